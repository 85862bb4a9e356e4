//! From heights to what a contact makes of them, without an engine about it: ways to read a ground
//! compared on the named cases.
//!
//! ```text
//! heights → contact, exact between events → pad, force → nine modes in f64 → heard
//! ```

use super::cases::{CASES, Case, SEEDS, Take};
use super::integrator::{OVERSAMPLING, Reference, rms};
use super::{CaseError, Row, SAMPLE_RATE_HZ, refused};
use crate::demo::scenes::plate_modes;
use crate::error::CliError;
use asperity::{Integrator, Probe};
use asperity_dsp::micro_contact::{ContactSample, MicroContact};
use std::f64::consts::TAU;

/// The fingertip of the cases.
const PROBE: Probe = Probe {
    pad_mass_kg: 0.15e-3,
    pad_stiffness_n_m: 1000.0,
    pad_damping_n_s_m: 2.0,
    finger_mass_kg: 0.02,
    contact_stiffness_n_m: 2e5,
    force_exponent: 0.0,
    tip_radius_m: 0.0,
    leash_m: 5e-3,
    ridge_m: 0.0,
    tip: None,
    face_m: 0.0,
    asperities: 1.0,
};

/// Response of a contact to heights at this rate.
fn through(case: &Case, heights: &[f64], rate_hz: f64) -> Result<Take, CliError> {
    let probe = Probe { leash_m: Probe::default().leash_m, ..PROBE };
    let model = MicroContact::new(&probe, Integrator::ExactEvent, rate_hz).map_err(refused)?;
    let mut state = model.at_rest(heights.first().copied().unwrap_or(0.0), case.force_n);
    let mut heights = heights.to_vec();
    // Rows lag behind heights.
    let late = model.latency_samples();
    heights.extend(heights.last().copied().into_iter().cycle().take(late));
    let (force_n, mut rows) =
        (vec![case.force_n; heights.len()], vec![ContactSample::default(); heights.len()]);
    model.run(&mut state, &heights, &force_n, &mut rows);
    rows.drain(..late);
    let mut take = Take::default();
    take.rate_hz = rate_hz;
    take.pad_m = rows.iter().map(|row| row.pad_m).collect();
    take.force_n = rows.iter().map(|row| row.contact_force_n).collect();
    take.audio = rung(&take.force_n, rate_hz);
    take.haptic = take.pad_m.clone();
    Ok(take)
}

/// The plate of the cases under a force, mode by mode; half a sample late, as a mean over the
/// sample that ends there is.
fn rung(force_n: &[f64], rate_hz: f64) -> Vec<f64> {
    let model = plate_modes();
    let mut out = vec![0.0; force_n.len()];
    for mode in &model.modes {
        let (keep, angle) = ((-mode.decay_per_s / rate_hz).exp(), TAU * mode.frequency_hz / rate_hz);
        let (sin, cos) = (keep * angle.sin(), keep * angle.cos());
        let gain = mode.amplitude / model.impulse_n_s / rate_hz;
        let [mut re, mut im] = [0.0; 2];
        for (y, force_n) in out.iter_mut().zip(force_n) {
            [re, im] = [re * cos - im * sin, re * sin + im * cos];
            re += force_n;
            *y += gain * im;
        }
    }
    out
}

/// Heights of a case's profile of a seed over places along the stroke, at a rate.
pub type Heights<'a> = dyn Fn(&Case, u64, &[f64], f64) -> Result<Vec<f64>, CliError> + 'a;

/// References of the cases that `concerns` names.
pub struct Truth(Vec<(Case, Vec<Reference>)>);

impl Truth {
    /// From the heights that count as true, at the reference's rate.
    ///
    /// # Errors
    /// Never but by a defect.
    pub fn new(concerns: impl Fn(&Case) -> bool, heights: &Heights<'_>) -> Result<Self, CliError> {
        let rate_hz = SAMPLE_RATE_HZ * OVERSAMPLING as f64;
        let of = |case: &Case| {
            let references = SEEDS.map(|seed| {
                let heights = heights(case, seed, &case.places_m(rate_hz), rate_hz)?;
                Ok(Reference::new(&through(case, &heights, rate_hz)?))
            });
            Ok((*case, references.collect::<Result<_, CliError>>()?))
        };
        CASES.iter().filter(|case| concerns(case)).map(of).collect::<Result<_, _>>().map(Self)
    }

    /// A way to read them.
    ///
    /// # Errors
    /// Never but by a defect.
    pub fn row(
        &self,
        name: (&'static str, String),
        ns_per_sample: f64,
        reference: &'static str,
        heights: &Heights<'_>,
    ) -> Result<Row, CliError> {
        let case = |(case, references): &(Case, Vec<Reference>)| {
            let errors = SEEDS.zip(references).map(|(seed, reference)| {
                let heights = heights(case, seed, &case.places_m(SAMPLE_RATE_HZ), SAMPLE_RATE_HZ)?;
                let take = through(case, &heights, SAMPLE_RATE_HZ)?;
                Ok(reference.errors(&take, Integrator::ExactEvent))
            });
            let [displacement, contact_force, output] = rms(&errors.collect::<Result<Vec<_>, CliError>>()?);
            let (displacement, contact_force) = (Some(displacement), Some(contact_force));
            Ok(CaseError { name: case.name, displacement, contact_force, output })
        };
        let cases = self.0.iter().map(case).collect::<Result<_, CliError>>()?;
        Ok(Row::on_cases(name, ns_per_sample, cases, reference))
    }
}
