//! Surfaces from photographs, and comparisons of surfaces.

use crate::error::{refused, refused_at};
use crate::interrupt::Pulse;
use crate::pictures::{array, raster};
use asperity_evidence::compare::{Asked, Comparison, STROKES, Table, all_like_the_first};
use asperity_pictures::from_photo::{DECIDED, PhotoOptions, PhotoSurface, reduced, surface_from_photo};
use asperity_pictures::light::Light;
use asperity_pictures::photograph::load_reduced_photograph;
use asperity_pictures::shape_from_shading::{Method, STEPS};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Steps of the method of Tsai and Shah, as the program takes them.
const TSAI_SHAH_STEPS: usize = 5;
/// Names of the methods.
const METHODS: [(&str, Method); 4] = [
    ("integrable", Method::Integrable(STEPS)),
    ("tsai-shah", Method::TsaiShah(TSAI_SHAH_STEPS)),
    ("dark-is-deep", Method::DarkIsDeep),
    ("flat-ground", Method::FlatGround),
];

/// The brightness of a photograph, 0 to 1, and how much of it is colour rather than light.
#[pyfunction]
pub fn read_photograph<'py>(py: Python<'py>, path: PathBuf) -> PyResult<(Bound<'py, PyArray2<f64>>, f64)> {
    let whole = || load_reduced_photograph(&path, usize::MAX);
    let photograph = py.detach(whole).map_err(|error| refused_at(&path, error))?;
    Ok((array(py, photograph.brightness)?, photograph.colour))
}

/// Heights of a photograph in metres, its roughness, and what was found out about it.
#[pyfunction]
#[pyo3(signature = (photo, *, width_m=None, relief_m=None, light=None, method=None, bright_is_deep=false, calibration=1.0, exaggerate=1.0, progress=None))]
#[allow(clippy::too_many_arguments, clippy::type_complexity, reason = "they are the options of a verb")]
pub fn from_photo<'py>(
    py: Python<'py>,
    photo: PyReadonlyArray2<'py, f64>,
    width_m: Option<f64>,
    relief_m: Option<f64>,
    light: Option<[f64; 3]>,
    method: Option<&str>,
    bright_is_deep: bool,
    calibration: f64,
    exaggerate: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyDict>)> {
    let picture = raster(&photo)?;
    let plain = PhotoOptions::default();
    let texel_m = width_m.map_or(plain.texel_m, |width_m| width_m / picture.width as f64);
    let (picture, reduced_by) = reduced(picture);
    let options = PhotoOptions {
        light: light.map(Light::new).transpose().map_err(refused)?,
        method: method.map(method_of).transpose()?,
        bright_is_deep,
        texel_m: texel_m * reduced_by as f64,
        relief_m,
        calibration,
        exaggeration: exaggerate,
        ..plain
    };
    let pulse = Pulse::new(progress);
    let surface =
        py.detach(|| pulse.run(|tell| surface_from_photo(&picture, &options, tell)))?.map_err(refused)?;
    let report = report(py, &surface, options.texel_m, reduced_by)?;
    let heights_m = surface.displacement.map(|grey| grey * surface.relief_m);
    Ok((array(py, heights_m)?, array(py, surface.roughness)?, report))
}

fn method_of(name: &str) -> PyResult<Method> {
    METHODS.iter().find(|(known, _)| *known == name).map(|(_, method)| *method).ok_or_else(|| {
        let names = METHODS.map(|(known, _)| known).join(", ");
        refused(format!("method: \"{name}\" is unknown; must be one of {names}"))
    })
}

fn report<'py>(
    py: Python<'py>,
    surface: &PhotoSurface,
    texel_m: f64,
    reduced_by: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let method = match surface.shape.method {
        Method::Integrable(_) => METHODS[0].0,
        Method::TsaiShah(_) => METHODS[1].0,
        Method::DarkIsDeep => METHODS[2].0,
        Method::FlatGround => METHODS[3].0,
    };
    let sign = match surface.sign {
        sign if sign.confidence < DECIDED => "undecided",
        sign if sign.bright_is_deep => "bright-is-deep",
        _ if surface.shape.method == Method::DarkIsDeep => "bright-is-high",
        _ => "light",
    };
    let report = PyDict::new(py);
    report.set_item("texel_m", texel_m)?;
    report.set_item("reduced_by", reduced_by)?;
    report.set_item("relief_m", surface.relief_m)?;
    report.set_item("micro_relief_m", surface.micro_relief_m)?;
    report.set_item("method", method)?;
    report.set_item("sign", sign)?;
    report.set_item("sign_confidence", surface.sign.confidence)?;
    report.set_item("light", surface.shape.light.map(|light| light.direction()))?;
    report.set_item("light_is_estimated", surface.light_was_found)?;
    report.set_item("fractal_dimension", surface.dimension)?;
    report.set_item("roughness", surface.roughness.mean())?;
    let repetition = surface.repetition.as_ref();
    report.set_item("lattice_px", repetition.map(|found| [found.lattice.t1_px, found.lattice.t2_px]))?;
    report.set_item("wallpaper_group", repetition.map(|found| found.group.name()))?;
    report.set_item("tileable", surface.tileable)?;
    report.set_item("warnings", surface.doubts.iter().map(ToString::to_string).collect::<Vec<_>>())?;
    Ok(report)
}

/// Share of strokes on each map that are put on the right one, and of metamers of all maps that are
/// put on the first.
#[pyfunction]
#[pyo3(signature = (maps, *, strokes, width_m, relief_m, seed, iterations=None, progress=None))]
#[allow(clippy::too_many_arguments, reason = "they are the options of a verb")]
pub fn compare<'py>(
    py: Python<'py>,
    maps: Vec<PyReadonlyArray2<'py, f64>>,
    strokes: usize,
    width_m: f64,
    relief_m: f64,
    seed: u64,
    iterations: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    if !(2..=8).contains(&maps.len()) {
        return Err(refused(format!("maps: are {}; give 2 to 8", maps.len())));
    }
    if !(STROKES[0]..=STROKES[1]).contains(&strokes) {
        let [least, most] = STROKES;
        return Err(refused(format!("strokes: {strokes} is refused; must be {least} to {most}")));
    }
    for (name, value) in [("width_m", width_m), ("relief_m", relief_m)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(refused(format!("{name}: {value} is refused; must be above 0 m")));
        }
    }
    let maps = maps.iter().map(raster).collect::<PyResult<Vec<_>>>()?;
    let comparison = Comparison { asked: Asked::Machine, strokes, width_m, relief_m, seed };
    let parts = if iterations.is_some() { 3.0 } else { 1.0 };
    let pulse = Pulse::new(progress);
    let tables = py.detach(|| {
        pulse.run(|tell| {
            let at = |(place, error): (usize, String)| format!("maps[{place}]: {error}");
            let table = |maps: &[_], set, part: f64, tell: &mut dyn FnMut(f64)| {
                let mut done = 0.0;
                let step = || {
                    done += 1.0 / maps.len() as f64;
                    tell((part + done) / parts);
                };
                comparison.table(maps, set, step).map_err(|(place, error)| at((place, error.to_string())))
            };
            let originals = table(&maps, 0, 0.0, tell)?;
            let Some(passes) = iterations else { return Ok((originals, None)) };
            let method = asperity_pictures::metamer::Method::Iterated(passes);
            let made = all_like_the_first(&maps, method, |done| tell((1.0 + done) / parts))
                .map_err(|(place, error)| at((place, error.to_string())))?;
            Ok::<_, String>((originals, Some(table(&made, 2, 2.0, tell)?)))
        })
    })?;
    let (originals, metamers) = tables.map_err(refused)?;
    let report = PyDict::new(py);
    report.set_item("originals", in_python(py, &originals)?)?;
    report.set_item("metamers", metamers.as_ref().map(|table| in_python(py, table)).transpose()?)?;
    Ok(report)
}

fn in_python<'py>(py: Python<'py>, table: &Table) -> PyResult<Bound<'py, PyDict>> {
    let report = PyDict::new(py);
    report.set_item("rows", PyArray2::from_vec2(py, &table.rows).map_err(refused)?)?;
    report.set_item("mean", table.mean)?;
    report.set_item("reference", table.reference)?;
    report.set_item("same", table.same)?;
    Ok(report)
}
