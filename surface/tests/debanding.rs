//! Debanding: the terraces of maps of few bits are not felt, and other maps are left as they are.

use asperity_dsp::rng::Rng;
use asperity_surface::deband::deband;
use asperity_surface::height_field::{HeightField, MAX_BLOCK, PathBlock, SurfaceBlock};
use asperity_surface::height_map::{Extent, HeightMap};
use asperity_surface::picture::{Channel, Picture, Samples};
use asperity_surface::raster::Raster;
use asperity_surface::wrap::Wrap;
use std::f64::consts::{PI, TAU};

const RATE_HZ: f64 = 44_100.0;
const EXTENT: Extent = Extent { width_m: 0.14, height_m: 0.14, relief_m: 0.004 };

/// Heights under a finger that moves from `start_m` at `velocity_m_s`, m.
fn heights_m(map: &mut HeightMap, start_m: [f64; 2], velocity_m_s: [f64; 2], samples: usize) -> Vec<f64> {
    let footprint_m = [velocity_m_s[0].hypot(velocity_m_s[1]) / RATE_HZ; MAX_BLOCK];
    let (mut heights_m, mut out) = (Vec::new(), SurfaceBlock::default());
    for first in (0..samples).step_by(MAX_BLOCK) {
        let place = |n: usize| [0, 1].map(|axis| start_m[axis] + velocity_m_s[axis] * n as f64 / RATE_HZ);
        let position_m: Vec<[f64; 2]> = (first..(first + MAX_BLOCK).min(samples)).map(place).collect();
        let path = PathBlock {
            position_m: &position_m,
            velocity_m_s: &[velocity_m_s; MAX_BLOCK][..position_m.len()],
            footprint_m: &footprint_m[..position_m.len()],
            normal_force_n: &[],
            first_sample: first as u64,
            contact: 0,
            slopes: false,
            ..PathBlock::default()
        };
        map.sample(&path, &mut out);
        heights_m.extend_from_slice(&out.height_m[..position_m.len()]);
    }
    heights_m
}

/// Rms of what is left of a signal between 40 and 1000 Hz, m: two cascaded second-order Butterworth
/// filters each way.
fn felt_m(heights: &[f64]) -> f64 {
    use asperity_dsp::butterworth::{Butterworth, State};
    let mut signal = heights.to_vec();
    for (cutoff, high) in [(40.0, true), (40.0, true), (1000.0, false), (1000.0, false)] {
        let filter = Butterworth::new(cutoff, RATE_HZ).unwrap();
        let mut state = State::settled_at(signal[0]);
        for x in &mut signal {
            let out = state.tick(&filter, *x);
            *x = if high { out.high } else { out.low };
        }
    }
    let late = &signal[signal.len() / 4..];
    (late.iter().map(|x| x * x).sum::<f64>() / late.len() as f64).sqrt()
}

// Bar of the project: ≤ 0.01 µm in 40–1000 Hz at 0.1 m/s over 4 mm of relief.
#[test]
fn the_terraces_of_an_8_bit_ramp_are_not_felt_after_debanding() {
    for texels_per_step in [3.3, 8.0, 13.7, 40.0] {
        let ramp = Raster::from_fn(1024, 64, |x, _| {
            (30.0 + (x as f64 - 512.0).abs() / texels_per_step).round() / 255.0
        });
        let felt = |raster: &Raster| {
            let mut map = HeightMap::new(raster, EXTENT, Wrap::Repeat).unwrap();
            felt_m(&heights_m(&mut map, [0.015, 0.03], [0.1, 0.002], 20_000))
        };
        let (before, after) = (felt(&ramp), felt(&deband(&ramp, 1.0 / 255.0, Wrap::Repeat)));
        println!("{texels_per_step} texels a step: {:.4} µm → {:.5} µm", before * 1e6, after * 1e6);
        assert!(before > 0.05e-6 && after < 0.01e-6, "{texels_per_step}: {before} → {after}");
    }
}

#[test]
fn debanding_makes_no_busy_map_worse() {
    let mut rng = Rng::new(12);
    for (name, smoothness) in [("rough", 3.0), ("medium", 20.0), ("gentle", 90.0)] {
        let waves: Vec<[f64; 3]> = (0..24)
            .map(|_| {
                let k = (1.0 + rng.uniform()) * (256.0f64 / smoothness).floor().max(2.0);
                let angle = rng.uniform() * PI;
                [(k * angle.cos()).round(), (k * angle.sin()).round(), rng.uniform() * TAU]
            })
            .collect();
        let truth = Raster::from_fn(256, 256, |x, y| {
            let wave = |w: &[f64; 3]| (TAU * (w[0] * x as f64 + w[1] * y as f64) / 256.0 + w[2]).cos();
            0.5 + 0.03 * waves.iter().map(wave).sum::<f64>()
        });
        let coarse = truth.map(|v| (v * 255.0).round() / 255.0);
        let smooth = deband(&coarse, 1.0 / 255.0, Wrap::Repeat);
        let error = |r: &Raster| {
            let square: f64 = r.values.iter().zip(&truth.values).map(|(a, b)| (a - b).powi(2)).sum();
            10.0 * square.log10()
        };
        let change = error(&smooth) - error(&coarse);
        println!("{name}: {change:.2} dB");
        assert!(change < 0.1, "{name}: {change} dB worse");
        let furthest =
            smooth.values.iter().zip(&coarse.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(furthest < 0.6 / 255.0, "{name}: moved by {furthest}");
    }
}

#[test]
fn a_finely_quantised_or_constant_map_is_left_alone() {
    let fine = Raster::from_fn(64, 64, |x, _| x as f64 / 65_535.0);
    assert_eq!(deband(&fine, 1.0 / 65_535.0, Wrap::Repeat), fine);
    let constant = Raster::constant(64, 64, 0.5);
    assert_eq!(deband(&constant, 1.0 / 255.0, Wrap::Clamp), constant);
}

/// One channel of a picture of `levels` even greys of `white`, debanded.
fn debanded(white: u16, levels: u16, cell: impl Fn(usize, usize) -> u16) -> (Raster, Raster) {
    let grey =
        |at: usize| (f64::from(white) * f64::from(cell(at % 192, at / 192)) / f64::from(levels - 1)).round();
    let samples = (0..192 * 128).map(|at| (grey(at) / f64::from(white) * 65_535.0).round() as u16);
    let picture = Picture::new(192, 128, Samples::U16(samples.collect())).unwrap();
    let read = picture.channel(Channel::Luma).unwrap();
    (read.debanded(Wrap::Repeat), read.raster)
}

/// Gain of `found` over `stored` about their means.
fn gain(found: &Raster, stored: &Raster) -> f64 {
    let mean = stored.mean();
    let about = |raster: &Raster| {
        raster.values.iter().zip(&stored.values).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>()
    };
    about(found) / about(stored)
}

#[test]
fn a_grating_of_black_and_white_is_no_flat_glass() {
    for bits in [1_u32, 2, 4, 8, 12, 16] {
        let white = ((1_u32 << bits) - 1) as u16;
        for levels in [2_u16, 4, 16].into_iter().filter(|levels| *levels - 1 <= white) {
            for period in [2, 8, 16, 32, 64] {
                let grating = |x: usize, _: usize| u16::from(x % period < period / 2);
                let stairs = |x: usize, _: usize| (x / (period / 2)) as u16 % levels;
                let dots = |x: usize, y: usize| {
                    let [x, y] = [x, y].map(|at| at as f64 - 32.0 * (at as f64 / 32.0).round());
                    u16::from(x.hypot(y) < period as f64 / 8.0)
                };
                let cells: [&dyn Fn(usize, usize) -> u16; 3] = [&grating, &stairs, &dots];
                for (shape, cell) in cells.iter().enumerate() {
                    let (found, stored) = debanded(white, levels, cell);
                    let range = stored.range();
                    if range.0 == range.1 {
                        continue;
                    }
                    let gain = gain(&found, &stored);
                    let what = format!("{bits} bits, {levels} levels, period {period}, shape {shape}");
                    assert!((gain - 1.0).abs() < 0.02, "{what}: gain {gain}");
                }
            }
        }
    }
}

#[test]
fn letters_of_two_greys_keep_their_edges() {
    for [dark, bright] in [[0, 255], [100, 200], [100, 101]] {
        let letters = |at: usize| if (at % 64 / 5 * (at / 64 / 7)).is_multiple_of(3) { bright } else { dark };
        let picture = Picture::new(64, 64, Samples::U8((0..64 * 64).map(letters).collect())).unwrap();
        let read = picture.channel(Channel::Luma).unwrap();
        assert_eq!(read.debanded(Wrap::Repeat), read.raster, "{dark} and {bright}");
    }
}
