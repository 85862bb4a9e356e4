//! In how much noise a fit finds modes: `colours DRAWS SEED SECONDS [RATE_HZ] [BITS] [COLOUR…] [-v]`
//!
//! Every colour of `tests/common/noise.rs`; with `-v` the modes that were invented.
#[path = "../tests/common/mod.rs"]
mod common;

use asperity_fit::{Fit, FitOptions, Recording, fit};
use common::noise::{COLOURS, noise};

fn fitted(samples: Vec<f64>, rate_hz: f64, bits: u32) -> Fit {
    let mut recording = Recording::from_samples("noise", samples, rate_hz).expect("noise is a recording");
    if bits > 0 {
        recording.quantum = 2.0_f64.powi(1 - bits as i32);
    }
    let options = FitOptions { threads: 1, ..FitOptions::default() };
    fit(&recording, &options, &mut |_| {}).expect("noise can be fitted")
}

fn main() {
    let (flags, args): (Vec<String>, Vec<String>) = std::env::args().skip(1).partition(|a| a == "-v");
    let number = |i: usize, usual: f64| args.get(i).and_then(|a| a.parse().ok()).unwrap_or(usual);
    let (draws, seed, seconds) = (number(0, 20.0) as u64, number(1, 1.0) as u64, number(2, 2.0));
    let (rate_hz, bits) = (number(3, 44_100.0), number(4, 0.0) as u32);
    let wanted = args.get(5..).unwrap_or(&[]);
    println!("{draws} draws of {seconds} s at {rate_hz} Hz, {bits} bits (0: float), seeds from {seed}");
    for (name, colour) in COLOURS {
        if !wanted.is_empty() && !wanted.iter().any(|w| name.contains(w.as_str())) {
            continue;
        }
        let clock = common::cpu_seconds();
        let count = (seconds * rate_hz) as usize;
        let mut silent = 0;
        for draw in 0..draws {
            let fit = fitted(noise(colour, count, rate_hz, bits, 1000 * seed + draw), rate_hz, bits);
            silent += u64::from(fit.modes.is_empty());
            if !flags.is_empty() && !fit.modes.is_empty() {
                println!(
                    "  {name}, draw {draw}: {} modes, from {:.3} s + {:.2} ms to {:.3} s, capped {}",
                    fit.modes.len(),
                    fit.onset_s,
                    1e3 * fit.start_offset_s,
                    fit.end_s,
                    fit.warnings.iter().any(|w| matches!(w, asperity_fit::Warning::ModesCapped { .. }))
                );
                for m in fit.modes.iter().take(8) {
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
        }
        let seconds = (common::cpu_seconds() - clock) / draws as f64;
        println!("{name:22} without a mode: {silent} of {draws}   ({seconds:.2} s of CPU each)");
    }
}
