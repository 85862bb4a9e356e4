//! `[probe]` and `[[probe]]`: what touches, and what is heard of it.

use super::body::read_material;
use super::fields::Fields;
use crate::files::FileError;
use crate::model::probe::{FACE_ASPERITIES, PROBE_PRESETS, TIP, probe_by_name};
use crate::parameters::probe as of;
use asperity_dsp::micro_contact::{HeardTip, Probe};

/// `[probe]`, the only one, or `[[probe]]`, of which the one without a name is the default.
pub(super) fn read_all(top: &mut Fields) -> Result<(Probe, Vec<(String, Probe)>), FileError> {
    if !top.is_list("probe") {
        let only = top.table("probe")?.map(read).transpose()?;
        return Ok((only.unwrap_or_default(), Vec::new()));
    }
    let (mut default, mut named) = (None, Vec::<(String, Probe)>::new());
    for mut fields in top.tables("probe")? {
        match fields.text("name")? {
            None if default.is_some() => {
                let right = "only one probe is the default";
                return Err(fields.refuse("name", "is missing for the second time", right));
            }
            Some(name) if named.iter().any(|(known, _)| *known == name) => {
                return Err(fields.refuse("name", "is used twice", "give each a name of its own"));
            }
            None => default = Some(read(fields)?),
            Some(name) => {
                fields.rename(format!("probe \"{name}\""));
                named.push((name, read(fields)?));
            }
        }
    }
    Ok((default.unwrap_or_default(), named))
}

/// A preset, and what differs from it.
pub(super) fn read(mut fields: Fields) -> Result<Probe, FileError> {
    let preset = match fields.text("preset")? {
        None => Probe::default(),
        Some(name) => probe_by_name(&name).ok_or_else(|| {
            let known = PROBE_PRESETS.map(|(name, _)| format!("\"{name}\"")).join(", ");
            let right = format!("must be one of {known}, or write the fields");
            fields.refuse("preset", format!("\"{name}\" is unknown"), right)
        })?,
    };
    // A stiffness that is written is one, whatever presses.
    let constant = fields.has("contact_stiffness_n_m");
    let force_exponent = if constant { 0.0 } else { preset.force_exponent };
    let tip_radius_m = fields.number_or(&of::TIP_RADIUS_M, preset.tip_radius_m)?;
    let face_m = fields.number_or(&of::FACE_M, preset.face_m)?;
    let asperities = if face_m > 0.0 { FACE_ASPERITIES } else { preset.asperities };
    let probe = Probe {
        pad_mass_kg: fields.number_or(&of::PAD_MASS_KG, preset.pad_mass_kg)?,
        pad_stiffness_n_m: fields.number_or(&of::PAD_STIFFNESS_N_M, preset.pad_stiffness_n_m)?,
        pad_damping_n_s_m: fields.number_or(&of::PAD_DAMPING_N_S_M, preset.pad_damping_n_s_m)?,
        finger_mass_kg: fields.number_or(&of::FINGER_MASS_KG, preset.finger_mass_kg)?,
        contact_stiffness_n_m: fields.number_or(&of::CONTACT_STIFFNESS_N_M, preset.contact_stiffness_n_m)?,
        leash_m: fields.number_or(&of::LEASH_M, preset.leash_m)?,
        tip_radius_m,
        force_exponent: fields.number_or(&of::FORCE_EXPONENT, force_exponent)?,
        ridge_m: fields.number_or(&of::RIDGE_M, preset.ridge_m)?,
        tip: read_tip(&mut fields, preset.tip, tip_radius_m)?,
        face_m,
        asperities: fields.number_or(&of::ASPERITIES, asperities)?,
    };
    fields.finish()?;
    Ok(probe)
}

/// Keys of a tip of its own beside its mass.
const OF_THE_TIP: [&str; 4] =
    ["tip_damping_n_s_m", "tip_material", "tip_contact_radius_m", "asperity_radius_m"];

/// A tip of its own: the preset's, or the one that its mass makes; 0 kg is none.
fn read_tip(
    fields: &mut Fields,
    preset: Option<HeardTip>,
    tip_radius_m: f64,
) -> Result<Option<HeardTip>, FileError> {
    let mass_kg = fields.number(&of::TIP_MASS_KG)?;
    let Some(mass_kg) = mass_kg.or(preset.map(|tip| tip.mass_kg)).filter(|mass_kg| *mass_kg > 0.0) else {
        let stray = OF_THE_TIP.into_iter().find(|key| fields.has(key));
        let right = "give the tip's mass, for instance tip_mass_kg = 0.0005, or leave it out";
        return stray.map_or(Ok(None), |key| Err(fields.refuse(key, "stands without tip_mass_kg", right)));
    };
    let contact_radius_m = if tip_radius_m > 0.0 { tip_radius_m } else { TIP.contact_radius_m };
    let tip = preset.unwrap_or(HeardTip { contact_radius_m, ..TIP });
    Ok(Some(HeardTip {
        mass_kg,
        damping_n_s_m: fields.number_or(&of::TIP_DAMPING_N_S_M, tip.damping_n_s_m)?,
        material: read_material(fields, "tip_material")?.map_or(tip.material, |material| material.elastic()),
        contact_radius_m: fields.number_or(&of::TIP_CONTACT_RADIUS_M, tip.contact_radius_m)?,
        asperity_radius_m: fields.number_or(&of::ASPERITY_RADIUS_M, tip.asperity_radius_m)?,
    }))
}
