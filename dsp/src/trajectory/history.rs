//! The last few events, read with a delay: cubic Hermite interpolation through positions and
//! reported velocities, linear for the force.

use super::TrajectoryDesign;
use super::reckoning::Horizon;

/// Events kept. They are at least an eighth of the delay apart (closer ones replace each other), so
/// the delay never reaches back beyond the oldest.
const KEPT: usize = 12;
const SPACINGS_PER_DELAY: u64 = 8;

/// An event relative to the path's origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Knot {
    sample: u64,
    position_m: [f64; 2],
    velocity_m_s: [f64; 2],
    force_n: f64,
}

/// The last events, oldest first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct History {
    knots: [Knot; KEPT],
    len: usize,
}

impl History {
    pub fn begin(sample: u64, velocity_m_s: [f64; 2], force_n: f64) -> Self {
        let mut knots = [Knot::default(); KEPT];
        knots[0] = Knot { sample, position_m: [0.0; 2], velocity_m_s, force_n };
        Self { knots, len: 1 }
    }

    /// Adds an event at the origin. `belief` as in [`Self::at`].
    pub fn push(
        &mut self,
        design: &TrajectoryDesign,
        sample: u64,
        belief: Horizon,
        velocity_m_s: [f64; 2],
        force_n: f64,
    ) {
        let knot = Knot { sample, position_m: [0.0; 2], velocity_m_s, force_n };
        if self.has_glided_out(design, sample, belief) {
            // A cubic across a long silence would swing out: leave the place of rest a moment ago.
            let (position_m, force_n) = self.at(design, sample, belief);
            let left = sample.saturating_sub(belief.whole_samples.max(1) as u64);
            self.knots[0] = Knot { sample: left, position_m, velocity_m_s: [0.0; 2], force_n };
            self.knots[1] = knot;
            self.len = 2;
            return;
        }
        let spacing = design.hermite_delay_samples / SPACINGS_PER_DELAY;
        let same_time = self.knots[self.len - 1].sample == sample;
        let crowded = self.len >= 2 && sample - self.knots[self.len - 2].sample < spacing;
        if same_time || crowded {
            self.knots[self.len - 1] = knot;
        } else if self.len < KEPT {
            self.knots[self.len] = knot;
            self.len += 1;
        } else {
            self.knots.copy_within(1.., 0);
            self.knots[KEPT - 1] = knot;
        }
    }

    pub fn shift(&mut self, step_m: [f64; 2]) {
        for knot in &mut self.knots[..self.len] {
            knot.position_m[0] += step_m[0];
            knot.position_m[1] += step_m[1];
        }
    }

    /// Lets every event have had this force.
    pub fn set_force_n(&mut self, force_n: f64) {
        for knot in &mut self.knots[..self.len] {
            knot.force_n = force_n;
        }
    }

    /// Tests whether the delayed reading has passed the latest event.
    pub fn is_past(&self, design: &TrajectoryDesign, sample: u64) -> bool {
        self.age_of_latest(design, sample) >= 0
    }

    /// Tests whether the path beyond the latest event has come to its end.
    pub fn has_glided_out(&self, design: &TrajectoryDesign, sample: u64, belief: Horizon) -> bool {
        self.age_of_latest(design, sample) > belief.whole_samples + fall_samples(design, belief)
    }

    fn age_of_latest(&self, design: &TrajectoryDesign, sample: u64) -> i64 {
        sample.wrapping_sub(self.knots[self.len - 1].sample) as i64 - design.hermite_delay_samples as i64
    }

    /// Position and force one delay before `sample`. Beyond the latest event the velocity is wholly
    /// believed as `belief` says, and then falls linearly to rest over twice the time of its fade.
    pub fn at(&self, design: &TrajectoryDesign, sample: u64, belief: Horizon) -> ([f64; 2], f64) {
        let knots = &self.knots[..self.len];
        let latest = &knots[self.len - 1];
        let age = self.age_of_latest(design, sample);
        if age >= 0 {
            let (whole, fall) = (belief.whole_samples, fall_samples(design, belief));
            let late = (age - whole).clamp(0, fall) as f64;
            let believed = age.min(whole) as f64 + late - 0.5 * late * late / fall as f64;
            return (along(latest, believed * design.sample_period_s), latest.force_n);
        }
        let read = sample.wrapping_sub(design.hermite_delay_samples);
        let age_at = |knot: &Knot| read.wrapping_sub(knot.sample) as i64;
        let Some(index) = knots.iter().rposition(|knot| age_at(knot) >= 0) else {
            // Before the landing: the line the finger came along.
            let first = &knots[0];
            return (along(first, age_at(first) as f64 * design.sample_period_s), first.force_n);
        };
        between(&knots[index], &knots[index + 1], age_at(&knots[index]) as f64, design.sample_period_s)
    }
}

/// Time in which a velocity falls once it is no longer wholly trusted.
fn fall_samples(design: &TrajectoryDesign, belief: Horizon) -> i64 {
    ((2.0 * belief.fade_s / design.sample_period_s) as i64).max(1)
}

fn along(knot: &Knot, time_s: f64) -> [f64; 2] {
    [knot.position_m[0] + knot.velocity_m_s[0] * time_s, knot.position_m[1] + knot.velocity_m_s[1] * time_s]
}

fn between(a: &Knot, b: &Knot, age: f64, sample_period_s: f64) -> ([f64; 2], f64) {
    let span = (b.sample - a.sample) as f64;
    let t = age / span;
    let span_s = span * sample_period_s;
    let (t2, t3) = (t * t, t * t * t);
    let rise = 3.0 * t2 - 2.0 * t3;
    let mut position_m = [0.0; 2];
    for (axis, out) in position_m.iter_mut().enumerate() {
        let tangents = (t3 - 2.0 * t2 + t) * a.velocity_m_s[axis] + (t3 - t2) * b.velocity_m_s[axis];
        let (from, to) = (a.position_m[axis], b.position_m[axis]);
        *out = from + rise * (to - from) + span_s * tangents;
    }
    (position_m, a.force_n + t * (b.force_n - a.force_n))
}
