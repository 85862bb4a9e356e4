//! An output that nobody hears. At the end of each frame it renders as many samples as `Time<Real>`
//! has gone on by, so that a test which sets the app's time by hand gets the same samples on every
//! machine, and never sleeps.

use asperity::Renderer;
use bevy_ecs::prelude::*;
use bevy_time::{Real, Time};
use std::sync::{Mutex, PoisonError};

/// Samples rendered at a time: what a device may ask for.
const BLOCK: usize = 256;

/// The null output.
#[derive(Resource)]
pub struct NullOutput {
    renderer: Mutex<Renderer>,
    block: [Vec<Vec<f32>>; 2],
    keep: bool,
    /// Rendered samples, a channel an actuator; empty unless they are kept.
    pub haptic: Vec<Vec<f32>>,
    /// Rendered samples, a channel an audio bus; empty unless they are kept.
    pub audio: Vec<Vec<f32>>,
}

impl NullOutput {
    pub(crate) fn new(renderer: Renderer, keep: bool) -> Self {
        let [haptic, audio] = [renderer.haptic_channels(), renderer.audio_buses()];
        Self {
            renderer: Mutex::new(renderer),
            block: [haptic, audio].map(|channels| vec![vec![0.0; BLOCK]; channels]),
            keep,
            haptic: vec![Vec::new(); haptic],
            audio: vec![Vec::new(); audio],
        }
    }

    /// Samples by which every output is late, look-ahead of the limiters.
    pub fn latency_samples(&mut self) -> usize {
        self.renderer().latency_samples()
    }

    fn renderer(&mut self) -> &mut Renderer {
        self.renderer.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    /// Renders until `time_s` of the app's own time.
    fn play_until(&mut self, time_s: f64) {
        let due = (time_s * self.renderer().sample_rate_hz()) as u64;
        let renderer = self.renderer.get_mut().unwrap_or_else(PoisonError::into_inner);
        while renderer.position() < due {
            let frames = (due - renderer.position()).min(BLOCK as u64) as usize;
            let [haptic, audio] = &mut self.block;
            let mut slices = [haptic, audio].map(|channels| {
                channels.iter_mut().map(|channel| &mut channel[..frames]).collect::<Vec<_>>()
            });
            let [haptic, audio] = &mut slices;
            renderer.render(haptic, audio);
            if self.keep {
                for (kept, played) in self.haptic.iter_mut().zip(haptic) {
                    kept.extend_from_slice(played);
                }
                for (kept, played) in self.audio.iter_mut().zip(audio) {
                    kept.extend_from_slice(played);
                }
            }
        }
    }
}

/// In `Last`: every fixed step of the frame has been reported.
pub(crate) fn play(mut output: ResMut<NullOutput>, time: Res<Time<Real>>) {
    output.play_until(time.elapsed_secs_f64());
}
