//! A probe, prepared for the audio half: its contact model, its mobility, and what its
//! micro-collisions weigh.
//!
//! ```text
//! collision   m (1 + e) v      m = pad mass; of a tool whose contact is far softer than a ball on hard ground, the ball alone, 4/3 π r³ ρ
//! ```
//! A contact of 6 kN/m is not that of a steel tip of 1.6 mm on stone, which Hertz has at 3 MN/m:
//! it is the tool's own bending and its grip. What strikes the ground without that spring between
//! is the tip in front of it, and the momentum of the tool behind arrives with the contact force. A
//! probe that has a [tip of its own](asperity_dsp::micro_contact::HeardTip) is heard by that alone.

use crate::resource::stiffness::{self, Ground, StiffnessTable};
use crate::resource::stroking::restitution;
use asperity_dsp::DesignError;
use asperity_dsp::micro_contact::{
    Choice, EXACT_MAX_STIFFNESS_N_M, HeardTip, Integrator, MicroContact, Probe,
};
use asperity_dsp::mobility::Mobility;
use asperity_dsp::simd::Level;

/// Everything a contact of this probe needs.
#[derive(Debug, Clone)]
pub(crate) struct PreparedProbe {
    pub(crate) micro_contact: MicroContact,
    /// Designs on contacts of any stiffness.
    pub(crate) stiffness_table: StiffnessTable,
    pub(crate) mobility: Mobility,
    /// Momentum of a micro-collision per closing speed, kg: colliding mass × (1 + restitution).
    pub(crate) collision_mass_kg: f64,
    /// Contact time over that of the engine's own probe: (m / m₀)^(2/5).
    pub(crate) contact_time_ratio: f64,
    /// True where its rows come one sample before those of the engine's integrator, and have to
    /// wait.
    pub(crate) waits: bool,
    /// HeardTip that is heard in its place.
    pub(crate) tip: Option<Box<PreparedProbe>>,
    /// The tip that this is, whose contact is Hertz'.
    hertz: Option<HeardTip>,
}

/// Density of a tip, kg/m³: steel.
const TIP_KG_M3: f64 = 7800.0;

/// Mass that collides in a micro-collision, kg.
pub(crate) fn colliding_kg(probe: &Probe) -> f64 {
    if !probe.bends() {
        return probe.pad_mass_kg;
    }
    let ball_kg = 4.0 / 3.0 * std::f64::consts::PI * libm::pow(probe.tip_radius_m, 3.0) * TIP_KG_M3;
    probe.pad_mass_kg.min(ball_kg)
}

/// By how many samples the rows of every probe lag behind its inputs.
pub(crate) fn row_latency(integrator: Integrator) -> usize {
    usize::from(integrator == Integrator::ExactEvent)
}

/// A line where another integrator runs than the one asked for, or in more steps.
pub(crate) fn remark(choice: Choice) -> Option<String> {
    (!choice.is_as_asked()).then(|| {
        format!(
            "integrator: {choice}; a lower contact_stiffness_n_m or a higher sample rate runs it as asked"
        )
    })
}

impl PreparedProbe {
    /// The probe as it was described.
    pub(crate) fn described(&self) -> &Probe {
        self.micro_contact.probe()
    }

    /// Radius of the sphere that rides on surfaces, m.
    pub(crate) fn tip_radius_m(&self) -> f64 {
        self.described().tip_radius_m
    }

    /// Part that touches the body: its tip, if it has one of its own.
    pub(crate) fn touching(&self) -> &Self {
        self.tip.as_deref().unwrap_or(self)
    }

    /// Share of a stroke that is heard of asperities that share its load.
    pub(crate) fn heard_share(&self) -> f64 {
        libm::sqrt(self.described().asperities).recip()
    }

    /// Stiffness on its ground under a reported force, N/m.
    pub(crate) fn stiffness_n_m(&self, ground: &Ground, force_n: f64) -> f64 {
        match &self.hertz {
            Some(tip) => tip.stiffness_n_m(ground.modulus_pa()) * libm::cbrt(stiffness::within(force_n)),
            None => stiffness::stiffness_n_m(self.described(), ground, force_n),
        }
    }

    /// Width over which its skin averages, m; 0 where it has none.
    pub(crate) fn ridge_m(&self) -> f64 {
        self.described().ridge_m
    }

    /// At the engine's inner rate; `own` is the engine's own probe.
    pub(crate) fn new(
        probe: &Probe,
        own: &Probe,
        integrator: Integrator,
        sample_rate_hz: f64,
        kernel: Level,
    ) -> Result<Self, DesignError> {
        let prepared = |tip: &HeardTip| {
            let mut front = probe.heard(tip);
            front.contact_stiffness_n_m = front.contact_stiffness_n_m.min(EXACT_MAX_STIFFNESS_N_M);
            let front = Self::new(&front, own, integrator, sample_rate_hz, kernel)?;
            Ok(Box::new(Self { hertz: Some(*tip), ..front }))
        };
        let tip = probe.tip.as_ref().map(prepared).transpose()?;
        let micro_contact = MicroContact::new(probe, integrator, sample_rate_hz)?.on(kernel);
        let colliding_kg = colliding_kg(probe);
        Ok(Self {
            waits: micro_contact.latency_samples() < row_latency(integrator),
            stiffness_table: StiffnessTable::new(&micro_contact)?,
            micro_contact,
            mobility: Mobility::new(probe, sample_rate_hz)?,
            collision_mass_kg: colliding_kg * (1.0 + restitution(probe)),
            contact_time_ratio: libm::pow(colliding_kg / self::colliding_kg(own), 0.4),
            tip,
            hertz: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::probe::probe_by_name;

    #[test]
    fn a_tool_collides_with_its_tip_and_a_point_with_its_pad() {
        let of = |name: &str| probe_by_name(name).unwrap();
        // A steel ball of 1.6 mm weighs 0.134 g.
        assert!((colliding_kg(&of("stylus")) - 0.134e-3).abs() < 1e-6);
        for name in ["fingertip", "fingernail", "rigid", "sole"] {
            assert_eq!(colliding_kg(&of(name)), of(name).pad_mass_kg, "{name}");
        }
    }
}
