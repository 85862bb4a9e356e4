//! Fit: one recorded hit becomes modes.

use crate::error::{refused, refused_at};
use crate::interrupt::Pulse;
use asperity_fit::{ChannelChoice, Fit, FitOptions, FittedMode, Recording};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Fits an array, or a sound file.
#[pyfunction]
#[pyo3(signature = (samples, path, sr, name, *, max_modes, from_hz, to_hz=None, min_level_db, strike=None, start_s=None, burst_s=None, progress=None))]
#[allow(clippy::too_many_arguments, reason = "they are the options of a verb")]
pub fn fit<'py>(
    py: Python<'py>,
    samples: Option<PyReadonlyArray1<'py, f64>>,
    path: Option<PathBuf>,
    sr: f64,
    name: &str,
    max_modes: usize,
    from_hz: f64,
    to_hz: Option<f64>,
    min_level_db: f64,
    strike: Option<usize>,
    start_s: Option<f64>,
    burst_s: Option<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let recording = match (samples, path) {
        (Some(samples), _) => {
            Recording::from_samples(name, samples.as_slice()?.to_vec(), sr).map_err(refused)?
        }
        (None, Some(path)) => py
            .detach(|| asperity_fit::load(&path, ChannelChoice::Loudest))
            .map_err(|error| refused_at(&path, error))?,
        (None, None) => return Err(refused("y: is missing; give samples or a sound file")),
    };
    let options = FitOptions {
        max_modes,
        band_hz: (from_hz, to_hz.unwrap_or(f64::INFINITY)),
        least_level_db: min_level_db,
        start_offset_s: start_s,
        strike,
        ..FitOptions::default()
    };
    let pulse = Pulse::new(progress);
    let fit =
        py.detach(|| pulse.run(|tell| asperity_fit::fit(&recording, &options, tell)))?.map_err(refused)?;
    in_python(py, &fit, recording.samples, burst_s)
}

fn in_python<'py>(
    py: Python<'py>,
    fit: &Fit,
    recording: Vec<f64>,
    burst_s: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let row = |mode: &FittedMode| {
        [
            mode.frequency_hz,
            mode.decay_per_s,
            mode.amplitude,
            mode.phase_rad,
            mode.frequency_std_hz,
            mode.decay_std_per_s,
            mode.amplitude_std,
            mode.phase_std_rad,
            mode.energy,
        ]
    };
    let rows: Vec<[f64; 9]> = fit.modes.iter().map(row).collect();
    let result = PyDict::new(py);
    result.set_item("modes", PyArray1::from_vec(py, rows.into_flattened()).reshape([fit.modes.len(), 9])?)?;
    result.set_item("source", &fit.source)?;
    result.set_item("sr", fit.sample_rate_hz)?;
    for (name, value) in [
        ("onset_s", fit.onset_s),
        ("start_offset_s", fit.start_offset_s),
        ("end_s", fit.end_s),
        ("noise_floor_db", fit.noise_floor_db),
        ("resynthesis_snr_db", fit.resynthesis_snr_db),
        ("snr_from_onset_db", fit.snr_from_onset_db),
        ("struck_peak_db", fit.struck_peak_db),
    ] {
        result.set_item(name, value)?;
    }
    result.set_item("recording", PyArray1::from_vec(py, recording))?;
    result.set_item("resynthesis", PyArray1::from_vec(py, fit.resynthesis()))?;
    result.set_item("residual", PyArray1::from_slice(py, &fit.residual.samples))?;
    let burst = burst_s.map(|length_s| fit.burst(length_s));
    result.set_item(
        "burst",
        burst.map(|burst| (burst.sample_rate_hz, PyArray1::from_vec(py, burst.samples))),
    )?;
    let warnings: Vec<String> = fit.warnings.iter().map(ToString::to_string).collect();
    result.set_item("warnings", warnings)?;
    Ok(result)
}
