//! Hand: how a finger or a tool moves over a surface, as the contact log that a tracker would
//! report.
//!
//! ```text
//! line     runs on at one speed, a little aslant; where the ground ends, to and fro on a sine
//! circle   at one speed
//! zigzag   a sine along u, while v drifts and comes back
//! ```
//! Circles and sines have whole turns in the time: of all that fit onto the surface the widest.

use crate::scene_log::rounded;
use asperity::files::contact_log::{ContactLog, ContactSample, LogHand, LogLine};
use asperity_dsp::rng::Rng;
use std::f64::consts::TAU;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// Digits behind the point in its log.
const DIGITS: i32 = 9;
/// Reports a second.
const REPORTS_HZ: f64 = 120.0;
/// Speed at which the finger lands, m/s.
const LANDING_M_S: f64 = 0.04;
/// Time in which it takes up its force and lets go, s, and the share that it lands with.
const PRESS_S: f64 = 0.1;
const FIRST_SHARE: f64 = 0.2;
/// Along v over along u of a line: a pattern is not met on one row only.
const ASLANT: f64 = 0.05;
/// Largest share of the surface from its middle.
const REACH: f64 = 0.4;
/// Speed along v over that along u of a zigzag, at most.
const DRIFT: f64 = 0.2;
/// Wander of a hand's force, as a share, and its rates, Hz (Smith 2002 has a few percent).
const WANDER: [(f64, f64); 2] = [(0.04, 1.7), (0.02, 4.1)];

/// Motion of the hand.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Path {
    /// On and on.
    Line,
    /// Round.
    Circle,
    /// To and fro, and across.
    Zigzag,
    /// As somebody's contact log says.
    Log(PathBuf),
}

impl FromStr for Path {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "line" => Ok(Self::Line),
            "circle" => Ok(Self::Circle),
            "zigzag" => Ok(Self::Zigzag),
            file if file.ends_with(".jsonl") => Ok(Self::Log(file.into())),
            _ => Err("must be line, circle, zigzag or a contact log (.jsonl)".to_owned()),
        }
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Line => "line",
            Self::Circle => "circle",
            Self::Zigzag => "zigzag",
            Self::Log(_) => "log",
        })
    }
}

/// One stroke.
#[derive(Debug, Clone)]
pub struct Hand {
    pub path: Path,
    pub speed_m_s: f64,
    pub force_n: f64,
    pub seconds: f64,
    /// Time of stroking before a loop begins, s; none where it is no loop.
    pub settled_s: Option<f64>,
    pub extent_m: [f64; 2],
    /// True where there is ground beyond the edges.
    pub runs_on: bool,
    pub surface: String,
    pub probe: Option<String>,
    /// Beginning, and the wander of the force.
    pub seed: u64,
    /// The first take begins in the middle.
    pub is_first: bool,
}

impl Hand {
    /// The contact log.
    pub fn log(&self) -> ContactLog {
        let mut rng = Rng::new(self.seed);
        let mut within = |share: f64| if self.is_first { 0.0 } else { share * (2.0 * rng.uniform() - 1.0) };
        // A take begins elsewhere; where the ground ends, no farther off than there is room for.
        let aside = if self.runs_on { 0.5 } else { 0.5 - REACH };
        let shift_m = self.extent_m.map(|extent_m| extent_m * within(aside));
        let phases = [TAU * within(0.5), 1.0 + TAU * within(0.5)];
        let total_s = self.settled_s.unwrap_or(0.0) + self.seconds;
        let reports = (total_s * REPORTS_HZ).ceil().max(1.0) as u32;
        let samples = (0..reports).map(|report| {
            let t = f64::from(report) / REPORTS_HZ;
            let (place_m, velocity_m_s) = self.at(t);
            let uv =
                [0, 1].map(|axis| rounded((place_m[axis] + shift_m[axis]) / self.extent_m[axis], DIGITS));
            let sample = ContactSample {
                uv,
                velocity_m_s: Some(velocity_m_s.map(|v| rounded(v, DIGITS))),
                normal_force_n: rounded(self.force_n * self.pressing(t, total_s, phases), DIGITS),
                closing_m_s: if report == 0 { LANDING_M_S } else { 0.0 },
                ..ContactSample::default()
            };
            (rounded(t, DIGITS), sample)
        });
        let hand = LogHand { probe: self.probe.clone(), ..LogHand::felt_by(0) };
        ContactLog { lines: LogLine::contact(1, (&self.surface, hand), samples, total_s) }
    }

    /// Share of the force: it lands and lifts softly and wanders a little; in a loop it stays.
    fn pressing(&self, t: f64, total_s: f64, phases: [f64; 2]) -> f64 {
        let rise = |since_s: f64| {
            let tau = (since_s / PRESS_S.min(0.3 * total_s)).clamp(0.0, 1.0);
            FIRST_SHARE + (1.0 - FIRST_SHARE) * tau * tau * (3.0 - 2.0 * tau)
        };
        if self.settled_s.is_some() {
            return rise(t);
        }
        let wander: f64 =
            WANDER.iter().zip(phases).map(|((share, hz), phase)| share * (TAU * hz * t + phase).sin()).sum();
        rise(t) * rise(total_s - t) * (1.0 + wander)
    }

    /// Place, m, and velocity, m/s, at a time.
    fn at(&self, t: f64) -> ([f64; 2], [f64; 2]) {
        let middle = self.extent_m.map(|extent_m| 0.5 * extent_m);
        let speed = self.speed_m_s;
        match self.path {
            Path::Line if self.runs_on => {
                let along = [speed / (1.0 + ASLANT * ASLANT).sqrt(), 0.0];
                let velocity = [along[0], ASLANT * along[0]];
                ([middle[0] + velocity[0] * t, middle[1] + velocity[1] * t], velocity)
            }
            Path::Circle => {
                let reach_m = REACH * self.extent_m[0].min(self.extent_m[1]);
                let (radius_m, omega) = self.turns(reach_m);
                let (sin, cos) = (omega * t).sin_cos();
                let place = [middle[0] + radius_m * cos, middle[1] + radius_m * sin];
                (place, [-radius_m * omega * sin, radius_m * omega * cos])
            }
            Path::Line | Path::Zigzag | Path::Log(_) => {
                let (reach_m, omega) = self.turns(REACH * self.extent_m[0]);
                let slow = TAU / self.seconds;
                let drift_m = (REACH * self.extent_m[1]).min(DRIFT * speed / slow);
                let drift_m = if self.path == Path::Zigzag { drift_m } else { 0.0 };
                let place = [middle[0] + reach_m * (omega * t).sin(), middle[1] + drift_m * (slow * t).sin()];
                (place, [reach_m * omega * (omega * t).cos(), drift_m * slow * (slow * t).cos()])
            }
        }
    }

    /// Remark on a circle, or a line to and fro, that comes round more than once: it sounds the
    /// same each time.
    pub fn repetition(&self) -> Option<String> {
        let reach_m = match self.path {
            Path::Circle => REACH * self.extent_m[0].min(self.extent_m[1]),
            Path::Line if !self.runs_on => REACH * self.extent_m[0],
            _ => return None,
        };
        let turn_s = TAU / self.turns(reach_m).1;
        let turns = (self.seconds / turn_s).round();
        (turns > 1.0).then(|| {
            format!(
                "at {} m/s the hand comes round {turns} times: the loop repeats every {turn_s:.2} s \
                 (--path zigzag does not)",
                self.speed_m_s
            )
        })
    }

    /// Radius, m, and rate, rad/s, of whole turns in the time at the speed, the radius within
    /// reach.
    fn turns(&self, reach_m: f64) -> (f64, f64) {
        let count = (self.speed_m_s * self.seconds / (TAU * reach_m)).ceil().max(1.0);
        let omega = TAU * count / self.seconds;
        (self.speed_m_s / omega, omega)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity::files::contact_log::LogEvent;

    fn hand(path: Path, runs_on: bool) -> Hand {
        Hand {
            path,
            speed_m_s: 0.1,
            force_n: 0.6,
            seconds: 2.0,
            settled_s: None,
            extent_m: [0.08, 0.05],
            runs_on,
            surface: "map".to_owned(),
            probe: None,
            seed: 4,
            is_first: false,
        }
    }

    #[test]
    fn reported_velocity_is_the_derivative_of_the_reported_place() {
        for (path, runs_on) in
            [(Path::Line, true), (Path::Line, false), (Path::Circle, true), (Path::Zigzag, false)]
        {
            let hand = hand(path, runs_on);
            for step in 1..40 {
                let (t, h) = (0.05 * f64::from(step), 1e-6);
                let ((before, _), (after, _), (_, velocity)) = (hand.at(t - h), hand.at(t + h), hand.at(t));
                for axis in 0..2 {
                    let slope = (after[axis] - before[axis]) / (2.0 * h);
                    assert!((slope - velocity[axis]).abs() < 1e-6, "{slope} {}", velocity[axis]);
                }
                let speed = velocity[0].hypot(velocity[1]);
                assert!(speed <= 0.103, "{speed}");
            }
        }
    }

    #[test]
    fn a_hand_stays_on_ground_that_ends_and_loops_with_it() {
        for path in [Path::Line, Path::Circle, Path::Zigzag] {
            let looped = Hand { settled_s: Some(1.0), ..hand(path, false) };
            for line in looped.log().lines {
                let sample = match line.event {
                    LogEvent::Begin { sample, .. } | LogEvent::Move { sample, .. } => sample,
                    _ => continue,
                };
                assert!(sample.uv.iter().all(|u| (0.0..=1.0).contains(u)), "{:?}", sample.uv);
            }
            let ((from, _), (to, _)) = (looped.at(1.0), looped.at(3.0));
            assert!((from[0] - to[0]).hypot(from[1] - to[1]) < 1e-9);
        }
    }
}
