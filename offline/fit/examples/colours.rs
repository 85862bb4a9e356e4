//! Fits of noise of any colour: `colours DRAWS SEED SECONDS [RATE_HZ] [BITS] [COLOUR…] [-s] [-v]`
//!
//! Every colour of `asperity_evidence::coloured_noise`, in which nothing rings; with `-s`, four
//! modes struck a quarter of a second after the start, 20 dB louder; with `-v` the modes that were
//! invented.

use asperity_dsp::mode::Mode;
use asperity_evidence::coloured_noise::{COLOURS, noise};
use asperity_evidence::impact::render_fast;
use asperity_evidence::process::cpu_seconds;
use asperity_fit::{Fit, FitOptions, FittedMode, Recording, Warning, fit};

/// What is struck.
const STRUCK: [(f64, f64, f64); 4] =
    [(180.0, 6.0, 0.4), (712.4, 9.0, 1.4), (2210.0, 20.0, -2.0), (5100.0, 40.0, 0.3)];

fn fitted(samples: Vec<f64>, rate_hz: f64, bits: u32) -> Fit {
    let mut recording = Recording::from_samples("noise", samples, rate_hz).expect("noise is a recording");
    if bits > 0 {
        recording.quantum = 2.0_f64.powi(1 - bits as i32);
    }
    let options = FitOptions { threads: 1, ..FitOptions::default() };
    fit(&recording, &options, &mut |_| {}).expect("noise can be fitted")
}

/// `samples`, 20 dB quieter, and what is struck.
fn strike(samples: &mut [f64], rate_hz: f64) {
    samples.iter_mut().for_each(|x| *x *= 0.1);
    let modes = STRUCK.map(|(frequency_hz, decay_per_s, phase_rad)| Mode {
        frequency_hz,
        decay_per_s,
        amplitude: 0.2,
        phase_rad,
    });
    let start = (0.25 * rate_hz) as usize;
    let ringing = render_fast(&modes, rate_hz, samples.len() - start);
    samples[start..].iter_mut().zip(ringing).for_each(|(x, y)| *x += y);
}

/// Whether this is one of what was struck.
fn struck(mode: &FittedMode) -> bool {
    STRUCK.iter().any(|(hz, ..)| (mode.frequency_hz - hz).abs() < 0.01 * hz.max(100.0))
}

fn main() {
    let (flags, args): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|a| a.starts_with('-'));
    let has = |flag: &str| flags.iter().any(|f| f == flag);
    let number = |i: usize, usual: f64| args.get(i).and_then(|a| a.parse().ok()).unwrap_or(usual);
    let (draws, seed, seconds) = (number(0, 20.0) as u64, number(1, 1.0) as u64, number(2, 2.0));
    let (rate_hz, bits) = (number(3, 44_100.0), number(4, 0.0) as u32);
    let wanted = args.get(5..).unwrap_or(&[]);
    println!("{draws} draws of {seconds} s at {rate_hz} Hz, {bits} bits (0: float), seeds from {seed}");
    for (name, colour) in COLOURS {
        if !wanted.is_empty() && !wanted.iter().any(|w| name.contains(w.as_str())) {
            continue;
        }
        let clock = cpu_seconds();
        let count = (seconds * rate_hz) as usize;
        let (mut clean, mut invented, mut met) = (0, 0, 0);
        for draw in 0..draws {
            let mut samples = noise(colour, count, rate_hz, bits, 1000 * seed + draw);
            if has("-s") {
                strike(&mut samples, rate_hz);
            }
            let fit = fitted(samples, rate_hz, bits);
            let of_noise: Vec<&FittedMode> = fit.modes.iter().filter(|m| !(has("-s") && struck(m))).collect();
            clean += u64::from(of_noise.is_empty());
            invented += of_noise.len();
            met += fit.modes.len() - of_noise.len();
            if has("-v") && !of_noise.is_empty() {
                print_draw(&fit, &of_noise, draw);
            }
        }
        let seconds = (cpu_seconds() - clock) / draws as f64;
        let struck = if has("-s") { format!(", {met} struck ones found") } else { String::new() };
        println!(
            "{name:22} without an invented mode: {clean} of {draws}; {invented} invented{struck}   ({seconds:.2} s of CPU each)"
        );
    }
}

fn print_draw(fit: &Fit, of_noise: &[&FittedMode], draw: u64) {
    println!(
        "  draw {draw}: {} invented, from {:.3} s + {:.2} ms to {:.3} s{}",
        of_noise.len(),
        fit.onset_s,
        1e3 * fit.start_offset_s,
        fit.end_s,
        if fit.warnings.iter().any(|w| matches!(w, Warning::ModesCapped { .. })) { ", capped" } else { "" }
    );
    for m in of_noise.iter().take(8) {
        println!(
            "    {:8.2} Hz ± {:.3}, decay {:7.2} ± {:.2} 1/s, amplitude {:.5} ± {:.5}",
            m.frequency_hz,
            m.frequency_std_hz,
            m.decay_per_s,
            m.decay_std_per_s,
            m.amplitude,
            m.amplitude_std
        );
    }
}
