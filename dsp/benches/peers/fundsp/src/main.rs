//! `fundsp-bank speed MODES`: mode-samples a nanosecond of banks built from the crate `fundsp`,
//! force in every sample: its eight-lane biquads by its `process` for blocks, by its `tick` for
//! samples, by `tick` with the states in a local copy for a block, and one resonator a mode. Best
//! of many segments.
//!
//! `fundsp-bank pitch RATE_HZ [NAME < RAW]`: what ring a mode of 30 Hz with a T60 of 10 s has, of
//! ours, of these, and of raw little-endian f32 samples of an impulse response on the standard
//! input.

mod ring;

use asperity_dsp::modal_bank::{GroupOptions, GroupState, Inputs, ModalBank, design_group};
use asperity_dsp::mode::Mode;
use asperity_dsp::simd::{Isa, Level};
use fundsp::biquad::BiquadCoefs;
use fundsp::biquad_bank::BiquadBank;
use fundsp::prelude32::*;
use ring::Ring;
use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::io::Read;
use std::time::Instant;

const BLOCK: usize = 64;
const SPEED_RATE_HZ: f64 = 44_100.0;
const SPEED_DECAY_PER_S: f64 = 20.0;
const PITCH_HZ: f64 = 30.0;
const PITCH_T60_S: f64 = 10.0;

/// Decay per second of a T60.
fn decay_per_s(t60_s: f64) -> f64 {
    1000f64.ln() / t60_s
}

/// Second argument of `resonator_hz`: its code has a Q there, whatever the argument is called.
fn q(frequency_hz: f64, decay_per_s: f64) -> f32 {
    (PI * frequency_hz / decay_per_s) as f32
}

/// Eight two-pole resonators, coefficients rounded once, from f64.
fn lanes(frequency_hz: impl Fn(usize) -> f64, decay_per_s: f64, gain: f64, rate_hz: f64) -> BiquadBank<F32x> {
    let r = (-decay_per_s / rate_hz).exp();
    let of = |f: &dyn Fn(f64) -> f64| {
        F32x::new(std::array::from_fn(|i| f(TAU * frequency_hz(i) / rate_hz) as f32))
    };
    BiquadBank::with_coefs(BiquadCoefs {
        a1: of(&|theta| -2.0 * r * theta.cos()),
        a2: of(&|_| r * r),
        b0: of(&|theta| gain * theta.sin()),
        b1: F32x::splat(0.0),
        b2: F32x::splat(0.0),
    })
}

fn force(samples: usize) -> Vec<f32> {
    let mut seed = 1_u32;
    let mut next = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 * 6e-8 - 0.5
    };
    (0..samples).map(|_| next()).collect()
}

/// Best of many segments of about a millisecond; `render` makes one block.
fn best(modes: usize, mut render: impl FnMut(&[f32], &mut [f32])) -> f64 {
    let samples = BLOCK * (1 + 2_000_000 / (modes * BLOCK));
    let input = force(samples);
    let mut output = vec![0.0; samples];
    (0..60)
        .map(|_| {
            let start = Instant::now();
            for (u, y) in input.chunks(BLOCK).zip(output.chunks_mut(BLOCK)) {
                render(u, y);
            }
            black_box(&output);
            (samples * modes) as f64 / start.elapsed().as_nanos() as f64
        })
        .fold(0.0, f64::max)
}

fn speed(modes: usize) {
    let frequency_hz = |i: usize| 100.0 + 15_000.0 * i as f64 / modes as f64;
    let bank =
        |b: usize| lanes(|i| frequency_hz(8 * b + i), SPEED_DECAY_PER_S, 1.0 / modes as f64, SPEED_RATE_HZ);
    let mut banks: Vec<BiquadBank<F32x>> = (0..modes / 8).map(bank).collect();
    let by_sample = best(modes, |input, output| {
        for (u, y) in input.iter().zip(output) {
            let input = Frame::splat(*u);
            let mut sum = F32x::splat(0.0);
            for bank in &mut banks {
                sum += F32x::from_frame(&bank.tick(&input));
            }
            *y = sum.reduce_add();
        }
    });
    let (mut heard, mut made) = (BufferVec::new(8), BufferVec::new(8));
    let by_process = best(modes, |input, output| {
        for channel in 0..8 {
            heard.channel_f32_mut(channel)[..BLOCK].copy_from_slice(input);
        }
        let mut sums = [F32x::splat(0.0); BLOCK / 8];
        for bank in &mut banks {
            bank.process(BLOCK, &heard.buffer_ref(), &mut made.buffer_mut());
            for channel in 0..8 {
                for (i, sum) in sums.iter_mut().enumerate() {
                    *sum += made.at(channel, i);
                }
            }
        }
        for (y, sum) in output.chunks_mut(8).zip(&sums) {
            y.copy_from_slice(sum.as_array());
        }
    });
    let by_block = best(modes, |input, output| {
        let mut sums = [F32x::splat(0.0); BLOCK];
        for bank in &mut banks {
            let mut local = bank.clone(); // in registers for a block
            for (u, sum) in input.iter().zip(&mut sums) {
                *sum += F32x::from_frame(&local.tick(&Frame::splat(*u)));
            }
            *bank = local;
        }
        for (sum, y) in sums.iter().zip(output) {
            *y = sum.reduce_add();
        }
    });
    let mut resonators: Vec<_> = (0..modes)
        .map(|i| resonator_hz(frequency_hz(i) as f32, q(frequency_hz(i), SPEED_DECAY_PER_S)))
        .collect();
    let single = best(modes, |input, output| {
        for (u, y) in input.iter().zip(output) {
            *y = resonators.iter_mut().map(|r| r.tick(&[*u].into())[0]).sum();
        }
    });
    println!("{by_process:.3} {by_sample:.3} {by_block:.3} {single:.3}");
}

fn show(name: &str, rate_hz: f64, response: &[f32]) {
    let ring = Ring::of(response, rate_hz, PITCH_HZ);
    println!(
        "  {name:<36} {:>12.5} cents   T60 {:>11.5} %",
        1200.0 * (ring.frequency_hz / PITCH_HZ).log2(),
        100.0 * (decay_per_s(PITCH_T60_S) / ring.decay_per_s - 1.0)
    );
}

/// The response to an impulse of 1, as long as the ring is looked at.
fn response(rate_hz: f64, mut tick: impl FnMut(f32) -> f32) -> Vec<f32> {
    (0..(ring::LENGTH_S * rate_hz) as usize).map(|n| tick(if n == 0 { 1.0 } else { 0.0 })).collect()
}

fn pitch(rate_hz: f64) {
    let decay = decay_per_s(PITCH_T60_S);
    let (theta, r) = (TAU * PITCH_HZ / rate_hz, (-decay / rate_hz).exp());
    let exact = |n: usize| (r.powi(n as i32) * (theta * n as f64).sin()) as f32;
    show(
        "the equation (what the method shows)",
        rate_hz,
        &(0..(ring::LENGTH_S * rate_hz) as usize).map(exact).collect::<Vec<_>>(),
    );
    let mode = Mode { frequency_hz: PITCH_HZ, decay_per_s: decay, amplitude: 1.0, phase_rad: 0.0 };
    for isa in Isa::ALL {
        let Some(kernel) = Level::find(isa) else { continue };
        let group =
            [design_group(&[mode], rate_hz, &GroupOptions::IMPULSE_RING).expect("a mode like any other")];
        let mut bank = ModalBank::new(kernel, group, [GroupState::REST]);
        let mut input = vec![0.0; (ring::LENGTH_S * rate_hz) as usize];
        input[0] = 1.0;
        let mut output = vec![0.0; input.len()];
        bank.render(0, Inputs::One(&input), &mut output);
        show(&format!("asperity, {isa:?}"), rate_hz, &output);
    }
    let mut bank = lanes(|_| PITCH_HZ, decay, 1.0, rate_hz);
    let biquads = response(rate_hz, |u| bank.tick(&Frame::splat(u))[0]);
    show("fundsp, eight-lane biquads", rate_hz, &biquads);
    let mut resonator = resonator_hz(PITCH_HZ as f32, q(PITCH_HZ, decay));
    resonator.set_sample_rate(rate_hz);
    show("fundsp, resonator_hz", rate_hz, &response(rate_hz, |u| resonator.tick(&[u].into())[0]));
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize| arguments.get(i).and_then(|a| a.parse::<f64>().ok());
    match (arguments.first().map(String::as_str), number(1), arguments.get(2)) {
        (Some("speed"), Some(modes), _) => speed(modes as usize),
        (Some("pitch"), Some(rate_hz), None) => pitch(rate_hz),
        (Some("pitch"), Some(rate_hz), Some(name)) => {
            let mut raw = Vec::new();
            std::io::stdin().read_to_end(&mut raw).expect("readable");
            let samples = raw.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
            show(name, rate_hz, &samples.collect::<Vec<_>>());
        }
        _ => eprintln!("usage: fundsp-bank speed MODES | pitch RATE_HZ [NAME < RAW]"),
    }
}
