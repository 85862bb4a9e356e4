//! Drag: friction drags the skin sideways (`dsp::tangential`), for actuators that play that.
//!
//! Rows and slopes in, rows out whose pad is where the skin has been dragged to along the motion.
//! The skin is as stiff as the reported force makes it, at the steps of the absolute sample grid.

use super::PadSample;
use asperity_dsp::tangential::{MASS_KG, Tangential, TangentialState, friction_force_n};
use asperity_dsp::trajectory::PathPoint;
use asperity_texture::height_field::{MAX_BLOCK, SurfaceBlock};

/// Below this speed friction no longer jumps with the direction, m/s: a resting finger is not
/// dragged.
const SETTLING_M_S: f64 = 1e-3;

/// The dragged skin of one contact.
pub(super) struct Drag {
    /// None where no skin can be designed for the rate: nothing is dragged there.
    design: Option<Tangential>,
    state: TangentialState,
    /// It has just begun: the first force has been there for long.
    begins: bool,
    rows: [PadSample; MAX_BLOCK],
}

impl Drag {
    /// State of an unused voice.
    pub(super) fn idle(sample_rate_hz: f64) -> Self {
        Self {
            design: Tangential::new(MASS_KG, 1.0, sample_rate_hz).ok(),
            state: TangentialState::default(),
            begins: true,
            rows: [PadSample::default(); MAX_BLOCK],
        }
    }

    /// Another contact begins.
    pub(super) fn begin(&mut self) {
        self.begins = true;
    }

    /// As stiff as this force makes it.
    pub(super) fn press(&mut self, force_n: f64) {
        self.design = self.design.map(|design| design.pressed_with(force_n));
    }

    /// The rows with the skin's place along the motion for the pad's; where it begins, if it does.
    pub(super) fn run(
        &mut self,
        points: &[PathPoint],
        surface: &SurfaceBlock,
        rows: &[PadSample],
    ) -> (&[PadSample], Option<f64>) {
        let Some(design) = &self.design else { return (&self.rows[..rows.len()], None) };
        let mut from_m = None;
        for (i, row) in rows.iter().enumerate() {
            let [u, v] = points[i].velocity_m_s;
            let speed_m_s = libm::hypot(u, v);
            let moves = (speed_m_s / SETTLING_M_S).min(1.0);
            let [slope_u, slope_v] = surface.gradient[i];
            let slope = (slope_u * u + slope_v * v) / speed_m_s.max(SETTLING_M_S);
            let force_n = moves * friction_force_n(row.contact_force_n, surface.friction[i], slope);
            if std::mem::take(&mut self.begins) {
                self.state = TangentialState::resting(design, force_n);
                from_m = Some(force_n / design.stiffness_n_m());
            }
            let skin_m = self.state.tick(design, force_n);
            self.rows[i] = PadSample { pad_m: skin_m, pad_velocity_m_s: self.state.velocity_m_s(), ..*row };
        }
        (&self.rows[..rows.len()], from_m)
    }
}
