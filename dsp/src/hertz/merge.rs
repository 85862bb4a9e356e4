//! Onsets that fall within a contact that is still going on.

use super::HertzPulse;

/// While the exciter touches, a further onset is no second impact: only what a harder one has more
/// than the hardest so far is added, as a pulse of its own shape. One a contact; chatter within a
/// contact time then sounds as its hardest hit, whatever its count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnsetMerge {
    /// Absolute end of the contact, in samples.
    end: f64,
    held_n_s: f64,
}

impl Default for OnsetMerge {
    fn default() -> Self {
        Self { end: f64::NEG_INFINITY, held_n_s: 0.0 }
    }
}

impl OnsetMerge {
    /// Pulse to deposit for `pulse`, which begins `onset_offset` of a step after `onset_sample`;
    /// `None` when it is part of the contact before.
    #[inline]
    pub fn merge_onset(
        &mut self,
        pulse: HertzPulse,
        onset_sample: u64,
        onset_offset: f64,
        sample_rate_hz: f64,
    ) -> Option<HertzPulse> {
        let onset = onset_sample as f64 + onset_offset;
        let end = onset + pulse.contact_time_s * sample_rate_hz;
        if onset >= self.end {
            *self = Self { end, held_n_s: pulse.impulse_n_s };
            return Some(pulse);
        }
        let excess = pulse.impulse_n_s - self.held_n_s;
        // A pulse that holds no finite number is no excess either.
        if !(excess > 0.0 && excess.is_finite()) {
            return None;
        }
        // It lasts as long as the harder one: a slow touch before it, which alone would last
        // longer, leaves nothing behind. So one that just grazes may be there or not, and all that
        // comes after sounds the same.
        *self = Self { end, held_n_s: pulse.impulse_n_s };
        Some(HertzPulse { impulse_n_s: excess, ..pulse })
    }
}
