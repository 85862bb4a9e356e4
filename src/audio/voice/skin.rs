//! Skin between the point that slides and what a fingertip is shaken by: for acceleration channels.

use crate::prepared::probe::PreparedProbe;
use asperity_dsp::actuator::{ContactOutput, Skin, SkinState};
use asperity_dsp::trajectory::PathPoint;

/// Acceleration that counts as still, m/s²: −120 dB of what a fingertip just feels.
const STILL_M_S2: f64 = 1e-6;

/// The skin of one contact; none for a tool, or where the pad's own motion is played.
#[derive(Default)]
pub(super) struct ContactSkin {
    now: Option<(Skin, SkinState)>,
    last_m_s2: f64,
}

impl ContactSkin {
    /// It becomes as soft as speed and force make it: called at the steps of the absolute sample grid.
    pub(super) fn soften(
        &mut self,
        probe: &PreparedProbe,
        output: &ContactOutput,
        at: &PathPoint,
        sample_rate_hz: f64,
    ) {
        let ridge_m = probe.ridge_m();
        if ridge_m == 0.0 || !output.minds_skin() {
            self.now = None;
            return;
        }
        let [u, v] = at.velocity_m_s;
        let skin = Skin::new(ridge_m, (u * u + v * v).sqrt(), at.normal_force_n, sample_rate_hz);
        let state = self.now.map_or_else(SkinState::default, |(_, state)| state);
        self.now = Some((skin, state));
    }

    /// What it lets through.
    pub(super) fn pass(&mut self, felt: &mut [f64]) {
        let Some((skin, state)) = &mut self.now else { return };
        felt.iter_mut().for_each(|felt| *felt = state.tick(skin, *felt));
        self.last_m_s2 = felt.last().copied().unwrap_or(self.last_m_s2);
    }

    /// Whether it has come to rest.
    pub(super) fn is_still(&self) -> bool {
        self.now.is_none() || self.last_m_s2.abs() < STILL_M_S2
    }
}
