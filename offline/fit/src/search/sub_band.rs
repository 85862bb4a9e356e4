//! The signal cut into complex, decimated bands in which exponentials stay exact exponentials.
//!
//! ```text
//! y_k[m] = Σ_{i < 15 D} h[i] · x[mD + i] · e^(−jπ k (mD + i)/D)         k = 0 … D
//! ```
//! Bands lie rate/(2D) apart and are decimated by D, so each covers twice its spacing and only
//! poles in its central half are kept. h is a Kaiser window design (β = 8, 15 D taps, half gain at
//! the decimated Nyquist frequency): flat over the central half, −80 dB where aliases fold onto it.
//! Every output lies wholly inside the data, which is what keeps exponentials exact: no filter
//! transient.
//!
//! All bands together cost one fold and one FFT of 2D points an output sample (weighted
//! overlap-add).

use asperity_dsp::bessel::bessel_i0;
use asperity_fft::FftPlanner;
use nalgebra::Complex;
use std::f64::consts::PI;

type C = Complex<f64>;

/// Filter length in decimated samples.
pub const TAPS_PER_SAMPLE: usize = 15;
/// Kaiser shape parameter: stop band near −80 dB.
const KAISER_BETA: f64 = 8.0;
/// Most decimated samples of a band that are used.
const MAX_SAMPLES: usize = 256;

/// One level of the analysis: a decimation factor and the window it implies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level {
    /// D: 1 means the signal as it is, in one band.
    pub decimation: usize,
}

impl Level {
    /// The levels for `samples` of signal, long windows (narrow bands) first.
    #[must_use]
    pub fn ladder(samples: usize) -> Vec<Self> {
        const SHORTEST_WINDOW: usize = 170;
        let mut decimation = 2;
        while samples / (decimation * 4) >= SHORTEST_WINDOW {
            decimation *= 4;
        }
        if samples / (decimation * 2) >= SHORTEST_WINDOW && decimation > 2 {
            decimation *= 2;
        }
        let mut levels = Vec::new();
        while decimation >= 2 {
            if samples >= decimation * (TAPS_PER_SAMPLE + 24) {
                levels.push(Self { decimation });
            }
            decimation = if decimation > 2 { (decimation / 4).max(2) } else { 0 };
        }
        if levels.is_empty() {
            levels.push(Self { decimation: 1 });
        }
        levels
    }

    /// Samples the filter spans: what is over by then is another level's business.
    #[must_use]
    pub fn span(self) -> usize {
        if self.decimation == 1 { 0 } else { TAPS_PER_SAMPLE * self.decimation }
    }

    /// Centre of band `k`, radians a sample.
    #[must_use]
    pub fn centre(self, k: usize) -> f64 {
        if self.decimation == 1 { 0.0 } else { PI * k as f64 / self.decimation as f64 }
    }
}

/// The bands of a level.
pub struct Bands {
    /// `bands[k][m]`: decimated samples of band k.
    pub bands: Vec<Vec<C>>,
    /// Variance of a band sample for white noise of unit variance.
    pub noise_gain: f64,
}

/// Splits `signal` into the bands of `level`.
#[must_use]
pub fn split(signal: &[f64], level: Level) -> Bands {
    let d = level.decimation;
    if d == 1 {
        let band = signal.iter().take(2 * MAX_SAMPLES).map(|&x| C::new(x, 0.0)).collect();
        return Bands { bands: vec![band], noise_gain: 1.0 };
    }
    let taps = kaiser_low_pass(d);
    let count = signal.len().saturating_sub(taps.len()).div_ceil(d).min(MAX_SAMPLES);
    let fft = FftPlanner::new().plan_fft_forward(2 * d);
    let mut scratch = vec![C::new(0.0, 0.0); fft.get_inplace_scratch_len()];
    let mut bands = vec![Vec::with_capacity(count); d + 1];
    let mut folded = vec![C::new(0.0, 0.0); 2 * d];
    for m in 0..count {
        folded.fill(C::new(0.0, 0.0));
        let frame = &signal[m * d..m * d + taps.len()];
        for (taps, frame) in taps.chunks(2 * d).zip(frame.chunks(2 * d)) {
            for ((sum, h), x) in folded.iter_mut().zip(taps).zip(frame) {
                sum.re += h * x;
            }
        }
        fft.process_with_scratch(&mut folded, &mut scratch);
        for (k, (band, &value)) in bands.iter_mut().zip(&folded).enumerate() {
            band.push(if k * m % 2 == 1 { -value } else { value });
        }
    }
    Bands { bands, noise_gain: taps.iter().map(|h| h * h).sum() }
}

/// Kaiser-windowed low-pass of unit gain, half gain at rate/(2 · decimation).
fn kaiser_low_pass(decimation: usize) -> Vec<f64> {
    let length = TAPS_PER_SAMPLE * decimation;
    let middle = (length as f64 - 1.0) / 2.0;
    let mut taps: Vec<f64> = (0..length)
        .map(|i| {
            let t = i as f64 - middle;
            let x = PI * t / decimation as f64;
            let sinc = if x.abs() < 1e-9 { 1.0 } else { x.sin() / x };
            let edge = t / (middle + 0.5);
            sinc * bessel_i0(KAISER_BETA * (1.0 - edge * edge).max(0.0).sqrt())
        })
        .collect();
    let sum: f64 = taps.iter().sum();
    taps.iter_mut().for_each(|h| *h /= sum);
    taps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sinusoid::partial::Partial;
    use crate::sinusoid::projection::synthesise;

    #[test]
    fn a_damped_sinusoid_stays_an_exact_exponential_in_its_band() {
        let level = Level { decimation: 8 };
        let partial = Partial { omega: 5.2 / 8.0 * PI, delta: 3e-3, c: C::new(1.0, 0.5) };
        let bands = split(&synthesise(&[partial], 3000), level);
        let band = &bands.bands[5];
        let expected = C::from_polar((-partial.delta * 8.0).exp(), 0.2 * PI);
        for pair in band.windows(2) {
            assert!((pair[1] / pair[0] - expected).norm() < 2e-3, "{}", pair[1] / pair[0]);
        }
    }

    #[test]
    fn white_noise_has_the_variance_in_a_band_that_its_gain_says() {
        let mut rng = asperity_dsp::rng::Rng::new(3);
        let noise: Vec<f64> = (0..40_000).map(|_| rng.normal()).collect();
        let bands = split(&noise, Level { decimation: 32 });
        let samples = &bands.bands[5..27];
        let count = samples.iter().map(Vec::len).sum::<usize>() as f64;
        let power: f64 = samples.iter().flatten().map(C::norm_sqr).sum::<f64>() / count;
        assert!((power / bands.noise_gain - 1.0).abs() < 0.06, "{power} {}", bands.noise_gain);
    }

    #[test]
    fn bands_reject_what_would_fold_onto_their_central_half() {
        let taps = kaiser_low_pass(16);
        let gain = |omega: f64| {
            let sum: C = taps.iter().enumerate().map(|(i, h)| C::from_polar(*h, omega * i as f64)).sum();
            sum.norm()
        };
        assert!((gain(0.25 * 2.0 * PI / 16.0) - 1.0).abs() < 1e-3);
        assert!(gain(0.75 * 2.0 * PI / 16.0) < 2e-4);
    }
}
