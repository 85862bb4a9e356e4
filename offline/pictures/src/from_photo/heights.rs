//! Heights of a picture by what its light allows, and why another way was taken.

use super::options::PhotoOptions;
use super::sign::Sign;
use crate::darkness_prior::high_pass;
use crate::fft2::{Fft2, angular_frequency};
use crate::light::{Light, estimate_light};
use crate::shape_from_shading::{LEAST_SLANT_RAD, Method, STEPS, Shape, shape_by};
use asperity_dsp::DesignError;
use asperity_surface::raster::Raster;

/// Contrast of linear light over contrast of stored values (sRGB is nearly a power of 1/2.2).
const GAMMA: f64 = 2.2;
/// Mean below which a picture's contrast is not raised further, of white: there it is the camera's.
const DARKEST_MEAN: f64 = 0.05;
/// Mean of stored values at which a step of brightness counts as its share of the mean. Source:
/// ours: a well exposed picture.
const USUAL_MEAN: f64 = 0.4;
/// Relief over the shorter side from which a found light is not believed. Source: ours; the map
/// sets stay below 0.08.
const MOST_RELIEF: f64 = 0.1;
/// Largest unexplained part of the image under a found light, over its standard deviation.
const MOST_UNEXPLAINED: f64 = 0.7;

/// Why heights were not found as the light seemed to allow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fallback {
    /// The given light comes from the viewer's direction, and there is no flat ground; its slant,
    /// radians.
    FrontalLight(f64),
    /// A light was found, but the relief it gives is this large over the shorter side.
    Implausible(f64),
    /// A light was found, but its shading leaves this share of the picture unexplained.
    Unexplained(f64),
}

impl std::fmt::Display for Fallback {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::FrontalLight(slant) => write!(
                f,
                "the light is {:.0}° from the viewer's direction, where shading shows no direction (below {:.0}°), and the picture shows no flat ground to begin from: heights are by dark is deep",
                slant.to_degrees(),
                LEAST_SLANT_RAD.to_degrees()
            ),
            Self::Implausible(relief) => write!(
                f,
                "the picture seems lit from a side, but that would make a relief of {relief:.2} of its side: heights are by dark is deep"
            ),
            Self::Unexplained(share) => write!(
                f,
                "the picture seems lit from a side, but that leaves {share:.2} of it unexplained: heights are by dark is deep"
            ),
        }
    }
}

/// Heights and how they came about.
#[derive(Debug)]
pub(super) struct Found {
    pub shape: Shape,
    pub sign: Sign,
    pub light_was_found: bool,
    pub fallback: Option<Fallback>,
}

/// Heights of a picture of stored values; which way up they are is asked of the `whole` photograph,
/// because a mean cell has its pattern's skewness and no shadows.
pub(super) fn heights_of(
    picture: &Raster,
    whole: &Raster,
    options: &PhotoOptions,
    progress: impl FnMut(f64),
) -> Result<Found, DesignError> {
    let mut found = match (options.method, options.light) {
        (Some(Method::DarkIsDeep), _) => by_brightness(picture, whole, None)?,
        (Some(Method::FlatGround), _) => {
            let linear = picture.map(linear_light);
            above_the_ground(shape_by(Method::FlatGround, &linear, Light::OVERHEAD, |_| {})?)
        }
        (Some(method), asked) => {
            let linear = picture.map(linear_light);
            let estimated = if asked.is_none() { estimate_light(&linear) } else { None };
            let light = asked.or(estimated).unwrap_or(Light::ABOVE_LEFT);
            by_shading(&linear, method, light, asked.is_some(), estimated.is_some(), progress)?
        }
        (None, Some(asked)) if asked.slant_rad() < LEAST_SLANT_RAD => {
            match shape_by(Method::FlatGround, &picture.map(linear_light), asked, |_| {}) {
                Ok(shape) => above_the_ground(shape),
                Err(_) => by_brightness(picture, whole, Some(Fallback::FrontalLight(asked.slant_rad())))?,
            }
        }
        (None, Some(asked)) => {
            let linear = picture.map(linear_light);
            by_shading(&linear, Method::Integrable(STEPS), asked, true, false, progress)?
        }
        (None, None) => by_what_is_found(picture, whole, progress)?,
    };
    if options.bright_is_deep {
        found.shape.height_px = found.shape.height_px.map(|z| -z);
        found.sign = Sign::given(true);
    }
    Ok(found)
}

/// With the light in the picture, if there is one and it makes sense.
fn by_what_is_found(
    picture: &Raster,
    whole: &Raster,
    progress: impl FnMut(f64),
) -> Result<Found, DesignError> {
    let linear = picture.map(linear_light);
    let Some(light) = estimate_light(&linear) else {
        drop(linear);
        return by_brightness(picture, whole, None);
    };
    let found = by_shading(&linear, Method::Integrable(STEPS), light, false, true, progress)?;
    let (low, high) = found.shape.height_px.range();
    let relief = (high - low) / picture.width.min(picture.height) as f64;
    let unexplained = found.shape.unexplained.unwrap_or(0.0);
    let fallback = if relief > MOST_RELIEF {
        Fallback::Implausible(relief)
    } else if unexplained > MOST_UNEXPLAINED {
        Fallback::Unexplained(unexplained)
    } else {
        return Ok(found);
    };
    drop((linear, found));
    by_brightness(picture, whole, Some(fallback))
}

fn by_brightness(picture: &Raster, whole: &Raster, fallback: Option<Fallback>) -> Result<Found, DesignError> {
    let shape = shape_by(Method::DarkIsDeep, &contrast(picture), Light::OVERHEAD, |_| {})?;
    Ok(Found { shape, sign: Sign::of_brightness(whole), light_was_found: false, fallback })
}

/// Choice of relief that stands out of its ground: frontal light cannot say; out of it is custom.
fn above_the_ground(shape: Shape) -> Found {
    Found { shape, sign: Sign::of_found_light(), light_was_found: false, fallback: None }
}

fn by_shading(
    linear: &Raster,
    method: Method,
    light: Light,
    asked: bool,
    light_was_found: bool,
    progress: impl FnMut(f64),
) -> Result<Found, DesignError> {
    let mut shape = shape_by(method, linear, light, progress)?;
    shape.height_px = without_streaks(&shape.height_px, light);
    let sign = if asked { Sign::given(false) } else { Sign::of_found_light() };
    Ok(Found { shape, sign, light_was_found, fallback: None })
}

/// Brightness as the light that fell, mean 1: proportional to the contrast of stored values.
///
/// A step over the mean would be right for a matt surface. Gloss adds as much light to a dark
/// surface as to a bright one, so steps on dark surfaces are divided by the geometric mean of
/// theirs and a usual mean: on 15 public map sets the levels are then 4.4 dB off (median; 5.1 by
/// the mean alone) and rank with the mapped ones at 0.31–0.55 (0.16–0.58; undivided 0.17–0.29).
pub(super) fn contrast(picture: &Raster) -> Raster {
    let mean = picture.mean();
    let gain = GAMMA / (mean.max(DARKEST_MEAN) * USUAL_MEAN).sqrt();
    picture.map(|v| 1.0 + gain * (v - mean))
}

/// Heights without what is longer, along the light, than a quarter of the picture. Shading shows
/// slopes along the light only; across it, and over long ways, its integral is noise: streaks and
/// domes.
fn without_streaks(heights: &Raster, light: Light) -> Raster {
    let (w, h) = (heights.width, heights.height);
    let [sx, sy, _] = light.direction();
    let tilt = sx.hypot(sy).max(1e-12);
    let mut fft = Fft2::new(w, h);
    let mut spectrum = fft.spectrum(&heights.values);
    for (place, value) in spectrum.iter_mut().enumerate() {
        let (wx, wy) = (angular_frequency(place / h, w), angular_frequency(place % h, h));
        *value *= high_pass((wx * sx + wy * sy) / tilt, w, h);
    }
    fft.image(&mut spectrum)
}

/// Linear light of an sRGB value (IEC 61966-2-1).
#[must_use]
pub fn linear_light(stored: f64) -> f64 {
    if stored <= 0.040_45 { stored / 12.92 } else { ((stored + 0.055) / 1.055).powf(2.4) }
}
