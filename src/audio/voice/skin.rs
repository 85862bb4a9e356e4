//! Skin between the point that slides and what a fingertip feels.
//!
//! An acceleration goes through ridge and tissue (`dsp::actuator::Skin`). A displacement stays the
//! pad's; where the channel asks for it, it grows with the area of contact, ∝ (F / 1 N)ⁿ
//! (`model::actuator::FELT_FORCE_EXPONENT`). A tool has no skin, and neither happens.

use super::exciters::Loudness;
use crate::prepared::probe::PreparedProbe;
use crate::prepared::stiffness::within;
use asperity_dsp::actuator::{ContactOutput, Skin, SkinState};
use asperity_dsp::trajectory::PathPoint;

/// Acceleration that counts as still, m/s²: −120 dB of what a fingertip just feels.
const STILL_M_S2: f64 = 1e-6;

/// The skin of one contact; none for a tool, or where the pad's own motion is played.
#[derive(Default)]
pub(super) struct ContactSkin {
    now: Option<(Skin, SkinState)>,
    /// Area that touches, over that at 1 N.
    growth: Option<Loudness>,
    last_m_s2: f64,
}

impl ContactSkin {
    /// It becomes as soft as speed and force make it: called at the steps of the absolute sample
    /// grid.
    pub(super) fn soften(
        &mut self,
        probe: &PreparedProbe,
        output: &ContactOutput,
        at: &PathPoint,
        sample_rate_hz: f64,
    ) {
        let (ridge_m, exponent) = (probe.ridge_m(), output.felt_force_exponent());
        if ridge_m > 0.0 && exponent > 0.0 {
            let grown = libm::pow(within(at.normal_force_n), exponent);
            self.growth.get_or_insert_with(|| Loudness::of(grown)).set_out(grown);
        } else {
            self.growth = None;
        }
        if ridge_m == 0.0 || !output.minds_skin() {
            self.now = None;
            return;
        }
        let [u, v] = at.velocity_m_s;
        let skin = Skin::new(ridge_m, (u * u + v * v).sqrt(), at.normal_force_n, sample_rate_hz);
        let state = self.now.map_or_else(SkinState::default, |(_, state)| state);
        self.now = Some((skin, state));
    }

    /// Passes samples from one of the absolute grid on, `slow_step` of which lie between two calls
    /// of [`soften`](Self::soften).
    pub(super) fn pass(&mut self, position: u64, slow_step: u64, felt: &mut [f64]) {
        if let Some(growth) = &self.growth {
            growth.weigh(position, slow_step, felt);
        }
        let Some((skin, state)) = &mut self.now else { return };
        felt.iter_mut().for_each(|felt| *felt = state.tick(skin, *felt));
        self.last_m_s2 = felt.last().copied().unwrap_or(self.last_m_s2);
    }

    /// Tests whether it has come to rest.
    pub(super) fn is_still(&self) -> bool {
        self.now.is_none() || self.last_m_s2.abs() < STILL_M_S2
    }
}
