//! The path stage: sparse contact events become one position, velocity and normal force a sample.
//!
//! ```text
//! input(t)  = p₀ + v₀ (t − t₀) + b(t − t₀)     t − t₀ ≤ 1.5 T        (extrapolate)
//!             … then v fades as e^(−(t − t₀ − 1.5 T)/τ)
//! position  = H_lp(input)        velocity = d position/dt        H_lp: [`crate::butterworth`]
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | p₀, v₀, t₀ | the latest [`PathEvent`] | position unwrapped, velocity reported or estimated |
//! | b | `bend` | how the velocity changes, as far as that has predicted the reports so far; 0 without reported velocities |
//! | T | `DeadReckoning`'s running event period | 1–100 ms, 1/60 s until two events are known |
//! | τ | how a velocity fades that no report renews | T/2, at least 50 ms |
//! | H_lp | [`TrajectoryDesign`]'s filter | Hasti §III-C: 2nd-order Butterworth, −3 dB at 30 Hz |
//! | velocity | the filter's band output | smooth, so that pitch does not step at events |
//!
//! **What we changed.** The paper holds each event's position until the next ([`PathMode::Hold`]).
//! At 60 Hz and a constant 0.1 m/s that leaves 36 % rms velocity ripple, heard as pitch wobble.
//! [`PathMode::Extrapolate`] feeds the same filter with dead reckoning: no ripple on clean events,
//! under 5 % with ±20 % jitter and 50 µm noise, and half the lag (7.5 ms, the filter's own). It
//! reckons with the change of the velocity too: a hand that reaches 90 mm in 0.55 s is followed to
//! 1 µm rms where a straight line between reports errs by 61 µm, and a finger that stops dead is
//! overrun as before. [`PathMode::Hermite`] interpolates instead of extrapolating,
//! [`HERMITE_DELAY_S`] late: for offline rendering and for games that report poor velocities.
//! [`PathMode::BandLimited`] estimates the motion from the last six reports, as a hand moves: no
//! later than extrapolation, and within 6 dB of the best linear estimator of handwriting and
//! drawing (`cli/tests/path_estimate.rs`, `asperity report`).
//!
//! The normal force runs through the same filter, held between events (interpolated in Hermite
//! mode), and never goes below zero: the filter's 4 % undershoot would pull at the surface.
//!
//! A landing or a jump that no finger can make (a *teleport*) sets the filter to the state it would
//! have had on the straight line through the event, so neither starts with a transient.
//!
//! A hitch of the game is no jump: the path fades while no report comes, and then makes up the
//! distance at most 1.41 times as fast as the finger moves (`catch_up`), so that it neither zips
//! nor steps; so does one whose first velocity had to be guessed.
//!
//! All arithmetic is relative to the latest event's position, so a path that has run a million
//! periods keeps its velocity; every sample depends on the samples before it alone, so any split
//! into blocks gives the same bits.

mod band_limited;
mod bend;
mod catch_up;
mod design;
mod history;
mod reckoning;
mod reports;
mod standstill;
#[cfg(test)]
mod tests;

use crate::butterworth::{State, Two};
use crate::pair::Pair;
use band_limited::Estimate;
use bend::Bend;
use catch_up::CatchUp;
pub use design::{HERMITE_DELAY_S, PathMode, TrajectoryDesign};
use history::History;
use reckoning::DeadReckoning;
pub use reports::{Moved, PathEvent, TELEPORT_FACTOR, TELEPORT_MARGIN_M, UNREPORTED_SPEED_M_S};
use reports::{carried_back, is_sane};
use standstill::Standstill;

/// Below this a reported or decayed velocity is rest, m/s.
const REST_SPEED_M_S: f64 = 1e-7;
/// The output is still when the filter is this close to its input: m, m/s and N.
const STILL_DISTANCE_M: f64 = 1e-10;
const STILL_SPEED_M_S: f64 = 1e-8;
const STILL_FORCE_N: f64 = 1e-7;
/// Stillness is looked for on this absolute sample grid.
const STILL_GRID: u64 = 64;

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

/// The path of one contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trajectory {
    /// The next sample [`Trajectory::advance`] makes.
    sample: u64,
    /// Origin of the coordinates of everything below, metres on the unwrapped surface.
    origin_m: [f64; 2],
    axes: [State; 2],
    force: State,
    reckoning: DeadReckoning,
    bend: Bend,
    history: History,
    estimate: Estimate,
    standstill: Standstill,
    catch_up: CatchUp,
    still: bool,
}

/// The velocity with rest made exact.
fn or_rest(velocity: [f64; 2]) -> [f64; 2] {
    if libm::hypot(velocity[0], velocity[1]) < REST_SPEED_M_S { [0.0; 2] } else { velocity }
}

/// True where the filters have come to their inputs.
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
            reckoning: DeadReckoning::begin(sane.sample, sane.fraction, velocity, sane.normal_force_n),
            bend: Bend::begin(sane.velocity_m_s.map(or_rest)),
            history: History::begin(sane.sample, velocity, sane.normal_force_n),
            estimate: Estimate::begin(design, sane.sample, sane.velocity_m_s.map(or_rest)),
            standstill: Standstill::begin(sane.velocity_m_s.map(or_rest)),
            catch_up: CatchUp::default(),
            still: false,
        };
        path.settle_on_line(design, velocity);
        path
    }

    /// From the next sample on the normal force stays at `normal_force_n` until the next event: for
    /// a contact that fades, which would otherwise follow its own lift-off.
    pub fn hold_force(&mut self, normal_force_n: f64) {
        if self.still || !(normal_force_n.is_finite() && normal_force_n >= 0.0) {
            return;
        }
        self.force = State::settled_at(normal_force_n);
        self.reckoning.set_force_n(normal_force_n);
        self.history.set_force_n(normal_force_n);
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

    /// Goes on as `before`, a path of the same contact until a jump, as far as that has learned to
    /// know its game: the rate of its reports, and whether its zero velocities are to be believed.
    pub fn inherit_rate(&mut self, before: &Self) {
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

    /// Tests whether the output no longer changes until the next event: at rest, at its place,
    /// force settled. A still path need not be advanced; it catches up at the next event.
    #[must_use]
    pub fn is_still(&self) -> bool {
        self.still
    }

    /// The next sample [`Self::advance`] makes.
    #[must_use]
    pub fn next_sample(&self) -> u64 {
        self.sample
    }

    /// Up to [`STILL_GRID`] samples, none of them beyond the grid.
    fn follow(&mut self, design: &TrajectoryDesign, out: &mut [PathPoint]) {
        let filter = &design.filter;
        let (mut axes, mut pressing) = (Two::new([filter; 2], self.axes), self.force);
        let (origin_m, to_speed) = (Pair::from(self.origin_m), Pair::from([design.band_to_speed; 2]));
        let (mut input, mut low) = ([0.0; 3], [0.0; 3]);
        self.inputs(design, out);
        for point in &mut *out {
            let ([u, v], force_n) = (point.position_m, point.normal_force_n);
            let smooth = axes.tick([u, v].into());
            let force = pressing.tick(filter, force_n);
            let at: [f64; 2] = smooth.low.into();
            (input, low) = ([u, v, force_n], [at[0], at[1], force.low]);
            *point = PathPoint {
                position_m: (origin_m + smooth.low).into(),
                velocity_m_s: (smooth.band * to_speed).into(),
                normal_force_n: force.low.max(0.0),
            };
        }
        (self.axes, self.force) = (axes.states(), pressing);
        let end = if design.mode == PathMode::BandLimited { self.estimated(design, out) } else { None };
        self.come_to(design, (&input, low), out, end);
    }

    /// Has made these points, of which the filters were given `input` for the last, and falls still
    /// if nothing moves any more; `end`: where an estimate ends.
    fn come_to(
        &mut self,
        design: &TrajectoryDesign,
        (input, low): (&[f64; 3], [f64; 3]),
        out: &[PathPoint],
        end: Option<[f64; 2]>,
    ) {
        self.sample += out.len() as u64;
        if let Some(point) = out.last()
            && self.sample.is_multiple_of(STILL_GRID)
            && is_settled(input, low, point)
            && self.has_arrived(design)
            && self.catch_up.is_over()
        {
            self.fall_still(end.unwrap_or([input[0], input[1]]), input[2]);
        }
    }

    /// Puts the most likely motion in the place of what the filters made; where it ends, from the
    /// origin.
    fn estimated(&mut self, design: &TrajectoryDesign, out: &mut [PathPoint]) -> Option<[f64; 2]> {
        let belief = self.reckoning.belief(design);
        let kept = band_limited::kept_a_sample(design);
        let mut end = None;
        for (sample, point) in (self.sample..).zip(out) {
            let [[u, u_speed], [v, v_speed]] = self.estimate.next(design, sample, belief, kept);
            point.position_m = [self.origin_m[0] + u, self.origin_m[1] + v];
            point.velocity_m_s = [u_speed, v_speed];
            end = Some([u, v]);
        }
        end
    }

    /// Inputs of the filters for the next samples, as points: places from the origin, and force.
    /// Velocities are left as they are. The points' own memory holds them, because any other would
    /// have to be cleared for each stretch.
    fn inputs(&mut self, design: &TrajectoryDesign, out: &mut [PathPoint]) {
        let force_n = self.reckoning.force_n();
        match design.mode {
            PathMode::Extrapolate | PathMode::BandLimited => self.reckoning.run(design, self.sample, out),
            PathMode::Hold => {
                let rests = PathPoint { normal_force_n: force_n, ..PathPoint::default() };
                out.fill(rests);
            }
            PathMode::Hermite => {
                let belief = self.reckoning.belief(design);
                for (sample, out) in (self.sample..).zip(&mut *out) {
                    (out.position_m, out.normal_force_n) = self.history.at(design, sample, belief);
                }
            }
        }
        if !self.catch_up.is_over() {
            self.catch_up.add_to(design, out);
        }
    }

    /// Tests whether the input has come to its end: nothing moves it until the next event.
    fn has_arrived(&self, design: &TrajectoryDesign) -> bool {
        match design.mode {
            PathMode::Hold => true,
            PathMode::Extrapolate | PathMode::BandLimited => self.reckoning.is_at_rest(),
            PathMode::Hermite => {
                self.reckoning.is_at_rest() && self.history.is_past(design, self.sample)
                    || self.history.has_glided_out(design, self.sample, self.reckoning.belief(design))
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
        self.estimate.shift([-step[0], -step[1]]);
    }

    /// Sets the filter as if the finger had always moved as it does now.
    fn settle_on_line(&mut self, design: &TrajectoryDesign, velocity: [f64; 2]) {
        for (axis, state) in self.axes.iter_mut().enumerate() {
            let rise = velocity[axis] * design.sample_period_s;
            *state = match design.mode {
                PathMode::Hold => State::default(),
                PathMode::Extrapolate | PathMode::BandLimited => {
                    State::settled_on_ramp(&design.filter, 0.0, rise)
                }
                PathMode::Hermite => {
                    let start = -rise * design.hermite_delay_samples as f64;
                    State::settled_on_ramp(&design.filter, start, rise)
                }
            };
        }
    }
}
