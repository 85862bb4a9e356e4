//! Lines of made strokes.

use super::made::{Made, density, make, options};
use asperity_stroke::lines::{self, Lines};

/// Amplitude of a line so many dB over the third octave of relief about it.
fn over(db: f64, period_m: f64) -> f64 {
    let q = 1.0 / period_m;
    let third = density(&Made::default(), q) * q * (10f64.powf(0.05) - 10f64.powf(-0.05));
    (2.0 * third * 10f64.powf(0.1 * db)).sqrt()
}

fn read(db: f64, period_m: f64, seed: u64, ripple: f64, told_ripple: bool) -> (f64, Lines) {
    let amplitude_m = over(db, period_m);
    let made = Made { lines: vec![(period_m, amplitude_m)], seed, ripple, told_ripple, ..Made::default() };
    (amplitude_m, lines::find(&make(&made), &options().tool))
}

#[test]
fn a_line_tells_its_period_and_amplitude() {
    for (db, period_m, bound_db) in [(0.0, 1e-3, 1.3), (10.0, 1e-3, 0.5), (0.0, 0.3e-3, 1.0)] {
        for seed in 500..504 {
            for ripple in [0.0, 0.1] {
                let (amplitude_m, found) = read(db, period_m, seed, ripple, true);
                let line = found.lines.first().unwrap_or_else(|| panic!("no line of {period_m} m"));
                assert!((line.period_m / period_m - 1.0).abs() < 5e-4, "{} m for {period_m}", line.period_m);
                let error_db = 20.0 * (line.amplitude_m / amplitude_m).log10();
                assert!(error_db.abs() < bound_db, "{period_m} m, {db} dB: off by {error_db} dB");
            }
        }
    }
}

#[test]
fn ground_without_a_line_shows_none() {
    let none = (900..916).map(|seed| {
        let found = lines::find(&make(&Made { seed, ..Made::default() }), &options().tool);
        found.lines.len() + usize::from(found.is_smeared)
    });
    let false_lines: usize = none.sum();
    assert!(false_lines <= 1, "{false_lines} in 16 strokes");
}

#[test]
fn a_wandering_speed_is_followed_by_strong_lines_and_reported() {
    for seed in 700..704 {
        let (amplitude_m, found) = read(6.0, 1e-3, seed, 0.05, false);
        let line = found.lines.first().unwrap_or_else(|| panic!("no line, {found:?}"));
        assert!((line.period_m / 1e-3 - 1.0).abs() < 0.02, "{} m", line.period_m);
        let error_db = 20.0 * (line.amplitude_m / amplitude_m).log10();
        assert!(error_db.abs() < 1.0 && found.wander > 0.02, "off by {error_db} dB, wander {}", found.wander);
        let (_, weak) = read(0.0, 1e-3, seed, 0.05, false);
        assert!(weak.is_smeared && weak.lines.is_empty(), "{weak:?}");
    }
}
