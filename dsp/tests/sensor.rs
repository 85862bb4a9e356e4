//! Sensors: their response is the equation's, and what leaves has the noise, the stops and the
//! steps that were asked for.

use asperity_dsp::sensor::{Converter, SensorFilter, SensorFilterState, SensorProfile};
use std::f64::consts::TAU;

const PLAIN: SensorProfile = SensorProfile {
    resonance_hz: 21e3,
    quality: 10.0,
    band_hz: [0.0, 1e6],
    noise_m_s2_rthz: 0.0,
    clip_m_s2: 1e6,
    gain_v_per_m_s2: 1.0,
    adc_bits: 0,
};

/// Magnitude of the filter at a frequency, from its impulse response.
fn measured(profile: &SensorProfile, rate_hz: f64, hz: f64) -> f64 {
    let filter = SensorFilter::new(profile, rate_hz).unwrap();
    let (mut state, mut block) = (SensorFilterState::default(), vec![0.0_f32; 1 << 16]);
    block[0] = 1.0;
    state.run(&filter, &mut block);
    let turn = |n: usize| TAU * hz / rate_hz * n as f64;
    let sum = |part: fn(f64) -> f64| {
        block.iter().enumerate().map(|(n, x)| f64::from(*x) * part(turn(n))).sum::<f64>()
    };
    sum(f64::cos).hypot(sum(f64::sin))
}

#[test]
fn a_filter_has_the_response_of_its_equation() {
    let mut worst = 0.0_f64;
    for rate_hz in [44_100.0, 48_000.0, 96_000.0] {
        for resonance in [0.02, 0.1, 0.3, 0.45, 0.48, 0.87, 1.0, 2.0] {
            for quality in [0.7, 5.0, 30.0] {
                let profile = SensorProfile { resonance_hz: resonance * rate_hz, quality, ..PLAIN };
                for at in [0.001, 0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.45] {
                    let hz = at * rate_hz;
                    let db = 20.0 * (measured(&profile, rate_hz, hz) / profile.response(hz)).log10();
                    worst = worst.max(db.abs());
                }
            }
        }
    }
    println!("worst {worst}");
    assert!(worst < 0.3, "{worst} dB");
}

#[test]
fn a_band_is_three_decibels_down_at_its_ends() {
    let profile = SensorProfile { band_hz: [20.0, 6e3], resonance_hz: 1e6, quality: 0.7, ..PLAIN };
    for hz in [20.0, 6e3] {
        let db = 20.0 * measured(&profile, 48e3, hz).log10();
        assert!((db + 3.0).abs() < 0.1, "{db} dB at {hz} Hz");
    }
    assert!(20.0 * measured(&profile, 48e3, 600.0).log10().abs() < 0.1);
}

#[test]
fn noise_has_its_density_and_readings_stop_and_step() {
    let profile = SensorProfile { noise_m_s2_rthz: 2e-3, clip_m_s2: 10.0, gain_v_per_m_s2: 0.5, ..PLAIN };
    let mut converter = Converter::new(&profile, 7, 16e3);
    let n = 100_000;
    let square: f64 = (0..n).map(|_| f64::from(converter.tick(0.0)).powi(2)).sum();
    let rms = (square / f64::from(n)).sqrt() / 0.5;
    assert!((rms / (2e-3 * 8e3_f64.sqrt()) - 1.0).abs() < 0.01, "{rms}");
    let profile = SensorProfile { noise_m_s2_rthz: 0.0, adc_bits: 8, ..profile };
    let mut converter = Converter::new(&profile, 7, 16e3);
    let step = 2.0 * 10.0 * 0.5 / 256.0;
    assert_eq!(converter.tick(1e3), (5.0 - step) as f32);
    assert_eq!(converter.tick(-1e3), -5.0);
    assert!((0..100).all(|i| (f64::from(converter.tick(0.173 * i as f32 - 9.0)) / step).fract() == 0.0));
}

#[test]
fn a_profile_that_no_sensor_has_is_refused_by_field() {
    for (profile, field) in [
        (SensorProfile { quality: 0.0, ..PLAIN }, "quality"),
        (SensorProfile { band_hz: [100.0, 50.0], ..PLAIN }, "band_hz"),
        (SensorProfile { resonance_hz: f64::NAN, ..PLAIN }, "resonance_hz"),
        (SensorProfile { adc_bits: 64, ..PLAIN }, "adc_bits"),
    ] {
        assert_eq!(SensorFilter::new(&profile, 48e3).unwrap_err().field, field);
    }
}
