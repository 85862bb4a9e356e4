//! A sound card through cpal; the only files that name it. Feature `device`.
//!
//! The renderer sits behind a lock that only the callback holds while a stream runs; the callback
//! *tries* it and plays silence otherwise, so it never waits. A supervisor thread owns the stream,
//! rebuilds it when the device is lost, and keeps the engine's state meanwhile. Without any device
//! the engine runs into a [null sink](crate::live::null_sink) and says so.

mod streams;

use crate::audio::renderer::Renderer;
use crate::live::channel_map::{ChannelMap, Interleaver};
use crate::live::null_sink::NullSink;
use cpal::traits::{DeviceTrait, HostTrait};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

/// Which device, and how it is used.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DeviceOptions {
    /// Host by name (`alsa`, `jack`, `pulseaudio`, `wasapi`, `coreaudio`); missing: the system's.
    pub host: Option<String>,
    /// Device id as [`list`] prints it; missing: the default output.
    pub device: Option<String>,
    /// A second device for the actuators, in channel order; its clock is followed by a small
    /// resampler.
    pub haptic_device: Option<String>,
    /// Which channels carry what; missing: audio on 0 and 1, actuators from 2 on.
    pub channels: Option<ChannelMap>,
    /// Frames a callback to ask for; any size is accepted.
    pub block_frames: Option<u32>,
}

/// One output device.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeviceInfo {
    /// Identifier that [`DeviceOptions::device`] takes.
    pub id: String,
    /// Name for people.
    pub name: String,
    /// Channels of its default configuration; 0 when it names none.
    pub channels: u16,
    /// Rate of its default configuration, Hz; 0 when it tells none.
    pub sample_rate_hz: u32,
}

/// Why no device could be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// No such host was built in.
    #[error("host: \"{host}\" is not there; must be one of: {known}")]
    UnknownHost {
        /// The name given.
        host: String,
        /// The hosts of this build.
        known: String,
    },
    /// No such device is there.
    #[error("device: \"{0}\" is not there; list the devices for their ids (asperity play --list-devices)")]
    UnknownDevice(String),
    /// No device at all.
    #[error("device: no sound card was found; connect one, or start the sound server")]
    NoDevice,
    /// The system refused.
    #[error("device: {0}; choose another one (asperity play --list-devices), rate or channel map")]
    System(#[from] cpal::Error),
    /// The device does not run in blocks of the size asked for.
    #[error("device: blocks of {asked} frames are refused ({why}); {right}")]
    Block {
        /// Frames asked for.
        asked: u32,
        /// Message of the system.
        why: cpal::Error,
        /// Remedy.
        right: String,
    },
    /// The system gives no thread.
    #[error("device: no thread could be started ({0})")]
    Thread(#[from] std::io::Error),
}

/// Every output device, over all hosts of this build.
#[must_use]
pub fn list() -> Vec<DeviceInfo> {
    let hosts = cpal::available_hosts().into_iter().filter_map(|id| cpal::host_from_id(id).ok());
    hosts.flat_map(|host| outputs(&host)).collect()
}

/// Every output device of one host.
///
/// # Errors
/// When there is no such host in this build.
pub fn list_on(host: &str) -> Result<Vec<DeviceInfo>, DeviceError> {
    Ok(outputs(&streams::host(Some(host))?))
}

fn outputs(host: &cpal::Host) -> Vec<DeviceInfo> {
    host.output_devices().into_iter().flatten().filter_map(|device| describe(&device)).collect()
}

/// An output device; none if it only records, which some hosts list among their outputs.
fn describe(device: &cpal::Device) -> Option<DeviceInfo> {
    let config = device.default_output_config().ok();
    let description = device.description().ok();
    if description.as_ref().is_some_and(|d| d.direction() == cpal::DeviceDirection::Input) {
        return None;
    }
    Some(DeviceInfo {
        id: device.id().ok()?.to_string(),
        name: description.map_or_else(String::new, |d| d.name().to_owned()),
        channels: config.as_ref().map_or(0, cpal::SupportedStreamConfig::channels),
        sample_rate_hz: config.as_ref().map_or(0, cpal::SupportedStreamConfig::sample_rate),
    })
}

/// The rate that the chosen device runs at, Hz: build the engine for it, because the device's rate
/// wins.
///
/// # Errors
/// When the host or device is not there or names none.
pub fn sample_rate_hz(options: &DeviceOptions) -> Result<f64, DeviceError> {
    let device = streams::find(options.host.as_deref(), options.device.as_deref())?;
    Ok(f64::from(device.default_output_config()?.sample_rate()))
}

/// Counters of a running device, readable at any time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DeviceReport {
    /// Callbacks so far.
    pub callbacks: u64,
    /// Glitches that the device or the sound server reported.
    pub underruns: u64,
    /// Times the stream was built anew after the device was lost.
    pub rebuilt: u64,
    /// Samples invented for the haptic device because its buffer ran dry.
    pub haptic_underruns: u64,
    /// Frames of the last callback.
    pub callback_frames: u64,
    /// Distance from callback to ear or skin, s, as the device states; 0 where it does not.
    pub latency_s: f64,
    /// Mean share of the callbacks' time that rendering took.
    pub mean_load: f64,
    /// Longest share of a callback's time that rendering took.
    pub peak_load: f64,
}

#[derive(Debug, Default)]
struct Meters {
    callbacks: AtomicU64,
    underruns: AtomicU64,
    rebuilt: AtomicU64,
    haptic_underruns: AtomicU64,
    callback_frames: AtomicU64,
    latency_us: AtomicU64,
    busy_ns: AtomicU64,
    frames: AtomicU64,
    peak_load_ppm: AtomicU64,
}

/// Messages to the supervisor.
#[derive(Debug)]
enum Message {
    /// The stream with this number is gone.
    Lost(u64),
    Stop,
}

/// A playing engine. Dropping it stops the sound.
#[derive(Debug)]
pub struct Player {
    meters: Arc<Meters>,
    rate_hz: f64,
    device: String,
    engine: Engine,
}

#[derive(Debug)]
enum Engine {
    Device { supervisor: Option<JoinHandle<()>>, orders: Sender<Message> },
    Silent { sink: Option<NullSink>, block_frames: usize, why: DeviceError },
}

/// Plays on the default device, or silently where there is none; see [`Player::silent_because`].
///
/// # Errors
/// When the system gives no thread.
pub fn play(renderer: Renderer) -> Result<Player, DeviceError> {
    play_on(renderer, &DeviceOptions::default())
}

/// Plays on a chosen device. A named device that is not there is an error; without a name the
/// engine runs silently when there is no device at all.
///
/// # Errors
/// When the host or device is not there or refuses the configuration.
pub fn play_on(renderer: Renderer, options: &DeviceOptions) -> Result<Player, DeviceError> {
    let actuators = renderer.haptic_channels();
    let map = match (&options.channels, &options.haptic_device) {
        (Some(map), _) => map.clone(),
        (None, Some(_)) => ChannelMap { audio: vec![vec![0, 1]], haptic: Vec::new() },
        (None, None) => ChannelMap::stereo_then_haptics(actuators),
    };
    let rate = renderer.sample_rate_hz();
    let interleaver = Interleaver::new(renderer, map);
    let named = options.host.is_some() || options.device.is_some() || options.haptic_device.is_some();
    let device = Arc::new(Mutex::new(interleaver));
    let meters = Arc::new(Meters::default());
    let (orders, inbox) = channel();
    match streams::supervise(device.clone(), options.clone(), rate, meters.clone(), orders.clone(), inbox) {
        Ok(supervisor) => {
            let engine = Engine::Device { supervisor: Some(supervisor), orders };
            let device = options.device.clone().or_else(|| options.host.clone());
            Ok(Player {
                meters,
                rate_hz: rate,
                device: device.unwrap_or("the default device".into()),
                engine,
            })
        }
        Err(error) if named => Err(error),
        Err(why) => {
            let Some(interleaver) = Arc::into_inner(device).and_then(|lock| lock.into_inner().ok()) else {
                return Err(why);
            };
            let block_frames = options.block_frames.unwrap_or(256) as usize;
            let sink = Some(NullSink::start(interleaver, block_frames)?);
            let engine = Engine::Silent { sink, block_frames, why };
            Ok(Player { meters, rate_hz: rate, device: "no device".into(), engine })
        }
    }
}

impl Player {
    /// Why nothing is heard, when the engine runs into a null sink.
    #[must_use]
    pub fn silent_because(&self) -> Option<&DeviceError> {
        match &self.engine {
            Engine::Device { .. } => None,
            Engine::Silent { why, .. } => Some(why),
        }
    }

    /// The device as it was asked for.
    #[must_use]
    pub fn device(&self) -> &str {
        &self.device
    }

    /// Stops the sound and returns what the device met. Of a null sink, callbacks are its blocks
    /// and underruns the blocks that were late.
    #[must_use]
    pub fn stop(mut self) -> DeviceReport {
        let pace = match &mut self.engine {
            Engine::Silent { sink, block_frames, .. } => {
                sink.take().and_then(NullSink::stop).map(|(_, pace)| (pace, *block_frames))
            }
            Engine::Device { .. } => None,
        };
        match pace {
            None => self.report(),
            Some((pace, block_frames)) => DeviceReport {
                callbacks: pace.blocks,
                underruns: pace.late,
                callback_frames: block_frames as u64,
                mean_load: pace.load,
                peak_load: pace.longest_s * self.rate_hz / block_frames as f64,
                ..DeviceReport::default()
            },
        }
    }

    /// Counters of the device so far; of a null sink only [`stop`](Self::stop) has them.
    #[must_use]
    pub fn report(&self) -> DeviceReport {
        let meters = &self.meters;
        let played_s = meters.frames.load(Relaxed) as f64 / self.rate_hz;
        DeviceReport {
            mean_load: meters.busy_ns.load(Relaxed) as f64 * 1e-9 / played_s.max(1e-9),
            callbacks: meters.callbacks.load(Relaxed),
            underruns: meters.underruns.load(Relaxed),
            rebuilt: meters.rebuilt.load(Relaxed),
            haptic_underruns: meters.haptic_underruns.load(Relaxed),
            callback_frames: meters.callback_frames.load(Relaxed),
            latency_s: meters.latency_us.load(Relaxed) as f64 * 1e-6,
            peak_load: meters.peak_load_ppm.load(Relaxed) as f64 * 1e-6,
        }
    }
}

impl Drop for Player {
    fn drop(&mut self) {
        if let Engine::Device { supervisor, orders } = &mut self.engine {
            // Both fail only when the supervisor is gone already.
            let _ = orders.send(Message::Stop);
            let _ = supervisor.take().map(JoinHandle::join);
        }
    }
}
