//! Analysis of pictures and surfaces made from them.

use crate::error::{refused, refused_at};
use crate::interrupt::Pulse;
use crate::pictures::{array, raster};
use asperity_pictures::fractal_dimension::{Condition, fractal_dimension};
use asperity_pictures::gradient_field::Derivative;
use asperity_pictures::metamer::MetamerOptions;
use asperity_pictures::normal_map::{Green, NormalMapOptions, heights_from_normals};
use asperity_pictures::symmetry::{averaged_cell, find_frieze, find_lattice, wallpaper_group};
use asperity_surface::image_io::{Channel, load_channel};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// One channel of a picture file, 0 to 1: "luma", "r", "g", "b" or "a".
#[pyfunction]
pub fn read_picture<'py>(
    py: Python<'py>,
    path: PathBuf,
    channel: &str,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let channel = match channel {
        "luma" => Channel::Luma,
        "r" => Channel::R,
        "g" => Channel::G,
        "b" => Channel::B,
        "a" => Channel::A,
        other => return Err(refused(format!("channel: \"{other}\" is unknown; must be luma, r, g, b or a"))),
    };
    let image = py.detach(|| load_channel(&path, channel)).map_err(|error| refused_at(&path, error))?;
    array(py, image.raster)
}

/// Fractal dimension, roughness, lattice and wallpaper group of a picture, as JSON.
#[pyfunction]
pub fn analyze(py: Python<'_>, picture: PyReadonlyArray2<'_, f64>) -> PyResult<String> {
    let picture = raster(&picture)?;
    py.detach(|| {
        let mut report = fractal_dimension(&picture)
            .map_err(|error| refused(format!("{error}; give a picture of at least 64 × 64 with relief")))?;
        let lattice = find_lattice(&picture);
        let frieze = if lattice.is_none() { find_frieze(&picture) } else { None };
        let group =
            lattice.map(|lattice| wallpaper_group(&averaged_cell(&picture, &lattice), &lattice).group.name());
        report.conditions.extend(lattice.map(|lattice| Condition::Symmetric(lattice.confidence)));
        let warnings: Vec<String> = report.conditions.iter().map(ToString::to_string).collect();
        Ok(serde_json::json!({
            "width_px": picture.width,
            "height_px": picture.height,
            "fractal_dimension": report.dimension,
            "hurst": report.hurst,
            "spectral_exponent": report.spectral_exponent,
            "roughness": report.roughness,
            "lattice": lattice,
            "wallpaper_group": group,
            "frieze": frieze,
            "warnings": warnings,
        })
        .to_string())
    })
}

/// Heights of a normal map in texels, mean 0, and what was found out about it.
#[pyfunction]
#[pyo3(signature = (red, green, blue, *, green_way=None, derivative=None, keep_tilt=false))]
pub fn from_normals<'py>(
    py: Python<'py>,
    red: PyReadonlyArray2<'py, f64>,
    green: PyReadonlyArray2<'py, f64>,
    blue: PyReadonlyArray2<'py, f64>,
    green_way: Option<&str>,
    derivative: Option<&str>,
    keep_tilt: bool,
) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyDict>)> {
    let way = match green_way {
        None => Green::Detect,
        Some("opengl") => Green::OpenGl,
        Some("directx") => Green::DirectX,
        Some(other) => {
            return Err(refused(format!("green: \"{other}\" is unknown; must be opengl or directx")));
        }
    };
    let derivative = match derivative {
        None => None,
        Some("exact") => Some(Derivative::Exact),
        Some("central") => Some(Derivative::Central),
        Some("sobel") => Some(Derivative::Sobel),
        Some(other) => {
            return Err(refused(format!(
                "derivative: \"{other}\" is unknown; must be exact, central or sobel"
            )));
        }
    };
    let [red, green, blue] = [raster(&red)?, raster(&green)?, raster(&blue)?];
    let options = NormalMapOptions { green: way, derivative, keep_tilt, ..NormalMapOptions::default() };
    let found = py.detach(|| heights_from_normals(&red, &green, &blue, &options)).map_err(refused)?;
    let findings = PyDict::new(py);
    findings.set_item("green", if found.green == Green::DirectX { "directx" } else { "opengl" })?;
    findings.set_item("green_is_certain", found.green_is_certain)?;
    findings.set_item("derivative_is_certain", found.derivative_is_certain)?;
    findings.set_item("tileable", found.tileable)?;
    findings.set_item("curl", found.curl)?;
    Ok((array(py, found.height_px)?, findings))
}

/// A surface that looks like one and feels like another, in the second's unit of height.
#[pyfunction]
#[pyo3(signature = (look, feel, *, iterations=None, progress=None))]
pub fn metamer<'py>(
    py: Python<'py>,
    look: PyReadonlyArray2<'py, f64>,
    feel: PyReadonlyArray2<'py, f64>,
    iterations: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyDict>)> {
    let (look, feel) = (raster(&look)?, raster(&feel)?);
    let mut options = MetamerOptions::default();
    if let Some(passes) = iterations {
        options.method = asperity_pictures::metamer::Method::Iterated(passes);
    }
    let pulse = Pulse::new(progress);
    let made = py
        .detach(|| pulse.run(|tell| asperity_pictures::metamer::metamer(&look, &feel, &options, tell)))?
        .map_err(refused)?;
    let findings = PyDict::new(py);
    findings.set_item("mean_before", made.before.mean)?;
    findings.set_item("mean_after", made.after.mean)?;
    findings.set_item("heights_after", made.after.heights)?;
    findings.set_item("tileable", made.tileable)?;
    findings.set_item("borrowed", made.borrowed)?;
    Ok((array(py, made.image)?, findings))
}
