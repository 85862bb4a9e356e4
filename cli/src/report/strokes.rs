//! Costs of a choice of the bank on the named cases: a body of 256 modes under what the contact of
//! each case sends it.

use super::cases::{CASES, Chain, SEEDS, take};
use super::resampled::after_the_lead_in;
use super::{CaseError, SAMPLE_RATE_HZ};
use crate::error::CliError;
use crate::measure::relative_error;

/// Impulse that the amplitudes of the body stand for, N·s.
const IMPULSE_N_S: f64 = 0.01;

/// The six cases as a bank takes them.
pub struct Strokes(Vec<(&'static str, Vec<f32>)>);

impl Strokes {
    /// Renders them with the engine's own settings.
    ///
    /// # Errors
    /// Never but by a defect.
    pub fn new() -> Result<Self, CliError> {
        let sent = CASES.iter().map(|case| {
            let take = take(case, *SEEDS.start(), &Chain::default(), None)?;
            Ok((case.name, take.impulse_n_s.iter().map(|impulse| (impulse / IMPULSE_N_S) as f32).collect()))
        });
        sent.collect::<Result<_, _>>().map(Self)
    }

    /// Sound under each case, by some bank.
    pub fn heard<T: Into<f64>>(&self, bank: impl Fn(&[f32]) -> Vec<T>) -> Vec<Vec<f64>> {
        self.0.iter().map(|(_, sent)| bank(sent).into_iter().map(Into::into).collect()).collect()
    }

    /// Sound under the case of this name.
    pub fn heard_of(&self, name: &str, bank: impl Fn(&[f32]) -> Vec<f32>) -> Option<Vec<f64>> {
        let (_, sent) = self.0.iter().find(|(case, _)| *case == name)?;
        Some(bank(sent).into_iter().map(f64::from).collect())
    }

    /// Distance from a reference.
    pub fn errors(&self, found: &[Vec<f64>], reference: &[Vec<f64>]) -> Vec<CaseError> {
        let pairs = self.0.iter().zip(found.iter().zip(reference));
        pairs
            .map(|((name, _), (found, reference))| {
                let all = after_the_lead_in(reference.len(), SAMPLE_RATE_HZ);
                let output = relative_error(found[all.clone()].iter().copied(), &reference[all]);
                CaseError { name, displacement: None, contact_force: None, output }
            })
            .collect()
    }
}
