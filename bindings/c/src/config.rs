//! Config: how an engine is built.

use crate::entry::{enter, out};
use crate::handles::{AudioHalf, RENDERERS, SCENES, SceneHalf, asp_renderer, asp_scene};
use crate::pickup::{self, ASP_MAX_PICKUPS};
use crate::sized::{self, sized};
use crate::status::{ASP_REFUSED, Failure};
use crate::text;
use asperity::{ActuatorSettings, AudioBus, ClockMode, Config, Engine, Isa};
use std::ffi::c_char;

/// Game seconds follow the device through pauses, restarts, slow motion and bursts of ticks: for a
/// game that runs now.
pub const ASP_CLOCK_LIVE: u32 = 0;
/// Sample = seconds times rate: for renders and replays.
pub const ASP_CLOCK_EXACT: u32 = 1;
/// As the text `more` says.
pub const ASP_CLOCK_MORE: u32 = 2;

/// The fastest instruction set of this processor.
pub const ASP_KERNEL_BEST: u32 = 0;
/// Kernel with equal bits on every processor.
pub const ASP_KERNEL_PORTABLE: u32 = 1;

/// Longest stretch rendered at once, frames; longer calls are split, which does not change a bit.
pub(crate) const CHUNK_FRAMES: usize = 512;
/// Most haptic channels of an engine that is built or loaded here.
pub const ASP_MAX_CHANNELS: u32 = 64;
/// Most audio buses of an engine.
pub const ASP_MAX_BUSES: u32 = 64;

/// Settings of a new engine; `asp_config_init` fills it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_config {
    /// Size of this struct, bytes.
    pub struct_size: u32,
    /// ASP_CLOCK_…; the device's unless said.
    pub clock: u32,
    /// Rate of every output, Hz, 8000 to 384000; 0 = as `more` or the scene file says, else 44100.
    pub sample_rate_hz: f64,
    /// Seed of the micro-noise; 0 = as `more` or the scene file says, else 1.
    pub seed: u64,
    /// Haptic channels, 1 to 64; 0 = as `more` or the scene file says, else one of 0.1 mm at full
    /// scale.
    pub haptic_channels: u32,
    /// Audio buses, 1 to 64; 0 = as `more` or the scene file says, else one.
    pub audio_buses: u32,
    /// ASP_KERNEL_…
    pub kernel: u32,
    /// Channels of pickups in SI units, 1 to 64; 0 = as `more` or the scene file says, else none.
    /// (Since 0.1.6; before, a 0 that was reserved.)
    pub pickup_channels: u32,
    /// Everything else as TOML or JSON, for instance "max_contacts = 128"; NULL = the engine's
    /// defaults. The fields above count more. Not beside a scene file, which says these things
    /// itself.
    pub more: *const c_char,
}

sized!(asp_config);

impl asp_config {
    pub(crate) fn is_live(&self) -> Result<bool, Failure> {
        match self.clock {
            ASP_CLOCK_LIVE => Ok(true),
            ASP_CLOCK_EXACT | ASP_CLOCK_MORE => Ok(false),
            other => Err(refuse("clock", other, "must be ASP_CLOCK_LIVE, ASP_CLOCK_EXACT or ASP_CLOCK_MORE")),
        }
    }

    pub(crate) fn isa(&self) -> Result<Option<Isa>, Failure> {
        match self.kernel {
            ASP_KERNEL_BEST => Ok(None),
            ASP_KERNEL_PORTABLE => Ok(Some(Isa::Portable)),
            other => Err(refuse("kernel", other, "must be ASP_KERNEL_BEST or ASP_KERNEL_PORTABLE")),
        }
    }

    fn engines(&self) -> Result<Config, FileOr> {
        let more = text::optional(self.more, "more")?;
        let mut config = more.map_or_else(|| Ok(Config::default()), Config::parse)?;
        if self.is_live()? {
            config.clock = ClockMode::LIVE;
        } else if self.clock == ASP_CLOCK_EXACT {
            config.clock = ClockMode::Exact;
        }
        if self.sample_rate_hz != 0.0 {
            config.sample_rate_hz = self.sample_rate_hz;
        }
        if self.seed != 0 {
            config.seed = self.seed;
        }
        if self.haptic_channels != 0 {
            let count = within("haptic_channels", self.haptic_channels as usize, ASP_MAX_CHANNELS)?;
            config.actuators.resize(count, ActuatorSettings::default());
        }
        if self.audio_buses != 0 {
            let count = within("audio_buses", self.audio_buses as usize, ASP_MAX_BUSES)?;
            config.audio.resize(count, AudioBus::default());
        }
        if self.pickup_channels != 0 {
            let count = within("pickup_channels", self.pickup_channels as usize, ASP_MAX_PICKUPS)?;
            config.pickups.resize(count, None);
        }
        within("pickups", config.pickups.len(), ASP_MAX_PICKUPS)?;
        config.kernel = self.isa()?.or(config.kernel);
        within("actuators", config.actuators.len(), ASP_MAX_CHANNELS)?;
        Ok(config)
    }
}

/// Either error, so that `?` takes both.
struct FileOr(Failure);

impl From<Failure> for FileOr {
    fn from(failure: Failure) -> Self {
        Self(failure)
    }
}

impl From<asperity::files::FileError> for FileOr {
    fn from(error: asperity::files::FileError) -> Self {
        Self(Failure::new(ASP_REFUSED, error))
    }
}

fn refuse(field: &str, value: impl std::fmt::Display, right: &str) -> Failure {
    Failure::new(ASP_REFUSED, format!("{field}: {value} is refused; {right}"))
}

pub(crate) fn within(field: &str, count: usize, most: u32) -> Result<usize, Failure> {
    if count <= most as usize {
        return Ok(count);
    }
    Err(refuse(field, count, &format!("must be at most {most} in the C library")))
}

/// Gives both halves of an engine their handles.
pub(crate) fn hand_out(
    half: SceneHalf,
    renderer: asperity::Renderer,
    scene: &mut *mut asp_scene,
    place: &mut *mut asp_renderer,
) -> Result<(), Failure> {
    let memory = |count: usize| vec![vec![0.0; CHUNK_FRAMES]; count];
    let (haptic, audio) = (memory(renderer.haptic_channels()), memory(renderer.audio_buses()));
    let pickups = pickup::memory(&renderer);
    let audio =
        RENDERERS.insert(AudioHalf { renderer: Some(renderer), haptic, audio, pickups, tick: None })?;
    match SCENES.insert(half) {
        Ok(handle) => {
            (*scene, *place) = (handle as *mut asp_scene, audio as *mut asp_renderer);
            Ok(())
        }
        Err(full) => {
            drop(RENDERERS.remove(audio));
            Err(full)
        }
    }
}

/// Fills a config with its size and the defaults: a live clock, one haptic channel, one bus.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_config_init(config: *mut asp_config) {
    sized::init(config);
}

/// Builds an engine: one half for the game's thread, one for the audio thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_build(
    config: *const asp_config,
    scene: *mut *mut asp_scene,
    renderer: *mut *mut asp_renderer,
) -> i32 {
    enter(|| {
        let config = sized::read(config, "config")?;
        let (scene, renderer) = (out(scene, "scene")?, out(renderer, "renderer")?);
        (*scene, *renderer) = (std::ptr::null_mut(), std::ptr::null_mut());
        let live = config.is_live()?;
        let built = config.engines().map_err(|FileOr(failure)| failure)?.build();
        let built = built.map_err(|error| Failure::new(ASP_REFUSED, error))?;
        let Engine { scene: game, renderer: audio, names, .. } = built;
        hand_out(SceneHalf { scene: game, names, sand: Vec::new(), live }, audio, scene, renderer)
    })
}
