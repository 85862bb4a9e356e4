//! Modes of a shape: a mesh and a material become a body that rings wherever it is struck.

use crate::error::{refused, refused_at};
use crate::interrupt::Pulse;
use asperity::Material;
use asperity_shape::eigenmodes::{MOST_MODES, Wanted};
use asperity_shape::modes_file::ModesFile;
use asperity_shape::surface_mesh::SurfaceMesh;
use asperity_shape::{Elastic, Making, Mesh};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// The lowest so many modes, as far as is heard, where nothing else is said.
const ORDINARY: Wanted = Wanted { up_to_hz: Some(20_000.0), most: 64 };

/// Solves a mesh, a file or points (n, 3) and triangles (m, 3), for its modes.
#[pyfunction]
#[pyo3(signature = (path, surface, *, material=None, elastic, damping_from=None, size_m=None, thickness_m=None, up_to_hz=None, max_modes=None, radiation=false, progress=None))]
#[allow(clippy::too_many_arguments, reason = "they are the options of a verb")]
pub fn modes<'py>(
    py: Python<'py>,
    path: Option<PathBuf>,
    surface: Option<(PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, u32>)>,
    material: Option<&str>,
    elastic: [Option<f64>; 3],
    damping_from: Option<PathBuf>,
    size_m: Option<f64>,
    thickness_m: Option<f64>,
    up_to_hz: Option<f64>,
    max_modes: Option<usize>,
    radiation: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let preset = material.map(preset).transpose()?;
    let elastic = elastic_of(preset, elastic)?;
    let damping = match &damping_from {
        None => preset.unwrap_or(Material::PLA).damping(),
        Some(path) => {
            let recorded = asperity::ModalModel::load(path).map_err(|error| refused_at(path, error))?;
            asperity_shape::damping_fit::fit(&recorded.modes).ok_or_else(|| {
                let path = path.display();
                refused(format!(
                    "{path}: has no damped mode to learn from; name the modes file of a recording"
                ))
            })?
        }
    };
    let wanted = wanted(up_to_hz, max_modes)?;
    let mesh = match (&path, surface) {
        (Some(path), _) => {
            py.detach(|| asperity_shape::load(path)).map_err(|error| refused_at(path, error))?
        }
        (None, Some((points, triangles))) => mesh_of(&points, &triangles)?,
        (None, None) => return Err(refused("mesh: is missing; give a path, or points and triangles")),
    };
    let source = path.unwrap_or_else(|| PathBuf::from("mesh"));
    let making = Making { material: elastic, size_m, unit_m: None, thickness_m, wanted };
    let pulse = Pulse::new(progress);
    let solved =
        py.detach(|| pulse.run(|tell| asperity_shape::make(mesh, &making, &mut |done| tell(done))))?;
    let name = source.display().to_string();
    let option = |error: asperity_shape::ShapeError| {
        // What the program calls an option is an argument here.
        let at = error.at.strip_prefix("--").map(|option| format!("{}_m", option.replace('-', "_")));
        match at {
            Some(at) => asperity_shape::ShapeError { at, ..error },
            None => error.within(&name),
        }
    };
    let mut solved = solved.map_err(|error| refused(option(error)))?;
    let file = py.detach(|| ModesFile::new(&mut solved, &damping, radiation, &source)).map_err(refused)?;
    let text = serde_json::to_string(&file).map_err(refused)?;
    // What the engine would refuse is no body.
    asperity::ModalModel::parse(&text).map_err(refused)?;
    let rows: Vec<[f64; 4]> = file
        .modes
        .iter()
        .map(|mode| [mode.frequency_hz, mode.decay_per_s, mode.amplitude, mode.phase_rad])
        .collect();
    let made = PyDict::new(py);
    made.set_item("modes", PyArray1::from_vec(py, rows.into_flattened()).reshape([file.modes.len(), 4])?)?;
    made.set_item("text", text)?;
    made.set_item("volume_m3", solved.volume_m3)?;
    made.set_item("mass_kg", solved.mass_kg)?;
    made.set_item("degrees_of_freedom", solved.degrees_of_freedom)?;
    made.set_item("warnings", solved.remarks)?;
    Ok(made)
}

fn preset(name: &str) -> PyResult<Material> {
    Material::by_name(name).ok_or_else(|| {
        refused(format!("material: \"{name}\" is unknown; must be one of {}", Material::names()))
    })
}

fn elastic_of(preset: Option<Material>, [young, poisson, density]: [Option<f64>; 3]) -> PyResult<Elastic> {
    let of = |name: &str, remarks: Option<f64>, own: Option<f64>| {
        remarks.or(own).ok_or_else(|| {
            let names = Material::names();
            refused(format!("{name}: is missing; give it, or as material one of {names}"))
        })
    };
    let elastic = Elastic {
        young_pa: of("young_pa", young, preset.map(|m| m.young_pa))?,
        poisson: of("poisson", poisson, preset.map(|m| m.poisson))?,
        density_kg_m3: of("density_kg_m3", density, preset.map(|m| m.density_kg_m3))?,
    };
    elastic.checked().map_err(refused)
}

fn wanted(up_to_hz: Option<f64>, max_modes: Option<usize>) -> PyResult<Wanted> {
    if let Some(hz) = up_to_hz.filter(|hz| !(*hz >= 1.0 && *hz <= 1e6)) {
        return Err(refused(format!("up_to_hz: {hz} is refused; must be 1 to 1e6 Hz")));
    }
    if let Some(count) = max_modes.filter(|count| !(1..=MOST_MODES).contains(count)) {
        return Err(refused(format!("max_modes: {count} is refused; must be 1 to {MOST_MODES}")));
    }
    Ok(match (up_to_hz, max_modes) {
        (None, None) => ORDINARY,
        (up_to_hz, most) => Wanted { up_to_hz, most: most.unwrap_or(usize::MAX) },
    })
}

fn mesh_of(points: &PyReadonlyArray2<'_, f64>, triangles: &PyReadonlyArray2<'_, u32>) -> PyResult<Mesh> {
    let three = |name: &str, shape: &[usize]| match shape {
        [_, 3] => Ok(()),
        _ => Err(refused(format!("{name}: has the shape {shape:?}; must be (n, 3)"))),
    };
    three("points", points.shape())?;
    three("triangles", triangles.shape())?;
    let corners = |array: &[f64]| array.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect::<Vec<_>>();
    let points = corners(points.as_slice()?);
    let triangles: Vec<[u32; 3]> =
        triangles.as_slice()?.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    if let Some(wrong) = triangles.iter().flatten().find(|corner| **corner as usize >= points.len()) {
        let most = points.len().saturating_sub(1);
        return Err(refused(format!("triangles: name point {wrong}; must be 0 to {most}")));
    }
    if points.iter().flatten().any(|x| !x.is_finite()) {
        return Err(refused("points: hold numbers that are not finite; must be metres"));
    }
    Ok(Mesh::Surface(SurfaceMesh { points, triangles }))
}
