//! Excitation of the touched body: what a contact sends it, by exciters of which a surface names
//! those that sound (Hasti §III-D).
//!
//! ```text
//! collisions, grains → Hertz pulses → ring → high-pass ┐
//! alternating contact force ──────────────────────────┴ × loudness → impulses, N·s, spread for the bank
//! friction ── speed and force along the motion → the body's own step
//! ```
//! Pulses and force meet sample by sample, not in the ring, so that the order of additions depends
//! on no split into blocks.

mod collisions;
mod force;
mod friction;
mod grains;
mod loudness;
mod pulses;

pub(super) use force::ForceRun;
pub(super) use loudness::Loudness;

use super::PadSample;
use super::PathPoint;
use super::block::VoiceBlock;
use crate::model::excitation::Exciter;
use crate::prepared::probe::PreparedProbe;
use crate::prepared::surface::SurfaceSlot;
use asperity_texture::height_field::Reaction;
use collisions::Collisions;
use force::ContactForce;
use friction::Rubbing;
use grains::Grains;
use pulses::Pulses;

/// Longest contact of a micro-collision, s, at every rate: the bead against rubber lasts 2 ms,
/// against jelly 20.
const LONGEST_COLLISION_S: f64 = 0.04;
/// Impulse per sample below which a contact counts as silent, N·s: −120 dB of an ordinary stroke's.
const STILL_N_S: f64 = 1e-12;

/// Inputs of exciters during a stretch.
#[derive(Clone, Copy)]
pub(super) struct Excited<'a> {
    pub(super) slot: &'a SurfaceSlot,
    pub(super) probe: &'a PreparedProbe,
    pub(super) reaction: Reaction,
    pub(super) sample_rate_hz: f64,
    /// Steps in which loudness is worked out, samples.
    pub(super) slow_step: u64,
    /// Absolute index of the first sample.
    pub(super) position: u64,
}

/// The exciters of one contact.
pub(super) struct Exciters {
    collisions: Collisions,
    grains: Grains,
    force: ContactForce,
    rubbing: Rubbing,
    loudness: Loudness,
    pulses: Pulses,
}

impl Exciters {
    /// State of an unused voice. Allocates the ring.
    pub(super) fn idle(seed: u64, sample_rate_hz: f64) -> Self {
        Self {
            collisions: Collisions::default(),
            grains: Grains::new(seed),
            force: ContactForce::default(),
            rubbing: Rubbing::default(),
            loudness: Loudness::default(),
            pulses: Pulses::new(sample_rate_hz),
        }
    }

    /// Another contact begins, as loud as this.
    pub(super) fn begin(&mut self, seed: u64, position: u64, loudness: f64) {
        self.collisions = Collisions::default();
        self.grains = Grains::new(seed);
        self.force = ContactForce::default();
        self.rubbing = Rubbing::default();
        self.loudness = Loudness::of(loudness);
        self.pulses.begin(position);
    }

    /// More of it sounds, or less, and it moves elsewhere: called at the steps of the absolute
    /// sample grid.
    pub(super) fn press(&mut self, loudness: f64, velocity_m_s: [f64; 2]) {
        self.loudness.set_out(loudness);
        self.rubbing.turn(velocity_m_s);
    }

    /// Rubbing of the body, where friction sounds.
    pub(super) fn rub(
        &mut self,
        by: &Excited<'_>,
        points: &[PathPoint],
        rows: &[PadSample],
        out: &mut VoiceBlock,
    ) {
        if by.slot.surface.excitation.has(Exciter::Friction) {
            self.rubbing.run(points, rows, &mut out.rub);
        }
    }

    /// Rows and the alternating force in; impulses, and what was counted, out.
    pub(super) fn run(
        &mut self,
        by: &Excited<'_>,
        rows: &[PadSample],
        force: &mut ForceRun,
        out: &mut VoiceBlock,
    ) {
        let (mut collisions, mut shortened) = (0, 0);
        let grains = by.reaction.grain_rate_per_s > 0.0;
        for (row, sample) in rows.iter().zip(by.position..) {
            if let Some(onset) = row.onset {
                collisions += 1;
                shortened += u64::from(self.collisions.strike(by, &onset, sample, &mut self.pulses.ring));
            }
            if grains {
                self.grains.shift(by, sample, &mut self.pulses.ring);
            }
        }
        let impulse_n_s = &mut out.impulse_n_s[..rows.len()];
        let beats = self.pulses.take(&by.slot.stroking.pulse_high_pass, by.position, impulse_n_s);
        self.force.add(force, impulse_n_s, beats);
        self.loudness.weigh(by.position, by.slow_step, impulse_n_s);
        (out.collisions, out.shortened, out.excites) = (collisions, shortened, true);
    }

    /// Tests whether nothing sounds from `end` on, when this was the last impulse.
    pub(super) fn are_still(&self, last_n_s: f64, end: u64) -> bool {
        last_n_s.abs() < STILL_N_S && self.pulses.are_still(end)
    }

    /// Drops what is left of the forces of a contact that has come to rest.
    pub(super) fn settle(&mut self) {
        self.force = ContactForce::default();
        self.pulses.settle();
    }
}
