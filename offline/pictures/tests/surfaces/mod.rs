//! Surfaces that the tests and benches of the offline tools share: all tile, heights 0–1.

#![allow(dead_code)] // Each test binary uses some of them.

use asperity_dsp::rng::Rng;
use asperity_pictures::fft2::{Fft2, angular_frequency};
use asperity_pictures::gradient_field::{Derivative, slopes};
use asperity_surface::raster::Raster;

/// A random surface with power spectral density ∝ r^−`beta`, stretched along u by `stretch`.
pub fn fractal(n: usize, beta: f64, stretch: f64, seed: u64) -> Raster {
    let mut rng = Rng::new(seed);
    let noise = Raster::from_fn(n, n, |_, _| rng.normal());
    let mut fft = Fft2::new(n, n);
    let mut spectrum = fft.spectrum(&noise.values);
    for (place, value) in spectrum.iter_mut().enumerate() {
        let r = (angular_frequency(place / n, n) * stretch).hypot(angular_frequency(place % n, n));
        *value *= if r > 0.0 { r.powf(-beta / 2.0) } else { 0.0 };
    }
    let image = fft.image(&mut spectrum);
    let (low, high) = image.range();
    image.map(|v| (v - low) / (high - low))
}

/// Grain: bands along u that wander.
pub fn wood(n: usize) -> Raster {
    fractal(n, 2.5, 12.0, 2).map(|v| 0.5 + 0.5 * (20.0 * v).sin())
}

/// Sharp-edged bars, 6 of every 32 texels, both ways: two heights only.
pub fn grid(n: usize) -> Raster {
    Raster::from_fn(n, n, |x, y| if x % 32 < 6 || y % 32 < 6 { 1.0 } else { 0.0 })
}

/// Ridges where a random surface crosses its middle.
pub fn ridges(n: usize) -> Raster {
    fractal(n, 3.2, 1.0, 3).map(|v| (1.0 - (2.0 * v - 1.0).abs()).powi(2))
}

/// Rough ground.
pub fn ground(n: usize) -> Raster {
    fractal(n, 3.0, 1.0, 1)
}

/// Surfaces 256 texels wide with an rms slope of about 0.3.
pub fn known_surfaces() -> Vec<(&'static str, Raster)> {
    let scaled = |surface: Raster| {
        let power = slopes(&surface, Derivative::Exact).power();
        surface.map(|z| z * 0.3 / power.sqrt())
    };
    vec![
        ("rough ground", scaled(fractal(256, 4.0, 1.0, 31))),
        ("smooth ground", scaled(fractal(256, 5.0, 1.0, 32))),
        ("wood", scaled(fractal(256, 4.0, 6.0, 33))),
        ("ridges", scaled(ridges(256))),
        (
            "bumps",
            scaled(Raster::from_fn(256, 256, |x, y| {
                let wave = |i: usize| (i as f64 * std::f64::consts::TAU / 32.0).sin();
                wave(x) * wave(y)
            })),
        ),
    ]
}

/// Correlation of two equally large rasters.
pub fn correlation(a: &Raster, b: &Raster) -> f64 {
    let (ma, mb) = (a.mean(), b.mean());
    let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
        a.values.iter().zip(&b.values).map(|(x, y)| f(x - ma, y - mb)).sum()
    };
    sum(&|x, y| x * y) / (sum(&|x, _| x * x) * sum(&|_, y| y * y)).sqrt()
}
