//! Integrators of the contact model, on the named cases.
//!
//! The reference is the engine itself at eight times the rate with exact events, which differs from
//! an independent re-integration by less than a tenth of any error stated here
//! (`cli/tests/report.rs` re-integrates profiles of other seeds with a Runge–Kutta scheme of its
//! own). A row's force is a mean over a sample, and so is that of the reference: of the sample that
//! ends at the row, or, for the Euler schemes, is centred on it.

use super::cases::{CASES, Case, Chain, SEEDS, Signal, Take, take};
use super::resampled::{after_the_lead_in, between};
use super::{BLOCK, CaseError, Row, SAMPLE_RATE_HZ, refused};
use crate::error::CliError;
use crate::measure::{ns_per_item, relative_error};
use asperity::{Integrator, Preset, Probe};
use asperity_dsp::micro_contact::{ContactSample, MicroContact};

/// The reference runs this much faster.
pub const OVERSAMPLING: usize = 8;
const REFERENCE: &str = "exact-event at 8 times the rate over the same ground, profiles of four seeds a case, which an independent \
                         Runge–Kutta integration confirms; what is heard against the whole chain at 16 inner samples with the bank in f64, lag taken out";

/// Tests whether a row's force is the mean over the sample that is centred on it.
fn is_centred(integrator: Integrator) -> bool {
    matches!(integrator, Integrator::SemiImplicitEuler | Integrator::SemiImplicitEulerExplicitDamper)
}

/// A reference as a row of each quantity at the coarse rate.
pub struct Reference {
    pad_m: Vec<f64>,
    /// Means over the sample that ends at the row, and is centred on it.
    force_n: [Vec<f64>; 2],
    felt: Vec<f64>,
    /// Errors of the two.
    heard: [Vec<f64>; 2],
}

impl Reference {
    /// Figures at the higher rate, rendered or estimated.
    pub fn new(fine: &Take) -> Self {
        let count = fine.audio.len() / OVERSAMPLING;
        let each = |signal: &[f64]| signal.iter().step_by(OVERSAMPLING).copied().collect();
        // The fine row m holds the mean over the fine step that ends there.
        let mean = |ahead: usize| {
            (0..count)
                .map(|n| {
                    let end = (n * OVERSAMPLING + ahead + 1).min(fine.force_n.len());
                    let begin = end.saturating_sub(OVERSAMPLING);
                    fine.force_n[begin..end].iter().sum::<f64>() / OVERSAMPLING as f64
                })
                .collect()
        };
        // What rings is as late as the force: half a step of its own where that ends at the row.
        let heard = |late: f64| {
            let late = late - 0.5;
            (0..count).map(|n| between(&fine.audio, (n * OVERSAMPLING) as f64 - late)).collect()
        };
        Self {
            pad_m: each(&fine.pad_m),
            force_n: [mean(0), mean(OVERSAMPLING / 2)],
            felt: each(&fine.haptic),
            heard: [heard(0.5 * OVERSAMPLING as f64), heard(0.0)],
        }
    }

    /// Errors of a render: displacement, force, output.
    pub fn errors(&self, take: &Take, integrator: Integrator) -> [f64; 3] {
        let [displacement, contact_force, felt, heard] = self.each(take, integrator);
        [displacement, contact_force, felt.max(heard)]
    }

    /// Displacement, force, felt, heard.
    fn each(&self, take: &Take, integrator: Integrator) -> [f64; 4] {
        let which = usize::from(is_centred(integrator));
        let error = |signal, reference: &[f64]| {
            let all = after_the_lead_in(reference.len(), SAMPLE_RATE_HZ);
            relative_error(take.signal(signal)[all.clone()].iter().copied(), &reference[all])
        };
        [
            error(Signal::Displacement, &self.pad_m),
            error(Signal::ContactForce, &self.force_n[which]),
            error(Signal::Felt, &self.felt),
            error(Signal::Heard, &self.heard[which]),
        ]
    }
}

/// References of every case and seed.
fn references() -> Result<Vec<Vec<Reference>>, CliError> {
    let rate_hz = Some(SAMPLE_RATE_HZ * OVERSAMPLING as f64);
    let fine = Chain { rate_hz, preset: Preset::Default, ..Chain::default() };
    let of = |case: &Case| SEEDS.map(|seed| Ok(Reference::new(&take(case, seed, &fine, None)?))).collect();
    CASES.iter().map(of).collect()
}

/// Root mean square over the seeds of each of three errors.
pub fn rms(errors: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|which| {
        (errors.iter().map(|error| error[which].powi(2)).sum::<f64>() / errors.len() as f64).sqrt()
    })
}

/// The errors of those strokes that forget how they came to where they are, if two do, otherwise of
/// all. Where a path moved by a picometre ends elsewhere, no integrator and no ground is at fault,
/// and one such stroke in four would be all that is stated.
fn of_what_forgets(errors: &[[f64; 3]], forget: &[bool]) -> Vec<[f64; 3]> {
    let some: Vec<_> =
        errors.iter().zip(forget).filter(|(_, forgets)| **forgets).map(|(error, _)| *error).collect();
    if some.len() > 1 { some } else { errors.to_vec() }
}

/// Which strokes of each case forget.
fn forgetting() -> Result<Vec<Vec<bool>>, CliError> {
    let of = |case: &Case| SEEDS.map(|seed| super::end_to_end::is_contractive(case, seed)).collect();
    CASES.iter().map(of).collect()
}

/// Measures the axis.
pub fn rows() -> Result<Vec<Row>, CliError> {
    let (references, truths, forgetting) = (references()?, super::choices::truths(None)?, forgetting()?);
    let row = |integrator: Integrator| {
        let chain = Chain { integrator: Some(integrator), ..Chain::default() };
        let (mut cases, mut profiles) = (Vec::new(), Vec::new());
        let cases_and_truths = CASES.iter().zip(&references).zip(&truths).zip(&forgetting);
        for (((case, references), truths), forget) in cases_and_truths {
            let takes = SEEDS.map(|seed| take(case, seed, &chain, None)).collect::<Result<Vec<_>, _>>()?;
            let errors: Vec<[f64; 3]> = takes
                .iter()
                .zip(references)
                .zip(truths)
                .map(|((take, reference), truth)| {
                    // What rings is as late as the force is.
                    let late_s = if is_centred(integrator) {
                        take.sound_late_s
                    } else {
                        super::end_to_end::late_s(take)
                    };
                    let heard = truth.heard(late_s);
                    let all = after_the_lead_in(heard.len(), SAMPLE_RATE_HZ);
                    let heard_error = relative_error(take.audio[all.clone()].iter().copied(), &heard[all]);
                    let [displacement, contact_force, felt, _] = reference.each(take, integrator);
                    [displacement, contact_force, felt.max(heard_error)]
                })
                .collect();
            let [displacement, contact_force, output] = rms(&of_what_forgets(&errors, forget));
            let (displacement, contact_force) = (Some(displacement), Some(contact_force));
            cases.push(CaseError { name: case.name, displacement, contact_force, output });
            let all = after_the_lead_in(takes[0].height_m.len(), SAMPLE_RATE_HZ);
            profiles.push((case.force_n, takes[0].height_m[all].to_vec()));
        }
        let ns = ns_per_sample(integrator, &profiles)?;
        Ok(Row::on_cases(("integrator", integrator.name()), ns, cases, REFERENCE))
    };
    Integrator::ALL.into_iter().map(row).collect()
}

/// The contact model alone over the profiles of every case.
fn ns_per_sample(integrator: Integrator, profiles: &[(f64, Vec<f64>)]) -> Result<f64, CliError> {
    let probe = Probe { force_exponent: 0.0, ..Probe::default() };
    let model = MicroContact::new(&probe, integrator, SAMPLE_RATE_HZ).map_err(refused)?;
    let mut rows = [ContactSample::default(); BLOCK];
    let count = profiles.iter().map(|(_, heights)| heights.len()).sum();
    Ok(ns_per_item(count, || {
        for (force_n, heights) in profiles {
            let (force_n, mut state) = ([*force_n; BLOCK], model.at_rest(heights[0], *force_n));
            for heights in heights.chunks(BLOCK) {
                model.run(&mut state, heights, &force_n[..heights.len()], &mut rows);
                std::hint::black_box(&rows);
            }
        }
    }))
}
