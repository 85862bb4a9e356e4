//! Synthetic impacts with known truth, the joint Cramér–Rao bound, and scoring against both.
#![allow(dead_code)]

pub mod noise;

use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use nalgebra::{Cholesky, DMatrix};
use std::f64::consts::PI;

/// A made impact: 50 Hz – 16 kHz log-uniform, T60 30 ms – 4 s, 50 dB of amplitudes, a tenth of the
/// modes in pairs 1 Hz apart, white noise at `snr_db` of the mean power.
pub struct Impact {
    pub rate_hz: f64,
    pub clean: Vec<f64>,
    pub noisy: Vec<f64>,
    pub noise_std: f64,
    pub truth: Vec<Mode>,
}

pub fn impact(modes: usize, snr_db: f64, seed: u64, rate_hz: f64, seconds: f64) -> Impact {
    let mut rng = Rng::new(seed ^ 0x5eed_0000);
    let draw = |rng: &mut Rng| Mode {
        frequency_hz: 50.0 * (320.0_f64).powf(rng.uniform()),
        decay_per_s: 3.0 * std::f64::consts::LN_10 / (0.03 * (4.0_f64 / 0.03).powf(rng.uniform())),
        amplitude: 10.0_f64.powf(-2.5 * rng.uniform()),
        phase_rad: 2.0 * PI * rng.uniform() - PI,
    };
    let pairs = (modes / 20).max(usize::from(modes >= 10));
    let mut truth: Vec<Mode> = Vec::new();
    for _ in 0..modes - pairs {
        truth.push(draw(&mut rng));
    }
    for k in 0..pairs {
        let partner = draw(&mut rng);
        truth.push(Mode { frequency_hz: truth[k].frequency_hz + 1.0, ..partner });
    }
    with_noise(truth, snr_db, &mut rng, rate_hz, seconds)
}

pub fn with_noise(truth: Vec<Mode>, snr_db: f64, rng: &mut Rng, rate_hz: f64, seconds: f64) -> Impact {
    let clean = render(&truth, rate_hz, (rate_hz * seconds) as usize);
    let power = clean.iter().map(|x| x * x).sum::<f64>() / clean.len() as f64;
    let noise_std = (power * 10.0_f64.powf(-snr_db / 10.0)).sqrt();
    let noisy = clean.iter().map(|x| x + noise_std * rng.normal()).collect();
    Impact { rate_hz, clean, noisy, noise_std, truth }
}

pub fn render(modes: &[Mode], rate_hz: f64, count: usize) -> Vec<f64> {
    let mut out = vec![0.0; count];
    for mode in modes {
        for (n, x) in out.iter_mut().enumerate() {
            let t = n as f64 / rate_hz;
            *x += mode.amplitude
                * (-mode.decay_per_s * t).exp()
                * (2.0 * PI * mode.frequency_hz * t + mode.phase_rad).sin();
        }
    }
    out
}

/// Standard deviations (f Hz, d 1/s, relative a, phase) no unbiased estimator can go below.
pub fn cramer_rao(modes: &[Mode], rate_hz: f64, count: usize, noise_std: f64) -> Vec<[f64; 4]> {
    let size = 4 * modes.len();
    let mut gram = DMatrix::<f64>::zeros(size, size);
    let mut start = 0;
    while start < count {
        let rows = (count - start).min(2048);
        let mut jacobian = DMatrix::<f64>::zeros(rows, size);
        for (k, mode) in modes.iter().enumerate() {
            for row in 0..rows {
                let t = (start + row) as f64 / rate_hz;
                let e = (-mode.decay_per_s * t).exp();
                let angle = 2.0 * PI * mode.frequency_hz * t + mode.phase_rad;
                let (s, c) = (e * angle.sin(), e * angle.cos());
                jacobian[(row, 4 * k)] = 2.0 * PI * t * mode.amplitude * c;
                jacobian[(row, 4 * k + 1)] = -t * mode.amplitude * s;
                jacobian[(row, 4 * k + 2)] = mode.amplitude * s;
                jacobian[(row, 4 * k + 3)] = mode.amplitude * c;
            }
        }
        gram += jacobian.transpose() * jacobian;
        start += rows;
    }
    let scale: Vec<f64> = (0..size).map(|i| 1.0 / gram[(i, i)].sqrt()).collect();
    let scaled = DMatrix::from_fn(size, size, |i, j| gram[(i, j)] * scale[i] * scale[j]);
    let inverse = [0.0, 1e-14, 1e-12]
        .iter()
        .find_map(|ridge| {
            Cholesky::new(&scaled + DMatrix::identity(size, size) * *ridge).map(|c| c.inverse())
        })
        .expect("the bound of these modes exists");
    let std = |i: usize| noise_std * inverse[(i, i)].sqrt() * scale[i];
    (0..modes.len()).map(|k| [std(4 * k), std(4 * k + 1), std(4 * k + 2), std(4 * k + 3)]).collect()
}

/// Whether the data can tell this mode at all.
pub fn identifiable(mode: &Mode, bound: &[f64; 4]) -> bool {
    bound[2] < 0.15
        && bound[1] < 0.3 * mode.decay_per_s
        && bound[0] < 0.15 * mode.decay_per_s / (2.0 * PI) + 0.05
}

#[derive(Debug, Clone, Default)]
pub struct Score {
    pub identifiable: usize,
    pub missed: usize,
    pub spurious: usize,
    /// Errors over bound of f and d, of matched identifiable modes.
    pub f_ratio: Vec<f64>,
    pub d_ratio: Vec<f64>,
    pub snr_db: f64,
    pub limit_db: f64,
    pub missed_modes: Vec<(Mode, [f64; 4])>,
    pub spurious_modes: Vec<Mode>,
}

impl Score {
    pub fn within_four_bounds(&self) -> f64 {
        let good = self.f_ratio.iter().zip(&self.d_ratio).filter(|(f, d)| f.abs() < 4.0 && d.abs() < 4.0);
        good.count() as f64 / self.f_ratio.len().max(1) as f64
    }
}

/// median |ratio| / 0.6745
pub fn robust_rms(ratios: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = ratios.iter().map(|r| r.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    if sizes.is_empty() { 0.0 } else { sizes[sizes.len() / 2] / 0.6745 }
}

pub fn snr_db(clean: &[f64], made: &[f64]) -> f64 {
    let signal: f64 = clean.iter().map(|x| x * x).sum();
    let error: f64 = clean.iter().zip(made).map(|(x, y)| (x - y) * (x - y)).sum();
    10.0 * (signal / error.max(1e-300)).log10()
}

/// One-to-one matching by frequency, nearest pairs (in bounds) first; a pair further apart than 8
/// bounds or half a bandwidth does not match.
pub fn score(impact: &Impact, bounds: &[[f64; 4]], found: &[Mode]) -> Score {
    let mut pairs = Vec::new();
    for (t, (truth, bound)) in impact.truth.iter().zip(bounds).enumerate() {
        let width = truth.decay_per_s / (2.0 * PI);
        let tolerance = (8.0 * bound[0]).max(0.05).min(0.5 * width + 8.0 * bound[0]).min(2.0 * width + 0.5);
        for (f, mode) in found.iter().enumerate() {
            let gap = (mode.frequency_hz - truth.frequency_hz).abs();
            if gap < tolerance {
                let decays = (mode.decay_per_s - truth.decay_per_s).abs() / bound[1];
                // What cannot be told apart must not take what can.
                let last = if identifiable(truth, bound) { 0.0 } else { 1e6 };
                pairs.push((last + gap / bound[0] + decays.min(20.0), t, f));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut of_truth, mut of_found) = (vec![None; impact.truth.len()], vec![None; found.len()]);
    for (_, t, f) in pairs {
        if of_truth[t].is_none() && of_found[f].is_none() {
            of_truth[t] = Some(f);
            of_found[f] = Some(t);
        }
    }
    let mut score = Score::default();
    for (t, (truth, bound)) in impact.truth.iter().zip(bounds).enumerate() {
        if !identifiable(truth, bound) {
            continue;
        }
        score.identifiable += 1;
        match of_truth[t] {
            None => {
                score.missed += 1;
                score.missed_modes.push((*truth, *bound));
            }
            Some(f) => {
                score.f_ratio.push((found[f].frequency_hz - truth.frequency_hz) / bound[0]);
                score.d_ratio.push((found[f].decay_per_s - truth.decay_per_s) / bound[1]);
            }
        }
    }
    for (f, of) in of_found.iter().enumerate() {
        if of.is_none() {
            score.spurious += 1;
            score.spurious_modes.push(found[f]);
        }
    }
    let made = render_fast(found, impact.rate_hz, impact.clean.len());
    score.snr_db = snr_db(&impact.clean, &made);
    let signal: f64 = impact.clean.iter().map(|x| x * x).sum();
    let count = 4.0 * impact.truth.len() as f64;
    score.limit_db = 10.0 * (signal / (count * impact.noise_std.powi(2))).log10();
    score
}

/// [`render`] by recurrence.
pub fn render_fast(modes: &[Mode], rate_hz: f64, count: usize) -> Vec<f64> {
    let mut out = vec![0.0; count];
    for mode in modes {
        let pole = nalgebra::Complex::from_polar(
            (-mode.decay_per_s / rate_hz).exp(),
            2.0 * PI * mode.frequency_hz / rate_hz,
        );
        let mut z = nalgebra::Complex::from_polar(mode.amplitude, mode.phase_rad);
        for x in &mut out {
            *x += z.im;
            z *= pole;
        }
    }
    out
}

/// The usual baseline: peaks of a short-time spectrum, decay from a line through their levels in dB.
pub fn stft_peaks(samples: &[f64], rate_hz: f64, most: usize) -> Vec<Mode> {
    let size = 4096.min(samples.len().next_power_of_two() / 2).max(64);
    let hop = size / 8;
    let window: Vec<f64> =
        (0..size).map(|i| 0.5 - 0.5 * (2.0 * PI * (i as f64 + 0.5) / size as f64).cos()).collect();
    let mut planner = rustfft::FftPlanner::new();
    let fft = planner.plan_fft_forward(size);
    let frames: Vec<Vec<nalgebra::Complex<f64>>> = (0..64)
        .map_while(|f| samples.get(f * hop..f * hop + size))
        .map(|frame| {
            let mut buffer: Vec<_> =
                frame.iter().zip(&window).map(|(x, w)| nalgebra::Complex::new(x * w, 0.0)).collect();
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
            let pole = nalgebra::Complex::from_polar(
                (-decay_per_s / rate_hz).exp(),
                2.0 * PI * frequency_hz / rate_hz,
            );
            let (mut power, mut up, mut down) =
                (nalgebra::Complex::new(1.0, 0.0), nalgebra::Complex::new(0.0, 0.0), 0.0);
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

/// What `independent/cramer_rao.py` prints.
pub const NUMPY_BOUNDS: [[f64; 4]; 3] = [
    [
        0.001_140_086_167_825_711_7,
        0.007_170_316_718_234_169_6,
        0.003_296_938_007_641_666,
        0.003_290_967_153_447_774,
    ],
    [
        0.004_506_691_716_099_619,
        0.028_257_643_236_233_757,
        0.007_404_124_989_189_170_5,
        0.007_413_526_169_765_97,
    ],
    [0.165_671_722_749_269_92, 1.030_009_674_489_012_2, 0.012_030_206_303_169_083, 0.012_287_204_201_892_14],
];

/// Time this thread has run, which other work on the machine does not lengthen much.
pub fn cpu_seconds() -> f64 {
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse::<f64>().ok())
        .map_or_else(
            || {
                let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
                now.map_or(0.0, |now| now.as_secs_f64())
            },
            |ns| ns * 1e-9,
        )
}

/// Most memory this process ever held, MiB; 0 where the system does not say.
pub fn peak_mib() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok())
        .map_or(0.0, |kb| kb / 1024.0)
}
