//! Standstill detection: whether a reported velocity of zero is believed.
//!
//! Some games fill in a velocity of zero because they have none. A finger that is said to rest and
//! is found elsewhere, report after report, does not rest: from then on its velocity is estimated
//! from its places, until a report holds another velocity than zero.

/// Way a contact may drift while every report says that it rests, m: more than a tracker's noise,
/// less than a stroke's way between two reports at 60 Hz from 0.03 m/s on. Assumed.
const DRIFT_AT_REST_M: f64 = 5e-4;

/// The run of reports that say zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Standstill {
    /// True where nothing is known yet: the first report held no velocity.
    unknown: bool,
    /// True where the latest report said zero.
    claimed: bool,
    /// Distance of the contact from where the run began, m.
    drift_m: [f64; 2],
    /// True where it has moved all the same.
    disproved: bool,
}

impl Standstill {
    /// A contact whose first report says this.
    pub fn begin(velocity_m_s: Option<[f64; 2]>) -> Self {
        Self { unknown: velocity_m_s.is_none(), claimed: velocity_m_s == Some([0.0; 2]), ..Self::default() }
    }

    /// Takes a report, `step_m` from the one before. Returns the velocity to believe (none: to be
    /// estimated), and whether what was believed before it was no knowledge: a missing velocity, or
    /// a zero that this report disproves.
    pub fn weigh(&mut self, velocity_m_s: Option<[f64; 2]>, step_m: [f64; 2]) -> (Option<[f64; 2]>, bool) {
        let unknown = core::mem::take(&mut self.unknown);
        if velocity_m_s != Some([0.0; 2]) {
            *self = Self::default();
            return (velocity_m_s, unknown);
        }
        if self.claimed {
            self.drift_m = [self.drift_m[0] + step_m[0], self.drift_m[1] + step_m[1]];
        }
        self.claimed = true;
        let before = self.disproved;
        self.disproved |= libm::hypot(self.drift_m[0], self.drift_m[1]) > DRIFT_AT_REST_M;
        (if self.disproved { None } else { velocity_m_s }, unknown || self.disproved && !before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REST: Option<[f64; 2]> = Some([0.0; 2]);

    #[test]
    fn a_finger_that_rests_within_a_trackers_noise_is_believed() {
        let mut standstill = Standstill::begin(REST);
        for n in 0..1000 {
            let step_m = if n % 2 == 0 { 5e-5 } else { -5e-5 };
            assert_eq!(standstill.weigh(REST, [step_m, -step_m]), (REST, false));
        }
    }

    #[test]
    fn a_moving_finger_reported_still_keeps_its_speed_until_a_velocity_comes() {
        let mut standstill = Standstill::begin(REST);
        assert_eq!(standstill.weigh(REST, [1e-3, 0.0]), (None, true));
        assert_eq!(standstill.weigh(REST, [1e-3, 0.0]), (None, false));
        assert_eq!(standstill.weigh(Some([0.1, 0.0]), [1e-3, 0.0]), (Some([0.1, 0.0]), false));
        // The first report of a stop is believed, however far the finger came before it.
        assert_eq!(standstill.weigh(REST, [1e-3, 0.0]), (REST, false));
        assert_eq!(standstill.weigh(REST, [0.0, 0.0]), (REST, false));
    }
}
