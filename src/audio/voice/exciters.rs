//! Excitation of the touched body, by exciters of which a surface names those that sound (Hasti
//! §III-D).
//!
//! ```text
//! collisions, grains → Hertz pulses → ring → high-pass ┐
//! alternating contact force ──────────────────────────┴ × loudness → impulses, N·s, spread for the bank
//! friction ── speed and force along the motion → the body's own step (`resource::body_rub`)
//! ```
//! The force sounds by itself, because a pad that never lifts off would be silent (ours, not the
//! document's). Pulses push and never pull: a stroke of many would hold the body bent, which costs
//! head room; a high-pass takes the bend. Pulses and force meet sample by sample, not in the ring,
//! so that the order of additions depends on no split into blocks.

use super::block::{RubBlock, VoiceBlock};
use super::{PadSample, PathPoint};
use crate::audio::smoothed::Ramp;
use crate::model::excitation::Exciter;
use crate::resource::impulse_ring::ImpulseRing;
use crate::resource::probe::PreparedProbe;
use crate::resource::surface::SurfaceSlot;
use asperity_dsp::butterworth::State;
use asperity_dsp::hertz::{FORCE_HISTORY, HertzPulse, OnsetMerge, spread_force, spread_force_alone};
use asperity_dsp::micro_contact::Onset;
use asperity_dsp::rng::Rng;
use asperity_surface::height_field::{MAX_BLOCK, Reaction};

/// Longest contact of a micro-collision, s, at every rate: the bead against rubber lasts 2 ms,
/// against jelly 20.
const LONGEST_COLLISION_S: f64 = 0.04;
/// Impulse per sample below which a contact counts as silent, N·s: −120 dB of an ordinary stroke's.
const STILL_N_S: f64 = 1e-12;
/// Closing speed of two grains, m/s.
const GRAIN_M_S: f64 = 0.1;
/// Below this speed a motion has no direction, m/s.
const LEAST_SPEED_M_S: f64 = 1e-3;

/// Inputs of exciters during a stretch.
#[derive(Clone, Copy)]
pub(super) struct Excited<'a> {
    pub(super) slot: &'a SurfaceSlot,
    pub(super) probe: &'a PreparedProbe,
    pub(super) reaction: Reaction,
    pub(super) sample_rate_hz: f64,
    pub(super) slow_step: u64,
    pub(super) position: u64,
}

/// The exciters of one contact.
pub(super) struct Exciters {
    merge: OnsetMerge,
    grains: Rng,
    /// Pulses on their way to the body.
    pulses: ImpulseRing,
    /// Their mean of late; zero where it has died away.
    pulse_mean: State,
    /// Impulses of the last forces, which are still on their way.
    force_n_s: [f64; FORCE_HISTORY],
    loudness: Ramp,
    /// Line of the motion, a unit vector. It turns, but not round: a bow that goes back rubs along
    /// the same line with a negative speed.
    along: [f64; 2],
}

impl Exciters {
    /// Allocates the ring.
    pub(super) fn idle(sample_rate_hz: f64) -> Self {
        Self {
            merge: OnsetMerge::default(),
            grains: Rng::new(0),
            pulses: ImpulseRing::new(LONGEST_COLLISION_S, sample_rate_hz),
            pulse_mean: State::default(),
            force_n_s: [0.0; FORCE_HISTORY],
            loudness: Ramp::default(),
            along: [1.0, 0.0],
        }
    }

    /// Another contact begins.
    pub(super) fn begin(&mut self, seed: u64, position: u64, loudness: f64) {
        self.merge = OnsetMerge::default();
        self.grains = Rng::new(seed);
        self.loudness = Ramp::at(loudness);
        self.along = [1.0, 0.0];
        self.settle();
        if !self.pulses.is_empty(position) {
            self.pulses.clear();
        }
    }

    /// More of it sounds, or less, and it moves elsewhere: at the steps of the absolute grid.
    pub(super) fn press(&mut self, loudness: f64, [u, v]: [f64; 2]) {
        self.loudness.aim(loudness);
        let speed_m_s = libm::hypot(u, v);
        if speed_m_s > LEAST_SPEED_M_S {
            let back = self.along[0] * u + self.along[1] * v < 0.0;
            let length = if back { -speed_m_s } else { speed_m_s };
            self.along = [u / length, v / length];
        }
    }

    /// Rows and the alternating force in; impulses, and what is counted, out.
    pub(super) fn run(
        &mut self,
        by: &Excited<'_>,
        rows: &[PadSample],
        force_n_s: &mut [f64; FORCE_HISTORY + MAX_BLOCK],
        out: &mut VoiceBlock,
    ) {
        let (mut collisions, mut shortened) = (0, 0);
        let grains = by.reaction.grain_rate_per_s > 0.0;
        for (row, sample) in rows.iter().zip(by.position..) {
            if let Some(onset) = row.onset {
                collisions += 1;
                shortened += u64::from(self.strike(by, &onset, sample));
            }
            if grains {
                self.shift_grains(by, sample);
            }
        }
        (out.counts.collisions, out.counts.shortened, out.excites) = (collisions, shortened, true);
        let n = rows.len();
        let impulse_n_s = &mut out.impulse_n_s[..n];
        let beats = self.take_pulses(by, impulse_n_s);
        force_n_s[..FORCE_HISTORY].copy_from_slice(&self.force_n_s);
        let spread = if beats { spread_force } else { spread_force_alone };
        spread(&force_n_s[..FORCE_HISTORY + n], impulse_n_s);
        self.force_n_s.copy_from_slice(&force_n_s[n..n + FORCE_HISTORY]);
        self.loudness.weigh(by.position, by.slow_step, impulse_n_s);
    }

    /// Sends a collision's pulse on its way, where collisions sound; true where it is shortened.
    fn strike(&mut self, by: &Excited<'_>, onset: &Onset, row: u64) -> bool {
        if by.probe.tip.is_some() || !by.slot.surface.excitation.has(Exciter::Collisions) {
            return false;
        }
        // An onset is dated within the step that ends at its row, and a force is heard as if that
        // step's middle were the row: both are half a step late.
        let half = onset.offset + 0.5;
        let (sample, offset) = if half < 1.0 { (row.saturating_sub(1), half) } else { (row, half - 1.0) };
        let own_s = by.slot.stroking.hertz.contact_time_s(onset.closing_m_s);
        let contact_time_s = by.probe.contact_time_ratio * own_s;
        let impulse_n_s = by.probe.collision_mass_kg * onset.closing_m_s;
        let pulse = HertzPulse::elastic(impulse_n_s, contact_time_s.min(LONGEST_COLLISION_S));
        if let Some(pulse) = self.merge.merge_onset(pulse, sample, offset, by.sample_rate_hz) {
            self.pulses.deposit(&pulse, sample, offset, by.sample_rate_hz);
        }
        contact_time_s > LONGEST_COLLISION_S
    }

    /// Draws the grains that give way during one sample, a Poisson process.
    fn shift_grains(&mut self, by: &Excited<'_>, sample: u64) {
        let draw = self.grains.uniform();
        let expected = by.reaction.grain_rate_per_s / by.sample_rate_hz;
        if draw < expected {
            // The part of the draw below `expected` is uniform too: it says when within the sample.
            let own_s = by.slot.stroking.hertz.contact_time_s(GRAIN_M_S);
            let impulse_n_s = by.reaction.grain_impulse_n_s * (0.5 + draw / expected);
            let pulse = HertzPulse::elastic(impulse_n_s, own_s.min(LONGEST_COLLISION_S));
            self.pulses.deposit(&pulse, sample, draw / expected, by.sample_rate_hz);
        }
    }

    /// Takes the pulses of a stretch without their mean, N·s; false, and nothing written, where
    /// there are none.
    fn take_pulses(&mut self, by: &Excited<'_>, out: &mut [f64]) -> bool {
        // At the steps of the absolute grid, so that it depends on no split into blocks.
        if by.position.is_multiple_of(MAX_BLOCK as u64) && self.pulses_are_over(by.position) {
            self.pulse_mean = State::default();
        }
        if self.pulses.is_empty(by.position) && self.pulse_mean == State::default() {
            return false;
        }
        self.pulses.take_into(by.position, out);
        let (high_pass, mut mean) = (&by.slot.stroking.pulse_high_pass, self.pulse_mean);
        out.iter_mut().for_each(|y| *y = mean.tick(high_pass, *y).high);
        self.pulse_mean = mean;
        true
    }

    /// Rubbing of the body, where friction sounds: speeds along the line, and what presses.
    pub(super) fn rub(
        &self,
        slot: &SurfaceSlot,
        points: &[PathPoint],
        rows: &[PadSample],
        out: &mut RubBlock,
    ) {
        if !slot.surface.excitation.has(Exciter::Friction) {
            return;
        }
        (out.rubs, out.along) = (true, self.along);
        for (i, (point, row)) in points.iter().zip(rows).enumerate() {
            let [u, v] = point.velocity_m_s;
            out.sweep_m_s[i] = u * self.along[0] + v * self.along[1];
            out.normal_force_n[i] = row.contact_force_n.max(0.0);
        }
    }

    fn pulses_are_over(&self, end: u64) -> bool {
        self.pulses.is_empty(end) && self.pulse_mean.is_within(STILL_N_S)
    }

    /// Tests whether nothing sounds from `end` on, when this was the last impulse.
    pub(super) fn are_still(&self, last_n_s: f64, end: u64) -> bool {
        last_n_s.abs() < STILL_N_S && self.pulses_are_over(end)
    }

    /// Drops what is left of the forces of a contact that has come to rest.
    pub(super) fn settle(&mut self) {
        self.force_n_s = [0.0; FORCE_HISTORY];
        self.pulse_mean = State::default();
    }
}
