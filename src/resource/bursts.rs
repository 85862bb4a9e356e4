//! Bursts that sound: what strikes on one body play of its residual.

use crate::model::residual::Residual;

/// Bursts of one body that sound at the same time; a further strike takes the place of the one that
/// is nearest to its end.
pub const AT_ONCE: usize = 8;

/// The bursts of one body that are sounding.
pub(crate) struct Bursts {
    /// The burst of an impulse of 1 N·s at the engine's rate.
    burst: Box<[f32]>,
    playing: [Playing; AT_ONCE],
    /// The sample from which on none plays.
    busy_until: u64,
}

#[derive(Clone, Copy, Default)]
struct Playing {
    /// Absolute sample of the burst's first and one past its last.
    start: u64,
    end: u64,
    gain: f32,
}

impl Bursts {
    /// The bursts of a body with this residual, if any, whose model answers `impulse_n_s`.
    pub(crate) fn new(residual: Option<&Residual>, impulse_n_s: f64, sample_rate_hz: f64) -> Self {
        let mut burst = residual.map_or_else(Box::default, |residual| residual.at_rate(sample_rate_hz));
        burst.iter_mut().for_each(|x| *x = (f64::from(*x) / impulse_n_s) as f32);
        Self { burst, playing: [Playing::default(); AT_ONCE], busy_until: 0 }
    }

    /// A strike of `impulse_n_s` whose contact begins at absolute sample `start`.
    pub(crate) fn strike(&mut self, start: u64, impulse_n_s: f64) {
        if self.burst.is_empty() {
            return;
        }
        let next = Playing { start, end: start + self.burst.len() as u64, gain: impulse_n_s as f32 };
        if let Some(oldest) = self.playing.iter_mut().min_by_key(|playing| playing.end) {
            *oldest = next;
            self.busy_until = self.busy_until.max(next.end);
        }
    }

    /// Tests whether nothing sounds from `position` on.
    pub(crate) fn silence(&mut self) {
        (self.playing, self.busy_until) = ([Playing::default(); AT_ONCE], 0);
    }

    /// Tests whether none plays or will.
    pub(crate) fn is_silent(&self, position: u64) -> bool {
        self.busy_until <= position
    }

    /// Adds the samples from `position` on to `out`.
    pub(crate) fn render(&self, position: u64, out: &mut [f32]) {
        if self.is_silent(position) {
            return;
        }
        let end = position + out.len() as u64;
        for playing in &self.playing {
            let (from, to) = (playing.start.max(position), playing.end.min(end));
            if from >= to {
                continue;
            }
            let heard = self.burst.get((from - playing.start) as usize..(to - playing.start) as usize);
            let into = out.get_mut((from - position) as usize..(to - position) as usize);
            if let (Some(heard), Some(into)) = (heard, into) {
                into.iter_mut().zip(heard).for_each(|(sum, x)| *sum += playing.gain * x);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn click() -> Residual {
        let at = |n: i32| (0.2 * f64::from(n)).sin() * (-0.01 * f64::from(n)).exp();
        Residual { sample_rate_hz: 44_100.0, samples: (0..900).map(|n| at(n) as f32).collect() }
    }

    #[test]
    fn strikes_add_up_and_the_ninth_takes_the_oldest_place() {
        let mut bursts = Bursts::new(Some(&click()), 0.01, 44_100.0);
        for strike in 0..9 {
            bursts.strike(10 * strike, 0.01);
        }
        let mut out = [0.0f32; 64];
        bursts.render(200, &mut out);
        let samples = click().samples;
        let expected: f32 = (1..9).map(|strike| samples[(200 - 10 * strike) as usize]).sum();
        assert!((out[0] - expected).abs() < 1e-6);
        assert!(!bursts.is_silent(200) && bursts.is_silent(80 + 900));
        assert!(Bursts::new(None, 1.0, 44_100.0).is_silent(0));
    }
}
