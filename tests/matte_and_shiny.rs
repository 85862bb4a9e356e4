//! Matte lies above shiny, felt as displacement and as acceleration, plain and as skin weighs it, at every speed of a hand.

mod common;

use asperity::offline::Options;
use asperity::{ActuatorSettings, Config, Quantity};
use asperity_measure::spectrum;
use asperity_observer::constants::touch_threshold_m;
use common::{SIDE_M, plate, render, stroke};

/// Power from 10 Hz to 1 kHz, each bin weighed.
fn power(roughness: f64, speed_m_s: f64, output: Quantity, weight: &dyn Fn(f64) -> f64) -> f64 {
    let actuators = vec![ActuatorSettings { full_scale: 1.0, output, ..ActuatorSettings::default() }];
    let mut sum = 0.0;
    for seed in 1..=4 {
        let config = Config { actuators: actuators.clone(), seed, ..Config::default() };
        let log = stroke(SIDE_M, speed_m_s, 0.6, 1.2);
        let take = render(config, plate(roughness), &log, &Options { tail_s: 0.0, ..Options::default() });
        let length = 16_384;
        let power = spectrum::power_spectrum(&take.haptic[0][8820..], length);
        let bin_hz = take.sample_rate_hz / length as f64;
        let at = |bin: usize| bin as f64 * bin_hz;
        let inside = (0..power.len()).filter(|bin| (10.0..=1000.0).contains(&at(*bin)));
        sum += inside.map(|bin| power[bin] * weight(at(bin))).sum::<f64>();
    }
    sum
}

#[test]
fn a_matte_plate_is_felt_at_least_3_db_above_a_shiny_one_at_every_speed() {
    let mut least = f64::INFINITY;
    for speed_m_s in [0.03, 0.05, 0.1, 0.2, 0.3, 0.5] {
        let above_db = |output, weight: &dyn Fn(f64) -> f64| {
            10.0 * (power(0.9, speed_m_s, output, weight) / power(0.1, speed_m_s, output, weight)).log10()
        };
        let moved = above_db(Quantity::Displacement, &|_| 1.0);
        let shaken = above_db(Quantity::Acceleration, &|_| 1.0);
        let felt = above_db(Quantity::Displacement, &|f| touch_threshold_m(f).powi(-2));
        println!(
            "{speed_m_s} m/s: displacement {moved:.1} dB, acceleration {shaken:.1} dB, over threshold {felt:.1} dB"
        );
        least = least.min(moved).min(shaken).min(felt);
    }
    assert!(least >= 3.0, "{least} dB");
}
