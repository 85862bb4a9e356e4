//! `AsperityHapticStream`: two haptic channels as a stereo stream, for a bus that leads to
//! actuators.

use crate::frames::{self, CHUNK_FRAMES};
use asperity::live::ports::PcmPort;
use godot::classes::native::AudioFrame;
use godot::classes::{AudioStream, AudioStreamPlayback, IAudioStream, IAudioStreamPlayback};
use godot::meta::conv::RawPtr;
use godot::prelude::*;
use std::sync::{Arc, Mutex};

/// Place of ports that are not played. The audio thread never looks here.
pub(crate) type Ports = Arc<Mutex<Option<[Option<PcmPort>; 2]>>>;

/// Two haptic channels of an `AsperityWorld`, left and right. `AsperityWorld.haptic_stream(left,
/// right)` gives it. It follows the world's `AsperityStream`, which renders: without that it is
/// silent.
#[derive(GodotClass)]
#[class(init, base = AudioStream)]
pub struct AsperityHapticStream {
    pub(crate) ports: Ports,
    base: Base<AudioStream>,
}

#[godot_api]
impl IAudioStream for AsperityHapticStream {
    fn instantiate_playback(&self) -> Option<Gd<AudioStreamPlayback>> {
        let ports = self.ports.lock().ok().and_then(|mut ports| ports.take());
        if ports.is_none() {
            godot_error!(
                "AsperityHapticStream: is played already, or was not given by a world; play it in one place. This playback is silent"
            );
        }
        let home = self.ports.clone();
        let playback = Gd::from_init_fn(|base| AsperityHapticPlayback {
            ports,
            home,
            flowing: false,
            memory: [vec![0.0; CHUNK_FRAMES], vec![0.0; CHUNK_FRAMES]],
            playing: false,
            base,
        });
        Some(playback.upcast())
    }

    fn get_stream_name(&self) -> GString {
        "asperity haptics".into()
    }

    fn get_length(&self) -> f64 {
        0.0
    }

    fn is_monophonic(&self) -> bool {
        true
    }
}

/// Playback of an `AsperityHapticStream` for the audio server. Scripts have no business with it.
#[derive(GodotClass)]
#[class(no_init, base = AudioStreamPlayback)]
pub struct AsperityHapticPlayback {
    ports: Option<[Option<PcmPort>; 2]>,
    home: Ports,
    /// Samples come: from the first block that was there on, until one is missing.
    flowing: bool,
    memory: [Vec<f32>; 2],
    playing: bool,
    base: Base<AudioStreamPlayback>,
}

impl AsperityHapticPlayback {
    fn render(&mut self, out: &mut [AudioFrame]) {
        frames::silence(out);
        let Some(ports) = &mut self.ports else { return };
        for (port, memory) in ports.iter_mut().zip(&mut self.memory) {
            let memory = &mut memory[..out.len()];
            memory.fill(0.0);
            let Some(port) = port else { continue };
            if !self.flowing {
                // What was rendered before this playback began is over: at most one block waits.
                while port.waiting() >= 2 * out.len() as u64 {
                    port.read(memory);
                }
                memory.fill(0.0);
            }
            port.read(memory);
        }
        self.flowing = true;
        let [left, right] = &self.memory;
        for ((frame, left), right) in out.iter_mut().zip(left).zip(right) {
            *frame = AudioFrame { left: *left, right: *right };
        }
    }
}

impl Drop for AsperityHapticPlayback {
    /// The ports wait for the next playback. Godot frees playbacks on the main thread.
    fn drop(&mut self) {
        if let (Some(ports), Ok(mut home)) = (self.ports.take(), self.home.lock()) {
            *home = Some(ports);
        }
    }
}

#[godot_api]
impl IAudioStreamPlayback for AsperityHapticPlayback {
    fn start(&mut self, _from_pos: f64) {
        (self.playing, self.flowing) = (true, false);
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
        0.0
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
