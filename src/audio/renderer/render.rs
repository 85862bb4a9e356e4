//! Blocks of the caller: cut into stretches at events and on the absolute grid, and handed out.

use super::Renderer;
use super::outputs::clear_beyond;
use crate::link::tap::{NoTap, Tap};
use asperity_surface::height_field::MAX_BLOCK;
use std::sync::atomic::Ordering::Relaxed;

impl Renderer {
    /// Renders the next samples: one slice a channel, all equally long (if they are not, the
    /// shortest counts and the rest is silent). Haptic channel i goes into haptic slice i, audio
    /// bus i into audio slice i, both in the order of the config.
    ///
    /// ```
    /// use asperity::{ActuatorSettings, AudioBus, Config, Engine};
    ///
    /// let config = Config {
    ///     actuators: vec![ActuatorSettings::default(); 3],
    ///     audio: vec![AudioBus::default(); 2],
    ///     ..Config::default()
    /// };
    /// let Engine { mut renderer, .. } = config.build()?;
    /// let (mut haptic, mut audio) = ([[0.0f32; 128]; 3], [[0.0f32; 128]; 2]);
    /// renderer.render(&mut haptic.each_mut().map(|c| &mut c[..]), &mut audio.each_mut().map(|c| &mut c[..]));
    /// # Ok::<(), asperity::ConfigError>(())
    /// ```
    pub fn render(&mut self, haptic: &mut [&mut [f32]], audio: &mut [&mut [f32]]) {
        self.render_tapped(haptic, audio, &mut NoTap);
    }

    /// [`render`](Self::render), and what the [pickups](crate::Pickup) read: channel i of
    /// [`Config::pickups`](field@crate::Config::pickups) into slice i. They lag as the audio does
    /// ([`audio_latency_samples`](Self::audio_latency_samples)).
    pub fn render_with_pickups(
        &mut self,
        haptic: &mut [&mut [f32]],
        audio: &mut [&mut [f32]],
        pickups: &mut [&mut [f32]],
    ) {
        self.render_all(haptic, audio, pickups, &mut NoTap);
    }

    /// [`render`](Self::render), with a view into every contact.
    pub fn render_tapped(&mut self, haptic: &mut [&mut [f32]], audio: &mut [&mut [f32]], tap: &mut dyn Tap) {
        self.render_all(haptic, audio, &mut [], tap);
    }

    pub(crate) fn render_all(
        &mut self,
        haptic: &mut [&mut [f32]],
        audio: &mut [&mut [f32]],
        pickups: &mut [&mut [f32]],
        tap: &mut dyn Tap,
    ) {
        let frames = shortest(haptic).min(shortest(audio)).min(shortest(pickups));
        let frames = if frames == usize::MAX { 0 } else { frames };
        self.clear_what_nobody_writes(frames, haptic, audio);
        clear_beyond(pickups, |index| if index < self.pickups.len() { frames } else { 0 });
        let split = [self.channels.len(), self.channels.len() + self.buses.len()];
        let mut done = 0;
        while done < frames {
            let wanted = if self.tape.runs() { self.tape.missing() } else { frames - done };
            if wanted > 0 {
                let ran = self.tape.runs();
                let n = self.render_on(done, wanted.min(frames - done), haptic, audio, pickups, tap);
                self.tape.write((done, n), haptic, audio, pickups, split, ran);
                done += if ran { 0 } else { n };
            } else {
                self.tape.read(done, haptic, audio, pickups, split);
                done += 1;
            }
        }
        self.given += frames as u64;
        self.counters.position.store(self.position, Relaxed);
    }

    /// Renders `frames` samples in the game's time, into the outputs from `at` on; as many as were
    /// rendered, fewer where the tape begins to run.
    fn render_on(
        &mut self,
        at: usize,
        frames: usize,
        haptic: &mut [&mut [f32]],
        audio: &mut [&mut [f32]],
        pickups: &mut [&mut [f32]],
        tap: &mut dyn Tap,
    ) -> usize {
        let every = self.shared.inner.every;
        let (mut done, end, ran) = (at * every, (at + frames) * every, self.tape.runs());
        while done < end {
            self.apply_due();
            if self.tape.runs() && !ran && done.is_multiple_of(every) {
                break;
            }
            let n = self.stretch(end - done);
            self.render_contacts(n, tap);
            if self.outlets.are_open() {
                let shown = (self.position + n as u64).saturating_sub(self.shared.row_latency as u64);
                self.outlets.shown(shown / self.shared.inner.every as u64);
            }
            self.render_master(n);
            self.render_haptics(done, n, haptic);
            self.render_bodies(done, n, audio);
            self.render_pickups(done, n, pickups);
            done += n;
            self.position += n as u64;
            if self.position.is_multiple_of(MAX_BLOCK as u64) {
                self.tidy();
            }
        }
        done / every - at
    }
}

/// Length of the shortest channel; `usize::MAX` when there is none.
fn shortest(channels: &[&mut [f32]]) -> usize {
    channels.iter().map(|channel| channel.len()).min().unwrap_or(usize::MAX)
}
