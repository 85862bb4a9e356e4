//! Rendering of a scene and its contacts, to arrays: what `asperity render` writes.

use crate::error::refused;
use crate::interrupt::Pulse;
use crate::pictures;
use crate::sources::{self, Sources};
use crate::watch::Watch;
use asperity::Engine;
use asperity::files::contact_log::{ContactLog, LogError};
use asperity::files::scene_file::SceneFile;
use asperity::files::{FileError, Files};
use asperity::load::Overrides;
use asperity::load::levels::Levels;
use asperity::offline::silence::Rendered;
use asperity::offline::{self, Options, Render};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};

/// Most samples of all channels together: 2 GiB of memory, as the program allows.
const MAX_SAMPLES: f64 = (1u64 << 29) as f64;

/// Render and its settings.
struct Wanted<'a> {
    sources: &'a Sources,
    scene: PathBuf,
    /// Text of the contact log, and its name in messages; none = the log that the scene names.
    log: Option<(String, String)>,
    overrides: Overrides<'a>,
    block_frames: usize,
    trace: bool,
    force_rate_hz: Option<f64>,
}

/// Result.
struct Made {
    render: Render,
    kernel: &'static str,
    levels: Levels,
    surfaces: Vec<(String, asperity::SurfaceId)>,
    unread: Vec<String>,
    warnings: Vec<String>,
    watch: Watch,
}

/// Renders a scene and its contacts.
#[pyfunction]
#[pyo3(signature = (scene, files, log, *, sr=None, seed=None, kernel=None, integrator=None, block=256, trace=false, force_rate=None, progress=None))]
#[allow(clippy::too_many_arguments, reason = "they are the options of a verb")]
pub fn render<'py>(
    py: Python<'py>,
    scene: PathBuf,
    files: &Bound<'py, PyDict>,
    log: Option<(String, String)>,
    sr: Option<f64>,
    seed: Option<u64>,
    kernel: Option<&str>,
    integrator: Option<&str>,
    block: usize,
    trace: bool,
    force_rate: Option<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    if !(1..=4096).contains(&block) {
        return Err(refused(format!("block: {block} is refused; must be 1 to 4096 frames")));
    }
    let (kernel, integrator) = (sources::kernel(kernel)?, sources::integrator(integrator)?);
    let sources = Sources::of(files)?;
    let pulse = Pulse::new(progress);
    let made = py.detach(|| {
        let overrides = Overrides {
            files: &sources,
            sample_rate_hz: sr,
            seed,
            integrator,
            kernel,
            ..Overrides::default()
        };
        let wanted = Wanted {
            sources: &sources,
            scene,
            log,
            overrides,
            block_frames: block,
            trace,
            force_rate_hz: force_rate,
        };
        made(&wanted, pulse)
    })?;
    in_python(py, made)
}

fn made(wanted: &Wanted<'_>, pulse: Pulse) -> PyResult<Made> {
    let told = |error: FileError| wanted.sources.told(error);
    let mut file = SceneFile::load_from(wanted.sources, &wanted.scene).map_err(told)?;
    file.seed = wanted.overrides.seed.or(file.seed);
    let (text, name) = log_text(wanted, &file)?;
    let (log, unread) = ContactLog::parse_telling(&text, &name).map_err(refused)?;
    let at = |error: LogError| refused(FileError::from_error(error).within(&name));
    let in_text = |error: LogError| refused(error.in_text(&text, &name));
    log.check_actuators(file.actuators.len()).map_err(in_text)?;
    let engine = Engine::from_scene(&file, &wanted.overrides).map_err(told)?;
    log.check_names(&engine.names).map_err(in_text)?;
    let rate_hz = engine.renderer.sample_rate_hz();
    let channels = engine.renderer.haptic_channels() + engine.renderer.audio_buses();
    let channels = channels + engine.renderer.pickup_channels();
    check_length(&name, (log.end_s() + file.tail_s) * rate_hz, channels, rate_hz)?;
    check_force_rate(wanted.force_rate_hz, rate_hz)?;
    let kernel = engine.renderer.kernel().name();
    let levels = engine.levels.clone();
    let surfaces: Vec<_> = engine.names.surfaces.iter().map(|(name, id)| (name.clone(), *id)).collect();
    let mut watch = Watch::new(pulse, wanted.trace, wanted.force_rate_hz, rate_hz);
    let options = Options { block_frames: wanted.block_frames, tail_s: file.tail_s, clock_s: None };
    let Engine { scene, renderer, names, remarks, .. } = engine;
    let render = offline::render_tapped(scene, renderer, &log, &names, &options, &mut watch);
    if let Some(error) = watch.error() {
        return Err(error);
    }
    let render = render.map_err(at)?;
    let rendered = Rendered { file: &file, log: &log, render: &render, levels: &levels, surfaces: &surfaces };
    let warnings = remarks.into_iter().chain(rendered.warnings()).collect();
    Ok(Made { render, kernel, levels, surfaces, unread, warnings, watch })
}

/// The text of the log and its name in messages.
fn log_text(wanted: &Wanted<'_>, file: &SceneFile) -> PyResult<(String, String)> {
    if let Some(log) = &wanted.log {
        return Ok(log.clone());
    }
    let Some(path) = &file.contacts else {
        let at = format!("{}: contacts", file.path.display());
        let right = "write contacts = \"NAME.jsonl\" there, or give contacts to render";
        return Err(refused(FileError::new(at, "is missing", right)));
    };
    let bytes =
        wanted.sources.read(path).map_err(|error| wanted.sources.told(FileError::read(path, &error)))?;
    let text = String::from_utf8(bytes)
        .map_err(|_| refused(FileError::read(path, &std::io::ErrorKind::InvalidData.into())))?;
    Ok((text, path.display().to_string()))
}

fn check_length(name: &str, samples: f64, channels: usize, rate_hz: f64) -> PyResult<()> {
    let most_s = MAX_SAMPLES / channels as f64 / rate_hz;
    if samples / rate_hz <= most_s {
        return Ok(());
    }
    let what = format!("lasts {:.0} s with its tail", samples / rate_hz);
    Err(refused(FileError::new(
        name,
        what,
        format!("at most {most_s:.0} s are rendered at once; split the log"),
    )))
}

fn check_force_rate(force_rate_hz: Option<f64>, rate_hz: f64) -> PyResult<()> {
    match force_rate_hz {
        Some(hz) if !asperity::limits::output::FORCE_RATE_HZ.holds(hz) || hz > rate_hz => {
            let words = asperity::limits::output::FORCE_RATE_HZ.words;
            Err(refused(format!(
                "force_rate: {hz} is refused; must be {words}, and at most the sample rate {rate_hz}"
            )))
        }
        _ => Ok(()),
    }
}

fn in_python(py: Python<'_>, made: Made) -> PyResult<Bound<'_, PyDict>> {
    let Made { render, kernel, levels, surfaces, unread, warnings, watch } = made;
    let result = PyDict::new(py);
    result.set_item("sr", render.sample_rate_hz)?;
    result.set_item("kernel", kernel)?;
    result.set_item("full_scale", levels.full_scale)?;
    result.set_item("gain", levels.gain)?;
    result.set_item("strike_gain", levels.strike_gain)?;
    result.set_item("limiter_db", render.limiter_db)?;
    result.set_item("stats", serde_json::to_string(&render.stats).map_err(refused)?)?;
    result.set_item("warnings", warnings)?;
    result.set_item("unread", unread)?;
    let sand = PyDict::new(py);
    for after in render.sand {
        let Some((name, _)) = surfaces.iter().find(|(_, id)| *id == after.surface) else { continue };
        let (lowest_m, scale_m) = (after.picture.lowest_m, after.picture.metres_per_grey);
        // 65,535 grey steps from black to white.
        let heights_m = after.picture.raster.map(|grey| lowest_m + grey * 65_535.0 * scale_m);
        sand.set_item(name, pictures::array(py, heights_m)?)?;
    }
    result.set_item("sand", sand)?;
    let (trace, force) = watch.finish();
    result.set_item("trace", trace.map(|rows| rows.arrays(py)).transpose()?)?;
    result.set_item("force", force.map(|rows| rows.arrays(py)).transpose()?)?;
    result.set_item("audio", pictures::planar(py, render.audio)?)?;
    result.set_item("haptic", pictures::planar(py, render.haptic)?)?;
    result.set_item("pickup", pictures::planar(py, render.pickup)?)?;
    Ok(result)
}

/// Writes (channels, samples) as a 32-bit float WAV file.
#[pyfunction]
pub fn write_wav(py: Python<'_>, path: PathBuf, samples: PyReadonlyArray2<'_, f32>, sr: f64) -> PyResult<()> {
    let channels = pictures::signals(&samples)?;
    py.detach(|| asperity::files::wav::write_wav(Path::new(&path), &channels, sr)).map_err(|error| {
        let right = "choose a folder that can be written and has room";
        refused(FileError::new(path.display(), format!("cannot be written ({error})"), right))
    })
}
