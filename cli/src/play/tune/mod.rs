//! `asperity play SCENE.toml --tune`: the scene sounds, again and again, and a page on the loopback
//! address turns its numbers.
//!
//! What is turned is applied to what sounds, as `--watch` does; nothing is written until the page
//! says so, and then only what was turned: comments and everything else in the file stay. A finger
//! on the page touches the scene too. Without a sound card a thread renders in real time, unheard.

mod desk;
mod document;

use super::Options;
use crate::error::CliError;
use crate::output;
use crate::scene_log::load_log;
use crate::shapes;
use asperity::files::contact_log::{ContactLog, Names};
use asperity::files::scene_file::SceneFile;
#[cfg(not(feature = "device"))]
use asperity::live::channel_map::{ChannelMap, Interleaver};
#[cfg(feature = "device")]
use asperity::live::device::{self, DeviceOptions, Player};
#[cfg(not(feature = "device"))]
use asperity::live::null_sink::NullSink;
use asperity::load::Overrides;
use asperity::{ContactEvent, Engine, Refusal, Renderer, Scene};
use asperity_surface::sand::{SandThread, SandWorker};
use desk::Desk;
use document::Document;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Lead of events over the sound, s: those of the log as those of a finger on the page, because a
/// scene takes them in order of time.
const LEAD_S: f64 = 0.06;
/// Interval at which the page is read.
const STEP: Duration = Duration::from_millis(5);
/// Frames of a silent block.
#[cfg(not(feature = "device"))]
const BLOCK_FRAMES: usize = 256;

/// A scene that sounds and is turned.
struct Tuned<'a> {
    path: PathBuf,
    /// The file as it was read or kept last, and as it is now.
    kept: String,
    document: Document,
    file: SceneFile,
    overrides: Overrides<'a>,
    scene: Scene,
    names: Names,
    sand: Vec<SandThread>,
    rate_hz: f64,
    heard: String,
    log: Log,
    /// Time of the newest event, s.
    latest_s: f64,
    /// Engine time minus the page's clock, s, of the finger that touches.
    touch_offset_s: Option<f64>,
    /// Last messages: what changed, what waits.
    said: Vec<String>,
}

/// The scene's contact log, played over and over.
struct Log {
    lines: ContactLog,
    next: usize,
    begins_s: f64,
    ends_s: f64,
    plays: bool,
}

/// Plays and serves until ended.
///
/// # Errors
/// When an input is bad, the port is taken, or the device does not start.
pub fn run(options: &Options) -> Result<(), CliError> {
    let path = options
        .scene
        .clone()
        .ok_or_else(|| CliError::new("SCENE.toml", "is missing", "name a scene file"))?;
    let kept = std::fs::read_to_string(&path).map_err(|error| CliError::read(&path, &error))?;
    let document = Document::parse(&kept, &path)?;
    let mut file = SceneFile::parse(&kept, &path)?;
    shapes::solve(&mut file)?;
    let log = if file.contacts.is_some() { load_log(&file)?.0 } else { ContactLog::default() };
    let overrides = Overrides { live: true, sample_rate_hz: rate(), ..Overrides::default() };
    let Engine { scene, renderer, names, workers, .. } = Engine::from_scene(&file, &overrides)?;
    let rate_hz = renderer.sample_rate_hz();
    let ends_s = log.end_s() + file.tail_s;
    let desk = Desk::open(options.port)?;
    let sounding = Sounding::start(renderer)?;
    let plays = !log.lines.is_empty();
    let mut tuned = Tuned {
        path,
        kept,
        document,
        file,
        overrides,
        scene,
        names,
        sand: workers.into_iter().map(SandWorker::spawn).collect(),
        rate_hz,
        heard: sounding.heard(),
        log: Log { lines: log, next: 0, begins_s: 0.0, ends_s, plays },
        latest_s: 0.0,
        touch_offset_s: None,
        said: Vec::new(),
    };
    output::say(&format!("tune it at {} until ended (Ctrl-C); {}", desk.address(), tuned.heard));
    while desk.answer(&mut tuned) {
        tuned.play();
        std::thread::sleep(STEP);
    }
    drop(sounding);
    for thread in tuned.sand {
        let _ = thread.stop();
    }
    Ok(())
}

impl Tuned<'_> {
    fn position_s(&self) -> f64 {
        self.scene.stats().position as f64 / self.rate_hz
    }

    /// Sends what of the log is due, and begins it anew when it is over.
    fn play(&mut self) {
        let now_s = self.position_s();
        if !self.log.plays {
            return;
        }
        if now_s > self.log.begins_s + self.log.ends_s {
            (self.log.begins_s, self.log.next) = (now_s + LEAD_S, 0);
        }
        while let Some(line) = self.log.lines.lines.get(self.log.next) {
            let time_s = self.log.begins_s + line.t;
            if time_s > now_s + LEAD_S {
                return;
            }
            // What names a thing that the scene no longer has is passed over.
            if let Ok(event) = line.event.resolve(&self.names)
                && full(self.report(time_s, event))
            {
                return;
            }
            self.log.next += 1;
        }
    }

    /// Lines of a contact log from a finger on the page, by its clock.
    fn touch(&mut self, lines: &str) -> Result<(), CliError> {
        let log = ContactLog::parse(lines, "touch").map_err(CliError::from_error)?;
        let now_s = self.position_s();
        for line in &log.lines {
            let event: ContactEvent = line.event.resolve(&self.names).map_err(CliError::from_error)?;
            let fresh = now_s + LEAD_S - line.t;
            let offset_s = self.touch_offset_s.filter(|known| (known - fresh).abs() < 0.2).unwrap_or(fresh);
            self.touch_offset_s = Some(offset_s);
            let time_s = (line.t + offset_s).max(now_s);
            self.report(time_s, event).map_err(CliError::from_error)?;
        }
        Ok(())
    }

    /// Reports an event, at the time of the last one at the earliest: the log and a finger take
    /// turns, and neither's stamps wait for the other's. (Asked first, the scene would refuse the
    /// later one, and report that it was lost.)
    fn report(&mut self, time_s: f64, event: ContactEvent) -> Result<(), Refusal> {
        let time_s = time_s.max(self.latest_s);
        self.scene.report(time_s, event).map_err(|refused| refused.reason)?;
        self.latest_s = time_s;
        Ok(())
    }

    /// Makes what sounds what `document` says; where that cannot be, all stays as it was.
    fn apply(&mut self, document: Document) -> Result<(), CliError> {
        let mut after = SceneFile::parse(&document.text(), &self.path)?;
        shapes::solve(&mut after)?;
        let changes = self.scene.apply(&mut self.names, &self.file, &after, &self.overrides)?;
        self.sand.extend(changes.workers.into_iter().map(SandWorker::spawn));
        self.log.ends_s = self.log.lines.end_s() + after.tail_s;
        (self.file, self.document) = (after, document);
        self.said = changes.done.into_iter().chain(changes.waiting).collect();
        Ok(())
    }

    fn set(&mut self, path: &str, key: &str, numbers: &[f64]) -> Result<(), CliError> {
        let mut document = self.document.clone();
        document.set(path, key, numbers)?;
        self.apply(document)
    }

    /// Back to what the file says.
    fn revert(&mut self) -> Result<(), CliError> {
        let text = std::fs::read_to_string(&self.path).map_err(|error| CliError::read(&self.path, &error))?;
        self.apply(Document::parse(&text, &self.path)?)?;
        self.kept = text;
        Ok(())
    }

    /// Writes the file; one that somebody else has written meanwhile is not written over.
    fn keep(&mut self) -> Result<(), CliError> {
        let on_disk =
            std::fs::read_to_string(&self.path).map_err(|error| CliError::read(&self.path, &error))?;
        if on_disk != self.kept {
            let right = "take the file as it is now (Revert), and turn again";
            return Err(CliError::file(&self.path, "was written by somebody else meanwhile", right));
        }
        let text = self.document.text();
        // The scene is read, and written back on purpose.
        output::clear_reads();
        let mut outputs = output::Outputs::new();
        outputs.write(&self.path, text.as_bytes())?;
        outputs.commit()?;
        self.kept = text;
        Ok(())
    }

    fn is_changed(&self) -> bool {
        self.document.text() != self.kept
    }

    fn name(&self) -> String {
        self.path.file_name().unwrap_or(Path::new("scene").as_os_str()).to_string_lossy().into_owned()
    }
}

/// Tests whether the queue had no room; other refusals are counted by the scene.
fn full(reported: Result<(), Refusal>) -> bool {
    reported == Err(Refusal::QueueFull)
}

/// Renderer.
#[cfg(feature = "device")]
struct Sounding(Player);
#[cfg(not(feature = "device"))]
struct Sounding {
    _sink: NullSink,
}

#[cfg(feature = "device")]
impl Sounding {
    fn start(renderer: Renderer) -> Result<Self, CliError> {
        device::play_on(renderer, &DeviceOptions::default()).map(Self).map_err(CliError::from_error)
    }

    fn heard(&self) -> String {
        match self.0.silent_because() {
            Some(why) => format!("silent: {why}"),
            None => format!("heard on {}", self.0.device()),
        }
    }
}

#[cfg(not(feature = "device"))]
impl Sounding {
    fn start(renderer: Renderer) -> Result<Self, CliError> {
        let map = ChannelMap::stereo_then_haptics(renderer.haptic_channels());
        let sink = NullSink::start(Interleaver::new(renderer, map), BLOCK_FRAMES).map_err(|error| {
            CliError::new("play", format!("no thread to render on ({error})"), "end other programs")
        })?;
        Ok(Self { _sink: sink })
    }

    fn heard(&self) -> String {
        "silent: this program was built without sound card support (cargo feature device)".to_owned()
    }
}

#[cfg(feature = "device")]
fn rate() -> Option<f64> {
    device::sample_rate_hz(&DeviceOptions::default()).ok()
}

#[cfg(not(feature = "device"))]
fn rate() -> Option<f64> {
    None
}
