//! Finding devices, building streams, and the supervisor that builds them anew.

use super::{DeviceError, DeviceOptions, Message, Meters};
use crate::link::ring::{self, Receiver};
use crate::live::channel_map::Interleaver;
use crate::live::drift::DriftResampler;
use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};
use cpal::{BufferSize, Device, ErrorKind, OutputCallbackInfo, Stream, StreamConfig, SupportedBufferSize};
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Waits between attempts to get a lost device back.
const RETRY: Duration = Duration::from_millis(500);
/// Frames a callback to ask for when nobody says: left to themselves some sound servers keep two
/// seconds.
const BLOCK_FRAMES: u32 = 512;
/// Haptic samples kept between two devices.
const HAPTIC_FILL: usize = 1024;

/// The device that host and id name. Each call opens the host anew: two PulseAudio streams of one
/// host object refuse to play on two sinks.
pub(super) fn find(host: Option<&str>, id: Option<&str>) -> Result<Device, DeviceError> {
    let host = self::host(host)?;
    match id {
        None => host.default_output_device().ok_or(DeviceError::NoDevice),
        Some(id) => {
            let unknown = || DeviceError::UnknownDevice(id.into());
            let parsed: cpal::DeviceId = id.parse().map_err(|_| unknown())?;
            let host = cpal::host_from_id(parsed.host()).map_err(|_| unknown())?;
            host.device_by_id(&parsed).ok_or_else(unknown)
        }
    }
}

/// The host of a name, or the system's.
pub(super) fn host(name: Option<&str>) -> Result<cpal::Host, DeviceError> {
    let Some(name) = name else { return Ok(cpal::default_host()) };
    let hosts = cpal::available_hosts();
    let known = hosts.iter().map(|h| h.to_string().to_lowercase()).collect::<Vec<_>>().join(", ");
    let id = hosts.into_iter().find(|h| h.to_string().eq_ignore_ascii_case(name));
    Ok(cpal::host_from_id(id.ok_or(DeviceError::UnknownHost { host: name.into(), known })?)?)
}

/// Block size that a device takes, from its answer to one that it does not.
fn refused_block(device: &Device, asked: u32, why: cpal::Error) -> DeviceError {
    let right = match device.default_output_config().map(|config| *config.buffer_size()) {
        Ok(SupportedBufferSize::Range { min, max }) if min == max => format!("ask for {min}, or for none"),
        Ok(SupportedBufferSize::Range { min, max }) => format!("ask for {min} to {max}, or for none"),
        Ok(SupportedBufferSize::Unknown) | Err(_) => "ask for another size, or for none".into(),
    };
    DeviceError::Block { asked, why, right }
}

/// Needs of a running stream; built anew with every stream.
struct Job {
    device: Arc<Mutex<Interleaver>>,
    options: DeviceOptions,
    rate_hz: f64,
    meters: Arc<Meters>,
    orders: Sender<Message>,
}

/// Builds the first streams (so that errors reach the caller) and starts the thread that keeps
/// them.
pub(super) fn supervise(
    device: Arc<Mutex<Interleaver>>,
    options: DeviceOptions,
    rate_hz: f64,
    meters: Arc<Meters>,
    orders: Sender<Message>,
    inbox: mpsc::Receiver<Message>,
) -> Result<JoinHandle<()>, DeviceError> {
    let job = Job { device, options, rate_hz, meters, orders };
    let (ready, outcome) = mpsc::channel();
    let supervisor = std::thread::Builder::new().name("asperity device".into()).spawn(move || {
        let mut number = 0;
        let mut streams = match job.build(number) {
            Ok(streams) => {
                let _ = ready.send(Ok(()));
                Some(streams)
            }
            Err(error) => {
                drop(job);
                let _ = ready.send(Err(error));
                return;
            }
        };
        loop {
            let wait = if streams.is_some() { Duration::from_secs(3600) } else { RETRY };
            match inbox.recv_timeout(wait) {
                Ok(Message::Stop) | Err(RecvTimeoutError::Disconnected) => return,
                Ok(Message::Lost(lost)) if lost == number => streams = None,
                // Word of a stream that was replaced already, or nothing at all.
                Ok(Message::Lost(_)) | Err(RecvTimeoutError::Timeout) => {}
            }
            if streams.is_none() {
                number += 1;
                streams = job.build(number).ok();
                job.meters.rebuilt.fetch_add(u64::from(streams.is_some()), Relaxed);
            }
        }
    })?;
    match outcome.recv() {
        Ok(Ok(())) => Ok(supervisor),
        Ok(Err(error)) => {
            // The engine is handed back once the thread has let go of it.
            let _ = supervisor.join();
            Err(error)
        }
        Err(_) => Err(DeviceError::NoDevice),
    }
}

impl Job {
    fn build(&self, number: u64) -> Result<Vec<Stream>, DeviceError> {
        let options = &self.options;
        let mut streams = Vec::new();
        let device = find(options.host.as_deref(), options.device.as_deref())?;
        streams.push(self.audio_stream(&device, number)?);
        if let Some(id) = &options.haptic_device {
            let device = find(options.host.as_deref(), Some(id))?;
            streams.push(self.haptic_stream(&device, number)?);
        }
        for stream in &streams {
            stream.play()?;
        }
        Ok(streams)
    }

    fn lock(&self) -> Option<std::sync::MutexGuard<'_, Interleaver>> {
        self.device.lock().ok()
    }

    fn config(&self, channels: usize, buffer_size: BufferSize) -> StreamConfig {
        StreamConfig { channels: channels as u16, sample_rate: self.rate_hz.round() as u32, buffer_size }
    }

    /// The buffer sizes to try in turn. Who names one gets that or an error.
    fn buffer_sizes(&self) -> Vec<BufferSize> {
        match self.options.block_frames {
            Some(frames) => vec![BufferSize::Fixed(frames)],
            None => vec![BufferSize::Fixed(BLOCK_FRAMES), BufferSize::Default],
        }
    }

    /// The first configuration with which a stream can be built.
    fn first_that_works(
        &self,
        channels: &[usize],
        build: impl Fn(StreamConfig) -> Result<Stream, DeviceError>,
    ) -> Result<Stream, DeviceError> {
        let mut outcome = Err(DeviceError::NoDevice);
        for buffer_size in self.buffer_sizes() {
            for &channels in channels {
                outcome = build(self.config(channels, buffer_size));
                if outcome.is_ok() {
                    return outcome;
                }
            }
        }
        outcome
    }

    fn audio_stream(&self, device: &Device, number: u64) -> Result<Stream, DeviceError> {
        let wanted = self.lock().map_or(2, |device| device.map().width());
        // Some devices only run with all their channels; those that list fewer may still take more.
        let offered = device.default_output_config().map_or(2, |c| usize::from(c.channels()));
        let built = self.first_that_works(&[wanted, wanted.max(offered)], |config| {
            self.build_audio(device, config, number)
        });
        match (built, self.options.block_frames) {
            // It is the block's fault if the device takes any other.
            (Err(DeviceError::System(why)), Some(asked))
                if self
                    .build_audio(device, self.config(wanted.max(offered), BufferSize::Default), number)
                    .is_ok() =>
            {
                Err(refused_block(device, asked, why))
            }
            (built, _) => built,
        }
    }

    fn build_audio(&self, device: &Device, config: StreamConfig, number: u64) -> Result<Stream, DeviceError> {
        let channels = usize::from(config.channels);
        let (engine, meters, rate_hz) = (self.device.clone(), self.meters.clone(), self.rate_hz);
        let callback = move |out: &mut [f32], info: &OutputCallbackInfo| {
            // Held by this callback alone while the stream runs; tried, so that nothing ever waits.
            let Ok(mut engine) = engine.try_lock() else {
                out.fill(0.0);
                return;
            };
            let began = Instant::now();
            engine.fill(out, channels);
            let frames = out.len() / channels;
            let busy = began.elapsed();
            let load = busy.as_secs_f64() * rate_hz / frames.max(1) as f64;
            engine.renderer().report_load(load as f32);
            let stamp = info.timestamp();
            meters.latency_us.store((stamp.playback - stamp.callback).as_micros() as u64, Relaxed);
            meters.callbacks.fetch_add(1, Relaxed);
            meters.frames.fetch_add(frames as u64, Relaxed);
            meters.busy_ns.fetch_add(busy.as_nanos() as u64, Relaxed);
            meters.callback_frames.store(frames as u64, Relaxed);
            meters.peak_load_ppm.fetch_max((load * 1e6) as u64, Relaxed);
        };
        Ok(device.build_output_stream::<f32, _, _>(config, callback, self.watch(number), None)?)
    }

    fn haptic_stream(&self, device: &Device, number: u64) -> Result<Stream, DeviceError> {
        let channels = self.lock().map_or(1, |mut device| device.renderer().haptic_channels().max(1));
        self.first_that_works(&[channels], |config| self.build_haptics(device, config, number))
    }

    fn build_haptics(
        &self,
        device: &Device,
        config: StreamConfig,
        number: u64,
    ) -> Result<Stream, DeviceError> {
        let channels = usize::from(config.channels);
        // The rings go to the stream and are lost with one that cannot be built.
        let mut haptics =
            self.lock().map_or_else(Vec::new, |mut device| device.split_haptics(4 * HAPTIC_FILL));
        let meters = self.meters.clone();
        let mut readers = vec![DriftResampler::new(HAPTIC_FILL, self.rate_hz); channels];
        let mut chunk = [0.0f32; 256];
        let callback = move |out: &mut [f32], _: &OutputCallbackInfo| {
            out.fill(0.0);
            for block in out.chunks_mut(256 * channels) {
                let frames = block.len() / channels;
                for (channel, (reader, ring)) in readers.iter_mut().zip(&mut haptics).enumerate() {
                    let waiting = ring.waiting();
                    reader.read(waiting, &mut chunk[..frames], || ring.receive());
                    for (frame, x) in block.chunks_exact_mut(channels).zip(&chunk) {
                        frame[channel] = *x;
                    }
                }
            }
            let underruns = readers.iter().map(DriftResampler::underruns).sum();
            meters.haptic_underruns.store(underruns, Relaxed);
        };
        Ok(device.build_output_stream::<f32, _, _>(config, callback, self.watch(number), None)?)
    }

    /// Counts glitches; everything else means that the stream is lost.
    fn watch(&self, number: u64) -> impl FnMut(cpal::Error) + Send + 'static {
        let (meters, orders) = (self.meters.clone(), self.orders.clone());
        move |error| match error.kind() {
            ErrorKind::Xrun => {
                meters.underruns.fetch_add(1, Relaxed);
            }
            ErrorKind::DeviceChanged | ErrorKind::RealtimeDenied => {}
            // After a normal stop nobody listens any more.
            _ => drop(orders.send(Message::Lost(number))),
        }
    }
}

impl Interleaver {
    /// From now on the actuators go into rings, one each, instead of the channel map.
    fn split_haptics(&mut self, capacity: usize) -> Vec<Receiver<f32>> {
        let (senders, receivers) =
            (0..self.renderer().haptic_channels()).map(|_| ring::channel(capacity)).unzip();
        self.tee_haptics(senders);
        receivers
    }
}
