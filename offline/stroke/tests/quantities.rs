//! Displacement instead of acceleration, friction, and ground that gives way.

use super::made::{Made, octave_rms, options, recorded, response, stylus};
use asperity_fft::num_complex::Complex;
use asperity_stroke::{Options, Quantity, Stroke, StrokeSurface, Track, fit};
use std::f64::consts::PI;

fn displacement() -> Options {
    let mut options = options();
    options.tool.quantity = Quantity::Displacement;
    options
}

/// Stroke of which the tip's place is recorded: its acceleration over s².
fn place(made: &Made) -> Stroke {
    recorded(made, |hz| {
        let s = Complex::new(0.0, 2.0 * PI * hz.max(0.1));
        response(&stylus(), made.force_n, hz.max(0.1)) / (s * s)
    })
}

#[test]
fn a_displacement_sensor_tells_octaves_within_a_tenth() {
    for (seed, alpha) in [(1, 1.2), (2, 2.0), (3, 2.8)] {
        let made = Made { alpha, seed, snr_db: 40.0, ..Made::default() };
        let found = fit(&[place(&made)], None, &displacement()).unwrap();
        let octaves: Vec<_> = found.octaves.iter().filter(|octave| !octave.is_extrapolated).collect();
        assert!(octaves.len() >= 3, "α {alpha}: {} octaves", octaves.len());
        for octave in octaves {
            let error_db = 20.0 * (octave.rms_m / octave_rms(&made, octave.wavelength_m)).log10();
            let bound_db = 0.83 + 2.0 * octave.se_db;
            assert!(error_db.abs() < bound_db, "α {alpha}, {} m: off by {error_db} dB", octave.wavelength_m);
        }
    }
}

/// Displacement under a force that rises from 0.5 to 4 N and falls again, over ground of this
/// compliance.
fn pressed(compliance_m_n: f64, seed: u64) -> Result<StrokeSurface, asperity_stroke::StrokeError> {
    let mut stroke = place(&Made { seed, snr_db: 40.0, ..Made::default() });
    let count = stroke.len();
    let probe = stylus();
    let force: Vec<f64> =
        (0..count).map(|i| 2.25 - 1.75 * (2.0 * PI * i as f64 / count as f64).cos()).collect();
    let rest = 1.0 - probe.force_exponent;
    for (x, force) in stroke.axes[0].iter_mut().zip(&force) {
        *x -= compliance_m_n * force + force.powf(rest) / (rest * probe.contact_stiffness_n_m);
    }
    stroke.force_n = Track::Samples(force);
    fit(&[stroke], None, &displacement())
}

#[test]
fn ground_that_sinks_under_a_changing_force_tells_its_compliance() {
    for (seed, compliance_m_n) in [(1, 3e-5), (2, 1e-4), (3, 1e-3)] {
        let found = pressed(compliance_m_n, seed).unwrap();
        let estimate = found.compliance.unwrap_or_else(|| panic!("{compliance_m_n}: {:?}", found.warnings));
        assert!((estimate.m_n / compliance_m_n - 1.0).abs() < 0.1, "{estimate:?} for {compliance_m_n}");
    }
    let hard = pressed(0.0, 4).unwrap();
    assert!(hard.compliance.is_none(), "{:?}", hard.compliance);
    assert!(
        hard.warnings.iter().any(|warning| warning.starts_with("compliance is not estimated")),
        "{:?}",
        hard.warnings
    );
}

#[test]
fn an_accelerometer_tells_no_compliance_and_why() {
    let mut stroke = super::made::make(&Made::default());
    let count = stroke.len();
    stroke.force_n = Track::Samples((0..count).map(|i| 0.5 + 3.0 * i as f64 / count as f64).collect());
    let found = fit(&[stroke], None, &options()).unwrap();
    assert!(found.compliance.is_none());
    assert!(
        found.warnings.iter().any(|warning| warning.contains("only the displacement")),
        "{:?}",
        found.warnings
    );
}

#[test]
fn friction_is_the_drag_over_the_pressing_force_forth_and_back() {
    let made = Made::default();
    let stroke = super::made::make(&made);
    for way in [1.0, -1.0] {
        let drag: Vec<f64> =
            (0..stroke.len()).map(|i| way * (0.35 * made.force_n + 0.2 * (0.01 * i as f64).sin())).collect();
        let found = fit(std::slice::from_ref(&stroke), Some(&drag), &options()).unwrap();
        assert!((found.friction.unwrap() / 0.35 - 1.0).abs() < 0.1, "{:?}", found.friction);
    }
}
