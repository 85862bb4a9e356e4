//! Render: what the audio thread calls. Nothing here fails, allocates, locks or waits; where
//! anything is wrong it is silent.

use crate::config::{ASP_MAX_BUSES, ASP_MAX_CHANNELS, CHUNK_FRAMES};
use crate::entry::{enter, out};
use crate::handles::{AudioHalf, RENDERERS, SCENES, asp_renderer, asp_scene};
use crate::pickup::ASP_MAX_PICKUPS;
use crate::status::{ASP_REFUSED, Failure};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Most frames of one call; a longer one renders nothing.
pub const ASP_MAX_FRAMES: u32 = 16777216;
/// Most channels of an interleaved buffer; with more nothing is rendered.
pub const ASP_MAX_WIDTH: u32 = 256;
/// In a channel map: this channel is silent. From 0 on it is an audio bus.
pub const ASP_SILENT: i32 = -1;
/// In a channel map: ASP_HAPTIC + i is haptic channel i.
pub const ASP_HAPTIC: i32 = 1000;

impl AudioHalf {
    /// Renders the next frames, at most a chunk, into the memory of this half. Hands out no slice
    /// that a program also has.
    pub(crate) fn render(&mut self, frames: usize) {
        let mut haptic: [&mut [f32]; ASP_MAX_CHANNELS as usize] = std::array::from_fn(|_| &mut [][..]);
        let mut audio: [&mut [f32]; ASP_MAX_BUSES as usize] = std::array::from_fn(|_| &mut [][..]);
        let (channels, buses) = (self.haptic.len().min(haptic.len()), self.audio.len().min(audio.len()));
        for (slice, channel) in haptic.iter_mut().zip(&mut self.haptic) {
            *slice = &mut channel[..frames];
        }
        for (slice, bus) in audio.iter_mut().zip(&mut self.audio) {
            *slice = &mut bus[..frames];
        }
        let mut pickups: [&mut [f32]; ASP_MAX_PICKUPS as usize] = std::array::from_fn(|_| &mut [][..]);
        let read = self.pickups.len().min(pickups.len());
        for (slice, pickup) in pickups.iter_mut().zip(&mut self.pickups) {
            *slice = &mut pickup[..frames];
        }
        if let Some(renderer) = &mut self.renderer {
            let (haptic, audio) = (&mut haptic[..channels], &mut audio[..buses]);
            renderer.render_with_pickups(haptic, audio, &mut pickups[..read]);
        } else {
            haptic.iter_mut().chain(&mut audio).chain(&mut pickups).for_each(|slice| slice.fill(0.0));
        }
    }

    /// Signal of a map's channel.
    fn signal(&self, number: i32) -> Option<&[f32]> {
        let number = usize::try_from(number).ok()?;
        match number.checked_sub(ASP_HAPTIC as usize) {
            Some(channel) => self.haptic.get(channel).map(Vec::as_slice),
            None => self.audio.get(number).map(Vec::as_slice),
        }
    }
}

/// Runs what renders; a panic is silence, and the handle is poisoned by its unwinding.
pub(crate) fn guarded(render: impl FnOnce()) {
    if let Err(panic) = catch_unwind(AssertUnwindSafe(render)) {
        std::mem::forget(panic);
    }
}

/// A program's planar channels; which of its pointers are null does not matter.
#[derive(Clone, Copy)]
pub(crate) struct Planes {
    first: *const *mut f32,
    count: usize,
}

impl Planes {
    pub(crate) fn new(first: *const *mut f32, count: u32) -> Self {
        let count = if first.is_null() || !first.is_aligned() { 0 } else { count as usize };
        Self { first, count }
    }

    /// Writes to a channel from frame `at` on.
    fn put(self, channel: usize, at: usize, samples: impl Iterator<Item = f32>) {
        if channel >= self.count {
            return;
        }
        // SAFETY: below the count that the caller has given.
        let plane = unsafe { self.first.add(channel).read() };
        if plane.is_null() || !plane.is_aligned() {
            return;
        }
        for (index, x) in samples.enumerate() {
            // SAFETY: the plane has as many frames as the caller has said, and no slice of it is
            // made, so that planes may be the same.
            unsafe { plane.add(at + index).write(x) };
        }
    }
}

/// Renders the next `frames`: haptic channel i into `haptic[i]`, audio bus i into `audio[i]`.
/// Pointers may be NULL, and channels that the engine does not have are silent. A handle that
/// cannot be used, more than 64 channels or more than 2²⁴ frames: silence, or nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_render(
    renderer: *mut asp_renderer,
    haptic: *const *mut f32,
    haptic_channels: u32,
    audio: *const *mut f32,
    audio_buses: u32,
    frames: u32,
) {
    if haptic_channels <= ASP_MAX_CHANNELS && audio_buses <= ASP_MAX_BUSES {
        let nothing = Planes::new(std::ptr::null(), 0);
        let (haptic, audio) = (Planes::new(haptic, haptic_channels), Planes::new(audio, audio_buses));
        render_planes(renderer, [haptic, audio, nothing], frames);
    }
}

/// Renders haptic channels, buses and pickups into a program's planes.
pub(crate) fn render_planes(renderer: *mut asp_renderer, all: [Planes; 3], frames: u32) {
    if frames > ASP_MAX_FRAMES {
        return;
    }
    let frames = frames as usize;
    let mut done = 0;
    guarded(|| {
        let Ok(mut half) = RENDERERS.try_hold(renderer as usize) else { return };
        while done < frames {
            let n = (frames - done).min(CHUNK_FRAMES);
            half.render(n);
            for (planes, signals) in all.into_iter().zip([&half.haptic, &half.audio, &half.pickups]) {
                for channel in 0..planes.count {
                    let silence = [0.0; CHUNK_FRAMES];
                    let signal = signals.get(channel).map_or(&silence[..], Vec::as_slice);
                    planes.put(channel, done, signal[..n].iter().copied());
                }
            }
            done += n;
        }
    });
    for planes in all.into_iter().filter(|_| done < frames) {
        (0..planes.count).for_each(|channel| planes.put(channel, done, (done..frames).map(|_| 0.0)));
    }
}

/// Renders the next `frames` into an interleaved buffer of `channels` channels. `map[c]` says what
/// channel c carries: an audio bus, ASP_HAPTIC + a haptic channel, or ASP_SILENT. `map` NULL: all
/// buses on channels 0 and 1, haptic channels from 2 on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_render_interleaved(
    renderer: *mut asp_renderer,
    out: *mut f32,
    channels: u32,
    frames: u32,
    map: *const i32,
) {
    let refused = channels == 0 || channels > ASP_MAX_WIDTH || frames > ASP_MAX_FRAMES;
    let samples = (channels as usize).checked_mul(frames as usize);
    let (false, Some(samples)) = (refused || out.is_null() || !out.is_aligned(), samples) else { return };
    if samples > isize::MAX as usize / size_of::<f32>() {
        return;
    }
    // SAFETY: not null and aligned; that so many samples are there is the caller's promise.
    let out = unsafe { std::slice::from_raw_parts_mut(out, samples) };
    out.fill(0.0);
    let width = channels as usize;
    let map = if map.is_null() || !map.is_aligned() {
        None
    } else {
        // SAFETY: not null and aligned; that it has one number a channel is the caller's promise.
        Some(unsafe { std::slice::from_raw_parts(map, width) })
    };
    guarded(|| {
        let Ok(mut half) = RENDERERS.try_hold(renderer as usize) else { return };
        for chunk in out.chunks_mut(CHUNK_FRAMES * width) {
            half.render(chunk.len() / width);
            half.interleave(chunk, width, map);
        }
    });
}

impl AudioHalf {
    /// Adds what was rendered last to an interleaved buffer.
    pub(crate) fn interleave(&self, chunk: &mut [f32], width: usize, map: Option<&[i32]>) {
        let mut add = |channel: usize, signal: &[f32]| {
            if channel < width {
                for (frame, x) in chunk.chunks_exact_mut(width).zip(signal) {
                    frame[channel] += *x;
                }
            }
        };
        if let Some(map) = map {
            for (channel, number) in map.iter().enumerate() {
                if let Some(signal) = self.signal(*number) {
                    add(channel, signal);
                }
            }
            return;
        }
        for bus in &self.audio {
            add(0, bus);
            add(1, bus);
        }
        for (channel, signal) in self.haptic.iter().enumerate() {
            add(2 + channel, signal);
        }
    }
}

/// Reports which share of its time the last block took (1 = all of it); above that the
/// least audible work is left out. For the audio thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_report_load(renderer: *mut asp_renderer, load: f32) {
    guarded(|| {
        if let Ok(mut half) = RENDERERS.try_hold(renderer as usize)
            && let Some(renderer) = &mut half.renderer
        {
            renderer.report_load(load);
        }
    });
}

/// Outputs of a renderer: haptic channels, audio buses, their rate in Hz, and by how many samples
/// all of them lag behind the stamps of their events (sound by two samples of the rate inside
/// more). Any of the places may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_signals(
    renderer: *mut asp_renderer,
    haptic_channels: *mut u32,
    audio_buses: *mut u32,
    sample_rate_hz: *mut f64,
    latency_samples: *mut u32,
) -> i32 {
    fn write_to<T>(place: *mut T, value: T, name: &str) -> Result<(), Failure> {
        if !place.is_null() {
            *out(place, name)? = value;
        }
        Ok(())
    }
    enter(|| {
        let half = RENDERERS.hold(renderer as usize)?;
        let Some(renderer) = &half.renderer else { return Err(moved()) };
        write_to(haptic_channels, renderer.haptic_channels() as u32, "haptic_channels")?;
        write_to(audio_buses, renderer.audio_buses() as u32, "audio_buses")?;
        write_to(sample_rate_hz, renderer.sample_rate_hz(), "sample_rate_hz")?;
        write_to(latency_samples, renderer.latency_samples() as u32, "latency_samples")
    })
}

pub(crate) fn moved() -> Failure {
    Failure::new(ASP_REFUSED, "renderer: has no engine any more; build another one")
}

/// Goes on at another rate, after a headset was plugged in: ids, contacts and gains stay, ports
/// end. Not while the audio thread renders.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_set_sample_rate(
    scene: *mut asp_scene,
    renderer: *mut asp_renderer,
    sample_rate_hz: f64,
) -> i32 {
    enter(|| {
        let mut game = SCENES.hold(scene as usize)?;
        let mut half = RENDERERS.hold(renderer as usize)?;
        let old = half.renderer.take().ok_or_else(moved)?;
        match game.scene.at_rate(old, sample_rate_hz) {
            Ok(at) => {
                half.renderer = Some(at.renderer);
                match at.lost.first() {
                    None => Ok(()),
                    Some((surface, error)) => Err(Failure::new(
                        ASP_REFUSED,
                        format!("surface {surface}: is no longer in the scene: {error}; add another one"),
                    )),
                }
            }
            Err(error) => {
                let sentence = error.to_string();
                half.renderer = Some(*error.renderer);
                Err(Failure::new(ASP_REFUSED, sentence))
            }
        }
    })
}
