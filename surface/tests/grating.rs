//! Gratings: spectrum, period and height by closed forms, and the rules of every source.

use crate::common::{Stroke, bits};

use asperity_surface::grating::{Grating, GratingKind, GratingParameters};
use asperity_surface::height_field::{Extension, HeightField};
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::SolidNoise;
use std::f64::consts::{PI, TAU};

const RATE: f64 = 44_100.0;
const KINDS: [GratingKind; 3] = [GratingKind::Sine, GratingKind::Ridges, GratingKind::Dots];

fn of(kind: GratingKind, duty: f64) -> GratingParameters {
    GratingParameters { kind, pitch_m: 1.5e-3, amplitude_m: 3e-5, duty }
}

/// Amplitude of the k-th cosine of the heights along u at this v.
fn harmonic(grating: &GratingParameters, k: usize, v_m: f64) -> f64 {
    const N: usize = 4096;
    let value = |n: usize| grating.at([grating.pitch_m * n as f64 / N as f64, v_m], 0.0).0;
    (0..N).map(|n| value(n) * (TAU * (k * n) as f64 / N as f64).cos()).sum::<f64>() * 2.0 / N as f64
}

#[test]
fn ridges_have_the_lines_of_a_rectangle_whose_edges_are_raised_cosines() {
    for duty in [0.2, 0.45, 0.7] {
        let ridges = of(GratingKind::Ridges, duty);
        for k in 1..12 {
            let (turn, w) = (PI * k as f64, ridges.flank());
            let edge = (turn * w).cos() / (1.0 - (2.0 * k as f64 * w).powi(2));
            let exact = ridges.amplitude_m * 4.0 * (turn * duty).sin() / turn * edge;
            let made = harmonic(&ridges, k, 0.0);
            assert!((made - exact).abs() < 1e-4 * ridges.amplitude_m, "{duty} {k}: {made} {exact}");
        }
    }
}

#[test]
fn every_grating_repeats_and_reaches_its_amplitude_and_slopes_as_it_rises() {
    for kind in KINDS {
        let grating = of(kind, 0.4);
        let p = grating.pitch_m;
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        for n in 0..40_000 {
            let at = [p * (n % 200) as f64 / 200.0, p * (n / 200) as f64 / 200.0];
            let (height, slope) = grating.at(at, 0.0);
            (low, high) = (low.min(height), high.max(height));
            let far = grating.at([at[0] + 17.0 * p, at[1] - 5.0 * p], 0.0).0;
            assert!((far - height).abs() < 1e-9 * p, "{kind:?} {at:?}");
            for axis in 0..2 {
                let moved = |by: f64| {
                    let mut to = at;
                    to[axis] += by;
                    grating.at(to, 0.0).0
                };
                let rise = (moved(1e-8) - moved(-1e-8)) / 2e-8;
                assert!((rise - slope[axis]).abs() < 2e-3, "{kind:?} {at:?}: {rise} {slope:?}");
            }
        }
        assert!((high - 3e-5).abs() < 1e-9 && (low + 3e-5).abs() < 1e-9, "{kind:?}: {low} {high}");
    }
}

#[test]
fn a_grating_that_the_sample_rate_cannot_carry_leaves_its_mean() {
    for kind in KINDS {
        let grating = of(kind, 0.3);
        let gone = grating.at([2e-4, 1e-4], 0.5 * grating.pitch_m).0;
        let cells = 300;
        let at = |n: usize| grating.pitch_m * (n as f64 + 0.5) / cells as f64;
        let heights = (0..cells * cells).map(|n| grating.at([at(n % cells), at(n / cells)], 0.0).0);
        let mean = heights.sum::<f64>() / (cells * cells) as f64;
        assert!((gone - mean).abs() < 1e-3 * grating.amplitude_m, "{kind:?}: {gone} {mean}");
    }
}

#[test]
fn blocks_change_no_bit_while_a_grating_changes() {
    let stroke = Stroke::new([0.01, 0.02], [0.11, -0.05], RATE, 12_000);
    let run = |lengths: &[usize]| {
        let mut source = Grating::new(of(GratingKind::Sine, 0.5)).unwrap();
        assert!(source.set(&of(GratingKind::Ridges, 0.2), 1001));
        assert!(source.set(&GratingParameters { pitch_m: 4e-3, ..of(GratingKind::Dots, 0.6) }, 3003));
        assert!(!source.set(&GratingParameters { duty: 2.0, ..of(GratingKind::Dots, 0.6) }, 3004));
        assert!(!source.set(&1.0_f64, 3004));
        stroke.heights(&mut source, lengths)
    };
    let whole = run(&[64]);
    assert_eq!(bits(&whole), bits(&run(&[1])));
    assert_eq!(bits(&whole), bits(&run(&[7, 64, 13, 1, 32])));
    let steepest = whole.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    assert!(steepest < 6e-5 / 10.0, "a change clicks: {steepest}");
}

#[test]
fn what_stands_still_on_a_grating_or_a_new_noise_feels_nothing() {
    let stroke = Stroke::new([0.0123, 0.004], [0.0; 2], RATE, 300);
    let is_constant = |source: &mut dyn HeightField| {
        let heights = stroke.heights(source, &[64]);
        assert!(heights.iter().all(|height| height.to_bits() == heights[0].to_bits()));
    };
    KINDS.into_iter().for_each(|kind| is_constant(&mut Grating::new(of(kind, 0.5)).unwrap()));
    SolidMaterial::KINDS
        .into_iter()
        .for_each(|material| is_constant(&mut SolidNoise::new(material.parameters(), 3).unwrap()));
}

#[test]
fn new_noises_are_their_definition_along_any_path() {
    for material in SolidMaterial::KINDS {
        let parameters = material.parameters();
        let mut source = SolidNoise::new(parameters, 11).unwrap();
        // Slow enough for every octave to be whole.
        let stroke = Stroke::new([0.01, -0.02], [0.03, 0.02], RATE, 4000);
        let heights = stroke.heights(&mut source, &[64]);
        assert_eq!(bits(&heights), bits(&stroke.heights(&mut source, &[1, 30, 7])));
        for (n, height) in heights.iter().enumerate() {
            let place = asperity_surface::solid_noise::SolidCut::SLANTED.at(stroke.position_m(n));
            let expected = parameters.amplitude_m * source.definition(&parameters, place);
            assert!((height - expected).abs() < 1e-9, "{material:?}: {height} {expected}");
        }
        // Five cells a reading: nothing but the mean is left, and no step.
        let fast = Stroke::new([0.0; 2], [450.0, 0.0], RATE, 50).heights(&mut source, &[64]);
        assert!(fast.iter().all(|height| (height - fast[0]).abs() < 1e-12), "{material:?}");
    }
}

#[test]
fn a_tile_of_whole_periods_repeats_and_another_one_is_fresh() {
    let extension = |kind, tile_m| Grating::new(of(kind, 0.5)).unwrap().properties(tile_m).extension;
    assert_eq!(extension(GratingKind::Sine, [0.15, 0.1]), Extension::Same);
    assert_eq!(extension(GratingKind::Dots, [0.15, 0.1]), Extension::Fresh);
    assert_eq!(extension(GratingKind::Ridges, [0.1, 0.15]), Extension::Fresh);
}
