//! Regularised inverse of a device: what is felt is what was asked for, within the device's band.
//!
//! ```text
//! E(s) = (s² + ω₀/Q s + ω₀²) / (s² + √2 ω_h s + ω_h²) · s² / (s² + √2 ω_l s + ω_l²) · constant   displacement
//! E(s) = (s² + ω₀/Q s + ω₀²) / (s² + √2 ω_l s + ω_l²) · ω_h² / (s² + √2 ω_h s + ω_h²) · constant  acceleration
//! ```
//! The zeros are the device's poles; what they cannot invert (a mass above resonance for
//! displacement, a spring below it for acceleration) is left to two Butterworth pairs a factor
//! [`EDGE`] outside the band, so the boost ends there. Minimum phase: stable by construction, no
//! latency but the edges' own group delay. The gain is 1 at f₀: a sine of full scale at resonance
//! drives fully, wherever the rest of the band needs more. Both fractions are mixes of the three
//! outputs of a state-variable filter, in `f64`.

use super::{DeviceProfile, Quantity};
use crate::DesignError;
use crate::butterworth::{Butterworth, Output, State};
use core::f64::consts::PI;

/// Distance of the band's edges to the corners: at the edge 0.8 dB are lost.
pub const EDGE: f64 = 1.5;

/// Corners are kept below this share of the sample rate.
const HIGHEST_CORNER: f64 = 0.45;

/// Coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equaliser {
    inverse: Butterworth,
    /// Gains of the low, band and high outputs of `inverse`.
    mix: [f64; 3],
    edge: Butterworth,
    edge_is_highpass: bool,
    group_delay_s: f64,
}

/// Memory.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EqualiserState {
    inverse: State,
    edge: State,
}

impl Equaliser {
    /// The inverse of `profile` for signals of `quantity`.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn new(
        profile: &DeviceProfile,
        quantity: Quantity,
        sample_rate_hz: f64,
    ) -> Result<Self, DesignError> {
        profile.check(sample_rate_hz)?;
        let low = profile.band_hz[0] / EDGE;
        let high = (profile.band_hz[1] * EDGE).min(HIGHEST_CORNER * sample_rate_hz);
        let (inverse_hz, edge_hz) = match quantity {
            Quantity::Displacement | Quantity::Tangential => (high, low),
            Quantity::Acceleration | Quantity::Force => (low, high),
        };
        let inverse = Butterworth::new(inverse_hz, sample_rate_hz)?;
        let edge = Butterworth::new(edge_hz, sample_rate_hz)?;
        // Prewarped, as the filter's own corner is: the notch stays on f₀ at every rate.
        let warped = |f: f64| libm::tan(PI * f / sample_rate_hz);
        let ratio = warped(profile.resonance_hz) / warped(inverse_hz);
        let mix = [ratio * ratio, ratio / profile.quality, 1.0];
        let mut out = Self {
            inverse,
            mix,
            edge,
            edge_is_highpass: quantity == Quantity::Displacement,
            group_delay_s: 0.0,
        };
        let at_resonance = out.gain_at(profile.resonance_hz, inverse_hz, edge_hz, sample_rate_hz);
        out.mix = mix.map(|g| g / at_resonance);
        out.group_delay_s = match quantity {
            Quantity::Displacement | Quantity::Tangential => inverse.group_delay_s(),
            Quantity::Acceleration | Quantity::Force => edge.group_delay_s(),
        };
        Ok(out)
    }

    /// Delay of the upper edge's corner pair, s: what remains when the device has undone the
    /// inverse.
    #[must_use]
    pub fn group_delay_s(&self) -> f64 {
        self.group_delay_s
    }

    /// |E| at `f` for the present mix.
    fn gain_at(&self, f: f64, inverse_hz: f64, edge_hz: f64, rate_hz: f64) -> f64 {
        let warped = |f: f64| libm::tan(PI * f / rate_hz);
        let x = warped(f) / warped(inverse_hz);
        let e = warped(f) / warped(edge_hz);
        let [low, band, high] = self.mix;
        let numerator = libm::hypot(low - high * x * x, band * x);
        let pair = |x: f64| libm::sqrt(1.0 + x * x * x * x);
        let edge = if self.edge_is_highpass { e * e / pair(e) } else { 1.0 / pair(e) };
        numerator / pair(x) * edge
    }
}

impl EqualiserState {
    /// Wanted quantity over full scale → drive.
    #[inline]
    pub fn tick(&mut self, design: &Equaliser, wanted: f64) -> f64 {
        let Output { low, band, high } = self.inverse.tick(&design.inverse, wanted);
        let [a, b, c] = design.mix;
        let out = self.edge.tick(&design.edge, a * low + b * band + c * high);
        if design.edge_is_highpass { out.high } else { out.low }
    }
}
