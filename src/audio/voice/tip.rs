//! Tip: a tool's second contact, by which it is heard (`dsp::micro_contact::Tip`).
//!
//! Heights as the tip's asperities ride them in, the contact force that the body gets out; the pad
//! that is felt runs beside it, untouched. Its force holds the pulses of its strokes already, so no
//! bead strikes beside it. Price: a stylus costs up to twice a fingertip, most of it for the second
//! ride over the micro-relief. Gain: a pen is heard 14 dB above a finger (R 0.5), where one spring
//! for both senses had it 29 dB below.

use super::between::Between;
use super::pad::Pad;
use super::profile::TipProfile;
use super::{PadSample, PathPoint};
use crate::audio::seat::Seat;
use crate::audio::shared::Shared;
use crate::link::stats::Counts;
use crate::resource::probe::PreparedProbe;
use crate::resource::stiffness::Ground;
use asperity_dsp::micro_contact::QuarticCorrection;

/// The tip of one contact; unused where the probe has none.
pub(super) struct Tip {
    pad: Pad,
    pub(super) between: Between,
    /// True until its first sample, where it appears on its ground.
    appears: bool,
}

impl Tip {
    /// Allocates the model.
    pub(super) fn idle(probe: &PreparedProbe) -> Self {
        Self { pad: Pad::idle(probe), between: Between::default(), appears: false }
    }

    /// Another contact begins.
    pub(super) fn begin(&mut self, tip: &PreparedProbe, ground: Ground, force_n: f64) {
        (self.between, self.appears) = (Between::default(), true);
        self.pad.begin(tip, ground, force_n);
    }

    /// Comes down and touches `later` samples after the stretch that follows begins.
    pub(super) fn land(&mut self, height_m: f64, force_n: f64, closing_m_s: f64, later: f64) {
        self.appears = false;
        self.pad.land(height_m, force_n, closing_m_s, later);
    }

    /// Becomes as stiff as ground and force make it, and decides what of the ground is sampled
    /// between samples: at the steps of the absolute grid.
    pub(super) fn take_slow_step(
        &mut self,
        shared: &Shared,
        seat: &mut Seat,
        tip: &PreparedProbe,
        at: &PathPoint,
        leaves: bool,
    ) {
        let Some(slot) = seat.current() else { return };
        self.pad.stiffen(tip, slot.stroking.ground, at.normal_force_n);
        if leaves {
            return self.between.leave();
        }
        self.between.decide(shared, seat, tip, self.pad.probe(), at);
    }

    /// Heights and forces become rows.
    pub(super) fn run(
        &mut self,
        (shared, tip): (&Shared, &PreparedProbe),
        profile: &TipProfile,
        forces_n: &[f64],
        quartic_correction: &mut [[QuarticCorrection; 2]],
        rows: &mut [PadSample],
        counts: &mut Counts,
    ) {
        let heights_m = &profile.height_m[..rows.len()];
        if std::mem::take(&mut self.appears) {
            self.pad.appear(heights_m[0], forces_n[0]);
        }
        let ground = self.between.ground(shared, &profile.short, rows.len(), quartic_correction);
        self.pad.run(heights_m, forces_n, ground, rows);
        let mut own = Counts::default();
        self.pad.settle(tip.waits, rows, &mut own);
        counts.resets += own.resets;
    }

    /// Tests whether it rests where the last row says.
    pub(super) fn is_settled(&self, row: &PadSample) -> bool {
        self.pad.is_settled(row)
    }
}
