//! Path: where a finger is, and how fast, at each report.
//!
//! | path | place along it at t, duration T, speed v |
//! |---|---|
//! | `line` | v t on a straight line |
//! | `arc` | v t on a circle that turns by ψ in T, radius v T/ψ |
//! | `back-and-forth` | v T/2π · sin(2π t/T) on a straight line: v is the highest speed |
//!
//! Start, direction and ψ (45° to 360°, either way) are drawn. At the edge of the surface the
//! finger turns round: both coordinates are folded into the surface less a margin of 2 %.

use crate::draw::Draws;
use asperity::files::FileError;
use asperity::files::contact_log::{ContactLog, ContactSample, LogHand, LogLine};
use std::f64::consts::{FRAC_PI_4, TAU};

/// Share of the surface at each edge that is not touched.
const MARGIN: f64 = 0.02;

/// Shape of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Straight on.
    Line,
    /// Along a circle.
    Arc,
    /// There and back.
    BackAndForth,
}

impl Shape {
    /// Reads its name.
    ///
    /// # Errors
    /// When there is no such path.
    pub fn from_name(name: &str) -> Result<Self, FileError> {
        match name {
            "line" => Ok(Self::Line),
            "arc" => Ok(Self::Arc),
            "back-and-forth" => Ok(Self::BackAndForth),
            _ => {
                let right = "must be one of line, arc, back-and-forth";
                Err(FileError::new("finger.path", format!("\"{name}\" is unknown"), right))
            }
        }
    }
}

/// One stroke of a finger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Its path.
    pub shape: Shape,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Force, N.
    pub force_n: f64,
    /// Duration of touch, s.
    pub duration_s: f64,
    /// Reports a second, Hz.
    pub reports_hz: f64,
}

impl Motion {
    /// Reports as a game makes them: contact 0 on the surface of that name and size (m), felt by
    /// actuator 0.
    #[must_use]
    pub fn log(&self, surface: &str, size_m: [f64; 2], draws: Draws) -> ContactLog {
        let way = Way::drawn(self, size_m, draws);
        let reports = (self.duration_s * self.reports_hz).ceil() as u64;
        let samples = (0..reports).map(|report| {
            let t = report as f64 / self.reports_hz;
            let (place_m, velocity_m_s) = way.at(t);
            let uv = [place_m[0] / size_m[0], place_m[1] / size_m[1]];
            (t, ContactSample::new(uv, self.force_n).sliding(velocity_m_s))
        });
        ContactLog { lines: LogLine::contact(0, (surface, LogHand::felt_by(0)), samples, self.duration_s) }
    }
}

/// A path on a surface.
struct Way {
    shape: Shape,
    speed_m_s: f64,
    duration_s: f64,
    start_m: [f64; 2],
    /// Angle of the direction at the start, rad.
    heading: f64,
    /// Angle of an arc, rad.
    turn: f64,
    size_m: [f64; 2],
}

impl Way {
    fn drawn(motion: &Motion, size_m: [f64; 2], draws: Draws) -> Self {
        let start = draws.pair("finger.start", 0);
        let inside = |axis: usize| size_m[axis] * (MARGIN + (1.0 - 2.0 * MARGIN) * start[axis]);
        let [amount, side] = draws.pair("finger.turn", 0);
        let turn = FRAC_PI_4 + amount * (TAU - FRAC_PI_4);
        Self {
            shape: motion.shape,
            speed_m_s: motion.speed_m_s,
            duration_s: motion.duration_s,
            start_m: [inside(0), inside(1)],
            heading: TAU * draws.unit("finger.direction"),
            turn: if side < 0.5 { -turn } else { turn },
            size_m,
        }
    }

    /// Place, m, and velocity, m/s, at a time.
    fn at(&self, t: f64) -> ([f64; 2], [f64; 2]) {
        let (way_m, velocity_m_s) = self.unbounded(t);
        let axes = [0, 1].map(|axis| {
            let margin = MARGIN * self.size_m[axis];
            let (place, sign) = folded(self.start_m[axis] + way_m[axis], margin, self.size_m[axis] - margin);
            (place, sign * velocity_m_s[axis])
        });
        ([axes[0].0, axes[1].0], [axes[0].1, axes[1].1])
    }

    /// Way from the start, m, and velocity, m/s, on a surface without edges.
    fn unbounded(&self, t: f64) -> ([f64; 2], [f64; 2]) {
        let v = self.speed_m_s;
        let along = |angle: f64, length: f64| [length * libm::cos(angle), length * libm::sin(angle)];
        match self.shape {
            Shape::Line => (along(self.heading, v * t), along(self.heading, v)),
            Shape::BackAndForth => {
                let phase = TAU * t / self.duration_s;
                let reach = v * self.duration_s / TAU;
                (along(self.heading, reach * libm::sin(phase)), along(self.heading, v * libm::cos(phase)))
            }
            Shape::Arc => {
                let radius = v * self.duration_s / self.turn;
                let angle = self.turn * t / self.duration_s;
                let from = along(self.heading - 0.25 * TAU, radius);
                let to = along(self.heading - 0.25 * TAU + angle, radius);
                ([to[0] - from[0], to[1] - from[1]], along(self.heading + angle, v))
            }
        }
    }
}

/// A coordinate that turns round at `low` and `high`, and −1 where it runs backwards there.
fn folded(x: f64, low: f64, high: f64) -> (f64, f64) {
    let width = high - low;
    let lap = (x - low).rem_euclid(2.0 * width);
    if lap <= width { (low + lap, 1.0) } else { (high - (lap - width), -1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity::files::contact_log::LogEvent;

    const SIZE_M: [f64; 2] = [0.1, 0.06];

    fn samples(shape: Shape, speed_m_s: f64, stroke: u64) -> Vec<(f64, ContactSample)> {
        let motion = Motion { shape, speed_m_s, force_n: 0.5, duration_s: 1.0, reports_hz: 1000.0 };
        let log = motion.log("top", SIZE_M, Draws { seed: 9, stroke });
        let of = |line: &LogLine| match &line.event {
            LogEvent::Begin { sample, .. } | LogEvent::Move { sample, .. } => Some((line.t, *sample)),
            _ => None,
        };
        log.lines.iter().filter_map(of).collect()
    }

    #[test]
    fn every_report_lies_on_the_surface_with_the_places_velocity() {
        for shape in [Shape::Line, Shape::Arc, Shape::BackAndForth] {
            for stroke in 0..20 {
                let samples = samples(shape, 0.5, stroke);
                let mut turned = 0;
                for pair in samples.windows(2) {
                    for axis in [0, 1] {
                        let uv = |i: usize| pair[i].1.uv[axis];
                        assert!((MARGIN - 1e-12..=1.0 - MARGIN + 1e-12).contains(&uv(0)), "{}", uv(0));
                        let moved = (uv(1) - uv(0)) * SIZE_M[axis] / (pair[1].0 - pair[0].0);
                        let reported = pair.iter().map(|(_, sample)| sample.velocity_m_s.unwrap()[axis]);
                        let mean = reported.sum::<f64>() / 2.0;
                        // Where the finger turns round at an edge a mean of two velocities is none
                        // of them.
                        if (moved - mean).abs() > 2e-3 {
                            turned += 1;
                        }
                    }
                }
                assert!(turned <= 40, "{shape:?}: {turned}");
            }
        }
    }

    #[test]
    fn speeds_are_those_asked_for() {
        for (shape, stroke) in [(Shape::Line, 0), (Shape::Arc, 1), (Shape::BackAndForth, 2)] {
            let speed = |sample: &ContactSample| {
                let [x, y] = sample.velocity_m_s.unwrap();
                (x * x + y * y).sqrt()
            };
            let speeds: Vec<f64> =
                samples(shape, 0.02, stroke).iter().map(|(_, sample)| speed(sample)).collect();
            let highest = speeds.iter().fold(0.0_f64, |a, b| a.max(*b));
            assert!((highest - 0.02).abs() < 1e-9, "{highest}");
            if shape != Shape::BackAndForth {
                assert!(speeds.iter().all(|speed| (speed - 0.02).abs() < 1e-9));
            }
        }
    }

    #[test]
    fn an_arc_lies_on_a_circle_of_the_length_of_the_stroke() {
        let way = Way {
            shape: Shape::Arc,
            speed_m_s: 0.1,
            duration_s: 2.0,
            start_m: [50.0; 2],
            heading: 0.7,
            turn: 3.0,
            size_m: [100.0; 2],
        };
        // The chord of an arc of length v T that turns by ψ is 2 (v T/ψ) sin(ψ/2).
        let (end, _) = way.unbounded(2.0);
        let chord = (end[0] * end[0] + end[1] * end[1]).sqrt();
        assert!((chord - 2.0 * 0.2 / 3.0 * 1.5_f64.sin()).abs() < 1e-12, "{chord}");
    }
}
