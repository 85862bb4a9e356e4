//! Choices of the whole engine on the named cases: how many inner samples, which preset, what excites the body.

use super::cases::{CASES, Case, Chain, SEEDS, Signal, Take, take};
use super::integrator::{references, rms};
use super::resampled::after_the_lead_in;
use super::{CaseError, Row, SAMPLE_RATE_HZ, end_to_end};
use crate::error::CliError;
use crate::measure::relative_error;
use asperity::{Integrator, Preset};

const WHOLE_REFERENCE: &str = "the whole chain at 16 inner samples, the bank in f64, profiles of four seeds a case; the whole renderer, one contact, is timed";
const EXCITER_REFERENCE: &str = "the same exciter at 8 times the rate; what is felt and how the contact moves do not depend on it. Collisions of a \
                                 contact that leaps are another sound wherever they fall a moment later";

/// Times an exciter is timed.
const ROUNDS: usize = 3;

/// The whole chain of every case and seed at sixteen inner samples.
fn truths() -> Result<Vec<Vec<(Take, end_to_end::Reference)>>, CliError> {
    let of = |case: &Case| {
        SEEDS
            .map(|seed| {
                let exact = end_to_end::with_exact_contact(Preset::Accurate);
                Ok((take(case, seed, &exact, None)?, end_to_end::Reference::new(case, seed, None)?))
            })
            .collect::<Result<Vec<_>, CliError>>()
    };
    CASES.iter().map(of).collect()
}

/// A choice against the whole chain.
fn whole_row(
    name: (&'static str, String),
    chain: &Chain,
    truths: &[Vec<(Take, end_to_end::Reference)>],
) -> Result<Row, CliError> {
    let (mut cases, mut best_ns) = (Vec::new(), Vec::new());
    for (case, truths) in CASES.iter().zip(truths) {
        let (mut errors, mut best) = (Vec::new(), f64::INFINITY);
        for (seed, (fine, truth)) in SEEDS.zip(truths) {
            let take = take(case, seed, chain, None)?;
            let heard = truth.heard(end_to_end::late_s(&take));
            let error = |signal: Signal, reference: &[f64]| {
                let all = after_the_lead_in(reference.len(), SAMPLE_RATE_HZ);
                relative_error(take.signal(signal)[all.clone()].iter().copied(), &reference[all])
            };
            errors.push([
                error(Signal::Displacement, &fine.pad_m),
                error(Signal::ContactForce, &fine.force_n),
                error(Signal::Felt, &truth.felt).max(error(Signal::Heard, &heard)),
            ]);
            best = f64::min(best, take.processing_s * 1e9 / take.audio.len() as f64);
        }
        let [displacement, contact_force, output] = rms(&errors);
        let (displacement, contact_force) = (Some(displacement), Some(contact_force));
        cases.push(CaseError { name: case.name, displacement, contact_force, output });
        best_ns.push(best);
    }
    best_ns.sort_by(f64::total_cmp);
    Ok(Row::on_cases(name, crate::measure::quantile(&best_ns, 0.5), cases, WHOLE_REFERENCE))
}

/// Inner samples where there would be one.
pub fn oversampling_rows() -> Result<Vec<Row>, CliError> {
    let truths = truths()?;
    [1, 2, 4, 8]
        .into_iter()
        .map(|inner| {
            let chain = Chain { oversampling: Some(inner), ..Chain::default() };
            let note = if inner == 1 { " (default)" } else { "" };
            whole_row(("oversampling", format!("{inner} inner samples{note}")), &chain, &truths)
        })
        .collect()
}

/// Engine presets.
pub fn preset_rows() -> Result<Vec<Row>, CliError> {
    let truths = truths()?;
    let row = |preset: Preset| {
        whole_row(("preset", preset.name().to_owned()), &Chain { preset, ..Chain::default() }, &truths)
    };
    Preset::ALL.into_iter().map(row).collect()
}

/// What of a contact excites the body.
pub fn exciter_rows() -> Result<Vec<Row>, CliError> {
    let row = |excitation: &'static str| {
        let (references, chain) =
            (references(Some(excitation))?, Chain { excitation: Some(excitation), ..Chain::default() });
        let (mut cases, mut best_ns) = (Vec::new(), Vec::new());
        for (case, references) in CASES.iter().zip(&references) {
            let (mut errors, mut best) = (Vec::new(), f64::INFINITY);
            for (seed, reference) in SEEDS.zip(references) {
                errors.push(reference.errors(&take(case, seed, &chain, None)?, Integrator::default()));
            }
            for _ in 0..ROUNDS {
                let timed = take(case, *SEEDS.start(), &chain, None)?;
                best = f64::min(best, timed.processing_s * 1e9 / timed.audio.len() as f64);
            }
            let [_, _, output] = rms(&errors);
            cases.push(CaseError { name: case.name, displacement: None, contact_force: None, output });
            best_ns.push(best);
        }
        best_ns.sort_by(f64::total_cmp);
        let ns = crate::measure::quantile(&best_ns, 0.5);
        Ok(Row::on_cases(("exciter", excitation), ns, cases, EXCITER_REFERENCE))
    };
    ["force", "collisions", "both"].into_iter().map(row).collect()
}
