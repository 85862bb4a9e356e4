//! Authored clips beside what is rendered: added to the sum of their channel, before its filters,
//! gain and limiters; strokes are ducked meanwhile.

use super::outputs::HapticChannel;
use crate::audio::smoothed::Smoothed;
use crate::link::message::Retired;
use crate::link::ring::Sender;
use crate::resource::clip::PlayingClip;

/// Clips that play at the same time.
pub(super) const AT_ONCE: usize = 32;

/// Clips that play, or wait for their time.
pub(super) struct Clips {
    #[allow(clippy::vec_box, reason = "they go home as they came")]
    playing: Vec<Box<PlayingClip>>,
    /// Gain of strokes, by channel.
    ducked: Box<[Smoothed]>,
}

impl Clips {
    pub(super) fn new(channels: usize, sample_rate_hz: f64) -> Self {
        Self {
            playing: Vec::with_capacity(AT_ONCE),
            ducked: vec![Smoothed::new(sample_rate_hz); channels].into(),
        }
    }

    /// A clip comes; one too many is handed back. What is late begins at once.
    pub(super) fn add(&mut self, mut clip: Box<PlayingClip>, position: u64) -> Result<(), Box<PlayingClip>> {
        if self.playing.len() == AT_ONCE {
            return Err(clip);
        }
        clip.starts = clip.starts.max(position);
        self.playing.push(clip);
        Ok(())
    }

    /// Adds the clips of a channel to the `n` samples from `position` on.
    pub(super) fn mix(&mut self, index: usize, position: u64, n: usize, channel: &mut HapticChannel) {
        let end = position + n as u64;
        let of_channel =
            |clip: &PlayingClip| clip.channel == index && clip.starts < end && clip.ends() > position;
        let ducked = &mut self.ducked[index];
        if self.playing.is_empty() && ducked.settled_at(1.0) {
            return;
        }
        let (sum, _) = channel.begun(n);
        for (i, x) in sum.iter_mut().enumerate() {
            let at = position + i as u64;
            let over = self
                .playing
                .iter()
                .filter(|clip| of_channel(clip))
                .filter(|clip| (clip.starts..clip.ends()).contains(&at));
            *x *= ducked.tick(over.fold(1.0, |least, clip| clip.ducking.min(least)));
        }
        for clip in self.playing.iter().filter(|clip| of_channel(clip)) {
            let from = clip.starts.max(position);
            let values = &clip.samples[(from - clip.starts) as usize..];
            sum[(from - position) as usize..].iter_mut().zip(values).for_each(|(x, clip)| *x += clip);
        }
    }

    /// Sends clips that are over home.
    pub(super) fn tidy(&mut self, position: u64, home: &mut Sender<Retired>) {
        while home.free() > 0
            && let Some(over) = self.playing.iter().position(|clip| clip.ends() <= position)
        {
            let _ = home.send(Retired::Clip(self.playing.remove(over)));
        }
    }
}
