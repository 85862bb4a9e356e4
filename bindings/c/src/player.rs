//! Player: an engine on a sound card of its own, for programs that have no audio callback to give.

use crate::entry::{array_mut, enter, out};
use crate::handles::{PLAYERS, RENDERERS, asp_player, asp_renderer};
use crate::playing::{Player, Playing};
use crate::sized::{self, sized};
use crate::status::{ASP_BAD_ARGUMENT, ASP_DEVICE, ASP_REFUSED, Failure};
use crate::text;
use asperity::Renderer;
use asperity::live::channel_map::{ChannelMap, Interleaver};
use asperity::live::null_sink::NullSink;
use std::ffi::c_char;

/// Settings of a player; `asp_player_config_init` fills it for the default device.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_player_config {
    /// Size of this struct, bytes.
    pub struct_size: u32,
    /// Not 0: play to nobody, in real time; works in every build and on every machine.
    pub silent: u32,
    /// Frames a block to ask for, 1 to 65536; 0 = the device's, or 256.
    pub block_frames: u32,
    /// 0.
    pub reserved: u32,
    /// Host by name ("alsa", "wasapi", "coreaudio", …); NULL = the system's.
    pub host: *const c_char,
    /// Device by its id; NULL = the default one.
    pub device: *const c_char,
    /// A second device for the haptic channels; NULL = none.
    pub haptic_device: *const c_char,
    /// Signals of its channels, for instance "audio=0,1 haptic=2,3"; NULL = just that.
    pub channels: *const c_char,
}

sized!(asp_player_config);

/// Report of a player; `asp_player_report_init` fills in the size.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_player_report {
    /// Size of this struct, bytes.
    pub struct_size: u32,
    /// Not 0: it plays to nobody.
    pub silent: u32,
    /// Callbacks, or blocks, so far.
    pub callbacks: u64,
    /// Glitches that the device reported, or blocks that were late.
    pub underruns: u64,
    /// Times the stream was built anew after the device was lost.
    pub rebuilt: u64,
    /// From callback to ear or skin, s, as the device tells.
    pub latency_s: f64,
    /// Mean share of the time that rendering took.
    pub mean_load: f64,
    /// Longest share of a callback's time.
    pub peak_load: f64,
}

sized!(asp_player_report);

/// A config whose texts have been read.
struct Wanted<'a> {
    block_frames: Option<u32>,
    host: Option<&'a str>,
    device: Option<&'a str>,
    haptic_device: Option<&'a str>,
    channels: Option<ChannelMap>,
}

impl asp_player_config {
    fn wanted<'a>(&self) -> Result<Wanted<'a>, Failure> {
        if self.block_frames > 65536 {
            let what = format!("block_frames: {} is refused", self.block_frames);
            return Err(Failure::new(ASP_BAD_ARGUMENT, format!("{what}; must be 0, or 1 to 65536")));
        }
        let channels = text::optional(self.channels, "channels")?.map(ChannelMap::parse).transpose();
        Ok(Wanted {
            block_frames: Some(self.block_frames).filter(|frames| *frames != 0),
            host: text::optional(self.host, "host")?,
            device: text::optional(self.device, "device")?,
            haptic_device: text::optional(self.haptic_device, "haptic_device")?,
            channels: channels.map_err(|error| Failure::new(ASP_REFUSED, error))?,
        })
    }
}

fn silent(renderer: Renderer, wanted: Wanted<'_>) -> Result<Playing, Failure> {
    let rate_hz = renderer.sample_rate_hz();
    let map = wanted.channels.unwrap_or(ChannelMap::stereo_then_haptics(renderer.haptic_channels()));
    let block_frames = wanted.block_frames.unwrap_or(256) as usize;
    let sink = NullSink::start(Interleaver::new(renderer, map), block_frames);
    let sink = sink.map_err(|error| {
        Failure::new(ASP_DEVICE, format!("player: no thread could be started ({error}); end some"))
    })?;
    Ok(Playing::Silent { sink, block_frames, rate_hz })
}

#[cfg(feature = "device")]
fn on_device(renderer: Renderer, wanted: Wanted<'_>) -> Result<Playing, Failure> {
    use asperity::live::device::{DeviceOptions, play_on};
    let options = DeviceOptions {
        host: wanted.host.map(Into::into),
        device: wanted.device.map(Into::into),
        haptic_device: wanted.haptic_device.map(Into::into),
        channels: wanted.channels,
        block_frames: wanted.block_frames,
    };
    play_on(renderer, &options).map(Playing::Device).map_err(|error| Failure::new(ASP_DEVICE, error))
}

/// Refuses where this build has no sound cards.
fn has_devices(wanted: &Wanted<'_>) -> Result<(), Failure> {
    if cfg!(feature = "device") {
        return Ok(());
    }
    let named = [wanted.host, wanted.device, wanted.haptic_device].into_iter().flatten().next();
    let what = format!(
        "device: {} is out of reach, this library was built without sound cards",
        named.unwrap_or("the default one")
    );
    let right =
        "build it with the feature device, set silent = 1, or call asp_render from your own audio callback";
    Err(Failure::new(crate::status::ASP_UNSUPPORTED, format!("{what}; {right}")))
}

/// Fills a player's config with its size and the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_player_config_init(config: *mut asp_player_config) {
    sized::init(config);
}

/// Fills a report with its size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_player_report_init(report: *mut asp_player_report) {
    sized::init(report);
}

/// Plays until `asp_player_stop`. The renderer belongs to the player from then on: its handle ends,
/// also where the device refuses. Where a sentence is refused before (a map, a build without sound
/// cards) it stays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_play(
    renderer: *mut asp_renderer,
    config: *const asp_player_config,
    player: *mut *mut asp_player,
) -> i32 {
    enter(|| {
        let config: asp_player_config =
            if config.is_null() { sized::Sized32::initial() } else { sized::read(config, "config")? };
        let player = out(player, "player")?;
        *player = std::ptr::null_mut();
        let wanted = config.wanted()?;
        if config.silent == 0 {
            has_devices(&wanted)?;
        }
        let half = RENDERERS.remove(renderer as usize)?;
        let renderer = half.renderer.ok_or_else(|| {
            Failure::new(ASP_REFUSED, "renderer: has no engine any more; build another one")
        })?;
        #[cfg(feature = "device")]
        let playing = if config.silent == 0 { on_device(renderer, wanted) } else { silent(renderer, wanted) };
        #[cfg(not(feature = "device"))]
        let playing = silent(renderer, wanted);
        *player = PLAYERS.insert(Player::new(playing?))? as *mut asp_player;
        Ok(())
    })
}

/// Which device plays, or why nobody hears it. `size` is the room in `words`, bytes; what does not
/// fit is cut.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_player_device(player: *mut asp_player, words: *mut c_char, size: u32) -> i32 {
    enter(|| {
        if size == 0 {
            return Err(Failure::new(
                ASP_BAD_ARGUMENT,
                "size: 0 is refused; give some room, 200 for instance",
            ));
        }
        let room = array_mut(words.cast::<u8>(), size as usize, 1 << 20, "words")?;
        room[0] = 0;
        let player = PLAYERS.hold(player as usize)?;
        match player.playing() {
            #[cfg(feature = "device")]
            Playing::Device(device) => match device.silent_because() {
                Some(why) => text::copy(&why.to_string(), room),
                None => text::copy(device.device(), room),
            },
            Playing::Silent { .. } => text::copy("no device, as asked for", room),
        };
        Ok(())
    })
}

/// Report of the player so far; one that plays to nobody tells it only when it is stopped.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_get_player_report(
    player: *mut asp_player,
    report: *mut asp_player_report,
) -> i32 {
    enter(|| {
        let player = PLAYERS.hold(player as usize)?;
        let counted = match player.playing() {
            #[cfg(feature = "device")]
            Playing::Device(device) => of_device(device.report(), device.silent_because().is_some()),
            Playing::Silent { .. } => asp_player_report { silent: 1, ..sized::Sized32::initial() },
        };
        sized::write(&counted, report, "report")
    })
}

#[cfg(feature = "device")]
fn of_device(report: asperity::live::device::DeviceReport, silent: bool) -> asp_player_report {
    asp_player_report {
        silent: u32::from(silent),
        callbacks: report.callbacks,
        underruns: report.underruns,
        rebuilt: report.rebuilt,
        latency_s: report.latency_s,
        mean_load: report.mean_load,
        peak_load: report.peak_load,
        ..sized::Sized32::initial()
    }
}

/// Stops and frees a player; null is nothing. `report` (may be NULL) is what it met.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_player_stop(player: *mut asp_player, report: *mut asp_player_report) -> i32 {
    enter(|| {
        if player.is_null() {
            return Ok(());
        }
        let counted = match PLAYERS.remove(player as usize)?.into_playing()? {
            #[cfg(feature = "device")]
            Playing::Device(device) => {
                let silent = device.silent_because().is_some();
                of_device(device.stop(), silent)
            }
            Playing::Silent { sink, block_frames, rate_hz } => {
                let pace = sink.stop().map(|(_, pace)| pace).unwrap_or_default();
                asp_player_report {
                    silent: 1,
                    callbacks: pace.blocks,
                    underruns: pace.late,
                    mean_load: pace.load,
                    peak_load: pace.longest_s * rate_hz / block_frames as f64,
                    ..sized::Sized32::initial()
                }
            }
        };
        if report.is_null() { Ok(()) } else { sized::write(&counted, report, "report") }
    })
}
