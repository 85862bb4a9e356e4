//! Integrators of the contact model.

use super::{BLOCK, Row, SAMPLE_RATE_HZ, refused};
use crate::error::CliError;
use crate::measure::{ns_per_item, relative_error};
use asperity::{Integrator, Probe};
use asperity_dsp::micro_contact::{ContactSample, MicroContact};
use asperity_dsp::rng::Rng;
use std::f64::consts::PI;

/// The reference runs this much faster.
const OVERSAMPLING: usize = 64;
const SECONDS: f64 = 0.4;
const FORCE_N: f64 = 0.5;
const REFERENCE: &str = "exact-event at 64 times the rate on the same band-limited profile, pad displacement, \
                         geometric mean of four profiles";

/// Lines of a profile: amplitude in m, frequency in Hz, phase.
type Lines = Vec<[f64; 3]>;

/// A smooth grating, one that throws the pad off, rough ground, and ridges with overtones.
fn profiles() -> Vec<Lines> {
    let mut rng = Rng::new(11);
    let mut noise = |rms_m: f64, top_hz: f64, slope: f64| -> Lines {
        let count = 60;
        let mut lines: Lines = (0..count)
            .map(|i| {
                let frequency =
                    20.0 * (top_hz / 20.0).powf((f64::from(i) + rng.uniform()) / f64::from(count));
                [frequency.powf(-slope / 2.0 + 0.5), frequency, 2.0 * PI * rng.uniform()]
            })
            .collect();
        let rms = (lines.iter().map(|line| line[0] * line[0] / 2.0).sum::<f64>()).sqrt();
        lines.iter_mut().for_each(|line| line[0] *= rms_m / rms);
        lines
    };
    let ridges =
        (1..12).map(|k| [4e-5 / f64::from(k), 60.0 * f64::from(k), 0.3 * f64::from(k * k)]).collect();
    vec![
        vec![[5e-5, 80.0, 0.0]],
        vec![[1.5e-4, 120.0, 0.4], [2e-5, 417.0, 1.0]],
        noise(2e-5, 3_000.0, 1.5),
        ridges,
    ]
}

fn heights(lines: &Lines, rate_hz: f64, count: usize) -> Vec<f64> {
    (0..count)
        .map(|n| {
            let t = n as f64 / rate_hz;
            lines.iter().map(|[a, f, phase]| a * ((2.0 * PI * f * t + phase).sin() - phase.sin())).sum()
        })
        .collect()
}

/// The pad at each input sample, latency undone.
fn pad(model: &MicroContact, height_m: &[f64]) -> Vec<f64> {
    let force_n = [FORCE_N; BLOCK];
    let mut rows = vec![ContactSample::default(); height_m.len()];
    let mut state = model.at_rest(height_m[0], FORCE_N);
    for begin in (0..height_m.len()).step_by(BLOCK) {
        let part = begin..(begin + BLOCK).min(height_m.len());
        let length = part.len();
        model.run(&mut state, &height_m[part.clone()], &force_n[..length], &mut rows[part]);
    }
    rows[model.latency_samples()..].iter().map(|row| row.pad_m).collect()
}

/// Measures the axis.
pub fn rows() -> Result<Vec<Row>, CliError> {
    let probe = Probe::default();
    let count = (SECONDS * SAMPLE_RATE_HZ) as usize;
    let fine_hz = SAMPLE_RATE_HZ * OVERSAMPLING as f64;
    let fine = MicroContact::new(&probe, Integrator::ExactEvent, fine_hz).map_err(refused)?;
    let profiles = profiles();
    let references: Vec<Vec<f64>> = profiles
        .iter()
        .map(|lines| pad(&fine, &heights(lines, fine_hz, count * OVERSAMPLING)))
        .map(|pads| pads.into_iter().step_by(OVERSAMPLING).collect())
        .collect();
    let coarse: Vec<Vec<f64>> = profiles.iter().map(|lines| heights(lines, SAMPLE_RATE_HZ, count)).collect();
    Integrator::ALL
        .into_iter()
        .map(|integrator| {
            let model = MicroContact::new(&probe, integrator, SAMPLE_RATE_HZ).map_err(refused)?;
            let mut logarithm = 0.0;
            for (height_m, reference) in coarse.iter().zip(&references) {
                let pads = pad(&model, height_m);
                let common = pads.len().min(reference.len());
                let error = relative_error(pads[..common].iter().copied(), &reference[..common]);
                logarithm += error.max(1e-16).ln() / coarse.len() as f64;
            }
            let all: Vec<f64> = coarse.concat();
            let (force_n, mut rows) = ([FORCE_N; BLOCK], [ContactSample::default(); BLOCK]);
            let mut state = model.at_rest(all[0], FORCE_N);
            let ns_per_sample = ns_per_item(all.len(), || {
                for heights in all.chunks(BLOCK) {
                    model.run(&mut state, heights, &force_n[..heights.len()], &mut rows);
                    std::hint::black_box(&rows);
                }
            });
            Ok(Row {
                axis: "integrator",
                choice: integrator.name().to_owned(),
                ns_per_sample,
                error: logarithm.exp(),
                reference: REFERENCE,
            })
        })
        .collect()
}
