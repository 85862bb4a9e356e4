//! Made impacts through the whole fit: `table [SEEDS [FIRST [MODES,…]]] [-v]`, `table pushes [SEEDS
//! [FIRST]]`
//!
//! Each is 0.2 s of noise and then 2 s of modes struck at once ([`impact`]) or pushed ([`pushes`]),
//! and is fitted as a user's file is: without a hint.
//!
//! | column | what |
//! |---|---|
//! | `missed` | identifiable modes that were not found, of all that are there |
//! | `spurious` | modes that are no true one's, of all found |
//! | `f`, `d` over the bound | robust rms error of frequency and decay over the Cramér–Rao bound |
//! | `in4` | part of the modes with both within four bounds |
//! | `below` | resynthesis under the best that an unbiased fit can do, dB: least .. most |
//! | `contact` | longest contact that was believed, ms: 0 is right |
//! | `s` | processor time, median .. most |

mod pushes;

use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_evidence::cramer_rao::cramer_rao;
use asperity_evidence::impact::{Impact, impact};
use asperity_evidence::process::cpu_seconds;
use asperity_evidence::score::{Score, robust_rms, score};
use asperity_fit::{Fit, FitOptions, FittedMode, Recording, fit};

const RATE_HZ: f64 = 44_100.0;
/// Noise before the strike, s.
const BEFORE_S: f64 = 0.2;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "-v").collect();
    let verbose = std::env::args().any(|arg| arg == "-v");
    let pushed = args.first().is_some_and(|arg| arg == "pushes");
    let number = |k: usize, usual: u64| args.get(k).and_then(|arg| arg.parse().ok()).unwrap_or(usual);
    if pushed {
        pushes::table(number(1, 3), number(2, 1));
        return;
    }
    let counts: Vec<usize> = match args.get(2) {
        Some(list) => list.split(',').filter_map(|k| k.parse().ok()).collect(),
        None => vec![10, 30, 60, 120],
    };
    println!(
        "   K  SNR    missed  spurious   f/CRB  d/CRB    in4   below limit dB  contact ms  s (median .. most)"
    );
    for modes in counts {
        for snr_db in [60.0, 40.0, 20.0] {
            let mut cell = Cell::default();
            for seed in number(1, 1)..number(1, 1) + number(0, 3) {
                cell.add(&impact(modes, snr_db, seed, RATE_HZ, 2.0), seed, verbose);
            }
            println!("{modes:4} {snr_db:4} {}", cell.text());
        }
    }
}

/// `made` after a stretch of its own noise, fitted; its processor time.
fn fitted(clean: &[f64], noise_std: f64, seed: u64) -> (Fit, f64) {
    let mut rng = Rng::new(seed ^ 0xbe_f0_4e);
    let mut samples: Vec<f64> =
        (0..(BEFORE_S * RATE_HZ) as usize).map(|_| noise_std * rng.normal()).collect();
    samples.extend(clean);
    let recording = Recording::from_samples("made", samples, RATE_HZ).expect("it is a recording");
    let clock = cpu_seconds();
    let options = FitOptions { threads: 1, ..FitOptions::default() };
    let fit = fit(&recording, &options, &mut |_| {}).expect("it can be fitted");
    (fit, cpu_seconds() - clock)
}

/// Modes with their phase where the strike was, wherever its onset was found.
fn at_the_strike(fit: &Fit, strike_s: f64) -> Vec<Mode> {
    let early_s = strike_s - fit.onset_s;
    let moved = |mode: Mode| Mode {
        amplitude: mode.amplitude * (-mode.decay_per_s * early_s).exp(),
        phase_rad: mode.phase_rad + std::f64::consts::TAU * mode.frequency_hz * early_s,
        ..mode
    };
    fit.modes.iter().map(FittedMode::mode).map(moved).collect()
}

/// What several impacts of a kind gave.
#[derive(Default)]
struct Cell {
    identifiable: usize,
    missed: usize,
    spurious: usize,
    found: usize,
    f_ratio: Vec<f64>,
    d_ratio: Vec<f64>,
    below_db: Vec<f64>,
    contact_s: f64,
    cpu_s: Vec<f64>,
}

impl Cell {
    fn add(&mut self, made: &Impact, seed: u64, verbose: bool) {
        let bounds = cramer_rao(&made.truth, made.rate_hz, made.clean.len(), made.noise_std);
        let (fit, cpu_s) = fitted(&made.noisy, made.noise_std, seed);
        let found = at_the_strike(&fit, BEFORE_S);
        let score = score(made, &bounds, &found);
        if verbose {
            told(&score, &fit, seed);
        }
        self.identifiable += score.identifiable;
        self.missed += score.missed;
        self.spurious += score.spurious;
        self.found += found.len();
        self.below_db.push(score.limit_db - score.snr_db);
        self.f_ratio.extend(score.f_ratio);
        self.d_ratio.extend(score.d_ratio);
        self.contact_s = self.contact_s.max(fit.start_offset_s);
        self.cpu_s.push(cpu_s);
    }

    fn text(&mut self) -> String {
        let near = self.f_ratio.iter().zip(&self.d_ratio).filter(|(f, d)| f.abs() < 4.0 && d.abs() < 4.0);
        let near = near.count() as f64 / self.f_ratio.len().max(1) as f64;
        self.cpu_s.sort_by(f64::total_cmp);
        self.below_db.sort_by(f64::total_cmp);
        format!(
            "{:4}/{:<5} {:3}/{:<5} {:6.2} {:6.2} {near:6.3}   {:5.2} .. {:5.2}   {:7.2}   {:5.2} .. {:5.2}",
            self.missed,
            self.identifiable,
            self.spurious,
            self.found,
            robust_rms(&self.f_ratio),
            robust_rms(&self.d_ratio),
            self.below_db.first().copied().unwrap_or(0.0),
            self.below_db.last().copied().unwrap_or(0.0),
            1e3 * self.contact_s,
            self.cpu_s[self.cpu_s.len() / 2],
            self.cpu_s[self.cpu_s.len() - 1],
        )
    }
}

fn told(score: &Score, fit: &Fit, seed: u64) {
    println!("seed {seed}: {} found; {:?}", fit.modes.len(), fit.warnings);
    for (mode, bound) in &score.missed_modes {
        println!("  missed {mode:?} {bound:?}");
    }
    for mode in &score.spurious_modes {
        println!("  spurious {mode:?}");
    }
}
