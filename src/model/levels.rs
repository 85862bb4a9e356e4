//! Levels of a scene: what full scale stands for, the gains of the buses, and the reference motions
//! that find them.

/// Levels that were resolved: one number a channel, bus or body, from the file or the policy.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Levels {
    /// m or m/s² at sample value 1.0 of each actuator.
    pub full_scale: Vec<f64>,
    /// n of a finger's displacement ∝ (F / 1 N)ⁿ of each actuator.
    pub felt_force_exponent: Vec<f64>,
    /// Linear gain of each bus.
    pub gain: Vec<f64>,
    /// Linear gain of impacts beside strokes, of each body.
    pub strike_gain: Vec<f64>,
}

/// Speed of the reference stroke, m/s.
pub const REFERENCE_SPEED_M_S: f64 = 0.1;
/// Pressing force of the reference stroke, N.
pub const REFERENCE_FORCE_N: f64 = 1.0;
/// Rms of a haptic channel under the reference stroke, full scale 1: −26 dB.
pub const HAPTIC_REFERENCE: f64 = 0.050_118_723_362_727_22;
/// Rms of an audio bus under the reference stroke, full scale 1: −32 dB.
pub const AUDIO_REFERENCE: f64 = 0.025_118_864_315_095_8;
/// Peak of a reference strike, full scale 1: −12 dB.
pub const STRIKE_REFERENCE: f64 = 0.251_188_643_150_958;
/// A reference strike, loss-free, with a ball of steel.
pub(crate) struct Strike {
    pub(crate) speed_m_s: f64,
    pub(crate) mass_kg: f64,
    pub(crate) radius_m: f64,
}

/// The reference strike of bodies.
pub(crate) const STRIKE: Strike = Strike { speed_m_s: 0.5, mass_kg: 0.01, radius_m: 0.005 };

/// Length of each stroke, s, and the time from which on it is measured.
pub(crate) const STROKE_S: f64 = 0.35;
pub(crate) const SETTLED_S: f64 = 0.1;
/// Strikes of a burst, and between two of them, s.
pub(crate) const BURST: (u32, f64) = (50, 0.02);
/// Between two strokes, s.
pub(crate) const PAUSE_S: f64 = 0.1;
/// Threshold of silence: rms in m, m/s² or the modes' own units.
pub(crate) const SILENT: f64 = 1e-10;
/// Beginning of a stroke, uv.
pub(crate) const FROM: [f64; 2] = [0.31, 0.37];
/// Directions of strokes, unit vectors of u and v: along threads and across them, and between.
pub(crate) const WAYS: [[f64; 2]; 4] = [[1.0, 0.0], [0.6, -0.8], [0.0, 1.0], [0.8, 0.6]];
/// The least power that one of them counts with, over the strongest: along its ribs a file is
/// silent.
pub(crate) const LEAST_POWER: f64 = 1.0 / 16.0;

/// Power of the mean level, in decibels, of strokes in all directions; none where all are silent.
pub(crate) fn mean_power(powers: &[f64]) -> Option<f64> {
    let least = LEAST_POWER * powers.iter().copied().fold(0.0, f64::max);
    let logs = powers.iter().map(|power| libm::log(power.max(least))).sum::<f64>();
    (least > 0.0).then(|| libm::exp(logs / powers.len() as f64))
}
