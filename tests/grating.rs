//! A grating of wavelength λ felt at speed v vibrates at v/λ.

use crate::common;

use asperity::offline::Options;
use asperity_evidence::spectrum::strongest_bin;
use common::{grating, render, si_config, stroke};

#[test]
fn the_fundamental_is_speed_over_wavelength_within_one_bin() {
    for (wavelength_m, speed_m_s) in
        [(0.5e-3, 0.02), (0.5e-3, 0.1), (1e-3, 0.3), (2e-3, 0.1), (5e-3, 0.2), (10e-3, 0.3), (10e-3, 0.15)]
    {
        let seconds = 2.5;
        let surface = grating(wavelength_m, 0.02 * wavelength_m);
        let periods = (common::SIDE_M / wavelength_m).round();
        let log = stroke(periods * wavelength_m, speed_m_s, 0.6, seconds);
        let take = render(si_config(), surface, &log, &Options::default());
        let rate = take.sample_rate_hz;
        // Leave out the start of the path filter and the fade; 2 s give bins of 0.5 Hz.
        let x = &take.haptic[0][(0.4 * rate) as usize..(2.4 * rate) as usize];
        let expected_hz = speed_m_s / wavelength_m;
        let strongest = 0.5 * strongest_bin(x) as f64;
        assert!(
            (strongest - expected_hz).abs() <= 0.5,
            "λ = {wavelength_m} m at {speed_m_s} m/s: {strongest} Hz instead of {expected_hz} Hz"
        );
    }
}
