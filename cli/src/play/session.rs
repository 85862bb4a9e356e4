//! A scene played on a device: events go out a little ahead of the sound, each stamped with its
//! sample, so that what is heard is what `render` writes.

use super::Options;
use super::watch::Watch;
use crate::error::CliError;
use crate::output;
use crate::progress::Progress;
use crate::scene_log::{load_log, read_past};
use crate::shapes;
use asperity::Engine;
use asperity::files::contact_log::{ContactLog, LogError, Names};
use asperity::files::scene_file::SceneFile;
use asperity::live::channel_map::ChannelMap;
use asperity::live::device::{self, DeviceOptions, DeviceReport};
use asperity::load::Overrides;
use asperity::{ContactEvent, Refusal, Scene, Stats};
use asperity_surface::sand::SandWorker;
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// Lead of events over the sound, s; the player may sleep for so long unnoticed.
const LEAD_S: f64 = 0.25;
/// Interval at which the player looks for due events.
const STEP: Duration = Duration::from_millis(10);
/// A device that stands still for so long is given up.
const PATIENCE: Duration = Duration::from_secs(5);
/// Group delay of the 30 Hz path filter, s (Hasti §III-C).
const PATH_DELAY_S: f64 = 0.0075;

/// Summary printed at the end.
#[derive(Debug, Serialize)]
struct Summary {
    /// The device, or null where the scene was played silently.
    device: Option<String>,
    sample_rate_hz: f64,
    played_s: f64,
    callbacks: u64,
    callback_frames: u64,
    underruns: u64,
    haptic_underruns: u64,
    rebuilt: u64,
    load: f64,
    peak_load: f64,
    /// Block and device together, without the path filter.
    latency_s: f64,
    path_delay_s: f64,
    events: u64,
    late: u64,
    dropped: u64,
    interrupted: bool,
    /// Events refused, lost or left out, and reasons for silence.
    warnings: Vec<String>,
}

/// Prints every output device, or those of one host.
///
/// # Errors
/// When the host is not in this build; a machine without devices is not an error.
pub fn list(options: &Options) -> Result<(), CliError> {
    let devices = match &options.host {
        Some(host) => device::list_on(host).map_err(CliError::from_error)?,
        None => device::list(),
    };
    if devices.is_empty() {
        eprintln!("no sound card was found; connect one, or start the sound server");
    }
    for found in devices {
        let shape = match (found.channels, found.sample_rate_hz) {
            (0, _) | (_, 0) => String::new(),
            (channels, rate_hz) => format!("\t{channels} channels, {rate_hz} Hz"),
        };
        output::say(&format!("{}\t{}{shape}", found.id, found.name));
    }
    Ok(())
}

/// Plays.
///
/// # Errors
/// When an input is bad, a named device is not there, or it is lost and does not come back.
pub fn run(options: &Options) -> Result<(), CliError> {
    let (scene_path, channels) = scene_and_channels(options)?;
    let mut file = SceneFile::load(Path::new(&scene_path))?;
    let (log, unread) = load_log(&file)?;
    shapes::solve(&mut file)?;
    for place in &unread {
        eprintln!("warning: {}", read_past(place));
    }
    let device_options = DeviceOptions {
        host: options.host.clone(),
        device: options.device.clone(),
        haptic_device: options.haptic_device.clone(),
        channels,
        block_frames: options.block,
    };
    let named = options.host.is_some() || options.device.is_some() || options.haptic_device.is_some();
    let rate = match device::sample_rate_hz(&device_options) {
        Ok(rate) => Some(rate),
        Err(error) if named => return Err(CliError::from_error(error)),
        Err(_) => None,
    };
    let overrides = Overrides { sample_rate_hz: rate, live: true, ..Overrides::default() };
    let built = Engine::from_scene(&file, &overrides)?;
    built.remarks.iter().for_each(|remark| eprintln!("warning: {remark}"));
    let watch = options.watch.then(|| Watch::new(file.clone(), overrides));
    let summary = play(built, &log, &file, &device_options, watch)?;
    output::say_report(&summary, options.json, || in_words(&summary))
}

/// `--channels` takes one or two values and may have swallowed the scene that follows it.
fn scene_and_channels(options: &Options) -> Result<(std::path::PathBuf, Option<ChannelMap>), CliError> {
    let mut parts = options.channels.clone();
    let mut scene = options.scene.clone();
    if scene.is_none() && parts.len() > 1 {
        scene = parts.pop().map(Into::into);
    }
    let scene = scene.ok_or_else(|| CliError::new("SCENE.toml", "is missing", "name a scene file"))?;
    let text = parts.join(" ");
    let map =
        (!parts.is_empty()).then(|| ChannelMap::parse(&text)).transpose().map_err(CliError::from_error)?;
    Ok((scene, map))
}

fn play(
    built: Engine,
    log: &ContactLog,
    file: &SceneFile,
    options: &DeviceOptions,
    watch: Option<Watch<'_>>,
) -> Result<Summary, CliError> {
    let Engine { mut scene, renderer, names, workers, .. } = built;
    let mut sand: Vec<_> = workers.into_iter().map(SandWorker::spawn).collect();
    let rate_hz = renderer.sample_rate_hz();
    let latency_samples = renderer.latency_samples();
    let events = log
        .lines
        .iter()
        .map(|line| Ok((line.t, line.event.resolve(&names)?)))
        .collect::<Result<Vec<_>, LogError>>()
        .map_err(|error| CliError::from_error(error).within(log_name(file)))?;
    let mut feed = Feed { events: &events, next: 0, rate_hz };
    feed.send(&mut scene);
    let interrupted = watch_for_interrupt();
    let player = device::play_on(renderer, options).map_err(CliError::from_error)?;
    if let Some(why) = player.silent_because() {
        eprintln!("warning: playing silently: {why}");
    }
    let mut live = Live { names, watch, ends_s: log.end_s(), tail_s: file.tail_s, latency_samples };
    let outcome = follow(&mut scene, &mut feed, &mut live, &interrupted);
    sand.extend(live.watch.into_iter().flat_map(|watch| watch.sand));
    let heard_on = player.silent_because().is_none().then(|| player.device().to_owned());
    let (stats, why_silent) = (scene.stats(), scene.why_silent());
    let report = player.stop();
    for thread in sand {
        let _ = thread.stop();
    }
    outcome?;
    let warnings = why_silent.iter().map(ToString::to_string).collect();
    let summary = summary(heard_on, rate_hz, latency_samples, &stats, &report, interrupted.load(Relaxed));
    Ok(Summary { warnings, ..summary })
}

fn log_name(file: &SceneFile) -> String {
    file.contacts.as_deref().unwrap_or(&file.path).display().to_string()
}

/// The events that are still to be sent.
struct Feed<'a> {
    events: &'a [(f64, ContactEvent)],
    next: usize,
    rate_hz: f64,
}

impl Feed<'_> {
    /// Sends what is due within [`LEAD_S`]; what the queue has no room for waits for the next call.
    fn send(&mut self, scene: &mut Scene) {
        let until_s = scene.stats().position as f64 / self.rate_hz + LEAD_S;
        while let Some((time_s, event)) = self.events.get(self.next).filter(|(time_s, _)| *time_s <= until_s)
        {
            match scene.report(*time_s, *event) {
                Err(refused) if refused.reason == Refusal::QueueFull => return,
                // Other refusals are counted by the scene; the rest of the log still plays.
                _ => self.next += 1,
            }
        }
    }
}

/// Parts that may change while it plays.
struct Live<'a> {
    names: Names,
    watch: Option<Watch<'a>>,
    /// Time of the last event, s.
    ends_s: f64,
    tail_s: f64,
    latency_samples: usize,
}

impl Live<'_> {
    /// One past the last sample to play.
    fn end(&self, rate_hz: f64) -> u64 {
        ((self.ends_s + self.tail_s) * rate_hz).ceil() as u64 + self.latency_samples as u64
    }

    /// Applies what has changed in the scene file.
    fn look(&mut self, scene: &mut Scene) {
        let Some(watch) = &mut self.watch else { return };
        for line in watch.look(scene, &mut self.names) {
            eprintln!("{line}");
        }
        self.tail_s = watch.file.tail_s;
    }
}

/// Feeds the engine until everything is played, the user has had enough, or the device stays away.
fn follow(
    scene: &mut Scene,
    feed: &mut Feed<'_>,
    live: &mut Live<'_>,
    interrupted: &AtomicBool,
) -> Result<(), CliError> {
    let mut progress = Progress::new("playing", live.end(feed.rate_hz));
    let (mut position, mut moved) = (scene.stats().position, Instant::now());
    while position < live.end(feed.rate_hz) && !interrupted.load(Relaxed) {
        feed.send(scene);
        live.look(scene);
        std::thread::sleep(STEP);
        let now = scene.stats().position;
        progress.advance(now - position);
        if now > position {
            (position, moved) = (now, Instant::now());
        } else if moved.elapsed() > PATIENCE {
            let what = format!("stands still for {} s", PATIENCE.as_secs());
            let right = "check the cable or the sound server, or choose another one with --device";
            return Err(CliError::new("device", what, right));
        }
    }
    Ok(())
}

/// Ctrl-C ends the session like its last event does. Without a handler it ends the program at once.
fn watch_for_interrupt() -> Arc<AtomicBool> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let seen = interrupted.clone();
    let _ = ctrlc::set_handler(move || seen.store(true, Relaxed));
    interrupted
}

fn summary(
    device: Option<String>,
    rate_hz: f64,
    latency_samples: usize,
    stats: &Stats,
    report: &DeviceReport,
    interrupted: bool,
) -> Summary {
    Summary {
        device,
        sample_rate_hz: rate_hz,
        played_s: stats.position as f64 / rate_hz,
        callbacks: report.callbacks,
        callback_frames: report.callback_frames,
        underruns: report.underruns,
        haptic_underruns: report.haptic_underruns,
        rebuilt: report.rebuilt,
        load: report.mean_load,
        peak_load: report.peak_load,
        latency_s: (report.callback_frames as f64 + latency_samples as f64) / rate_hz + report.latency_s,
        path_delay_s: PATH_DELAY_S,
        events: stats.events,
        late: stats.late,
        dropped: stats.dropped,
        interrupted,
        warnings: Vec::new(),
    }
}

fn in_words(summary: &Summary) -> String {
    format!(
        "{} {:.1} s on {} at {} Hz, blocks of {} frames\n{} underruns, {} haptic underruns, stream built anew {} times; \
         load {:.1} %, at most {:.1} %; latency {:.1} ms and {:.1} ms of the path filter; {} events, {} late, {} dropped{}",
        if summary.interrupted { "stopped after" } else { "played" },
        summary.played_s,
        summary.device.as_deref().unwrap_or("no device"),
        summary.sample_rate_hz,
        summary.callback_frames,
        summary.underruns,
        summary.haptic_underruns,
        summary.rebuilt,
        100.0 * summary.load,
        100.0 * summary.peak_load,
        1e3 * summary.latency_s,
        1e3 * summary.path_delay_s,
        summary.events,
        summary.late,
        summary.dropped,
        output::warned(&summary.warnings)
    )
}
