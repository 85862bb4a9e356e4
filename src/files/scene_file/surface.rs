//! `[[surface]]`: what is touched.

use super::fields::{Fields, as_number, shown};
use super::pixels::{Pixels, read_channel};
use super::source::{self, Source};
use crate::files::FileError;
use crate::model::excitation::{Excitation, Exciter};
use crate::model::frame::SurfaceFrame;
use crate::model::surface::DEFAULT_STICK_SLIP;
use crate::parameters::{frame, surface as parameters};
use asperity_dsp::fractal_noise::OCTAVES;
use asperity_dsp::stick_slip::Friction;
use asperity_surface::wrap::Wrap;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// One surface.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceEntry {
    /// Name that the contact log uses.
    pub name: String,
    /// The table as it is written, and what its paths are relative to.
    pub(crate) written: (Table, PathBuf),
    /// Body that rings when the surface is touched; none = silent.
    pub body: Option<String>,
    /// Which of the body's strike positions contacts here excite; the modes file lists them, 0 is
    /// its own amplitudes.
    pub strike_position: usize,
    /// Source of its heights.
    pub source: Source,
    /// Perceptual roughness R.
    pub roughness: RoughnessEntry,
    /// Metres that uv 1 spans along u.
    pub width_m: f64,
    /// Metres that uv 1 spans along v.
    pub height_m: f64,
    /// Level of the 1/f^α overlay, m; none = that of its material, or the engine's default.
    pub micro_relief_m: Option<f64>,
    /// Wavelength beyond which the overlay is flat, m; none = the engine's default.
    pub outer_scale_m: Option<f64>,
    /// Gains of the overlay's octaves over its law, coarsest first, dB.
    pub micro_relief_octaves_db: Option<[f64; OCTAVES]>,
    /// Long waves under a map that has none of its own; none = no.
    pub long_waves: Option<bool>,
    /// Continuation beyond the edge.
    pub wrap: Wrap,
    /// Excitation of the body by sliding.
    pub excitation: Excitation,
    /// Place in its body.
    pub frame: Option<SurfaceFrame>,
    /// Friction with which contacts stick and slip; none where friction is no exciter.
    pub stick_slip: Option<Friction>,
    /// Coulomb friction coefficient, for the 3-D force; none = the source's.
    pub friction: Option<f64>,
    /// Compliance, m/N; none = as its source has it.
    pub compliance_m_n: Option<f64>,
}

/// Source of R.
#[derive(Debug, Clone, PartialEq)]
pub enum RoughnessEntry {
    /// One R everywhere; none = the engine's default.
    Number(Option<f64>),
    /// A map of R, or of gloss 1 − R.
    Map {
        /// Image file and channel.
        image: Pixels,
        /// The map holds gloss.
        gloss: bool,
    },
}

/// Reads one `[[surface]]`.
pub(crate) fn read(mut fields: Fields, folder: &Path) -> Result<SurfaceEntry, FileError> {
    let written = (fields.written(), folder.to_owned());
    let name = fields.needed_text("name")?;
    let place = format!("{} \"{name}\"", fields.inner("").trim_end_matches(": "));
    fields.rename(place);
    let source = source::read(&mut fields, folder)?;
    let excitation = read_excitation(&mut fields)?;
    let wraps = [("repeat", Wrap::Repeat), ("clamp", Wrap::Clamp), ("mirror", Wrap::Mirror)];
    let surface = SurfaceEntry {
        name,
        written,
        body: fields.text("body")?,
        strike_position: fields.count(&parameters::STRIKE_POSITION)?.unwrap_or(0),
        source,
        roughness: read_roughness(&mut fields, folder)?,
        width_m: fields.needed_number(&parameters::WIDTH_M)?,
        height_m: fields.needed_number(&parameters::HEIGHT_M)?,
        micro_relief_m: fields.number(&parameters::MICRO_RELIEF_M)?,
        outer_scale_m: fields.number(&parameters::OUTER_SCALE_M)?,
        micro_relief_octaves_db: fields.up_to(&parameters::MICRO_RELIEF_OCTAVES_DB, 0.0)?,
        long_waves: fields.flag("long_waves")?,
        wrap: fields.word("wrap", &wraps)?.unwrap_or_default(),
        excitation,
        stick_slip: read_stick_slip(&mut fields, excitation)?,
        frame: read_frame(&mut fields)?,
        friction: fields.number(&parameters::FRICTION)?,
        compliance_m_n: fields.number(&parameters::COMPLIANCE_M_N)?,
    };
    fields.finish()?;
    Ok(surface)
}

/// One word for a set of exciters, or a list of them.
fn read_excitation(fields: &mut Fields) -> Result<Excitation, FileError> {
    let Some(value) = fields.take("excitation") else { return Ok(Excitation::default()) };
    let what = format!("{} is refused", shown(&value));
    value.try_into().map_err(|_| {
        let right = "must be collisions, force, friction or both, or a list of collisions, force, friction";
        fields.refuse("excitation", what, right)
    })
}

/// The numbers of friction that rings the body.
fn read_stick_slip(fields: &mut Fields, excitation: Excitation) -> Result<Option<Friction>, FileError> {
    if !excitation.has(Exciter::Friction) {
        for key in ["mu_static", "mu_kinetic", "slip_speed_m_s"] {
            if fields.has(key) {
                let right = "write excitation = [\"friction\"], alone or among others, or leave it out";
                return Err(fields.refuse(key, "stands without friction among excitation", right));
            }
        }
        return Ok(None);
    }
    let mu_static = fields.number_or(&parameters::MU_STATIC, DEFAULT_STICK_SLIP.mu_static)?;
    let written = fields.number(&parameters::MU_KINETIC)?;
    if let Some(mu) = written.filter(|mu| *mu > mu_static) {
        let right = format!("must be at most mu_static, {mu_static}");
        return Err(fields.refuse("mu_kinetic", format!("{mu} is refused"), right));
    }
    let mu_kinetic = written.unwrap_or(DEFAULT_STICK_SLIP.mu_kinetic.min(mu_static));
    let slip_speed_m_s = fields.number_or(&parameters::SLIP_SPEED_M_S, DEFAULT_STICK_SLIP.slip_speed_m_s)?;
    Ok(Some(Friction { mu_static, mu_kinetic, slip_speed_m_s }))
}

/// `[surface.frame]`; what is missing is the body's origin, its x and its y axis.
fn read_frame(fields: &mut Fields) -> Result<Option<SurfaceFrame>, FileError> {
    let Some(mut fields) = fields.table("frame")? else { return Ok(None) };
    let origin_m = fields.vector(&frame::ORIGIN_M)?.unwrap_or_default();
    let u_axis = fields.vector(&frame::U_AXIS)?.unwrap_or([1.0, 0.0, 0.0]);
    let v_axis = fields.vector(&frame::V_AXIS)?.unwrap_or([0.0, 1.0, 0.0]);
    let place = fields.inner("");
    fields.finish()?;
    let placed = |error| FileError::from_error(error).within(place.trim_end_matches([':', ' ', '.']));
    SurfaceFrame::new(origin_m, u_axis, v_axis).map(Some).map_err(placed)
}

fn read_roughness(fields: &mut Fields, folder: &Path) -> Result<RoughnessEntry, FileError> {
    if fields.has("roughness") && fields.has("gloss") {
        return Err(fields.refuse(
            "gloss",
            "stands beside roughness",
            "write one of them; gloss is 1 − roughness",
        ));
    }
    let channel = read_channel(fields, "roughness_channel")?;
    let (value, gloss, key) = match (fields.take("roughness"), fields.take("gloss")) {
        (Some(value), _) => (value, false, "roughness"),
        (None, Some(value)) => (value, true, "gloss"),
        (None, None) => return Ok(RoughnessEntry::Number(None)),
    };
    match value {
        Value::String(name) => {
            Ok(RoughnessEntry::Map { image: Pixels { path: folder.join(name), channel }, gloss })
        }
        value => {
            let number = as_number(&value)
                .filter(|number| parameters::ROUGHNESS.range.holds(*number))
                .ok_or_else(|| {
                    let right = format!("must be {}, or name an image", parameters::ROUGHNESS.range.words);
                    fields.refuse(key, format!("{} is refused", shown(&value)), right)
                })?;
            Ok(RoughnessEntry::Number(Some(if gloss { 1.0 - number } else { number })))
        }
    }
}
