//! Skin between the point that slides and what a fingertip is shaken by: for acceleration channels.

use super::{Shared, Voice};
use asperity_dsp::actuator::{ContactOutput, Skin, SkinState};

impl Voice {
    /// The skin becomes as soft as speed and force make it, at the steps of the absolute sample grid.
    pub(super) fn soften(&mut self, shared: &Shared, output: &ContactOutput) {
        let ridge_m = shared.probe(self.role.probe).ridge_m();
        if ridge_m == 0.0 || !output.minds_skin() {
            self.skin = None;
            return;
        }
        let point = &self.last_point;
        let [u, v] = point.velocity_m_s;
        let skin = Skin::new(ridge_m, (u * u + v * v).sqrt(), point.normal_force_n, shared.sample_rate_hz);
        let state = self.skin.map_or_else(SkinState::default, |(_, state)| state);
        self.skin = Some((skin, state));
    }

    /// What it lets through.
    pub(super) fn feel_through_skin(&mut self, felt: &mut [f64]) {
        let Some((skin, state)) = &mut self.skin else { return };
        felt.iter_mut().for_each(|felt| *felt = state.tick(skin, *felt));
    }
}
