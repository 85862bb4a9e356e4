//! Waveforms of a struck bank, against closed forms, figures of scipy and its own reference in f64.

use super::made::{PLAIN, RATES_HZ, body, design, error_db, kernels, mode, reference, render};
use asperity_dsp::modal_bank::{GroupOptions, design_group};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::Level;
use std::f64::consts::PI;

#[test]
fn an_impulse_rings_as_the_formula_says_at_every_rate_and_phase() {
    for rate in RATES_HZ {
        for kernel in kernels() {
            for (f, d, phase) in
                [(440.0, 5.0, 0.0), (3_000.0, 200.0, 1.0), (82.4, 1.0, -2.2), (9_800.0, 30.0, 3.0)]
            {
                let groups = design(&[mode(f, d, 0.7, phase)], rate);
                let mut impulses = vec![0.0; (0.2 * rate) as usize];
                impulses[0] = 2e-3;
                let y = render(kernel, &groups, &impulses, 17, || 128);
                for (n, y) in y.iter().enumerate() {
                    let t = n as f64 / rate;
                    let exact = 1.4e-3 * (-d * t).exp() * (2.0 * PI * f * t + phase).sin();
                    assert!((f64::from(*y) - exact).abs() < 1.4e-3 * 3e-5, "{rate} Hz, {f} Hz, sample {n}");
                }
            }
        }
    }
}

#[test]
fn the_bank_agrees_with_scipy() {
    let modes = [mode(440.0, 12.0, 0.8, 0.0), mode(3217.5, 55.0, 0.5, 1.1), mode(61.7, 3.0, 1.3, -0.6)];
    // scipy.signal.lfilter, tests/independent/modal_bank.py.
    // Rate, (sample, value), rms over half a second.
    type Figures = (f64, [(usize, f64); 7], f64);
    let figures: [Figures; 2] = [
        (
            44_100.0,
            [
                (0, -0.000_288_431_535_4),
                (44, 0.000_333_732_255),
                (1323, -0.000_747_913_951_3),
                (2646, -0.000_618_679_326_8),
                (4851, -0.000_238_993_652_3),
                (11_025, 0.000_742_685_691_8),
                (21_609, 0.000_121_622_601),
            ],
            5.805_079_871e-4,
        ),
        (
            192_000.0,
            [
                (0, -0.000_288_431_535_4),
                (192, 0.000_313_578_994_7),
                (5760, -0.000_747_913_951_2),
                (11_520, -0.000_618_679_327_1),
                (21_120, -0.000_238_993_652_4),
                (48_000, 0.000_742_685_691_7),
                (94_080, 0.000_121_622_601_8),
            ],
            5.805_102_948e-4,
        ),
    ];
    for (rate, values, rms) in figures {
        let mut impulses = vec![0.0_f32; (0.5 * rate) as usize];
        for (t, j) in [(0.0, 1e-3), (0.05, -4e-4), (0.1, 7e-4)] {
            impulses[(t * rate).round() as usize] = j;
        }
        for kernel in kernels() {
            let y = render(kernel, &design(&modes, rate), &impulses, 0, || 64);
            for (n, expected) in values {
                assert!((f64::from(y[n]) - expected).abs() < 1e-7 * 0.1, "{rate} Hz, sample {n}: {}", y[n]);
            }
            let measured = (y.iter().map(|y| f64::from(*y).powi(2)).sum::<f64>() / y.len() as f64).sqrt();
            assert!((measured / rms - 1.0).abs() < 5e-6, "{rate} Hz: rms {measured}");
        }
    }
}

/// Pitch error in cents and relative error of T60 of a rendered impulse, by comparing the phasor of
/// the output in two windows (Hann, many periods) with that of the formula.
fn pitch_and_t60_error(y: &[f32], m: &Mode, rate: f64) -> (f64, f64) {
    let window = (40.0 / m.frequency_hz * rate) as usize;
    let gap = y.len() - window;
    let phasor = |from: usize, sample: &dyn Fn(usize) -> f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for n in 0..window {
            let w = 0.5 - 0.5 * (2.0 * PI * n as f64 / window as f64).cos();
            let angle = 2.0 * PI * m.frequency_hz * (from + n) as f64 / rate;
            let x = w * sample(from + n);
            re += x * angle.cos();
            im += x * angle.sin();
        }
        (im.atan2(re), (re * re + im * im).sqrt())
    };
    let exact = |n: usize| {
        let t = n as f64 / rate;
        m.amplitude * (-m.decay_per_s * t).exp() * (2.0 * PI * m.frequency_hz * t).sin()
    };
    let turn = |sample: &dyn Fn(usize) -> f64| {
        let (a, b) = (phasor(0, sample), phasor(gap, sample));
        (b.0 - a.0, (a.1 / b.1).ln())
    };
    let (ours, theirs) = (turn(&|n| f64::from(y[n])), turn(&exact));
    let time = gap as f64 / rate;
    let hertz = (ours.0 - theirs.0) / (2.0 * PI * time);
    (1200.0 * (1.0 - hertz / m.frequency_hz).log2(), theirs.1 / ours.1 - 1.0)
}

#[test]
fn a_30_hz_mode_keeps_pitch_and_decay_at_every_rate() {
    let m = mode(30.0, 3.0 * std::f64::consts::LN_10 / 10.0, 1.0, 0.0);
    assert!((m.t60_s() - 10.0).abs() < 1e-12);
    for rate in RATES_HZ {
        for kernel in kernels() {
            // Slightly detuned copies: coefficients round differently.
            for shift in [1.0, 0.93, 1.017, 1.08] {
                let m = mode(30.0 * shift, m.decay_per_s, 1.0, 0.0);
                let mut impulses = vec![0.0; (5.0 * rate) as usize];
                impulses[0] = 1.0;
                let y = render(kernel, &design(&[m], rate), &impulses, 0, || 4096);
                let (cents, t60) = pitch_and_t60_error(&y, &m, rate);
                println!("{rate} Hz {:?}: {cents:.1e} cent, T60 {:.1e} %", kernel.isa(), 100.0 * t60);
                assert!(cents.abs() < 0.001, "{rate} Hz, {:?}: {cents} cent", kernel.isa());
                assert!(t60.abs() < 1e-4, "{rate} Hz, {:?}: T60 {t60}", kernel.isa());
            }
        }
    }
}

#[test]
fn without_the_trim_the_decay_is_what_f32_can_store() {
    let m = mode(30.0, 0.690_775_5, 1.0, 0.0);
    let untrimmed = GroupOptions { true_t60: false, ..PLAIN };
    let group = design_group(&[m], 192_000.0, &untrimmed).unwrap();
    let mut impulses = vec![0.0; 960_000];
    impulses[0] = 1.0;
    let y = render(Level::detect(), &[group], &impulses, 0, || 4096);
    let (_, t60) = pitch_and_t60_error(&y, &m, 192_000.0);
    assert!(t60.abs() > 3e-4 && t60.abs() < 1e-2, "{t60}");
}

#[test]
fn white_force_leaves_no_error_above_minus_100_db() {
    let mut rng = Rng::new(3);
    for rate in [44_100.0, 192_000.0] {
        for count in [16, 64, 256, 1024] {
            let modes = body(count, &mut rng);
            let impulses: Vec<f32> = (0..8192).map(|_| 1e-6 * rng.normal() as f32).collect();
            let exact = reference(&modes, rate, &impulses);
            for kernel in kernels() {
                let db = error_db(&render(kernel, &design(&modes, rate), &impulses, 0, || 64), &exact);
                println!("{count} modes at {rate} Hz, {:?}: {db:.1} dB", kernel.isa());
                assert!(db <= -100.0, "{count} modes at {rate} Hz, {:?}: {db} dB", kernel.isa());
            }
        }
    }
}

#[test]
fn two_seconds_of_white_force_leave_no_error_above_100_db() {
    let mut rng = Rng::new(4);
    for rate in [44_100.0, 192_000.0] {
        let modes = [mode(30.0, 0.690_775_5, 1.0, 0.0)];
        let impulses: Vec<f32> = (0..(2.0 * rate) as usize).map(|_| 1e-6 * rng.normal() as f32).collect();
        let exact = reference(&modes, rate, &impulses);
        for kernel in kernels() {
            let db = error_db(&render(kernel, &design(&modes, rate), &impulses, 0, || 64), &exact);
            println!("{rate} Hz, {:?}: {db:.1} dB", kernel.isa());
            assert!(db <= -100.0, "{rate} Hz, {:?}: {db} dB", kernel.isa());
        }
    }
}
