//! Synthetic impacts of known truth: modes struck at once, and white noise.

use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use nalgebra::Complex;
use std::f64::consts::PI;

/// A made impact; those of [`fn@impact`]: 50 Hz – 16 kHz log-uniform, T60 30 ms – 4 s, 50 dB of
/// amplitudes, a tenth of the modes in pairs 1 Hz apart, white noise at `snr_db` of the mean power.
#[derive(Debug)]
pub struct Impact {
    /// Samples a second.
    pub rate_hz: f64,
    /// The modes alone.
    pub clean: Vec<f64>,
    /// The modes and the noise.
    pub noisy: Vec<f64>,
    /// Standard deviation of the noise.
    pub noise_std: f64,
    /// The modes; time 0 is the first sample.
    pub truth: Vec<Mode>,
}

/// An impact of so many modes.
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

/// An impact of these modes, white noise at `snr_db` of the mean power.
pub fn with_noise(truth: Vec<Mode>, snr_db: f64, rng: &mut Rng, rate_hz: f64, seconds: f64) -> Impact {
    let clean = render(&truth, rate_hz, (rate_hz * seconds) as usize);
    let power = clean.iter().map(|x| x * x).sum::<f64>() / clean.len() as f64;
    let noise_std = (power * 10.0_f64.powf(-snr_db / 10.0)).sqrt();
    let noisy = clean.iter().map(|x| x + noise_std * rng.normal()).collect();
    Impact { rate_hz, clean, noisy, noise_std, truth }
}

/// `count` samples of modes from time 0 on.
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

/// [`render`] by recurrence.
pub fn render_fast(modes: &[Mode], rate_hz: f64, count: usize) -> Vec<f64> {
    let mut out = vec![0.0; count];
    for mode in modes {
        let pole =
            Complex::from_polar((-mode.decay_per_s / rate_hz).exp(), 2.0 * PI * mode.frequency_hz / rate_hz);
        let mut z = Complex::from_polar(mode.amplitude, mode.phase_rad);
        for x in &mut out {
            *x += z.im;
            z *= pole;
        }
    }
    out
}
