//! Path modes compared: sparse positions made into a path.
//!
//! A hand reaches from place to place (minimum jerk, 0.4–1 s a reach, below 15 Hz), reported 60
//! times a second in four ways: with its velocity or without, with positions that are exact or have
//! a tracker's 50 µm of noise. The error is that of the velocity, which is the pitch of what is
//! felt and heard, at the lag that the mode states.

use super::{BLOCK, Row, SAMPLE_RATE_HZ, refused};
use crate::error::CliError;
use crate::measure::{ns_per_item, relative_error};
use asperity::PathMode;
use asperity_dsp::rng::Rng;
use asperity_dsp::trajectory::{PathEvent, PathPoint, Trajectory, TrajectoryDesign};

const SECONDS: f64 = 8.0;
const EVENT_RATE_HZ: f64 = 60.0;
const NOISE_M: f64 = 50e-6;
/// Most that a reach goes, m.
const REACH_M: f64 = 0.1;
const REFERENCE: &str =
    "the hand's true velocity, delayed by the mode's own lag, by how the hand is reported";

/// Every mode, as on the command line.
pub const MODES: [(&str, PathMode); 4] = [
    ("extrapolate", PathMode::Extrapolate),
    ("hold", PathMode::Hold),
    ("hermite", PathMode::Hermite),
    ("band-limited", PathMode::BandLimited),
];

/// A reach: when it begins, how long it takes, from where and how far.
struct Reach {
    begin_s: f64,
    time_s: f64,
    from_m: f64,
    far_m: f64,
}

/// Reaches one after the other.
fn reaches() -> Vec<Reach> {
    let mut rng = Rng::new(3);
    let (mut begin_s, mut from_m, mut reaches) = (0.0, 0.0, Vec::new());
    while begin_s < SECONDS {
        let (time_s, far_m) = (0.4 + 0.6 * rng.uniform(), REACH_M * (2.0 * rng.uniform() - 1.0));
        reaches.push(Reach { begin_s, time_s, from_m, far_m });
        (begin_s, from_m) = (begin_s + time_s, from_m + far_m);
    }
    reaches
}

/// Place and velocity at a time.
fn truth(reaches: &[Reach], t: f64) -> (f64, f64) {
    let now = reaches.iter().rev().find(|reach| reach.begin_s <= t);
    now.map_or((0.0, 0.0), |Reach { begin_s, time_s, from_m, far_m }| {
        let x = ((t - begin_s) / time_s).min(1.0);
        let place = x * x * x * (10.0 + x * (6.0 * x - 15.0));
        let rate = 30.0 * x * x * (1.0 - x) * (1.0 - x);
        (from_m + far_m * place, far_m * rate / time_s)
    })
}

fn events(reaches: &[Reach], with_velocity: bool, noise_m: f64) -> Vec<PathEvent> {
    let mut rng = Rng::new(4);
    (0..(SECONDS * EVENT_RATE_HZ) as u32)
        .map(|index| {
            let time_s = f64::from(index) / EVENT_RATE_HZ;
            let (position, velocity) = truth(reaches, time_s);
            PathEvent {
                sample: (time_s * SAMPLE_RATE_HZ) as u64,
                fraction: (time_s * SAMPLE_RATE_HZ).fract(),
                position_m: [position + noise_m * rng.normal(), 0.0],
                velocity_m_s: with_velocity.then_some([velocity, 0.0]),
                normal_force_n: 0.5,
            }
        })
        .collect()
}

/// Velocities along u that a path makes of the events.
fn velocities(design: &TrajectoryDesign, events: &[PathEvent]) -> Vec<f64> {
    let mut path = Trajectory::begin(design, &events[0]);
    let mut points = [PathPoint::default(); BLOCK];
    let mut next = events[1..].iter().peekable();
    let end = (SECONDS * SAMPLE_RATE_HZ) as u64;
    let mut out = Vec::with_capacity(end as usize);
    let mut at = events[0].sample;
    while at < end {
        while let Some(event) = next.next_if(|event| event.sample <= at) {
            path.moved(design, event);
        }
        let until = next.peek().map_or(end, |event| event.sample.min(end));
        let count = ((until - at) as usize).min(BLOCK);
        path.advance(design, &mut points[..count]);
        out.extend(points[..count].iter().map(|point| point.velocity_m_s[0]));
        at += count as u64;
    }
    out
}

/// Cost of a mode of path a sample where velocities are reported, and its delay, s.
pub fn cost(mode: PathMode) -> Result<(f64, f64), CliError> {
    let design = TrajectoryDesign::new(mode, 30.0, SAMPLE_RATE_HZ, [f64::INFINITY; 2]).map_err(refused)?;
    let events = events(&reaches(), true, 0.0);
    let count = (SECONDS * SAMPLE_RATE_HZ) as usize;
    let ns = ns_per_item(count, || {
        std::hint::black_box(velocities(&design, &events));
    });
    Ok((ns, design.lag_s()))
}

/// Measures the axis: a row for each mode and way of reporting.
pub fn rows() -> Result<Vec<Row>, CliError> {
    let reports = [
        ("", true, 0.0),
        (", 50 µm of noise", true, NOISE_M),
        (", velocity not reported", false, 0.0),
        (", velocity not reported, 50 µm of noise", false, NOISE_M),
    ];
    let reaches = reaches();
    let mut rows = Vec::new();
    for (name, mode) in MODES {
        let design =
            TrajectoryDesign::new(mode, 30.0, SAMPLE_RATE_HZ, [f64::INFINITY; 2]).map_err(refused)?;
        for (how, with_velocity, noise_m) in reports {
            let events = events(&reaches, with_velocity, noise_m);
            let found = velocities(&design, &events);
            // The first tenths of a second show how a contact begins, not how it goes on.
            let skip = (0.3 * SAMPLE_RATE_HZ) as usize;
            let reference: Vec<f64> = (skip..found.len())
                .map(|n| truth(&reaches, n as f64 / SAMPLE_RATE_HZ - design.lag_s()).1)
                .collect();
            let ns_per_sample = ns_per_item(found.len(), || {
                std::hint::black_box(velocities(&design, &events));
            });
            let error = relative_error(found[skip..].iter().copied(), &reference);
            let row = Row::of(("path", format!("{name}{how}")), ns_per_sample, error, REFERENCE);
            rows.push(Row { latency_ms: Some(1e3 * design.lag_s()), ..row });
        }
    }
    Ok(rows)
}
