//! From a photograph to a surface that can be touched.
//!
//! ```text
//! photo → lattice, primitive → symmetric part ─→ heights ──────────→ displacement
//!                           └─ residual ──────→ local dimension D → R = (D − 2.25)/0.75 → roughness
//! ```
//! Source: document 004, the chain of chapters 6 (roughness), 7 (symmetry) and 8 (heights). Nothing in it
//! is tuned by hand:
//!
//! | step | here |
//! |---|---|
//! | lattice, or none | [`crate::symmetry`]; averaged in its wallpaper group's fundamental domain |
//! | heights | [`crate::shape_from_shading`]: the light given, or found, or dark is deep |
//! | D map | [`crate::fractal_dimension`], windows of [`DIMENSION_WINDOW_PX`] |
//!
//! Without a lattice nothing is averaged: the whole picture is the primitive, heights and D are taken from it. They are
//! also taken from the whole picture when the pattern wanders off its lattice, as scales on a bent skin do: then the mean of
//! all cells is a blur ([`Repetition::wanders`]).
//! Brightness has no size: a texel is [`TEXEL_M`] wide unless told. The document's users preferred heights
//! twice as large as computed; [`PhotoOptions::exaggeration`] is 1, 2 or 4 there.

use crate::borders::{Borders, SplitBorders};
use crate::fft2::{Fft2, angular_frequency};
use crate::fractal_dimension::{self, DimensionError, local_map};
use crate::light::Light;
use crate::raster::Raster;
use crate::shape_from_shading::{Method, Shape, shape_by, shape_from_shading};
use crate::symmetry::{self, Lattice, WallpaperGroup};
use asperity_dsp::DesignError;
use std::f64::consts::TAU;

/// Size of a texel when nobody says: 40 mm over 256 texels (document 002, document 004 §8.3: 40 mm).
pub const TEXEL_M: f64 = 0.04 / 256.0;
/// Window of the local dimension, texels. Source: the note of `fractal_dimension`: error 0.02.
pub const DIMENSION_WINDOW_PX: usize = 64;
/// Texels between two windows.
const DIMENSION_STRIDE_PX: usize = 8;
/// Wavelength at which the engine's micro-noise is calibrated, m.
const MICRO_WAVELENGTH_M: f64 = 1e-3;
/// [`symmetry::steadiness`] below which the mean cell is not used. Source: ours; at least 0.95 for strict patterns of the tests
/// and photographs, 0.08 for the skin among the photographs.
const STEADY: f64 = 0.7;
/// Largest micro-noise that is written, m: sandpaper.
const LARGEST_MICRO_RELIEF_M: f64 = 1e-4;

/// What is known about a photograph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhotoOptions {
    /// Where the light was; `None`: find out.
    pub light: Option<Light>,
    /// How heights are found; `None`: by what the light allows.
    pub method: Option<Method>,
    /// Size of a texel, m.
    pub texel_m: f64,
    /// Height from the lowest to the highest point, m; `None`: what shading and texel size give.
    pub relief_m: Option<f64>,
    /// Factor on the heights.
    pub exaggeration: f64,
}

impl Default for PhotoOptions {
    fn default() -> Self {
        Self { light: None, method: None, texel_m: TEXEL_M, relief_m: None, exaggeration: 1.0 }
    }
}

/// What repeats in the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Repetition {
    /// Its translations.
    pub lattice: Lattice,
    /// Its symmetries.
    pub group: WallpaperGroup,
    /// How much of the picture's variance repeats, 0–1.
    pub share: f64,
    /// Whether the pattern drifts off its lattice, so that its mean cell is a blur: heights and roughness are then those of
    /// the whole picture.
    pub wanders: bool,
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
    /// Dimension of the residual, or of the picture where nothing repeats; `None` when that is flat.
    pub dimension: Option<f64>,
    /// What repeats; `None` when nothing does.
    pub repetition: Option<Repetition>,
    /// The averaged cell in lattice coordinates, or the picture.
    pub primitive: Raster,
    /// The cell repeated, or the picture.
    pub symmetric: Raster,
    /// What does not repeat; nothing where nothing does.
    pub residual: Raster,
    /// How the heights were found.
    pub shape: Shape,
    /// Whether the picture tiles.
    pub tileable: bool,
}

/// Makes a surface of a photograph: grey values 0–1 as stored (sRGB). `progress` is told the fraction done.
///
/// # Errors
/// When the picture is smaller than 16 × 16, holds numbers that are not finite, or an option is outside
/// its range.
pub fn surface_from_photo(
    picture: &Raster,
    options: &PhotoOptions,
    mut progress: impl FnMut(f64),
) -> Result<PhotoSurface, DesignError> {
    check(picture, options)?;
    let (repetition, parts) = take_apart(picture);
    progress(0.3);
    let averaged = repetition.as_ref().is_some_and(|found| !found.wanders);
    let (shaped, textured) = if averaged { (&parts.symmetric, &parts.residual) } else { (picture, picture) };
    let shape = heights_of(shaped, options, |done| progress(0.3 + 0.6 * done))?;
    let (roughness, dimension) = roughness_of(textured);
    let (low, high) = shape.height_px.range();
    let natural_m = (high - low) * options.texel_m * options.exaggeration;
    let relief_m = options.relief_m.map_or(natural_m, |relief| relief * options.exaggeration);
    let displacement = shape.height_px.map(|z| if high > low { (z - low) / (high - low) } else { 0.5 });
    let metres_per_grey = relief_m * deviation(&displacement) / deviation(shaped).max(1e-9);
    let micro = octave_at_1_mm(textured, options.texel_m, dimension) * metres_per_grey;
    progress(1.0);
    Ok(PhotoSurface {
        displacement,
        relief_m,
        roughness,
        micro_relief_m: micro.min(LARGEST_MICRO_RELIEF_M),
        dimension,
        repetition,
        primitive: parts.primitive,
        symmetric: parts.symmetric,
        residual: parts.residual,
        shape,
        tileable: Borders::Detect.decide(picture) == Borders::Periodic,
    })
}

fn check(picture: &Raster, options: &PhotoOptions) -> Result<(), DesignError> {
    let smaller = picture.width.min(picture.height) as f64;
    DesignError::check("photo side", smaller, "at least 16 texels", |n| n >= 16.0)?;
    if let Some(&value) = picture.values.iter().find(|v| !v.is_finite()) {
        return Err(DesignError { field: "photo", value, expected: "finite at every texel" });
    }
    DesignError::check("texel_m", options.texel_m, "above 0 m and at most 1 m", |t| t > 0.0 && t <= 1.0)?;
    let range = "above 0 and at most 100";
    DesignError::check("exaggeration", options.exaggeration, range, |e| e > 0.0 && e <= 100.0)?;
    if let Some(relief_m) = options.relief_m {
        DesignError::check("relief_m", relief_m, "above 0 m and at most 1 m", |r| r > 0.0 && r <= 1.0)?;
    }
    Ok(())
}

/// Primitive, symmetric part and residual, and what repeats.
fn take_apart(picture: &Raster) -> (Option<Repetition>, symmetry::Separation) {
    let Some(lattice) = symmetry::find_lattice(picture) else {
        let whole = symmetry::Separation {
            primitive: picture.clone(),
            symmetric: picture.clone(),
            residual: Raster::constant(picture.width, picture.height, 0.0),
        };
        return (None, whole);
    };
    let averaged = symmetry::averaged_cell(picture, &lattice);
    let found = symmetry::wallpaper_group(&averaged, &lattice);
    let parts = symmetry::with_cell(picture, &lattice, &found.cell);
    let share = (deviation(&parts.symmetric) / deviation(picture).max(1e-12)).powi(2).min(1.0);
    let wanders = symmetry::steadiness(picture, &lattice, &averaged) < STEADY;
    (Some(Repetition { lattice, group: found.group, share, wanders }), parts)
}

fn heights_of(
    picture: &Raster,
    options: &PhotoOptions,
    progress: impl FnMut(f64),
) -> Result<Shape, DesignError> {
    // Dark is deep works on what the eye sees, shading on the light that fell.
    match options.method {
        Some(Method::DarkIsDeep) => shape_by(Method::DarkIsDeep, picture, Light::OVERHEAD, progress),
        Some(method) => {
            let linear = picture.map(linear_light);
            let found = options.light.or_else(|| crate::light::estimate_light(&linear));
            shape_by(method, &linear, found.unwrap_or(Light::ABOVE_LEFT), progress)
        }
        None => {
            let linear = picture.map(linear_light);
            let shape = shape_from_shading(&linear, options.light, progress)?;
            if shape.method == Method::DarkIsDeep {
                return shape_by(Method::DarkIsDeep, picture, Light::OVERHEAD, |_| {});
            }
            Ok(shape)
        }
    }
}

/// Linear light of an sRGB value (IEC 61966-2-1).
#[must_use]
pub fn linear_light(stored: f64) -> f64 {
    if stored <= 0.040_45 { stored / 12.92 } else { ((stored + 0.055) / 1.055).powf(2.4) }
}

/// The roughness map, as large as the picture, and the dimension of the whole.
fn roughness_of(textured: &Raster) -> (Raster, Option<f64>) {
    let smaller = textured.width.min(textured.height);
    let window = DIMENSION_WINDOW_PX.min(smaller / 2).max(8);
    let measured = local_map(textured, window, DIMENSION_STRIDE_PX)
        .and_then(|local| Ok((local, fractal_dimension::transects(textured)?.dimension)));
    match measured {
        Ok((local, dimension)) => {
            let coarse = local.roughness();
            let stride = local.stride as f64;
            let full = Raster::from_fn(textured.width, textured.height, |x, y| {
                let at = |texel: usize| (texel as f64 + 0.5) / stride - 0.5;
                between(&coarse, at(x), at(y))
            });
            (full, Some(dimension))
        }
        // A flat residual is smooth; the other refusals are checked for above.
        Err(DimensionError::Flat | DimensionError::TooSmall { .. } | DimensionError::NotFinite { .. }) => {
            (Raster::constant(textured.width, textured.height, 0.0), None)
        }
    }
}

/// Bilinear interpolation, constant beyond the border.
fn between(raster: &Raster, x: f64, y: f64) -> f64 {
    let split = |at: f64, n: usize| {
        let at = at.clamp(0.0, (n - 1) as f64);
        let low = at as usize;
        (low, (low + 1).min(n - 1), at - low as f64)
    };
    let (x0, x1, ax) = split(x, raster.width);
    let (y0, y1, ay) = split(y, raster.height);
    let row = |y: usize| (1.0 - ax) * raster.at(x0, y) + ax * raster.at(x1, y);
    (1.0 - ay) * row(y0) + ay * row(y1)
}

fn deviation(raster: &Raster) -> f64 {
    let mean = raster.mean();
    let sum: f64 = raster.values.iter().map(|v| (v - mean).powi(2)).sum();
    (sum / raster.values.len().max(1) as f64).sqrt()
}

/// Rms of the picture in the octave around 1 mm, in its own unit. Where texels are too coarse for that
/// octave or the picture too small, the nearest octave it has, carried over by λ^H.
fn octave_at_1_mm(picture: &Raster, texel_m: f64, dimension: Option<f64>) -> f64 {
    let (w, h) = (picture.width, picture.height);
    let shortest_m = 4.0 * texel_m;
    let longest_m = (w.min(h) as f64 / 4.0 * texel_m).max(shortest_m);
    let wavelength_m = MICRO_WAVELENGTH_M.clamp(shortest_m, longest_m);
    let periodic = SplitBorders::of(picture, Borders::Detect).periodic;
    let spectrum = Fft2::new(w, h).spectrum(&periodic.values);
    let (low, high) = (wavelength_m / std::f64::consts::SQRT_2, wavelength_m * std::f64::consts::SQRT_2);
    let mut power = 0.0;
    for (place, value) in spectrum.iter().enumerate().skip(1) {
        let r = angular_frequency(place / h, w).hypot(angular_frequency(place % h, h));
        let length_m = TAU / r * texel_m;
        if (low..high).contains(&length_m) {
            power += value.norm_sqr();
        }
    }
    let rms = power.sqrt() / (w * h) as f64;
    let hurst = dimension.map_or(0.5, fractal_dimension::hurst);
    rms * (MICRO_WAVELENGTH_M / wavelength_m).powf(hurst)
}
