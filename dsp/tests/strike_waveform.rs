//! A strike through ring, bank and first samples against the equation: the integrated Hertz force
//! convolved with the modes.

use asperity_dsp::hertz::{HertzPulse, KERNEL_LATENCY, take};
use asperity_dsp::modal_bank::{GroupOptions, GroupState, Inputs, ModalBank, OnsetCorrection, design_groups};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::Level;
use std::f64::consts::PI;

const RATES_HZ: [f64; 5] = [22_050.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0];
const CONTACTS_S: [f64; 7] = [1e-6, 1e-5, 5e-5, 1e-4, 3e-4, 6e-4, 1e-3];

/// Points of the integrated pulse over its contact time.
const POINTS: usize = 4000;

/// The elastic pulse by integrating x'' = −x^1.5 (Runge–Kutta), its area 1 over u in 0…1.
fn integrated_pulse() -> Vec<f64> {
    let force = |x: f64| x.max(0.0).powf(1.5);
    // τ v / x_max = 2.943275, x_max = 1.25^0.4.
    let step = 2.943_275_18 * 1.25_f64.powf(0.4) / (POINTS * 4) as f64;
    let (mut x, mut v) = (0.0, 1.0);
    let mut pulse = vec![0.0];
    for _ in 0..POINTS {
        for _ in 0..4 {
            let (k1, l1) = (v, -force(x));
            let (k2, l2) = (v + 0.5 * step * l1, -force(x + 0.5 * step * k1));
            let (k3, l3) = (v + 0.5 * step * l2, -force(x + 0.5 * step * k2));
            let (k4, l4) = (v + step * l3, -force(x + step * k3));
            x += step / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
            v += step / 6.0 * (l1 + 2.0 * (l2 + l3) + l4);
        }
        pulse.push(force(x));
    }
    let area = pulse.iter().sum::<f64>() / POINTS as f64;
    pulse.iter().map(|f| f / area).collect()
}

/// Response of the modes to the pulse, sample by sample, by numerical convolution.
fn convolved(
    modes: &[Mode],
    pulse: &[f64],
    contact_s: f64,
    onset: f64,
    rate_hz: f64,
    count: usize,
) -> Vec<f64> {
    let mut out = vec![0.0; count];
    for mode in modes.iter().filter(|mode| mode.frequency_hz < 0.5 * rate_hz) {
        let omega = 2.0 * PI * mode.frequency_hz;
        // ∫ F(t) e^((d − iω) t) dt up to each point, by trapezia.
        let at = |i: usize| {
            let t = contact_s * i as f64 / POINTS as f64;
            let g = pulse[i] * (mode.decay_per_s * t).exp() / POINTS as f64;
            [g * (omega * t).cos(), -g * (omega * t).sin()]
        };
        let mut sums = vec![[0.0; 2]];
        for i in 1..=POINTS {
            let ([a, b], [c, d], last) = (at(i - 1), at(i), sums[i - 1]);
            sums.push([last[0] + 0.5 * (a + c), last[1] + 0.5 * (b + d)]);
        }
        for (n, y) in out.iter_mut().enumerate() {
            let t = (n as f64 - onset) / rate_hz;
            if t <= 0.0 {
                continue;
            }
            let place = (t / contact_s * POINTS as f64).min(POINTS as f64);
            let i = (place as usize).min(POINTS - 1);
            let share = place - i as f64;
            let [re, im] = [0, 1].map(|k| sums[i][k] + share * (sums[i + 1][k] - sums[i][k]));
            let (sin, cos) = (omega * t + mode.phase_rad).sin_cos();
            *y += mode.amplitude * (-mode.decay_per_s * t).exp() * (re * sin + im * cos);
        }
    }
    out
}

/// Waveform through the ring, the bank and the first samples.
fn rendered(modes: &[Mode], contact_s: f64, onset: f64, rate_hz: f64, count: usize) -> Vec<f64> {
    let groups = design_groups(modes, rate_hz, &GroupOptions::IMPULSE_RING);
    let groups = groups.collect::<Result<Vec<_>, _>>().unwrap();
    let states = vec![GroupState::REST; groups.len()];
    let mut bank = ModalBank::new(Level::detect(), groups, states);
    let first = OnsetCorrection::new(modes.iter().copied(), rate_hz).unwrap();
    let pulse = HertzPulse::elastic(1.0, contact_s);
    let ring = (count + 512).next_power_of_two();
    let (mut impulses, mut early) = (vec![0.0; ring], vec![0.0; ring]);
    pulse.deposit(&mut impulses, onset as u64, onset.fract(), rate_hz);
    first.deposit(&pulse, &mut early, onset as u64, onset.fract(), rate_hz);
    let (mut input, mut out) = (vec![0.0; count], vec![0.0; count]);
    take(&mut impulses, 0, &mut input);
    bank.render(0, Inputs::One(&input), &mut out);
    out.iter().zip(&early).skip(KERNEL_LATENCY).map(|(y, early)| f64::from(*y) + f64::from(*early)).collect()
}

fn bodies() -> Vec<(&'static str, Vec<Mode>)> {
    let mut rng = Rng::new(24);
    let mut body = |count: i32, top_hz: f64, damping: f64, phases: bool| -> Vec<Mode> {
        (0..count)
            .map(|i| Mode {
                frequency_hz: 300.0
                    * (top_hz / 300.0).powf((f64::from(i) + rng.uniform()) / f64::from(count)),
                decay_per_s: damping * (5.0 + 40.0 * f64::from(i)) * (0.5 + rng.uniform()),
                amplitude: 0.2 + rng.uniform(),
                phase_rad: if phases { 2.0 * PI * rng.uniform() } else { 0.0 },
            })
            .collect()
    };
    vec![
        ("a bell of 10 modes", body(10, 8_000.0, 1.0, false)),
        ("a box of 10 modes, damped", body(10, 8_000.0, 10.0, false)),
        ("a recorded body of 40 modes with phases", body(40, 8_000.0, 2.0, true)),
        ("a bar of 3 low modes", body(3, 1_500.0, 1.0, false)),
    ]
}

/// Error over the event's rms, and the share of its power before the first sample after the onset.
fn errors(modes: &[Mode], pulse: &[f64], contact_s: f64, rate_hz: f64, onset: f64) -> (f64, f64) {
    let count = (0.06 * rate_hz) as usize;
    let wanted = convolved(modes, pulse, contact_s, onset, rate_hz, count);
    let found = rendered(modes, contact_s, onset, rate_hz, count);
    let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let error: Vec<f64> = found.iter().zip(&wanted).map(|(f, w)| f - w).collect();
    let early = square(&found[..=onset as usize]) / square(&wanted);
    ((square(&error) / square(&wanted)).sqrt(), early)
}

#[test]
fn a_strike_is_the_modes_file_from_its_first_sample_on() {
    let pulse = integrated_pulse();
    for (name, modes) in bodies() {
        for rate_hz in RATES_HZ {
            let mut worst = (0.0, 0.0);
            for contact_s in CONTACTS_S {
                for onset in [100.0, 101.37, 102.93] {
                    let (error, early) = errors(&modes, &pulse, contact_s, rate_hz, onset);
                    // The ring reaches back two samples; ring and first samples cancel to rounding.
                    assert!(early < 1e-10, "{name}: {early:e} sounds before the contact");
                    worst = if error > worst.0 { (error, contact_s) } else { worst };
                }
            }
            println!("{name}, {rate_hz} Hz: {:.3} % at {:.0e} s", 100.0 * worst.0, worst.1);
            assert!(worst.0 < 0.01, "{name}, {rate_hz} Hz: {:.3} % at {:.0e} s", 100.0 * worst.0, worst.1);
        }
    }
}
