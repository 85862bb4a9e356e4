//! Outputs of a render beyond full scale, and limiters that work too hard.

use super::{Rendered, peak};

/// A limiter that works as hard as that is heard and felt, dB; and one that the scene asks for.
const HARD_DB: f64 = 6.0;
const ASKED_HARD_DB: f64 = 12.0;

impl Rendered<'_> {
    pub(super) fn too_loud(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        let heard = self.render.audio.iter().map(|bus| peak(bus)).fold(0.0, f32::max);
        if heard > 1.0 {
            sentences.push(format!(
                "the audio exceeds full scale (peak {heard:.2}): lower gain under [audio], or write limit = true there"
            ));
        }
        let felt = self.render.haptic.iter().map(|channel| peak(channel)).enumerate();
        sentences.extend(felt.filter(|(_, peak)| *peak > 1.0).map(|(channel, peak)| {
            format!(
                "haptic channel {channel} peaks at {peak:.2} of full scale: raise full_scale of its [[actuator]], or write \
                 limit = true there"
            )
        }));
        sentences.extend(self.turned_down());
        sentences
    }

    fn turned_down(&self) -> Option<String> {
        let (by_db, levels) = (self.render.limiter_db, self.levels);
        let asked = self.file.audio.iter().any(|bus| bus.limit == Some(true))
            || self.file.actuators.iter().any(|actuator| actuator.limit_peaks == Some(true));
        let gain = match levels.gain.as_slice() {
            [only] => only.to_string(),
            all => format!("{all:?}"),
        };
        (by_db > if asked { ASKED_HARD_DB } else { HARD_DB }).then(|| {
            format!(
                "a limiter turned down by up to {by_db:.1} dB: lower gain under [audio], strike_gain of the [[body]], or raise full_scale of the [[actuator]] (in use: \
                 gain {gain}, full_scale {:?})",
                levels.full_scale
            )
        })
    }
}
