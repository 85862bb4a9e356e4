//! Shape from a photograph: a picture becomes a surface that can be touched.
//!
//! ```text
//! photo → camera's noise off → lattice, primitive → symmetric part ─→ heights ──────(+)→ displacement
//!                                                └─ residual ──────→ heights ─ fine ─┘
//!                                                                        └→ 1/f^α → roughness R, micro-relief
//! ```
//! Source: document 004, the chain of chapters 6 (roughness), 7 (symmetry) and 8 (heights). Nothing
//! in it is tuned by hand:
//!
//! | step | here |
//! |---|---|
//! | noise | [`crate::camera_noise`] |
//! | lattice, or none | [`crate::symmetry`]; averaged in its wallpaper group's fundamental domain |
//! | heights | [`crate::shape_from_shading`]: the light given, or found, or [dark is deep](mod@crate::darkness_prior) |
//! | which way up | [`Sign`] |
//! | R and micro-relief | [`crate::relief_spectrum`] of the heights |
//!
//! **Contrast is slope**, so half the contrast gives half the relief and half the micro-relief, and
//! a blank wall next to none. How steep one unit of contrast is depends on light and camera:
//! [`PhotoOptions::calibration`] is the factor, [`calibration`] takes it from a sample of known
//! relief.
//!
//! Without a lattice nothing is averaged: the whole picture is the primitive, heights and R are
//! taken from it. They are also taken from the whole picture when the pattern wanders off its
//! lattice, as scales on a bent skin do: then the mean of all cells is a blur
//! ([`Repetition::wanders`]). Brightness has no size: a texel is [`TEXEL_M`] wide by default. The
//! document's users preferred heights twice as large as computed; [`PhotoOptions::exaggeration`] is
//! 1, 2 or 4 there.

mod heights;
mod options;
mod reduced;
mod residual;
mod sign;

pub use heights::{Fallback, linear_light};
pub use options::{PhotoOptions, TEXEL_M};
pub use reduced::{MOST_TEXELS, reduced};
pub use sign::{DECIDED, Sign};

use crate::borders::Borders;
use crate::camera_noise::{MOST_NOISE, without_noise_and_steps};
use crate::fractal_dimension::{Condition, conditions, transects};
use crate::relief_spectrum::ReliefSpectrum;
use crate::shape_from_shading::Shape;
use crate::side_by_side::both;
use crate::symmetry::{self, Lattice, WallpaperGroup};
use asperity_dsp::DesignError;
use asperity_surface::raster::Raster;
use reduced::means;

/// [`symmetry::even_steadiness`] below which the mean cell is not used. Source: ours; at least 0.95
/// for strict patterns of the tests and photographs, 0.08 for the skin among the photographs.
const STEADY: f64 = 0.7;
/// Largest micro-noise that is written, m: sandpaper.
pub const LARGEST_MICRO_RELIEF_M: f64 = 1e-4;
/// Shorter side below which R is not trusted, texels: two octaves above the blur.
pub const SMALL_PX: usize = 64;
/// R where a picture is too small or too even to show it. Assumed: α of 1.75.
const UNKNOWN_ROUGHNESS: f64 = 0.5;

/// Repeating pattern of the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Repetition {
    /// Its translations.
    pub lattice: Lattice,
    /// Its symmetries.
    pub group: WallpaperGroup,
    /// Share of the picture's variance that repeats, 0–1.
    pub share: f64,
    /// True where the pattern drifts off its lattice, so that its mean cell is a blur: heights and
    /// roughness are then those of the whole picture.
    pub wanders: bool,
}

/// Doubts about a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Doubt {
    /// An input condition of the document that does not hold.
    Condition(Condition),
    /// A pattern repeats, with this confidence: heights are its mean cell's.
    Repeats(f64),
    /// Another way to heights was taken than the light seemed to allow.
    Fallback(Fallback),
    /// Which way up the heights are is a guess.
    GuessedSign,
    /// The picture is smaller than [`SMALL_PX`]: its R rests on few waves.
    Small,
    /// Too small or too even for any R: it is assumed.
    NoRoughness,
    /// Noise as strong as the strongest that is taken off; some may be left.
    Noisy,
    /// Nothing rises above the camera's noise: the surface is flat.
    Flat,
    /// The micro-relief was cut to [`LARGEST_MICRO_RELIEF_M`].
    MicroReliefCut,
}

impl std::fmt::Display for Doubt {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Condition(condition) => condition.fmt(f),
            Self::Repeats(confidence) => write!(
                f,
                "a pattern repeats (confidence {confidence:.2}): heights are those of its mean cell and the fine waves of what differs from it, roughness and micro-relief those of what differs"
            ),
            Self::Fallback(reason) => reason.fmt(f),
            Self::GuessedSign => f.write_str(
                "which way up the heights are is a guess; look at overview.png, `--bright-is-deep` turns them over",
            ),
            Self::Small => {
                write!(f, "the picture is below {SMALL_PX} texels: its roughness rests on few waves")
            }
            Self::NoRoughness => {
                write!(f, "too small or too even to tell a roughness: R = {UNKNOWN_ROUGHNESS} is assumed")
            }
            Self::Noisy => f.write_str(
                "the finest waves are as strong as a noisy camera's: what is felt above 200 Hz may be noise",
            ),
            Self::Flat => {
                f.write_str("nothing in the picture can be told from noise (a camera's, or what blurring, reducing and recompressing leave of it): the surface is flat")
            }
            Self::MicroReliefCut => {
                write!(f, "the micro-relief was cut to {:.0} µm", LARGEST_MICRO_RELIEF_M * 1e6)
            }
        }
    }
}

/// One cell of a pattern as heights, for a lattice that never ends.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightCell {
    /// Heights 0–1 over `relief_m`, columns along `t1_m`, rows along `t2_m`.
    pub heights: Raster,
    /// Height of 1 over 0, m.
    pub relief_m: f64,
    /// First translation, m.
    pub t1_m: [f64; 2],
    /// Second translation, m.
    pub t2_m: [f64; 2],
}

/// The surface of a photograph.
#[derive(Debug, Clone, PartialEq)]
pub struct PhotoSurface {
    /// Heights, 0–1 over [`PhotoSurface::relief_m`], as large as the picture.
    pub displacement: Raster,
    /// Height of 1 over 0, m.
    pub relief_m: f64,
    /// Perceptual roughness R, 0–1, as large as the picture.
    pub roughness: Raster,
    /// Rms of the micro-noise in the octave around 1 mm, m, for the engine's overlay.
    pub micro_relief_m: f64,
    /// Dimension of the residual's relief, or of the whole where nothing repeats; `None` when that
    /// is flat.
    pub dimension: Option<f64>,
    /// Repeating pattern; `None` when nothing repeats.
    pub repetition: Option<Repetition>,
    /// The pattern's cell as heights; `None` when nothing repeats or the pattern wanders.
    pub cell: Option<HeightCell>,
    /// The averaged cell in lattice coordinates, or the picture.
    pub primitive: Raster,
    /// The cell repeated, or the picture.
    pub symmetric: Raster,
    /// Part that does not repeat; empty where nothing does.
    pub residual: Raster,
    /// Method that found the heights.
    pub shape: Shape,
    /// Which way up they are.
    pub sign: Sign,
    /// True where the light was found in the picture (and not given).
    pub light_was_found: bool,
    /// Rms of what was taken for the camera's noise, of white.
    pub noise: f64,
    /// Doubts.
    pub doubts: Vec<Doubt>,
    /// True where the picture tiles.
    pub tileable: bool,
}

/// Makes a surface of a photograph: grey values 0–1 as stored (sRGB). `progress` gets the
/// fraction done.
///
/// # Errors
/// When the picture is smaller than 16 × 16, holds numbers that are not finite, or an option is
/// outside its range.
pub fn surface_from_photo(
    picture: &Raster,
    options: &PhotoOptions,
    mut progress: impl FnMut(f64),
) -> Result<PhotoSurface, DesignError> {
    options::check(picture, options)?;
    let (quiet, (repetition, parts)) =
        both(|| without_noise_and_steps(picture, options.jpeg_divisor), || take_apart(picture));
    progress(0.4);
    let averaged = repetition.as_ref().is_some_and(|found| !found.wanders);
    let shaped = if averaged { &parts.symmetric } else { &quiet.picture };
    let (textured_px, found) = both(
        || averaged.then(|| residual::residual_heights(&parts.residual, picture, options.jpeg_divisor)),
        || heights::heights_of(shaped, &quiet.picture, options, |done| progress(0.4 + 0.4 * done)),
    );
    let mut found = found?;
    let noise = quiet.noise;
    drop(quiet);
    let textured_px = match textured_px {
        Some(residual_px) => {
            let up = if found.sign.bright_is_deep { -1.0 } else { 1.0 };
            let residual_px = residual_px.map(|z| up * z);
            residual::add_fine_waves(&mut found.shape.height_px, &residual_px);
            residual_px
        }
        None => found.shape.height_px.clone(),
    };
    let scale = options.scale(&found.shape.height_px);
    let textured = if averaged { &parts.residual } else { picture };
    let (input_conditions, law) = both(|| conditions_of(textured), || ReliefSpectrum::of(&textured_px));
    let roughness = match &law {
        Some(law) => law.roughness_map(&textured_px),
        None => Raster::constant(picture.width, picture.height, UNKNOWN_ROUGHNESS),
    };
    drop(textured_px);
    progress(0.9);
    let micro_m = law.map_or(0.0, |law| law.micro_relief_px(options.texel_m)) * scale.metres_per_px;
    let cell = repetition.as_ref().filter(|_| averaged).map(|found_pattern| {
        height_cell(&found.shape.height_px, &found_pattern.lattice, scale.metres_per_px, options.texel_m)
    });
    let mut doubts = doubts_of(picture, input_conditions, &law, noise, scale.relief_m);
    if let Some(found) = repetition.as_ref().filter(|_| scale.relief_m > 0.0) {
        let confidence = found.lattice.confidence;
        let repeats = Doubt::Repeats(confidence);
        doubts.push(if averaged { repeats } else { Doubt::Condition(Condition::Symmetric(confidence)) });
    }
    doubts.extend(found.fallback.map(Doubt::Fallback));
    doubts.extend((!found.sign.is_decided() && scale.relief_m > 0.0).then_some(Doubt::GuessedSign));
    doubts.extend((micro_m > LARGEST_MICRO_RELIEF_M).then_some(Doubt::MicroReliefCut));
    let displacement = zero_to_one(&found.shape.height_px);
    found.shape.height_px = found.shape.height_px.map(|z| z * scale.metres_per_px / options.texel_m);
    progress(1.0);
    Ok(PhotoSurface {
        displacement,
        relief_m: scale.relief_m,
        roughness,
        micro_relief_m: micro_m.min(LARGEST_MICRO_RELIEF_M),
        dimension: law.map(|law| law.dimension()),
        repetition,
        cell,
        primitive: parts.primitive,
        symmetric: parts.symmetric,
        residual: parts.residual,
        shape: found.shape,
        sign: found.sign,
        light_was_found: found.light_was_found,
        noise,
        doubts,
        tileable: Borders::Detect.decide(picture) == Borders::Periodic,
    })
}

/// The factor on heights that makes a sample's photograph give its known relief: the same camera,
/// light and texel size then give other surfaces theirs. `options` are those of the photograph of
/// the sample.
///
/// # Errors
/// As [`surface_from_photo`], and when the sample shows no relief.
pub fn calibration(sample: &Raster, relief_m: f64, options: &PhotoOptions) -> Result<f64, DesignError> {
    let range = "above 0 m and at most 1 m";
    DesignError::check("known relief", relief_m, range, |r| r > 0.0 && r <= 1.0)?;
    let plain = PhotoOptions { relief_m: None, calibration: 1.0, exaggeration: 1.0, ..*options };
    let found_m = surface_from_photo(sample, &plain, |_| {})?.relief_m;
    let shown = "a sample whose relief rises above the camera's noise";
    DesignError::check("known relief", found_m, shown, |found| found > 0.0)?;
    Ok(relief_m / found_m)
}

/// The lattice of a picture; of a large one, that of its halves, where patterns below 16 texels are
/// not seen.
fn lattice_of(picture: &Raster) -> Option<Lattice> {
    if picture.width * picture.height <= MOST_TEXELS / 2 {
        return symmetry::find_lattice(picture);
    }
    let found = symmetry::find_lattice(&means(picture, 2))?;
    let twice = |t: [f64; 2]| t.map(|length| 2.0 * length);
    Some(Lattice { t1_px: twice(found.t1_px), t2_px: twice(found.t2_px), ..found })
}

/// Primitive, symmetric part and residual, and what repeats.
fn take_apart(picture: &Raster) -> (Option<Repetition>, symmetry::Separation) {
    let Some(lattice) = lattice_of(picture) else {
        let whole = symmetry::Separation {
            primitive: picture.clone(),
            symmetric: picture.clone(),
            residual: Raster::constant(picture.width, picture.height, 0.0),
        };
        return (None, whole);
    };
    let even = symmetry::detrended(picture);
    let averaged = symmetry::averaged_even_cell(&even, &lattice);
    let wanders = symmetry::even_steadiness(&even, &lattice, &averaged) < STEADY;
    drop(even);
    let found = symmetry::wallpaper_group(&averaged, &lattice);
    let parts = symmetry::with_cell(picture, &lattice, &found.cell);
    let share = (deviation(&parts.symmetric) / deviation(picture).max(1e-12)).powi(2).min(1.0);
    (Some(Repetition { lattice, group: found.group, share, wanders }), parts)
}

/// The mean cell of the heights.
fn height_cell(heights_px: &Raster, lattice: &Lattice, metres_per_px: f64, texel_m: f64) -> HeightCell {
    let cell = symmetry::averaged_cell(heights_px, lattice).cell;
    let (low, high) = cell.range();
    let metres = |t: [f64; 2]| t.map(|length| length * texel_m);
    HeightCell {
        heights: zero_to_one(&cell),
        relief_m: (high - low) * metres_per_px,
        t1_m: metres(lattice.t1_px),
        t2_m: metres(lattice.t2_px),
    }
}

/// The document's input conditions that do not hold.
fn conditions_of(textured: &Raster) -> Vec<Doubt> {
    let broken = transects(textured).map(|along| conditions(textured, &along));
    broken.unwrap_or_default().into_iter().map(Doubt::Condition).collect()
}

fn doubts_of(
    picture: &Raster,
    mut doubts: Vec<Doubt>,
    law: &Option<ReliefSpectrum>,
    noise: f64,
    relief_m: f64,
) -> Vec<Doubt> {
    if relief_m <= 0.0 {
        return vec![Doubt::Flat];
    }
    doubts.extend((picture.width.min(picture.height) < SMALL_PX).then_some(Doubt::Small));
    doubts.extend(law.is_none().then_some(Doubt::NoRoughness));
    doubts.extend((noise >= MOST_NOISE).then_some(Doubt::Noisy));
    doubts
}

fn zero_to_one(heights: &Raster) -> Raster {
    let (low, high) = heights.range();
    heights.map(|z| if high > low { (z - low) / (high - low) } else { 0.5 })
}

fn deviation(raster: &Raster) -> f64 {
    let mean = raster.mean();
    let sum: f64 = raster.values.iter().map(|v| (v - mean).powi(2)).sum();
    (sum / raster.values.len().max(1) as f64).sqrt()
}
