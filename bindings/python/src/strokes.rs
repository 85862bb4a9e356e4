//! Surfaces from recorded strokes.

use crate::error::{refused, refused_at};
use asperity::files::scene_file::probe_of;
use asperity::{ModalModel, Mode};
use asperity_stroke::octaves::OUTER_SCALE_M;
use asperity_stroke::pattern::{Pattern, TEXELS};
use asperity_stroke::report::Report;
use asperity_stroke::tool::Ring;
use asperity_stroke::{Options, Quantity, Stroke, Tool, Track};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use std::path::PathBuf;

/// A recording (axes, samples) in SI units, its rate, and one number or a number a sample of speed
/// and force.
type Recorded<'py> =
    (PyReadonlyArray2<'py, f64>, f64, PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>);

/// The report as JSON; the map (rows, columns) in metres and its side, where there are lines; the
/// outer scale of the surface that plays it.
#[pyfunction]
#[pyo3(signature = (strokes, probe, *, displacement, ring=None, tangential_n=None, colour=None, probe_error))]
#[allow(clippy::too_many_arguments, clippy::type_complexity, reason = "they are the options of a verb")]
pub fn from_stroke<'py>(
    py: Python<'py>,
    strokes: Vec<Recorded<'py>>,
    probe: &str,
    displacement: bool,
    ring: Option<PathBuf>,
    tangential_n: Option<Vec<f64>>,
    colour: Option<Vec<(f64, f64)>>,
    probe_error: f64,
) -> PyResult<(String, Option<(Bound<'py, PyArray2<f64>>, f64)>, f64)> {
    let quantity = match ring {
        Some(path) => {
            let model = ModalModel::load(&path).map_err(|error| refused_at(&path, error))?;
            let for_one = |mode: &Mode| Mode { amplitude: mode.amplitude / model.impulse_n_s, ..*mode };
            Quantity::Sound(Ring(model.modes.iter().map(for_one).collect()))
        }
        None if displacement => Quantity::Displacement,
        None => Quantity::Acceleration,
    };
    let probe = serde_json::from_str(probe).map_err(refused)?;
    let tool = Tool { probe: probe_of(probe).map_err(refused)?, quantity };
    let options = Options { tool, probe_error, colour };
    let track = |values: &PyReadonlyArray1<'_, f64>| -> PyResult<Track> {
        Ok(match values.as_slice()? {
            [one] => Track::Constant(*one),
            many => Track::Samples(many.to_vec()),
        })
    };
    let stroke = |(axes, rate_hz, speed, force): &Recorded<'_>| -> PyResult<Stroke> {
        let length = axes.shape()[1].max(1);
        Ok(Stroke {
            axes: axes.as_slice()?.chunks(length).map(<[f64]>::to_vec).collect(),
            rate_hz: *rate_hz,
            speed_m_s: track(speed)?,
            force_n: track(force)?,
        })
    };
    let strokes = strokes.iter().map(stroke).collect::<PyResult<Vec<_>>>()?;
    let (found, map) = py
        .detach(|| {
            let found = asperity_stroke::fit(&strokes, tangential_n.as_deref(), &options)?;
            let map = Pattern::of(&found);
            Ok::<_, asperity_stroke::StrokeError>((found, map))
        })
        .map_err(refused)?;
    let report = serde_json::to_string(&Report::of(&found)).map_err(refused)?;
    let map = map
        .map(|map| {
            Ok::<_, PyErr>((PyArray1::from_vec(py, map.height_m).reshape([TEXELS, TEXELS])?, map.side_m))
        })
        .transpose()?;
    Ok((report, map, OUTER_SCALE_M))
}
