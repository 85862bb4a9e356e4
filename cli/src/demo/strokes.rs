//! Demo strokes: contact logs as a tracker and a physics step would report them, at 60 Hz.
//!
//! A stroke leaves and stops with a smooth speed (no step in acceleration), runs at one speed
//! between, bows a little as it turns about the elbow, trembles by some hundredths of a millimetre
//! at 9 Hz, and presses with a force that wanders by a few percent. Speeds and forces are those of
//! people exploring textures: 80–200 mm/s, 0.5–0.6 N (Smith 2002; Greenspon 2019).

use crate::scene_log;
use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogHand, LogLine, Striker};
use std::f64::consts::PI;

/// Events a second.
const EVENT_RATE_HZ: f64 = 60.0;
/// Rest at the end of a stroke, s.
const PAUSE_S: f64 = 0.12;
/// Speed at which the finger lands, m/s.
const LANDING_M_S: f64 = 0.04;
/// Time to reach the stroke's speed, and to stop, s.
const RAMP_S: f64 = 0.16;
/// Physiological tremor: amplitude, m, and frequency, Hz.
const TREMOR_M: f64 = 3e-5;
const TREMOR_HZ: f64 = 9.0;

/// Place and manner of a finger's strokes.
#[derive(Debug, Clone)]
pub struct Finger<'a> {
    /// Contact id.
    pub contact: u64,
    /// Surface touched.
    pub surface: &'a str,
    /// Extent of the surface, m.
    pub extent_m: [f64; 2],
    /// Time of landing, s.
    pub start_s: f64,
    /// Force, N.
    pub normal_force_n: f64,
    /// Landing place, m.
    pub from_m: [f64; 2],
    /// End of each stroke, m, and its speed, m/s.
    pub strokes: Vec<([f64; 2], f64)>,
}

impl Finger<'_> {
    /// The events from landing to lifting off.
    #[must_use]
    pub fn lines(&self) -> Vec<LogLine> {
        let mut samples = Vec::new();
        let mut t = self.start_s;
        let mut from = self.from_m;
        for &(to, speed_m_s) in &self.strokes {
            let stroke = Stroke::new(from, to, speed_m_s);
            let end = t + stroke.duration_s() + PAUSE_S;
            let start = t;
            while t < end {
                samples.push((rounded(t), self.sample(samples.is_empty(), t, stroke.at(t - start))));
                t += 1.0 / EVENT_RATE_HZ;
            }
            from = to;
        }
        LogLine::contact(self.contact, (self.surface, LogHand::felt_by(0)), samples, rounded(t))
    }

    fn sample(&self, first: bool, t: f64, (place, velocity): ([f64; 2], [f64; 2])) -> ContactSample {
        let since = t - self.start_s;
        let tremor = TREMOR_M * (2.0 * PI * TREMOR_HZ * since).sin();
        let wander =
            1.0 + 0.04 * (2.0 * PI * 1.7 * since).sin() + 0.02 * (2.0 * PI * 4.1 * since + 1.0).sin();
        ContactSample {
            uv: [rounded(place[0] / self.extent_m[0]), rounded((place[1] + tremor) / self.extent_m[1])],
            velocity_m_s: Some(velocity.map(rounded)),
            normal_force_n: rounded(self.normal_force_n * wander * pressing(since)),
            closing_m_s: if first { LANDING_M_S } else { 0.0 },
            ..ContactSample::default()
        }
    }
}

/// A landing finger presses with a fifth of its force at first and with all of it after a tenth of
/// a second.
fn pressing(since_s: f64) -> f64 {
    let tau = (since_s / 0.1).clamp(0.0, 1.0);
    0.2 + 0.8 * tau * tau * (3.0 - 2.0 * tau)
}

/// One way across.
struct Stroke {
    from: [f64; 2],
    along: [f64; 2],
    length_m: f64,
    speed_m_s: f64,
    ramp_s: f64,
}

impl Stroke {
    fn new(from: [f64; 2], to: [f64; 2], speed_m_s: f64) -> Self {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length_m = dx.hypot(dy).max(1e-9);
        let ramp_s = RAMP_S.min(length_m / speed_m_s);
        Self { from, along: [dx / length_m, dy / length_m], length_m, speed_m_s, ramp_s }
    }

    fn duration_s(&self) -> f64 {
        self.length_m / self.speed_m_s + self.ramp_s
    }

    /// Distance and speed along the stroke.
    fn progress(&self, t: f64) -> (f64, f64) {
        // Speed rises as 3τ² − 2τ³, so the distance is V·T·(τ³ − τ⁴/2).
        let rise = |tau: f64| {
            let distance = self.speed_m_s * self.ramp_s * (tau.powi(3) - tau.powi(4) / 2.0);
            (distance, self.speed_m_s * (3.0 * tau * tau - 2.0 * tau.powi(3)))
        };
        let left = self.duration_s() - t;
        if t < self.ramp_s {
            rise(t.max(0.0) / self.ramp_s)
        } else if left < self.ramp_s {
            let (distance, speed) = rise(left.max(0.0) / self.ramp_s);
            (self.length_m - distance, speed)
        } else {
            (self.speed_m_s * (t - self.ramp_s / 2.0), self.speed_m_s)
        }
    }

    /// Place and velocity, with the bow of a hand that turns about the elbow.
    fn at(&self, t: f64) -> ([f64; 2], [f64; 2]) {
        let (distance, speed) = self.progress(t);
        let part = distance / self.length_m;
        let bow = 0.03 * self.length_m * 4.0 * part * (1.0 - part);
        let bow_slope = 0.03 * 4.0 * (1.0 - 2.0 * part);
        let [x, y] = self.along;
        (
            [self.from[0] + x * distance - y * bow, self.from[1] + y * distance + x * bow],
            [speed * (x - y * bow_slope), speed * (y + x * bow_slope)],
        )
    }
}

/// A tenth of a micrometre.
fn rounded(value: f64) -> f64 {
    scene_log::rounded(value, 7)
}

/// A tenth of a millisecond.
fn stamp(t: f64) -> f64 {
    scene_log::rounded(t, 4)
}

/// A finger that lies still on a surface, from and to, s.
pub fn resting(
    contact: u64,
    surface: &str,
    uv: [f64; 2],
    normal_force_n: f64,
    [from_s, to_s]: [f64; 2],
) -> Vec<LogLine> {
    let sample = ContactSample::new(uv, normal_force_n).sliding([0.0; 2]);
    let reports = ((to_s - from_s) * EVENT_RATE_HZ) as u32;
    let samples = (0..reports).map(|step| (stamp(from_s + f64::from(step) / EVENT_RATE_HZ), sample));
    LogLine::contact(contact, (surface, LogHand::felt_by(0)), samples, stamp(to_s))
}

/// An impact on a body, at a place where one is named, by something of a material, with its mass
/// and radius, kg and m.
pub fn strike(
    t: f64,
    (body, at_m): (&str, Option<[f64; 3]>),
    speed_m_s: f64,
    striker: impl Into<Striker>,
    (mass_kg, radius_m): (f64, f64),
) -> LogLine {
    let event = LogEvent::Impact {
        body: body.to_owned(),
        other: None,
        speed_m_s,
        mass_kg,
        radius_m,
        striker: striker.into(),
        restitution: 0.5,
        position: 0,
        at_m,
        direction: None,
        hand: LogHand::default(),
    };
    LogLine { t: stamp(t), event }
}

/// A log of several fingers and strikes, in time order.
#[must_use]
pub fn log(mut lines: Vec<LogLine>) -> ContactLog {
    lines.sort_by(|a, b| a.t.total_cmp(&b.t));
    ContactLog { lines }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reported_velocity_is_the_derivative_of_the_reported_place() {
        let stroke = Stroke::new([0.01, 0.02], [0.12, 0.05], 0.2);
        let h = 1e-5;
        for step in 1..40 {
            let t = stroke.duration_s() * f64::from(step) / 40.0;
            let ((before, _), (after, _), (_, velocity)) = (stroke.at(t - h), stroke.at(t + h), stroke.at(t));
            for axis in 0..2 {
                let slope = (after[axis] - before[axis]) / (2.0 * h);
                assert!((slope - velocity[axis]).abs() < 1e-4, "{slope} {}", velocity[axis]);
            }
        }
        let (end, speed) = stroke.at(stroke.duration_s());
        assert!((end[0] - 0.12).abs() < 1e-9 && speed[0].abs() < 1e-9);
    }

    #[test]
    fn a_log_has_one_begin_one_end_and_rising_times() {
        let finger = Finger {
            contact: 1,
            surface: "plate",
            extent_m: [0.14, 0.14],
            start_s: 0.1,
            normal_force_n: 0.6,
            from_m: [0.02, 0.07],
            strokes: vec![([0.12, 0.07], 0.08), ([0.02, 0.07], 0.2)],
        };
        let lines = finger.lines();
        assert!(matches!(&lines[0].event, LogEvent::Begin { touching, .. } if touching.surface == "plate"));
        assert!(matches!(lines.last().unwrap().event, LogEvent::End { contact: 1 }));
        assert!(lines.windows(2).all(|pair| pair[1].t > pair[0].t));
        assert!((2.0..3.5).contains(&lines.last().unwrap().t));
        assert!(
            matches!(&lines[60].event, LogEvent::Move { sample, .. } if (0.14..0.9).contains(&sample.uv[0]))
        );
    }
}
