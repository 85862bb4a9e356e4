//! Choices of the whole engine on the named cases: how many inner samples, what excites the body.

use super::cases::{CASES, Case, Chain, SEEDS, Signal, Take, take};
use super::end_to_end::Reference;
use super::integrator::rms;
use super::resampled::after_the_lead_in;
use super::{CaseError, Row, SAMPLE_RATE_HZ, end_to_end};
use crate::error::CliError;
use crate::measure::relative_error;

const REFERENCE: &str = "the whole chain at 16 inner samples, the bank in f64, profiles of four seeds a case; the whole renderer, one contact, is timed";
const EXCITER_REFERENCE: &str = "the same exciter, the whole chain at 16 inner samples; what is felt and how the contact moves do not depend on it. Collisions of a \
                                 contact that leaps are another sound wherever they fall a moment later";

/// The whole chain of every case and seed at sixteen inner samples, where this excites the body.
///
/// # Errors
/// Never but by a defect.
pub fn truths(excitation: Option<&'static str>) -> Result<Vec<Vec<Reference>>, CliError> {
    let of = |case: &Case| SEEDS.map(|seed| Reference::excited_by(case, seed, None, excitation)).collect();
    CASES.iter().map(of).collect()
}

/// Errors against the truth: displacement, force, felt, heard.
fn errors(take: &Take, truth: &Reference) -> [f64; 4] {
    let error = |found: &[f64], reference: &[f64]| {
        let all = after_the_lead_in(reference.len().min(found.len()), SAMPLE_RATE_HZ);
        relative_error(found[all.clone()].iter().copied(), &reference[all])
    };
    let [pad_m, force_n] = end_to_end::contact_of(take);
    let heard = truth.heard(end_to_end::late_s(take));
    [
        error(&pad_m, &truth.contact[0]),
        error(&force_n, &truth.contact[1]),
        error(take.signal(Signal::Felt), &truth.felt),
        error(take.signal(Signal::Heard), &heard),
    ]
}

/// A choice against the whole chain. Of an exciter: pad, force and what is felt do not depend on
/// it.
fn row(
    name: (&'static str, String),
    chain: &Chain,
    truths: &[Vec<Reference>],
    reference: &'static str,
) -> Result<Row, CliError> {
    let (mut cases, mut best_ns) = (Vec::new(), Vec::new());
    for (case, truths) in CASES.iter().zip(truths) {
        let (mut found, mut best) = (Vec::new(), f64::INFINITY);
        for (seed, truth) in SEEDS.zip(truths) {
            let shown = take(case, seed, &Chain { inner_rows: true, ..*chain }, None)?;
            let [displacement, contact_force, felt, heard] = errors(&shown, truth);
            let output = if chain.excitation.is_some() { heard } else { felt.max(heard) };
            found.push([displacement, contact_force, output]);
            let timed = take(case, seed, chain, None)?;
            best = f64::min(best, timed.processing_s * 1e9 / timed.audio.len() as f64);
        }
        let [displacement, contact_force, output] = rms(&found);
        let reached = |error: f64| chain.excitation.is_none().then_some(error);
        let (displacement, contact_force) = (reached(displacement), reached(contact_force));
        cases.push(CaseError { name: case.name, displacement, contact_force, output });
        best_ns.push(best);
    }
    best_ns.sort_by(f64::total_cmp);
    Ok(Row::on_cases(name, crate::measure::quantile(&best_ns, 0.5), cases, reference))
}

/// Inner samples where there would be one.
pub fn oversampling_rows() -> Result<Vec<Row>, CliError> {
    let truths = truths(None)?;
    let choice = |inner: usize| {
        let chain = Chain { oversampling: Some(inner), ..Chain::default() };
        let note = if inner == 1 { " (default)" } else { "" };
        row(("oversampling", format!("{inner} inner samples{note}")), &chain, &truths, REFERENCE)
    };
    [1, 2, 4, 8].into_iter().map(choice).collect()
}

/// Part of a contact that excites the body.
pub fn exciter_rows() -> Result<Vec<Row>, CliError> {
    let choice = |excitation: &'static str| {
        let chain = Chain { excitation: Some(excitation), ..Chain::default() };
        row(("exciter", excitation.to_owned()), &chain, &truths(Some(excitation))?, EXCITER_REFERENCE)
    };
    ["force", "collisions", "both"].into_iter().map(choice).collect()
}
