//! Felt part of a displacement: its samples over the detection threshold.
//!
//! The [`THRESHOLD_DB`] is that of a fingertip. Between its points it is linear in log f; below the
//! first it is held, above the last it rises on by 40 dB an octave, which nobody has measured and
//! nobody feels. Phases stay as they are.

pub use asperity_dsp::sensation::THRESHOLD_DB;
use asperity_fft::{FftPlanner, PowerSpectra, hann, num_complex::Complex, samples_from};

/// Everything is compared at this rate, Hz.
pub const RATE_HZ: f64 = 8000.0;

/// Weight of a displacement by frequency, against 250 Hz where most is felt: 1 there, 0.01 where
/// the threshold is 40 dB higher.
#[must_use]
pub fn weight(frequency_hz: f64) -> f64 {
    let (last_hz, last_db) = THRESHOLD_DB[THRESHOLD_DB.len() - 1];
    let mut db = THRESHOLD_DB[0].1;
    for pair in THRESHOLD_DB.windows(2) {
        let part = (frequency_hz / pair[0].0).ln() / (pair[1].0 / pair[0].0).ln();
        if part > 0.0 {
            db = pair[0].1 + part.min(1.0) * (pair[1].1 - pair[0].1);
        }
    }
    if frequency_hz > last_hz {
        db = last_db + 40.0 * (frequency_hz / last_hz).log2();
    }
    10f64.powf((-24.0 - db) / 20.0)
}

/// A length that transforms fast: with room behind the samples, so that the end does not wrap into
/// the beginning.
pub(crate) fn padded(count: usize) -> usize {
    let least = count + 2048;
    let mut best = least.next_power_of_two();
    for factor in [3, 5, 9, 15] {
        let length = factor * (least.div_ceil(factor)).next_power_of_two();
        best = best.min(length);
    }
    best
}

/// Samples times a real function of frequency; the mean is left out.
pub(crate) fn shaped(samples: &[f64], rate_hz: f64, gain: impl Fn(f64) -> f64) -> Vec<f64> {
    spectrum_times(samples, rate_hz, gain).iter().take(samples.len()).map(|z| z.re).collect()
}

/// The analytic signal of samples times a function of frequency.
pub(crate) fn analytic(samples: &[f64], rate_hz: f64, gain: impl Fn(f64) -> f64) -> Vec<Complex<f64>> {
    let mut z = spectrum_times(samples, rate_hz, |hz| if hz > 0.0 { 2.0 * gain(hz) } else { 0.0 });
    z.truncate(samples.len());
    z
}

/// `gain` gets negative frequencies where it wants to tell them apart; real ones come in pairs.
fn spectrum_times(samples: &[f64], rate_hz: f64, gain: impl Fn(f64) -> f64) -> Vec<Complex<f64>> {
    let length = padded(samples.len());
    let mut planner = FftPlanner::new();
    let mut z: Vec<_> = samples.iter().map(|x| Complex::new(*x, 0.0)).collect();
    z.resize(length, Complex::new(0.0, 0.0));
    planner.plan_fft_forward(length).process(&mut z);
    for (bin, z) in z.iter_mut().enumerate() {
        let signed = if bin <= length / 2 { bin as f64 } else { bin as f64 - length as f64 };
        let hz = signed * rate_hz / length as f64;
        *z *= if bin == 0 { 0.0 } else { gain(hz) / length as f64 };
    }
    planner.plan_fft_inverse(length).process(&mut z);
    z
}

/// Samples at [`RATE_HZ`], weighted by what is felt.
#[must_use]
pub fn felt(samples: &[f64]) -> Vec<f64> {
    shaped(samples, RATE_HZ, |hz| weight(hz.abs()))
}

/// Mean power of each bin of windows of 4096 samples (1.95 Hz), Hann, half overlapping; the sum is
/// the mean square.
pub(crate) fn power(samples: &[f64]) -> Vec<f64> {
    const LENGTH: usize = 4096;
    let spectra = PowerSpectra::new(hann(LENGTH, 0.0), LENGTH);
    let mut power = vec![0.0; LENGTH / 2];
    // Windows that hang over both ends, so that every sample counts alike.
    for start in (-(LENGTH as isize) / 2..samples.len() as isize).step_by(LENGTH / 2) {
        for (sum, bin) in power.iter_mut().zip(spectra.of(samples_from(samples, start))) {
            *sum += 2.0 * bin / LENGTH as f64;
        }
    }
    // Windows of Hann squared, half overlapping, sum to 3/4 on the mean.
    let scale = 1.0 / (0.75 * samples.len().max(1) as f64);
    power.iter_mut().for_each(|p| *p *= scale);
    power
}

/// Frequency of a bin of [`power`], Hz.
pub(crate) fn bin_hz(bin: usize) -> f64 {
    bin as f64 * RATE_HZ / 4096.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_sine_is_weighted_by_its_threshold_and_keeps_its_phase() {
        for (frequency_hz, db) in [(40.0, -26.0), (100.0, -9.0), (250.0, 0.0), (400.0, -7.0)] {
            let x: Vec<f64> = (0..16_000).map(|n| (TAU * frequency_hz * n as f64 / RATE_HZ).sin()).collect();
            let y = felt(&x);
            let gain = 10f64.powf(db / 20.0);
            let worst = (4000..12_000).map(|n| (y[n] - gain * x[n]).abs()).fold(0.0, f64::max);
            assert!(worst < 0.02 * gain, "{frequency_hz} Hz: {worst} of {gain}");
        }
    }

    #[test]
    fn the_power_of_a_spectrum_is_that_of_the_samples() {
        let x: Vec<f64> = (0..20_000).map(|n| (TAU * 130.0 * n as f64 / RATE_HZ).sin()).collect();
        let sum: f64 = power(&x).iter().sum();
        assert!((sum - 0.5).abs() < 0.01, "{sum}");
    }
}
