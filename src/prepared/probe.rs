//! A probe, prepared for the audio half: its contact model, its mobility, and what its micro-collisions weigh.

use crate::prepared::stiffness::Ladder;
use crate::prepared::stroking::restitution;
use asperity_dsp::DesignError;
use asperity_dsp::micro_contact::{Integrator, MicroContact, Probe};
use asperity_dsp::mobility::Mobility;
use asperity_dsp::simd::Level;

/// Everything a contact of this probe needs.
#[derive(Debug, Clone)]
pub(crate) struct PreparedProbe {
    pub(crate) micro_contact: MicroContact,
    /// The same on contacts of any stiffness.
    pub(crate) ladder: Ladder,
    pub(crate) mobility: Mobility,
    /// Momentum of a micro-collision per closing speed, kg: pad mass × (1 + restitution).
    pub(crate) collision_mass_kg: f64,
    /// Contact time over that of the engine's own probe: (m / m₀)^(2/5).
    pub(crate) contact_time_ratio: f64,
    /// Whether its rows come one sample before those of the engine's integrator, and have to wait.
    pub(crate) waits: bool,
}

/// By how many samples the rows of every probe lag behind its inputs.
pub(crate) fn row_latency(integrator: Integrator) -> usize {
    usize::from(integrator == Integrator::ExactEvent)
}

impl PreparedProbe {
    /// Radius of the sphere that rides on surfaces, m.
    pub(crate) fn tip_radius_m(&self) -> f64 {
        self.micro_contact.probe().tip_radius_m
    }

    /// Width over which its skin averages, m; 0 where it has none.
    pub(crate) fn ridge_m(&self) -> f64 {
        self.micro_contact.probe().ridge_m
    }

    /// At the engine's inner rate; `own` is the engine's own probe.
    pub(crate) fn new(
        probe: &Probe,
        own: &Probe,
        integrator: Integrator,
        sample_rate_hz: f64,
        kernel: Level,
    ) -> Result<Self, DesignError> {
        let micro_contact = MicroContact::new(probe, integrator, sample_rate_hz)?.on(kernel);
        Ok(Self {
            waits: micro_contact.latency_samples() < row_latency(integrator),
            ladder: Ladder::new(&micro_contact, integrator, sample_rate_hz)?,
            micro_contact,
            mobility: Mobility::new(probe, sample_rate_hz)?,
            collision_mass_kg: probe.pad_mass_kg * (1.0 + restitution(probe)),
            contact_time_ratio: libm::pow(probe.pad_mass_kg / own.pad_mass_kg, 0.4),
        })
    }
}
