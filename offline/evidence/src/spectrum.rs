//! Spectra of signals: power, third-octave levels as vibration and sound are compared, the
//! strongest line.

use asperity_fft::{FftPlanner, PowerSpectra, hann, num_complex::Complex, samples_from};

/// Levels of the third octaves from 25 Hz to 10 kHz, dB re 1 (rms²); Welch's method with Hann
/// windows.
pub fn third_octaves_db(x: &[f32], rate_hz: f64) -> Vec<f64> {
    third_octaves_from_db(x, rate_hz, 8192, 25.0, 27)
}

/// Levels of `bands` third octaves from `first_hz` on, from spectra of `length` samples.
pub fn third_octaves_from_db(x: &[f32], rate_hz: f64, length: usize, first_hz: f64, bands: u32) -> Vec<f64> {
    let power = power_spectrum(x, length);
    let bin_hz = rate_hz / length as f64;
    (0..bands)
        .map(|band| {
            let centre_hz = first_hz * 2f64.powf(f64::from(band) / 3.0);
            let (low, high) = (centre_hz * 2f64.powf(-1.0 / 6.0), centre_hz * 2f64.powf(1.0 / 6.0));
            let inside = |bin: &usize| (low..high).contains(&(*bin as f64 * bin_hz));
            let sum: f64 = (0..power.len()).filter(inside).map(|bin| power[bin]).sum();
            10.0 * sum.max(1e-30).log10()
        })
        .collect()
}

/// Mean power of each bin up to Nyquist; the sum is the mean square.
pub fn power_spectrum(x: &[f32], length: usize) -> Vec<f64> {
    let spectra = PowerSpectra::new(hann(length, 0.0), length);
    let energy = spectra.energy();
    let mut power = vec![0.0; length / 2];
    let starts: Vec<usize> = (0..=x.len().saturating_sub(length)).step_by(length / 2).collect();
    for start in &starts {
        for (sum, bin) in power.iter_mut().zip(spectra.of(samples_from(x, *start as isize))) {
            *sum += 2.0 * bin / (energy * length as f64) / starts.len() as f64;
        }
    }
    power
}

/// The bin of the strongest line of the whole signal, unwindowed, above 0 Hz and below Nyquist.
pub fn strongest_bin(x: &[f32]) -> usize {
    let mut spectrum: Vec<_> = x.iter().map(|x| Complex::new(f64::from(*x), 0.0)).collect();
    FftPlanner::new().plan_fft_forward(spectrum.len()).process(&mut spectrum);
    (1..spectrum.len() / 2).max_by(|a, b| spectrum[*a].norm().total_cmp(&spectrum[*b].norm())).unwrap_or(0)
}
