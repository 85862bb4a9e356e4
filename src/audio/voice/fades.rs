//! Fades: raised cosines, in for a contact that was suddenly there (a landing has its own
//! beginning), out for one that ended, lapsed or was stolen.

use super::VoiceState;
use super::block::VoiceBlock;
use crate::audio::shared::Shared;
use crate::audio::smoothed::Smoothed;

/// Share of a fade's length that its turning takes.
const TURN: f64 = 0.2;

/// A fade that turns round: its phase (0 = silent, 1 = full) slows down, stops and comes back.
struct Rising {
    phase: f64,
    /// Per sample.
    speed: f64,
}

impl Rising {
    fn tick(&mut self, fade_samples: u32) -> f64 {
        let top = 1.0 / f64::from(fade_samples);
        self.speed = (self.speed + 2.0 * top * top / TURN).min(top);
        self.phase = (self.phase + self.speed).clamp(0.0, 1.0);
        0.5 - 0.5 * libm::cos(std::f64::consts::PI * self.phase)
    }
}

/// The gains of one contact over time.
pub(super) struct Fades {
    in_left: u32,
    /// Coming back out of a fade.
    rising: Option<Rising>,
    /// Gain of the last sample.
    gain: f64,
    /// On its way to the role's gain.
    role_gain: Smoothed,
}

impl Fades {
    pub(super) fn idle(sample_rate_hz: f64) -> Self {
        Self { in_left: 0, rising: None, gain: 0.0, role_gain: Smoothed::new(sample_rate_hz) }
    }

    /// Another contact begins.
    pub(super) fn begin(&mut self, role_gain: f64, lands: bool, shared: &Shared) {
        self.rising = None;
        self.role_gain.set(role_gain);
        self.in_left = if lands { 0 } else { shared.fade_samples() };
    }

    /// Comes back out of a fade that stands at `phase`, from the level it has faded to.
    pub(super) fn resume(&mut self, phase: VoiceState, shared: &Shared) {
        let step = 1.0 / f64::from(shared.fade_samples());
        // Before the first faded sample nothing has happened yet.
        let faded = matches!(phase, VoiceState::Fading { left } if left < shared.fade_samples());
        let phase = libm::acos((1.0 - 2.0 * self.gain).clamp(-1.0, 1.0)) / std::f64::consts::PI;
        self.rising = faded.then_some(Rising { phase, speed: -step });
        if faded {
            self.in_left = 0;
        }
    }

    /// Fades `n` samples; the phase after them.
    pub(super) fn run(
        &mut self,
        mut phase: VoiceState,
        role_gain: f64,
        shared: &Shared,
        n: usize,
        out: &mut VoiceBlock,
    ) -> VoiceState {
        if role_gain != 1.0 || !self.role_gain.settled_at(1.0) {
            (0..n).for_each(|i| out.scale(i, self.role_gain.tick(role_gain)));
        }
        if self.in_left == 0 && self.rising.is_none() && phase == VoiceState::Sounding {
            self.gain = 1.0;
            return phase;
        }
        let (total, rise) = (shared.fade_samples(), &shared.fade);
        for i in 0..n {
            self.gain = 1.0;
            if self.in_left > 0 {
                self.in_left -= 1;
                self.gain *= rise[(total - self.in_left) as usize];
            }
            if let Some(rising) = &mut self.rising {
                self.gain *= rising.tick(total);
                if rising.phase >= 1.0 {
                    self.rising = None;
                }
            }
            if let VoiceState::Fading { left } = phase {
                let left = left.saturating_sub(1);
                self.gain *= rise[left as usize];
                phase = VoiceState::Fading { left };
            }
            if self.gain != 1.0 {
                out.scale(i, self.gain);
            }
        }
        if phase == (VoiceState::Fading { left: 0 }) { VoiceState::Free } else { phase }
    }
}
