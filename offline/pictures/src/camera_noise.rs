//! Camera noise: estimated and taken off a picture's spectrum.
//!
//! ```text
//! X'(k) = X(k) √max(0, 1 − N/P(r) · (1 + 3/√n))       r = |k|
//! N = max(N_step, N_level, min(N_most, max(N_corner, N_plateau, N_jpeg)))
//! ```
//! | symbol | here |
//! |---|---|
//! | P, n | mean power of a ring of waves of one length, and how many they are: what a ring has beyond three standard errors of noise is kept |
//! | N_corner | mean power where both frequencies are above `CORNER`: a lens leaves nothing there, white noise is as strong as elsewhere |
//! | N_plateau | power of 4–8 texels where 8–16 texels have no more: JPEG takes noise out of the corner, not out of the middle |
//! | N_level | power of three octaves that are level, of 8–64 or of 16–128 texels: a sensor's mosaic and its sharpening colour noise below 8 texels and leave longer waves white; a surface's rise or have a hump there. Such octaves may be as strong as [`MOST_LEVEL`] |
//! | N_jpeg | the most of the octaves of 8–64 texels (of 64–128 too, where they are as weak) where none has more than what JPEG hides: noise below its divisors, and the steps between its blocks. A surface that has nothing there has nothing in shorter waves |
//! | N_step | an eighth bit's rounding |
//! | N_most | [`MOST_NOISE`]: what is stronger is not a camera's, but a rough surface under a low light, which is white as well |
//!
//! Uneven light is no noise and no relief: octaves are those of the picture without it, which comes
//! back where anything is left. They are measured with the picture faded towards its borders by a
//! quarter at either end: steps from one border to the other one, or what a tiling part makes of
//! them, leak into the octave of 64–128 texels, and a level spectrum rises there. Where each octave
//! has noise's even spread of power and less than [`FAINT`], noise that somebody blurred (denoised,
//! reduced, recompressed) and a faint surface are the same picture, and it is flat; so it is where
//! less than [`NOTHING`] is left of 4–128 texels.
//!
//! Power is subtracted, not filtered by least squares (Wiener), so that what stays has the strength
//! it had: levels are compared by power. Source: spectral subtraction (S. F. Boll, IEEE ASSP 27,
//! 1979) over rings instead of frames; limits ours. Measured: a wall of 200 ± 1 of 255 keeps 1 % of
//! its noise, one of 2 levels of noise saved as JPEG at quality 85–95 a tenth; a photograph of
//! gravel at 3 % of its contrast keeps 97 %.

use crate::borders::{Borders, SplitBorders};
use crate::symmetry::detrended;
use crate::waves::Waves;
use asperity_surface::raster::Raster;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Rms of the strongest noise that is taken for a camera's, of white: five levels of 255. Assumed:
/// a telephone indoors.
pub const MOST_NOISE: f64 = 0.02;
/// Rms of the weakest, of white: 8-bit rounding, 1/√12 of a level.
pub const LEAST_NOISE: f64 = 0.288_7 / 255.0;
/// Frequency of the corner, cycles per texel in both directions.
const CORNER: f64 = 0.4;
/// Octaves of waves that are looked at, from 4 to 128 texels.
const OCTAVES: usize = 5;
/// Waves that an octave needs to be judged by.
const FEWEST_WAVES: f64 = 40.0;
/// Most over least power of octaves that are level for certain, and of those that are not. Walls
/// under a mosaic, sharpened, blurred, denoised, reduced or as JPEG 1.0–1.8 in 400 × 400 texels,
/// where chance alone makes 1.4 of the longest; squares of ten texels under noise 1.65–2.9.
const LEVEL: f64 = 1.5;
const NOT_LEVEL: f64 = 1.65;
/// Factor over the mean of level octaves that is taken off: a mosaic and JPEG leave them uneven by
/// a fifth.
const MARGIN: f64 = 1.3;
/// Rms of the strongest octaves that are taken for noise because they are level, of white: eight
/// levels of 255. Source: ours; a wall under six levels of noise before its mosaic has 7.4.
pub const MOST_LEVEL: f64 = 8.0 / 255.0;
/// Rms of the white noise that a JPEG of divisor 1 hides, levels of 255: quantisation takes what is
/// below half a divisor, and steps of its block means are white noise of 1/√12 of it. Source: ours,
/// above what walls of quality 76–92 keep (0.35–0.7).
const HIDDEN: f64 = 0.8;
/// Rms of an octave that cannot be told from blurred noise, of white: 0.4 of a level. Source: ours;
/// denoised, reduced and recompressed walls have up to 0.37, bricks at a twentieth of their
/// contrast 0.43.
pub const FAINT: f64 = 0.4 / 255.0;
/// Mean over logarithmic mean of an octave's power up to which it is noise's: 1 of noise, 1.2 where
/// JPEG thinned it, 3 and more of patterns.
const EVEN: f64 = 1.7;
/// Rms of all octaves together that is nothing, of white: a fifth of a level.
pub const NOTHING: f64 = 0.2 / 255.0;
/// Part of a side in which a picture fades at either end. Source: J. W. Tukey, in B. Harris (ed.),
/// Spectral Analysis of Time Series, 1967; a quarter leaves half of the waves independent.
const FADE: f64 = 0.25;
/// Longest waves of the octaves, texels.
const LONGEST: f64 = 128.0;
/// Euler's and Mascheroni's.
const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;
/// Standard errors that a ring's noise may be above its mean.
const DOUBT: f64 = 3.0;

/// A picture without its camera's noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Quiet {
    /// Remainder.
    pub picture: Raster,
    /// Rms of what was taken for noise, in the picture's unit.
    pub noise: f64,
}

/// Takes the noise off a picture of values 0–1 that came from a JPEG of this divisor, 0
/// of none
/// ([`PhotoOptions::jpeg_divisor`](crate::from_photo::PhotoOptions::jpeg_divisor)).
#[must_use]
pub fn without_noise_and_steps(picture: &Raster, jpeg_divisor: f64) -> Quiet {
    let level = detrended(picture);
    let hidden = HIDDEN * jpeg_divisor / 255.0;
    let Floor { noise, taken, is_faint } = floor(&level, hidden * hidden);
    let split = SplitBorders::of(&level, Borders::Detect.decide(picture));
    let mut waves = Waves::of(&split.periodic);
    drop(split.periodic);
    let rings = Rings::of(&waves, picture);
    let texels = picture.values.len() as f64;
    let gains: Vec<f64> = rings
        .power
        .iter()
        .map(|&(power, count)| {
            let least = taken * (1.0 + DOUBT / count.max(1.0).sqrt());
            if power > least { (1.0 - least / power).sqrt() } else { 0.0 }
        })
        .collect();
    if is_faint || rings.left(&gains, texels) < NOTHING * NOTHING {
        let even = Raster::constant(picture.width, picture.height, picture.mean());
        return Quiet { picture: even, noise: noise.sqrt() };
    }
    let mut quiet = waves.weighed_by_frequency(|r| if r > 0.0 { gains[rings.of_frequency(r)] } else { 1.0 });
    if let Some(smooth) = split.smooth {
        quiet.values.iter_mut().zip(&smooth.values).for_each(|(v, s)| *v += s);
    }
    for ((value, picture), level) in quiet.values.iter_mut().zip(&picture.values).zip(&level.values) {
        *value += picture - level;
    }
    Quiet { picture: quiet, noise: noise.sqrt() }
}

/// Mean power of rings of waves.
struct Rings {
    shorter_side: f64,
    power: Vec<(f64, f64)>,
}

impl Rings {
    fn of(waves: &Waves, picture: &Raster) -> Self {
        let shorter_side = picture.width.min(picture.height) as f64;
        let last = (shorter_side * std::f64::consts::FRAC_1_SQRT_2).ceil() as usize + 1;
        let mut rings = Self { shorter_side, power: vec![(0.0, 0.0); last + 1] };
        let texels = picture.values.len() as f64;
        waves.each(|wave| {
            let ring = rings.of_frequency(wave.frequency());
            let (power, count) = &mut rings.power[ring];
            (*power, *count) = (*power + wave.count * wave.power / texels, *count + wave.count);
        });
        rings.power.iter_mut().for_each(|(power, count)| *power /= count.max(1.0));
        rings
    }

    /// Mean power a texel that these gains leave of waves of up to [`LONGEST`].
    fn left(&self, gains: &[f64], texels: f64) -> f64 {
        let first = self.of_frequency(TAU / LONGEST);
        let rings = self.power.iter().zip(gains).skip(first);
        rings.map(|((power, count), gain)| power * count * gain * gain).sum::<f64>() / texels
    }

    /// One ring a wave over the shorter side; of a wave of so many radians a texel.
    fn of_frequency(&self, frequency: f64) -> usize {
        (frequency / TAU * self.shorter_side + 0.5) as usize
    }
}

/// Estimate of the noise from octaves.
struct Floor {
    /// Power of the corner, of the plateau, of level octaves or of what JPEG hides, whichever is
    /// most.
    noise: f64,
    /// Power to be taken off.
    taken: f64,
    /// Nothing rises above blurred noise.
    is_faint: bool,
}

/// The noise of a picture of even light, mean 0, of which JPEG hides at most `hidden`.
fn floor(even: &Raster, hidden: f64) -> Floor {
    let (faded, weight) = faded(even);
    let waves = Waves::of(&faded);
    let mut corner = Mean::default();
    let mut octaves: [Mean; OCTAVES] = Default::default();
    waves.each(|wave| {
        let power = wave.power / weight;
        if wave.wx.min(wave.wy.abs()) > TAU * CORNER {
            corner.add(power, wave.count);
        }
        // Octave 0: waves of 4 to 8 texels.
        let octave = (PI / 2.0 / wave.frequency()).log2().ceil();
        if (1.0..=OCTAVES as f64).contains(&octave) {
            octaves[octave as usize - 1].add(power, wave.count);
        }
    });
    let level = octaves[1..].windows(3).map(of_level_octaves).fold(0.0, f64::max);
    let hidden = of_hidden_octaves(&octaves[1..], hidden);
    let noise = corner.get().max(plateau(&octaves));
    let noise = noise.clamp(LEAST_NOISE * LEAST_NOISE, MOST_NOISE * MOST_NOISE);
    let is_faint = are_faint(&octaves[1..], even.values.len() as f64);
    let most = MOST_NOISE * MOST_NOISE;
    Floor {
        noise: noise.max(level).max(hidden.min(most)),
        taken: noise.max(MARGIN * level).max((MARGIN * hidden).min(most)),
        is_faint,
    }
}

/// A picture that fades out by a sine towards its borders, and the sum of the squares of its
/// weights.
fn faded(picture: &Raster) -> (Raster, f64) {
    let weights = |size: usize| -> Vec<f64> {
        let end = |i: usize| (i as f64 + 0.5) / (FADE * size as f64);
        (0..size).map(|i| (FRAC_PI_2 * end(i).min(end(size - 1 - i)).min(1.0)).sin()).collect()
    };
    let (across, down) = (weights(picture.width), weights(picture.height));
    let sum = |weights: &[f64]| weights.iter().map(|w| w * w).sum::<f64>();
    let faded = Raster::from_fn(picture.width, picture.height, |x, y| across[x] * down[y] * picture.at(x, y));
    (faded, sum(&across) * sum(&down))
}

/// Tests whether three octaves or more are seen, and none rises above [`FAINT`] or is more uneven
/// than noise.
fn are_faint(octaves: &[Mean], texels: f64) -> bool {
    let seen = || octaves.iter().filter(|octave| octave.count >= FEWEST_WAVES);
    let is_faint = |octave: &Mean| {
        octave.of_noise() * octave.count / texels <= FAINT * FAINT && octave.get() <= EVEN * octave.of_noise()
    };
    seen().count() >= 3 && seen().all(is_faint)
}

/// The most power of the octaves from the first on that are no stronger than what JPEG hides, if
/// there are three of them.
fn of_hidden_octaves(octaves: &[Mean], hidden: f64) -> f64 {
    let are_hidden =
        octaves.iter().take_while(|octave| octave.count >= FEWEST_WAVES && octave.of_noise() <= hidden);
    let (count, most) =
        are_hidden.fold((0, 0.0_f64), |(n, most), octave| (n + 1, most.max(octave.of_noise())));
    if count >= 3 { most } else { 0.0 }
}

/// All of 4–8 texels where 8–16 have no more, nothing where they have twice the power.
fn plateau(octaves: &[Mean]) -> f64 {
    let (fine, coarse) = (octaves[0].get(), octaves[1].get());
    if fine > 0.0 { (2.0 - coarse / fine).clamp(0.0, 1.0) * fine } else { 0.0 }
}

/// The power of three octaves if they are level, nothing of it if they are not.
fn of_level_octaves(octaves: &[Mean]) -> f64 {
    let powers = || octaves.iter().map(Mean::of_noise);
    let (least, most) = (powers().fold(f64::INFINITY, f64::min), powers().fold(0.0, f64::max));
    // What is stronger than a camera's is a surface.
    if most > MOST_LEVEL * MOST_LEVEL || octaves.iter().any(|octave| octave.count < FEWEST_WAVES) {
        return 0.0;
    }
    let doubt = (most / least - LEVEL) / (NOT_LEVEL - LEVEL);
    let count: f64 = octaves.iter().map(|octave| octave.count).sum();
    let mean = octaves.iter().map(|octave| octave.of_noise() * octave.count).sum::<f64>() / count;
    (1.0 - doubt).clamp(0.0, 1.0) * mean
}

#[derive(Default)]
struct Mean {
    sum: f64,
    logarithms: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, value: f64, count: f64) {
        self.sum += value * count;
        self.logarithms += value.max(f64::MIN_POSITIVE).ln() * count;
        self.count += count;
    }

    fn get(&self) -> f64 {
        self.sum / self.count.max(1.0)
    }

    /// The mean of noise that these are powers of, whatever a few strong waves among them have:
    /// powers of noise are exponentially distributed, and E ln P = ln N − γ.
    fn of_noise(&self) -> f64 {
        (self.logarithms / self.count.max(1.0) + EULER_GAMMA).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    fn rms(raster: &Raster) -> f64 {
        let mean = raster.mean();
        (raster.values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / raster.values.len() as f64).sqrt()
    }

    #[test]
    fn a_wall_loses_its_noise_and_a_waves_strength_stays() {
        let mut rng = Rng::new(5);
        let wall = Raster::from_fn(200, 160, |_, _| 0.8 + 0.01 * rng.normal());
        let quiet = without_noise_and_steps(&wall, 0.0);
        assert!(rms(&quiet.picture) < 0.05 * rms(&wall), "{}", rms(&quiet.picture));
        assert!((quiet.noise - 0.01).abs() < 0.001);
        let wave = |x: usize| 0.02 * (TAU * x as f64 / 10.0).sin();
        let noisy = Raster::from_fn(200, 160, |x, y| wall.at(x, y) + wave(x));
        let left = rms(&without_noise_and_steps(&noisy, 0.0).picture) / (0.02 / 2.0_f64.sqrt());
        assert!((left - 1.0).abs() < 0.05, "{left}");
    }

    /// Open question: a sensor's mosaic blurs noise over a texel or two, so that neither its corner
    /// nor 4–8 texels show how strong it is.
    #[test]
    fn a_wall_loses_noise_that_a_mosaic_has_blurred() {
        let mut rng = Rng::new(7);
        let white = Raster::from_fn(401, 301, |_, _| rng.normal());
        let blurred = Raster::from_fn(400, 300, |x, y| {
            let sum = white.at(x, y) + white.at(x + 1, y) + white.at(x, y + 1) + white.at(x + 1, y + 1);
            0.7 + 0.006 * sum / 2.0
        });
        let left = rms(&without_noise_and_steps(&blurred, 0.0).picture) / rms(&blurred);
        assert!(left < 0.1, "{left}");
        // A ground that has more of longer waves keeps them, however faint.
        let rising = |long: f64| {
            let mut rng = Rng::new(8);
            let coarse = Raster::from_fn(41, 31, |_, _| rng.normal());
            Raster::from_fn(400, 300, |x, y| {
                0.7 + 0.003 * (white.at(x, y) + long * coarse.at(x / 10, y / 10))
            })
        };
        let kept = rms(&without_noise_and_steps(&rising(1.0), 0.0).picture) / rms(&rising(1.0));
        assert!(kept > 0.6, "{kept}");
    }

    /// Open question of before: a wall taken at night, blurred or as JPEG, was felt with 4 to 6 µm.
    #[test]
    fn a_wall_loses_the_strong_noise_of_a_dark_room() {
        for (seed, levels) in [(21, 5.0), (22, 6.0), (32, 6.0)] {
            let mut rng = Rng::new(seed);
            let white = Raster::from_fn(403, 303, |_, _| rng.normal());
            // The mean of 3 × 3 leaves long waves as strong as they were.
            let blurred = Raster::from_fn(400, 300, |x, y| {
                let sum: f64 = (0..9).map(|i| white.at(x + i % 3, y + i / 3)).sum();
                0.7 + levels / 255.0 * sum / 9.0
            });
            let left = rms(&without_noise_and_steps(&blurred, 0.0).picture) / rms(&blurred);
            assert!(left < 0.1, "{levels}: {left}");
        }
    }

    /// Felt with 2 to 4 µm before: steps between the borders leaked into long waves.
    #[test]
    fn a_wall_loses_noise_that_was_blurred_whatever_its_borders() {
        for (seed, levels) in [(41, 2.7), (42, 4.0), (43, 2.7), (44, 4.0)] {
            let mut rng = Rng::new(seed);
            let mut wall = Raster::from_fn(400, 400, |_, _| levels / 255.0 * rng.normal());
            for _ in 0..2 {
                let at = |x: usize, y: usize| wall.at(x.min(399), y.min(399));
                wall = Raster::from_fn(400, 400, |x, y| {
                    (0..9)
                        .map(|i| at((x + i % 3).saturating_sub(1), (y + i / 3).saturating_sub(1)))
                        .sum::<f64>()
                        / 9.0
                });
            }
            let lit = Raster::from_fn(400, 400, |x, y| 0.7 - 0.07 * x as f64 / 400.0 + wall.at(x, y));
            let light = detrended(&lit);
            let quiet = detrended(&without_noise_and_steps(&lit, 0.0).picture);
            assert!(rms(&quiet) < 0.2 * rms(&light), "{seed}: {} of {}", rms(&quiet), rms(&light));
        }
    }

    #[test]
    fn a_strong_white_texture_is_no_noise() {
        let mut rng = Rng::new(6);
        let sand = Raster::from_fn(128, 128, |_, _| 0.5 + 0.1 * rng.normal());
        let quiet = without_noise_and_steps(&sand, 0.0);
        assert_eq!(quiet.noise, MOST_NOISE);
        assert!(rms(&quiet.picture) > 0.95 * rms(&sand));
    }

    #[test]
    fn a_picture_without_anything_in_it_stays_as_it_is() {
        let even = Raster::constant(20, 33, 0.25);
        let quiet = without_noise_and_steps(&even, 0.0).picture;
        assert!(quiet.values.iter().all(|v| (v - 0.25).abs() < 1e-12));
    }
}
