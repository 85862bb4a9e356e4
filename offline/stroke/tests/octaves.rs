//! Octaves, slope and told errors of made strokes.

use super::made::{Made, make, octave_rms, options};
use asperity_dsp::rng::Rng;
use asperity_stroke::{Options, Quantity, Tool, fit};

/// Strokes of random ground, speed, force, noise and ripple.
fn random(rng: &mut Rng, seed: u64) -> Made {
    let mut pick = |low: f64, high: f64| low * (high / low).powf(rng.uniform());
    Made {
        at_1mm_m: pick(1e-6, 6e-6),
        speed_m_s: pick(0.03, 0.3),
        force_n: pick(0.3, 3.0),
        alpha: 1.0 + 2.5 * rng.uniform(),
        snr_db: 20.0 + 20.0 * rng.uniform(),
        ripple: if seed.is_multiple_of(2) { 0.0 } else { 0.1 * rng.uniform() },
        seed,
        ..Made::default()
    }
}

/// Error of each octave that lies within 20 Hz to 1 kHz, dB, and its told error of sampling.
fn errors(made: &Made, options: &Options) -> (f64, Vec<(f64, f64)>) {
    let found = fit(&[make(made)], None, options).unwrap();
    let inside = found.octaves.iter().filter(|octave| {
        let hz = made.speed_m_s / octave.wavelength_m;
        !octave.is_extrapolated && (20.0 * 1.41..1000.0 / 1.41).contains(&hz)
    });
    let error = |rms_m: f64, wavelength_m: f64| 20.0 * (rms_m / octave_rms(made, wavelength_m)).log10();
    (found.law.alpha, inside.map(|octave| (error(octave.rms_m, octave.wavelength_m), octave.se_db)).collect())
}

#[test]
fn made_octaves_and_slope_return_within_their_stated_errors() {
    let mut rng = Rng::new(23);
    let (mut all, mut slopes) = (Vec::new(), Vec::new());
    for seed in 300..316 {
        let made = random(&mut rng, seed);
        let (alpha, octaves) = errors(&made, &options());
        slopes.push((alpha - made.alpha).abs());
        all.extend(octaves);
    }
    let worst = all.iter().fold(0.0f64, |worst, (error, _)| worst.max(error.abs()));
    let rms = (all.iter().map(|(error, _)| error * error).sum::<f64>() / all.len() as f64).sqrt();
    assert!(
        all.len() > 60 && rms <= 0.3 && worst <= 1.0,
        "{} octaves, rms {rms} dB, worst {worst} dB",
        all.len()
    );
    let covered = all.iter().filter(|(error, se)| error.abs() <= 2.0 * se).count() as f64 / all.len() as f64;
    assert!((0.9..=1.0).contains(&covered), "{covered} within two standard errors");
    let steep = slopes.iter().filter(|slope| **slope > 0.04).count();
    assert!(steep <= 1, "slopes off by {slopes:?}");
}

#[test]
fn a_probe_constant_off_by_a_fifth_stays_within_the_stated_error() {
    let made = Made { alpha: 2.0, seed: 41, ..Made::default() };
    let right = errors(&made, &options()).1;
    for constant in 0..3 {
        let mut wrong = options();
        let Tool { probe, quantity } = &mut wrong.tool;
        assert_eq!(*quantity, Quantity::Acceleration);
        *[&mut probe.contact_stiffness_n_m, &mut probe.pad_mass_kg, &mut probe.pad_damping_n_s_m]
            [constant] *= 1.2;
        let found = fit(&[make(&made)], None, &wrong).unwrap();
        let own = errors(&made, &wrong).1;
        for ((now, _), (before, _)) in own.iter().zip(&right) {
            assert!((now - before).abs() <= 1.8, "constant {constant}: {now} dB instead of {before}");
        }
        let stated_db = found.probe_se_db.iter().copied().fold(0.0, f64::max);
        assert!(stated_db > 0.3, "the told error has nothing of the probe: {stated_db} dB");
    }
}
