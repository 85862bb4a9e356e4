//! ACF: an actuator configuration of Meta's haptic renderer, read for the range it says.
//!
//! It is JSON5: comments, trailing commas, keys without quotes. Of it are used
//! `continuous.frequency_min`, `frequency_max` and `emphasis_ducking`, and the strokes where it has
//! them; it says no resonance, so nothing of an actuator's response comes from it.

use crate::device::{Device, Stroke};
use crate::error::PortError;
use crate::json5_text;
use serde::Deserialize;

#[derive(Deserialize)]
struct Acf {
    continuous: Continuous,
    emphasis: Option<Emphasis>,
}

#[derive(Deserialize)]
struct Continuous {
    frequency_min: f64,
    frequency_max: f64,
    emphasis_ducking: Option<f64>,
}

#[derive(Deserialize)]
struct Emphasis {
    frequency_min: Option<End>,
    frequency_max: Option<End>,
}

#[derive(Deserialize)]
struct End {
    output_frequency: f64,
    duration_ms: f64,
    shape: Option<String>,
}

impl End {
    fn stroke(&self) -> Stroke {
        let square = self.shape.as_deref().is_some_and(|shape| shape.eq_ignore_ascii_case("square"));
        Stroke { hz: self.output_frequency, duration_s: 1e-3 * self.duration_ms, square }
    }
}

/// A device from a configuration.
pub(crate) fn device(text: &str) -> Result<Device, PortError> {
    let right = "must be an actuator configuration with continuous.frequency_min and frequency_max";
    let read = json5_text::value(text)
        .and_then(|value| serde_json::from_value(value).map_err(|error| error.to_string()));
    let acf: Acf = read.map_err(|error| PortError::new("device", error, right))?;
    let mut device = Device::quest();
    device.label = "From an actuator configuration".to_owned();
    device.band_hz = [acf.continuous.frequency_min, acf.continuous.frequency_max];
    device.source.insert("band_hz".to_owned(), "the actuator configuration".to_owned());
    if let Some(ducking) = acf.continuous.emphasis_ducking {
        device.emphasis.ducking = ducking;
    }
    if let Some(emphasis) = acf.emphasis {
        device.emphasis.dull = emphasis.frequency_min.map_or(device.emphasis.dull, |end| end.stroke());
        device.emphasis.sharp = emphasis.frequency_max.map_or(device.emphasis.sharp, |end| end.stroke());
    }
    device.checked()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_configuration_with_comments_gives_its_range_and_strokes() {
        let text = r#"// a controller
        { continuous: { gain: 1.0, "emphasis_ducking": 0.4, /* Hz */ "frequency_min": 60, "frequency_max": 180, },
          "emphasis": { "frequency_min": { "output_frequency": 60, "duration_ms": 30, "shape": "sine" },
                        "frequency_max": { "output_frequency": 170, "duration_ms": 12, "shape": "SQUARE" } } }"#;
        let device = Device::parse(text).unwrap();
        assert_eq!((device.band_hz, device.emphasis.ducking), ([60.0, 180.0], 0.4));
        assert!(device.emphasis.sharp.square && !device.emphasis.dull.square);
        assert_eq!(device.emphasis.dull.duration_s, 0.03);
    }

    #[test]
    fn a_configuration_without_a_range_is_refused() {
        let error = Device::parse(r#"{"continuous": {"gain": 1}}"#).unwrap_err().to_string();
        assert!(error.contains("frequency_min"), "{error}");
    }
}
