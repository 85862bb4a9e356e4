//! Choice of integrator: the wanted one while it is safe, sub-stepped or replaced where it is not.
//!
//! The rule looks at ω_c·h, the phase (radians) that the pressed pad turns through in one sample.
//! Semi-implicit Euler stays linearly stable to 2 but gains energy far below that: an undamped
//! bounce returns up to 1.022 of its speed at 0.5 and 1.25 at 1.5. So it runs plain to 0.5, in
//! sub-steps to 1.5, and beyond that the energy-conserving scheme runs in its place. The exact
//! scheme locates its events; it is replaced above a contact stiffness of 5e6 N/m, or above ω_c·h =
//! 5, where its contact maps would need so many sub-steps that it is no longer worth its price.

use super::Probe;
use core::fmt;

/// Largest ω_c·h of a semi-implicit Euler step.
pub const EULER_MAX_PHASE: f64 = 0.5;
/// Largest ω_c·h that is sub-stepped; above it the energy-conserving scheme runs.
pub const SUBSTEP_MAX_PHASE: f64 = 1.5;
/// Largest ω_c·h of the exact scheme.
pub const EXACT_MAX_PHASE: f64 = 5.0;
/// Largest contact stiffness of the exact scheme, N/m.
pub const EXACT_MAX_STIFFNESS_N_M: f64 = 5e6;
/// Most sub-steps a sample.
const MAX_SUBSTEPS: usize = 16;

/// Integrators of the equations of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Integrator {
    /// The paper's scheme with the damper centred in time: 4× less error at the same cost.
    SemiImplicitEuler,
    /// The paper's scheme read literally: the damper sees the old velocities.
    #[cfg_attr(feature = "serde", serde(rename = "semi-implicit-euler-explicit"))]
    SemiImplicitEulerExplicitDamper,
    /// Exact maps of both regimes, located events, cubic profile; one sample of latency.
    #[default]
    ExactEvent,
    /// Exact free flow and a discrete-gradient contact: never gains energy, however stiff.
    EnergyConserving,
}

impl Integrator {
    /// Every integrator.
    pub const ALL: [Self; 4] = [
        Self::SemiImplicitEuler,
        Self::SemiImplicitEulerExplicitDamper,
        Self::ExactEvent,
        Self::EnergyConserving,
    ];

    /// The name used on the command line and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::SemiImplicitEuler => "semi-implicit-euler",
            Self::SemiImplicitEulerExplicitDamper => "semi-implicit-euler-explicit",
            Self::ExactEvent => "exact-event",
            Self::EnergyConserving => "energy-conserving",
        }
    }

    /// The integrator of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|i| i.name() == name)
    }
}

/// Decision of the builder and its reason; prints as one sentence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// Integrator that was asked for.
    pub wanted: Integrator,
    /// Integrator that runs.
    pub used: Integrator,
    /// Steps a sample.
    pub substeps: usize,
    /// ω_c·h at the sample rate, radians.
    pub phase: f64,
    /// k_m, N/m.
    pub contact_stiffness_n_m: f64,
}

impl Choice {
    /// The wanted integrator runs, in one step a sample.
    #[must_use]
    pub fn is_as_asked(&self) -> bool {
        self.used == self.wanted && self.substeps == 1
    }

    pub(super) fn new(probe: &Probe, wanted: Integrator, step_s: f64) -> Self {
        let phase = probe.contact_rate_per_s() * step_s;
        let stiffness = probe.contact_stiffness_n_m;
        let (used, substeps) = match wanted {
            Integrator::SemiImplicitEuler => euler(wanted, phase, phase / EULER_MAX_PHASE),
            Integrator::SemiImplicitEulerExplicitDamper => {
                // Stable while phase² + 2hμb < 4 (μ: both masses); half of that is left for safety.
                let friction =
                    step_s * probe.pad_damping_n_s_m * (1.0 / probe.pad_mass_kg + 1.0 / probe.finger_mass_kg);
                euler(wanted, phase, (phase / EULER_MAX_PHASE).max(2.0 * friction / 1.75))
            }
            Integrator::ExactEvent if phase > EXACT_MAX_PHASE || stiffness > EXACT_MAX_STIFFNESS_N_M => {
                (Integrator::EnergyConserving, 1)
            }
            Integrator::ExactEvent | Integrator::EnergyConserving => (wanted, 1),
        };
        Self { wanted, used, substeps, phase, contact_stiffness_n_m: stiffness }
    }
}

/// Sub-steps an Euler scheme `steps` times (rounded up) or gives way to the energy-conserving one.
fn euler(wanted: Integrator, phase: f64, steps: f64) -> (Integrator, usize) {
    let steps = libm::ceil(steps).max(1.0);
    if phase > SUBSTEP_MAX_PHASE || steps > MAX_SUBSTEPS as f64 {
        (Integrator::EnergyConserving, 1)
    } else {
        (wanted, steps as usize)
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { wanted, used, substeps, phase, contact_stiffness_n_m } = *self;
        let (wanted_name, used_name) = (wanted.name(), used.name());
        if used != wanted {
            write!(
                f,
                "{used_name} instead of {wanted_name}, which is not safe for a contact of \
                 {contact_stiffness_n_m:.3e} N/m (omega_c*h = {phase:.2}) at this rate"
            )
        } else if substeps > 1 {
            write!(f, "{used_name} in {substeps} sub-steps a sample (omega_c*h = {phase:.2})")
        } else {
            write!(f, "{used_name} as asked (omega_c*h = {phase:.2})")
        }
    }
}
