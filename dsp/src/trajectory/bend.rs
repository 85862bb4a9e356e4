//! Bend: how a hand's velocity is changing, from its last three reports, as far as that has
//! predicted the reports so far.
//!
//! ```text
//! velocity(τ) = v + T (a τ + ½ j τ²)            τ ≤ 1.25 T₀ after the report, then constant
//! a = Δ₁ + Δ₂ g     j = 2 Δ₂                    Δ₁, Δ₂: first and second divided differences of the last velocities, g: the last interval
//! T = max(0, 1 − 4 S_bent/S_straight)           S ← ½ S + |p − p̂|² + |½ g (v − v̂)|²    of each foretelling at each report
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | v, p | a report's velocity and place | of reports that hold a velocity only |
//! | T | `trust` | 0 unless the bend has predicted the reports at least twice as well as the straight line |
//! | T₀ | the running event period | |
//!
//! A hand that speeds up by 2 m/s² leaves dead reckoning by 0.3 mm between two reports at 60 Hz, a
//! seventh of a 2 mm grating's period and more than a finger's whole path error otherwise. A finger
//! that stops dead or meets an edge is predicted by neither, so that the trust is gone with the
//! very report that holds it, and the path goes on as dead reckoning does; so it is where
//! reports are noisy, or a game's velocities do not belong to its places.

/// Weight of the past in what has been predicted.
const FORGETTING: f64 = 0.5;
/// Ratio of squared errors below which the bent one of two predictions counts.
const SELECTION_RATIO: f64 = 4.0;
/// Event periods for which a bend is believed.
const VELOCITY_HOLD_PERIODS: f64 = 1.25;
/// Intervals below this are no intervals, s.
const SHORTEST_S: f64 = 1e-5;

/// Course of the velocity after a report.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Turn {
    /// m/s².
    acceleration_m_s2: [f64; 2],
    /// m/s³.
    jerk_m_s3: [f64; 2],
    /// Until when, s after the report.
    until_s: f64,
}

impl Turn {
    /// By how much a contact is elsewhere, m, and faster, m/s, so long after the report than at
    /// constant velocity.
    pub fn after(&self, since_s: f64) -> [[f64; 2]; 2] {
        let bent_s = since_s.clamp(0.0, self.until_s);
        let straight_s = (since_s - bent_s).max(0.0);
        let faster =
            [0, 1].map(|axis| bent_s * (self.acceleration_m_s2[axis] + 0.5 * bent_s * self.jerk_m_s3[axis]));
        let further = [0, 1].map(|axis| {
            let bent = 0.5 * self.acceleration_m_s2[axis] + bent_s * self.jerk_m_s3[axis] * (1.0 / 6.0);
            bent_s * bent_s * bent + straight_s * faster[axis]
        });
        [further, faster]
    }

    /// Tests whether it changes nothing.
    pub fn is_none(&self) -> bool {
        self.acceleration_m_s2 == [0.0; 2] && self.jerk_m_s3 == [0.0; 2]
    }
}

/// The last reports' velocities, and how well they have predicted each other.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Bend {
    /// The latest velocity, and those before it, m/s …
    velocities_m_s: [[f64; 2]; 3],
    /// … and how many there are.
    known: usize,
    /// The latest interval, and the one before it, s.
    gaps_s: [f64; 2],
    /// As the last three velocities have it, trusted or not.
    raw: Turn,
    /// Squared errors of the straight way to foretell, and of the bent one, m².
    missed_m2: [f64; 2],
}

impl Bend {
    /// A contact whose first report says this.
    pub fn begin(velocity_m_s: Option<[f64; 2]>) -> Self {
        let mut bend = Self::default();
        if let Some(velocity) = velocity_m_s {
            (bend.velocities_m_s[0], bend.known) = (velocity, 1);
        }
        bend
    }

    /// Takes a report that holds a velocity, `gap_s` and `covered_m` after the one before; how the
    /// velocity will change.
    pub fn follow(&mut self, gap_s: f64, covered_m: [f64; 2], velocity_m_s: [f64; 2], period_s: f64) -> Turn {
        if self.known == 0 || gap_s < SHORTEST_S {
            *self = Self::begin(Some(velocity_m_s));
            return Turn::default();
        }
        self.compare(gap_s, covered_m, velocity_m_s);
        self.velocities_m_s = [velocity_m_s, self.velocities_m_s[0], self.velocities_m_s[1]];
        self.gaps_s = [gap_s, self.gaps_s[0]];
        self.known = (self.known + 1).min(3);
        self.raw = if self.known == 3 { self.through_three(period_s) } else { Turn::default() };
        let [straight, bent] = self.missed_m2;
        // One that is said to stand stands.
        if velocity_m_s == [0.0; 2] || straight <= SELECTION_RATIO * bent {
            return Turn::default();
        }
        let trust = 1.0 - SELECTION_RATIO * bent / straight;
        Turn {
            acceleration_m_s2: self.raw.acceleration_m_s2.map(|a| trust * a),
            jerk_m_s3: self.raw.jerk_m_s3.map(|j| trust * j),
            ..self.raw
        }
    }

    /// Errors of each prediction against what has come.
    fn compare(&mut self, gap_s: f64, covered_m: [f64; 2], velocity_m_s: [f64; 2]) {
        let [further, faster] = self.raw.after(gap_s);
        for (missed_m2, share) in self.missed_m2.iter_mut().zip([0.0, 1.0]) {
            *missed_m2 *= FORGETTING;
            for axis in 0..2 {
                let told_m_s = self.velocities_m_s[0][axis];
                let place_m = covered_m[axis] - told_m_s * gap_s - share * further[axis];
                let speed_m_s = velocity_m_s[axis] - told_m_s - share * faster[axis];
                let turned_m = 0.5 * gap_s * speed_m_s;
                *missed_m2 += place_m * place_m + turned_m * turned_m;
            }
        }
    }

    /// The parabola through the last three velocities.
    fn through_three(&self, period_s: f64) -> Turn {
        let [last_s, before_s] = self.gaps_s;
        let [now, last, before] = self.velocities_m_s;
        let mut turn = Turn { until_s: VELOCITY_HOLD_PERIODS * period_s, ..Turn::default() };
        for axis in 0..2 {
            let first = (now[axis] - last[axis]) / last_s;
            let second = (first - (last[axis] - before[axis]) / before_s) / (last_s + before_s);
            turn.acceleration_m_s2[axis] = first + second * last_s;
            turn.jerk_m_s3[axis] = 2.0 * second;
        }
        turn
    }
}
