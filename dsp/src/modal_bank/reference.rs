//! The paper's two-pole filter in `f64` direct form: what the fast bank is measured against.

use super::design::{GroupOptions, Pole};
use crate::DesignError;
use crate::mode::Mode;

/// Coefficients of one mode: H(z) = (b₀ + b₁ z⁻¹ + b₂ z⁻²) / (1 − a₁ z⁻¹ − a₂ z⁻²).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReferenceMode {
    a1: f64,
    a2: f64,
    b0: f64,
    b1: f64,
    b2: f64,
}

/// Memory of one reference mode.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReferenceState {
    y1: f64,
    y2: f64,
    u1: f64,
    u2: f64,
}

impl ReferenceMode {
    /// Designs the mode; at or above Nyquist it is silent.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn new(mode: &Mode, sample_rate_hz: f64, options: &GroupOptions) -> Result<Self, DesignError> {
        let Some(pole) = Pole::new(mode, sample_rate_hz, options)? else {
            return Ok(Self::default());
        };
        let r = libm::exp(-pole.decay);
        let (b0, b1) = pole.numerator();
        let (a1, a2, direct) =
            (2.0 * r * libm::cos(pole.theta), -r * r, pole.direct_correction + pole.passed);
        // The direct term is a third tap of the numerator.
        Ok(Self { a1, a2, b0: b0 + direct, b1: b1 - direct * a1, b2: -direct * a2 })
    }

    /// Response to one sample's impulse, N·s.
    #[inline]
    pub fn tick(&self, state: &mut ReferenceState, impulse_n_s: f64) -> f64 {
        let y = self.a1 * state.y1
            + self.a2 * state.y2
            + self.b0 * impulse_n_s
            + self.b1 * state.u1
            + self.b2 * state.u2;
        *state = ReferenceState { y1: y, y2: state.y1, u1: impulse_n_s, u2: state.u1 };
        y
    }
}
