//! Stability of the contact model: for every contact stiffness, rate and scheme asked for, what
//! runs in its place, in how many sub-steps, what it does to the energy of a finger that bounces
//! without damping, and whether it is contractive.
//!
//! *Energy gain*: an undamped finger lands at 0.1 m/s under 0.5 N and bounces for a second; the
//! largest energy over that at the landing, less 1. The equations have none.
//!
//! *Contractive*: the same stroke over the same rough ground twice, at 0.1 m/s and 0.5 N with the
//! fingertip's damping, the second a picometre further. Where the pads end less than −80 dB of
//! their movement apart the contact is contractive; where not, it is chaotic, and levels
//! can be compared and waveforms cannot.

use super::refused;
use crate::error::CliError;
use asperity::{Integrator, Probe};
use asperity_dsp::fractal_noise::{FractalNoise, NoisePath, OctaveWeights};
use asperity_dsp::micro_contact::{ContactSample, ContactState, MicroContact};
use serde::Serialize;

/// Contact stiffnesses, N/m: the fingertip's, and what probes from sponge to steel have.
pub const STIFFNESS_N_M: [f64; 8] = [1e3, 1e4, 5e4, 2e5, 1e6, 5e6, 2e7, 1e9];
/// Rates inside the engine, Hz, and the lowest a kernel of its own is asked to run at.
pub const RATES_HZ: [f64; 6] = [8_000.0, 22_050.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0];

const FORCE_N: f64 = 0.5;
const LANDING_M_S: f64 = 0.1;
const BOUNCING_S: f64 = 1.0;
const STROKE_S: f64 = 0.5;
const SPEED_M_S: f64 = 0.1;
const MOVED_M: f64 = 1e-12;
/// Roughness and rms of the ground: half matte, as a photograph's overlay, on 50 µm waves of 2 mm.
const ROUGHNESS: f64 = 0.5;
const MICRO_RELIEF_M: f64 = 2e-6;
/// Difference below which a contact has forgotten where it came from.
const FORGOTTEN_DB: f64 = -80.0;

/// One cell.
#[derive(Debug, Clone, Serialize)]
pub struct Cell {
    pub contact_stiffness_n_m: f64,
    pub sample_rate_hz: f64,
    /// Scheme asked for.
    pub wanted: &'static str,
    /// Scheme that runs.
    pub used: &'static str,
    /// Steps a sample.
    pub substeps: usize,
    /// Largest energy of an undamped bounce over that at the landing, less 1.
    pub energy_gain: f64,
    /// Final distance of two strokes that begin a picometre apart, dB of their movement.
    pub difference_db: f64,
    pub contractive: bool,
}

/// Measures every cell.
pub fn cells() -> Result<Vec<Cell>, CliError> {
    let mut cells = Vec::new();
    for sample_rate_hz in RATES_HZ {
        let grounds = [0.0, MOVED_M].map(|moved_m| ground(sample_rate_hz, moved_m));
        for wanted in Integrator::ALL {
            for contact_stiffness_n_m in STIFFNESS_N_M {
                cells.push(cell(contact_stiffness_n_m, sample_rate_hz, wanted, &grounds)?);
            }
        }
    }
    Ok(cells)
}

fn cell(
    contact_stiffness_n_m: f64,
    sample_rate_hz: f64,
    wanted: Integrator,
    grounds: &[Vec<f64>; 2],
) -> Result<Cell, CliError> {
    let probe = Probe { contact_stiffness_n_m, ..Probe::default() };
    let model = MicroContact::new(&probe, wanted, sample_rate_hz).map_err(refused)?;
    let undamped = Probe { pad_damping_n_s_m: 0.0, leash_m: 0.05, ..probe };
    let bouncing = MicroContact::new(&undamped, wanted, sample_rate_hz).map_err(refused)?;
    let difference_db = difference_db(&model, grounds);
    Ok(Cell {
        contact_stiffness_n_m,
        sample_rate_hz,
        wanted: wanted.name(),
        used: model.integrator().name(),
        substeps: model.substeps(),
        energy_gain: energy_gain(&bouncing, sample_rate_hz),
        difference_db,
        contractive: difference_db <= FORGOTTEN_DB,
    })
}

/// Energy above that of rest, J.
fn energy_j(model: &MicroContact, state: &ContactState, row: &ContactSample) -> f64 {
    let Probe { contact_stiffness_n_m, pad_stiffness_n_m, .. } = *model.probe();
    let resting = -0.5 * FORCE_N * FORCE_N * (1.0 / contact_stiffness_n_m + 1.0 / pad_stiffness_n_m);
    model.energy_j(state) + FORCE_N * row.finger_m - resting
}

fn energy_gain(model: &MicroContact, sample_rate_hz: f64) -> f64 {
    let mut state = model.landing(0.0, FORCE_N, LANDING_M_S);
    let mut row = [ContactSample::default()];
    model.run(&mut state, &[0.0], &[FORCE_N], &mut row);
    let start_j = energy_j(model, &state, &row[0]);
    let mut most_j = start_j;
    for _ in 0..(BOUNCING_S * sample_rate_hz) as usize {
        model.run(&mut state, &[0.0], &[FORCE_N], &mut row);
        most_j = most_j.max(energy_j(model, &state, &row[0]));
    }
    most_j / start_j - 1.0
}

/// Heights under a stroke that begins `moved_m` further.
fn ground(sample_rate_hz: f64, moved_m: f64) -> Vec<f64> {
    let count = (STROKE_S * sample_rate_hz) as usize;
    let along = |n: usize| moved_m + SPEED_M_S * n as f64 / sample_rate_hz;
    let position_m: Vec<[f64; 2]> = (0..count).map(|n| [along(n), 0.0123]).collect();
    let wave = |x: f64| 5e-5 * (std::f64::consts::TAU * x / 2e-3).sin();
    let mut height_m: Vec<f64> = (0..count).map(|n| wave(along(n))).collect();
    let footprint_m = vec![SPEED_M_S / sample_rate_hz.min(44_100.0); count];
    let path = NoisePath { position_m: &position_m, footprint_m: &footprint_m };
    FractalNoise::new(1).add(
        &path,
        &vec![ROUGHNESS; count],
        &OctaveWeights::pinned(MICRO_RELIEF_M, f64::INFINITY),
        &mut height_m,
    );
    height_m
}

fn difference_db(model: &MicroContact, grounds: &[Vec<f64>; 2]) -> f64 {
    let pads = [0, 1].map(|k| {
        let force_n = vec![FORCE_N; grounds[k].len()];
        let mut rows = vec![ContactSample::default(); grounds[k].len()];
        // Both begin at the same height, so that only the ground differs.
        let mut state = model.at_rest(grounds[0][0], FORCE_N);
        model.run(&mut state, &grounds[k], &force_n, &mut rows);
        // The last fifth: what the beginning did has had its time.
        rows[rows.len() * 4 / 5..].iter().map(|row| row.pad_m).collect::<Vec<f64>>()
    });
    let mean = pads[0].iter().sum::<f64>() / pads[0].len() as f64;
    let moving: f64 = pads[0].iter().map(|x| (x - mean).powi(2)).sum();
    let apart: f64 = pads[0].iter().zip(&pads[1]).map(|(a, b)| (a - b).powi(2)).sum();
    10.0 * (apart.max(1e-60) / moving).log10()
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::micro_contact::CONTACT_STIFFNESS_N_M;

    #[test]
    fn the_default_contact_is_contractive_and_stiff_ones_change_scheme() {
        let grounds = [0.0, MOVED_M].map(|moved_m| ground(44_100.0, moved_m));
        let fingertip = cell(CONTACT_STIFFNESS_N_M, 44_100.0, Integrator::ExactEvent, &grounds).unwrap();
        assert!(fingertip.contractive && fingertip.energy_gain < 1e-6, "{fingertip:?}");
        let stiff = cell(1e9, 44_100.0, Integrator::SemiImplicitEuler, &grounds).unwrap();
        assert_eq!((stiff.used, stiff.substeps), ("energy-conserving", 1));
        assert!(stiff.energy_gain < 1e-9, "{stiff:?}");
    }
}
