//! `asperity render SCENE.toml -o STEM`: a scene and its contact log become WAV files.

pub mod picture;
mod recorder;
mod report;
mod view;

use crate::error::CliError;
use crate::output::{self, Outputs, check_destination, with_suffix};
use crate::scene_log::{load_log, read_past};
use crate::{haptic, shapes, wav};
use asperity::Engine;
use asperity::files::contact_log::{ContactLog, LogEvent};
use asperity::files::scene_file::{SceneFile, Source, SurfaceEntry};
use asperity::limits::output as limits;
use asperity::load::Overrides;
use asperity::offline::silence::Rendered;
use asperity::offline::{self, Render};
use asperity::{Integrator, Isa, PathMode, Preset, Quantity, SurfaceId};
use asperity_plot::pixels;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use picture::ContactCurve;
use recorder::Recorder;
use report::report;
pub use report::{Report, SandReport};
use std::path::PathBuf;
use std::time::Duration;

/// Renders longer than this show a progress bar even when nothing else watches the contacts, s.
const LONG_S: f64 = 60.0;
/// Most samples of all channels together: 2 GiB of memory.
const MAX_SAMPLES: f64 = (1u64 << 29) as f64;

/// Render a scene and its contact log to WAV files
#[derive(Debug, Args)]
pub struct Options {
    /// Scene file
    #[arg(value_name = "SCENE.toml")]
    pub scene: PathBuf,
    /// Writes STEM.audio.wav, STEM.haptic.wav, and what else is asked for
    #[arg(short, long = "output", value_name = "STEM")]
    pub output: PathBuf,
    /// Sample rate, whatever the scene says
    #[arg(long, value_name = "HZ", value_parser = sample_rate)]
    pub rate: Option<f64>,
    /// Frames a block; the result does not depend on it
    #[arg(long, value_name = "FRAMES", default_value_t = 256, value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub block: u16,
    /// Seed of every random number, whatever the scene says
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Accuracy of the engine, from the fastest on: fast, default, accurate; the options below
    /// count more
    #[arg(long, value_name = "NAME", value_parser = presets(), default_value = "default")]
    pub preset: Preset,
    /// Integrator of the contact model
    #[arg(long, value_name = "NAME", value_parser = integrators())]
    pub integrator: Option<Integrator>,
    /// Way from sparse positions to a path
    #[arg(long, value_name = "NAME", value_parser = paths())]
    pub path: Option<PathMode>,
    /// Instruction set of the kernels whose last bits depend on it: portable gives the same files
    /// on every processor
    #[arg(long, value_name = "NAME", value_parser = kernels())]
    pub kernel: Option<Isa>,
    /// Most threads that render at once; the files are the same
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=64))]
    pub threads: u8,
    /// Write STEM.trace.csv, one row a sample and contact
    #[arg(long)]
    pub trace: bool,
    /// Write STEM.force.csv, the 3-D force, one row a millisecond and contact
    #[arg(long)]
    pub force: bool,
    /// Rows a second of STEM.force.csv, up to the sample rate
    #[arg(long, value_name = "HZ", default_value_t = 1000.0, requires = "force", value_parser = force_rate)]
    pub force_rate: f64,
    /// Write STEM.svg, a picture of what happened
    #[arg(long)]
    pub plot: bool,
    /// Write the first haptic channel as a headset's controller plays it, too: `asperity haptic`
    /// has more options
    #[arg(long, value_name = "OUT.(haptic|ahap|hjif|android.json|pcm.wav|wav)")]
    pub port: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

fn force_rate(text: &str) -> Result<f64, String> {
    let rate: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    let range = limits::FORCE_RATE_HZ;
    if range.holds(rate) { Ok(rate) } else { Err(format!("must be {}", range.words)) }
}

/// A sample rate of the command line.
///
/// # Errors
/// When it is no whole number, or out of range.
pub fn sample_rate(text: &str) -> Result<f64, String> {
    let rate: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if limits::SAMPLE_RATE_HZ.holds(rate) && rate.fract() == 0.0 {
        Ok(rate)
    } else {
        Err(format!("must be a whole number, {}", limits::SAMPLE_RATE_HZ.words))
    }
}

fn integrators() -> impl TypedValueParser<Value = Integrator> {
    PossibleValuesParser::new(Integrator::ALL.map(Integrator::name))
        .map(|name| Integrator::from_name(&name).unwrap_or_default())
}

fn presets() -> impl TypedValueParser<Value = Preset> {
    PossibleValuesParser::new(Preset::ALL.map(Preset::name))
        .map(|name| Preset::from_name(&name).unwrap_or_default())
}

fn kernels() -> impl TypedValueParser<Value = Isa> {
    PossibleValuesParser::new(Isa::ALL.map(Isa::name))
        .map(|name| Isa::from_name(&name).unwrap_or(Isa::Portable))
}

fn paths() -> impl TypedValueParser<Value = PathMode> {
    PossibleValuesParser::new(["extrapolate", "hold", "hermite", "band-limited"]).map(|name| {
        match name.as_str() {
            "hold" => PathMode::Hold,
            "hermite" => PathMode::Hermite,
            "band-limited" => PathMode::BandLimited,
            _ => PathMode::Extrapolate,
        }
    })
}

/// Runs the verb.
///
/// # Errors
/// When an input is bad or an output cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let report = render(options)?;
    output::say_report(&report, options.json, || {
        format!(
            "{} of signal at {:.0}× real time: {}, {}, {}; audio peak {:.3}\nwrote {}{}",
            asperity_plot::quantity(report.duration_s, "s"),
            report.real_time_factor,
            asperity_plot::counted(report.events, "event"),
            asperity_plot::counted(report.micro_collisions, "micro-collision"),
            asperity_plot::counted(report.impacts, "impact"),
            report.audio_peak,
            output::listed(&report.files),
            output::warned(&report.warnings),
        )
    })
}

/// Renders, writes the files and reports; `demo` uses it too.
///
/// # Errors
/// As [`run`].
pub fn render(options: &Options) -> Result<Report, CliError> {
    let stem = &options.output;
    if stem.file_name().is_none() || stem.as_os_str().to_string_lossy().ends_with(['/', '\\']) {
        return Err(CliError::file(stem, "is not a file name", "write -o FOLDER/NAME"));
    }
    check_destination(&with_suffix(stem, "audio.wav"))?;
    let mut file = SceneFile::load(&options.scene)?;
    file.seed = options.seed.or(file.seed);
    let (log, unread) = load_log(&file)?;
    check_outputs(options, &file)?;
    shapes::solve(&mut file)?;
    let overrides = Overrides {
        sample_rate_hz: options.rate,
        seed: options.seed,
        preset: options.preset,
        integrator: options.integrator,
        path: options.path,
        kernel: options.kernel,
        threads: Some(usize::from(options.threads)),
        ..Overrides::default()
    };
    let built = Engine::from_scene(&file, &overrides)?;
    let names: Vec<(String, SurfaceId)> =
        built.names.surfaces.iter().map(|(name, id)| (name.clone(), *id)).collect();
    let (levels, remarks) = (built.levels.clone(), built.remarks.clone());
    for (actuator, full_scale) in file.actuators.iter_mut().zip(&levels.full_scale) {
        actuator.full_scale = Some(*full_scale);
    }
    let (rate_hz, kernel) = (built.renderer.sample_rate_hz(), built.renderer.kernel());
    let duration_s = log.end_s() + file.tail_s;
    check_length(&file, duration_s, rate_hz)?;

    let mut outputs = Outputs::new();
    let recorder = start_recorder(options, &mut outputs, rate_hz, duration_s)?;
    let (render, curves, watching) = play(built, &log, &file, options, recorder)?;
    check_finite(&render)?;

    let audio: Vec<&[f32]> = render.audio.iter().map(Vec::as_slice).collect();
    wav::write(&mut outputs, &with_suffix(stem, "audio.wav"), &audio, rate_hz)?;
    let haptic: Vec<&[f32]> = render.haptic.iter().map(Vec::as_slice).collect();
    wav::write(&mut outputs, &with_suffix(stem, "haptic.wav"), &haptic, rate_hz)?;
    if !render.pickup.is_empty() {
        let pickup: Vec<&[f32]> = render.pickup.iter().map(Vec::as_slice).collect();
        wav::write(&mut outputs, &with_suffix(stem, "pickup.wav"), &pickup, rate_hz)?;
    }
    let rendered = Rendered { file: &file, log: &log, render: &render, levels: &levels, surfaces: &names };
    let warnings = unread.iter().map(|place| read_past(place)).chain(remarks).chain(rendered.warnings());
    let warnings = warnings.collect();
    let mut report = Report { warnings, ..report(&render, kernel, levels, watching) };
    for sand in &render.sand {
        let Some((name, _)) = names.iter().find(|(_, id)| *id == sand.surface) else { continue };
        let raster = &sand.picture.raster;
        let grey: Vec<u16> = raster.values.iter().map(|height| (height * 65_535.0).round() as u16).collect();
        let path = with_suffix(stem, &sand_suffix(name));
        outputs.write(&path, &pixels::png16(raster.width, raster.height, &grey))?;
        report.sand.insert(
            name.clone(),
            SandReport {
                volume_before_m3: sand.figures.volume_before_m3,
                volume_after_m3: sand.figures.volume_after_m3,
                max_slope_deg: sand.figures.max_slope_deg,
                print_m: sand.figures.print_m,
                metres_per_grey: sand.picture.metres_per_grey,
                lowest_m: sand.picture.lowest_m,
            },
        );
    }
    if options.plot {
        let svg = view::draw(&file, &log, &render, &curves, &report, &names);
        outputs.write(&with_suffix(stem, "svg"), svg.as_bytes())?;
    }
    if let Some(path) = &options.port {
        let of = file.actuators.first().map(|actuator| actuator.settings.output);
        if !matches!(of, Some(Quantity::Displacement | Quantity::Tangential)) {
            let right = "write output = \"displacement\" for the first actuator";
            return Err(CliError::new("--port", "a clip is made of displacement", right));
        }
        let samples = render.haptic[0].iter().map(|x| f64::from(*x)).collect();
        let strokes_s = haptic::strokes_s(&log, 0);
        report.warnings.extend(haptic::write_port(samples, rate_hz, strokes_s, path, &mut outputs)?);
    }
    report.files = outputs.commit()?;
    Ok(report)
}

/// Refuses outputs that cannot be written, before any work is done for them.
fn check_outputs(options: &Options, file: &SceneFile) -> Result<(), CliError> {
    let sand = |surface: &SurfaceEntry| {
        matches!(surface.source, Source::Sand(_)).then(|| sand_suffix(&surface.name))
    };
    let suffixes =
        ["audio.wav", "haptic.wav", "pickup.wav", "trace.csv", "force.csv", "svg"].map(str::to_owned);
    let of_stem = suffixes.into_iter().chain(file.surfaces.iter().filter_map(sand));
    of_stem
        .map(|suffix| with_suffix(&options.output, &suffix))
        .try_for_each(|path| check_destination(&path))?;
    options.port.as_deref().map_or(Ok(()), check_destination)
}

/// Ending, after the stem, of the picture of a surface of sand.
fn sand_suffix(surface: &str) -> String {
    format!("{}.sand.png", file_name(surface))
}

/// Renders a scene and a log that are in memory, as [`render`] does without options. Returns the
/// samples and what is to be warned of.
///
/// # Errors
/// When the scene or the log is refused.
pub fn in_memory(mut file: SceneFile, log: &ContactLog) -> Result<(Render, Vec<String>), CliError> {
    shapes::solve(&mut file)?;
    let built = Engine::from_scene(&file, &Overrides { threads: Some(1), ..Overrides::default() })?;
    let levels = built.levels.clone();
    for (actuator, full_scale) in file.actuators.iter_mut().zip(&levels.full_scale) {
        actuator.full_scale = Some(*full_scale);
    }
    let surfaces: Vec<(String, SurfaceId)> =
        built.names.surfaces.iter().map(|(name, id)| (name.clone(), *id)).collect();
    let Engine { scene, renderer, names, .. } = built;
    check_length(&file, log.end_s() + file.tail_s, renderer.sample_rate_hz())?;
    let settings = offline::Options { tail_s: file.tail_s, ..offline::Options::default() };
    let render = offline::render(scene, renderer, log, &names, &settings).map_err(CliError::from_error)?;
    check_finite(&render)?;
    let rendered = Rendered { file: &file, log, render: &render, levels: &levels, surfaces: &surfaces };
    let warnings = rendered.warnings();
    Ok((render, warnings))
}

fn check_length(file: &SceneFile, duration_s: f64, rate_hz: f64) -> Result<(), CliError> {
    let samples = duration_s * rate_hz * (1 + file.actuators.len()) as f64;
    if samples <= MAX_SAMPLES {
        return Ok(());
    }
    let most = MAX_SAMPLES / rate_hz / (1 + file.actuators.len()) as f64;
    let at = file.contacts.as_deref().unwrap_or(&file.path).display().to_string();
    let what = format!("lasts {duration_s:.0} s with its tail");
    Err(CliError::new(at, what, format!("at most {most:.0} s are rendered at once; split the log")))
}

fn start_recorder(
    options: &Options,
    outputs: &mut Outputs,
    rate_hz: f64,
    duration_s: f64,
) -> Result<Recorder, CliError> {
    let mut recorder = Recorder::new(rate_hz);
    if options.trace {
        let path = with_suffix(&options.output, "trace.csv");
        recorder.trace(outputs.create(&path)?).map_err(|error| CliError::write(&path, &error))?;
    }
    if options.force {
        if options.force_rate > rate_hz {
            let what = format!("{} Hz is above the sample rate", options.force_rate);
            return Err(CliError::new("--force-rate", what, format!("must be at most {rate_hz} Hz")));
        }
        let path = with_suffix(&options.output, "force.csv");
        recorder
            .force(outputs.create(&path)?, options.force_rate)
            .map_err(|error| CliError::write(&path, &error))?;
    }
    if options.plot {
        recorder.curves();
    }
    if options.trace || options.force || options.plot || duration_s > LONG_S {
        recorder.progress((duration_s * rate_hz) as u64);
    }
    Ok(recorder)
}

type Played = (Render, Vec<ContactCurve>, Duration);

fn play(
    built: Engine,
    log: &ContactLog,
    file: &SceneFile,
    options: &Options,
    mut recorder: Recorder,
) -> Result<Played, CliError> {
    let settings = offline::Options {
        block_frames: usize::from(options.block),
        tail_s: file.tail_s,
        clock_s: Some(crate::measure::seconds),
    };
    let Engine { scene, renderer, names, .. } = built;
    let at = |error| {
        let path = file.contacts.as_deref().unwrap_or(&file.path);
        CliError::from_error(error).within(path.display())
    };
    let render =
        offline::render_tapped(scene, renderer, log, &names, &settings, &mut recorder).map_err(at)?;
    let (curves, watching) =
        recorder.finish().map_err(|error| CliError::write(&with_suffix(&options.output, "…"), &error))?;
    let labelled = curves.into_iter().map(|(contact, curve)| {
        let surface = log.lines.iter().rev().find_map(|line| match &line.event {
            LogEvent::Begin { contact: begun, touching, .. }
                if *begun == contact.0 && line.t <= curve.start_s + 1e-3 =>
            {
                Some(touching.surface.as_str())
            }
            _ => None,
        });
        ContactCurve { label: format!("{} on {}", contact.0, surface.unwrap_or("?")), ..curve }
    });
    Ok((render, labelled.collect(), watching))
}

/// The engine promises finite samples; a promise that a WAV file depends on is checked.
fn check_finite(render: &Render) -> Result<(), CliError> {
    let channels = render.haptic.iter().chain(&render.audio).chain(&render.pickup);
    if channels.flatten().all(|sample| sample.is_finite()) {
        Ok(())
    } else {
        Err(CliError::new(
            "asperity",
            "the render holds samples that are not finite",
            "please report the scene",
        ))
    }
}

/// A surface's name as part of a file name.
fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || "-_. ".contains(c) { c } else { '_' }).collect()
}
