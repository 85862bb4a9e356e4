//! Reduction: what a phone, a headset or a pad plays of a vibration.

use crate::error::{refused, refused_at};
use crate::interrupt::Pulse;
use asperity_ports::{Clip, Device, ahap, android, haptic_file, hjif, oscillator, reduction};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use std::collections::HashMap;

/// Most envelope points a second where nothing else is said, as the program has it.
const POINTS_PER_S: f64 = 250.0;
/// Keyframes a second of an `.hjif`, and the accuracy beyond which nobody needs more, dB; as the
/// program has them.
const HJIF: [f64; 2] = [4000.0, 40.0];

/// A vibration as two envelopes, and the device that they were made for.
#[pyclass(frozen, module = "asperity._native")]
pub struct NativeClip {
    clip: Clip,
    device: Device,
    #[pyo3(get)]
    gain: f64,
    #[pyo3(get)]
    way: &'static str,
    original: Vec<f64>,
    left: Vec<f64>,
    #[pyo3(get)]
    score: HashMap<&'static str, f64>,
}

/// Reduces samples of displacement, full scale 1, to what a device plays.
#[pyfunction]
#[pyo3(signature = (samples, sr, device, *, points=None, strokes_s=Vec::new(), normalise=false, source="", progress=None))]
#[allow(clippy::too_many_arguments, reason = "they are the options of a verb")]
pub fn reduce(
    py: Python<'_>,
    samples: PyReadonlyArray1<'_, f64>,
    sr: f64,
    device: &str,
    points: Option<f64>,
    strokes_s: Vec<f64>,
    normalise: bool,
    source: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<NativeClip> {
    let device = device_of(device)?;
    let samples = samples.as_slice()?.to_vec();
    let about = asperity_ports::clip::About {
        editor: format!("asperity {}", env!("CARGO_PKG_VERSION")),
        source: source.to_owned(),
        ..Default::default()
    };
    let points_per_s = points.or(Some(device.points_per_s.min(POINTS_PER_S)));
    let options = reduction::Options { points_per_s, strokes_s, normalise, way: None, about };
    let pulse = Pulse::new(progress);
    let made = py.detach(|| pulse.run(|tell| reduction::reduce(&samples, sr, &device, &options, tell)))?;
    let made = made.map_err(refused)?;
    let score = HashMap::from([
        ("in_band_error_db", made.score.in_band_error_db),
        ("balance_db", made.score.balance_db),
        ("level_bias_db", made.score.level_bias_db),
        ("envelope_correlation", made.score.envelope_correlation),
    ]);
    let (way, gain) = (made.way.name(), made.gain);
    Ok(NativeClip { clip: made.clip, device, gain, way, original: made.original, left: made.left, score })
}

fn device_of(name: &str) -> PyResult<Device> {
    if let Some(device) = Device::shipped(name) {
        return Ok(device);
    }
    let path = std::path::Path::new(name);
    let text = std::fs::read_to_string(path).map_err(|error| {
        let known = Device::NAMES.join(", ");
        refused_at(
            path,
            format!("device: {name} cannot be read ({error}); must be one of {known}, or a profile's file"),
        )
    })?;
    Device::parse(&text).map_err(|error| refused(error.within(name)))
}

#[pymethods]
impl NativeClip {
    /// (points, 2): seconds and amplitude 0 to 1.
    fn amplitude<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        points(py, self.clip.amplitude.iter().map(|p| [p.time_s, p.amplitude]).collect())
    }

    /// (points, 2): seconds and frequency 0 to 1 of the device's range.
    fn frequency<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        points(py, self.clip.frequency.iter().map(|p| [p.time_s, p.frequency]).collect())
    }

    /// The original at 8 kHz with the gain, and what is left of it.
    fn waves<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>) {
        (PyArray1::from_slice(py, &self.original), PyArray1::from_slice(py, &self.left))
    }

    /// The clip's length, s.
    fn duration_s(&self) -> f64 {
        self.clip.duration_s()
    }

    /// The label and the band of the device, Hz.
    fn device(&self) -> (String, [f64; 2]) {
        (self.device.label.clone(), self.device.band_hz)
    }

    /// The texts of a format ("haptic", "ahap", "android", "hjif"): what is added to the file's
    /// stem, and the text.
    fn texts(&self, py: Python<'_>, format: &str) -> PyResult<Vec<(&'static str, String)>> {
        py.detach(|| match format {
            "haptic" => Ok(vec![(".haptic", haptic_file::write(&self.clip).map_err(refused)?)]),
            "android" => {
                Ok(vec![(".android.json", android::write(&self.clip, &self.device).map_err(refused)?)])
            }
            "ahap" => {
                let files = ahap::write(&self.clip, None).map_err(refused)?;
                let transients = files.transients.map(|text| (".transients.ahap", text));
                Ok(std::iter::once((".ahap", files.main)).chain(transients).collect())
            }
            "hjif" => {
                let left = oscillator::rendered(&self.clip, &self.device, hjif::RATE_HZ);
                let bounded: Vec<f64> = left.iter().map(|x| x.clamp(-1.0, 1.0)).collect();
                let written = hjif::write(&bounded, HJIF[0], HJIF[1], "vibration").map_err(refused)?;
                Ok(vec![(".hjif", written.text)])
            }
            other => {
                Err(refused(format!("format: \"{other}\" is unknown; must be haptic, ahap, android or hjif")))
            }
        })
    }
}

fn points(py: Python<'_>, points: Vec<[f64; 2]>) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let shape = [points.len(), 2];
    PyArray1::from_vec(py, points.into_flattened()).reshape(shape)
}
