//! Rendering a contact log without a device: the same two halves, the same events, to memory or
//! WAV.

pub mod silence;

use crate::audio::renderer::Renderer;
use crate::files::contact_log::{ContactLog, LogError, LogEvent, LogLine, Names};
use crate::files::wav::write_wav;
use crate::game::scene::Scene;
use crate::game::silence::SilenceReason;
use crate::link::stats::Stats;
use crate::link::tap::{NoTap, Tap};
use crate::make::edit::Edits;
use crate::model::error::ReportError;
use crate::model::id::SurfaceId;
use crate::model::stamp::Stamp;
use asperity_surface::sand::{SandFigures, SandPicture};
use std::borrow::Cow;
use std::path::Path;
use std::time::Duration;

/// Options of a render.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// Frames a block; the result does not depend on it. What lies outside 1–4096 counts as the
    /// nearer of the two.
    pub block_frames: usize,
    /// Time for bodies to ring after the last event, s.
    pub tail_s: f64,
    /// Reads a clock, s, so that [`Render::processing`] is known; nothing here reads one by itself.
    pub clock_s: Option<fn() -> f64>,
}

impl Default for Options {
    fn default() -> Self {
        Self { block_frames: 256, tail_s: 1.0, clock_s: None }
    }
}

/// A finished render. Sample 0 is game time 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Render {
    /// Rate of every channel, Hz.
    pub sample_rate_hz: f64,
    /// One channel an audio bus, in order.
    pub audio: Vec<Vec<f32>>,
    /// One channel an actuator, in order.
    pub haptic: Vec<Vec<f32>>,
    /// One channel of [pickups](crate::Config::pickups), in order: SI units, or volts of its
    /// sensor.
    pub pickup: Vec<Vec<f32>>,
    /// Statistics.
    pub stats: Stats,
    /// The first event that was refused, and its game time, s.
    pub first_refused: Option<(f64, ReportError)>,
    /// Reasons against anything being heard or felt ([`Scene::why_silent`]).
    pub why_silent: Vec<SilenceReason>,
    /// Surfaces of sand as they lie after the last contact, settled.
    pub sand: Vec<SandAfter>,
    /// By how much the peak limiters have turned down at most, dB.
    pub limiter_db: f64,
    /// Time spent in the renderer alone; zero without [`Options::clock_s`].
    pub processing: Duration,
}

/// A surface of sand after a render.
#[derive(Debug, Clone, PartialEq)]
pub struct SandAfter {
    /// Which surface.
    pub surface: SurfaceId,
    /// Volume before and after, steepest slope.
    pub figures: SandFigures,
    /// Its height as a 16-bit picture.
    pub picture: SandPicture,
}

/// Renders a log.
///
/// ```
/// use asperity::files::contact_log::ContactLog;
/// use asperity::offline::{self, Options};
/// use asperity::{Body, Config, Engine, Material, Stock};
///
/// let Engine { mut scene, renderer, mut names, .. } = Config::default().build()?;
/// names.bodies.insert("bell".into(), scene.add_body(Body::stock(Stock::Bowl, Material::BRASS, 0.1)?)?);
/// let log = r#"{"t":0.1,"event":"impact","body":"bell","speed_m_s":0.8,"mass_kg":0.01,"radius_m":0.005,"striker":"wood"}"#;
/// let log = ContactLog::parse(log, "bell.jsonl")?;
/// let take = offline::render(scene, renderer, &log, &names, &Options::default())?;
/// // A tenth of a second before the blow, a second to ring out.
/// assert!(take.stats.impacts == 1 && take.audio[0].len() >= 48_510);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Events with bad numbers are left out and counted in
/// [`Stats::refused`](crate::Stats::refused); the first is in [`Render::first_refused`].
///
/// # Errors
/// When the log names a surface, body or striker that is not in `names`.
pub fn render(
    scene: Scene,
    renderer: Renderer,
    log: &ContactLog,
    names: &Names,
    options: &Options,
) -> Result<Render, LogError> {
    render_tapped(scene, renderer, log, names, options, &mut NoTap)
}

/// [`render`], with a view into every contact.
///
/// # Errors
/// As [`render`], and [`LogError::Stopped`] when the tap [does not go on](Tap::goes_on).
pub fn render_tapped(
    scene: Scene,
    renderer: Renderer,
    log: &ContactLog,
    names: &Names,
    options: &Options,
    tap: &mut dyn Tap,
) -> Result<Render, LogError> {
    render_edited(scene, renderer, log, names, options, &mut Edits::default(), tap)
}

/// [`render_tapped`] of a recording that holds edits of the scene, made with what `edits` has.
/// Without, they are made from the disk, and of nobody's own sources and surfaces.
///
/// # Errors
/// As [`render`], and when an edit cannot be made.
pub fn render_edited(
    scene: Scene,
    renderer: Renderer,
    log: &ContactLog,
    names: &Names,
    options: &Options,
    edits: &mut Edits<'_>,
    tap: &mut dyn Tap,
) -> Result<Render, LogError> {
    let (rate, inner_rate) = (renderer.sample_rate_hz(), renderer.inner_rate_hz());
    let every = (inner_rate / rate).round() as u64;
    let frames = ((log.heard_s() + options.tail_s.max(0.0)) * rate).ceil() as usize;
    // What is misnamed is reported before anything is rendered, unless an edit may bring it.
    log.check_names(names)?;
    let mut names = names.clone();
    let mut take = Take::new(scene, renderer, frames, options);
    for (index, line) in log.lines.iter().enumerate() {
        let LogLine { t, event } = line;
        if take.stopped {
            break;
        }
        let sample = Stamp::at(take.scene.clock.sample_at(*t)).sample() / every;
        if let LogEvent::Edit(edit) = event {
            // It was made at this sample, behind what was reported before.
            take.render_to(sample, tap);
            edits
                .make(edit, &mut take.scene, &mut names, *t)
                .map_err(|problem| LogError::CannotEdit { t: *t, problem })?;
            continue;
        }
        let event = event.resolve(&names).map_err(|problem| line.in_log(index, problem))?;
        take.make_room(sample, tap);
        // Refusals are counted by the scene; the rest of the log still renders.
        if let Err(refused) = take.scene.report(*t, event) {
            take.first_refused.get_or_insert((*t, refused));
        }
    }
    take.render_to(u64::MAX, tap);
    if take.stopped { Err(LogError::Stopped) } else { Ok(take.finish()) }
}

/// A render in progress.
struct Take {
    scene: Scene,
    renderer: Renderer,
    block_frames: usize,
    clock_s: Option<fn() -> f64>,
    /// The tap wanted no more.
    stopped: bool,
    /// One past the last sample to render, the latency included.
    end: u64,
    audio: Vec<Vec<f32>>,
    haptic: Vec<Vec<f32>>,
    pickup: Vec<Vec<f32>>,
    processing: Duration,
    first_refused: Option<(f64, ReportError)>,
}

impl Take {
    fn new(scene: Scene, renderer: Renderer, frames: usize, options: &Options) -> Self {
        let total = frames + renderer.latency_samples();
        let haptic = vec![vec![0.0; total]; renderer.haptic_channels()];
        Self {
            scene,
            block_frames: options.block_frames.clamp(1, 4096),
            clock_s: options.clock_s,
            stopped: false,
            end: total as u64,
            audio: vec![vec![0.0; total]; renderer.audio_buses()],
            haptic,
            pickup: vec![vec![0.0; total]; renderer.pickup_channels()],
            processing: Duration::ZERO,
            first_refused: None,
            renderer,
        }
    }

    /// Renders whole blocks that no coming event can touch, and more when the queue runs full.
    /// Where the queue is flushed does not change the result, because every event carries its
    /// sample.
    fn make_room(&mut self, next_event: u64, tap: &mut dyn Tap) {
        let fits = |take: &Self| {
            let ahead = next_event.saturating_sub(take.renderer.game_position()) as usize;
            take.renderer.frames_within(ahead).min(take.left()) >= take.block_frames
        };
        while !self.stopped && fits(self) {
            self.render_block(self.block_frames, tap);
        }
        if self.scene.is_filling() {
            self.render_to(next_event.max(self.renderer.game_position() + 1), tap);
        }
    }

    /// Samples that are left of the render.
    fn left(&self) -> usize {
        (self.end - self.renderer.position()) as usize
    }

    /// Renders until the game's time is there, or the render ends.
    fn render_to(&mut self, game_sample: u64, tap: &mut dyn Tap) {
        while !self.stopped && self.left() > 0 && self.renderer.game_position() < game_sample {
            let ahead = game_sample - self.renderer.game_position();
            let ahead = ahead.min(4 * self.block_frames as u64 + 512) as usize;
            let frames = self.renderer.frames_within(ahead).max(1);
            self.render_block(frames.min(self.block_frames).min(self.left()), tap);
        }
    }

    fn render_block(&mut self, frames: usize, tap: &mut dyn Tap) {
        self.stopped = !tap.goes_on(self.renderer.position(), self.end);
        if self.stopped {
            return;
        }
        let at = self.renderer.position() as usize;
        let range = at..at + frames;
        let mut haptic: Vec<_> = self.haptic.iter_mut().map(|channel| &mut channel[range.clone()]).collect();
        let mut audio: Vec<_> = self.audio.iter_mut().map(|bus| &mut bus[range.clone()]).collect();
        let mut pickup: Vec<_> = self.pickup.iter_mut().map(|channel| &mut channel[range.clone()]).collect();
        let began_s = self.clock_s.map(|clock_s| clock_s());
        self.renderer.render_all(&mut haptic, &mut audio, &mut pickup, tap);
        if let (Some(began_s), Some(clock_s)) = (began_s, self.clock_s) {
            self.processing += Duration::from_secs_f64((clock_s() - began_s).max(0.0));
        }
    }

    fn finish(mut self) -> Render {
        let latency = self.renderer.latency_samples();
        for channel in self.haptic.iter_mut().chain(&mut self.audio).chain(&mut self.pickup) {
            channel.drain(..latency);
        }
        let sand = self.renderer.finish().into_iter().filter_map(|(surface, result)| {
            let (figures, picture) = *result.downcast::<(SandFigures, SandPicture)>().ok()?;
            Some(SandAfter { surface, figures, picture })
        });
        Render {
            sample_rate_hz: self.renderer.sample_rate_hz(),
            audio: self.audio,
            haptic: self.haptic,
            pickup: self.pickup,
            stats: self.scene.stats(),
            first_refused: self.first_refused,
            why_silent: self.scene.why_silent(),
            sand: sand.collect(),
            limiter_db: self.renderer.limiter_db(),
            processing: self.processing,
        }
    }
}

impl Render {
    /// Duration, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.audio.first().map_or(0, Vec::len) as f64 / self.sample_rate_hz
    }

    /// The sum of all buses: what a single one would have carried, but for limiters.
    #[must_use]
    pub fn mix(&self) -> Cow<'_, [f32]> {
        match self.audio.as_slice() {
            [only] => Cow::Borrowed(only),
            buses => {
                let frames = buses.first().map_or(0, Vec::len);
                Cow::Owned((0..frames).map(|i| buses.iter().map(|bus| bus[i]).sum()).collect())
            }
        }
    }

    /// Seconds of signal per second of signal processing.
    #[must_use]
    pub fn real_time_factor(&self) -> f64 {
        self.duration_s() / self.processing.as_secs_f64().max(1e-9)
    }

    /// Writes the audio buses as one 32-bit float WAV file, a channel a bus.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write_audio_wav(&self, path: impl AsRef<Path>) -> Result<(), hound::Error> {
        let channels: Vec<_> = self.audio.iter().map(Vec::as_slice).collect();
        write_wav(path.as_ref(), &channels, self.sample_rate_hz)
    }

    /// Writes the haptic channels as one 32-bit float WAV file, in the order of the actuators.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write_haptic_wav(&self, path: impl AsRef<Path>) -> Result<(), hound::Error> {
        let channels: Vec<_> = self.haptic.iter().map(Vec::as_slice).collect();
        write_wav(path.as_ref(), &channels, self.sample_rate_hz)
    }
}
