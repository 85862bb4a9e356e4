//! The source of a surface's heights, as a scene file writes it: one, or several put together.
//!
//! The same keys make a surface's own source and each part of `sum`, `mask` and `crossfade`.

use super::fields::{Fields, shown};
use super::own::{self, OwnSource};
use super::pixels::{Pixels, read_channel};
use super::sand::{self, Sand};
use crate::files::FileError;
use asperity_dsp::limits::{self, Range};
use std::path::Path;
use toml::Value;

/// When a crossfade begins.
const AT_S: Range = Range::new(0.0, 1e6, "0 to 1e6 s");

/// Where heights come from.
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
    /// One of the seven solid-noise materials.
    Solid(Box<SolidNoise>),
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
        /// When the change begins, s.
        at_s: f64,
    },
}

/// Solid noise under the finger: a preset, and what differs from it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SolidNoise {
    /// Name of the preset.
    pub preset: String,
    /// Seed; none = the scene's.
    pub seed: Option<u64>,
    /// M of the first module.
    pub magnitude: Option<f64>,
    /// N of the first module.
    pub octaves: Option<u64>,
    /// f of the first module, cells per unit of length.
    pub frequency: Option<f64>,
    /// Lacunarity of the first module.
    pub lacunarity: Option<f64>,
    /// Persistence of the first module.
    pub persistence: Option<f64>,
    /// T, 1/m.
    pub texture_factor_per_m: Option<f64>,
    /// A, m per unit of magnitude.
    pub amplitude_m: Option<f64>,
    /// L, N per unit of magnitude.
    pub limit_n: Option<f64>,
    /// Largest texture force, N.
    pub cap_n: Option<f64>,
    /// b, N·s/m.
    pub viscosity_n_s_m: Option<f64>,
    /// Direction of the texture force.
    pub direction: Option<Direction>,
    /// Whether the texture force is multiplied by the normal force.
    pub proportional: Option<bool>,
}

/// Direction of a texture force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Along u.
    X,
    /// Out of the surface.
    Normal,
    /// Along the motion.
    Tangent,
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
    pub force: Option<BrownianForce>,
}

/// The thesis' force renderings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BrownianForce {
    /// Out of the surface, from the rate of climbing.
    Orthogonal,
    /// Along the surface, from the slope.
    Lateral,
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
pub fn read(fields: &mut Fields, folder: &Path) -> Result<Source, FileError> {
    let given: Vec<&'static str> = SOURCES.into_iter().filter(|key| fields.has(key)).collect();
    if let [first, second, ..] = given[..] {
        let right = format!("write one of {}, or put them into sum", SOURCES.join(", "));
        return Err(fields.refuse(second, format!("stands beside {first}"), right));
    }
    // `channel`, `invert` and `relief_m` speak of images; beside another source they say nothing.
    let channel = read_channel(fields, "channel")?;
    let invert = fields.flag("invert")?.unwrap_or(false);
    let relief_m = fields.number("relief_m", limits::RELIEF_M)?;
    let scale = fields.number("scale", limits::combined::FACTOR)?;
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
    let at_s = table.needed_number("at_s", AT_S)?;
    table.finish()?;
    Ok(Source::Crossfade { from, to, at_s })
}

/// The name of a preset, or a table of one and what differs from it.
fn read_solid(fields: &mut Fields) -> Result<Source, FileError> {
    let right = "write the name of a material, or { preset = \"NAME\", … }";
    let mut table = match fields.take("solid") {
        Some(Value::Table(table)) => Fields::new(table, fields.inner("solid")),
        Some(Value::String(preset)) if !preset.is_empty() => {
            return Ok(Source::Solid(Box::new(SolidNoise { preset, ..SolidNoise::default() })));
        }
        Some(value) => {
            return Err(fields.refuse("solid", format!("{} is no material", shown(&value)), right));
        }
        None => return Err(fields.missing("solid", "the name of a material")),
    };
    let directions = [("x", Direction::X), ("normal", Direction::Normal), ("tangent", Direction::Tangent)];
    let solid = SolidNoise {
        preset: table.needed_text("preset")?,
        seed: table.whole("seed", 0, u64::MAX)?,
        magnitude: table.number("magnitude", limits::solid::MAGNITUDE)?,
        octaves: table.whole("octaves", 1, 16)?,
        frequency: table.number("frequency", limits::solid::FREQUENCY)?,
        lacunarity: table.number("lacunarity", limits::solid::LACUNARITY)?,
        persistence: table.number("persistence", limits::solid::PERSISTENCE)?,
        texture_factor_per_m: table.number("texture_factor_per_m", limits::solid::TEXTURE_FACTOR_PER_M)?,
        amplitude_m: table.number("amplitude_m", limits::solid::AMPLITUDE_M)?,
        limit_n: table.number("limit_n", limits::solid::LIMIT_N)?,
        cap_n: table.number("cap_n", limits::solid::CAP_N)?,
        viscosity_n_s_m: table.number("viscosity_n_s_m", limits::solid::VISCOSITY_N_S_M)?,
        direction: table.word("direction", &directions)?,
        proportional: table.flag("proportional")?,
    };
    table.finish()?;
    Ok(Source::Solid(Box::new(solid)))
}

fn read_brownian(mut table: Fields) -> Result<Source, FileError> {
    let forces = [("orthogonal", BrownianForce::Orthogonal), ("lateral", BrownianForce::Lateral)];
    let graph = table.flag("graph")?.unwrap_or(false);
    let most = if graph { 1 << 22 } else { 4096 };
    let brownian = Brownian {
        hurst: table.needed_number("hurst", limits::brownian::HURST)?,
        rms_m: table.needed_number("rms_m", limits::brownian::RMS_M)?,
        seed: table.whole("seed", 0, u64::MAX)?,
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
    channel: Option<char>,
    relief_m: f64,
    invert: bool,
) -> Result<Source, FileError> {
    let step = limits::combined::STEP_M;
    let cell = table.needed_text("cell")?;
    let t1_m = table.pair("t1_m", step)?.ok_or_else(|| table.missing("t1_m", "[0.01, 0.0]"))?;
    let t2_m = table.pair("t2_m", step)?.ok_or_else(|| table.missing("t2_m", "[0.0, 0.01]"))?;
    let area = (t1_m[0] * t2_m[1] - t1_m[1] * t2_m[0]).abs();
    let longest = t1_m.iter().chain(&t2_m).fold(0.0_f64, |longest, length| longest.max(length.abs()));
    if area <= 1e-6 * longest * longest || longest < 1e-6 {
        return Err(table.refuse("t2_m", "spans no cell together with t1_m", "must point another way"));
    }
    table.finish()?;
    let cell = Pixels { path: folder.join(cell), channel };
    Ok(Source::Lattice(Lattice { cell, t1_m, t2_m, relief_m, invert }))
}
