//! Path modes compared: sparse positions made into a path.

use super::{BLOCK, Row, SAMPLE_RATE_HZ, refused};
use crate::error::CliError;
use crate::measure::{ns_per_item, relative_error};
use asperity::PathMode;
use asperity_dsp::trajectory::{PathEvent, PathPoint, Trajectory, TrajectoryDesign};
use std::f64::consts::PI;

const SECONDS: f64 = 2.0;
const EVENT_RATE_HZ: f64 = 60.0;
const REFERENCE: &str = "the finger's true velocity, delayed by the mode's own lag";

/// A finger that strokes to and fro at up to 0.15 m/s while it drifts at 0.1 m/s.
fn truth(t: f64) -> (f64, f64) {
    let omega = 2.0 * PI * 1.3;
    (0.1 * t + 0.05 / omega * (omega * t).sin(), 0.1 + 0.05 * (omega * t).cos())
}

fn events(with_velocity: bool) -> Vec<PathEvent> {
    (0..(SECONDS * EVENT_RATE_HZ) as u32)
        .map(|index| {
            let time_s = f64::from(index) / EVENT_RATE_HZ;
            let (position, velocity) = truth(time_s);
            PathEvent {
                sample: (time_s * SAMPLE_RATE_HZ) as u64,
                fraction: (time_s * SAMPLE_RATE_HZ).fract(),
                position_m: [position, 0.0],
                velocity_m_s: with_velocity.then_some([velocity, 0.0]),
                normal_force_n: 0.5,
            }
        })
        .collect()
}

fn velocities(design: &TrajectoryDesign, events: &[PathEvent]) -> Vec<f64> {
    let mut path = Trajectory::begin(design, &events[0]);
    let mut points = [PathPoint::default(); BLOCK];
    let total = (SECONDS * SAMPLE_RATE_HZ) as u64;
    let mut out = Vec::with_capacity(total as usize);
    let mut next = 1;
    let mut at = 0;
    while at < total {
        if let Some(event) = events.get(next).filter(|event| event.sample == at) {
            path.moved(design, event);
            next += 1;
        }
        let until = events.get(next).map_or(total, |event| event.sample).min(total);
        let count = ((until - at) as usize).min(BLOCK);
        path.advance(design, &mut points[..count]);
        out.extend(points[..count].iter().map(|point| point.velocity_m_s[0]));
        at += count as u64;
    }
    out
}

/// Measures the axis.
pub fn rows() -> Result<Vec<Row>, CliError> {
    let choices = [
        ("extrapolate", PathMode::Extrapolate, true),
        ("extrapolate, velocity not reported", PathMode::Extrapolate, false),
        ("hold", PathMode::Hold, true),
        ("hermite", PathMode::Hermite, true),
    ];
    choices
        .into_iter()
        .map(|(choice, mode, with_velocity)| {
            let design =
                TrajectoryDesign::new(mode, 30.0, SAMPLE_RATE_HZ, [f64::INFINITY; 2]).map_err(refused)?;
            let events = events(with_velocity);
            let found = velocities(&design, &events);
            // The first tenths of a second show how a contact begins, not how it goes on.
            let skip = (0.3 * SAMPLE_RATE_HZ) as usize;
            let reference: Vec<f64> =
                (skip..found.len()).map(|n| truth(n as f64 / SAMPLE_RATE_HZ - design.lag_s()).1).collect();
            let ns_per_sample = ns_per_item(found.len(), || {
                std::hint::black_box(velocities(&design, &events));
            });
            Ok(Row {
                axis: "path",
                choice: choice.to_owned(),
                ns_per_sample,
                error: relative_error(found[skip..].iter().copied(), &reference),
                reference: REFERENCE,
            })
        })
        .collect()
}
