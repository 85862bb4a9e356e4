//! The rate inside: never below 32 kHz.
//!
//! A pad that leaves a rough surface and meets it again does so hundreds of times a second and
//! within a tenth of a millisecond, and micro-relief of what is heard up to 8 kHz passes. So at
//! lower rates the whole engine runs at the smallest multiple from 32 kHz on, and one of so many
//! inner samples leaves. The relief fades with the way of a sample at 44.1 kHz whatever the rate is
//! (`Shared::noise_footprints`): it is the same ground. At 16 kHz outside, 32 inside, 16 kinds of
//! strokes meet as many collisions as at 48 inside, within 2 % in the median and 8 at most. Their
//! third octaves of 63 Hz to 7 kHz, within 40 dB of the strongest, move by 0.00 dB in the median;
//! what is felt by 0.3 and what is heard by 0.7 in 95 %. Strokes that are all blows move by up to
//! 3, and as much from 48 to 384 kHz inside. With a relief that fades as at 32 kHz a finger on
//! ridges lost 59 % of its collisions, and one on rough ground 2.7 dB. 16 kHz inside moves what is
//! felt by up to 12 dB.
//!
//! Nothing is filtered out before: bodies have no modes above half of the rate outside, and a
//! sampled displacement is what it was; of an acceleration the mean of the inner samples leaves,
//! which is the change of velocity over the outer one. What passes at once to a pickup folds.
//! [`Config::oversampling`](crate::Config::oversampling) multiplies what is so found, for renders
//! that are to be more exact than the outputs' rate allows. No latency is added: the look-ahead of
//! the contact model is one inner sample, and another inner sample is at hand where there are
//! several.

/// Lowest rate inside, Hz.
pub(crate) const LOWEST_INNER_HZ: f64 = 32_000.0;

/// Which of the inner samples leave.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct InnerRate {
    /// Inner samples for each that leaves.
    pub(crate) every: usize,
    /// Which of them leaves.
    at: usize,
}

/// Work that is not needed where every sample leaves stays out of the way of the rest.
impl InnerRate {
    /// Number of inner samples for each at `sample_rate_hz`.
    pub(crate) fn samples(sample_rate_hz: f64) -> usize {
        ((LOWEST_INNER_HZ / sample_rate_hz - 1e-9).ceil() as usize).max(1)
    }

    /// `every` inner samples for each that leaves, which lag by `latency_samples`: a whole number
    /// of outer samples is left of that.
    pub(crate) fn new(every: usize, latency_samples: usize) -> Self {
        Self { every, at: latency_samples % every }
    }

    /// Outer samples that are left of a lag in inner samples.
    pub(crate) fn lag(&self, inner_samples: usize) -> usize {
        (inner_samples - self.at.min(inner_samples)).div_ceil(self.every)
    }

    /// Tests whether an inner sample leaves.
    pub(crate) fn leaves(&self, sample: u64) -> bool {
        sample % self.every as u64 == self.at as u64
    }

    /// Copies what leaves of the inner samples from `position` on to the beginning of `out`;
    /// returns the index of the first among all that leave, and how many there are.
    #[cold]
    #[inline(never)]
    pub(crate) fn leaving(&self, position: u64, inner: &[f32], out: &mut [f32]) -> (u64, usize) {
        let every = self.every as u64;
        let first = (position + every - 1 - self.at as u64) / every;
        let skipped = (first * every + self.at as u64 - position) as usize;
        let leaving = inner.iter().skip(skipped).step_by(self.every);
        (first, out.iter_mut().zip(leaving).map(|(to, x)| *to = *x).count())
    }

    /// Means that leave; `mean` is what the first of them has come to already, and then the last.
    #[cold]
    #[inline(never)]
    pub(crate) fn leaving_means(
        &self,
        position: u64,
        inner: &[f32],
        mean: &mut f32,
        out: &mut [f32],
    ) -> (u64, usize) {
        let (every, share) = (self.every as u64, 1.0 / self.every as f32);
        let mut count = 0;
        for (sample, x) in (position..).zip(inner) {
            *mean += share * x;
            if (sample + 1).is_multiple_of(every) {
                out[count] = std::mem::take(mean);
                count += 1;
            }
        }
        (position / every, count)
    }

    /// Writes to `out` what leaves of the inner samples from `at` on.
    #[cold]
    #[inline(never)]
    pub(crate) fn pick(&self, at: usize, inner: &[f32], out: &mut [f32]) {
        if self.every == 1 {
            return out[at..at + inner.len()].copy_from_slice(inner);
        }
        let first = (self.at + self.every - at % self.every) % self.every;
        for (k, x) in inner.iter().enumerate().skip(first).step_by(self.every) {
            out[(at + k) / self.every] = *x;
        }
    }

    /// Adds to `out` the means of the inner samples from `at` on.
    #[cold]
    #[inline(never)]
    pub(crate) fn average(&self, at: usize, inner: &[f32], out: &mut [f32]) {
        let share = 1.0 / self.every as f32;
        for (k, x) in inner.iter().enumerate() {
            out[(at + k) / self.every] += share * x;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_inside_is_the_smallest_multiple_from_32_khz_on() {
        let inner = |rate_hz: f64| rate_hz * InnerRate::samples(rate_hz) as f64;
        assert_eq!(
            [8e3, 11_025.0, 16e3, 22_050.0, 32e3, 44_100.0, 48e3, 192e3].map(inner),
            [32e3, 33_075.0, 32e3, 44_100.0, 32e3, 44_100.0, 48e3, 192e3]
        );
    }

    #[test]
    fn what_leaves_does_not_depend_on_how_it_is_cut() {
        let inner: Vec<f32> = (0..60).map(|k| k as f32).collect();
        for (rate_hz, latency) in [(22_050.0, 1), (22_050.0, 0), (16e3, 1), (8e3, 1), (44_100.0, 1)] {
            let rate = InnerRate::new(InnerRate::samples(rate_hz), latency);
            let all = |cuts: &[usize]| {
                let (mut picked, mut means) = (vec![0.0; 60 / rate.every], vec![0.0; 60 / rate.every]);
                let (mut shown, mut shown_means, mut mean) = (Vec::new(), Vec::new(), 0.0);
                let mut show = |position: usize, block: &[f32]| {
                    let mut out = [0.0; 64];
                    let (first, count) = rate.leaving(position as u64, block, &mut out);
                    assert_eq!(first as usize, shown.len());
                    shown.extend_from_slice(&out[..count]);
                    let (first, count) = rate.leaving_means(position as u64, block, &mut mean, &mut out);
                    assert_eq!(first as usize, shown_means.len());
                    shown_means.extend_from_slice(&out[..count]);
                };
                for ends in cuts.windows(2) {
                    show(ends[0], &inner[ends[0]..ends[1]]);
                    rate.pick(ends[0], &inner[ends[0]..ends[1]], &mut picked);
                    rate.average(ends[0], &inner[ends[0]..ends[1]], &mut means);
                }
                assert_eq!((&shown, &shown_means), (&picked, &means));
                (picked, means)
            };
            assert_eq!(all(&[0, 60]), all(&[0, 1, 5, 6, 17, 18, 31, 59, 60]));
            let (picked, _) = all(&[0, 60]);
            let at = if rate.every == 1 { 0 } else { latency };
            assert!(picked.iter().enumerate().all(|(i, x)| *x == (i * rate.every + at) as f32));
            assert_eq!(rate.lag(latency), if rate.every == 1 { latency } else { 0 });
        }
    }
}
