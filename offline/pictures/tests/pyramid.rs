//! The steerable pyramid against one written with numpy (tests/independent/pyramid.py).

use asperity_pictures::pyramid::{Pyramid, Sampling};
use asperity_surface::raster::Raster;

fn chirp(width: usize, height: usize) -> Raster {
    Raster::from_fn(width, height, |x, y| {
        let (x, y) = (x as f64, y as f64);
        (0.013 * x * x + 0.021 * y * y + 0.017 * x * y).sin() * (1.0 + 0.02 * y)
            + (-((x - 20.0).powi(2) + (y - 15.0).powi(2)) / 30.0).exp()
    })
}

fn deviation(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

/// Standard deviation of each sub-band and its value in column 11 of row 7.
const EVEN: [(f64, f64); 14] = [
    (0.735239360433, 0.004869534550),
    (0.169259037994, 0.020420971393),
    (0.565711032018, 0.094029435408),
    (0.336858083012, 0.065685828104),
    (0.058140197459, 0.007582863956),
    (0.087829892682, -0.136154005215),
    (0.245862596522, -0.599685182560),
    (0.146623709611, -0.286292533184),
    (0.039280852524, -0.004197558182),
    (0.063896867628, -0.202837235414),
    (0.108748899146, -0.524572306654),
    (0.076213568624, -0.191726188649),
    (0.045758878554, 0.074799608010),
    (0.109270113115, 0.154973219836),
];
const ODD: [(f64, f64); 14] = [
    (0.679758032894, -0.007934673755),
    (0.174530126517, 0.018003496870),
    (0.578532882806, 0.086791059084),
    (0.339494618734, 0.063279142250),
    (0.059438481791, 0.007545483839),
    (0.091194859130, -0.139650367655),
    (0.255601802262, -0.611980074769),
    (0.152507199413, -0.295891910035),
    (0.040850846267, -0.004553493428),
    (0.067085510016, -0.204122224491),
    (0.114515156534, -0.526337206918),
    (0.080111431391, -0.192276581488),
    (0.046871395336, 0.073126748533),
    (0.112200312450, 0.152434378951),
];

#[test]
fn sub_bands_agree_with_numpy_at_even_and_odd_sizes() {
    for (width, height, figures) in [(64, 48, EVEN), (63, 45, ODD)] {
        let mut pyramid = Pyramid::new(width, height, 3, 4, Sampling::Full).unwrap();
        let split = pyramid.split(&chirp(width, height).values);
        for (index, (spread, value)) in figures.into_iter().enumerate() {
            let band = split.get(index);
            assert!((deviation(band) - spread).abs() < 1e-10, "{width} × {height}, band {index}");
            assert!((band[7 * width + 11] - value).abs() < 1e-10, "{width} × {height}, band {index}");
        }
    }
}

#[test]
fn the_round_trip_of_a_photograph_size_loses_nothing() {
    let image = chirp(256, 256);
    let mut pyramid = Pyramid::new(256, 256, 4, 4, Sampling::Reduced).unwrap();
    let split = pyramid.split(&image.values);
    let back = pyramid.join(&split);
    let power = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
    let error: Vec<f64> = image.values.iter().zip(&back.values).map(|(a, b)| a - b).collect();
    let snr_db = 10.0 * (power(&image.values) / power(&error)).log10();
    println!("round trip 256 × 256, 4 × 4: {snr_db:.1} dB");
    assert!(snr_db > 290.0);
}
