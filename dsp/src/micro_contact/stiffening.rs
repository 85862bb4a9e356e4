//! A contact that stiffens with the reported force: designs for a ladder of stiffnesses, and what
//! lies between two rungs.
//!
//! ```text
//! k_m(F) = k₁ Fⁿ        F: the reported force in newtons, not the instant one
//! ```
//! n is ⅓ for a sphere on a plane (Hertz), about 0.1–0.25 for a tool on stone and paper, 0.7–0.8 on
//! pile and foam (fitted to published strokes with a tool: Culbertson, Lopez Delgado, Kuchenbecker
//! 2014). Following the instant force would end the closed-form flow; the reported one changes
//! slowly, so that the flow is that of a fixed spring within a step.
//!
//! The maps of a stiffness between two rungs are the mean of theirs, weighed linearly in k. Two
//! rungs lie a quarter of an octave apart: the spring that the mean stands for is off by less than
//! 0.4 %, on the side that loses energy.

use super::{MicroContact, Scheme};

/// Rungs an octave of stiffness.
pub const RUNGS_AN_OCTAVE: usize = 4;

impl MicroContact {
    /// Tests whether two designs differ in nothing that would keep a contact from going over from
    /// one to the other.
    #[must_use]
    pub fn is_a_rung_beside(&self, other: &Self) -> bool {
        self.choice.used == other.choice.used
            && self.choice.substeps == other.choice.substeps
            && self.step_s == other.step_s
    }

    /// Becomes the design between `softer` (`share` 0) and `harder` (1), two rungs of one ladder. A
    /// contact's state goes on as it is.
    pub fn interpolate(&mut self, softer: &Self, harder: &Self, share: f64) {
        let mix = |a: f64, b: f64| a + share * (b - a);
        self.probe = softer.probe;
        self.probe.contact_stiffness_n_m =
            mix(softer.probe.contact_stiffness_n_m, harder.probe.contact_stiffness_n_m);
        self.choice = harder.choice;
        (self.step_s, self.leash_m) = (softer.step_s, softer.leash_m);
        let rest_m_n = [-1.0 / self.probe.contact_stiffness_n_m, 1.0 / self.probe.pad_stiffness_n_m];
        match (&mut self.scheme, &softer.scheme, &harder.scheme) {
            (Scheme::ExactEvent(own), Scheme::ExactEvent(a), Scheme::ExactEvent(b)) => {
                own.interpolate(a, b, share, rest_m_n);
            }
            (Scheme::SemiImplicit(own), Scheme::SemiImplicit(a), Scheme::SemiImplicit(b)) => {
                // Everything but the contact's column is the same, and that is proportional to k.
                *own = *b;
                own.contact_stiffness_n_m = mix(a.contact_stiffness_n_m, b.contact_stiffness_n_m);
                for (c, (a, b)) in own.contact.iter_mut().zip(a.contact.iter().zip(&b.contact)) {
                    *c = mix(*a, *b);
                }
            }
            (own, _, Scheme::EnergyConserving(b)) => {
                let mut between = *b;
                between.set_stiffness(self.probe.contact_stiffness_n_m);
                *own = Scheme::EnergyConserving(between);
            }
            // Two rungs of one ladder never differ in their scheme.
            (own, _, b) => *own = *b,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Integrator, MicroContact, Probe};

    #[test]
    fn a_stiffened_contact_is_the_one_that_is_designed_for_that_stiffness() {
        let probe = Probe::default();
        for wanted in [
            Integrator::ExactEvent,
            Integrator::SemiImplicitEuler,
            Integrator::SemiImplicitEulerExplicitDamper,
            Integrator::EnergyConserving,
        ] {
            let own = MicroContact::new(&probe, wanted, 44_100.0).unwrap();
            for contact_stiffness_n_m in [1.0, 3e3, 2e5, 5e6, 1e9] {
                let designed = Probe { contact_stiffness_n_m, ..probe };
                let designed = MicroContact::new(&designed, wanted, 44_100.0).unwrap();
                assert!(own.stiffened(contact_stiffness_n_m).unwrap() == designed, "{contact_stiffness_n_m}");
            }
            assert!(own.stiffened(f64::NAN).is_err());
        }
    }
}
