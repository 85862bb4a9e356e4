//! Brownian surfaces and paths: measured dimension, law, seams, and the four renderings.
#![cfg(feature = "brownian")]

use crate::common;

use asperity_surface::brownian::rendering::{BrownianForce, BrownianPath, BrownianSurface, Rendering};
use asperity_surface::brownian::{BrownianDesign, Method};
use asperity_surface::height_field::HeightField;
use asperity_surface::lattice::Lattice;
use asperity_surface::raster::Raster;
use common::{Stroke, bits, rms};

/// H of a line of heights by the madogram, log2 of the ratio of mean absolute differences at lags 2
/// and 1 (Gneiting, Ševčíková & Percival 2012): an estimator that shares nothing with the
/// generators.
fn madogram(line: &[f64]) -> f64 {
    let mean = |lag: usize| {
        let n = (line.len() - lag) as f64;
        line.windows(lag + 1).map(|w| (w[lag] - w[0]).abs()).sum::<f64>() / n
    };
    (mean(2) / mean(1)).log2()
}

/// Median over all rows and columns of a surface.
fn hurst_of(surface: &Raster) -> f64 {
    let n = surface.width;
    let column = |x: usize| (0..n).map(|y| surface.at(x, y)).collect::<Vec<f64>>();
    let mut all: Vec<f64> =
        (0..n).map(|y| madogram(surface.row(y))).chain((0..n).map(|x| madogram(&column(x)))).collect();
    all.sort_by(f64::total_cmp);
    0.5 * (all[n - 1] + all[n])
}

const HURST: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];

#[test]
fn measured_dimension_of_exact_surfaces_is_3_minus_h_within_0_03() {
    println!("   H   open   periodic   midpoint  (3 - H measured)");
    for hurst in HURST {
        let measured = |method, periodic, size| {
            let design = BrownianDesign { method, periodic, size, ..BrownianDesign::new(hurst, 1e-4, 5) };
            3.0 - hurst_of(&design.surface().unwrap())
        };
        let open = measured(Method::Exact, false, 256);
        let periodic = measured(Method::Exact, true, 512);
        let midpoint = measured(Method::Midpoint, false, 257);
        println!("{hurst:4.1}  {open:.3}    {periodic:.3}      {midpoint:.3}");
        assert!((open - (3.0 - hurst)).abs() <= 0.03, "open, H = {hurst}: {open}");
        assert!((periodic - (3.0 - hurst)).abs() <= 0.03, "periodic, H = {hurst}: {periodic}");
        assert!((midpoint - (3.0 - hurst)).abs() <= 0.1, "midpoint, H = {hurst}: {midpoint}");
    }
}

/// Means of the two or four nearest points alone left creases: 2.34 for 2.1, 2.41 for 2.2.
#[test]
fn measured_dimension_of_midpoint_surfaces_is_3_minus_h_within_0_03() {
    for tenth in 1..=9 {
        let hurst = 0.1 * f64::from(tenth);
        let measured: Vec<f64> = (0..4)
            .map(|seed| {
                let (method, periodic, size) = (Method::Midpoint, false, 257);
                let design =
                    BrownianDesign { method, periodic, size, ..BrownianDesign::new(hurst, 1e-4, seed) };
                3.0 - hurst_of(&design.surface().unwrap())
            })
            .collect();
        println!("midpoint surface, H = {hurst:.1}: {measured:.3?}");
        // One surface's measure scatters as an exact one's does: 0.03 from H = 0.7.
        assert!(measured.iter().all(|d| (d - (3.0 - hurst)).abs() <= 0.1), "H = {hurst}: {measured:?}");
        let mean = measured.iter().sum::<f64>() / 4.0;
        assert!((mean - (3.0 - hurst)).abs() <= 0.03, "H = {hurst}: {mean}");
    }
}

#[test]
fn measured_dimension_of_exact_paths_is_2_minus_h_within_0_03() {
    for hurst in HURST {
        for periodic in [false, true] {
            let design = BrownianDesign { size: 1 << 16, periodic, ..BrownianDesign::new(hurst, 1e-4, 9) };
            let measured = 2.0 - madogram(&design.path().unwrap());
            assert!((measured - (2.0 - hurst)).abs() <= 0.03, "H = {hurst}: {measured}");
        }
        let method = Method::Midpoint;
        let design =
            BrownianDesign { size: 65_537, periodic: false, method, ..BrownianDesign::new(hurst, 1e-4, 9) };
        let measured = 2.0 - madogram(&design.path().unwrap());
        println!("midpoint path, H = {hurst}: {measured:.3}");
        assert!((measured - (2.0 - hurst)).abs() <= 0.03, "midpoint, H = {hurst}: {measured}");
    }
}

/// Mean square increments over many seeds, in every direction: the law itself, closed form.
#[test]
fn increments_of_exact_open_surfaces_follow_the_law_in_all_directions() {
    for hurst in [0.2, 0.5, 0.8] {
        let lags = [(1, 0), (0, 1), (1, 1), (4, 3), (8, 0), (0, 16), (-6, 8), (12, 16)];
        let mut square = [0.0; 8];
        for seed in 0..60 {
            let (size, rms_m) = (48, 1e-3);
            let design =
                BrownianDesign { size, periodic: false, seed, ..BrownianDesign::new(hurst, rms_m, 0) };
            let s = design.surface().unwrap();
            // Surfaces are scaled to one rms each; the smallest increment undoes it.
            let mean = |(dx, dy): (i32, i32)| {
                let (mut sum, mut count) = (0.0, 0.0);
                for y in 0..32_i32 {
                    for x in 8..32_i32 {
                        let far = s.at((x + dx) as usize, (y + dy) as usize);
                        sum += (far - s.at(x as usize, y as usize)).powi(2);
                        count += 1.0;
                    }
                }
                sum / count
            };
            let unit = 0.5 * (mean((1, 0)) + mean((0, 1)));
            for (sum, &lag) in square.iter_mut().zip(&lags) {
                *sum += mean(lag) / unit / 60.0;
            }
        }
        for (&(dx, dy), measured) in lags.iter().zip(square) {
            let wanted = f64::from(dx).hypot(f64::from(dy)).powf(2.0 * hurst);
            // Standard error of 60 surfaces: 3 % at short lags, 20 % at a third of the surface.
            let bound = 0.04 + 0.02 * f64::from(dx).hypot(f64::from(dy));
            assert!((measured / wanted - 1.0).abs() < bound, "H {hurst}, lag {dx} {dy}: {measured} {wanted}");
        }
    }
}

#[test]
fn midpoint_variances_are_those_the_law_leaves_open() {
    // The centre of a 3 × 3 surface, over many seeds: variance of X(½,½) about the origin is
    // 2^{−H}.
    for hurst in [0.2, 0.5, 0.8] {
        let (mut centre, mut edge, mut corner) = (0.0, 0.0, 0.0);
        let count = 20_000_i32;
        let mut unit = 0.0;
        let mut rng = asperity_dsp::rng::Rng::new(17);
        for _ in 0..count {
            let values = asperity_surface::brownian::midpoint::raw_surface(hurst, 5, &mut rng);
            let x0 = values[0];
            unit += (values[4] - x0).powi(2);
            centre += (values[12] - x0).powi(2);
            edge += (values[2] - x0).powi(2);
            corner += (values[24] - x0).powi(2);
        }
        let n = f64::from(count);
        let checks = [
            (unit / n, 1.0),
            (centre / n, 2.0_f64.powf(-hurst)),
            (edge / n, 2.0_f64.powf(-2.0 * hurst)),
            (corner / n, 2.0_f64.powf(hurst)),
        ];
        for (measured, wanted) in checks {
            assert!((measured / wanted - 1.0).abs() < 0.06, "H = {hurst}: {measured} for {wanted}");
        }
    }
}

#[test]
fn a_periodic_surface_has_no_seam() {
    for hurst in [0.2, 0.8] {
        let s = BrownianDesign { size: 128, ..BrownianDesign::new(hurst, 1e-4, 3) }.surface().unwrap();
        let n = s.width;
        let step =
            |a: usize, b: usize| (0..n).map(|y| (s.at(a, y) - s.at(b, y)).abs()).sum::<f64>() / n as f64;
        let inside: f64 = (0..n - 1).map(|x| step(x, x + 1)).sum::<f64>() / (n - 1) as f64;
        assert!((step(n - 1, 0) / inside - 1.0).abs() < 0.25, "{} {inside}", step(n - 1, 0));
    }
}

#[test]
fn rms_and_mean_are_as_asked_and_seeds_repeat() {
    let design = BrownianDesign { size: 64, ..BrownianDesign::new(0.4, 2.5e-5, 77) };
    let s = design.surface().unwrap();
    assert!((rms(&s.values) - 2.5e-5).abs() < 1e-15 && s.mean().abs() < 1e-18);
    assert_eq!(bits(&s.values), bits(&design.surface().unwrap().values));
    let other = BrownianDesign { seed: 78, ..design }.surface().unwrap();
    assert_ne!(bits(&s.values), bits(&other.values));
}

#[test]
fn impossible_designs_are_refused_by_name() {
    let design = BrownianDesign::new(0.5, 1e-4, 1);
    let field = |d: BrownianDesign| d.surface().unwrap_err().field;
    assert_eq!(field(BrownianDesign { hurst: 1.0, ..design }), "hurst");
    assert_eq!(field(BrownianDesign { hurst: f64::NAN, ..design }), "hurst");
    assert_eq!(field(BrownianDesign { size: 2, ..design }), "size");
    assert_eq!(field(BrownianDesign { size: 1 << 20, ..design }), "size");
    assert_eq!(field(BrownianDesign { rms_m: -1.0, ..design }), "rms_m");
    assert_eq!(field(BrownianDesign { method: Method::Midpoint, ..design }), "periodic");
}

fn span(values: &[f64]) -> f64 {
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    high - values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Rms force of one rendering along a 0.1 m/s stroke, asked for at every sample.
fn rms_force(source: &mut dyn HeightField, rate: f64) -> f64 {
    let stroke = Stroke::new([0.011, 0.017], [0.08, 0.06], rate, (0.8 * rate) as usize);
    let mut forces = Vec::new();
    let mut out = asperity_surface::height_field::SurfaceBlock::default();
    for n in 0..stroke.samples {
        let position = stroke.position_m(n);
        let path = asperity_surface::height_field::PathBlock {
            position_m: &[position],
            velocity_m_s: &[stroke.velocity_m_s],
            footprint_m: &[stroke.footprint_m()],
            normal_force_n: &[0.5],
            first_sample: 1 + n as u64,
            contact: 0,
            slopes: true,
            ..Default::default()
        };
        source.sample(&path, &mut out);
        if n % 64 == 0 {
            forces.extend(out.answer.at(0).force_n);
        }
    }
    (forces.iter().map(|f| f * f).sum::<f64>() * 3.0 / forces.len() as f64).sqrt()
}

#[test]
fn all_four_renderings_fall_strictly_as_h_grows_at_any_rate() {
    // 257 samples over 128 mm, as the document's maps on its workspace.
    let (size, spacing) = (257, 5e-4);
    let edge = spacing * size as f64;
    for rendering in [Rendering::Orthogonal, Rendering::Lateral] {
        for graph in [false, true] {
            let mut last = [f64::INFINITY; 2];
            for tenth in 1..=9 {
                let design = BrownianDesign { size, ..BrownianDesign::new(0.1 * f64::from(tenth), 1e-4, 4) };
                let forces = [44_100.0, 192_000.0].map(|rate| {
                    if graph {
                        let path = design.path().unwrap();
                        rms_force(&mut BrownianPath::new(&path, spacing, Some(rendering)).unwrap(), rate)
                    } else {
                        let relief = design.surface().unwrap();
                        let force = BrownianForce::surface(rendering, span(&relief.values)).unwrap();
                        let relief = Lattice::new(&relief, [edge, 0.0], [0.0, edge]).unwrap();
                        rms_force(&mut BrownianSurface::new(Box::new(relief), force), rate)
                    }
                });
                let name = if graph { "graph" } else { "surface" };
                println!(
                    "{name} {rendering:?} H 0.{tenth}: {:.4} N at 44.1, {:.4} N at 192 kHz",
                    forces[0], forces[1]
                );
                assert!(forces[0] < last[0] && forces[1] < last[1], "strictly falling");
                assert!((forces[0] / forces[1] - 1.0).abs() < 0.05, "rate-normalised");
                last = forces;
            }
        }
    }
}

#[test]
fn a_graph_is_read_by_distance_whatever_the_direction_and_the_blocks() {
    let heights = BrownianDesign { size: 257, ..BrownianDesign::new(0.5, 1e-4, 4) }.path().unwrap();
    let made = || BrownianPath::new(&heights, 5e-4, Some(Rendering::Lateral)).unwrap();
    let mut stroke = Stroke::new([0.0; 2], [0.1, 0.0], 44_100.0, 4000);
    stroke.first_sample = 1;
    let along_u = stroke.heights(&mut made(), &[64]);
    let slanted = Stroke { velocity_m_s: [-0.06, 0.08], ..stroke }.heights(&mut made(), &[64]);
    assert!(along_u.iter().zip(&slanted).all(|(a, b)| (a - b).abs() < 1e-12));
    assert_eq!(bits(&along_u), bits(&stroke.heights(&mut made(), &[1, 17, 64])));
    // It goes through its own samples: 5e-4 m at 0.1 m/s are 220.5 samples.
    let path = made();
    for (i, h) in heights.iter().enumerate() {
        assert!((path.at((i as f64 + 0.5) * 5e-4).0 - h).abs() < 1e-15);
    }
}
