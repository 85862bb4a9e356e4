//! Mode-samples a nanosecond of two banks built from the crate `fundsp`, force in every sample: its eight-lane
//! biquads, and one resonator a mode. `fundsp-bank MODES` prints the best of many segments of each.

use fundsp::biquad::BiquadCoefs;
use fundsp::biquad_bank::BiquadBank;
use fundsp::prelude32::*;
use std::time::Instant;

const RATE_HZ: f32 = 44_100.0;
const BLOCK: usize = 64;

fn frequency_hz(i: usize, modes: usize) -> f32 {
    100.0 + 15_000.0 * i as f32 / modes as f32
}

/// Best of many segments of about a millisecond.
fn best(modes: usize, mut tick: impl FnMut(f32) -> f32) -> f64 {
    let mut seed = 1_u32;
    let mut force = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 * 6e-8 - 0.5
    };
    let samples = BLOCK * (1 + 2_000_000 / (modes * BLOCK));
    let input: Vec<f32> = (0..samples).map(|_| force()).collect();
    let mut output = vec![0.0; samples];
    (0..60)
        .map(|_| {
            let start = Instant::now();
            for (y, u) in output.iter_mut().zip(&input) {
                *y = tick(*u);
            }
            std::hint::black_box(&output);
            (samples * modes) as f64 / start.elapsed().as_nanos() as f64
        })
        .fold(0.0, f64::max)
}

fn main() {
    let modes: usize = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(256);
    let r = (-20.0 / RATE_HZ).exp();
    let lanes = |from: usize, of: &dyn Fn(f32) -> f32| {
        F32x::new(std::array::from_fn(|i| of(std::f32::consts::TAU * frequency_hz(from + i, modes) / RATE_HZ)))
    };
    let mut banks: Vec<BiquadBank<F32x>> = (0..modes / 8)
        .map(|b| {
            let none = F32x::splat(0.0);
            BiquadBank::with_coefs(BiquadCoefs {
                a1: lanes(8 * b, &|theta| -2.0 * r * theta.cos()),
                a2: F32x::splat(r * r),
                b0: lanes(8 * b, &|theta| theta.sin() / modes as f32),
                b1: none,
                b2: none,
            })
        })
        .collect();
    let wide = best(modes, |u| {
        let input = Frame::splat(u);
        let mut sum = F32x::splat(0.0);
        for bank in &mut banks {
            sum += F32x::from_frame(&bank.tick(&input));
        }
        sum.reduce_add()
    });
    let mut resonators: Vec<_> = (0..modes).map(|i| resonator_hz(frequency_hz(i, modes), 6.4)).collect();
    let single = best(modes, |u| resonators.iter_mut().map(|r| r.tick(&[u].into())[0]).sum());
    println!("{wide:.3} {single:.3}");
}
