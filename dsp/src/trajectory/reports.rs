//! Reports taken by a path: it goes on, makes up what a silence cost, or starts elsewhere.

use super::bend::{Bend, Turn};
use super::catch_up::{Distance, Speeds};
use super::{PathMode, STILL_DISTANCE_M, Trajectory, TrajectoryDesign, or_rest};
use crate::trajectory::history::History;

/// A jump is a teleport beyond this many times the distance the reported speed allows.
pub const TELEPORT_FACTOR: f64 = 3.0;

/// … plus this margin, m: position noise and a finger that sets off between two events. Assumed.
pub const TELEPORT_MARGIN_M: f64 = 0.005;

/// Speed a finger is believed to reach when the game reports none, m/s. Assumed.
pub const UNREPORTED_SPEED_M_S: f64 = 0.5;

/// Longest gap between events that counts towards the distance a finger may have travelled, s.
const LONGEST_GAP_S: f64 = 0.1;

/// Report of a game about one contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathEvent {
    /// Absolute index of the sample at which it holds …
    pub sample: u64,
    /// … and how far beyond that sample, 0 to 1 of a sample. Game time does not fall on samples:
    /// rounding it to them is a jitter, which at 22.05 kHz and 60 events a second ripples the
    /// velocity by 0.14 %.
    pub fraction: f64,
    /// Position on the surface along u and v, metres; may wrap or run on.
    pub position_m: [f64; 2],
    /// Tangential velocity along u and v, m/s; estimated from positions when missing.
    pub velocity_m_s: Option<[f64; 2]>,
    /// Force pressing the contact onto the surface, N.
    pub normal_force_n: f64,
}

/// Result of an event for [`Trajectory::moved`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Moved {
    /// The path goes on to the new position.
    Followed,
    /// The jump was too far for a finger, or for the filter to follow after a silence: the path now
    /// starts there. Treat it as a new contact.
    Teleported,
    /// Older than the event before it, or not finite: nothing changed.
    Ignored,
}

/// A report beside the one before it.
struct Seen {
    /// From where the latest event's contact was at its whole sample, m.
    step_m: [f64; 2],
    /// From where it was at its own time, m …
    covered_m: [f64; 2],
    /// … so long ago, s.
    gap_s: f64,
    /// From where it would be by now, m.
    surprise_m: f64,
}

pub(super) fn is_sane(event: &PathEvent) -> bool {
    let velocity = event.velocity_m_s.unwrap_or_default();
    let numbers = [event.position_m[0], event.position_m[1], velocity[0], velocity[1], event.normal_force_n];
    numbers.iter().all(|x| x.is_finite()) && (0.0..1.0).contains(&event.fraction)
}

/// Place at that sample of a contact that holds a fraction after it, relative to the event.
pub(super) fn carried_back(design: &TrajectoryDesign, velocity_m_s: [f64; 2], fraction: f64) -> [f64; 2] {
    velocity_m_s.map(|v| -v * fraction * design.sample_period_s)
}

impl Trajectory {
    /// Takes a new event. Its sample is normally the next one [`Self::advance`] will make; earlier
    /// and later stamps are carried to it along the event's velocity.
    pub fn moved(&mut self, design: &TrajectoryDesign, event: &PathEvent) -> Moved {
        if !is_sane(event) || event.sample < self.reckoning.sample() {
            return Moved::Ignored;
        }
        if self.still {
            self.sample = self.sample.max(event.sample);
        }
        let seen = self.see(design, event);
        let (reported, unknown) = self.standstill.weigh(event.velocity_m_s.map(or_rest), seen.covered_m);
        let velocity = or_rest(match reported {
            Some(velocity) => velocity,
            None if seen.gap_s > 0.0 => seen.covered_m.map(|x| x / seen.gap_s),
            None => self.reckoning.velocity(),
        });
        if seen.gap_s == 0.0
            && length(seen.covered_m) < STILL_DISTANCE_M
            && velocity == self.reckoning.velocity()
        {
            // Nothing new but the force: a game that stands reports the same instant again and
            // again.
            self.still &= event.normal_force_n == self.reckoning.force_n();
            self.reckoning.set_force_n(event.normal_force_n);
            return Moved::Followed;
        }
        let late = unknown || self.is_late(design, event, seen.gap_s);
        let distance = if seen.surprise_m > self.reach_m(reported, seen.gap_s) {
            Distance::TooFar
        } else if self.may_part(design, late, velocity) {
            let (away_m, speeds) = self.part(design, event, &seen, velocity, late);
            self.catch_up.over(design, away_m, &speeds)
        } else {
            Distance::Small
        };
        match distance {
            Distance::TooFar => return self.jump(design, event, velocity, seen.gap_s),
            Distance::MadeUp(over) => self.catch_up = over,
            Distance::Small => self.catch_up.go_on_beside(velocity),
        }
        let rejoins = matches!(distance, Distance::MadeUp(_));
        self.go_on(design, event, &seen, (velocity, reported), rejoins);
        Moved::Followed
    }

    fn see(&self, design: &TrajectoryDesign, event: &PathEvent) -> Seen {
        // The origin is where the latest event's contact was at its whole sample.
        let since_origin = (event.sample - self.reckoning.sample()) as f64 + event.fraction;
        let gap_s = (since_origin - self.reckoning.fraction()).max(0.0) * design.sample_period_s;
        let expected = self.reckoning.expected(design, since_origin * design.sample_period_s);
        let latest = carried_back(design, self.reckoning.velocity(), -self.reckoning.fraction());
        let step_m = [0, 1].map(|axis| {
            let near = self.origin_m[axis] + expected[axis];
            design.unwrap(axis, event.position_m[axis], near) - self.origin_m[axis]
        });
        Seen {
            step_m,
            covered_m: [step_m[0] - latest[0], step_m[1] - latest[1]],
            gap_s,
            surprise_m: length([step_m[0] - expected[0], step_m[1] - expected[1]]),
        }
    }

    /// Goes on to an event; one that `rejoins` comes after a silence that the path has not guessed
    /// well.
    fn go_on(
        &mut self,
        design: &TrajectoryDesign,
        event: &PathEvent,
        seen: &Seen,
        (velocity, reported): ([f64; 2], Option<[f64; 2]>),
        rejoins: bool,
    ) {
        let back = carried_back(design, velocity, event.fraction);
        let step = [seen.step_m[0] + back[0], seen.step_m[1] + back[1]];
        let force_n = event.normal_force_n;
        let unchanged = step == [0.0; 2]
            && velocity == [0.0; 2]
            && self.reckoning.is_at_rest()
            && force_n == self.reckoning.force_n();
        self.still &= unchanged;
        self.rebase(step);
        let turn = self.turn(design, seen, reported, rejoins);
        let at = (event.sample, event.fraction);
        self.reckoning.follow(design, at, seen.gap_s, (velocity, turn), force_n);
        match design.mode {
            PathMode::Hermite if rejoins => self.history = History::begin(event.sample, velocity, force_n),
            PathMode::Hermite => {
                let belief = self.reckoning.belief(design);
                self.history.push(design, event.sample, belief, velocity, force_n);
            }
            PathMode::BandLimited => {
                let (belief, samples) = (self.reckoning.belief(design), (self.sample, event.sample));
                self.estimate.push(design, samples, belief, reported, rejoins);
            }
            PathMode::Extrapolate | PathMode::Hold => {}
        }
    }

    /// Course of the velocity of an event: of a path that reckons on, where reports hold
    /// velocities.
    fn turn(
        &mut self,
        design: &TrajectoryDesign,
        seen: &Seen,
        reported: Option<[f64; 2]>,
        rejoins: bool,
    ) -> Turn {
        match reported {
            Some(velocity) if design.mode == PathMode::Extrapolate && !rejoins => {
                self.bend.follow(seen.gap_s, seen.covered_m, velocity, self.reckoning.period_s())
            }
            _ => {
                self.bend = Bend::begin(reported);
                Turn::default()
            }
        }
    }

    fn jump(
        &mut self,
        design: &TrajectoryDesign,
        event: &PathEvent,
        velocity: [f64; 2],
        gap_s: f64,
    ) -> Moved {
        let (reckoning, standstill) = (self.reckoning, self.standstill);
        *self = Self::begin(design, &PathEvent { velocity_m_s: Some(velocity), ..*event });
        self.reckoning.keep_rate(&reckoning, gap_s);
        self.standstill = standstill;
        Moved::Teleported
    }

    /// Tests whether the path may be elsewhere than an event says. One that extrapolates has run on
    /// past a finger that stopped; one that interpolates reads late enough to see it stop; the
    /// paper's, which holds, hurries at every event.
    fn may_part(&self, design: &TrajectoryDesign, late: bool, velocity: [f64; 2]) -> bool {
        match design.mode {
            PathMode::Extrapolate => late || velocity == [0.0; 2],
            PathMode::BandLimited => late,
            PathMode::Hermite => late,
            PathMode::Hold => false,
        }
    }

    /// Largest distance of an event from its expected position within one stroke.
    fn reach_m(&self, reported: Option<[f64; 2]>, gap_s: f64) -> f64 {
        let now = reported.unwrap_or([UNREPORTED_SPEED_M_S, 0.0]);
        let speed = length(self.reckoning.velocity()).max(length(now));
        TELEPORT_FACTOR * speed * gap_s.min(LONGEST_GAP_S) + TELEPORT_MARGIN_M
    }

    /// Tests whether the path has begun to lose trust in a movement for want of reports.
    fn is_late(&self, design: &TrajectoryDesign, event: &PathEvent, gap_s: f64) -> bool {
        let read_late_s = match design.mode {
            PathMode::Extrapolate | PathMode::Hold | PathMode::BandLimited => 0.0,
            PathMode::Hermite => design.hermite_delay_samples as f64 * design.sample_period_s,
        };
        let until = self.sample.max(event.sample);
        let silence_s = (until.saturating_sub(self.reckoning.sample())) as f64 * design.sample_period_s;
        let believed_s = self.reckoning.belief(design).whole_samples as f64 * design.sample_period_s;
        self.reckoning.is_lost(silence_s.max(gap_s), believed_s + read_late_s)
    }

    /// Distance of the path's input from the line of a new event, m, now or when the event comes
    /// into force, and how fast both move.
    fn part(
        &self,
        design: &TrajectoryDesign,
        event: &PathEvent,
        seen: &Seen,
        now_m_s: [f64; 2],
        late: bool,
    ) -> ([f64; 2], Speeds) {
        let now = self.sample.max(event.sample);
        let read_late =
            if design.mode == PathMode::Hermite { design.hermite_delay_samples as f64 } else { 0.0 };
        let since_s = ((now - event.sample) as f64 - event.fraction - read_late) * design.sample_period_s;
        let (here_m, just_m) = (self.guessed(design, now), self.guessed(design, now.saturating_sub(1)));
        let away_m = [0, 1].map(|axis| here_m[axis] - (seen.step_m[axis] + now_m_s[axis] * since_s));
        let path_m_s = [0, 1].map(|axis| (here_m[axis] - just_m[axis]) / design.sample_period_s);
        let path_m_s = late.then_some(path_m_s);
        (away_m, Speeds { before_m_s: self.reckoning.velocity(), now_m_s, path_m_s })
    }

    /// Place of the path's input at a sample by the reports so far, from the origin.
    fn guessed(&self, design: &TrajectoryDesign, sample: u64) -> [f64; 2] {
        if design.mode == PathMode::Hermite {
            return self.history.at(design, sample, self.reckoning.belief(design)).0;
        }
        let since_s = sample.saturating_sub(self.reckoning.sample()) as f64 * design.sample_period_s;
        self.reckoning.expected(design, since_s)
    }
}

fn length([u, v]: [f64; 2]) -> f64 {
    libm::hypot(u, v)
}
