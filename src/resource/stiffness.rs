//! Stiffness of a contact: probe and ground in series, each stiffening with the reported force.
//!
//! ```text
//! 1/k(F) = 1/(k_m Fⁿ) + 1/(k_g Fᵍ)        k_g = (6 E*² r)^(1/3),  F in newtons
//! ```
//! k_m and n are the probe's. k_g is the slope at 1 N of Hertz' sphere of the tip's radius r on
//! ground of the modulus E* = E/(1 − ν²), and g = 0.8, because pile and foam close up under load
//! (0.7–0.8, fitted to published strokes with a tool: Culbertson, Lopez Delgado, Kuchenbecker
//! 2014). From 0.1 GPa on ground counts as rigid and k = k_m Fⁿ: stone, wood and plastic do not
//! give way beside skin or a hand-held tool. Rubber and foam do, and are felt softer.

use crate::model::material::Material;
use asperity_dsp::DesignError;
use asperity_dsp::micro_contact::{MicroContact, Probe, RUNGS_AN_OCTAVE};

/// Forces between which the laws hold, N; beyond, the nearer end counts.
const FORCE_N: (f64, f64) = (0.01, 300.0);
/// Ground of a lower modulus gives way, Pa.
const SOFT_PA: f64 = 1e8;
/// g.
const SOFT_EXPONENT: f64 = 0.8;
/// Least radius with which a probe presses on its ground, m: the exciter's.
const LEAST_RADIUS_M: f64 = crate::model::surface::EXCITER_RADIUS_M;
/// Octaves of stiffness below and above a probe's own that a contact can take.
const OCTAVES: (usize, usize) = (5, 3);

/// Ground that a probe presses on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ground {
    modulus_pa: f64,
    hard: bool,
}

impl Ground {
    /// Ground of a material.
    pub(crate) fn of(material: Material) -> Self {
        let modulus_pa = material.young_pa / (1.0 - material.poisson * material.poisson);
        Self { modulus_pa, hard: material.young_pa >= SOFT_PA }
    }

    /// E/(1 − ν²), Pa.
    pub(crate) fn modulus_pa(&self) -> f64 {
        self.modulus_pa
    }

    /// Tests whether it counts as rigid beside a probe.
    fn is_hard(&self) -> bool {
        self.hard
    }
}

/// The stiffness of a probe on its ground under a reported force, N/m.
pub(crate) fn stiffness_n_m(probe: &Probe, ground: &Ground, force_n: f64) -> f64 {
    let force_n = within(force_n);
    let own_n_m = probe.contact_stiffness_n_m * libm::pow(force_n, probe.force_exponent);
    if ground.is_hard() {
        return own_n_m;
    }
    let radius_m = probe.tip_radius_m.max(LEAST_RADIUS_M);
    let ground_n_m = libm::cbrt(6.0 * ground.modulus_pa * ground.modulus_pa * radius_m)
        * libm::pow(force_n, SOFT_EXPONENT);
    own_n_m * ground_n_m / (own_n_m + ground_n_m)
}

pub(crate) fn within(force_n: f64) -> f64 {
    force_n.clamp(FORCE_N.0, FORCE_N.1)
}

/// Designs of one probe on contacts of rising stiffness.
#[derive(Debug, Clone)]
pub(crate) struct StiffnessTable {
    entries: Box<[MicroContact]>,
    /// Stiffness of the first rung.
    lowest_n_m: f64,
}

impl StiffnessTable {
    /// Around the probe's own stiffness, as far as the integrator that runs there reaches.
    pub(crate) fn new(own: &MicroContact) -> Result<Self, DesignError> {
        let probe = *own.probe();
        let entry = |step: i32| {
            let factor = libm::exp2(f64::from(step) / RUNGS_AN_OCTAVE as f64);
            let contact_stiffness_n_m = (probe.contact_stiffness_n_m * factor).clamp(1.0, 1e9);
            own.stiffened(contact_stiffness_n_m)
        };
        let (below, above) = ((OCTAVES.0 * RUNGS_AN_OCTAVE) as i32, (OCTAVES.1 * RUNGS_AN_OCTAVE) as i32);
        let steps = -below..=above;
        let entries: Vec<_> = steps.map(entry).collect::<Result<_, _>>()?;
        let fits = |entry: &MicroContact| entry.is_a_rung_beside(own);
        // The rungs about the probe's own that run as it does.
        let middle = below as usize;
        let first = middle - entries[..middle].iter().rev().take_while(|entry| fits(entry)).count();
        let last = middle + entries[middle + 1..].iter().take_while(|entry| fits(entry)).count();
        let entries: Box<[_]> = entries[first..=last].into();
        let lowest_n_m = entries[0].probe().contact_stiffness_n_m;
        Ok(Self { entries, lowest_n_m })
    }

    /// Makes `contact` the design of that stiffness, or of the nearest that the ladder has.
    pub(crate) fn set(&self, contact: &mut MicroContact, stiffness_n_m: f64) {
        let height = RUNGS_AN_OCTAVE as f64 * libm::log2(stiffness_n_m / self.lowest_n_m);
        let height = height.clamp(0.0, (self.entries.len() - 1) as f64);
        let below = (height as usize).min(self.entries.len().saturating_sub(2));
        let (Some(softer), Some(harder)) = (self.entries.get(below), self.entries.get(below + 1)) else {
            return contact.clone_from(&self.entries[0]);
        };
        let [low, high] = [softer, harder].map(|entry| entry.probe().contact_stiffness_n_m);
        let share = ((stiffness_n_m - low) / (high - low)).clamp(0.0, 1.0);
        contact.interpolate(softer, harder, if high > low { share } else { 0.0 });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::micro_contact::Integrator;

    #[test]
    fn hard_ground_changes_nothing_and_rubber_halves_a_tool() {
        let tool = Probe {
            contact_stiffness_n_m: 1e4,
            force_exponent: 0.25,
            tip_radius_m: 1.6e-3,
            ..Probe::default()
        };
        let on = |material, force_n| stiffness_n_m(&tool, &Ground::of(material), force_n);
        assert!((on(Material::STEEL, 1.0) / 1e4 - 1.0).abs() < 0.01);
        assert!((on(Material::STEEL, 16.0) / 2e4 - 1.0).abs() < 0.01);
        assert!((0.3..0.6).contains(&(on(Material::RUBBER, 1.0) / 1e4)));
        let growth = (on(Material::RUBBER, 2.0) / on(Material::RUBBER, 0.5)).ln() / 4f64.ln();
        assert!((0.45..0.8).contains(&growth), "{growth}");
    }

    #[test]
    fn a_ladder_has_every_stiffness_between_its_ends() {
        let probe = Probe::default();
        let own = MicroContact::new(&probe, Integrator::ExactEvent, 44_100.0).unwrap();
        let stiffness_table = StiffnessTable::new(&own).unwrap();
        let mut contact = own;
        for factor in [0.05, 0.5, 0.99, 1.0, 3.3, 7.0] {
            let wanted = factor * probe.contact_stiffness_n_m;
            stiffness_table.set(&mut contact, wanted);
            assert!((contact.probe().contact_stiffness_n_m / wanted - 1.0).abs() < 1e-12);
        }
        stiffness_table.set(&mut contact, probe.contact_stiffness_n_m);
        let rest = contact.at_rest(0.0, 0.5);
        assert!(contact.is_settled(&rest, 0.0, 0.5));
    }
}
