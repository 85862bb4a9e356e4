//! `AsperityStream`: the audio buses of a world. Its playback is the renderer.

use crate::frames::{self, CHUNK_FRAMES};
use asperity::Renderer;
use godot::classes::native::AudioFrame;
use godot::classes::{AudioStream, AudioStreamPlayback, IAudioStream, IAudioStreamPlayback};
use godot::meta::conv::RawPtr;
use godot::prelude::*;
use std::sync::{Arc, Mutex};

/// Place of a renderer that is not played. The audio thread never looks here.
pub(crate) type Slot = Arc<Mutex<Option<Renderer>>>;

/// The audio buses of an `AsperityWorld`: one bus sounds on both sides; of several the first is
/// left, the second right, further ones both. `AsperityWorld.audio_stream()` gives it.
#[derive(GodotClass)]
#[class(init, base = AudioStream)]
pub struct AsperityStream {
    pub(crate) slot: Slot,
    base: Base<AudioStream>,
}

#[godot_api]
impl IAudioStream for AsperityStream {
    fn instantiate_playback(&self) -> Option<Gd<AudioStreamPlayback>> {
        let renderer = self.slot.lock().ok().and_then(|mut slot| slot.take());
        if renderer.is_none() {
            godot_error!(
                "AsperityStream: is played already, or its world is not built; play it in one place, after build(). This playback is silent"
            );
        }
        let playback = Gd::from_init_fn(|base| AsperityPlayback::new(renderer, self.slot.clone(), base));
        Some(playback.upcast())
    }

    fn get_stream_name(&self) -> GString {
        "asperity".into()
    }

    fn get_length(&self) -> f64 {
        0.0
    }

    fn is_monophonic(&self) -> bool {
        true
    }
}

/// Playback of an `AsperityStream` for the audio server. Scripts have no business with it.
#[derive(GodotClass)]
#[class(no_init, base = AudioStreamPlayback)]
pub struct AsperityPlayback {
    renderer: Option<Renderer>,
    slot: Slot,
    haptic: Vec<Vec<f32>>,
    audio: Vec<Vec<f32>>,
    playing: bool,
    base: Base<AudioStreamPlayback>,
}

/// Most channels of either kind.
pub(crate) const MOST_CHANNELS: usize = 16;

impl AsperityPlayback {
    fn new(renderer: Option<Renderer>, slot: Slot, base: Base<AudioStreamPlayback>) -> Self {
        let memory = |count: usize| vec![vec![0.0; CHUNK_FRAMES]; count.min(MOST_CHANNELS)];
        let counts = renderer.as_ref().map_or((0, 0), |r| (r.haptic_channels(), r.audio_buses()));
        Self { renderer, slot, haptic: memory(counts.0), audio: memory(counts.1), playing: false, base }
    }

    fn render(&mut self, out: &mut [AudioFrame]) {
        let Some(renderer) = &mut self.renderer else { return frames::silence(out) };
        let (haptics, buses) = (self.haptic.len(), self.audio.len());
        let mut haptic: [&mut [f32]; MOST_CHANNELS] = std::array::from_fn(|_| Default::default());
        let mut audio: [&mut [f32]; MOST_CHANNELS] = std::array::from_fn(|_| Default::default());
        for (place, signal) in haptic.iter_mut().zip(&mut self.haptic) {
            *place = &mut signal[..out.len()];
        }
        for (place, signal) in audio.iter_mut().zip(&mut self.audio) {
            *place = &mut signal[..out.len()];
        }
        renderer.render(&mut haptic[..haptics], &mut audio[..buses]);
        frames::silence(out);
        for (bus, signal) in audio[..buses].iter().enumerate() {
            let [left, right] = [bus != 1 || buses == 1, bus != 0 || buses == 1];
            for (frame, x) in out.iter_mut().zip(signal.iter()) {
                frame.left += if left { *x } else { 0.0 };
                frame.right += if right { *x } else { 0.0 };
            }
        }
    }
}

impl Drop for AsperityPlayback {
    /// The renderer waits for the next playback. Godot frees playbacks on the main thread.
    fn drop(&mut self) {
        if let (Some(renderer), Ok(mut slot)) = (self.renderer.take(), self.slot.lock()) {
            *slot = Some(renderer);
        }
    }
}

#[godot_api]
impl IAudioStreamPlayback for AsperityPlayback {
    fn start(&mut self, _from_pos: f64) {
        self.playing = true;
    }

    fn stop(&mut self) {
        self.playing = false;
    }

    fn is_playing(&self) -> bool {
        self.playing
    }

    fn get_loop_count(&self) -> i32 {
        0
    }

    fn get_playback_position(&self) -> f64 {
        self.renderer.as_ref().map_or(0.0, |r| r.position() as f64 / r.sample_rate_hz())
    }

    fn seek(&mut self, _position: f64) {}

    unsafe fn mix_rawptr(&mut self, buffer: RawPtr<*mut AudioFrame>, _rate_scale: f32, frames: i32) -> i32 {
        // SAFETY: the audio server's own buffer, of so many frames, for this call.
        let out = unsafe { frames::of(buffer.ptr(), frames) };
        for chunk in out.chunks_mut(CHUNK_FRAMES) {
            self.render(chunk);
        }
        frames
    }
}
