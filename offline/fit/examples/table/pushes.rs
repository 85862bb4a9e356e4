//! Bodies that are pushed for a while, not struck at once: is the end of the push found, and are
//! the modes right after it?

use super::{BEFORE_S, RATE_HZ, fitted};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use std::f64::consts::PI;

/// Noise under the mean power of the sound, dB.
const SNR_DB: f64 = 60.0;
/// Lengths of the push, s.
const PUSHES_S: [f64; 6] = [0.0003, 0.0005, 0.0007, 0.001, 0.002, 0.003];

/// One row a length of push and number of modes, over so many seeds.
pub fn table(seeds: u64, first: u64) {
    println!(
        "push ms  modes   contact found, ms (one a seed)    end of it off by, ms   decays off, % (worst median)   struck peak dB   s"
    );
    for push_s in PUSHES_S {
        for modes in [8, 24] {
            let rows: Vec<Row> = (first..first + seeds).map(|seed| Row::of(push_s, modes, seed)).collect();
            let worst = |value: fn(&Row) -> f64| rows.iter().map(value).fold(0.0, |a: f64, b| a.max(b.abs()));
            let contacts: Vec<String> = rows.iter().map(|r| format!("{:.2}", 1e3 * r.contact_s)).collect();
            println!(
                "{:7.2}  {modes:5}   {:32}  {:18.2}   {:28.2}   {:14.2}   {:.2}",
                1e3 * push_s,
                contacts.join(" "),
                1e3 * worst(|r| r.end_off_s),
                100.0 * worst(|r| r.decay_off),
                rows.iter().map(|r| r.peak_db).fold(f64::NEG_INFINITY, f64::max),
                worst(|r| r.cpu_s),
            );
        }
    }
}

struct Row {
    contact_s: f64,
    end_off_s: f64,
    decay_off: f64,
    peak_db: f64,
    cpu_s: f64,
}

impl Row {
    fn of(push_s: f64, count: usize, seed: u64) -> Self {
        let mut rng = Rng::new(seed ^ 0x9054);
        let modes: Vec<Mode> = (0..count).map(|_| drawn(&mut rng)).collect();
        let mut sound = pushed(&modes, push_s);
        let power = sound.iter().map(|x| x * x).sum::<f64>() / sound.len() as f64;
        let noise_std = power.sqrt() * 10.0_f64.powf(-SNR_DB / 20.0);
        sound.iter_mut().for_each(|x| *x += noise_std * rng.normal());
        let (fit, cpu_s) = fitted(&sound, noise_std, seed);
        let mut decays_off: Vec<f64> = modes
            .iter()
            .filter_map(|mode| {
                let gap_hz = |f: &f64| (f - mode.frequency_hz).abs();
                let nearest = fit
                    .modes
                    .iter()
                    .min_by(|a, b| gap_hz(&a.frequency_hz).total_cmp(&gap_hz(&b.frequency_hz)))?;
                Some((nearest.decay_per_s / mode.decay_per_s - 1.0).abs())
            })
            .collect();
        decays_off.sort_by(f64::total_cmp);
        Self {
            contact_s: fit.start_offset_s,
            end_off_s: fit.onset_s + fit.start_offset_s - BEFORE_S - push_s,
            decay_off: decays_off.get(decays_off.len() / 2).copied().unwrap_or(1.0),
            peak_db: fit.struck_peak_db,
            cpu_s,
        }
    }
}

/// 150 Hz – 9 kHz, T60 0.1–1.4 s, 20 dB of amplitudes.
fn drawn(rng: &mut Rng) -> Mode {
    Mode {
        frequency_hz: 150.0 * 60.0_f64.powf(rng.uniform()),
        decay_per_s: 5.0 * 14.0_f64.powf(rng.uniform()),
        amplitude: 0.1_f64.powf(rng.uniform()),
        phase_rad: 0.0,
    }
}

/// Two seconds of `modes` under a half-sine of force.
fn pushed(modes: &[Mode], push_s: f64) -> Vec<f64> {
    let push = (push_s * RATE_HZ).round();
    let force: Vec<f64> = (0..push as usize).map(|n| (PI * (n as f64 + 0.5) / push).sin()).collect();
    let mut out = vec![0.0; (2.0 * RATE_HZ) as usize];
    for mode in modes {
        let (sin, cos) = (std::f64::consts::TAU * mode.frequency_hz / RATE_HZ).sin_cos();
        let radius = (-mode.decay_per_s / RATE_HZ).exp();
        let (mut re, mut im) = (0.0, 0.0);
        for (n, x) in out.iter_mut().enumerate() {
            let driven = re + force.get(n).copied().unwrap_or(0.0);
            (re, im) = (radius * (driven * cos - im * sin), radius * (driven * sin + im * cos));
            *x += mode.amplitude * im;
        }
    }
    out
}
