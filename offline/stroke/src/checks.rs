//! Refusals and warnings: recordings that the model does not explain.

use crate::StrokeError;
use crate::floor::Floor;
use crate::recording::{STANDSTILL_M_S, Stroke, Window};
use crate::tool::{Quantity, Tool};

/// Shortest stroke, s.
const LEAST_S: f64 = 1.0;
/// Lowest rate, Hz.
const LEAST_RATE_HZ: f64 = 200.0;
/// Share of the samples in flat runs at the extremes that counts as clipped.
const CLIPPED: f64 = 1e-4;
/// Samples at the extreme in a row that are no coincidence.
const CLIPPED_RUN: usize = 3;
/// Force that changes by more of its mean than this lets go of the ground now and then: reported,
/// refused.
const LIFTS: (f64, f64) = (0.5, 1.0);
/// Floor over the recording beyond which nothing of the ground is left, dB.
const BURIED_DB: f64 = -1.0;

/// Refuses what is no stroke.
///
/// # Errors
/// Names the field, with its figure, and what would be right.
pub fn refuse(stroke: &Stroke) -> Result<(), StrokeError> {
    let refused = |field, what: String, expected: &str| Err(StrokeError::new(field, what, expected));
    if stroke.is_empty() {
        return refused("recording", "holds no samples".into(), "record 10 s of one stroke");
    }
    if stroke.rate_hz.is_nan() || stroke.rate_hz < LEAST_RATE_HZ {
        return refused(
            "rate",
            format!("{} Hz", stroke.rate_hz),
            "must be at least 200 Hz: touch reaches from 20 to 500 Hz",
        );
    }
    if stroke.seconds() < LEAST_S {
        let what = format!("{:.3} s long", stroke.seconds());
        return refused("recording", what, "must be at least 1 s, best 10 s");
    }
    for axis in &stroke.axes {
        if axis.len() != stroke.len() {
            return refused(
                "recording",
                "its axes differ in length".into(),
                "every axis must have a value a row",
            );
        }
        if let Some(i) = axis.iter().position(|x| !x.is_finite()) {
            return refused("recording", format!("sample {i} is no number"), "must be finite");
        }
        let mean = axis.iter().sum::<f64>() / axis.len() as f64;
        if stroke.axes.len() == 1 && axis.iter().all(|x| (x - mean).abs() <= 1e-12 * mean.abs().max(1e-30)) {
            return refused(
                "recording",
                "every sample is the same".into(),
                "must hold the vibration of a stroke",
            );
        }
        let clipped = clipped_share(axis);
        if clipped > CLIPPED {
            let what = format!("clipped: {:.2} % of the samples stand at the extremes", 100.0 * clipped);
            return refused("recording", what, "record at a lower gain");
        }
    }
    for i in 0..stroke.len() {
        let (speed, force) = (stroke.speed_m_s.at(i), stroke.force_n.at(i));
        if !(speed.is_finite() && (0.0..=10.0).contains(&speed)) {
            return refused("speed", format!("{speed} m/s at sample {i}"), "must be 0 to 10 m/s");
        }
        if !(force.is_finite() && (0.0..=1000.0).contains(&force)) {
            return refused("force", format!("{force} N at sample {i}"), "must be 0 to 1000 N, pressing");
        }
        if !stroke.speed_m_s.is_measured() && !stroke.force_n.is_measured() {
            break;
        }
    }
    let moving = (0..stroke.len()).filter(|i| stroke.speed_m_s.at(*i) >= STANDSTILL_M_S).count();
    if (moving as f64) < LEAST_S * stroke.rate_hz {
        let what = format!("{:.2} s move faster than 1 mm/s", moving as f64 / stroke.rate_hz);
        return refused("speed", what, "must be 1 s of motion or more; is the column in m/s?");
    }
    let force_n = stroke.force_n.mean(0, stroke.len());
    if force_n < 1e-3 {
        return refused(
            "force",
            format!("{force_n} N in the mean"),
            "must be above 0.001 N; is the column in newtons?",
        );
    }
    Ok(())
}

/// Share of samples in flat runs at the extremes.
fn clipped_share(axis: &[f64]) -> f64 {
    let (low, high) =
        axis.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    if high <= low {
        return 0.0;
    }
    let near = 1e-6 * (high - low);
    let mut clipped = 0;
    for extreme in [low, high] {
        let mut run = 0;
        for x in axis.iter().chain([&f64::NAN]) {
            if (x - extreme).abs() <= near {
                run += 1;
            } else {
                clipped += if run >= CLIPPED_RUN { run } else { 0 };
                run = 0;
            }
        }
    }
    clipped as f64 / axis.len() as f64
}

/// Rms of the contact's changing force over its mean, from 20 Hz to 1 kHz.
#[must_use]
pub fn lift(windows: &[Window], tool: &Tool, floors: &[Floor]) -> f64 {
    let (mut changing, mut pressed, mut count) = (0.0, 0.0, 0.0);
    for window in windows.iter().filter(|window| window.speed_m_s >= STANDSTILL_M_S) {
        let floor = &floors[window.stroke].density;
        let (from, to) = ((20.0 / window.bin_hz) as usize, (1000.0 / window.bin_hz) as usize);
        let bins = window.density.iter().zip(floor).zip(&window.response).enumerate();
        for (i, ((density, floor), response)) in bins.take(to).skip(from) {
            let height = (density - floor).max(0.0) / response.max(f64::MIN_POSITIVE);
            changing += height * tool.force_power(i as f64 * window.bin_hz, window.force_n) * window.bin_hz;
        }
        pressed += window.force_n * window.force_n;
        count += 1.0;
    }
    if count > 0.0 { (changing / pressed).sqrt() } else { 0.0 }
}

/// Warns of, or refuses, a stroke that lets go of the ground.
///
/// # Errors
/// When the contact's force changes by more than its mean.
pub fn stays_down(lift: f64, tool: &Tool, warnings: &mut Vec<String>) -> Result<(), StrokeError> {
    let collisions = matches!(tool.quantity, Quantity::Sound(_));
    if lift > LIFTS.1 {
        let what = format!("the contact's force changes by {lift:.2} of its mean: the tip leaves the ground");
        let what = if collisions { format!("{what}, and its collisions make the sound") } else { what };
        return Err(StrokeError::new("force", what, "press harder or stroke slower (3 N rather than 0.3 N)"));
    }
    if lift > LIFTS.0 {
        warnings.push(format!(
            "the contact's force changes by {lift:.2} of its mean: the tip leaves the ground now and then, and levels are 1 to 2 dB low; press harder"
        ));
    }
    Ok(())
}

/// Refuses a recording that is all floor, and warns of one whose floor is unknown.
///
/// # Errors
/// When the floor is as strong as the recording.
pub fn stands_over_floor(floor: &Floor, warnings: &mut Vec<String>) -> Result<(), StrokeError> {
    if floor.over_signal_db > BURIED_DB {
        let what = format!("noise floor {:.1} dB beside the stroke's own level", floor.over_signal_db);
        return Err(StrokeError::new(
            "recording",
            what,
            "press harder, stroke faster or mount the sensor closer to the tip",
        ));
    }
    if floor.over_signal_db > -10.0 {
        let origin = if floor.from_standstill { "at standstill" } else { "judged by the top of the band" };
        warnings
            .push(format!("the noise floor ({origin}) is {:.0} dB under the stroke", -floor.over_signal_db));
    }
    if !floor.from_standstill && floor.over_signal_db > -30.0 {
        warnings.push(
            "no standstill gives the noise floor: record a second of it (speed column at 0)".to_owned(),
        );
    }
    Ok(())
}
