//! From sparse contact events to one position, velocity and normal force a sample: the path stage.
//!
//! ```text
//! input(t)  = p₀ + v₀ (t − t₀)                 t − t₀ ≤ 1.5 T        (extrapolate)
//!             … then v decays as e^(−(t − t₀ − 1.5 T)/(T/2))
//! position  = H_lp(input)        velocity = d position/dt        H_lp: [`crate::butterworth`]
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | p₀, v₀, t₀ | the latest [`PathEvent`] | position unwrapped, velocity reported or estimated |
//! | T | `Reckoning`'s running event period | 1–100 ms, 1/60 s until two events are known |
//! | H_lp | [`TrajectoryDesign`]'s filter | Hasti §III-C: 2nd-order Butterworth, −3 dB at 30 Hz |
//! | velocity | the filter's band output | smooth, so that pitch does not step at events |
//!
//! **What we changed.** The paper holds each event's position until the next ([`PathMode::Hold`]).
//! At 60 Hz and a constant 0.1 m/s that leaves 36 % rms velocity ripple, heard as pitch wobble.
//! [`PathMode::Extrapolate`] feeds the same filter with dead reckoning: no ripple on clean events,
//! under 5 % with ±20 % jitter and 50 µm noise, and half the lag (7.5 ms, the filter's own).
//! [`PathMode::Hermite`] interpolates instead of extrapolating, [`HERMITE_DELAY_S`] late: for offline
//! rendering and for games that report poor velocities.
//!
//! The normal force runs through the same filter, held between events (interpolated in Hermite
//! mode), and never goes below zero: the filter's 4 % undershoot would pull at the surface.
//!
//! A landing or a jump that no finger can make (a *teleport*) sets the filter to the state it would
//! have had on the straight line through the event, so neither starts with a transient. So does a report
//! after a silence in which the path has slowed down, if it lies so far ahead that the filter would have to
//! hurry: a step of s metres is followed at up to 86 s
//! m/s, which after 100 ms without reports is six times the finger's own speed and heard as a zip.
//!
//! All arithmetic is relative to the latest event's position, so a path that has run a million
//! periods keeps its velocity; every sample depends on the samples before it alone, so any split
//! into blocks gives the same bits.

mod design;
mod history;
mod reckoning;
mod standstill;
#[cfg(test)]
mod tests;

use crate::butterworth::{State, Two};
use crate::pair::Pair;
pub use design::{HERMITE_DELAY_S, PathMode, TrajectoryDesign};
use history::History;
use reckoning::Reckoning;
use standstill::Standstill;

/// A jump is a teleport beyond this many times the distance the reported speed allows.
pub const TELEPORT_FACTOR: f64 = 3.0;

/// … plus this margin, m: position noise and a finger that sets off between two events. Assumed.
pub const TELEPORT_MARGIN_M: f64 = 0.005;

/// Share of a contact's speed by which the path may outrun it to catch up after a silence.
const HURRY: f64 = 0.4;

/// Distance that is a tracker's noise and no movement, m. Assumed: twice the 50 µm of the project's bars.
const NOISE_M: f64 = 1e-4;

/// Speed a finger is believed to reach when the game reports none, m/s. Assumed.
pub const UNREPORTED_SPEED_M_S: f64 = 0.5;

/// Longest gap between events that counts towards the distance a finger may have travelled, s.
const LONGEST_GAP_S: f64 = 0.1;

/// Below this a reported or decayed velocity is rest, m/s.
const REST_SPEED_M_S: f64 = 1e-7;
/// The output is still when the filter is this close to its input: m, m/s and N.
const STILL_DISTANCE_M: f64 = 1e-10;
const STILL_SPEED_M_S: f64 = 1e-8;
const STILL_FORCE_N: f64 = 1e-7;
/// Stillness is looked for on this absolute sample grid.
const STILL_GRID: u64 = 64;

/// What a game reported about one contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathEvent {
    /// Absolute index of the sample at which it holds …
    pub sample: u64,
    /// … and how far beyond that sample, 0 to 1 of a sample. Game time does not fall on samples: rounding it
    /// to them is a jitter, which at 22.05 kHz and 60 events a second ripples the velocity by 0.14 %.
    pub fraction: f64,
    /// Position on the surface along u and v, metres; may wrap or run on.
    pub position_m: [f64; 2],
    /// Tangential velocity along u and v, m/s; estimated from positions when missing.
    pub velocity_m_s: Option<[f64; 2]>,
    /// Force pressing the contact onto the surface, N.
    pub normal_force_n: f64,
}

/// The path at one sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PathPoint {
    /// Smoothed position, metres, unwrapped.
    pub position_m: [f64; 2],
    /// Its derivative, m/s.
    pub velocity_m_s: [f64; 2],
    /// Smoothed normal force, N, at or above 0.
    pub normal_force_n: f64,
}

/// What [`Trajectory::moved`] made of an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Moved {
    /// The path goes on to the new position.
    Followed,
    /// The jump was too far for a finger, or for the filter to follow after a silence: the path now starts
    /// there. Treat it as a new contact.
    Teleported,
    /// Older than the event before it, or not finite: nothing changed.
    Ignored,
}

/// The path of one contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trajectory {
    /// The next sample [`Trajectory::advance`] makes.
    sample: u64,
    /// Where the coordinates of everything below are zero, metres on the unwrapped surface.
    origin_m: [f64; 2],
    axes: [State; 2],
    force: State,
    reckoning: Reckoning,
    history: History,
    standstill: Standstill,
    still: bool,
}

/// The velocity with rest made exact.
fn or_rest(velocity: [f64; 2]) -> [f64; 2] {
    if libm::hypot(velocity[0], velocity[1]) < REST_SPEED_M_S { [0.0; 2] } else { velocity }
}

fn is_sane(event: &PathEvent) -> bool {
    let velocity = event.velocity_m_s.unwrap_or_default();
    let numbers = [event.position_m[0], event.position_m[1], velocity[0], velocity[1], event.normal_force_n];
    numbers.iter().all(|x| x.is_finite()) && (0.0..1.0).contains(&event.fraction)
}

/// Where a contact that holds a fraction after its sample was at that sample, relative to the event.
fn carried_back(design: &TrajectoryDesign, velocity_m_s: [f64; 2], fraction: f64) -> [f64; 2] {
    velocity_m_s.map(|v| -v * fraction * design.sample_period_s)
}

/// Whether the filters have come to their inputs.
fn is_settled(input: &[f64; 3], low: [f64; 3], point: &PathPoint) -> bool {
    (low[0] - input[0]).abs().max((low[1] - input[1]).abs()) < STILL_DISTANCE_M
        && point.velocity_m_s.iter().all(|v| v.abs() < STILL_SPEED_M_S)
        && (low[2] - input[2]).abs() < STILL_FORCE_N
}

impl Trajectory {
    /// A contact that lands. An event that is not finite lands at rest at the origin without force.
    #[must_use]
    pub fn begin(design: &TrajectoryDesign, event: &PathEvent) -> Self {
        let sane = if is_sane(event) {
            *event
        } else {
            let (position_m, fraction) = ([0.0; 2], 0.0);
            PathEvent { position_m, fraction, velocity_m_s: None, normal_force_n: 0.0, ..*event }
        };
        let velocity = or_rest(sane.velocity_m_s.unwrap_or_default());
        let back = carried_back(design, velocity, sane.fraction);
        let mut path = Self {
            sample: sane.sample,
            origin_m: [sane.position_m[0] + back[0], sane.position_m[1] + back[1]],
            axes: [State::default(); 2],
            force: State::settled_at(sane.normal_force_n),
            reckoning: Reckoning::begin(sane.sample, sane.fraction, velocity, sane.normal_force_n),
            history: History::begin(sane.sample, velocity, sane.normal_force_n),
            standstill: Standstill::begin(sane.velocity_m_s.map(or_rest)),
            still: false,
        };
        path.settle_on_line(design, velocity);
        path
    }

    /// Takes a new event. Its sample is normally the next one [`Self::advance`] will make; earlier and
    /// later stamps are carried to it along the event's velocity.
    pub fn moved(&mut self, design: &TrajectoryDesign, event: &PathEvent) -> Moved {
        if !is_sane(event) || event.sample < self.reckoning.sample() {
            return Moved::Ignored;
        }
        if self.still {
            self.sample = self.sample.max(event.sample);
        }
        // The origin is where the latest event's contact was at its whole sample.
        let since_origin = (event.sample - self.reckoning.sample()) as f64 + event.fraction;
        let gap_s = (since_origin - self.reckoning.fraction()).max(0.0) * design.sample_period_s;
        let expected = self.reckoning.expected(design, since_origin * design.sample_period_s);
        let latest = carried_back(design, self.reckoning.velocity(), -self.reckoning.fraction());
        let mut step = [0.0; 2]; // from the origin
        let mut surprise = [0.0; 2];
        for axis in 0..2 {
            let near = self.origin_m[axis] + expected[axis];
            step[axis] = design.unwrap(axis, event.position_m[axis], near) - self.origin_m[axis];
            surprise[axis] = step[axis] - expected[axis];
        }
        let covered = [step[0] - latest[0], step[1] - latest[1]];
        let (reported, unknown) = self.standstill.weigh(event.velocity_m_s.map(or_rest), covered);
        let velocity = match reported {
            Some(velocity) => velocity,
            None if gap_s > 0.0 => [covered[0] / gap_s, covered[1] / gap_s],
            None => self.reckoning.velocity(),
        };
        let velocity = or_rest(velocity);
        let same_m = libm::hypot(covered[0], covered[1]);
        if gap_s == 0.0 && same_m < STILL_DISTANCE_M && velocity == self.reckoning.velocity() {
            // Nothing new but the force: a game that stands reports the same instant again and again.
            self.still &= event.normal_force_n == self.reckoning.force_n();
            self.reckoning.set_force_n(event.normal_force_n);
            return Moved::Followed;
        }
        let surprise_m = libm::hypot(surprise[0], surprise[1]);
        let unforeseen = unknown || self.has_slowed_down(design, gap_s);
        let catch_up_m = self.catch_up_m(design, velocity);
        // The paper's path, which holds, hurries at every event.
        let must_hurry = unforeseen && design.mode != PathMode::Hold && surprise_m > catch_up_m;
        if must_hurry || surprise_m > self.reach_m(reported, gap_s) {
            let (reckoning, standstill) = (self.reckoning, self.standstill);
            *self = Self::begin(design, &PathEvent { velocity_m_s: Some(velocity), ..*event });
            self.reckoning.keep_rate(&reckoning, gap_s);
            self.standstill = standstill;
            return Moved::Teleported;
        }
        let back = carried_back(design, velocity, event.fraction);
        let step = [step[0] + back[0], step[1] + back[1]];
        let unchanged = step == [0.0; 2]
            && velocity == [0.0; 2]
            && self.reckoning.is_at_rest()
            && event.normal_force_n == self.reckoning.force_n();
        self.still &= unchanged;
        self.rebase(step);
        let force_n = event.normal_force_n;
        self.reckoning.follow(design, (event.sample, event.fraction), gap_s, velocity, force_n);
        if design.mode == PathMode::Hermite {
            let limit = self.reckoning.glide_limit_samples(design);
            self.history.push(design, event.sample, limit, velocity, force_n);
        }
        Moved::Followed
    }

    /// From the next sample on the normal force stays at `normal_force_n` until the next event: for a contact
    /// that fades, which would otherwise follow its own lift-off.
    pub fn hold_force(&mut self, normal_force_n: f64) {
        if self.still || !(normal_force_n.is_finite() && normal_force_n >= 0.0) {
            return;
        }
        self.force = State::settled_at(normal_force_n);
        self.reckoning.set_force_n(normal_force_n);
        self.history.set_force_n(normal_force_n);
    }

    /// How far from its expected position an event may be and still belong to the same stroke.
    fn reach_m(&self, reported: Option<[f64; 2]>, gap_s: f64) -> f64 {
        let before = self.reckoning.velocity();
        let now = reported.unwrap_or([UNREPORTED_SPEED_M_S, 0.0]);
        let speed = libm::hypot(before[0], before[1]).max(libm::hypot(now[0], now[1]));
        TELEPORT_FACTOR * speed * gap_s.min(LONGEST_GAP_S) + TELEPORT_MARGIN_M
    }

    /// How far from its expected position an event may be so that the filter, which follows a step of s metres
    /// in about [`TrajectoryDesign::step_time_s`], does not hurry.
    fn catch_up_m(&self, design: &TrajectoryDesign, velocity_m_s: [f64; 2]) -> f64 {
        let before = self.reckoning.velocity();
        let speed = libm::hypot(before[0], before[1]).max(libm::hypot(velocity_m_s[0], velocity_m_s[1]));
        HURRY * speed * design.step_time_s() + NOISE_M
    }

    /// Whether the path has lost belief in a movement for want of reports.
    fn has_slowed_down(&self, design: &TrajectoryDesign, gap_s: f64) -> bool {
        let read_late_s = match design.mode {
            PathMode::Extrapolate | PathMode::Hold => 0.0,
            PathMode::Hermite => design.hermite_delay_samples as f64 * design.sample_period_s,
        };
        let believed_s = self.reckoning.glide_limit_samples(design) as f64 * design.sample_period_s;
        self.reckoning.is_lost(gap_s, believed_s + read_late_s)
    }

    /// Makes the next `out.len()` samples.
    pub fn advance(&mut self, design: &TrajectoryDesign, out: &mut [PathPoint]) {
        let mut rest = out;
        while !rest.is_empty() {
            // Never beyond the grid on which stillness is looked for.
            let to_grid = (STILL_GRID - self.sample % STILL_GRID) as usize;
            let (next, later) = rest.split_at_mut(to_grid.min(rest.len()));
            if self.still {
                self.stay(next);
            } else {
                self.follow(design, next);
            }
            rest = later;
        }
    }

    fn stay(&mut self, out: &mut [PathPoint]) {
        self.sample += out.len() as u64;
        out.fill(PathPoint {
            position_m: self.origin_m,
            velocity_m_s: [0.0; 2],
            normal_force_n: self.reckoning.force_n().max(0.0),
        });
    }

    /// Goes on as `before`, a path of the same contact until a jump, as far as that has learned to know its game:
    /// the rate of its reports, and whether its zero velocities are to be believed.
    pub fn succeed(&mut self, before: &Self) {
        self.reckoning.keep_rate(&before.reckoning, 0.0);
        self.standstill = before.standstill;
    }

    /// The velocity of the latest event as it is believed, m/s.
    #[must_use]
    pub fn believed_velocity_m_s(&self) -> [f64; 2] {
        self.reckoning.velocity()
    }

    /// The force of the latest event, N.
    #[must_use]
    pub fn reported_force_n(&self) -> f64 {
        self.reckoning.force_n()
    }

    /// Whether the output no longer changes until the next event: at rest, at its place, force
    /// settled. A still path need not be advanced; it catches up at the next event.
    #[must_use]
    pub fn is_still(&self) -> bool {
        self.still
    }

    /// The next sample [`Self::advance`] makes.
    #[must_use]
    pub fn next_sample(&self) -> u64 {
        self.sample
    }

    /// The sample of the latest event, so that a contact nobody refreshes can be let go.
    #[must_use]
    pub fn latest_event_sample(&self) -> u64 {
        self.reckoning.sample()
    }

    /// Up to [`STILL_GRID`] samples, none of them beyond the grid.
    fn follow(&mut self, design: &TrajectoryDesign, out: &mut [PathPoint]) {
        let mut inputs = [[0.0; 3]; STILL_GRID as usize];
        let inputs = &mut inputs[..out.len()];
        self.inputs(design, inputs);
        let filter = &design.filter;
        let (mut axes, mut pressing) = (Two::new([filter; 2], self.axes), self.force);
        let (origin_m, to_speed) = (Pair::from(self.origin_m), Pair::from([design.band_to_speed; 2]));
        let mut low = [0.0; 3];
        for ([u, v, force_n], point) in inputs.iter().zip(&mut *out) {
            let smooth = axes.tick([*u, *v].into());
            let force = pressing.tick(filter, *force_n);
            let at: [f64; 2] = smooth.low.into();
            low = [at[0], at[1], force.low];
            *point = PathPoint {
                position_m: (origin_m + smooth.low).into(),
                velocity_m_s: (smooth.band * to_speed).into(),
                normal_force_n: force.low.max(0.0),
            };
        }
        (self.axes, self.force) = (axes.states(), pressing);
        self.sample += out.len() as u64;
        if let (Some(input), Some(point)) = (inputs.last(), out.last())
            && self.sample.is_multiple_of(STILL_GRID)
            && is_settled(input, low, point)
            && self.has_arrived(design)
        {
            self.fall_still([input[0], input[1]], input[2]);
        }
    }

    /// What the filters are given for the next samples: position along u and v from the origin, and force.
    fn inputs(&mut self, design: &TrajectoryDesign, out: &mut [[f64; 3]]) {
        let force_n = self.reckoning.force_n();
        match design.mode {
            PathMode::Extrapolate => self.reckoning.run(design, self.sample, out),
            PathMode::Hold => out.fill([0.0, 0.0, force_n]),
            PathMode::Hermite => {
                let glide = self.reckoning.glide_limit_samples(design);
                for (sample, out) in (self.sample..).zip(out) {
                    let ([u, v], force_n) = self.history.at(design, sample, glide);
                    *out = [u, v, force_n];
                }
            }
        }
    }

    /// Whether the input has come to its end: nothing moves it until the next event.
    fn has_arrived(&self, design: &TrajectoryDesign) -> bool {
        match design.mode {
            PathMode::Hold => true,
            PathMode::Extrapolate => self.reckoning.is_at_rest(),
            PathMode::Hermite => {
                self.reckoning.is_at_rest() && self.history.is_past(design, self.sample)
                    || self.history.has_glided_out(
                        design,
                        self.sample,
                        self.reckoning.glide_limit_samples(design),
                    )
            }
        }
    }

    /// Puts the output exactly where it already is but for rounding, and stays there.
    fn fall_still(&mut self, input: [f64; 2], force: f64) {
        self.rebase(input);
        self.axes = [State::default(); 2];
        self.force = State::settled_at(force);
        self.reckoning.stop();
        self.still = true;
    }

    /// Moves the origin of all coordinates by `step`; nothing else changes.
    fn rebase(&mut self, step: [f64; 2]) {
        for (axis, step) in step.iter().enumerate() {
            self.origin_m[axis] += step;
            self.axes[axis].shift(-step);
        }
        self.history.shift([-step[0], -step[1]]);
    }

    /// Sets the filter as if the finger had always moved as it does now.
    fn settle_on_line(&mut self, design: &TrajectoryDesign, velocity: [f64; 2]) {
        for (axis, state) in self.axes.iter_mut().enumerate() {
            let rise = velocity[axis] * design.sample_period_s;
            *state = match design.mode {
                PathMode::Hold => State::default(),
                PathMode::Extrapolate => State::settled_on_ramp(&design.filter, 0.0, rise),
                PathMode::Hermite => {
                    let start = -rise * design.hermite_delay_samples as f64;
                    State::settled_on_ramp(&design.filter, start, rise)
                }
            };
        }
    }
}
