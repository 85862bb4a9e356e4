//! The judge of the seven materials: third-octave spectra of held-out strokes, nearest centroid.
//!
//! A stroke: 1 s at 60–100 mm/s, the speed wavering as a hand's does, from anywhere on the surface
//! in any direction. Haptic signal: the rate of the height under the finger, or the force on the
//! tool. Features: level in dB of every third octave, and of the part below the lowest one. The
//! judge knows the mean of 30 strokes a material and the spread within materials, and is asked
//! about 30 others.
#![allow(dead_code)]

#[path = "../../../dsp/tests/spectrum/mod.rs"]
mod spectrum;

use asperity_dsp::rng::Rng;
use asperity_surface::height_field::{HeightField, PathBlock, SurfaceBlock};
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::{SolidNoise, SolidNoiseParameters};
use spectrum::fft;
use std::f64::consts::TAU;

pub const RATE: f64 = 4096.0;
const SAMPLES: usize = 4096;

/// Positions and velocities of one stroke.
pub fn stroke(rng: &mut Rng) -> Vec<([f64; 2], [f64; 2])> {
    let (speed, angle) = (0.06 + 0.04 * rng.uniform(), TAU * rng.uniform());
    let (waver, phase) = (0.1 + 0.1 * rng.uniform(), TAU * rng.uniform());
    let mut at = [rng.normal(), rng.normal()];
    (0..SAMPLES)
        .map(|n| {
            let t = n as f64 / RATE;
            let v = speed * (1.0 + waver * (TAU * 1.5 * t + phase).sin());
            let velocity = [v * angle.cos(), v * angle.sin()];
            at = [at[0] + velocity[0] / RATE, at[1] + velocity[1] / RATE];
            (at, velocity)
        })
        .collect()
}

/// Rate of the height under the finger, m/s.
pub fn height_rate(source: &mut SolidNoise, path: &[([f64; 2], [f64; 2])]) -> Vec<f64> {
    let mut out = SurfaceBlock::default();
    let mut signal = Vec::with_capacity(path.len());
    for (k, block) in path.chunks(64).enumerate() {
        let position: Vec<_> = block.iter().map(|p| p.0).collect();
        let velocity: Vec<_> = block.iter().map(|p| p.1).collect();
        let footprint: Vec<_> = velocity.iter().map(|v| v[0].hypot(v[1]) / RATE).collect();
        let path = PathBlock {
            position_m: &position,
            velocity_m_s: &velocity,
            footprint_m: &footprint,
            normal_force_n: &[],
            first_sample: 64 * k as u64,
            contact: 0,
            slopes: true,
            ..PathBlock::default()
        };
        source.sample(&path, &mut out);
        signal.extend(
            (0..block.len())
                .map(|i| out.gradient[i][0] * velocity[i][0] + out.gradient[i][1] * velocity[i][1]),
        );
    }
    signal
}

/// Force on the tool against the stroke: texture, medium and Coulomb friction at 0.5 N. The texture
/// force acts along x, so that its share in the stroke depends on the direction: taken whole.
pub fn force(source: &SolidNoise, path: &[([f64; 2], [f64; 2])]) -> Vec<f64> {
    path.iter()
        .map(|&(at, velocity)| {
            let speed = velocity[0].hypot(velocity[1]);
            // The force as a tool moving along x at that speed feels it.
            let f = source.force_n(at, [speed, 0.0], 0.5, speed / RATE, 0);
            f[0] - source.parameters().friction * 0.5
        })
        .collect()
}

/// Power spectrum of a Hann window.
fn power_spectrum(signal: &[f64]) -> Vec<f64> {
    let n = signal.len();
    let hann = |i: usize| 0.5 - 0.5 * (TAU * i as f64 / n as f64).cos();
    let mut re: Vec<f64> = signal.iter().enumerate().map(|(i, s)| s * hann(i)).collect();
    let mut im = vec![0.0; n];
    fft(&mut re, &mut im);
    re.iter().zip(&im).take(n / 2).map(|(re, im)| (re * re + im * im) / n as f64).collect()
}

/// Levels in dB below 4 Hz and in third octaves from 5 to 1000 Hz.
fn features(signal: &[f64]) -> Vec<f64> {
    let power = power_spectrum(signal);
    let level = |from: f64, to: f64| {
        let bins = (from.ceil() as usize)..(to.ceil() as usize).min(power.len());
        10.0 * (power[bins].iter().sum::<f64>() + 1e-16).log10()
    };
    let mut all = vec![level(0.0, 4.0)];
    all.extend((0..24).map(|k| {
        let centre = 5.0 * 2.0_f64.powf(f64::from(k) / 3.0);
        level(centre * 2.0_f64.powf(-1.0 / 6.0), centre * 2.0_f64.powf(1.0 / 6.0))
    }));
    all
}

/// Strokes to learn from and as many to be asked about, and the seeds of strokes and pieces.
#[derive(Debug, Clone, Copy)]
pub struct Question {
    pub strokes: usize,
    pub strokes_seed: u64,
    pub known_piece: u64,
    pub asked_piece: u64,
}

/// Share of held-out strokes named rightly, and the confusions.
pub fn identified(
    question: Question,
    parameters: &[SolidNoiseParameters],
    haptic: impl Fn(&mut SolidNoise, &mut Rng) -> Vec<f64>,
) -> (f64, Vec<Vec<usize>>) {
    let strokes = question.strokes;
    let mut rng = Rng::new(question.strokes_seed);
    let mut felt = |piece: u64| -> Vec<Vec<Vec<f64>>> {
        let made = parameters.iter().map(|p| SolidNoise::new(*p, piece).unwrap());
        made.map(|mut m| (0..strokes).map(|_| features(&haptic(&mut m, &mut rng))).collect()).collect()
    };
    let (known, asked) = (felt(question.known_piece), felt(question.asked_piece));
    let width = known[0][0].len();
    let centroid: Vec<Vec<f64>> = known
        .iter()
        .map(|s| (0..width).map(|k| s.iter().map(|f| f[k]).sum::<f64>() / strokes as f64).collect())
        .collect();
    let spread: Vec<f64> = (0..width)
        .map(|k| {
            let sum: f64 =
                known.iter().zip(&centroid).flat_map(|(s, c)| s.iter().map(|f| (f[k] - c[k]).powi(2))).sum();
            (sum / (strokes * known.len()) as f64).sqrt().max(0.1)
        })
        .collect();
    let mut right = 0;
    let mut confusions = vec![vec![0; parameters.len()]; parameters.len()];
    for (m, strokes) in asked.iter().enumerate() {
        for f in strokes {
            let distance =
                |c: &Vec<f64>| (0..width).map(|k| ((f[k] - c[k]) / spread[k]).powi(2)).sum::<f64>();
            let best = (0..centroid.len())
                .min_by(|&a, &b| distance(&centroid[a]).total_cmp(&distance(&centroid[b])))
                .unwrap();
            confusions[m][best] += 1;
            right += i32::from(best == m);
        }
    }
    (f64::from(right) / (strokes * parameters.len()) as f64, confusions)
}

/// The seven as they are.
pub fn seven() -> Vec<SolidNoiseParameters> {
    SolidMaterial::SEVEN.map(SolidMaterial::parameters).to_vec()
}
