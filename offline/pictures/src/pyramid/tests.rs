//! Exactness, tightness, and what lands where.

use super::filter::angular_norm;
use super::*;
use asperity_dsp::rng::Rng;
use std::f64::consts::PI;

fn noise(width: usize, height: usize, seed: u64) -> Raster {
    let mut rng = Rng::new(seed);
    Raster::from_fn(width, height, |_, _| rng.normal())
}

fn snr_db(signal: &[f64], other: &[f64]) -> f64 {
    let error: f64 = signal.iter().zip(other).map(|(a, b)| (a - b) * (a - b)).sum();
    10.0 * (signal.iter().map(|a| a * a).sum::<f64>() / error).log10()
}

#[test]
fn the_round_trip_is_exact_at_even_odd_and_oblong_sizes() {
    for (w, h, s, k) in [(256, 256, 4, 4), (255, 255, 4, 4), (129, 200, 3, 5), (37, 41, 2, 1), (64, 48, 3, 2)]
    {
        for sampling in [Sampling::Reduced, Sampling::Full] {
            let image = noise(w, h, 11);
            let mut pyramid = Pyramid::new(w, h, s, k, sampling).unwrap();
            let split = pyramid.split(&image.values);
            let back = pyramid.join(&split);
            let db = snr_db(&image.values, &back.values);
            assert!(db > 290.0, "{w} × {h}, {s} × {k}, {sampling:?}: {db} dB");
        }
    }
}

#[test]
fn memory_used_again_changes_nothing() {
    let mut pyramid = Pyramid::new(45, 64, 3, 3, Sampling::Reduced).unwrap();
    let (first, second) = (noise(45, 64, 13), noise(45, 64, 14));
    let mut coefficients = pyramid.split(&first.values);
    let mut image = pyramid.join(&coefficients);
    pyramid.split_into(&second.values, &mut coefficients);
    assert_eq!(coefficients, pyramid.split(&second.values));
    pyramid.join_into(&coefficients, &mut image);
    assert_eq!(image, pyramid.join(&coefficients));
}

#[test]
fn squared_filters_sum_to_one_at_every_frequency() {
    for (w, h, s, k) in [(64, 64, 3, 4), (63, 45, 3, 6), (50, 64, 2, 3)] {
        let pyramid = Pyramid::new(w, h, s, k, Sampling::Reduced).unwrap();
        let mut sum = vec![0.0; (w / 2 + 1) * h];
        for filter in &pyramid.filters {
            for ((place, _), gain) in pyramid.levels[filter.level].frequencies(w).zip(&filter.gains) {
                sum[place] += gain * gain;
            }
        }
        for value in sum {
            assert!((value - 1.0).abs() < 1e-12, "{w} × {h}: {value}");
        }
    }
}

#[test]
fn reduced_bands_are_the_full_bands_at_fewer_places() {
    let image = noise(64, 64, 12);
    let full = Pyramid::new(64, 64, 3, 4, Sampling::Full).unwrap().split(&image.values);
    let mut reduced = Pyramid::new(64, 64, 3, 4, Sampling::Reduced).unwrap();
    let few = reduced.split(&image.values);
    for (index, band) in reduced.subbands().iter().enumerate() {
        let (many, few) = (full.get(index), few.get(index));
        let step = 64 / band.width;
        for y in 0..band.height {
            for x in 0..band.width {
                let difference = few[y * band.width + x] - many[y * step * 64 + x * step];
                assert!(difference.abs() < 1e-13, "{band:?}");
            }
        }
    }
}

#[test]
fn a_wave_lands_in_the_band_of_its_length_and_direction() {
    // 8 texels long, running along v: band 1, orientation 2 of 4.
    let wave = Raster::from_fn(64, 64, |_, y| (2.0 * PI * y as f64 / 8.0).cos());
    let mut pyramid = Pyramid::new(64, 64, 3, 4, Sampling::Reduced).unwrap();
    let split = pyramid.split(&wave.values);
    let energy = |i: usize| {
        let values = split.get(i);
        values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64
    };
    let strongest = (0..split.len()).max_by(|&a, &b| energy(a).total_cmp(&energy(b))).unwrap();
    assert_eq!(pyramid.subbands()[strongest].kind, Kind::Oriented { band: 1, orientation: 2 });
    // In closed form: Ψ = a at the peak of the band (H = L-chain = 1 there), cos² has mean ½.
    let expected = 0.5 * angular_norm(4).powi(2);
    assert!((energy(strongest) - expected).abs() < 1e-12);
}

#[test]
fn impossible_designs_are_refused_by_name() {
    let refused = |w, h, s, k| Pyramid::new(w, h, s, k, Sampling::Full).unwrap_err().field;
    assert_eq!(refused(64, 64, 0, 4), "bands");
    assert_eq!(refused(64, 64, 4, 0), "orientations");
    assert_eq!(refused(31, 64, 4, 4), "image side");
}
