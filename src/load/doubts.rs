//! Numbers of actuators that are accepted and hardly meant: a unit off by a thousand, reported with
//! what was likely meant.

use crate::model::actuator::{ActuatorSettings, DeviceProfile, Quantity};

/// Longest displacement that an actuator has, m.
const LONGEST_M: f64 = 0.01;
/// Most metres at sample value 1: a file of metres has 1.
const MOST_FULL_SCALE_M: f64 = 1.0;

/// One line for each number in doubt.
pub(super) fn doubts(actuators: &[ActuatorSettings], full_scale: impl Iterator<Item = f64>) -> Vec<String> {
    let mut found = Vec::new();
    for (channel, (settings, full_scale)) in actuators.iter().zip(full_scale).enumerate() {
        if matches!(settings.output, Quantity::Displacement | Quantity::Tangential) {
            found.extend(long(&format!("actuator {channel}: full_scale"), full_scale, MOST_FULL_SCALE_M));
        }
        // The limits of the device that is equalised are reported once.
        let other = settings.limit.filter(|limit| settings.equalise.as_ref() != Some(limit));
        for (key, device) in [("equalise", settings.equalise), ("limit", other)] {
            found.extend(
                device.iter().flat_map(|device| of_device(&format!("actuator {channel}: {key}"), device)),
            );
        }
    }
    found
}

fn of_device(at: &str, device: &DeviceProfile) -> Vec<String> {
    let DeviceProfile { resonance_hz, band_hz: [low, high], .. } = *device;
    let lengths = [("felt_at_resonance_m", device.felt_at_resonance_m), ("excursion_m", device.excursion_m)];
    let mut found: Vec<String> = lengths
        .iter()
        .filter_map(|(key, metres)| long(&format!("{at}: {key}"), *metres, LONGEST_M))
        .collect();
    if !(0.2 * low..=5.0 * high).contains(&resonance_hz) {
        let kilohertz = (low..=high).contains(&(1e3 * resonance_hz));
        let right = if kilohertz {
            format!("if this is kilohertz, write {}", 1e3 * resonance_hz)
        } else {
            "check its unit, hertz".to_owned()
        };
        found.push(format!(
            "{at}: resonance_hz = {resonance_hz} is far outside its band_hz, {low} to {high}; {right}"
        ));
    }
    found
}

/// A displacement beyond what is usual.
fn long(at: &str, metres: f64, usual_m: f64) -> Option<String> {
    let (unit, meant) =
        if metres <= 1.0 { ("millimetres", metres / 1e3) } else { ("micrometres", metres / 1e6) };
    (metres > usual_m).then(|| {
        format!("{at} = {metres} is metres, beyond the usual {usual_m}; if these are {unit}, write {meant:e}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::actuator_profile::ActuatorPreset;

    #[test]
    fn wrong_units_of_a_device_are_reported_and_shipped_ones_not() {
        for name in ActuatorPreset::names().split(", ") {
            assert_eq!(of_device("", &ActuatorPreset::by_name(name).unwrap().profile), [""; 0], "{name}");
        }
        let slip = DeviceProfile { resonance_hz: 0.17, excursion_m: 13.0, ..DeviceProfile::LRA_170 };
        let settings = ActuatorSettings { limit: Some(slip), ..ActuatorSettings::default() };
        let found = doubts(&[settings], [100.0].into_iter()).join("\n");
        for part in [
            "actuator 0: full_scale = 100 is metres, beyond the usual 1; if these are micrometres, write 1e-4",
            "actuator 0: limit: excursion_m = 13 is metres",
            "write 1.3e-5",
            "actuator 0: limit: resonance_hz = 0.17 is far outside its band_hz, 60 to 400; if this is kilohertz, write 170",
        ] {
            assert!(found.contains(part), "{found}\nlacks {part}");
        }
        assert_eq!(doubts(&[ActuatorSettings::default()], [1.0].into_iter()), [""; 0]);
    }
}
