//! Lines of made strokes.

use super::made::{Made, make, options};
use asperity_stroke::lines;

fn report(name: &str, of: impl Fn(u64) -> Made) {
    let tool = options().tool;
    let (mut found, mut periods, mut sizes, mut wrong, mut smeared) = (0, 0.0f64, Vec::new(), 0, 0);
    for seed in 0..12 {
        let made = of(seed);
        let lines = lines::find(&make(&made), &tool);
        smeared += usize::from(lines.is_smeared);
        for line in &lines.lines {
            match made.lines.iter().find(|(period, _)| (line.period_m / period - 1.0).abs() < 0.05) {
                Some((period, amplitude)) => {
                    found += 1;
                    periods = periods.max((line.period_m / period - 1.0).abs());
                    sizes.push(20.0 * (line.amplitude_m / amplitude).log10());
                }
                None => wrong += 1,
            }
        }
    }
    let worst = sizes.iter().fold(0.0f64, |w, e| w.max(e.abs()));
    let mean = sizes.iter().sum::<f64>() / sizes.len().max(1) as f64;
    println!("{name}: found {found} period {:.4} % amplitude mean {mean:.2} worst {worst:.2} dB false {wrong} smeared {smeared}", 100.0 * periods);
}

/// Amplitude of a line so many dB over the third octave of relief about it.
fn over(db: f64, period_m: f64) -> f64 {
    let made = Made::default();
    let q = 1.0 / period_m;
    let third = super::made::density(&made, q) * q * (10f64.powf(0.05) - 10f64.powf(-0.05));
    (2.0 * third * 10f64.powf(0.1 * db)).sqrt()
}

#[test]
fn lines_tell_period_and_amplitude() {
    for db in [-5.0, 0.0, 10.0] {
        report(&format!("1 mm {db}"), |seed| Made { lines: vec![(1e-3, over(db, 1e-3))], seed: 500 + seed, ..Made::default() });
    }
    report("none", |seed| Made { seed: 900 + seed, ..Made::default() });
    report("0.3 mm 0", |seed| Made { lines: vec![(0.3e-3, over(0.0, 0.3e-3))], seed: 550 + seed, ..Made::default() });
    report("known ripple 10", |seed| Made { lines: vec![(1e-3, over(0.0, 1e-3))], ripple: 0.1, seed: 600 + seed, ..Made::default() });
    for db in [0.0, 2.0, 3.5, 5.0, 10.0] {
        report(&format!("untold ripple 5, {db}"), |seed| Made {
            lines: vec![(1e-3, over(db, 1e-3))],
            ripple: 0.05,
            told_ripple: false,
            seed: 700 + seed,
            ..Made::default()
        });
    }
}
