//! One vibration mode: a damped sinusoid (Hasti §III-D).

/// A mode of a body: its response to a unit impulse is
/// `amplitude · e^(−decay_per_s · t) · sin(2π · frequency_hz · t + phase_rad)`.
///
/// The paper's modes have `phase_rad` = 0; fitted ones do not.
///
/// ```
/// use asperity_dsp::mode::Mode;
///
/// let mode = Mode { frequency_hz: 440.0, decay_per_s: 6.908, amplitude: 1.0, phase_rad: 0.0 };
/// assert!((mode.t60_s() - 1.0).abs() < 1e-4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Mode {
    /// Frequency of the damped oscillation, Hz, above 0.
    pub frequency_hz: f64,
    /// Decay rate of the amplitude, 1/s, at or above 0; T60 = 6.908 / `decay_per_s`.
    pub decay_per_s: f64,
    /// Amplitude at t = 0 for an impulse of 1 N·s, in output units.
    pub amplitude: f64,
    /// Phase at t = 0, radians.
    #[cfg_attr(feature = "serde", serde(default))]
    pub phase_rad: f64,
}

impl Mode {
    /// Time for the mode to fall by 60 dB, seconds.
    ///
    /// ```
    /// use asperity_dsp::mode::Mode;
    ///
    /// let mode = Mode { frequency_hz: 440.0, decay_per_s: 6.908, amplitude: 0.1, phase_rad: 0.0 };
    /// assert!((mode.t60_s() - 1.0).abs() < 1e-3);
    /// ```
    #[must_use]
    pub fn t60_s(&self) -> f64 {
        3.0 * core::f64::consts::LN_10 / self.decay_per_s
    }
}
