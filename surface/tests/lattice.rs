//! Lattice textures: interpolation, endless repetition, smoothness across borders.

use crate::common;

use asperity_dsp::rng::Rng;
use asperity_surface::height_field::HeightField;
use asperity_surface::lattice::Lattice;
use asperity_surface::raster::Raster;
use common::{Stroke, bits, rms};
use std::f64::consts::TAU;

const T1: [f64; 2] = [0.008, 0.001];
const T2: [f64; 2] = [-0.003, 0.006];

fn random_cell(width: usize, height: usize, seed: u64) -> Raster {
    let mut rng = Rng::new(seed);
    Raster::from_fn(width, height, |_, _| 1e-4 * rng.normal())
}

fn place(a: f64, b: f64) -> [f64; 2] {
    [a * T1[0] + b * T2[0], a * T1[1] + b * T2[1]]
}

#[test]
fn the_surface_goes_through_every_texel_of_every_cell() {
    for (w, h) in [(1, 1), (2, 3), (5, 4), (17, 32)] {
        let cell = random_cell(w, h, 3);
        let lattice = Lattice::new(&cell, T1, T2).unwrap();
        for (m, n) in [(0.0, 0.0), (-3.0, 7.0), (1000.0, -2000.0)] {
            for y in 0..h {
                for x in 0..w {
                    let (a, b) = ((x as f64 + 0.5) / w as f64, (y as f64 + 0.5) / h as f64);
                    let error = lattice.at(place(m + a, n + b)).0 - cell.at(x, y);
                    assert!(error.abs() < 1e-12, "{w}×{h}, cell {m} {n}: {error}");
                }
            }
        }
    }
}

#[test]
fn a_cosine_cell_is_reproduced_everywhere() {
    let (w, h) = (64, 48);
    let wave = |a: f64, b: f64| 1e-4 * (TAU * (a + 2.0 * b)).cos();
    let cell = Raster::from_fn(w, h, |x, y| wave((x as f64 + 0.5) / w as f64, (y as f64 + 0.5) / h as f64));
    let lattice = Lattice::new(&cell, T1, T2).unwrap();
    let mut rng = Rng::new(5);
    for _ in 0..2000 {
        let (a, b) = (rng.uniform() * 40.0 - 20.0, rng.uniform() * 40.0 - 20.0);
        let error = lattice.at(place(a, b)).0 - wave(a, b);
        // Interpolation error of a cubic B-spline at 1/24 cycle a texel.
        assert!(error.abs() < 1e-4 * 2e-5, "{error}");
    }
}

#[test]
fn height_slope_and_curvature_run_through_the_cell_border() {
    let lattice = Lattice::new(&random_cell(6, 7, 9), T1, T2).unwrap();
    for k in 0..50 {
        let along = f64::from(k) * 0.137;
        let jump = |border: f64| {
            let at = |d: f64| lattice.at(place(border + d, along)).0;
            let e = 1e-4;
            let curvature = |s: f64| (at(s * 3.0 * e) - 2.0 * at(s * 2.0 * e) + at(s * e)) / (e * e);
            [
                at(1e-13) - at(-1e-13),
                (at(2.0 * e) - at(e)) / e - (at(-e) - at(-2.0 * e)) / e,
                curvature(1.0) - curvature(-1.0),
            ]
        };
        // a = 0 is a border between cells; a = 1/3 lies between texels inside one.
        let (border, inside) = (jump(0.0), jump(1.0 / 3.0));
        assert!(border[0].abs() < 1e-15, "{border:?}");
        // Both differences are what third derivatives make of a step of 3e-4, no more.
        let third = 1e-4 * 6.0_f64.powi(3) * 30.0;
        assert!(border[1].abs() < third * 3e-4 && inside[1].abs() < third * 3e-4, "{border:?}");
        assert!(border[2].abs() < third * 6e-4 && inside[2].abs() < third * 6e-4, "{border:?} {inside:?}");
    }
}

#[test]
fn slopes_agree_with_finite_differences() {
    let lattice = Lattice::new(&random_cell(9, 8, 2), T1, T2).unwrap();
    let mut rng = Rng::new(6);
    for _ in 0..1000 {
        let p = [rng.normal() * 0.1, rng.normal() * 0.1];
        let slope = lattice.at(p).1;
        for a in 0..2 {
            let shifted = |s: f64| {
                let mut q = p;
                q[a] += s;
                lattice.at(q).0
            };
            let measured = (shifted(1e-7) - shifted(-1e-7)) / 2e-7;
            assert!((measured - slope[a]).abs() < 1e-5, "{measured} {}", slope[a]);
        }
    }
}

#[test]
fn a_blunt_footprint_smooths_to_the_mean_in_any_blocks() {
    let mut cell = random_cell(32, 32, 4);
    cell = cell.map(|v| v + 1e-3);
    let mut lattice = Lattice::new(&cell, T1, T2).unwrap();
    let mut last = f64::INFINITY;
    for speed in [0.5, 4.0, 16.0, 64.0, 4000.0] {
        let stroke = Stroke::new([0.0; 2], [speed, 0.31 * speed], 44_100.0, 3000);
        let heights = stroke.heights(&mut lattice, &[64]);
        assert!(rms(&heights) < last, "{speed} m/s");
        last = rms(&heights);
        assert_eq!(bits(&heights), bits(&stroke.heights(&mut lattice, &[1, 9, 64])));
    }
    assert!(last < 1e-9, "only the mean is left: {last}");
}

#[test]
fn impossible_lattices_are_refused_by_name() {
    let cell = random_cell(4, 4, 1);
    let field = |t1, t2| Lattice::new(&cell, t1, t2).unwrap_err().field;
    assert_eq!(field([0.01, 0.0], [0.02, 0.0]), "t2_m");
    assert_eq!(field([0.0, 0.0], [0.02, 0.0]), "t1_m");
    assert_eq!(field([f64::NAN, 0.0], [0.02, 0.0]), "t1_m");
    assert_eq!(Lattice::new(&Raster::default(), T1, T2).unwrap_err().field, "cell.width");
    let mut hole = cell.clone();
    hole.values[3] = f64::NAN;
    assert_eq!(Lattice::new(&hole, T1, T2).unwrap_err().field, "cell.values");
    assert!(Lattice::new(&cell, T1, T2).unwrap().properties([1.0; 2]).band.shortest_m > 0.0);
}

// scipy.ndimage.map_coordinates(order=3, mode="grid-wrap"); tests/independent/lattice.py.
#[test]
fn heights_agree_with_scipys_periodic_cubic_spline() {
    let cell = Raster::from_fn(5, 4, |x, y| ((7 * x + 11 * y + 3 * x * y) % 13) as f64 * 1e-5);
    let lattice = Lattice::new(&cell, T1, T2).unwrap();
    for (at, wanted) in [
        ([0.0, 0.0], 1.090_909_090_909_088e-5),
        ([0.0123, -0.0045], 4.378_044_299_028_781_5e-5),
        ([-0.1, 0.2], 1.109_122_474_747_486_7e-4),
        ([0.003_71, 0.001_13], 6.911_262_899_369_695e-6),
        ([1.5, -2.25], 8.830_852_119_737_43e-5),
    ] {
        let height = lattice.at(at).0;
        assert!((height - wanted).abs() < 1e-15, "{height} for {wanted}");
    }
}
