//! Spin: what slips faster than it moves, a wheel that turns on the spot or slows down locked.
//!
//! Its own relief runs over the place of contact then. The engine has the ground's: that runs on
//! under the contact with what the slip has over the path, in the direction of the path or along u,
//! and stays where it came to until the contact ends. A slip up to the path's speed changes
//! nothing.

use crate::model::event::ContactSample;

/// Slip beyond the path's speed that is a number's rounding or a solver's tremble, m/s.
const NO_SPIN_M_S: f64 = 0.002;
/// Longest time between two reports over which a wheel is believed to have spun on, s.
const LONGEST_S: f64 = 0.25;

/// Spin of one contact, along u and v.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Spin {
    /// Way that the ground has run on, m, and its speed, m/s.
    run_m: [f64; 2],
    runs_m_s: [f64; 2],
    /// Time and place of the last report.
    told_s: f64,
    uv: Option<[f64; 2]>,
}

impl Spin {
    /// Place of the last report as it came.
    pub(super) fn uv(&self) -> Option<[f64; 2]> {
        self.uv
    }

    /// The sample of a contact over ground that has run on, reported at `now_s` on a surface of
    /// `size_m`.
    pub(super) fn under(&mut self, now_s: f64, size_m: [f64; 2], sample: ContactSample) -> ContactSample {
        let elapsed_s = (now_s - self.told_s).clamp(0.0, LONGEST_S);
        self.run_m = [0, 1].map(|i| self.run_m[i] + self.runs_m_s[i] * elapsed_s);
        self.told_s = now_s;
        // A velocity that is not reported is 0 where the place stays, and unknown where it moves.
        let stays = self.uv.replace(sample.uv) == Some(sample.uv);
        let path_m_s = sample.velocity_m_s.or(stays.then_some([0.0; 2]));
        self.runs_m_s = match (path_m_s, sample.slip_m_s) {
            (Some(path_m_s), Some(slip_m_s)) => beyond(path_m_s, slip_m_s),
            _ => [0.0; 2],
        };
        if self.run_m == [0.0; 2] && self.runs_m_s == [0.0; 2] {
            return sample;
        }
        let uv = [0, 1].map(|i| sample.uv[i] + self.run_m[i] / size_m[i]);
        let velocity_m_s = path_m_s.map(|path| [0, 1].map(|i| path[i] + self.runs_m_s[i]));
        ContactSample { uv, velocity_m_s, ..sample }
    }
}

/// Velocity that a slip has beyond that of the path, m/s.
fn beyond(path_m_s: [f64; 2], slip_m_s: f64) -> [f64; 2] {
    let speed_m_s = libm::hypot(path_m_s[0], path_m_s[1]);
    let beyond_m_s = slip_m_s - speed_m_s;
    if beyond_m_s <= NO_SPIN_M_S {
        return [0.0; 2];
    }
    if speed_m_s > 0.0 { path_m_s.map(|v| v / speed_m_s * beyond_m_s) } else { [beyond_m_s, 0.0] }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE_M: [f64; 2] = [0.5, 2.0];

    fn wheel(velocity_m_s: [f64; 2], slip_m_s: f64) -> ContactSample {
        ContactSample::new([0.2, 0.3], 200.0).sliding(velocity_m_s).rolling(0.3).slipping(slip_m_s)
    }

    #[test]
    fn what_rolls_or_slides_is_told_as_it_is() {
        let mut spin = Spin::default();
        for (velocity, slip) in [([1.0, 0.0], 0.0), ([3.0, 4.0], 5.0), ([0.0, 0.0], 0.001), ([1.0, 1.0], 0.3)]
        {
            let sample = wheel(velocity, slip);
            assert_eq!(spin.under(0.1, SIZE_M, sample), sample);
        }
        let stroke = ContactSample::new([0.2, 0.3], 1.0);
        assert_eq!(spin.under(0.2, SIZE_M, stroke), stroke);
    }

    #[test]
    fn the_ground_runs_under_a_spinning_wheel_as_it_slips() {
        let mut spin = Spin::default();
        for n in 0..60 {
            let t = f64::from(n) / 60.0;
            let place = spin.under(t, SIZE_M, wheel([0.0, 0.0], 13.0));
            assert_eq!(place.velocity_m_s, Some([13.0, 0.0]));
            assert!((place.uv[0] - (0.2 + 13.0 * t / 0.5)).abs() < 1e-9 && place.uv[1] == 0.3);
        }
        // Where it came to it stays, and a hitch is no spin of minutes.
        let (then, stops) = (59.0 / 60.0, wheel([0.0, 0.0], 0.0));
        let place = spin.under(then + 60.0, SIZE_M, stops);
        assert!((place.uv[0] - (0.2 + 13.0 * (then + LONGEST_S) / 0.5)).abs() < 1e-9);
        assert_eq!(spin.under(then + 61.0, SIZE_M, stops).uv, place.uv);
    }

    #[test]
    fn a_wheel_that_slips_on_its_way_runs_in_its_direction() {
        let place = Spin::default().under(0.0, SIZE_M, wheel([0.0, -1.0], 13.0));
        assert_eq!(place.velocity_m_s, Some([0.0, -13.0]));
    }

    #[test]
    fn a_place_that_moves_without_a_velocity_is_left_alone() {
        let mut spin = Spin::default();
        let mut sample = wheel([0.0; 2], 5.0);
        sample.velocity_m_s = None;
        assert_eq!(spin.under(0.0, SIZE_M, sample), sample);
        sample.uv = [0.3, 0.3];
        assert_eq!(spin.under(0.1, SIZE_M, sample), sample);
        // One that stays has none.
        assert_eq!(spin.under(0.2, SIZE_M, sample).velocity_m_s, Some([5.0, 0.0]));
    }
}
