//! Stroke excitation of a body: how long a micro-collision lasts, and which part of the force rings
//! it.

use crate::model::material::Material;
use crate::model::surface::{EXCITER_MATERIAL, EXCITER_RADIUS_M};
use crate::resource::stiffness::Ground;
use asperity_dsp::DesignError;
use asperity_dsp::butterworth::Butterworth;
use asperity_dsp::hertz::HertzContact;
use asperity_dsp::micro_contact::Probe;

/// A sliding contact excites a body only above this share of its lowest mode. Below it the modes
/// follow the force like springs: a rumble that neither the recording nor a real radiating body
/// has, and that would bury the ringing under the grating's own fundamental.
const FORCE_HIGH_PASS_SHARE: f64 = 0.5;
/// Bounds of that cutoff, Hz; the upper one keeps a body of high modes audible when it is scraped
/// slowly.
const FORCE_HIGH_PASS_HZ: (f64, f64) = (20.0, 500.0);
/// Cutoff of the high-pass of pulses, Hz. Collisions and grains only ever push, and a push that
/// lasts is no sound: without it a rough stroke holds a fifth of its energy below 40 Hz. A third
/// octave at 63 Hz loses 0.04 dB.
const PULSE_HIGH_PASS_HZ: f64 = 20.0;

/// Designed on the game thread whenever a surface or its body is set.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stroking {
    /// The exciter of a micro-collision against the body's material.
    pub(crate) hertz: HertzContact,
    /// Ground that a probe presses on.
    pub(crate) ground: Ground,
    /// Keeps the part of the contact force that the body answers.
    pub(crate) force_high_pass: Butterworth,
    /// Takes the mean push from pulses that follow each other.
    pub(crate) pulse_high_pass: Butterworth,
}

impl Stroking {
    /// For a body of `material` whose lowest mode is at `lowest_mode_hz` (∞: no mode).
    pub(crate) fn new(
        material: Material,
        lowest_mode_hz: f64,
        pad_mass_kg: f64,
        sample_rate_hz: f64,
    ) -> Result<Self, DesignError> {
        let (low, high) = FORCE_HIGH_PASS_HZ;
        let cutoff_hz = (FORCE_HIGH_PASS_SHARE * lowest_mode_hz).clamp(low, high);
        let (exciter, body) = (EXCITER_MATERIAL.elastic(), material.elastic());
        Ok(Self {
            hertz: HertzContact::new(&exciter, &body, EXCITER_RADIUS_M, pad_mass_kg)?,
            ground: Ground::of(material),
            force_high_pass: Butterworth::new(cutoff_hz, sample_rate_hz)?,
            pulse_high_pass: Butterworth::new(PULSE_HIGH_PASS_HZ, sample_rate_hz)?,
        })
    }
}

/// Rebound over closing speed of the pad as a damped oscillator on the contact spring:
/// e^(−πζ/√(1−ζ²)).
pub(crate) fn restitution(probe: &Probe) -> f64 {
    let critical = 2.0 * (probe.contact_stiffness_n_m * probe.pad_mass_kg).sqrt();
    let damping = (probe.pad_damping_n_s_m / critical).min(0.999);
    libm::exp(-std::f64::consts::PI * damping / (1.0 - damping * damping).sqrt())
}
