//! Choices of the whole engine on the named cases: how many inner samples, which preset, what excites the body.

use super::cases::{CASES, Chain, SEEDS, Take, take};
use super::integrator::{Reference, references, rms};
use super::{CaseError, Row};
use crate::error::CliError;
use asperity::{Integrator, Preset};

const REFERENCE: &str = "exact-event at 8 times the rate over the same ground, profiles of four seeds a case; the whole renderer, one contact, is timed";
const EXCITER_REFERENCE: &str = "the same exciter at 8 times the rate; what is felt and how the contact moves do not depend on it. Collisions of a \
                                 contact that leaps are another sound wherever they fall a moment later";
/// Times a choice is timed.
const ROUNDS: usize = 3;

/// A choice on every case; `reaches_contact`: whether pad and force depend on it.
fn row(
    (axis, name): (&'static str, String),
    chain: &Chain,
    references: &[Vec<Reference>],
    reference: &'static str,
    reaches_contact: bool,
) -> Result<Row, CliError> {
    let integrator = chain.integrator.unwrap_or(match chain.preset {
        Preset::Fast => Integrator::EnergyConserving,
        Preset::Default | Preset::Accurate => Integrator::ExactEvent,
    });
    let mut cases = Vec::new();
    let mut best_ns = vec![f64::INFINITY; CASES.len()];
    for ((case, references), best_ns) in CASES.iter().zip(references).zip(&mut best_ns) {
        let takes: Vec<Take> =
            SEEDS.map(|seed| take(case, seed, chain, None)).collect::<Result<_, CliError>>()?;
        let errors: Vec<[f64; 3]> = takes
            .iter()
            .zip(references)
            .map(|(take, reference)| reference.errors(take, integrator))
            .collect();
        let [displacement, contact_force, output] = rms(&errors);
        let reached = |error: f64| reaches_contact.then_some(error);
        let (displacement, contact_force) = (reached(displacement), reached(contact_force));
        cases.push(CaseError { name: case.name, displacement, contact_force, output });
        for round in 0..ROUNDS {
            let again = if round == 0 { None } else { Some(take(case, *SEEDS.start(), chain, None)?) };
            let timed = again.as_ref().unwrap_or(&takes[0]);
            *best_ns = best_ns.min(timed.processing_s * 1e9 / timed.audio.len() as f64);
        }
    }
    best_ns.sort_by(f64::total_cmp);
    Ok(Row::on_cases((axis, name), crate::measure::quantile(&best_ns, 0.5), cases, reference))
}

/// Inner samples where there would be one.
pub fn oversampling_rows() -> Result<Vec<Row>, CliError> {
    let references = references(None)?;
    [1, 2, 4, 8]
        .into_iter()
        .map(|inner| {
            let chain = Chain { oversampling: Some(inner), ..Chain::default() };
            let name = format!("{inner} inner samples{}", if inner == 1 { " (default)" } else { "" });
            row(("oversampling", name), &chain, &references, REFERENCE, true)
        })
        .collect()
}

/// Engine presets.
pub fn preset_rows() -> Result<Vec<Row>, CliError> {
    let references = references(None)?;
    Preset::ALL
        .into_iter()
        .map(|preset| {
            let chain = Chain { preset, ..Chain::default() };
            row(("preset", preset.name().to_owned()), &chain, &references, REFERENCE, true)
        })
        .collect()
}

/// What of a contact excites the body.
pub fn exciter_rows() -> Result<Vec<Row>, CliError> {
    ["force", "collisions", "both"]
        .into_iter()
        .map(|excitation| {
            let (references, excitation) = (references(Some(excitation))?, Some(excitation));
            let chain = Chain { excitation, ..Chain::default() };
            let name = excitation.unwrap_or_default().to_owned();
            row(("exciter", name), &chain, &references, EXCITER_REFERENCE, false)
        })
        .collect()
}
