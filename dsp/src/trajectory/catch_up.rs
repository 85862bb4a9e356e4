//! Back to the reports after a silence of the game, without hurry.
//!
//! ```text
//! input(t) = reckoned(t) + x(t) a       dx/dt = −c       dc/dt = ±A towards min(w, √(2 A x)), until x = 0
//! w = 0.35 V, more while the contact itself moves slower than V: 1.35 V − |v₀|          A = V / 0.1 s
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | x, a | `left_m`, `away` | how far the path still is from where the reports say, and whither |
//! | c | `closing_m_s` | begins with the speed that the path still had: it does not start with a jerk |
//! | V | `own_speed_m_s` | the faster of the speeds before and after the silence |
//! | w | `limit_m_s` | |
//!
//! A path that came back at once would be heard as a zip: the 30 Hz filter follows a step of s
//! metres at up to 86 s m/s, after 100 ms without reports six times the finger's own speed. Over
//! hills a sudden change of speed is felt as much as too much of it: hence the slow turn.

use super::{PathPoint, TrajectoryDesign};

/// Share of a contact's own speed by which the path may outrun it.
pub(super) const MAX_OVERSPEED: f64 = 0.35;

/// Time in which a path reaches the contact's own speed, s. Chosen: over hills a hitch is then felt
/// at most 1.9 times as strongly as the stroke.
const TURN_S: f64 = 0.1;

/// Longest time a path takes to catch up, s: covers 0.2 s without reports, and a first report after
/// 0.2 s. What is further away is a jump.
const LONGEST_CATCH_UP_S: f64 = 1.0;

/// Distance that is a tracker's noise and no movement, m. Assumed: twice the 50 µm of the project's
/// bars.
const NOISE_M: f64 = 1e-4;

/// Remainder of a distance between a path and its reports.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct CatchUp {
    /// m; 0 once it is made up.
    left_m: f64,
    /// From where the reports say to where the path is; of length 1.
    away: [f64; 2],
    own_speed_m_s: f64,
    limit_m_s: f64,
    closing_m_s: f64,
}

/// Speeds of a contact about a silence, m/s.
pub(super) struct Speeds {
    /// As it was reported before …
    pub before_m_s: [f64; 2],
    /// … and after it.
    pub now_m_s: [f64; 2],
    /// Remainder of the path; none where the contact says that it stands, and the path is to be
    /// there as soon as may be.
    pub path_m_s: Option<[f64; 2]>,
}

/// True where a path can come back to its reports.
pub(super) enum Distance {
    /// The filter alone makes it up without hurry.
    Small,
    /// It is made up like this.
    MadeUp(CatchUp),
    /// No finger would have come so far: a jump.
    TooFar,
}

impl CatchUp {
    /// A path that is `away_m` from where a late report says.
    pub fn over(&self, design: &TrajectoryDesign, away_m: [f64; 2], speeds: &Speeds) -> Distance {
        let Speeds { before_m_s, now_m_s, path_m_s } = *speeds;
        let own_speed_m_s = length(before_m_s).max(length(now_m_s)).max(self.own_speed_m_s);
        if length(away_m) <= room_m_s(own_speed_m_s, length(now_m_s)) * design.step_time_s() {
            return Distance::Small;
        }
        let away_m = [0, 1].map(|axis| away_m[axis] + self.left_m * self.away[axis]);
        let left_m = length(away_m);
        if left_m == 0.0 {
            return Distance::MadeUp(Self::default());
        }
        let away = away_m.map(|x| x / left_m);
        let mut next = Self { left_m, away, own_speed_m_s, ..Self::default() };
        next.go_on_beside(now_m_s);
        next.closing_m_s = path_m_s.map_or(next.limit_m_s, |path_m_s| {
            let parting = |axis: usize| path_m_s[axis] - now_m_s[axis] - self.closing_m_s * self.away[axis];
            -(parting(0) * away[0] + parting(1) * away[1])
        });
        if left_m > LONGEST_CATCH_UP_S * next.limit_m_s { Distance::TooFar } else { Distance::MadeUp(next) }
    }

    /// Goes on while the contact moves at `now_m_s`.
    pub fn go_on_beside(&mut self, now_m_s: [f64; 2]) {
        if self.is_over() {
            return;
        }
        let now_m_s = length(now_m_s);
        self.own_speed_m_s = self.own_speed_m_s.max(now_m_s);
        self.limit_m_s = room_m_s(self.own_speed_m_s, now_m_s).max(NOISE_M / LONGEST_CATCH_UP_S);
    }

    /// Tests whether the path is where the reports say.
    pub fn is_over(&self) -> bool {
        self.left_m == 0.0
    }

    /// Adds what is left to the coming inputs.
    pub fn add_to(&mut self, design: &TrajectoryDesign, inputs: &mut [PathPoint]) {
        let step_s = design.sample_period_s;
        let turn_m_s2 = self.own_speed_m_s.max(self.limit_m_s) / TURN_S;
        for PathPoint { position_m: [u, v], .. } in inputs {
            *u += self.left_m * self.away[0];
            *v += self.left_m * self.away[1];
            let wanted_m_s = libm::sqrt(2.0 * turn_m_s2 * self.left_m).min(self.limit_m_s);
            let most_m_s = turn_m_s2 * step_s;
            self.closing_m_s += (wanted_m_s - self.closing_m_s).clamp(-most_m_s, most_m_s);
            self.left_m = (self.left_m - self.closing_m_s * step_s).max(0.0);
        }
        if self.is_over() {
            *self = Self::default();
        }
    }
}

/// Largest speed of a path besides a contact that moves at `now_m_s`.
fn room_m_s(own_speed_m_s: f64, now_m_s: f64) -> f64 {
    (1.0 + MAX_OVERSPEED) * own_speed_m_s - now_m_s
}

fn length([u, v]: [f64; 2]) -> f64 {
    libm::hypot(u, v)
}

#[cfg(test)]
mod tests {
    use super::super::PathMode;
    use super::*;

    #[test]
    fn a_still_contact_makes_up_noise_and_jumps_beyond_it() {
        let design =
            TrajectoryDesign::new(PathMode::Extrapolate, 30.0, 44_100.0, [f64::INFINITY; 2]).unwrap();
        let speeds = Speeds { before_m_s: [0.0; 2], now_m_s: [0.0; 2], path_m_s: None };
        let over = |away_m| CatchUp::default().over(&design, [away_m, 0.0], &speeds);
        assert!(matches!(over(NOISE_M), Distance::MadeUp(_)));
        assert!(matches!(over(1.01 * NOISE_M), Distance::TooFar));
    }
}
