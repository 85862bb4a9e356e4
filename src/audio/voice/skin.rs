//! Skin between the pad and what a fingertip feels. A tool has none.
//!
//! An acceleration goes through ridge and tissue (`dsp::actuator::Skin`). A displacement stays the
//! pad's; where the channel asks for it, it grows with the area of contact, ∝ (F / 1 N)ⁿ
//! (`model::actuator::FELT_FORCE_EXPONENT`). Friction drags it sideways (`dsp::tangential`).

use super::PadSample;
use super::coupling::STILL_M_S2;
use crate::audio::smoothed::Ramp;
use crate::resource::probe::PreparedProbe;
use crate::resource::stiffness::within;
use asperity_dsp::actuator::{ContactOutput, Skin, SkinState};
use asperity_dsp::tangential::{MASS_KG, Tangential, TangentialState, friction_force_n};
use asperity_dsp::trajectory::PathPoint;
use asperity_surface::height_field::{MAX_BLOCK, SurfaceBlock};

/// Below this speed friction no longer jumps with the direction, m/s.
const SETTLING_M_S: f64 = 1e-3;

/// The skin of one contact; nothing where the pad's own motion is played.
#[derive(Default)]
pub(super) struct ContactSkin {
    now: Option<(Skin, SkinState)>,
    /// Area that touches, over that at 1 N.
    growth: Option<Ramp>,
    last_m_s2: f64,
}

impl ContactSkin {
    /// Becomes as soft as speed and force make it: at the steps of the absolute grid.
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
            self.growth.get_or_insert_with(|| Ramp::at(grown)).aim(grown);
        } else {
            self.growth = None;
        }
        if ridge_m == 0.0 || !output.uses_skin_filter() {
            self.now = None;
            return;
        }
        let [u, v] = at.velocity_m_s;
        let skin = Skin::new(ridge_m, (u * u + v * v).sqrt(), at.normal_force_n, sample_rate_hz);
        let state = self.now.map_or_else(SkinState::default, |(_, state)| state);
        self.now = Some((skin, state));
    }

    /// Passes samples, `slow_step` of which lie between two calls of [`soften`](Self::soften).
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

/// The dragged skin of one contact.
pub(super) struct Drag {
    /// Law of the skin; none where none can be designed for the rate, and nothing is dragged then.
    design: Option<Tangential>,
    state: TangentialState,
    /// True until the first row: its force has been there for long.
    pub(super) begins: bool,
    rows: [PadSample; MAX_BLOCK],
}

impl Drag {
    pub(super) fn idle(sample_rate_hz: f64) -> Self {
        Self {
            design: Tangential::new(MASS_KG, 1.0, sample_rate_hz).ok(),
            state: TangentialState::default(),
            begins: true,
            rows: [PadSample::default(); MAX_BLOCK],
        }
    }

    /// Becomes as stiff as this force makes it: at the steps of the absolute grid.
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
