//! Maps that tile and repeat two to five times a side: the seam shows what the feature matrix
//! cannot.

use crate::patterns;

use asperity_dsp::rng::Rng;
use asperity_pictures::fft2::Fft2;
use asperity_pictures::symmetry::{Lattice, find_lattice};
use asperity_surface::raster::Raster;
use patterns::is_lattice;
use std::f64::consts::TAU;

const SIDE: usize = 128;

/// A mark of a motif: place in the cell, size in texels, height, and whether it is a square instead
/// of a bump.
struct Mark {
    at: [f64; 2],
    size: f64,
    height: f64,
    square: bool,
}

/// Cells of a few marks drawn by lot on the torus, their rms 1, and white noise.
fn tiled_pattern(basis: [[f64; 2]; 2], noise: f64, seed: u64) -> Raster {
    let mut rng = Rng::new(seed);
    let short = basis.map(|t| t[0].hypot(t[1])).into_iter().fold(f64::INFINITY, f64::min);
    let count = 1 + (4.0 * rng.uniform()) as usize;
    let marks: Vec<Mark> = (0..count)
        .map(|_| Mark {
            at: [rng.uniform(), rng.uniform()],
            size: short * (0.06 + 0.12 * rng.uniform()),
            height: (0.4 + 0.8 * rng.uniform()) * if rng.uniform() < 0.5 { -1.0 } else { 1.0 },
            square: rng.uniform() < 0.5,
        })
        .collect();
    let side = SIDE as f64;
    let mut map = Raster::constant(SIDE, SIDE, 0.0);
    for (i, j) in (-9..=9).flat_map(|i| (-9..=9).map(move |j| (f64::from(i), f64::from(j)))) {
        for mark in &marks {
            let [m, n] = [i + mark.at[0], j + mark.at[1]];
            let centre = [0, 1].map(|axis| m * basis[0][axis] + n * basis[1][axis]);
            if centre.iter().any(|c| !(0.0..side).contains(c)) {
                continue;
            }
            for (at, value) in map.values.iter_mut().enumerate() {
                let off = |texel: usize, centre: f64| {
                    (texel as f64 - centre + 1.5 * side).rem_euclid(side) - 0.5 * side
                };
                let (u, v) = (off(at % SIDE, centre[0]), off(at / SIDE, centre[1]));
                *value += mark.height
                    * if mark.square {
                        1.0 / (1.0 + (2.0 * (u.abs().max(v.abs()) - 1.3 * mark.size)).exp())
                    } else {
                        (-(u * u + v * v) / (2.0 * mark.size * mark.size)).exp()
                    };
            }
        }
    }
    let mean = map.mean();
    let rms = (map.values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / map.values.len() as f64).sqrt();
    map.map(|v| (v - mean) / rms + noise * rng.normal())
}

/// Translations that carry the map onto itself: two to five repeats a side, straight and slanted.
const LATTICES: [[[f64; 2]; 2]; 10] = {
    const S: f64 = SIDE as f64;
    [
        [[S / 2.0, 0.0], [0.0, S / 2.0]],
        [[S / 3.0, 0.0], [0.0, S / 3.0]],
        [[S / 4.0, 0.0], [0.0, S / 4.0]],
        [[S / 5.0, 0.0], [0.0, S / 5.0]],
        [[S / 2.0, 0.0], [0.0, S / 3.0]],
        [[S / 4.0, 0.0], [0.0, S / 2.0]],
        [[S / 2.0, 0.0], [S / 4.0, S / 2.0]],
        [[S / 4.0, S / 4.0], [-S / 4.0, S / 4.0]],
        [[S / 3.0, 0.0], [S / 6.0, S / 4.0]],
        [[S * 2.0 / 5.0, S / 5.0], [-S / 5.0, S * 2.0 / 5.0]],
    ]
};

/// Whether a lattice is the true one; a fraction of it is worse than a multiple.
fn is_fraction(found: &Lattice, truth: [[f64; 2]; 2]) -> bool {
    let area = (truth[0][0] * truth[1][1] - truth[0][1] * truth[1][0]).abs();
    found.cell_area_px2() < 0.9 * area
}

/// Share of patterns whose lattice is found; a line for each other one.
fn found(lattices: &[[[f64; 2]; 2]], noise: f64, seeds: std::ops::Range<u64>) -> (f64, Vec<String>) {
    let (mut all, mut wrong) = (0, Vec::new());
    for (truth, seed) in lattices.iter().flat_map(|truth| seeds.clone().map(move |seed| (*truth, seed))) {
        let found = find_lattice(&tiled_pattern(truth, noise, 97 * all + seed));
        let name = format!("{truth:?}, noise {noise}, seed {seed}: {found:?}");
        assert!(found.is_none_or(|l| !is_fraction(&l, truth)), "{name}");
        if !found.is_some_and(|l| is_lattice([l.t1_px, l.t2_px], truth)) {
            wrong.push(name);
        }
        all += 1;
    }
    (1.0 - wrong.len() as f64 / all as f64, wrong)
}

#[test]
fn a_map_that_tiles_shows_two_to_five_repeats_a_side() {
    for (noise, least) in [(0.0, 0.95), (0.05, 0.85)] {
        let (share, wrong) = found(&LATTICES, noise, 0..3);
        println!("noise {noise}: {share:.3} {wrong:#?}");
        assert!(share >= least, "{share}: {wrong:#?}");
    }
}

/// Of few cells under much noise too few waves are left to tell a pattern from chance: none is
/// claimed rather than a wrong one.
#[test]
fn nine_cells_are_found_under_noise_and_fewer_not_misread() {
    let many =
        LATTICES.map(|[a, b]| ((a[0] * b[1] - a[1] * b[0]).abs() < (SIDE * SIDE) as f64 / 8.5, [a, b]));
    let many: Vec<_> = many.into_iter().filter(|(many, _)| *many).map(|(_, basis)| basis).collect();
    for noise in [0.25, 0.7] {
        let (share, wrong) = found(&many, noise, 10..13);
        println!("noise {noise}: {share:.3} {wrong:#?}");
        assert!(share >= 0.8, "{share}: {wrong:#?}");
        let (share, _) = found(&LATTICES[..1], noise, 20..23);
        println!("2 × 2, noise {noise}: {share:.3}");
    }
}

/// Noise whose waves of k periods a side have this strength; it tiles.
fn periodic_noise(seed: u64, strength: impl Fn(f64) -> f64) -> Raster {
    let mut rng = Rng::new(seed);
    let white: Vec<f64> = (0..SIDE * SIDE).map(|_| rng.normal()).collect();
    let mut fft = Fft2::new(SIDE, SIDE);
    let mut spectrum = fft.spectrum(&white);
    let signed = |k: usize| if k > SIDE / 2 { SIDE as f64 - k as f64 } else { k as f64 };
    for (at, value) in spectrum.iter_mut().enumerate() {
        let k = signed(at / SIDE).hypot(signed(at % SIDE));
        *value *= if k == 0.0 { 0.0 } else { strength(k) };
    }
    fft.image(&mut spectrum)
}

#[test]
fn noise_rings_of_waves_and_stripes_that_tile_are_no_lattice() {
    let mut called = Vec::new();
    for seed in 0..6 {
        for slope in [0.0, 1.1, 1.6, 2.0] {
            let noise = periodic_noise(seed, |k| k.powf(-slope));
            called.extend(find_lattice(&noise).map(|l| format!("slope {slope}, {seed}: {l:?}")));
        }
        for ring in [2.0, 3.0, 4.0, 6.0] {
            let waves = periodic_noise(seed, |k| (-((k - ring) / (0.15 * ring + 0.3)).powi(2)).exp());
            called.extend(find_lattice(&waves).map(|l| format!("ring {ring}, {seed}: {l:?}")));
        }
        let (across, down) = ((2 + seed % 4) as f64, (seed % 3) as f64);
        let mut rng = Rng::new(seed);
        let stripes = Raster::from_fn(SIDE, SIDE, |x, y| {
            let turns = (across * x as f64 + down * y as f64) / SIDE as f64 + 0.013;
            (TAU * turns).cos().signum() + 0.3 * rng.normal()
        });
        called.extend(find_lattice(&stripes).map(|l| format!("stripes {across} {down}: {l:?}")));
    }
    assert!(called.is_empty(), "{called:#?}");
}

/// A cut through the pattern has no seam to go by: nothing is claimed.
#[test]
fn three_and_a_half_repeats_that_do_not_tile_are_left_alone() {
    for seed in 0..6 {
        let whole = tiled_pattern([[SIDE as f64 / 4.0, 0.0], [0.0, SIDE as f64 / 4.0]], 0.0, seed);
        let cut = Raster::from_fn(108, 108, |x, y| whole.at(x, y) + 0.02 * x as f64);
        let found = find_lattice(&cut);
        assert!(
            found.is_none_or(|l| is_lattice([l.t1_px, l.t2_px], [[32.0, 0.0], [0.0, 32.0]])),
            "{seed}: {found:?}"
        );
    }
}
