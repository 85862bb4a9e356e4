//! A machine in the place of the observers of document 002's ABX experiment.
//!
//! A finger strokes each surface at random through the engine; what the actuator would do in a
//! stroke becomes a vector of third-octave levels; a linear discriminant that has seen other
//! strokes of two surfaces says which of the two a stroke was on. Its share of right answers,
//! cross-validated, stands for the observers': 0.5 is chance, 1 is certain.
//!
//! | symbol | here |
//! |---|---|
//! | stroke | [`STROKE_S`], any place and direction, [`SPEEDS_M_S`], [`FORCES_N`] |
//! | level | 10 log₁₀(power of displacement in the band + [`NOISE_M`]²), bands of a third of an octave from [`LOWEST_HZ`] |
//! | discriminant | w = (Σ + λI)⁻¹(μ_B − μ_A), Σ pooled over both, λ = [`SHRINKAGE`] · mean variance |
//!
//! Source: the experiment is document 002's (five textures, 40 × 40 mm, 256 × 256 texels, chance
//! 0.5); strokes, features and judge are ours. [`NOISE_M`] stands for what skin does not feel; a
//! judge with less noise is stricter than the observers were.

use asperity::files::FileError;
use asperity::files::contact_log::{ContactLog, ContactSample, LogHand, LogLine, Names};
use asperity::offline::{self, Options};
use asperity::{ActuatorSettings, Config, Extent, Roughness, Surface, Wrap};
use asperity_dsp::rng::Rng;
use asperity_fft::{PowerSpectra, hann};
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Length of a stroke that is judged, s (the landing before it is not).
pub const STROKE_S: f64 = 0.4;
/// Landing, s: left out.
const LANDING_S: f64 = 0.1;
/// Pause between two strokes, s.
const PAUSE_S: f64 = 0.1;
/// Speeds of strokes, m/s.
pub const SPEEDS_M_S: [f64; 2] = [0.09, 0.11];
/// Forces of strokes, N.
pub const FORCES_N: [f64; 2] = [0.45, 0.55];
/// Centre of the lowest band, Hz.
pub const LOWEST_HZ: f64 = 12.5;
/// Bands: up to 800 Hz, beyond which fingertips feel next to nothing.
const BANDS: usize = 19;
/// Displacement that the judge cannot tell from none, m: a tenth of the best vibration threshold of
/// a fingertip, 0.1 µm at 250 Hz (Bolanowski 1988).
pub const NOISE_M: f64 = 1e-8;
/// λ over the mean variance.
pub const SHRINKAGE: f64 = 0.01;
/// Parts in cross-validation.
pub const FOLDS: usize = 10;
/// Rate of the strokes, Hz.
pub const RATE_HZ: f64 = 22_050.0;
/// Events a second.
const EVENTS_HZ: f64 = 100.0;

/// Levels of one stroke, dB.
pub type Features = [f64; BANDS];

/// Size of the surfaces.
#[derive(Debug, Clone, Copy)]
pub struct Size {
    /// Side of a texel, m.
    pub texel_m: f64,
    /// Height of 1 over 0, m.
    pub relief_m: f64,
}

/// Strokes a surface (heights 0–1) at random; levels of each.
///
/// # Errors
/// When the engine refuses the surface.
pub fn strokes(
    heights: &Raster,
    tiles: bool,
    size: Size,
    count: usize,
    seed: u64,
) -> Result<Vec<Features>, FileError> {
    let levels = Levels::new((STROKE_S * RATE_HZ) as usize);
    displacements(heights, tiles, size, (count, seed), |samples| levels.of(samples))
}

/// Strokes a surface (heights 0–1) at random; what `each` makes of the displacement, m, of each at
/// [`RATE_HZ`].
///
/// # Errors
/// When the engine refuses the surface.
pub fn displacements<T>(
    heights: &Raster,
    tiles: bool,
    size: Size,
    (count, seed): (usize, u64),
    mut each: impl FnMut(&[f32]) -> T,
) -> Result<Vec<T>, FileError> {
    let (width_m, height_m) = (heights.width as f64 * size.texel_m, heights.height as f64 * size.texel_m);
    let extent = Extent { width_m, height_m, relief_m: size.relief_m };
    let wrap = if tiles { Wrap::Repeat } else { Wrap::Mirror };
    let map = HeightMap::new(heights, extent, wrap).map_err(FileError::from_error)?;
    let surface = Surface::new(map, width_m, height_m).map_err(FileError::from_error)?;
    // Nothing but the map: the judge shall not tell micro-noise apart.
    let surface = surface.micro_relief_m(0.0).roughness(Roughness::Constant(0.0));
    let config = Config {
        sample_rate_hz: RATE_HZ,
        actuators: vec![ActuatorSettings { full_scale: 1.0, ..ActuatorSettings::default() }],
        ..Config::default()
    };
    let asperity::Engine { mut scene, renderer, .. } = config.build().map_err(FileError::from_error)?;
    let id = scene.add_surface(surface).map_err(FileError::from_error)?;
    let names = Names { surfaces: HashMap::from([("s".to_owned(), id)]), ..Names::default() };
    let latency = renderer.latency_samples();
    let log = random_strokes([width_m, height_m], count, seed);
    let options = Options { tail_s: PAUSE_S, ..Options::default() };
    let render = offline::render(scene, renderer, &log, &names, &options).map_err(FileError::from_error)?;
    let length = (STROKE_S * RATE_HZ) as usize;
    let start = |stroke: usize| {
        let begin_s = stroke as f64 * (LANDING_S + STROKE_S + PAUSE_S) + LANDING_S;
        (begin_s * RATE_HZ) as usize + latency
    };
    Ok((0..count).map(|stroke| each(&render.haptic[0][start(stroke)..start(stroke) + length])).collect())
}

fn random_strokes(size_m: [f64; 2], count: usize, seed: u64) -> ContactLog {
    let mut rng = Rng::new(seed);
    let mut lines = Vec::new();
    for stroke in 0..count {
        let mut within = |[low, high]: [f64; 2]| low + (high - low) * rng.uniform();
        let (angle, speed) = (within([0.0, TAU]), within(SPEEDS_M_S));
        let (normal_force_n, from) = (within(FORCES_N), [within([0.0, 1.0]), within([0.0, 1.0])]);
        let velocity = [speed * angle.cos(), speed * angle.sin()];
        let contact = stroke as u64 + 1;
        let start_s = stroke as f64 * (LANDING_S + STROKE_S + PAUSE_S);
        let steps = ((LANDING_S + STROKE_S) * EVENTS_HZ) as usize;
        let samples = (0..steps).map(|step| {
            let t = step as f64 / EVENTS_HZ;
            let uv = [0, 1].map(|axis| from[axis] + velocity[axis] * t / size_m[axis]);
            (start_s + t, ContactSample::new(uv, normal_force_n).sliding(velocity))
        });
        let end_s = start_s + LANDING_S + STROKE_S;
        lines.extend(LogLine::contact(contact, ("s", LogHand::felt_by(0)), samples, end_s));
    }
    ContactLog { lines }
}

/// Third-octave levels.
struct Levels(PowerSpectra);

impl Levels {
    fn new(length: usize) -> Self {
        Self(PowerSpectra::new(hann(length, 0.5), length))
    }

    fn of(&self, samples: &[f32]) -> Features {
        let power = self.0.of(samples.iter().map(|x| f64::from(*x)));
        let n = samples.len() as f64;
        // A Hann window keeps 3/8 of the power; both halves of the spectrum count.
        let scale = 2.0 / (n * n * 0.375);
        let mut features = [NOISE_M * NOISE_M; BANDS];
        for (bin, power) in power.iter().enumerate().take(samples.len() / 2).skip(1) {
            let octaves = (bin as f64 * RATE_HZ / n / LOWEST_HZ).log2();
            let band = (3.0 * octaves).round();
            if (0.0..BANDS as f64).contains(&band) {
                features[band as usize] += scale * power;
            }
        }
        features.map(|power| 10.0 * power.log10())
    }
}

/// Share of strokes that a judge who has learned from the others puts on the right surface.
pub fn right_answers(a: &[Features], b: &[Features]) -> f64 {
    let mut right = 0;
    for fold in 0..FOLDS {
        let (learn_a, test_a) = split(a, fold);
        let (learn_b, test_b) = split(b, fold);
        let judge = Judge::new(&learn_a, &learn_b);
        right += test_a.iter().filter(|stroke| !judge.says_b(stroke)).count();
        right += test_b.iter().filter(|stroke| judge.says_b(stroke)).count();
    }
    right as f64 / (a.len() + b.len()) as f64
}

/// Strokes to learn from and strokes to ask, of a part of the cross-validation.
pub fn split<T: Clone>(strokes: &[T], fold: usize) -> (Vec<T>, Vec<T>) {
    let of = |test: bool| {
        let kept = strokes.iter().enumerate().filter(move |(i, _)| (i % FOLDS == fold) == test);
        kept.map(|(_, stroke)| stroke.clone()).collect()
    };
    (of(false), of(true))
}

/// A linear discriminant.
struct Judge {
    direction: Features,
    middle: f64,
}

impl Judge {
    fn new(a: &[Features], b: &[Features]) -> Self {
        let (mean_a, mean_b) = (mean(a), mean(b));
        let mut scatter = [[0.0; BANDS]; BANDS];
        for (strokes, mean) in [(a, &mean_a), (b, &mean_b)] {
            for stroke in strokes {
                for i in 0..BANDS {
                    for j in 0..BANDS {
                        scatter[i][j] += (stroke[i] - mean[i]) * (stroke[j] - mean[j]);
                    }
                }
            }
        }
        let mean_variance = (0..BANDS).map(|i| scatter[i][i]).sum::<f64>() / BANDS as f64;
        for (i, row) in scatter.iter_mut().enumerate() {
            row[i] += SHRINKAGE * mean_variance + f64::MIN_POSITIVE;
        }
        let difference: Features = std::array::from_fn(|i| mean_b[i] - mean_a[i]);
        let direction = solve(scatter, difference);
        let middle = (0..BANDS).map(|i| direction[i] * 0.5 * (mean_a[i] + mean_b[i])).sum();
        Self { direction, middle }
    }

    fn says_b(&self, stroke: &Features) -> bool {
        self.direction.iter().zip(stroke).map(|(w, x)| w * x).sum::<f64>() > self.middle
    }
}

fn mean(strokes: &[Features]) -> Features {
    std::array::from_fn(|i| strokes.iter().map(|s| s[i]).sum::<f64>() / strokes.len().max(1) as f64)
}

/// Solves a symmetric positive definite system (Cholesky).
fn solve(mut m: [[f64; BANDS]; BANDS], mut x: Features) -> Features {
    for i in 0..BANDS {
        for j in 0..=i {
            let sum: f64 = m[i][j] - (0..j).map(|k| m[i][k] * m[j][k]).sum::<f64>();
            m[i][j] = if i == j { sum.max(f64::MIN_POSITIVE).sqrt() } else { sum / m[j][j] };
        }
    }
    for i in 0..BANDS {
        x[i] = (x[i] - (0..i).map(|k| m[i][k] * x[k]).sum::<f64>()) / m[i][i];
    }
    for i in (0..BANDS).rev() {
        x[i] = (x[i] - (i + 1..BANDS).map(|k| m[k][i] * x[k]).sum::<f64>()) / m[i][i];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(count: usize, shift: f64, seed: u64) -> Vec<Features> {
        let mut rng = Rng::new(seed);
        let stroke = |_| std::array::from_fn(|i| rng.normal() + if i == 4 { shift } else { 0.0 });
        (0..count).map(stroke).collect()
    }

    #[test]
    fn the_judge_guesses_between_equals_and_scores_by_the_normal_law() {
        let equal = right_answers(&drawn(1000, 0.0, 1), &drawn(1000, 0.0, 2));
        assert!((equal - 0.5).abs() < 0.04, "{equal}");
        // Two standard deviations apart, halfway between is one from each: Φ(1) = 0.841.
        let apart = right_answers(&drawn(1000, 0.0, 3), &drawn(1000, 2.0, 4));
        assert!((apart - 0.841).abs() < 0.03, "{apart}");
    }

    #[test]
    fn a_tone_has_the_level_of_its_power_in_its_band() {
        let amplitude = 3e-6;
        let samples: Vec<f32> = (0..(STROKE_S * RATE_HZ) as usize)
            .map(|i| (amplitude * (TAU * 100.0 * i as f64 / RATE_HZ).sin()) as f32)
            .collect();
        let features = Levels::new(samples.len()).of(&samples);
        let expected = 10.0 * (0.5_f64 * amplitude * amplitude).log10();
        assert!((features[9] - expected).abs() < 0.05, "{} against {expected}", features[9]);
        assert!(features[14] < expected - 40.0);
    }

    fn felt(period: f64, crossed: f64, seed: u64) -> Vec<Features> {
        let wave = |i: usize| (TAU * i as f64 / period).sin();
        let relief = Raster::from_fn(64, 64, |x, y| 0.5 + 0.25 * (wave(x) + crossed * wave(y)));
        strokes(&relief, true, Size { texel_m: 1.5e-4, relief_m: 1e-4 }, 60, seed).unwrap()
    }

    #[test]
    fn a_coarse_grid_differs_from_a_fine_one_and_not_from_itself() {
        let coarse = felt(16.0, 1.0, 1);
        let share = right_answers(&coarse, &felt(8.0, 1.0, 2));
        assert!(share > 0.95, "{share}");
        let same = right_answers(&coarse, &felt(16.0, 1.0, 3));
        assert!((same - 0.5).abs() < 0.15, "{same}");
    }

    #[test]
    fn gratings_are_told_apart_as_the_strokes_angles_allow() {
        // Across a grating at an angle a finger meets cos θ as many ridges a second. A stroke on
        // the fine one (half the period) beyond 60° is one on the coarse one; the best judge is
        // right in 1/2 + 1/2 · 60°/90° = 5/6.
        let share = right_answers(&felt(16.0, 0.0, 1), &felt(8.0, 0.0, 2));
        assert!((share - 5.0 / 6.0).abs() < 0.08, "{share}");
    }
}
