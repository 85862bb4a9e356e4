//! `[[surface]]`: what is touched.

use super::fields::{Allowed, Fields, as_number, shown};
use crate::error::CliError;
use std::path::{Path, PathBuf};
use toml::Value;

/// Extents and translations, m.
const EXTENT_M: Allowed = Allowed::above(0.0, 1_000.0, "m");
const RELIEF_M: Allowed = Allowed::between(0.0, 10.0, "m");
const ROUGHNESS: Allowed = Allowed::between(0.0, 1.0, "");

/// One surface.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceEntry {
    /// Name that the contact log uses.
    pub name: String,
    /// Body that rings when the surface is touched; none = silent.
    pub body: Option<String>,
    /// Which of the body's strike positions contacts here excite; the modes file lists them, 0 is its own amplitudes.
    pub strike_position: usize,
    /// Where its heights come from.
    pub source: Source,
    /// Perceptual roughness R.
    pub roughness: Roughness,
    /// What uv 1 spans along u, m.
    pub width_m: f64,
    /// What uv 1 spans along v, m.
    pub height_m: f64,
    /// Level of the 1/f^α overlay; none = the engine's default.
    pub micro_relief_m: Option<f64>,
    /// What lies beyond the edge.
    pub wrap: Wrap,
    /// What sliding sends to the body; none = the engine's default.
    pub excitation: Option<Excitation>,
    /// Coulomb friction coefficient, for the 3-D force; none = the engine's default.
    pub friction: Option<f64>,
}

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
    Solid(SolidNoise),
    /// An exact fractional Brownian surface.
    Brownian {
        /// Hurst exponent.
        hurst: f64,
        /// Rms height, m.
        rms_m: f64,
        /// Seed; none = the scene's.
        seed: Option<u64>,
        /// Points a side; none = the engine's choice.
        cells: Option<u64>,
    },
    /// A primitive cell repeated along two translations.
    Lattice(Lattice),
    /// Sand that gives way.
    Sand(Sand),
}

/// A channel of an image file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pixels {
    /// Image file.
    pub path: PathBuf,
    /// `r`, `g`, `b`, `a` or `luma`; none = what the image suggests.
    pub channel: Option<char>,
}

/// Solid noise under the finger.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SolidNoise {
    /// Name of the preset, which holds its own heights in metres.
    pub preset: String,
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

/// Sand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sand {
    /// Cells a side.
    pub cells: u64,
    /// Depth of the bed, m.
    pub depth_m: f64,
    /// Angle of repose, degrees.
    pub talus_deg: f64,
    /// k_s of the repulse force, N.
    pub stiffness_n: f64,
    /// k_c of the repulse force, 1/m.
    pub exponent_per_m: f64,
    /// k_f of the drag, s/m.
    pub drag_s_per_m: f64,
    /// Radius of the tool, m.
    pub tool_radius_m: f64,
    /// 0 dry – 1 wet; none = the engine's default.
    pub wetness: Option<f64>,
}

/// Where R comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Roughness {
    /// The same everywhere; none = the engine's default.
    Number(Option<f64>),
    /// A map of R, or of gloss 1 − R.
    Map {
        /// Image file and channel.
        image: Pixels,
        /// The map holds gloss.
        gloss: bool,
    },
}

/// What lies beyond the edge of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wrap {
    /// The map again.
    #[default]
    Repeat,
    /// Its edge for ever.
    Clamp,
    /// The map, mirrored.
    Mirror,
}

/// What sliding sends to the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Excitation {
    /// Hertz pulses of micro-collisions, as the paper.
    Collisions,
    /// The alternating part of the contact force.
    Force,
    /// Both.
    Both,
}

/// Reads one `[[surface]]`.
pub fn read(mut fields: Fields, folder: &Path) -> Result<SurfaceEntry, CliError> {
    let name = fields.needed_text("name")?;
    let place = format!("{} \"{name}\"", fields.inner("").trim_end_matches(": "));
    fields.rename(place);
    let source = read_source(&mut fields, folder)?;
    let wraps = [("repeat", Wrap::Repeat), ("clamp", Wrap::Clamp), ("mirror", Wrap::Mirror)];
    let excitations =
        [("collisions", Excitation::Collisions), ("force", Excitation::Force), ("both", Excitation::Both)];
    let surface = SurfaceEntry {
        name,
        body: fields.text("body")?,
        // The engine takes 16 positions.
        strike_position: fields.whole("strike_position", 0, 15)?.unwrap_or(0) as usize,
        source,
        roughness: read_roughness(&mut fields, folder)?,
        width_m: fields.needed_number("width_m", EXTENT_M)?,
        height_m: fields.needed_number("height_m", EXTENT_M)?,
        micro_relief_m: fields.number("micro_relief_m", Allowed::between(0.0, 1e-2, "m, 0 = none"))?,
        wrap: fields.word("wrap", &wraps)?.unwrap_or_default(),
        excitation: fields.word("excitation", &excitations)?,
        friction: fields.number("friction", Allowed::between(0.0, 10.0, ""))?,
    };
    fields.finish()?;
    Ok(surface)
}

/// The five keys of which at most one may be there.
const SOURCES: [&str; 5] = ["displacement", "solid", "brownian", "lattice", "sand"];

fn read_source(fields: &mut Fields, folder: &Path) -> Result<Source, CliError> {
    let given: Vec<&'static str> = SOURCES.into_iter().filter(|key| fields.has(key)).collect();
    if let [first, second, ..] = given[..] {
        let right = format!("write one of {}", SOURCES.join(", "));
        return Err(fields.refuse(second, format!("stands beside {first}"), right));
    }
    // `channel`, `invert` and `relief_m` speak of images; beside another source they say nothing.
    let channel = read_channel(fields, "channel")?;
    let invert = fields.flag("invert")?.unwrap_or(false);
    let relief_m = fields.number("relief_m", RELIEF_M)?;
    let needed_relief = |fields: &Fields| {
        relief_m.ok_or_else(|| fields.missing("relief_m", "the height of white over black in m"))
    };
    match given.first().copied() {
        Some("displacement") => Ok(Source::Map {
            image: Pixels { path: folder.join(fields.needed_text("displacement")?), channel },
            relief_m: needed_relief(fields)?,
            invert,
        }),
        Some("solid") => Ok(Source::Solid(SolidNoise { preset: fields.needed_text("solid")? })),
        Some("brownian") => match fields.table("brownian")? {
            Some(table) => read_brownian(table),
            None => Ok(Source::Flat),
        },
        Some("lattice") => {
            let relief_m = needed_relief(fields)?;
            match fields.table("lattice")? {
                Some(table) => read_lattice(table, folder, channel, relief_m, invert),
                None => Ok(Source::Flat),
            }
        }
        Some("sand") => match fields.table("sand")? {
            Some(table) => read_sand(table),
            None => Ok(Source::Flat),
        },
        _ => Ok(Source::Flat),
    }
}

fn read_channel(fields: &mut Fields, key: &'static str) -> Result<Option<char>, CliError> {
    fields.word(key, &[("r", 'r'), ("g", 'g'), ("b", 'b'), ("a", 'a'), ("luma", 'l')])
}

fn read_brownian(mut table: Fields) -> Result<Source, CliError> {
    let source = Source::Brownian {
        hurst: table.needed_number("hurst", Allowed::between(0.01, 0.99, ""))?,
        rms_m: table.needed_number("rms_m", Allowed::between(0.0, 0.1, "m"))?,
        seed: table.whole("seed", 0, u64::MAX)?,
        cells: table.whole("cells", 16, 4096)?,
    };
    table.finish()?;
    Ok(source)
}

fn read_lattice(
    mut table: Fields,
    folder: &Path,
    channel: Option<char>,
    relief_m: f64,
    invert: bool,
) -> Result<Source, CliError> {
    let step = Allowed::between(-1_000.0, 1_000.0, "m");
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

fn read_sand(mut table: Fields) -> Result<Source, CliError> {
    let sand = Sand {
        cells: table.whole("cells", 16, 2048)?.unwrap_or(512),
        depth_m: table.number_or("depth_m", 0.05, Allowed::above(0.0, 0.45, "m"))?,
        talus_deg: table.number_or("talus_deg", 30.0, Allowed::between(1.0, 80.0, "degrees"))?,
        stiffness_n: table.number_or("stiffness_n", 1_000.0, Allowed::between(0.01, 1e6, "N"))?,
        exponent_per_m: table.number_or("exponent_per_m", 1.0, Allowed::between(1e-3, 1e4, "1/m"))?,
        drag_s_per_m: table.number_or("drag_s_per_m", 20.0, Allowed::between(0.0, 1e4, "s/m"))?,
        tool_radius_m: table.number_or("tool_radius_m", 0.005, Allowed::between(1e-4, 0.2, "m"))?,
        wetness: table.number("wetness", Allowed::between(0.0, 1.0, ""))?,
    };
    table.finish()?;
    Ok(Source::Sand(sand))
}

fn read_roughness(fields: &mut Fields, folder: &Path) -> Result<Roughness, CliError> {
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
        (None, None) => return Ok(Roughness::Number(None)),
    };
    match value {
        Value::String(name) => {
            Ok(Roughness::Map { image: Pixels { path: folder.join(name), channel }, gloss })
        }
        value => {
            let number =
                as_number(&value).filter(|number| (0.0..=1.0).contains(number)).ok_or_else(|| {
                    let right = format!("{ROUGHNESS}, or name an image");
                    fields.refuse(key, format!("{} is refused", shown(&value)), right)
                })?;
            Ok(Roughness::Number(Some(if gloss { 1.0 - number } else { number })))
        }
    }
}
