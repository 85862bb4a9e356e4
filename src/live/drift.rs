//! Two devices, two clocks: a small resampler that holds the fill of the buffer between them.
//!
//! The audio callback is the clock master and pushes haptic frames; the haptic callback pulls them
//! at its own pace. The reading speed is 1 plus a small correction, proportional and integral in
//! the deviation of the smoothed fill from its target, limited to ±[`MAX_CORRECTION`]: crystals
//! differ by up to ±200 ppm, and 0.1 % of pitch is far below what skin can tell. Frames between
//! samples are read by a cubic (Catmull–Rom); for haptics below 1 kHz at 44.1 kHz its error is
//! below −80 dB.

/// Largest change of reading speed.
pub const MAX_CORRECTION: f64 = 2e-3;
/// Time over which the fill is smoothed, s: much longer than a callback.
const SMOOTHING_S: f64 = 0.5;
/// Proportional gain: correction per relative deviation of the fill.
const PROPORTIONAL: f64 = 2e-3;
/// Integral gain, 1/s.
const INTEGRAL_PER_S: f64 = 2e-4;

/// Reads one ring of frames at a slowly adapting speed.
#[derive(Debug, Clone)]
pub struct DriftResampler {
    target_fill: f64,
    period_s: f64,
    smoothed_fill: f64,
    integral: f64,
    phase: f64,
    history: [f32; 4],
    underruns: u64,
    primed: bool,
}

impl DriftResampler {
    /// A reader that keeps about `target_fill` samples in the buffer at `sample_rate_hz`.
    #[must_use]
    pub fn new(target_fill: usize, sample_rate_hz: f64) -> Self {
        let target_fill = target_fill.max(8) as f64;
        Self {
            target_fill,
            period_s: 1.0 / sample_rate_hz,
            smoothed_fill: target_fill,
            integral: 0.0,
            phase: 0.0,
            history: [0.0; 4],
            underruns: 0,
            primed: false,
        }
    }

    /// Fills `out` from `pull`, which gives the next sample or none; `fill` is how many wait.
    /// Nothing is given until the buffer first holds the target.
    pub fn read(&mut self, fill: usize, out: &mut [f32], mut pull: impl FnMut() -> Option<f32>) {
        self.primed |= fill as f64 >= self.target_fill;
        if !self.primed {
            out.fill(0.0);
            return;
        }
        let speed = self.speed(fill as f64, out.len() as f64 * self.period_s);
        for y in out {
            self.phase += speed;
            while self.phase >= 1.0 {
                self.phase -= 1.0;
                self.history.rotate_left(1);
                // An empty buffer fades to the last value's neighbourhood rather than to a click.
                self.history[3] = pull().unwrap_or_else(|| {
                    self.underruns += 1;
                    0.95 * self.history[2]
                });
            }
            *y = catmull_rom(&self.history, self.phase as f32);
        }
    }

    fn speed(&mut self, fill: f64, elapsed_s: f64) -> f64 {
        let share = (elapsed_s / SMOOTHING_S).min(1.0);
        self.smoothed_fill += share * (fill - self.smoothed_fill);
        let deviation = self.smoothed_fill / self.target_fill - 1.0;
        self.integral =
            (self.integral + INTEGRAL_PER_S * deviation * elapsed_s).clamp(-MAX_CORRECTION, MAX_CORRECTION);
        1.0 + (PROPORTIONAL * deviation + self.integral).clamp(-MAX_CORRECTION, MAX_CORRECTION)
    }

    /// Samples that had to be invented because the buffer was empty.
    #[must_use]
    pub fn underruns(&self) -> u64 {
        self.underruns
    }
}

fn catmull_rom(h: &[f32; 4], t: f32) -> f32 {
    let a = 2.0 * h[1];
    let b = h[2] - h[0];
    let c = 2.0 * h[0] - 5.0 * h[1] + 4.0 * h[2] - h[3];
    let d = 3.0 * (h[1] - h[2]) + h[3] - h[0];
    0.5 * (a + t * (b + t * (c + t * d)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::VecDeque;

    /// Ten minutes of two callbacks of unequal size whose clocks differ by `ppm`; returns the range
    /// of the fill over the last nine and the reader.
    fn simulate(ppm: f64) -> (usize, usize, DriftResampler) {
        let rate = 48_000.0;
        let mut ring = VecDeque::new();
        let mut reader = DriftResampler::new(2048, rate);
        let (mut written, mut read, mut n) = (0.0, 0.0, 0u64);
        let (mut lowest, mut highest) = (usize::MAX, 0);
        let mut out = [0.0; 264];
        while read < 600.0 {
            if written <= read {
                for _ in 0..256 {
                    ring.push_back((n as f32 * 0.01).sin());
                    n += 1;
                }
                written += 256.0 / rate;
            } else {
                reader.read(ring.len(), &mut out, || ring.pop_front());
                read += 264.0 / (rate * (1.0 + ppm * 1e-6));
                if read > 60.0 {
                    lowest = lowest.min(ring.len());
                    highest = highest.max(ring.len());
                }
            }
        }
        (lowest, highest, reader)
    }

    #[test]
    fn clocks_that_differ_by_200_ppm_never_run_dry_or_over() {
        for ppm in [-200.0, -37.0, 0.0, 200.0] {
            let (lowest, highest, reader) = simulate(ppm);
            assert_eq!(reader.underruns(), 0, "{ppm} ppm");
            assert!(lowest > 500 && highest < 4096, "{ppm} ppm: fill {lowest}–{highest}");
        }
    }

    #[test]
    fn at_equal_clocks_samples_pass_with_their_values() {
        let mut reader = DriftResampler::new(64, 48_000.0);
        let mut ring: VecDeque<f32> = (0..4800).map(|n| (n as f32 * 0.05).sin()).collect();
        let mut out = vec![0.0; 2000];
        for block in out.chunks_mut(50) {
            reader.read(64, block, || ring.pop_front());
        }
        // Two samples of look-ahead, speed 1 within rounding.
        let worst = out[100..]
            .iter()
            .enumerate()
            .map(|(i, y)| (y - ((i + 98) as f32 * 0.05).sin()).abs())
            .fold(0.0, f32::max);
        assert!(worst < 1e-3, "{worst}");
    }
}
