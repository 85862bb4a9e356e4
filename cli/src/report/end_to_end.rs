//! From path to ear and finger: each engine preset against the whole chain in f64 at 16 times the
//! rate, and how much of its error each stage makes.
//!
//! ```text
//! E = preset − reference = (preset − A) + (A − B) + (B − reference)
//! A: the preset, its contact exact at 16 times the rate     B: the same with every mode     reference: B's impulses into a bank in f64
//! ```
//! A stage's share is the power of its difference over the sum of all three, so that shares sum to
//! one. The path is the same everywhere: a straight stroke, of which reports are true. What
//! sparse reports of a real one cost stands in [`super::from_reports`].

use super::SAMPLE_RATE_HZ;
use super::cases::{CASES, Case, Chain, SEEDS, Signal, Take, take};
use super::resampled::{after_the_lead_in, between};
use crate::demo::scenes::plate_modes;
use crate::error::CliError;
use crate::measure::{Timing, relative_error};
use asperity::files::contact_log::ContactLog;
use asperity::{Integrator, ModalModel, Preset as EnginePreset};
use serde::Serialize;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// The reference's inner samples over the engine's.
const INNER: usize = 16;
/// Delay in samples of an impulse of the tap behind the force that it is: the kernel is two samples
/// long on each side, and a mean over a step belongs half a step before its end.
const LATE_SAMPLES: f64 = 2.5;
/// The stages, from the contact on.
const STAGES: [&str; 3] = ["contact", "modes left out", "number format of the bank"];
/// A case is contractive where a path moved by 1e-12 m is felt and heard the same within this, dB.
const CONTRACTIVE_DB: f64 = -80.0;

/// A preset.
#[derive(Debug, Clone, Serialize)]
pub struct Preset {
    /// As it is called on the command line.
    pub preset: &'static str,
    /// The worst contractive case, felt or heard, dB.
    pub error_db: f64,
    /// One contact on a body of nine modes, all cases.
    pub ns_per_sample: f64,
    /// Share of each stage in the error's power.
    pub stages: BTreeMap<&'static str, f64>,
    /// Every case by itself.
    pub cases: Vec<CaseLevel>,
}

/// A preset on a case.
#[derive(Debug, Clone, Serialize)]
pub struct CaseLevel {
    /// Name of the case.
    pub name: &'static str,
    /// True where the case loses its initial state; elsewhere waveforms cannot be compared.
    pub contractive: bool,
    /// dB.
    pub felt_db: f64,
    /// dB.
    pub heard_db: f64,
}

/// The chain of a preset with an exact contact at 16 times the rate.
pub fn with_exact_contact(preset: EnginePreset) -> Chain {
    let integrator = Some(Integrator::ExactEvent);
    Chain { preset, integrator, oversampling: Some(INNER), ..Chain::default() }
}

/// Outputs of the reference.
pub struct Reference {
    /// At the engine's samples.
    pub felt: Vec<f64>,
    /// At the inner ones.
    heard: Vec<f64>,
    /// Contact at the engine's samples: the pad's displacement, and the mean force over the sample
    /// that ends there.
    pub contact: [Vec<f64>; 2],
}

impl Reference {
    /// Renders it.
    ///
    /// # Errors
    /// Never but by a defect.
    pub fn new(case: &Case, seed: u64, log: Option<&ContactLog>) -> Result<Self, CliError> {
        Self::excited_by(case, seed, log, None)
    }

    /// Error where this excites the body in place of the contact's force.
    ///
    /// # Errors
    /// Never but by a defect.
    pub fn excited_by(
        case: &Case,
        seed: u64,
        log: Option<&ContactLog>,
        excitation: Option<&'static str>,
    ) -> Result<Self, CliError> {
        let chain = Chain { inner_rows: true, excitation, ..with_exact_contact(EnginePreset::Accurate) };
        let take = take(case, seed, &chain, log)?;
        let (heard, contact) =
            (rung(&plate_modes(), &take.impulse_n_s, take.inner_rate_hz), contact_of(&take));
        Ok(Self { felt: take.haptic, heard, contact })
    }

    /// Sound at each of the engine's samples, so much later, s.
    pub fn heard(&self, later_s: f64) -> Vec<f64> {
        let later = later_s * SAMPLE_RATE_HZ * INNER as f64;
        let at = |n: usize| (n * INNER) as f64 + LATE_SAMPLES - later;
        (0..self.heard.len() / INNER).map(|n| between(&self.heard, at(n))).collect()
    }
}

/// Pad and force of a render with inner rows, at the engine's samples: where the pad is, and the
/// mean force over the sample that ends there.
pub fn contact_of(take: &Take) -> [Vec<f64>; 2] {
    let every = (take.inner_rate_hz / take.rate_hz).round().max(1.0) as usize;
    let mean = |n: usize| {
        let end = (n * every + 1).min(take.force_n.len());
        let over = &take.force_n[end.saturating_sub(every)..end];
        over.iter().sum::<f64>() / over.len().max(1) as f64
    };
    let count = take.audio.len();
    [take.pad_m.iter().step_by(every).copied().collect(), (0..count).map(mean).collect()]
}

/// A body under impulses as the tap shows them, in f64, [`LATE_SAMPLES`] late.
///
/// An impulse is the force of the step that ends at its sample, spread by a cubic B-spline and its
/// delay; each mode undoes the spline. h₀ is the mode's continuous integral less the other samples
/// of its response, so that a slow force is answered exactly whatever the phase.
fn rung(model: &ModalModel, impulse_n_s: &[f64], rate_hz: f64) -> Vec<f64> {
    let mut out = vec![0.0; impulse_n_s.len()];
    for mode in &model.modes {
        let (decay, angle) = (mode.decay_per_s / rate_hz, TAU * mode.frequency_hz / rate_hz);
        let (amplitude, (sin_phase, cos_phase)) =
            (mode.amplitude / model.impulse_n_s, mode.phase_rad.sin_cos());
        let gain = amplitude / ((0.5 * angle).sin() / (0.5 * angle)).powi(4);
        let (keep, (sin, cos)) = ((-decay).exp(), angle.sin_cos());
        let (step_re, step_im) = (keep * cos, keep * sin);
        // Σ h over all later samples: the imaginary part of e^(iφ) z / (1 − z).
        let distance = (1.0 - step_re) * (1.0 - step_re) + step_im * step_im;
        let later = [(step_re - keep * keep) / distance, step_im / distance];
        let continuous =
            amplitude * (angle * cos_phase + decay * sin_phase) / (decay * decay + angle * angle);
        let direct = continuous - gain * (later[1] * cos_phase + later[0] * sin_phase);
        let [mut re, mut im] = [0.0; 2];
        for (y, impulse) in out.iter_mut().zip(impulse_n_s) {
            [re, im] = [re * step_re - im * step_im, re * step_im + im * step_re];
            *y += gain * (im * cos_phase + re * sin_phase) + direct * impulse;
            re += impulse;
        }
    }
    out
}

/// Delay of a preset's sound, s: its forces are means over the inner sample that ends at a row, and
/// the ring's delay is left where the inner samples do not hide it.
pub fn late_s(take: &Take) -> f64 {
    0.5 / take.inner_rate_hz + take.sound_late_s
}

/// Power of a difference over the alternating power of the reference.
fn apart(a: &[f64], b: &[f64], reference: &[f64]) -> f64 {
    let all = after_the_lead_in(reference.len(), SAMPLE_RATE_HZ);
    let difference: Vec<f64> = a.iter().zip(b).zip(reference).map(|((a, b), r)| a - b + r).collect();
    relative_error(difference[all.clone()].iter().copied(), &reference[all]).powi(2)
}

/// A preset's render of a profile, stage by stage as the head of this file says.
fn stages(
    case: &Case,
    seed: u64,
    preset: EnginePreset,
    reference: &Reference,
) -> Result<[[f64; 4]; 2], CliError> {
    let chains = [
        Chain { preset, ..Chain::default() },
        with_exact_contact(preset),
        with_exact_contact(EnginePreset::Accurate),
    ];
    let takes = chains.iter().map(|chain| take(case, seed, chain, None)).collect::<Result<Vec<_>, _>>()?;
    let own: Vec<[Vec<f64>; 2]> =
        takes.iter().map(|take| [reference.felt.clone(), reference.heard(late_s(take))]).collect();
    // What differs from the reference at each one's own time.
    let error = |which: usize, signal: Signal, heard: usize| -> Vec<f64> {
        takes[which].signal(signal).iter().zip(&own[which][heard]).map(|(x, r)| x - r).collect()
    };
    Ok([(Signal::Felt, 0), (Signal::Heard, 1)].map(|(signal, heard)| {
        let truth = &own[0][heard];
        let errors: Vec<Vec<f64>> = (0..3).map(|which| error(which, signal, heard)).collect();
        let none = vec![0.0; truth.len()];
        [
            apart(&errors[0], &none, truth),
            apart(&errors[0], &errors[1], truth),
            apart(&errors[1], &errors[2], truth),
            apart(&errors[2], &none, truth),
        ]
    }))
}

/// Tests whether a path moved by a picometre gives equal outputs.
///
/// # Errors
/// Never but by a defect.
pub fn is_contractive(case: &Case, seed: u64) -> Result<bool, CliError> {
    let chain = Chain::default();
    let (mut moved, here) = (case.log(), take(case, seed, &chain, None)?);
    super::cases::move_along(&mut moved, 1e-12);
    let there = take(case, seed, &chain, Some(&moved))?;
    let most = 10f64.powf(0.1 * CONTRACTIVE_DB);
    Ok([Signal::Felt, Signal::Heard]
        .into_iter()
        .all(|signal| apart(here.signal(signal), there.signal(signal), here.signal(signal)) < most))
}

fn decibels(power: f64) -> f64 {
    10.0 * power.max(1e-30).log10()
}

/// Measures every preset.
///
/// # Errors
/// Never but by a defect.
pub fn presets() -> Result<Vec<Preset>, CliError> {
    let mut grounds = Vec::new();
    for case in &CASES {
        let seed = *SEEDS.start();
        grounds.push((case, seed, is_contractive(case, seed)?, Reference::new(case, seed, None)?));
    }
    EnginePreset::ALL
        .into_iter()
        .zip(ns_per_sample()?)
        .map(|(preset, ns_per_sample)| {
            let (mut sums, mut cases, mut worst_db) = ([0.0; 3], Vec::new(), f64::NEG_INFINITY);
            for (case, seed, contractive, reference) in &grounds {
                let [felt, heard] = stages(case, *seed, preset, reference)?;
                let (felt_db, heard_db) = (decibels(felt[0]), decibels(heard[0]));
                if *contractive {
                    worst_db = worst_db.max(felt_db).max(heard_db);
                    for (sum, which) in sums.iter_mut().zip(1..) {
                        *sum += felt[which] + heard[which];
                    }
                }
                cases.push(CaseLevel { name: case.name, contractive: *contractive, felt_db, heard_db });
            }
            let all: f64 = sums.iter().sum();
            Ok(Preset {
                preset: preset.name(),
                error_db: worst_db,
                ns_per_sample,
                stages: STAGES.into_iter().zip(sums.map(|sum| sum / all)).collect(),
                cases,
            })
        })
        .collect()
}

/// The error of a preset on the worst contractive case, felt or heard, dB.
///
/// # Errors
/// Never but by a defect.
pub fn worst_db(preset: EnginePreset) -> Result<f64, CliError> {
    let (seed, mut worst_db) = (*SEEDS.start(), f64::NEG_INFINITY);
    for case in &CASES {
        if is_contractive(case, seed)? {
            let [felt, heard] = stages(case, seed, preset, &Reference::new(case, seed, None)?)?;
            worst_db = worst_db.max(decibels(felt[0])).max(decibels(heard[0]));
        }
    }
    Ok(worst_db)
}

/// The whole renderer, one contact, of each preset: the median over the cases of the best of some
/// rounds, in turns.
fn ns_per_sample() -> Result<Vec<f64>, CliError> {
    const ROUNDS: usize = 5;
    let mut best = vec![vec![f64::INFINITY; CASES.len()]; EnginePreset::ALL.len()];
    for _ in 0..ROUNDS {
        for (of, case) in CASES.iter().enumerate() {
            for (best, preset) in best.iter_mut().zip(EnginePreset::ALL) {
                let take = take(case, 1, &Chain { preset, ..Chain::default() }, None)?;
                best[of] = best[of].min(take.processing_s * 1e9 / take.audio.len() as f64);
            }
        }
    }
    Ok(best.into_iter().map(|best| Timing::of(best).median).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity::Mode;

    #[test]
    fn a_slow_force_rings_a_mode_as_the_convolution_does() {
        let (rate_hz, pushed_s) = (SAMPLE_RATE_HZ * INNER as f64, 2e-3);
        let force_n = |t: f64| if t < pushed_s { 0.5 - 0.5 * (TAU * t / pushed_s).cos() } else { 0.0 };
        for phase_rad in [0.0, 0.7, -1.3, 3.0] {
            let mode = Mode { frequency_hz: 900.0, decay_per_s: 60.0, amplitude: 0.3, phase_rad };
            let model = ModalModel::new(vec![mode], 0.01).unwrap();
            let count = (4e-3 * rate_hz) as usize;
            let impulses: Vec<f64> = (0..count).map(|n| force_n(n as f64 / rate_hz) / rate_hz).collect();
            let found = rung(&model, &impulses, rate_hz);
            let answer = |t: f64| {
                mode.amplitude / 0.01
                    * (-mode.decay_per_s * t).exp()
                    * (TAU * mode.frequency_hz * t + phase_rad).sin()
            };
            let (mut apart, mut all) = (0.0, 0.0);
            for n in (0..count).step_by(97) {
                let now_s = n as f64 / rate_hz;
                // Simpson's rule over what has pushed so far.
                let steps = 2000;
                let h = now_s.min(pushed_s) / f64::from(steps);
                let at = |k: i32| force_n(h * f64::from(k)) * answer(now_s - h * f64::from(k));
                let weight = |k: i32| if k == 0 || k == steps { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
                let wanted = h / 3.0 * (0..=steps).map(|k| weight(k) * at(k)).sum::<f64>();
                apart += (found[n] - wanted).powi(2);
                all += wanted * wanted;
            }
            let error_db = decibels(apart / all);
            println!("phase {phase_rad}: {error_db:.1} dB");
            assert!(error_db < -80.0, "phase {phase_rad}: {error_db} dB");
        }
    }
}
