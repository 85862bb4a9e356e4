//! Authored clips.

use super::Scene;
use crate::link::message::Message;
use crate::model::clip::Clip;
use crate::model::error::Refusal;
use crate::model::event::ChannelId;
use crate::resource::clip::PlayingClip;
use std::sync::atomic::Ordering::Relaxed;

impl Scene {
    /// Plays a clip on a haptic channel from game time `time_s` on, beside what is rendered: it is
    /// added to the channel's sum, so the user's gain, the equaliser and the limiters act on both.
    /// Its ends are faded over 2 ms. At most 32 play at once; more are dropped and counted in
    /// [`Stats::clips_dropped`](crate::Stats::clips_dropped). Recordings hold no clips, and a
    /// change of the sample rate ends them.
    ///
    /// ```
    /// use asperity::{ChannelId, Clip, Config, Engine};
    ///
    /// let Engine { mut scene, .. } = Config::live(48_000.0).build()?;
    /// let hum: Vec<f32> = (0..800).map(|n| 0.5 * (0.12 * n as f32).sin()).collect();
    /// scene.play_clip(0.0, ChannelId(0), &Clip { ducking: 0.3, ..Clip::new(hum, 8000.0) })?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When there is no such channel, a number is out of its range or the queue is full.
    pub fn play_clip(&mut self, time_s: f64, channel: ChannelId, clip: &Clip) -> Result<(), Refusal> {
        clip.check()?;
        let (index, channels) = (usize::from(channel.0), self.config.actuators.len());
        let unknown = Refusal::UnknownActuator { index: channel.0, channels };
        let actuator = self.config.actuators.get(index).ok_or(unknown)?;
        let (full_scale, rate_hz) = (actuator.full_scale, self.config.inner_rate_hz());
        self.checked_time(time_s)?;
        let position = self.counters.position.load(Relaxed);
        let starts = self.clock.stamp(time_s, position, false).stamp.sample();
        self.show_epochs();
        let clip = PlayingClip::new(clip, (index, full_scale), starts, rate_hz);
        self.collect();
        self.send_event(Message::PlayClip(Box::new(clip)))
    }
}
