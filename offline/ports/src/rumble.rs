//! Rumble: two motor levels some ten times a second.
//!
//! Both come from the causal kernel, so a game's live port and this give the same numbers.

use crate::error::PortError;
use asperity_dsp::vibration_points::{Point, PointDesign, PointSettings, PointState, Tone};

/// The causal points of samples: what a live port gives of the same signal.
///
/// # Errors
/// When the rate or a setting is refused.
pub fn causal(samples: &[f64], rate_hz: f64, settings: PointSettings) -> Result<Vec<Point>, PortError> {
    let design = PointDesign::new(settings, rate_hz).map_err(|error| {
        PortError::new(
            error.field,
            format!("{} is refused", error.value),
            format!("must be {}", error.expected),
        )
    })?;
    let mut state = PointState::default();
    Ok(samples.iter().filter_map(|x| state.tick(&design, *x)).collect())
}

/// Levels of a heavy and a light motor, 0 to 65535, `per_s` times a second.
///
/// # Errors
/// As [`causal`].
pub fn levels(samples: &[f64], rate_hz: f64, per_s: f64) -> Result<Vec<[u16; 2]>, PortError> {
    let settings = PointSettings { rate_hz: per_s, band_hz: [20.0, 250.0], tone: Tone::Strongest };
    let level = |x: f64| (x.clamp(0.0, 1.0) * 65_535.0).round() as u16;
    Ok(causal(samples, rate_hz, settings)?.iter().map(|p| [level(p.low), level(p.high)]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn low_hum_turns_the_heavy_motor_and_high_hum_the_light() {
        let sine = |hz: f64| -> Vec<f64> {
            (0..8000).map(|n| 0.5 * (TAU * hz * f64::from(n) / 8000.0).sin()).collect()
        };
        for (hz, motor) in [(60.0, 0), (160.0, 1)] {
            let all = levels(&sine(hz), 8000.0, 30.0).unwrap();
            assert_eq!(all.len(), 30);
            let last = all[29];
            let share = f64::from(last[motor]) / 65_535.0;
            assert!((share - 0.5).abs() < 0.05 && last[motor] > 3 * last[1 - motor], "{hz} Hz: {last:?}");
        }
    }
}
