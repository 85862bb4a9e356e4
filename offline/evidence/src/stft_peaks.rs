//! The baseline of mode extraction: peaks of a short-time spectrum.

use asperity_dsp::mode::Mode;
use asperity_fft::{FftPlanner, num_complex::Complex};
use std::f64::consts::PI;

/// The usual baseline: peaks of a short-time spectrum, decay from a line through their levels in
/// dB.
pub fn stft_peaks(samples: &[f64], rate_hz: f64, most: usize) -> Vec<Mode> {
    let size = 4096.min(samples.len().next_power_of_two() / 2).max(64);
    let hop = size / 8;
    let window: Vec<f64> =
        (0..size).map(|i| 0.5 - 0.5 * (2.0 * PI * (i as f64 + 0.5) / size as f64).cos()).collect();
    let mut planner = FftPlanner::new();
    let fft = planner.plan_fft_forward(size);
    let frames: Vec<Vec<Complex<f64>>> = (0..64)
        .map_while(|f| samples.get(f * hop..f * hop + size))
        .map(|frame| {
            let mut buffer: Vec<_> =
                frame.iter().zip(&window).map(|(x, w)| Complex::new(x * w, 0.0)).collect();
            fft.process(&mut buffer);
            buffer
        })
        .collect();
    let Some(first) = frames.first() else { return Vec::new() };
    let level = |f: usize, k: usize| frames[f][k].norm().max(1e-12).ln();
    let mut peaks: Vec<usize> = (2..size / 2 - 2)
        .filter(|&k| first[k].norm() > first[k - 1].norm() && first[k].norm() >= first[k + 1].norm())
        .collect();
    peaks.sort_by(|&a, &b| first[b].norm().total_cmp(&first[a].norm()));
    peaks.truncate(most);
    peaks
        .into_iter()
        .map(|k| {
            let (a, b, c) = (level(0, k - 1), level(0, k), level(0, k + 1));
            let shift = 0.5 * (a - c) / (a - 2.0 * b + c).min(-1e-9);
            let frequency_hz = (k as f64 + shift) * rate_hz / size as f64;
            // Levels down to 30 dB under the first.
            let used: Vec<(f64, f64)> = (0..frames.len())
                .map(|f| ((f * hop) as f64 / rate_hz, level(f, k)))
                .take_while(|(_, l)| *l > b - 3.5)
                .collect();
            let n = used.len() as f64;
            let (mt, ml) =
                (used.iter().map(|u| u.0).sum::<f64>() / n, used.iter().map(|u| u.1).sum::<f64>() / n);
            let slope = used.iter().map(|u| (u.0 - mt) * (u.1 - ml)).sum::<f64>()
                / used.iter().map(|u| (u.0 - mt).powi(2)).sum::<f64>().max(1e-12);
            let decay_per_s = (-slope).clamp(0.2, 1500.0);
            // Amplitude and phase from the first frame's transform at the mode's own pole.
            let pole = Complex::from_polar((-decay_per_s / rate_hz).exp(), 2.0 * PI * frequency_hz / rate_hz);
            let (mut power, mut up, mut down) = (Complex::new(1.0, 0.0), Complex::new(0.0, 0.0), 0.0);
            for (x, w) in samples.iter().zip(&window) {
                up += power.conj() * x * w;
                down += power.norm_sqr() * w;
                power *= pole;
            }
            let c = up * 2.0 / down;
            Mode { frequency_hz, decay_per_s, amplitude: c.norm(), phase_rad: c.arg() + 0.5 * PI }
        })
        .collect()
}
