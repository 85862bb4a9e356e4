//! Rest: a contact of which nothing moves or sounds falls asleep, and costs nothing until something
//! stirs.

use super::shared::Stretch;
use super::{PadSample, Scratch, Voice};

impl Voice {
    /// A resting contact: nothing moves, so nothing is computed; the rows stay as they were.
    pub(super) fn rest(&self, n: usize, scratch: &mut Scratch) {
        scratch.points[..n].fill(self.path.last);
        scratch.rows[..n].fill(self.last_row);
        let out = &mut scratch.out;
        self.ac.rest(&mut out.haptic[..n]);
        out.impulse_n_s[..n].fill(0.0);
        out.excites = false;
        (out.collisions, out.shortened, out.resets, out.blows) = (0, 0, 0, 0);
    }

    /// Falls asleep where nothing of it moves or sounds any more; called at the ends of grid cells.
    pub(super) fn fall_asleep_when_still(&mut self, stretch: Stretch<'_>, scratch: &Scratch) {
        let Stretch { output, position, n, .. } = stretch;
        let row = PadSample { onset: None, ..scratch.rows[n - 1] };
        self.last_row = row;
        if self.asleep {
            return;
        }
        self.asleep = self.ac.feels_still(output, row.pad_m)
            && self.path.is_still()
            && self.skin.is_still()
            && self.pad.is_settled(&row)
            && self.reaction.grain_rate_per_s == 0.0
            && !self.reaction.stirs
            && !scratch.out.rub.rubs
            && self.exciters.are_still(scratch.out.impulse_n_s[n - 1], position + n as u64);
        if self.asleep {
            self.ac.settle(output);
            self.exciters.settle();
        }
    }
}
