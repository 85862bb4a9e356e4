//! Levels of a scene: what full scale stands for, and the gains of the buses.

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
