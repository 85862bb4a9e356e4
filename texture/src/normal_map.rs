//! Heights from a normal map.
//!
//! ```text
//! n = 2 (r, g, b) − 1        dz/du = −n_x / n_z        dz/dv = ±n_y / n_z
//! ```
//! with + for OpenGL maps (green brightens towards a slope facing up the image) and − for DirectX maps;
//! v grows downwards. The slopes are integrated by [`crate::gradient_field`].
//!
//! What a map does not say is read from it by asking which answer makes it the normals of a surface:
//! the convention of its green channel, and which differences of texels it was made with. Corrugations and waves as long along u as
//! along v are the same map whatever made them, up to the waves' heights: there [`Derivative::ExactOrCentral`] is taken and said
//! to be uncertain. Over a wave of ω radians a texel it errs by (ω − sin ω)/(ω + sin ω) in both cases, 0.32 % at 32 texels,
//! and no method can do better in the worse one. Told which, waves of 11 to 26 texels come out within 0.5 %.
//!
//! 8-bit maps round each component of a normal to 1/127.5: a slope's variance from that is
//! ```text
//! σ² (1 + p² + q²) ((1 + p²)² + 2 p² q² + (1 + q²)²)/2        σ² = (1/127.5)²/12, p and q the slopes
//! ```
//! and [`integrate_rounded`] takes no more height from the slopes than that leaves. They have no number for 0 (127.5),
//! so that a flat map tilts by 0.4 %: the mean slope of a map that tiles is
//! dropped, and of one that does not, too, unless [`NormalMapOptions::keep_tilt`]. What is flat in a map comes out at the step next to 0:
//! where that step stands out of the others, its texels are taken for what they are on average.

mod next_to_zero;

use crate::borders::{Borders, SplitBorders};
use crate::gradient_field::{
    Derivative, Slopes, curl, integrate_open_rounded, integrate_periodic, integrate_rounded,
    possible_derivatives, possible_derivatives_inside,
};
use crate::raster::Raster;
use asperity_dsp::DesignError;
use next_to_zero::NextToZero;

/// Steepest slope that is believed (84°); beyond it 8 bits say nothing.
const STEEPEST: f64 = 10.0;
/// A green convention is only decided when its curl is at most this fraction of the other's.
const DECIDED: f64 = 0.8;
/// Numbers of steps from 0 to 1 that image files round to.
const STEPS: [f64; 2] = [255.0, 65_535.0];

/// Which way green points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Green {
    /// The one that makes the map integrable; OpenGL when it makes no difference.
    #[default]
    Detect,
    /// Up the image.
    OpenGl,
    /// Down the image.
    DirectX,
}

/// What is known about a normal map.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NormalMapOptions {
    /// Which way green points.
    pub green: Green,
    /// How its slopes were taken from heights; `None`: find out.
    pub derivative: Option<Derivative>,
    /// Whether it tiles.
    pub borders: Borders,
    /// Keep the mean slope of a map that does not tile.
    pub keep_tilt: bool,
}

/// The surface of a normal map.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalMapHeights {
    /// Heights in texels (multiply by the size of a texel), mean 0.
    pub height_px: Raster,
    /// Which way green points.
    pub green: Green,
    /// Whether the map says so: false when both conventions fit alike.
    pub green_is_certain: bool,
    /// How its slopes were taken.
    pub derivative: Derivative,
    /// Whether it was told or the map says so: false when several fit alike.
    pub derivative_is_certain: bool,
    /// Whether it tiles.
    pub tileable: bool,
    /// What is not integrable in it, 0–1 of the power of its slopes' derivatives.
    pub curl: f64,
}

/// The surface whose normals are nearest to the map's.
///
/// # Errors
/// When the three channels are not equally large or smaller than 4 × 4, or hold numbers outside 0–1.
pub fn heights_from_normals(
    red: &Raster,
    green: &Raster,
    blue: &Raster,
    options: &NormalMapOptions,
) -> Result<NormalMapHeights, DesignError> {
    check([red, green, blue])?;
    let steps = rounding_steps([red, green, blue]);
    let mut field = slopes_of_normals(red, green, blue, steps);
    let borders = borders_of(&field, options.borders);
    let (way, green_is_certain) = which_green(&field, borders, options.green);
    if way == Green::DirectX {
        field.along_v.values.iter_mut().for_each(|q| *q = -*q);
    }
    let (derivative, derivative_is_certain) = which_derivative(&field, borders, options.derivative);
    let tileable = borders == Borders::Periodic;
    if tileable || !options.keep_tilt {
        for slope in [&mut field.along_u, &mut field.along_v] {
            let mean = slope.mean();
            slope.values.iter_mut().for_each(|v| *v -= mean);
        }
    }
    let noise = steps.map(|steps| rounding_noise(&field, 2.0 / steps));
    let height_px = match noise {
        Some(noise) if tileable => integrate_rounded(&field, derivative, noise),
        None if tileable => integrate_periodic(&field, derivative),
        _ => integrate_open_rounded(&field, derivative, noise.unwrap_or(f64::INFINITY)),
    };
    let curl = curl_of(&field, borders, derivative);
    Ok(NormalMapHeights {
        height_px,
        green: way,
        green_is_certain,
        derivative,
        derivative_is_certain,
        tileable,
        curl,
    })
}

fn check(channels: [&Raster; 3]) -> Result<(), DesignError> {
    let first = channels[0];
    let smaller = first.width.min(first.height) as f64;
    DesignError::check("normal map side", smaller, "at least 4 texels", |n| n >= 4.0)?;
    for channel in channels {
        if (channel.width, channel.height) != (first.width, first.height) {
            let expected = "as wide and high as the red channel";
            return Err(DesignError { field: "channel width", value: channel.width as f64, expected });
        }
        if let Some(&value) = channel.values.iter().find(|v| !(0.0..=1.0).contains(*v)) {
            return Err(DesignError { field: "normal map", value, expected: "within 0 to 1" });
        }
    }
    Ok(())
}

/// Slopes with green taken as OpenGL's.
fn slopes_of_normals(red: &Raster, green: &Raster, blue: &Raster, steps: Option<f64>) -> Slopes {
    let (w, h) = (red.width, red.height);
    let (mut along_u, mut along_v) = (Raster::constant(w, h, 0.0), Raster::constant(w, h, 0.0));
    let [centre_x, centre_y] = [red, green].map(|c| steps.map(|steps| NextToZero::of(c, steps)));
    for i in 0..w * h {
        let [x, y, z] = [red, green, blue].map(|c| 2.0 * c.values[i] - 1.0);
        let x = centre_x.as_ref().map_or(x, |c| c.value(x));
        let y = centre_y.as_ref().map_or(y, |c| c.value(y));
        let flat = x * x + y * y;
        let length = (flat + z * z).sqrt();
        // Gentle slopes: the other two channels tell n_z better than blue does. Steep ones: blue,
        // unless the map has two channels only and blue does not make a unit vector.
        let up = if flat < 0.5 || (length - 1.0).abs() > 0.1 { (1.0 - flat).max(0.0).sqrt() } else { z };
        let up = up.max(flat.sqrt() / STEEPEST).max(1e-9);
        along_u.values[i] = -x / up;
        along_v.values[i] = y / up;
    }
    Slopes { along_u, along_v }
}

fn borders_of(field: &Slopes, wanted: Borders) -> Borders {
    match (wanted.decide(&field.along_u), wanted.decide(&field.along_v)) {
        (Borders::Periodic, Borders::Periodic) => Borders::Periodic,
        _ => Borders::Smooth,
    }
}

/// The number of steps from 0 to 1 to which all channels were rounded; `None`: they were not.
fn rounding_steps(channels: [&Raster; 3]) -> Option<f64> {
    let rounded = |value: f64, steps: f64| (value * steps - (value * steps).round()).abs() < 1e-6 * steps;
    let all = |steps| channels.iter().all(|c| c.values.iter().all(|&v| rounded(v, steps)));
    STEPS.into_iter().find(|&steps| all(steps))
}

/// Variance of a slope whose normal was rounded, mean over the map.
fn rounding_noise(field: &Slopes, step: f64) -> f64 {
    let gain = |(&p, &q): (&f64, &f64)| {
        let (p2, q2) = (p * p, q * q);
        0.5 * (1.0 + p2 + q2) * ((1.0 + p2).powi(2) + 2.0 * p2 * q2 + (1.0 + q2).powi(2))
    };
    let gains = field.along_u.values.iter().zip(&field.along_v.values).map(gain);
    step * step / 12.0 * gains.sum::<f64>() / field.along_u.values.len() as f64
}

fn curl_of(field: &Slopes, borders: Borders, derivative: Derivative) -> f64 {
    let periodic = |slope: &Raster| SplitBorders::of(slope, borders).periodic;
    let field = Slopes { along_u: periodic(&field.along_u), along_v: periodic(&field.along_v) };
    curl(&field, derivative)
}

fn which_green(field: &Slopes, borders: Borders, wanted: Green) -> (Green, bool) {
    let mut turned = field.clone();
    turned.along_v.values.iter_mut().for_each(|q| *q = -*q);
    let up = curl_of(field, borders, Derivative::Exact);
    let down = curl_of(&turned, borders, Derivative::Exact);
    let certain = up.min(down) < DECIDED * up.max(down);
    match wanted {
        Green::Detect if certain && down < up => (Green::DirectX, true),
        Green::Detect => (Green::OpenGl, certain),
        told => (told, true),
    }
}

/// The derivative that was told, or the one that the slopes leave, or the middle of those they do not tell apart.
fn which_derivative(field: &Slopes, borders: Borders, told: Option<Derivative>) -> (Derivative, bool) {
    if let Some(derivative) = told {
        return (derivative, true);
    }
    let tiles = borders == Borders::Periodic;
    let possible = if tiles { possible_derivatives(field) } else { possible_derivatives_inside(field) };
    let both = [Derivative::Exact, Derivative::Central].iter().all(|d| possible.contains(d));
    match possible[..] {
        [only] => (only, true),
        [likeliest, ..] if !both => (likeliest, false),
        _ => (Derivative::ExactOrCentral, false),
    }
}
