//! Fades of a contact that comes or goes, without a click.

use super::{Phase, Scratch, Shared, Voice};

/// Share of a fade's length that its turning takes.
const TURN: f64 = 0.2;

/// A fade that turns round: its phase (0 = silent, 1 = full) slows down, stops and comes back, so that
/// the gain has no corner.
pub(super) struct Rising {
    phase: f64,
    /// Per sample.
    speed: f64,
}

impl Rising {
    /// The next gain.
    fn tick(&mut self, fade_samples: u32) -> f64 {
        let top = 1.0 / f64::from(fade_samples);
        self.speed = (self.speed + 2.0 * top * top / TURN).min(top);
        self.phase = (self.phase + self.speed).clamp(0.0, 1.0);
        0.5 - 0.5 * (std::f64::consts::PI * self.phase).cos()
    }
}

impl Voice {
    /// Starts to fade, if it has not yet, pressed as it is now: the smoothed force still falls after a
    /// lift-off, and the pad it sets free would be felt as a thump louder than the stroke.
    pub(crate) fn fade(&mut self, shared: &Shared) {
        if self.phase == Phase::Sounding {
            self.trajectory.hold_force(self.last_point.normal_force_n);
            self.phase = Phase::Fading { left: shared.fade_samples() };
        }
    }

    /// Comes back out of its fade, from the level it has faded to and without a corner.
    pub(crate) fn resume(&mut self, shared: &Shared) {
        let step = 1.0 / f64::from(shared.fade_samples());
        let faded = matches!(self.phase, Phase::Fading { left } if left < shared.fade_samples());
        let phase = (1.0 - 2.0 * self.gain).clamp(-1.0, 1.0).acos() / std::f64::consts::PI;
        // Before the first faded sample nothing has happened yet.
        self.rising = faded.then_some(Rising { phase, speed: -step });
        if faded {
            self.fade_in_left = 0;
        }
        self.phase = Phase::Sounding;
        self.ended = false;
    }

    /// Raised cosines, without step or corner: in for a contact that was suddenly there (a landing has
    /// its own beginning), out for one that ended, lapsed or was stolen.
    pub(super) fn apply_fades(&mut self, shared: &Shared, n: usize, scratch: &mut Scratch) {
        if self.role.gain != 1.0 || !self.role_gain.settled_at(1.0) {
            (0..n).for_each(|i| scratch.out.scale(i, self.role_gain.tick(self.role.gain)));
        }
        if self.fade_in_left == 0 && self.rising.is_none() && self.phase == Phase::Sounding {
            self.gain = 1.0;
            return;
        }
        let (total, rise) = (shared.fade_samples(), &shared.fade);
        for i in 0..n {
            self.gain = 1.0;
            if self.fade_in_left > 0 {
                self.fade_in_left -= 1;
                self.gain *= rise[(total - self.fade_in_left) as usize];
            }
            if let Some(rising) = &mut self.rising {
                self.gain *= rising.tick(total);
                if rising.phase >= 1.0 {
                    self.rising = None;
                }
            }
            if let Phase::Fading { left } = self.phase {
                let left = left.saturating_sub(1);
                self.gain *= rise[left as usize];
                self.phase = Phase::Fading { left };
            }
            if self.gain != 1.0 {
                scratch.out.scale(i, self.gain);
            }
        }
        if self.phase == (Phase::Fading { left: 0 }) {
            self.phase = Phase::Free;
        }
    }
}
