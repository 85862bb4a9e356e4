//! Sound of a stroke, read through the ring of its body.

use super::made::{Made, octave_rms, options, recorded, response, stylus};
use asperity_dsp::mode::Mode;
use asperity_fft::num_complex::Complex;
use asperity_stroke::tool::Ring;
use asperity_stroke::{Quantity, fit};
use std::f64::consts::PI;

/// Modes of a small body, for 1 N·s.
const MODES: [(f64, f64, f64); 6] = [
    (180.0, 40.0, 30.0),
    (420.0, 50.0, 25.0),
    (760.0, 60.0, 20.0),
    (1300.0, 70.0, 20.0),
    (2100.0, 90.0, 15.0),
    (3300.0, 120.0, 10.0),
];

/// Σ a ω / ((s + d)² + ω²): sines that decay, by their Laplace transform.
fn ring(hz: f64) -> Complex<f64> {
    let s = Complex::new(0.0, 2.0 * PI * hz);
    MODES
        .iter()
        .map(|(mode_hz, decay, amplitude)| {
            let w = 2.0 * PI * mode_hz;
            amplitude * w / ((s + decay) * (s + decay) + w * w)
        })
        .sum()
}

#[test]
fn a_sounding_stroke_is_read_within_3_db_on_ringing_bodies() {
    let mut options = options();
    let mode = |&(frequency_hz, decay_per_s, amplitude): &(f64, f64, f64)| Mode {
        frequency_hz,
        decay_per_s,
        amplitude,
        phase_rad: 0.0,
    };
    options.tool.quantity = Quantity::Sound(Ring(MODES.iter().map(mode).collect()));
    for (seed, alpha) in [(1, 1.5), (2, 2.2)] {
        let made = Made { alpha, at_1mm_m: 2e-6, seed, ..Made::default() };
        // The contact's force: k (h − x), where the tip's x is its acceleration over s².
        let k = stylus().contact_stiffness_n_m * made.force_n.powf(stylus().force_exponent);
        let force = |hz: f64| {
            let s = Complex::new(0.0, 2.0 * PI * hz.max(1.0));
            k * (1.0 - response(&stylus(), made.force_n, hz.max(1.0)) / (s * s))
        };
        let stroke = recorded(&made, |hz| force(hz) * ring(hz));
        let found = fit(&[stroke], None, &options).unwrap();
        let mut seen = 0;
        for octave in found.octaves.iter().filter(|octave| !octave.is_extrapolated) {
            let error = 20.0 * (octave.rms_m / octave_rms(&made, octave.wavelength_m)).log10();
            assert!(error.abs() <= 3.0, "α {alpha}, {} m: off by {error} dB", octave.wavelength_m);
            seen += 1;
        }
        assert!(seen >= 2, "{seen} octaves");
    }
}
