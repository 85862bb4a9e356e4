//! Strokes of known ground: a Gaussian profile, the stylus' contact as a linear filter, white
//! noise.

use asperity_dsp::micro_contact::Probe;
use asperity_dsp::rng::Rng;
use asperity_fft::FftPlanner;
use asperity_fft::num_complex::Complex;
use asperity_stroke::{Options, Quantity, Stroke, Tool, Track, surface};
use std::f64::consts::PI;

pub const RATE_HZ: f64 = 10_000.0;

/// Stylus of the engine: 30 g in a hand of 0.3 kg, on 6.5 kN/m F^¼.
pub fn stylus() -> Probe {
    Probe {
        pad_mass_kg: 30e-3,
        pad_stiffness_n_m: 1e3,
        pad_damping_n_s_m: 39.0,
        finger_mass_kg: 0.3,
        contact_stiffness_n_m: 6.5e3,
        force_exponent: 0.25,
        tip_radius_m: 0.0,
        ridge_m: 0.0,
        ..Probe::default()
    }
}

pub fn options() -> Options {
    let tool = Tool { probe: stylus(), quantity: Quantity::Acceleration };
    Options { tool, probe_error: surface::PROBE_ERROR, colour: None }
}

#[derive(Debug, Clone)]
pub struct Made {
    pub alpha: f64,
    /// Rms of the octave about 1 mm, m.
    pub at_1mm_m: f64,
    pub outer_scale_m: f64,
    /// Period and amplitude of lines, m.
    pub lines: Vec<(f64, f64)>,
    pub speed_m_s: f64,
    pub force_n: f64,
    pub seconds: f64,
    /// Signal over noise, dB, from 20 Hz to 1 kHz.
    pub snr_db: f64,
    /// Depth of a ripple of the speed at 1.5 Hz.
    pub ripple: f64,
    pub told_ripple: bool,
    pub seed: u64,
}

impl Default for Made {
    fn default() -> Self {
        Self {
            alpha: 2.5,
            at_1mm_m: 3e-6,
            outer_scale_m: 10e-3,
            lines: Vec::new(),
            speed_m_s: 0.12,
            force_n: 1.5,
            seconds: 10.0,
            snr_db: 30.0,
            ripple: 0.0,
            told_ripple: true,
            seed: 1,
        }
    }
}

/// Density of the profile, m³.
pub fn density(made: &Made, q: f64) -> f64 {
    let a = made.alpha;
    let r2 = 2f64.sqrt();
    let octave =
        if (a - 1.0).abs() < 1e-9 { 2f64.ln() } else { (r2.powf(1.0 - a) - r2.powf(a - 1.0)) / (1.0 - a) };
    let at = |q: f64| q.max(1.0 / made.outer_scale_m) * 1e-3;
    made.at_1mm_m.powi(2) * 1e-3 / octave * at(q).powf(-a)
}

pub fn filtered(signal: &mut Vec<f64>, gain: impl Fn(f64) -> Complex<f64>) {
    let n = signal.len();
    let length = n.next_power_of_two();
    let mut bins: Vec<Complex<f64>> = signal.iter().map(|x| Complex::new(*x, 0.0)).collect();
    bins.resize(length, Complex::default());
    let mut planner = FftPlanner::new();
    planner.plan_fft_forward(length).process(&mut bins);
    for i in 0..=length / 2 {
        let g = gain(i as f64 * RATE_HZ / length as f64) / length as f64;
        bins[i] *= g;
        if i > 0 && i < length / 2 {
            bins[length - i] *= g.conj();
        }
    }
    planner.plan_fft_inverse(length).process(&mut bins);
    *signal = bins[..n].iter().map(|bin| bin.re).collect();
}

/// Acceleration over height: m x'' = k (h − x) − grip, solved as two masses in a chain.
pub fn response(probe: &Probe, force_n: f64, hz: f64) -> Complex<f64> {
    let s = Complex::new(0.0, 2.0 * PI * hz);
    let k = probe.contact_stiffness_n_m * force_n.powf(probe.force_exponent);
    let z = probe.pad_stiffness_n_m + probe.pad_damping_n_s_m * s;
    // (m s² + z + k) x − z y = k h;  (M s² + z) y = z x
    let hand = probe.finger_mass_kg * s * s + z;
    let tip = probe.pad_mass_kg * s * s + z + k;
    s * s * k * hand / (tip * hand - z * z)
}

pub fn make(made: &Made) -> Stroke {
    recorded(made, |hz| response(&stylus(), made.force_n, hz))
}

/// Stroke of which a linear filter of the height is recorded.
pub fn recorded(made: &Made, gain: impl Fn(f64) -> Complex<f64>) -> Stroke {
    let mut rng = Rng::new(made.seed);
    let count = (made.seconds * RATE_HZ) as usize;
    let phase = rng.uniform() * 2.0 * PI;
    let speed: Vec<f64> = (0..count)
        .map(|i| {
            let t = i as f64 / RATE_HZ;
            made.speed_m_s * (1.0 + made.ripple * 2f64.sqrt() * (2.0 * PI * 1.5 * t + phase).sin())
        })
        .collect();
    let mut at = 0.0;
    let path: Vec<f64> = speed
        .iter()
        .map(|v| {
            at += v / RATE_HZ;
            at
        })
        .collect();
    let step = 0.5 * made.speed_m_s / RATE_HZ;
    let length = ((1.05 * at / step) as usize).next_power_of_two();
    let mut bins = vec![Complex::default(); length];
    for i in 1..length / 2 {
        let q = i as f64 / (length as f64 * step);
        if q > 60_000.0 || q > 0.5 * RATE_HZ / made.speed_m_s {
            break;
        }
        let size = (density(made, q) / (length as f64 * step) / 2.0).sqrt();
        bins[i] = Complex::new(rng.normal(), rng.normal()) * size / 2f64.sqrt();
        bins[length - i] = bins[i].conj();
    }
    FftPlanner::new().plan_fft_inverse(length).process(&mut bins);
    let height = |x: f64| {
        let i = (x / step) as usize;
        let t = x / step - i as f64;
        let p = |k: usize| bins[(i + k + length - 1) % length].re;
        let own = p(1)
            + 0.5
                * t
                * (p(2) - p(0)
                    + t * (2.0 * p(0) - 5.0 * p(1) + 4.0 * p(2) - p(3)
                        + t * (3.0 * (p(1) - p(2)) + p(3) - p(0))));
        own + made
            .lines
            .iter()
            .map(|(period, amplitude)| amplitude * (2.0 * PI * x / period).sin())
            .sum::<f64>()
    };
    let mut signal: Vec<f64> = path.iter().map(|x| height(*x)).collect();
    filtered(&mut signal, gain);
    let mut inside = signal.clone();
    filtered(&mut inside, |hz| Complex::new(if (20.0..1000.0).contains(&hz) { 1.0 } else { 0.0 }, 0.0));
    let rms = (inside.iter().map(|x| x * x).sum::<f64>() / count as f64).sqrt();
    // Noise is white up to the rate's half; the told ratio is within 20 Hz to 1 kHz.
    let noise = rms * 10f64.powf(-0.05 * made.snr_db) * (0.5 * RATE_HZ / 980.0).sqrt();
    signal.iter_mut().for_each(|x| *x += noise * rng.normal());
    let speed_m_s = if made.ripple > 0.0 && made.told_ripple {
        Track::Samples(speed)
    } else {
        Track::Constant(made.speed_m_s)
    };
    Stroke { axes: vec![signal], rate_hz: RATE_HZ, speed_m_s, force_n: Track::Constant(made.force_n) }
}

/// Rms of an octave of the made profile, m.
pub fn octave_rms(made: &Made, wavelength_m: f64) -> f64 {
    const STEPS: usize = 200;
    let (from, to) = (1.0 / wavelength_m / 2f64.sqrt(), 2f64.sqrt() / wavelength_m);
    let sum: f64 = (0..STEPS)
        .map(|i| {
            let q = from * (to / from).powf((i as f64 + 0.5) / STEPS as f64);
            density(made, q) * q
        })
        .sum();
    (sum * (to / from).ln() / STEPS as f64).sqrt()
}
