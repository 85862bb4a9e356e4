//! Strokes over measured and made ground, and what their spectra tell.
#![allow(dead_code)]

use super::{SIDE_M, render, stroke};
use asperity::offline::{Options, Render};
use asperity::{ActuatorSettings, Config, Quantity, Surface, Wrap, probe_by_name};
use asperity_evidence::corpus::corpus;
use asperity_evidence::exact_brownian::ExactBrownian;
use asperity_evidence::spectrum;
use asperity_surface::height_map::{Extent, HeightMap};
use asperity_surface::image_io::{self, Channel};
use asperity_surface::raster::Raster;

/// A map of the corpus, repeated on a square of [`SIDE_M`].
pub fn map(name: &str, relief_m: f64) -> Option<Surface> {
    let file = corpus(&format!("textures/{name}"))?;
    let raster = image_io::load_channel(file, Channel::Luma).unwrap().debanded(Wrap::Repeat);
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m };
    Some(Surface::new(HeightMap::new(&raster, extent, Wrap::Repeat).unwrap(), SIDE_M, SIDE_M).unwrap())
}

/// A stroke of a second along u with a probe preset.
pub fn take(probe: &str, surface: Surface, speed_m_s: f64, force_n: f64, output: Quantity) -> Render {
    take_over(SIDE_M, probe, surface, (speed_m_s, force_n), output)
}

/// The same on a surface of another width, m: uv counts in its widths.
pub fn take_over(
    width_m: f64,
    probe: &str,
    surface: Surface,
    (speed_m_s, force_n): (f64, f64),
    output: Quantity,
) -> Render {
    let actuators = vec![ActuatorSettings { full_scale: 1.0, output, ..ActuatorSettings::default() }];
    let config = Config { probe: probe_by_name(probe).unwrap(), actuators, ..Config::default() };
    let log = stroke(width_m, speed_m_s, force_n, 1.0);
    render(config, surface, &log, &Options { tail_s: 0.0, ..Options::default() })
}

/// Power spectrum after the first 0.2 s: from Hz to power a bin.
pub fn power(x: &[f32], rate_hz: f64) -> (Vec<f64>, f64) {
    const LENGTH: usize = 8192;
    let from = (0.2 * rate_hz) as usize;
    (spectrum::power_spectrum(&x[from..], LENGTH), rate_hz / LENGTH as f64)
}

/// Rms and centroid between two frequencies.
pub fn rms_and_centroid((power, bin_hz): &(Vec<f64>, f64), from_hz: f64, to_hz: f64) -> (f64, f64) {
    let inside = || power.iter().enumerate().map(|(i, p)| (i as f64 * bin_hz, p));
    let inside = || inside().filter(|(f, _)| (from_hz..=to_hz).contains(f));
    let sum: f64 = inside().map(|(_, p)| p).sum();
    (sum.sqrt(), inside().map(|(f, p)| f * p).sum::<f64>() / sum)
}

/// Levels of third octaves from `from_hz` on.
pub fn third_octaves_db((power, bin_hz): &(Vec<f64>, f64), from_hz: f64, count: i32) -> Vec<f64> {
    (0..count)
        .map(|band| {
            let centre_hz = from_hz * 2f64.powf(f64::from(band) / 3.0);
            let edges = [-1.0, 1.0].map(|side: f64| centre_hz * 2f64.powf(side / 6.0));
            let inside = |i: &usize| (edges[0]..edges[1]).contains(&(*i as f64 * bin_hz));
            10.0 * (0..power.len()).filter(inside).map(|i| power[i]).sum::<f64>().max(1e-30).log10()
        })
        .collect()
}

/// Exponents a, b of y ∝ v^a F^b over a whole grid, by least squares.
pub fn exponents(y: &[Vec<f64>], speeds: &[f64], forces: &[f64]) -> (f64, f64) {
    let mean = |x: &[f64]| x.iter().map(|x| x.ln()).sum::<f64>() / x.len() as f64;
    let (v0, f0) = (mean(speeds), mean(forces));
    let (mut vy, mut vv, mut fy, mut ff) = (0.0, 0.0, 0.0, 0.0);
    for (row, v) in y.iter().zip(speeds) {
        for (y, f) in row.iter().zip(forces) {
            let (v, f, y) = (v.ln() - v0, f.ln() - f0, y.ln());
            (vy, vv, fy, ff) = (vy + v * y, vv + v * v, fy + f * y, ff + f * f);
        }
    }
    (vy / vv, fy / ff)
}

/// Heights of a Brownian surface of 1 m rms.
pub fn brownian(hurst: f64) -> Raster {
    const SIDE: usize = 512;
    let [values, _] = ExactBrownian::new(SIDE, hurst).pair(7);
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let rms = (values.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
    Raster { width: SIDE, height: SIDE, values: values.iter().map(|h| (h - mean) / rms).collect() }
}

/// Heights in units of `relief_m`.
pub fn relief(raster: &Raster, relief_m: f64) -> Surface {
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m };
    Surface::new(HeightMap::new(raster, extent, Wrap::Mirror).unwrap(), SIDE_M, SIDE_M).unwrap()
}
