//! Acoustic surfaces → micro-relief and heights.
//!
//! ```text
//! draft: spectrum ∝ k^p beyond 1/ℓ, flat below, down to ℓ/16, rms σ
//! ours:  a(λ) = m · 10^(0.75 (R − 1)) (λ/1 mm)^((α − 1)/2) (1 + (λ/L)²)^(−α/4)      α = 2.5 − 1.5 R
//! so     R = (2.5 + p)/1.5 within 0–1,  L = ℓ,  m such that Σ over octaves of a² = σ²
//! ```

use crate::error::CliError;
use asperity_dsp::fractal_noise::{FractalNoise, growth};
use asperity_pictures::normal_map::{Green, NormalMapOptions, heights_from_normals};
use asperity_shape::gltf::Document;
use asperity_surface::image_io::decode_photograph;
use asperity_surface::picture::Channel;
use asperity_surface::raster::Raster;
use serde_json::Value;
use std::io::Cursor;

/// Micro-relief of a surface in our terms.
pub struct Finish {
    pub roughness: f64,
    pub micro_relief_m: f64,
    pub outer_scale_m: f64,
}

/// Reads σ, ℓ and p, each with the draft's default.
pub fn finish(document: &Document, surface: &Value, at: &str) -> Result<Finish, CliError> {
    let number = |key: &str, default: f64, low: f64, high: f64| -> Result<f64, CliError> {
        let value = surface[key].as_f64().unwrap_or(default);
        let inside = value.is_finite()
            && value > low
            && value <= high
            && (surface[key].is_null() || surface[key].is_number());
        let right = format!("must be a number above {low}, to {high}");
        if inside {
            Ok(value)
        } else {
            let what = format!("{} is refused", surface[key]);
            Err(document.wrong(format!("{at}.{key}"), what, &right).into())
        }
    };
    let sigma_m = number("roughness", 2e-6, 0.0, 0.01)?;
    let length_m = number("correlationLength", 5e-5, 0.0, 1.0)?;
    let slope = number("spectralSlope", -2.4, -10.0, 0.0)?;
    let shortest_m = number("shortWavelength", length_m / 16.0, 0.0, 1.0)?.min(length_m);
    let roughness = FractalNoise::roughness(-slope);
    let (alpha, outer_scale_m) = (FractalNoise::alpha(roughness), length_m.clamp(1e-5, 1.0));
    let rms = |wave_m: f64| {
        growth(roughness)
            * (wave_m / 1e-3).powf(0.5 * (alpha - 1.0))
            * (1.0 + (wave_m / outer_scale_m).powi(2)).powf(-0.25 * alpha)
    };
    let octaves =
        std::iter::successors(Some(shortest_m * std::f64::consts::SQRT_2), |wave_m| Some(2.0 * wave_m));
    let power: f64 =
        octaves.take_while(|wave_m| *wave_m < 64.0 * length_m).map(|wave_m| rms(wave_m).powi(2)).sum();
    let micro_relief_m = if power > 0.0 { (sigma_m / power.sqrt()).min(0.01) } else { 0.0 };
    Ok(Finish { roughness, micro_relief_m, outer_scale_m })
}

/// Heights of a normal texture: a 16-bit picture's greys, and white over black in metres.
pub struct Heights {
    pub width: usize,
    pub height: usize,
    pub grey: Vec<u16>,
    pub relief_m: f64,
}

/// Solves a normal texture that spans `extent_m` for heights; its `scale` multiplies its slopes.
/// Green points up the image, as glTF says.
pub fn heights(
    document: &Document,
    texture: &Value,
    extent_m: [f64; 2],
    at: &str,
) -> Result<Heights, CliError> {
    let picture = document.picture(&texture["index"], at)?;
    let wrong = |what: String| document.wrong(at, what, "must be a normal map as PNG or JPEG");
    let read = decode_photograph(Cursor::new(picture)).and_then(|picture| {
        let channel = |channel| picture.channel(channel).map(|found| found.raster.values);
        Ok((picture.size(), channel(Channel::R)?, channel(Channel::G)?, channel(Channel::B)?))
    });
    let ([width, height], red, green, blue) = read.map_err(|error| wrong(error.to_string()))?;
    let texel_m = [extent_m[0] / width.max(1) as f64, extent_m[1] / height.max(1) as f64];
    let higher = texel_m[1] / texel_m[0];
    let normals = (0..red.len()).map(|at| {
        let rgb = [red[at], green[at], blue[at]];
        if (higher - 1.0).abs() > 0.01 { stretched(rgb, higher) } else { rgb }
    });
    let normals: Vec<[f64; 3]> = normals.collect();
    let channel = |k: usize| Raster { width, height, values: normals.iter().map(|n| n[k]).collect() };
    let options = NormalMapOptions { green: Green::OpenGl, ..NormalMapOptions::default() };
    let found = heights_from_normals(&channel(0), &channel(1), &channel(2), &options)
        .map_err(|error| wrong(error.to_string()))?;
    let (low, high) = found.height_px.range();
    let scale = texture["scale"].as_f64().filter(|s| s.is_finite()).unwrap_or(1.0);
    let relief = high - low;
    let up = scale >= 0.0;
    let part = |z: f64| if relief > 0.0 { (z - low) / relief } else { 0.5 };
    let grey = |z: &f64| ((if up { part(*z) } else { 1.0 - part(*z) }) * 65_535.0).round() as u16;
    let grey = found.height_px.values.iter().map(grey).collect();
    Ok(Heights { width, height, grey, relief_m: relief * scale.abs() * texel_m[0] })
}

/// A normal where texels are `higher` times as high as wide: slopes along v count that much more a
/// texel.
fn stretched(rgb: [f64; 3], higher: f64) -> [f64; 3] {
    let [x, y, z] = rgb.map(|c| 2.0 * c - 1.0);
    // Maps of two channels leave blue empty.
    let z = if z > 0.05 { z } else { (1.0 - x * x - y * y).max(0.0025).sqrt() };
    let y = y * higher;
    let length = (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|c| 0.5 + 0.5 * c / length)
}
