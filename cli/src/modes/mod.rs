//! `asperity modes`: the shape of a body becomes modes that ring wherever it is struck.

mod options;
mod picture;

use crate::arguments::plain;
use crate::error::CliError;
use crate::output::{self, Outputs, check_destination};
use crate::paths::has_end;
use crate::progress::Progress;
use asperity::{Material, ModalModel};
use asperity_shape::modes_file::ModesFile;
use asperity_shape::surface_mesh::SurfaceMesh;
use asperity_shape::unwrap::Unwrapped;
use asperity_shape::{Elastic, Making, Mesh};
pub use options::{Options, preset};
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

/// Steps of the progress bar.
const STEPS: u64 = 200;

/// The object of `--json`.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Modes written.
    pub modes: usize,
    /// Unknowns solved for.
    pub degrees_of_freedom: usize,
    elements: usize,
    volume_m3: f64,
    mass_kg: f64,
    /// Lowest mode, Hz.
    pub lowest_hz: f64,
    /// Highest mode, Hz.
    pub highest_hz: f64,
    /// Duration, s.
    pub seconds: f64,
    peak_mib: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    unwrap: Option<Unwrapped>,
    warnings: Vec<String>,
}

/// Runs the verb.
///
/// # Errors
/// When the mesh is no body, an option is out of range, the modes cannot be solved for, or a file
/// cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let mut progress = Progress::new("solving", STEPS);
    let report = make(options, &mut |done| progress.reach(done));
    drop(progress);
    let report = report?;
    output::say_report(&report, options.json, || in_words(&report, options))
}

/// Modes of a mesh of a material, `size_m` long or as long as it is, as `asperity modes` writes
/// them.
///
/// # Errors
/// When the mesh is no body, or the modes cannot be solved for.
pub fn model(
    mesh: &Path,
    material: &Material,
    size_m: Option<f64>,
    progress: &mut dyn FnMut(f64),
) -> Result<ModalModel, CliError> {
    let Material { young_pa, poisson, density_kg_m3, .. } = *material;
    let elastic = Elastic { young_pa, poisson, density_kg_m3 }.checked().map_err(CliError::from_error)?;
    let wanted = plain::<Options>(mesh, mesh)?.wanted()?;
    let making = Making { material: elastic, size_m, unit_m: None, thickness_m: None, wanted };
    let remarks =
        |error: asperity_shape::ShapeError| CliError::from_error(error.within(&mesh.display().to_string()));
    let shape = asperity_shape::load_part(mesh, None).map_err(CliError::from_error)?;
    let mut body = asperity_shape::make(shape, &making, progress).map_err(remarks)?;
    let file = ModesFile::new(&mut body, &material.damping(), false, mesh).map_err(CliError::from_error)?;
    let text =
        serde_json::to_string(&file).map_err(|error| CliError::from_error(error).within(mesh.display()))?;
    ModalModel::parse(&text).map_err(|error| CliError::from_error(error).within(mesh.display()))
}

/// Writes the files and says nothing; `progress` gets the part done, 0 to 1.
///
/// # Errors
/// Those of [`run`].
pub fn make(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<Report, CliError> {
    let started = Instant::now();
    check_destination(&options.output)?;
    options.plot.as_deref().map_or(Ok(()), check_destination)?;
    let beside = options.output.with_extension(if options.shapes_glb { "glb" } else { "shapes" });
    output::refuse_input(&beside)?;
    let wanted = options.wanted()?;
    let (material, damping) = options.material()?;
    let mesh =
        asperity_shape::load_part(&options.body, options.part.as_deref()).map_err(CliError::from_error)?;
    let making = Making {
        material,
        size_m: options.size,
        unit_m: options.unit,
        thickness_m: options.thickness,
        wanted,
    };
    let name = options.body.display().to_string();
    let beside_uv = options.output.with_extension("uv.glb");
    let unwrapped = match &options.unwrap.unwrap {
        Some(_) => {
            check_destination(&beside_uv)?;
            options
                .unwrap
                .glb(sheet(&mesh, options)?)
                .map_err(|error| CliError::from_error(error.within(&name)))?
        }
        None => None,
    };
    let mut body = asperity_shape::make(mesh, &making, progress).map_err(|error| {
        CliError::from_error(if error.at.starts_with("--") { error } else { error.within(&name) })
    })?;
    let mut file = ModesFile::new(&mut body, &damping, options.radiation, &options.body)
        .map_err(CliError::from_error)?;
    let mut outputs = Outputs::new();
    let text = serde_json::to_string(&file)
        .map_err(|error| CliError::file(&options.output, error, "please report it with the input"))?;
    // What the engine would refuse is no body.
    ModalModel::parse(&text).map_err(|error| CliError::from_error(error).within(&name))?;
    let name = beside.file_name().map(|name| name.to_string_lossy().into_owned());
    let written = if let (true, Some(name)) = (options.shapes_beside || options.shapes_glb, name) {
        if let Some(bytes) = file.put_shapes_beside(name) {
            outputs.write(&beside, &bytes)?;
        }
        serde_json::to_string(&file)
            .map_err(|error| CliError::file(&options.output, error, "please report it with the input"))?
    } else {
        text
    };
    outputs.write(&options.output, written.as_bytes())?;
    let mut unwrap = None;
    if let Some((bytes, report)) = unwrapped {
        outputs.write(&beside_uv, &bytes)?;
        unwrap = Some(report);
    }
    if let Some(path) = &options.plot {
        let title = options.body.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        outputs.write(path, picture::svg(&title, &body, &damping, &file).as_bytes())?;
    }
    outputs.commit()?;
    Ok(Report {
        modes: file.modes.len(),
        degrees_of_freedom: body.degrees_of_freedom,
        elements: body.elements,
        volume_m3: body.volume_m3,
        mass_kg: body.mass_kg,
        lowest_hz: file.modes.first().map_or(0.0, |m| m.frequency_hz),
        highest_hz: file.modes.last().map_or(0.0, |m| m.frequency_hz),
        seconds: started.elapsed().as_secs_f64(),
        peak_mib: peak_mib(),
        unwrap,
        warnings: body.remarks,
    })
}

/// The surface that is unwrapped, as large as the body that is solved.
fn sheet(mesh: &Mesh, options: &Options) -> Result<SurfaceMesh, CliError> {
    let Mesh::Surface(surface) = mesh else {
        let right = "leave --unwrap out, or give a surface mesh with one rim";
        return Err(CliError::file(&options.body, "is cut into tetrahedra and has no rim", right));
    };
    let mut surface = surface.clone();
    let longest_m = (0..3)
        .map(|axis| {
            let along = || surface.points.iter().map(|point| point[axis]);
            along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min)
        })
        .fold(0.0, f64::max);
    let scale = options.size.map_or(options.unit.unwrap_or(1.0), |size_m| size_m / longest_m);
    surface.points.iter_mut().flatten().for_each(|x| *x *= scale);
    Ok(surface)
}

fn in_words(report: &Report, options: &Options) -> String {
    format!(
        "{}: {} modes from {:.1} to {:.1} Hz, {:.1} g{}, {} unknowns, {:.1} s{}",
        options.output.display(),
        report.modes,
        report.lowest_hz,
        report.highest_hz,
        1e3 * report.mass_kg,
        if options.thickness.is_some() || has_end(&options.body, &["msh"]) {
            ""
        } else {
            " if it is solid (--thickness M: a shell)"
        },
        report.degrees_of_freedom,
        report.seconds,
        output::warned(&report.warnings)
    )
}

/// Most memory the program has held so far, MiB; only where the system says it.
fn peak_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kib / 1024.0)
}
