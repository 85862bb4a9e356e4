//! Reliefs under light from the viewer's direction, as the thesis' scanner saw them: heights come
//! back where there is a flat ground, and where there is none another way is taken and said.

use crate::framed;

use asperity_dsp::rng::Rng;
use asperity_pictures::flat_ground::above_flat_ground;
use asperity_pictures::from_photo::{Doubt, Fallback, PhotoOptions, TEXEL_M, surface_from_photo};
use asperity_pictures::light::Light;
use asperity_pictures::shape_from_shading::Method;
use asperity_surface::raster::Raster;
use framed::{SHAPES, Shape, frontally_lit, thesis_relief};

/// As a camera stores it: sRGB with noise, 8 bits.
fn photographed(relief: &Raster, noise_levels: f64, seed: u64) -> Raster {
    let mut rng = Rng::new(seed);
    frontally_lit(relief).map(|lit| {
        let linear = 0.6 * lit;
        let stored = 1.055 * linear.powf(1.0 / 2.4) - 0.055;
        ((stored * 255.0 + noise_levels * rng.normal()).round() / 255.0).clamp(0.0, 1.0)
    })
}

fn correlation(a: &Raster, b: &Raster) -> f64 {
    let (ma, mb) = (a.mean(), b.mean());
    let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
        a.values.iter().zip(&b.values).map(|(x, y)| f(x - ma, y - mb)).sum()
    };
    sum(&|x, y| x * y) / (sum(&|x, _| x * x) * sum(&|_, y| y * y)).sqrt()
}

/// Bumps of random size and place, some of them overlapping, on a plate.
fn bumps(seed: u64) -> Raster {
    let mut rng = Rng::new(seed);
    let bumps: Vec<[f64; 4]> = (0..14)
        .map(|_| {
            [
                220.0 * rng.uniform(),
                180.0 * rng.uniform(),
                4.0 + 6.0 * rng.uniform(),
                2.0 + 4.0 * rng.uniform(),
            ]
        })
        .collect();
    Raster::from_fn(220, 180, |x, y| {
        let bump = |b: &[f64; 4]| {
            let r2 = (x as f64 - b[0]).powi(2) + (y as f64 - b[1]).powi(2);
            b[3] * (-r2 / (2.0 * b[2] * b[2])).exp()
        };
        bumps.iter().map(bump).sum()
    })
}

fn frontal() -> PhotoOptions {
    PhotoOptions { light: Some(Light::OVERHEAD), ..Default::default() }
}

#[test]
fn the_reliefs_of_the_thesis_come_back_from_frontal_light() {
    for shape in SHAPES {
        for (across, noise) in [(6.0, 0.0), (6.0, 1.0), (8.0, 2.0)] {
            let (relief, _) = thesis_relief(shape, across, 240);
            let picture = photographed(&relief, noise, 1);
            let surface = surface_from_photo(&picture, &frontal(), |_| {}).unwrap();
            let r = correlation(&surface.displacement, &relief);
            let (low, high) = relief.range();
            let relief_ratio = surface.relief_m / ((high - low) * TEXEL_M);
            println!(
                "{shape:?} {across} noise {noise}: r {r:.3}, relief {relief_ratio:.2}, {:?}",
                surface.shape.method
            );
            assert_eq!(surface.shape.method, Method::FlatGround);
            assert!(
                r > 0.93 && (0.8..1.2).contains(&relief_ratio),
                "{shape:?} {across} {noise}: {r} {relief_ratio}"
            );
            assert!(surface.doubts.contains(&Doubt::GuessedSign));
        }
    }
}

#[test]
fn bumps_at_any_place_come_back_from_frontal_light() {
    let found: Vec<f64> = (500..512)
        .map(|seed| {
            let relief = bumps(seed);
            let surface = surface_from_photo(&photographed(&relief, 1.0, seed), &frontal(), |_| {}).unwrap();
            correlation(&surface.displacement, &relief)
        })
        .collect();
    println!("{found:.2?}");
    assert!(found.iter().all(|r| *r > 0.8) && found.iter().filter(|r| **r > 0.9).count() >= 8, "{found:.2?}");
}

#[test]
fn surfaces_without_a_ground_fall_back_and_say_so() {
    let mut rng = Rng::new(9);
    let rough = Raster::from_fn(128, 128, |_, _| 0.5 + 0.1 * rng.normal());
    let surface = surface_from_photo(&rough, &frontal(), |_| {}).unwrap();
    assert_eq!(surface.shape.method, Method::DarkIsDeep);
    let said = |d: &Doubt| matches!(d, Doubt::Fallback(Fallback::FrontalLight(_)));
    assert!(surface.doubts.iter().any(said));
    let message = PhotoOptions { method: Some(Method::FlatGround), ..Default::default() };
    let refused = surface_from_photo(&rough, &message, |_| {}).unwrap_err();
    assert_eq!((refused.field, refused.value), ("flat ground", 0.0));
}

#[test]
fn a_relief_turned_over_is_told_by_a_flag() {
    let (relief, _) = thesis_relief(Shape::Spheres, 6.0, 192);
    let picture = photographed(&relief, 0.0, 2);
    let sunk =
        surface_from_photo(&picture, &PhotoOptions { bright_is_deep: true, ..frontal() }, |_| {}).unwrap();
    assert!(correlation(&sunk.displacement, &relief) < -0.95 && sunk.sign.is_decided());
}

/// `tests/independent/flat_ground.py`: a solver written apart; the same relief, no noise.
#[test]
fn heights_agree_with_an_independent_solver() {
    let relief = Raster::from_fn(48, 48, |x, y| {
        let (u, v) = (x as f64 - 20.0, y as f64 - 26.0);
        4.0 * (-(u * u + 2.0 * v * v) / 60.0).exp()
    });
    let heights = above_flat_ground(&frontally_lit(&relief)).unwrap();
    for (x, y, z) in INDEPENDENT {
        assert!((heights.at(x, y) - z).abs() < 1e-9, "{x} {y}: {} for {z}", heights.at(x, y));
    }
}

const INDEPENDENT: [(usize, usize, f64); 4] =
    [(20, 26, 3.656707071797), (16, 24, 2.394426687319), (24, 29, 2.200820918746), (12, 26, 1.014624251479)];
