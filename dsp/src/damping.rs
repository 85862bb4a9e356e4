//! Material damping: the decay rate of a mode by its frequency.
//!
//! ```text
//! d(ω) = (α + η ω + β ω²) / 2          T60 = ln(1000) / d
//! ```
//! | symbol | field | loses |
//! |---|---|---|
//! | α | `alpha_per_s` | the same share a second at every frequency: supports, air |
//! | η | `eta` | the same share a cycle: the loss factor that handbooks measure |
//! | β | `beta_s` | a share a cycle that grows with frequency: viscosity |
//!
//! Source: α and β are Rayleigh's proportional damping; η, its structural (hysteretic) counterpart,
//! is ours beside them: over 52 fitted modes of a ceramic bowl a loss factor alone is within a
//! factor of 2 of 83 % of them, the best Rayleigh pair of 63 %.

use crate::limits::material as limits;
use crate::{DesignError, limits::Range};
use core::f64::consts::TAU;

/// Damping of a material.
///
/// ```
/// use asperity_dsp::damping::Damping;
///
/// // A loss factor of 0.001 at 1 kHz: 2.2 s for 60 dB.
/// let glass = Damping { alpha_per_s: 0.0, eta: 1e-3, beta_s: 0.0 };
/// assert!((glass.t60_s(1000.0) - 2.2).abs() < 0.01);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping {
    /// α, 1/s.
    pub alpha_per_s: f64,
    /// η, a loss factor.
    pub eta: f64,
    /// β, s.
    pub beta_s: f64,
}

impl Damping {
    /// Decay rate of the amplitude of a mode at `frequency_hz`, 1/s.
    #[must_use]
    pub fn decay_per_s(&self, frequency_hz: f64) -> f64 {
        let omega = TAU * frequency_hz;
        0.5 * (self.alpha_per_s + omega * (self.eta + omega * self.beta_s))
    }

    /// Time in which a mode at `frequency_hz` falls by 60 dB, s; infinite without damping.
    #[must_use]
    pub fn t60_s(&self, frequency_hz: f64) -> f64 {
        3.0 * core::f64::consts::LN_10 / self.decay_per_s(frequency_hz)
    }

    /// # Errors
    /// When a parameter is outside its range.
    pub fn checked(self) -> Result<Self, DesignError> {
        let check = |field, value, range: Range| range.check(field, value).map(|_| ());
        check("alpha_per_s", self.alpha_per_s, limits::ALPHA_PER_S)?;
        check("eta", self.eta, limits::ETA)?;
        check("beta_s", self.beta_s, limits::BETA_S)?;
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn a_loss_factor_takes_the_same_number_of_cycles_at_every_frequency() {
        let structural = Damping { alpha_per_s: 0.0, eta: 0.01, beta_s: 0.0 };
        // ln(1000) / (π η) cycles.
        for frequency_hz in [20.0, 440.0, 15e3] {
            assert!((structural.t60_s(frequency_hz) * frequency_hz - 219.88).abs() < 0.01);
        }
    }

    #[test]
    fn any_damping_takes_energy_and_never_less_at_a_higher_frequency() {
        let mut rng = Rng::new(9);
        for _ in 0..1000 {
            let mut up_to = |most: f64| most * rng.uniform();
            let damping = Damping { alpha_per_s: up_to(1e3), eta: up_to(1.0), beta_s: up_to(1e-3) };
            let (low_hz, higher_hz) = (up_to(1e4), up_to(1e4));
            let (low, high) = (damping.decay_per_s(low_hz), damping.decay_per_s(low_hz + higher_hz));
            assert!(damping.checked().is_ok() && low >= 0.0 && high >= low);
        }
        assert_eq!(Damping { alpha_per_s: 1.0, eta: -0.1, beta_s: 0.0 }.checked().unwrap_err().field, "eta");
    }

    #[test]
    fn the_decay_is_that_of_a_spring_with_a_complex_stiffness() {
        // numpy: imaginary part of sqrt(k (1 + i eta) / m) for k / m = (2 pi 1000)^2: 31.41553 (eta
        // 0.01), 62.82871 (eta 0.02).
        for (eta, decay_per_s) in [(0.01, 31.415_53), (0.02, 62.828_71)] {
            let d = Damping { alpha_per_s: 0.0, eta, beta_s: 0.0 }.decay_per_s(1000.0);
            assert!((d / decay_per_s - 1.0).abs() < 1e-3, "{d}");
        }
    }
}
