//! The source of a surface's heights, as a scene file writes it: one, or several put together.
//!
//! The same keys make a surface's own source and each part of `sum`, `mask` and `crossfade`.

use super::fields::{Fields, shown};
use super::own::{self, OwnSource};
use super::pixels::{Pixels, read_channel};
use super::sand::{self, Sand};
use crate::files::FileError;
use crate::parameters::{self, solid};
use asperity_surface::force_rendering::Rendering;
use asperity_surface::grating::{GratingKind, GratingParameters};
use asperity_surface::picture::Channel;
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::{ForceDirection, SolidNoiseParameters};
use std::path::Path;
use toml::Value;

/// Source of heights.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// No relief but the overlay.
    Flat,
    /// A height map.
    Map {
        /// Image file and channel.
        image: Pixels,
        /// Height of white over black, m.
        relief_m: f64,
        /// Black is high.
        invert: bool,
    },
    /// Solid noise.
    Solid {
        /// Layers of the preset, and what was written.
        parameters: Box<SolidNoiseParameters>,
        /// Seed; none = the scene's.
        seed: Option<u64>,
    },
    /// Waves, ridges or dots.
    Grating(GratingParameters),
    /// An exact fractional Brownian relief.
    Brownian(Brownian),
    /// A primitive cell repeated along two translations.
    Lattice(Lattice),
    /// Sand that gives way.
    Sand(Box<Sand>),
    /// One that the engine does not know.
    Own(OwnSource),
    /// All of them on top of each other.
    Sum(Vec<Self>),
    /// One, times a factor.
    Scale(Box<Self>, f64),
    /// One where an image is white, another where it is black.
    Mask {
        /// The weight of `inside`.
        image: Pixels,
        /// Felt where the image is white.
        inside: Box<Self>,
        /// Felt where it is black.
        outside: Box<Self>,
    },
    /// One first, another later.
    Crossfade {
        /// Felt at first.
        from: Box<Self>,
        /// Felt in the end.
        to: Box<Self>,
        /// Beginning of the change, s.
        at_s: f64,
    },
}

/// Brownian relief.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Brownian {
    /// Hurst exponent.
    pub hurst: f64,
    /// Rms height, m.
    pub rms_m: f64,
    /// Seed; none = the scene's.
    pub seed: Option<u64>,
    /// Points a side, or of the graph; none = the engine's choice.
    pub cells: Option<u64>,
    /// Heights follow the distance travelled instead of the place.
    pub graph: bool,
    /// The force that the relief answers with.
    pub force: Option<Rendering>,
}

/// A repeated cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Lattice {
    /// Image of one cell.
    pub cell: Pixels,
    /// First translation, m along u and v.
    pub t1_m: [f64; 2],
    /// Second translation.
    pub t2_m: [f64; 2],
    /// Height of white over black, m.
    pub relief_m: f64,
    /// Black is high.
    pub invert: bool,
}

/// The keys of which at most one may be there.
const SOURCES: [&str; 9] =
    ["displacement", "solid", "brownian", "lattice", "sand", "sum", "mask", "crossfade", "own"];

/// Reads the source of a surface or of a part of one; other keys stay.
pub(crate) fn read(fields: &mut Fields, folder: &Path) -> Result<Source, FileError> {
    let given: Vec<&'static str> = SOURCES.into_iter().filter(|key| fields.has(key)).collect();
    if let [first, second, ..] = given[..] {
        let right = format!("write one of {}, or put them into sum", SOURCES.join(", "));
        return Err(fields.refuse(second, format!("stands beside {first}"), right));
    }
    // `channel`, `invert` and `relief_m` speak of images; beside another source they say nothing.
    let channel = read_channel(fields, "channel")?;
    let invert = fields.flag("invert")?.unwrap_or(false);
    let relief_m = fields.number(&parameters::surface::RELIEF_M)?;
    let scale = fields.number(&parameters::surface::SCALE)?;
    let needed_relief = |fields: &Fields| {
        relief_m.ok_or_else(|| fields.missing("relief_m", "the height of white over black in m"))
    };
    let source = match given.first().copied() {
        None => Source::Flat,
        Some("displacement") => Source::Map {
            image: Pixels { path: folder.join(fields.needed_text("displacement")?), channel },
            relief_m: needed_relief(fields)?,
            invert,
        },
        Some("solid") => read_solid(fields)?,
        Some("lattice") => {
            let relief_m = needed_relief(fields)?;
            read_lattice(needed_table(fields, "lattice")?, folder, channel, relief_m, invert)?
        }
        Some("brownian") => read_brownian(needed_table(fields, "brownian")?)?,
        Some("sand") => Source::Sand(Box::new(sand::read(needed_table(fields, "sand")?, folder)?)),
        Some("own") => Source::Own(own::read(needed_table(fields, "own")?)?),
        Some("sum") => read_sum(fields, folder)?,
        Some("mask") => read_mask(needed_table(fields, "mask")?, folder)?,
        Some(_) => read_crossfade(needed_table(fields, "crossfade")?, folder)?,
    };
    Ok(match scale {
        Some(factor) => Source::Scale(Box::new(source), factor),
        None => source,
    })
}

fn needed_table(fields: &mut Fields, key: &'static str) -> Result<Fields, FileError> {
    fields.table(key)?.ok_or_else(|| fields.missing(key, "a table, { key = value }"))
}

/// A source that is a part of another one: a table with nothing else in it.
fn read_part(mut table: Fields, folder: &Path) -> Result<Source, FileError> {
    let source = read(&mut table, folder)?;
    table.finish()?;
    Ok(source)
}

fn read_sum(fields: &mut Fields, folder: &Path) -> Result<Source, FileError> {
    let parts = fields.tables("sum")?;
    if parts.is_empty() {
        return Err(fields.refuse("sum", "is empty", "write sum = [{ … }, { … }]"));
    }
    parts.into_iter().map(|part| read_part(part, folder)).collect::<Result<_, _>>().map(Source::Sum)
}

fn read_mask(mut table: Fields, folder: &Path) -> Result<Source, FileError> {
    let channel = read_channel(&mut table, "channel")?;
    let image = Pixels { path: folder.join(table.needed_text("image")?), channel };
    let inside = Box::new(read_part(needed_table(&mut table, "inside")?, folder)?);
    let outside = Box::new(read_part(needed_table(&mut table, "outside")?, folder)?);
    table.finish()?;
    Ok(Source::Mask { image, inside, outside })
}

fn read_crossfade(mut table: Fields, folder: &Path) -> Result<Source, FileError> {
    let from = Box::new(read_part(needed_table(&mut table, "from")?, folder)?);
    let to = Box::new(read_part(needed_table(&mut table, "to")?, folder)?);
    let at_s = table.needed_number(&parameters::crossfade::AT_S)?;
    table.finish()?;
    Ok(Source::Crossfade { from, to, at_s })
}

/// The name of a preset, or a table of one and what differs from it.
fn read_solid(fields: &mut Fields) -> Result<Source, FileError> {
    let right = "write the name of a material, or { preset = \"NAME\", … }";
    match fields.take("solid") {
        Some(Value::Table(table)) => read_solid_table(Fields::new(table, fields.inner("solid"))),
        Some(Value::String(preset)) if is_grating(&preset) => {
            Ok(Source::Grating(GratingParameters::default()))
        }
        Some(Value::String(preset)) if !preset.is_empty() => {
            let mut parameters = Box::new(solid_preset(fields, "solid", &preset)?);
            parameters.flow_m_s = fields.number_or_vector(&solid::FLOW_M_S)?.unwrap_or(parameters.flow_m_s);
            Ok(Source::Solid { parameters, seed: None })
        }
        Some(value) => Err(fields.refuse("solid", format!("{} is no material", shown(&value)), right)),
        None => Err(fields.missing("solid", "the name of a material")),
    }
}

fn solid_preset(fields: &Fields, key: &str, name: &str) -> Result<SolidNoiseParameters, FileError> {
    let material = SolidMaterial::from_name(name).ok_or_else(|| {
        let known = SolidMaterial::all().map(SolidMaterial::name);
        let known = known.chain(["grating"]).collect::<Vec<_>>().join(", ").replace('_', "-");
        fields.refuse(key, format!("\"{name}\" is unknown"), format!("must be one of: {known}"))
    })?;
    Ok(material.parameters())
}

fn is_grating(name: &str) -> bool {
    name.trim().eq_ignore_ascii_case("grating")
}

fn read_grating(mut table: Fields) -> Result<Source, FileError> {
    let kinds = [("sine", GratingKind::Sine), ("ridges", GratingKind::Ridges), ("dots", GratingKind::Dots)];
    let usual = GratingParameters::default();
    let grating = GratingParameters {
        kind: table.word("kind", &kinds)?.unwrap_or(usual.kind),
        pitch_m: table.number_or(&solid::PITCH_M, usual.pitch_m)?,
        amplitude_m: table.number_or(&solid::AMPLITUDE_M, usual.amplitude_m)?,
        duty: table.number_or(&solid::DUTY, usual.duty)?,
    };
    table.finish()?;
    Ok(Source::Grating(grating))
}

fn read_solid_table(mut table: Fields) -> Result<Source, FileError> {
    let directions =
        [("x", ForceDirection::X), ("normal", ForceDirection::Normal), ("tangent", ForceDirection::Tangent)];
    let preset = table.needed_text("preset")?;
    if is_grating(&preset) {
        return read_grating(table);
    }
    let mut parameters = solid_preset(&table, "preset", &preset)?;
    let seed = table.seed(&solid::SEED)?;
    let [first, _] = &mut parameters.modules;
    first.octaves = table.count(&solid::OCTAVES)?.unwrap_or(first.octaves);
    for (to, of) in [
        (&mut first.magnitude, &solid::MAGNITUDE),
        (&mut first.frequency, &solid::FREQUENCY),
        (&mut first.lacunarity, &solid::LACUNARITY),
        (&mut first.persistence, &solid::PERSISTENCE),
        (&mut parameters.texture_factor_per_m, &solid::TEXTURE_FACTOR_PER_M),
        (&mut parameters.amplitude_m, &solid::AMPLITUDE_M),
        (&mut parameters.limit_n, &solid::LIMIT_N),
        (&mut parameters.cap_n, &solid::CAP_N),
        (&mut parameters.viscosity_n_s_m, &solid::VISCOSITY_N_S_M),
    ] {
        *to = table.number_or(of, *to)?;
    }
    parameters.flow_m_s = table.number_or_vector(&solid::FLOW_M_S)?.unwrap_or(parameters.flow_m_s);
    parameters.direction = table.word("direction", &directions)?.unwrap_or(parameters.direction);
    let proportional = table.flag("proportional")?;
    parameters.proportional_to_contact = proportional.unwrap_or(parameters.proportional_to_contact);
    table.finish()?;
    Ok(Source::Solid { parameters: Box::new(parameters), seed })
}

fn read_brownian(mut table: Fields) -> Result<Source, FileError> {
    let forces = [("orthogonal", Rendering::Orthogonal), ("lateral", Rendering::Lateral)];
    let graph = table.flag("graph")?.unwrap_or(false);
    let most = if graph { 1 << 22 } else { 4096 };
    let brownian = Brownian {
        hurst: table.needed_number(&parameters::brownian::HURST)?,
        rms_m: table.needed_number(&parameters::brownian::RMS_M)?,
        seed: table.seed(&parameters::brownian::SEED)?,
        cells: table.whole("cells", 16, most)?,
        graph,
        force: table.word("force", &forces)?,
    };
    table.finish()?;
    Ok(Source::Brownian(brownian))
}

fn read_lattice(
    mut table: Fields,
    folder: &Path,
    channel: Channel,
    relief_m: f64,
    invert: bool,
) -> Result<Source, FileError> {
    let cell = table.needed_text("cell")?;
    let t1_m = table.pair(&parameters::lattice::T1_M)?.ok_or_else(|| table.missing("t1_m", "[0.01, 0.0]"))?;
    let t2_m = table.pair(&parameters::lattice::T2_M)?.ok_or_else(|| table.missing("t2_m", "[0.0, 0.01]"))?;
    let area = (t1_m[0] * t2_m[1] - t1_m[1] * t2_m[0]).abs();
    let longest = t1_m.iter().chain(&t2_m).fold(0.0_f64, |longest, length| longest.max(length.abs()));
    if area <= 1e-6 * longest * longest || longest < 1e-6 {
        return Err(table.refuse("t2_m", "spans no cell together with t1_m", "must point another way"));
    }
    table.finish()?;
    let cell = Pixels { path: folder.join(cell), channel };
    Ok(Source::Lattice(Lattice { cell, t1_m, t2_m, relief_m, invert }))
}
