//! Dead reckoning from the latest event, and how long to believe it.

use super::bend::Turn;
use super::{PathPoint, REST_SPEED_M_S, TrajectoryDesign};
use crate::pair::Pair;

/// Event period assumed until two events are known, s.
const FIRST_PERIOD_S: f64 = 1.0 / 60.0;
/// Shortest and longest event period the running estimate may take, s.
const PERIOD_RANGE_S: (f64, f64) = (0.001, 0.1);
/// Weight of a new interval in the running estimate.
const PERIOD_WEIGHT: f64 = 0.25;
/// Event periods over which a reported velocity is believed.
const VELOCITY_HOLD_PERIODS: f64 = 1.5;
/// Time constant with which it then fades, event periods …
const FADE_PERIODS: f64 = 0.5;
/// … and at least so long, s: most fingers go on while a game hangs, and one that has stopped
/// glides 5 mm too far at 0.1 m/s. Chosen: after 40 ms without reports half the speed is left,
/// after 200 ms none.
const LEAST_FADE_S: f64 = 0.05;

/// Time for which a velocity is trusted when no report follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Horizon {
    /// Wholly, from its report on.
    pub whole_samples: i64,
    /// Time constant with which the velocity then fades, s.
    pub fade_s: f64,
}

/// The latest event, at the origin of the path's coordinates, and what follows from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DeadReckoning {
    sample: u64,
    /// Distance of the event beyond its sample, samples; its position is already carried back to
    /// it.
    fraction: f64,
    velocity_m_s: [f64; 2],
    /// Course of the velocity.
    turn: Turn,
    force_n: f64,
    period_s: f64,
    events: u32,
    glide: Glide,
    /// True where it has come to rest for want of reports, and not because the game said so.
    lost: bool,
}

/// The path once the reported velocity is no longer believed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Glide {
    /// Samples from the event for which the velocity is believed.
    after_samples: i64,
    position_m: [f64; 2],
    velocity_m_s: [f64; 2],
    /// Share of the velocity that is left after one sample.
    keep: f64,
    started: bool,
}

impl DeadReckoning {
    pub fn begin(sample: u64, fraction: f64, velocity_m_s: [f64; 2], force_n: f64) -> Self {
        let glide = Glide {
            after_samples: -1,
            position_m: [0.0; 2],
            velocity_m_s: [0.0; 2],
            keep: 0.0,
            started: false,
        };
        Self {
            sample,
            fraction,
            velocity_m_s,
            turn: Turn::default(),
            force_n,
            period_s: FIRST_PERIOD_S,
            events: 1,
            glide,
            lost: false,
        }
    }

    pub fn sample(&self) -> u64 {
        self.sample
    }

    pub fn fraction(&self) -> f64 {
        self.fraction
    }

    pub fn velocity(&self) -> [f64; 2] {
        self.velocity_m_s
    }

    pub fn force_n(&self) -> f64 {
        self.force_n
    }

    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    pub fn set_force_n(&mut self, force_n: f64) {
        self.force_n = force_n;
    }

    /// Takes over the event rate of the path before a jump, `gap_s` after its latest event.
    pub fn keep_rate(&mut self, before: &Self, gap_s: f64) {
        (self.period_s, self.events) = (before.period_s, before.events);
        self.note_interval(gap_s);
    }

    fn note_interval(&mut self, gap_s: f64) {
        if gap_s > 0.0 {
            // A dropped event doubles an interval; clamping keeps it from doubling the estimate.
            let (low, high) =
                if self.events == 1 { PERIOD_RANGE_S } else { (0.5 * self.period_s, 1.5 * self.period_s) };
            let interval_s = gap_s.clamp(low, high).clamp(PERIOD_RANGE_S.0, PERIOD_RANGE_S.1);
            let weight = if self.events == 1 { 1.0 } else { PERIOD_WEIGHT };
            self.period_s += weight * (interval_s - self.period_s);
            self.events = self.events.saturating_add(1);
        }
    }

    /// Tests whether nothing moves the input until the next event.
    pub fn is_at_rest(&self) -> bool {
        self.velocity_m_s == [0.0; 2] || (self.glide.started && self.glide.velocity_m_s == [0.0; 2])
    }

    /// Tests whether `gap_s` after the latest event its movement is no longer trusted.
    pub fn is_lost(&self, gap_s: f64, believed_s: f64) -> bool {
        self.lost || self.velocity_m_s != [0.0; 2] && gap_s > believed_s
    }

    /// Clears the velocity.
    pub fn stop(&mut self) {
        self.lost |= self.velocity_m_s != [0.0; 2];
        self.velocity_m_s = [0.0; 2];
        self.turn = Turn::default();
        self.glide.started = false;
        self.glide.after_samples = -1;
    }

    /// Time for which the latest event's velocity is trusted.
    pub fn belief(&self, design: &TrajectoryDesign) -> Horizon {
        Horizon {
            whole_samples: (VELOCITY_HOLD_PERIODS * self.period_s / design.sample_period_s) as i64,
            fade_s: (FADE_PERIODS * self.period_s).max(LEAST_FADE_S),
        }
    }

    /// Place of the input `gap_s` after the latest event, relative to it.
    pub fn expected(&self, design: &TrajectoryDesign, gap_s: f64) -> [f64; 2] {
        let Horizon { whole_samples, fade_s } = self.belief(design);
        let believed_s = whole_samples as f64 * design.sample_period_s;
        let late_s = gap_s - believed_s;
        let on_s = gap_s.min(believed_s);
        let fading_s = if late_s > 0.0 { fade_s * (1.0 - libm::exp(-late_s / fade_s)) } else { 0.0 };
        let [further, faster] = self.turn.after(on_s);
        [0, 1]
            .map(|axis| self.velocity_m_s[axis] * (on_s + fading_s) + further[axis] + faster[axis] * fading_s)
    }

    /// Takes a new event, `gap_s` after the latest; the origin has already been moved to it.
    pub fn follow(
        &mut self,
        design: &TrajectoryDesign,
        (sample, fraction): (u64, f64),
        gap_s: f64,
        (velocity_m_s, turn): ([f64; 2], Turn),
        force_n: f64,
    ) {
        self.note_interval(gap_s);
        let (period_s, events) = (self.period_s, self.events);
        *self = Self { period_s, events, turn, ..Self::begin(sample, fraction, velocity_m_s, force_n) };
        self.plan_glide(design);
    }

    fn plan_glide(&mut self, design: &TrajectoryDesign) {
        let Horizon { whole_samples, fade_s } = self.belief(design);
        self.glide.after_samples = whole_samples;
        self.glide.keep = libm::exp(-design.sample_period_s / fade_s);
    }

    /// The input from `sample` on, relative to the latest event, and the force. Once the velocity
    /// is no longer believed every sample must be asked for in turn.
    #[inline]
    pub fn run(&mut self, design: &TrajectoryDesign, sample: u64, out: &mut [PathPoint]) {
        let age = sample.wrapping_sub(self.sample) as i64;
        if self.glide.after_samples < 0 {
            self.plan_glide(design);
        }
        let after = self.glide.after_samples;
        let believed = after.saturating_sub(age).saturating_add(1).clamp(0, out.len() as i64) as usize;
        let (believed, late) = out.split_at_mut(believed);
        // An event stamped ahead of its sample is followed back no further than ahead.
        let earliest = -after as f64;
        let mut samples = age as f64;
        for out in believed {
            let since_s = if samples > earliest { samples } else { earliest } * design.sample_period_s;
            // As one vector, because the path's filters read it as one.
            let mut at_m = Pair::from(self.velocity_m_s) * Pair::from([since_s; 2]);
            if !self.turn.is_none() {
                let [further_m, _] = self.turn.after(since_s);
                at_m = at_m + Pair::from(further_m);
            }
            (out.position_m, out.normal_force_n) = (at_m.into(), self.force_n);
            samples += 1.0;
        }
        for out in late {
            (out.position_m, out.normal_force_n) = (self.glide(design), self.force_n);
        }
    }

    fn glide(&mut self, design: &TrajectoryDesign) -> [f64; 2] {
        let glide = &mut self.glide;
        if !glide.started {
            let believed_s = glide.after_samples as f64 * design.sample_period_s;
            let [further, faster] = self.turn.after(believed_s);
            for axis in 0..2 {
                glide.position_m[axis] = self.velocity_m_s[axis] * believed_s + further[axis];
                glide.velocity_m_s[axis] = self.velocity_m_s[axis] + faster[axis];
            }
            glide.started = true;
        }
        for axis in 0..2 {
            glide.velocity_m_s[axis] *= glide.keep;
            glide.position_m[axis] += glide.velocity_m_s[axis] * design.sample_period_s;
        }
        if libm::hypot(glide.velocity_m_s[0], glide.velocity_m_s[1]) < REST_SPEED_M_S {
            glide.velocity_m_s = [0.0; 2];
        }
        glide.position_m
    }
}
