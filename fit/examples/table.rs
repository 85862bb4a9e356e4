//! Prints the synthetic table of the fit: misses, spurious modes, errors over the bound, time.

use asperity_dsp::mode::Mode;
use asperity_fit::analysis::analyse;
use asperity_fit::fitted::partial_of;
use asperity_fit::limits::Limits;
use asperity_fit::partial::Partial;
use asperity_fit::refinement::{Bounds, refine};
use asperity_measure::cramer_rao::cramer_rao;
use asperity_measure::impact::{Impact, impact};
use asperity_measure::process::cpu_seconds;
use asperity_measure::score::{robust_rms, score};
use std::f64::consts::PI;

fn to_mode(p: &Partial, rate: f64) -> Mode {
    Mode {
        frequency_hz: p.omega * rate / (2.0 * PI),
        decay_per_s: p.delta * rate,
        amplitude: p.c.norm(),
        phase_rad: p.c.arg() + 0.5 * PI,
    }
}

/// The likeliest modes as refinement from the truth finds them: what no fit that has to search can beat.
fn likeliest(impact: &Impact, limits: &Limits) -> Vec<Mode> {
    let mut partials: Vec<Partial> = impact.truth.iter().map(|m| partial_of(m, impact.rate_hz)).collect();
    refine(&impact.noisy, &mut partials, &limits.bounds, 200);
    partials.iter().map(|p| to_mode(p, impact.rate_hz)).collect()
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let seeds: u64 = args.get(1).and_then(|s| s.parse().ok()).unwrap_or(3);
    let first: u64 = args.get(2).and_then(|s| s.parse().ok()).unwrap_or(1);
    let only: Option<usize> = args.get(3).and_then(|s| s.parse().ok());
    let verbose = args.iter().any(|a| a == "-v");
    println!("   K  SNR  missed     spurious  f/CRB  d/CRB  in4    below limit dB  s (median)");
    for modes in [10, 30, 100] {
        if only.is_some_and(|k| k != modes) {
            continue;
        }
        for snr in [60.0, 40.0, 20.0] {
            let (mut missed, mut spurious, mut total, mut f, mut d, mut below, mut times) =
                (0, 0, 0, vec![], vec![], vec![], vec![]);
            for seed in first..first + seeds {
                let impact = impact(modes, snr, seed, 44_100.0, 2.0);
                let bounds = cramer_rao(&impact.truth, 44_100.0, impact.clean.len(), impact.noise_std);
                let limits = Limits {
                    bounds: Bounds {
                        omega_low: 2.0 * PI * 20.0 / 44_100.0,
                        omega_high: 0.98 * PI,
                        delta_low: 0.115 / 44_100.0,
                        delta_high: 1500.0 / 44_100.0,
                        amplitude_high: 8.0 * impact.noisy.iter().fold(0.0, |a: f64, x| a.max(x.abs())),
                        energy_cost: 0.0,
                    },
                    max_partials: 200,
                    least_energy: 1e-9,
                    threads: 1,
                    rate_hz: 44_100.0,
                    least_noise: 1e-14,
                };
                let clock = cpu_seconds();
                let found = analyse(&impact.noisy, &limits, &mut |_| {});
                times.push(cpu_seconds() - clock);
                let found: Vec<Mode> = found.partials.iter().map(|p| to_mode(p, 44_100.0)).collect();
                let score = score(&impact, &bounds, &found);
                missed += score.missed;
                spurious += score.spurious;
                total += score.identifiable;
                if verbose {
                    let likeliest = likeliest(&impact, &limits);
                    let best = asperity_measure::score::score(&impact, &bounds, &likeliest);
                    println!(
                        "from the truth: f/CRB {:.2}, {:.2} dB below limit; found: f/CRB {:.2}",
                        robust_rms(&best.f_ratio),
                        best.limit_db - best.snr_db,
                        robust_rms(&score.f_ratio)
                    );
                    println!("seed {seed}: {} found", found.len());
                    for (mode, bound) in &score.missed_modes {
                        println!("  missed {mode:?} {bound:?}");
                    }
                    for mode in &score.spurious_modes {
                        println!("  spurious {mode:?}");
                    }
                }
                f.extend(score.f_ratio.clone());
                d.extend(score.d_ratio.clone());
                below.push(score.limit_db - score.snr_db);
            }
            let in4 = f.iter().zip(&d).filter(|(f, d): &(&f64, &f64)| f.abs() < 4.0 && d.abs() < 4.0).count();
            times.sort_by(f64::total_cmp);
            below.sort_by(f64::total_cmp);
            println!(
                "{modes:4} {snr:4} {missed:4}/{total:<4} {spurious:6}    {:6.2} {:6.2} {:6.3}  {:6.2} .. {:5.2}    {:.2}",
                robust_rms(&f),
                robust_rms(&d),
                in4 as f64 / f.len().max(1) as f64,
                below[0],
                below[below.len() - 1],
                times[times.len() / 2],
            );
        }
    }
}
