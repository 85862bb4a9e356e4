//! A force that lasts, through the ring's taps and the bank, against the convolution with the modes
//! two samples later.

use asperity_dsp::hertz::{FORCE_HISTORY, HertzPulse, KERNEL_LATENCY, spread_force, take};
use asperity_dsp::modal_bank::{GroupOptions, GroupState, Inputs, ModalBank, design_groups};
use asperity_dsp::mode::Mode;
use asperity_dsp::simd::Level;
use core::f64::consts::PI;

const RATE_HZ: f64 = 44_100.0;
const COUNT: usize = 3000;
/// Steps of the convolution in a sample.
const FINE: usize = 64;

fn modes() -> Vec<Mode> {
    let mode = |i: i32| Mode {
        frequency_hz: 330.0 * (1.0 + 0.61 * f64::from(i)).powf(1.4),
        decay_per_s: 20.0 + 15.0 * f64::from(i),
        amplitude: 0.3 + 0.1 * f64::from(i % 4),
        phase_rad: 0.3 * f64::from(i % 3),
    };
    (0..10).map(mode).collect()
}

/// ∫ F(t) h(n − t) dt by the recursion of each mode in fine steps, the force a straight line over
/// each: exact to its curvature.
fn convolved(modes: &[Mode], force: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut out = vec![0.0; COUNT];
    let step = 1.0 / FINE as f64;
    for mode in modes {
        let (decay, angle) =
            (mode.decay_per_s / RATE_HZ * step, 2.0 * PI * mode.frequency_hz / RATE_HZ * step);
        let turn = |part: f64| {
            let ((sin, cos), size) = ((angle * part).sin_cos(), (-decay * part).exp());
            [size * cos, size * sin]
        };
        let ([cos, sin], [half_cos, half_sin]) = (turn(1.0), turn(0.5));
        let (sin_phase, cos_phase) = mode.phase_rad.sin_cos();
        let [mut re, mut im] = [0.0; 2];
        for (n, y) in out.iter_mut().enumerate() {
            if n > 0 {
                for k in 0..FINE {
                    let t = (n - 1) as f64 + (k as f64 + 0.5) * step;
                    (re, im) = (re * cos - im * sin, re * sin + im * cos);
                    let f = force(t) * step;
                    (re, im) = (re + f * half_cos, im + f * half_sin);
                }
            }
            *y += mode.amplitude * (im * cos_phase + re * sin_phase);
        }
    }
    out
}

/// The bank under impulses, cut into stretches, as many samples earlier as the ring is late.
fn rendered(modes: &[Mode], impulses: &[f64], cut: usize) -> Vec<f64> {
    let groups = design_groups(modes, RATE_HZ, &GroupOptions::IMPULSE_RING);
    let groups = groups.collect::<Result<Vec<_>, _>>().unwrap();
    let states = vec![GroupState::REST; groups.len()];
    let mut bank = ModalBank::new(Level::detect(), groups, states);
    let input: Vec<f32> = impulses.iter().map(|x| *x as f32).collect();
    let mut out = vec![0.0; COUNT];
    for first in (0..COUNT).step_by(cut) {
        let stretch = first..(first + cut).min(COUNT);
        bank.render(first as u64, Inputs::One(&input[stretch.clone()]), &mut out[stretch]);
    }
    out[KERNEL_LATENCY..].iter().map(|y| f64::from(*y)).collect()
}

fn error_db(found: &[f64], wanted: &[f64]) -> f64 {
    let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let error: Vec<f64> = found.iter().zip(wanted).map(|(f, w)| f - w).collect();
    10.0 * (square(&error) / square(wanted)).log10()
}

/// Error for a force over time in samples, dB.
fn error_of(force: impl Fn(f64) -> f64) -> f64 {
    let modes = modes();
    let mean = |n: usize| {
        let fine = |k: usize| force(n as f64 - 0.5 + (k as f64 + 0.5) / FINE as f64);
        (0..FINE).map(fine).sum::<f64>() / FINE as f64
    };
    let steps: Vec<f64> = (0..COUNT).map(mean).collect();
    let mut behind = vec![0.0; FORCE_HISTORY];
    behind.extend(&steps);
    let mut spread = vec![0.0; COUNT];
    spread_force(&behind, &mut spread);
    let wanted = convolved(&modes, force);
    let found = rendered(&modes, &spread, COUNT);
    assert!(found == rendered(&modes, &spread, 7), "the split into stretches is heard");
    error_db(&found, &wanted)
}

#[test]
fn a_force_that_lasts_is_the_convolution_with_the_modes() {
    let cosine = |samples: f64| {
        move |t: f64| {
            let u = (t - 20.0) / samples;
            if (0.0..1.0).contains(&u) { 0.5 - 0.5 * (2.0 * PI * u).cos() } else { 0.0 }
        }
    };
    // Fades in, so that nothing but the sine is heard.
    let sine = |hz: f64| {
        move |t: f64| {
            (2.0 * PI * hz / RATE_HZ * t).sin() * (0.5 - 0.5 * (PI * (t / 400.0).clamp(0.0, 1.0)).cos())
        }
    };
    let mut all = Vec::new();
    for samples in [44.1, 14.7] {
        all.push((format!("raised cosine of {samples} samples"), error_of(cosine(samples))));
    }
    for hz in [50.0, 200.0, 1000.0, 3000.0, 6000.0, 8000.0] {
        all.push((format!("sine of {hz} Hz"), error_of(sine(hz))));
    }
    for (name, error_db) in &all {
        println!("{name}: {error_db:.1} dB");
    }
    // The direct term is exact for a slow force: what is left grows with frequency.
    let bound_db = |name: &str| match name {
        _ if name.starts_with("raised") => -55.0,
        "sine of 3000 Hz" => -34.0,
        "sine of 6000 Hz" => -20.0,
        "sine of 8000 Hz" => -14.0,
        _ => -65.0,
    };
    for (name, error_db) in all {
        assert!(error_db <= bound_db(&name), "{name}: {error_db} dB");
    }
}

#[test]
fn a_collision_of_25_samples_is_the_convolution_with_the_modes() {
    let modes = modes();
    let (onset, samples) = (20.6_f64, 25.0_f64);
    let pulse = HertzPulse::elastic(1.0, samples / RATE_HZ);
    let mut spread = vec![0.0; 4096];
    pulse.deposit(&mut spread, onset as u64, onset.fract(), RATE_HZ);
    let wanted = convolved(&modes, |t| asperity_dsp::hertz::pulse_shape((t - onset) / samples) / samples);
    let mut input = vec![0.0; COUNT];
    take(&mut spread, 0, &mut input);
    let input: Vec<f64> = input.into_iter().map(f64::from).collect();
    let error_db = error_db(&rendered(&modes, &input, COUNT), &wanted);
    println!("{error_db:.1} dB");
    assert!(error_db <= -60.0, "{error_db} dB");
}
