//! Response of a probe: the recorded quantity over the height that its contact point follows.
//!
//! ```text
//! k = k₁ Fⁿ,   Z = k_g + b s,   Z' = Z − Z²/(M s² + Z),   D = m s² + Z' + k,   s = 2πi f
//! displacement  x/h = k/D       acceleration  a/h = s² k/D       contact force  F_c/h = k (m s² + Z')/D
//! ```
//! The pad on its pressed contact spring, the grip behind it, the hand at its end: the engine's
//! contact while it stays down. An acceleration of a finger goes on through its skin and tissue
//! ([`asperity_dsp::actuator::Skin`]). Sound is the contact force through the body's own response,
//! under the tip of its own that a tool has for it.

use asperity_dsp::actuator::{Skin, SkinState};
use asperity_dsp::micro_contact::Probe;
use asperity_dsp::mode::Mode;
use asperity_fft::PowerSpectra;
use asperity_fft::num_complex::Complex;
use std::f64::consts::PI;

/// Recorded quantity.
#[derive(Debug, Clone, PartialEq)]
pub enum Quantity {
    /// Acceleration of the probe's tip end, m/s².
    Acceleration,
    /// Its displacement, m.
    Displacement,
    /// Sound of the body, whose response to an impulse of 1 N·s is known.
    Sound(Ring),
}

/// Ring of a body: its modes, whose amplitudes answer an impulse of 1 N·s.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ring(pub Vec<Mode>);

impl Ring {
    /// Response to a force at a frequency.
    #[must_use]
    pub fn response(&self, frequency_hz: f64) -> Complex<f64> {
        let s = Complex::new(0.0, 2.0 * PI * frequency_hz);
        let each = |mode: &Mode| {
            let (w, d) = (2.0 * PI * mode.frequency_hz, mode.decay_per_s);
            let (sin, cos) = mode.phase_rad.sin_cos();
            mode.amplitude * ((s + d) * sin + w * cos) / ((s + d) * (s + d) + w * w)
        };
        self.0.iter().map(each).sum()
    }
}

/// A probe and what is recorded of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Tool {
    /// Constants of the probe.
    pub probe: Probe,
    /// Recorded quantity.
    pub quantity: Quantity,
}

impl Tool {
    /// Probe that the recording is of: for sound the tip of its own, where it has one, on hard
    /// ground.
    pub(crate) fn sounding(&self) -> Probe {
        match (&self.quantity, &self.probe.tip) {
            (Quantity::Sound(_), Some(tip)) => self.probe.heard(tip),
            _ => self.probe,
        }
    }

    /// Recorded quantity and contact force over felt height at a frequency under a force.
    fn responses(&self, frequency_hz: f64, force_n: f64) -> [Complex<f64>; 2] {
        let probe = &self.sounding();
        let s = Complex::new(0.0, 2.0 * PI * frequency_hz.max(1e-6));
        let k = probe.contact_stiffness_n_m * force_n.max(1e-3).powf(probe.force_exponent);
        let grip = probe.pad_stiffness_n_m + probe.pad_damping_n_s_m * s;
        let grip = grip - grip * grip / (probe.finger_mass_kg * s * s + grip);
        let without = probe.pad_mass_kg * s * s + grip;
        let whole = without + k;
        let force = k * without / whole;
        let recorded = match &self.quantity {
            Quantity::Displacement => k / whole,
            Quantity::Acceleration => s * s * k / whole,
            Quantity::Sound(ring) => force * ring.response(frequency_hz),
        };
        [recorded, force]
    }

    /// Power of the recorded quantity over that of the felt height, at bins `bin_hz` apart.
    #[must_use]
    pub fn power(
        &self,
        bins: usize,
        bin_hz: f64,
        (speed_m_s, force_n): (f64, f64),
        rate_hz: f64,
    ) -> Vec<f64> {
        let mut power: Vec<f64> =
            (0..bins).map(|i| self.responses(i as f64 * bin_hz, force_n)[0].norm_sqr()).collect();
        if self.probe.ridge_m > 0.0 && self.quantity == Quantity::Acceleration {
            let skin = Skin::new(self.probe.ridge_m, speed_m_s, force_n, rate_hz);
            let mut state = SkinState::default();
            let answer = (0..2 * bins).map(|n| state.tick(&skin, if n == 0 { 1.0 } else { 0.0 }));
            let through = PowerSpectra::new(vec![1.0; 2 * bins], 2 * bins).of(answer);
            power.iter_mut().zip(through).for_each(|(power, bin)| *power *= bin);
        }
        power
    }

    /// Power of the recorded quantity over that of the felt height at one frequency, without skin.
    #[must_use]
    pub fn power_at(&self, frequency_hz: f64, force_n: f64) -> f64 {
        self.responses(frequency_hz, force_n)[0].norm_sqr()
    }

    /// Felt height over the recorded quantity, for whole strokes; skin is left in.
    #[must_use]
    pub fn inverse(&self, frequency_hz: f64, force_n: f64) -> Complex<f64> {
        self.responses(frequency_hz, force_n)[0].inv()
    }

    /// Power of the contact force over that of the felt height.
    #[must_use]
    pub fn force_power(&self, frequency_hz: f64, force_n: f64) -> f64 {
        self.responses(frequency_hz, force_n)[1].norm_sqr()
    }

    /// Error, dB, that constants each wrong by `share`, independently, bring at a frequency.
    #[must_use]
    pub fn uncertainty_db(&self, frequency_hz: f64, force_n: f64, share: f64) -> f64 {
        let level = |tool: &Self| crate::db(tool.responses(frequency_hz, force_n)[0].norm_sqr());
        let own = level(self);
        let mut sum = 0.0;
        for constant in 0..4 {
            let mut other = self.clone();
            let probe = &mut other.probe;
            *[
                &mut probe.contact_stiffness_n_m,
                &mut probe.pad_mass_kg,
                &mut probe.pad_damping_n_s_m,
                &mut probe.pad_stiffness_n_m,
            ][constant] *= 1.0 + share;
            sum += (level(&other) - own).powi(2);
        }
        sum.sqrt()
    }
}
