//! Waves of every direction and nearly one length, which fit themselves at one distance whatever
//! the direction, and repeat nowhere.
//!
//! ```text
//! P_i = Σ (|X(k)|² − N) over sector i of 24 and 0.82 K < |k| < 1.22 K        quiet = Σ of the 8 least P_i / Σ P_i
//! ```
//! | symbol | here |
//! |---|---|
//! | X | spectrum of the picture under a Hann window |
//! | K | the ring of the most power near that of the lattice's shortest translation t, 0.7/&#124;t&#124; to 1.6/&#124;t&#124;, or of the next few, to 4.5/&#124;t&#124;, where that ring has most of the picture's power |
//! | N | noise: the median power of 1.45 K to 1.9 K, over ln 2 |
//!
//! A lattice's waves lie in a few directions: quiet is 0 to 0.005 for square, hexagonal,
//! rectangular and oblique patterns, clean, noisy and warped, and for frames; 0.002 for the skin of
//! a reptile. Of ripples, wrinkles and grains of one size it is 0.07–0.21, a third where they are
//! many. Source: ours.

use crate::fft2::{Fft2, angular_frequency};
use crate::histogram::median;
use asperity_surface::raster::Raster;
use std::f64::consts::{LN_2, PI, TAU};

/// Share of the power in the quietest third of the directions from which there is no lattice.
const QUIET: f64 = 0.04;
/// Directions in half a turn.
const SECTORS: usize = 24;
/// Band in which the ring is looked for, over one wave a translation.
const SOUGHT: [f64; 2] = [0.7, 1.6];
/// Band for a lattice of several waves a cell, as chance proposes where nothing but the ring is
/// seen.
const SEVERAL: [f64; 2] = [1.6, 4.5];
/// Share of the picture's power that the ring then has at least: a pattern's harmonics stand beside
/// its fundamental.
const MOST_OF_ALL: f64 = 0.6;
/// The ring, and where the noise is measured, over its middle.
const RING: [f64; 2] = [0.82, 1.22];
const NOISE: [f64; 2] = [1.45, 1.9];
/// Power of the ring over the noise below which its directions are not known.
const CLEAR_OF_NOISE: f64 = 2.5;
/// Waves across the shorter side below which a sector has too few frequencies.
const FEWEST_WAVES: f64 = 6.0;

/// Tests whether a picture's waves about as long as a translation, texels, have every direction.
pub(super) fn has_waves_of_every_direction(picture: &Raster, translation_px: f64) -> bool {
    let waves = Waves::of(picture);
    let step = TAU / picture.width.min(picture.height) as f64;
    let strongest =
        |sought: [f64; 2]| waves.strongest_ring(sought.map(|share| share * TAU / translation_px), step);
    let power = |band: [f64; 2]| waves.between(band).map(|wave| wave.power).sum::<f64>();
    let is_most =
        |middle: &f64| power(RING.map(|share| share * middle)) >= MOST_OF_ALL * power([0.0, f64::INFINITY]);
    let near = strongest(SOUGHT).is_some_and(|middle| waves.have_every_direction(middle, step));
    near || strongest(SEVERAL).filter(is_most).is_some_and(|middle| waves.have_every_direction(middle, step))
}

/// One wave of the windowed picture.
#[derive(Debug, Clone, Copy)]
struct Wave {
    /// Radians per texel.
    frequency: f64,
    /// Direction, 0 to π.
    turn: f64,
    power: f64,
}

struct Waves(Vec<Wave>);

impl Waves {
    /// Tests whether the ring about this frequency has every direction.
    fn have_every_direction(&self, middle: f64, step: f64) -> bool {
        if middle < FEWEST_WAVES * step {
            return false;
        }
        let ring: Vec<Wave> = self.between(RING.map(|share| share * middle)).collect();
        let noise =
            median(self.between(NOISE.map(|share| share * middle)).map(|wave| wave.power).collect()) / LN_2;
        let mut sectors = [0.0; SECTORS];
        for wave in &ring {
            let sector = (wave.turn / PI * SECTORS as f64) as usize;
            sectors[sector.min(SECTORS - 1)] += wave.power - noise;
        }
        let all: f64 = sectors.iter().sum();
        if all < (CLEAR_OF_NOISE - 1.0) * noise * ring.len() as f64 || all <= 0.0 {
            return false;
        }
        sectors.sort_by(f64::total_cmp);
        sectors[..SECTORS / 3].iter().sum::<f64>() > QUIET * all
    }

    fn of(picture: &Raster) -> Self {
        let (w, h) = (picture.width, picture.height);
        let hann = |i: usize, n: usize| 0.5 - 0.5 * (TAU * (i as f64 + 0.5) / n as f64).cos();
        let mean = picture.mean();
        let windowed = Raster::from_fn(w, h, |x, y| (picture.at(x, y) - mean) * hann(x, w) * hann(y, h));
        let spectrum = Fft2::new(w, h).spectrum(&windowed.values);
        let wave = |(place, value): (usize, &asperity_fft::num_complex::Complex64)| {
            let (wx, wy) = (angular_frequency(place / h, w), angular_frequency(place % h, h));
            Wave { frequency: wx.hypot(wy), turn: wy.atan2(wx).rem_euclid(PI), power: value.norm_sqr() }
        };
        Self(spectrum.iter().enumerate().skip(1).map(wave).collect())
    }

    fn between(&self, [low, high]: [f64; 2]) -> impl Iterator<Item = Wave> + '_ {
        self.0.iter().copied().filter(move |wave| wave.frequency > low && wave.frequency < high)
    }

    /// Frequency of the ring, one step wide, of the largest mean power.
    fn strongest_ring(&self, sought: [f64; 2], step: f64) -> Option<f64> {
        let mut rings = vec![(0.0, 0.0); (sought[1] / step) as usize + 2];
        for wave in self.between(sought) {
            let (power, count) = &mut rings[(wave.frequency / step) as usize];
            (*power, *count) = (*power + wave.power, *count + 1.0);
        }
        let means =
            rings.iter().enumerate().filter(|(_, ring)| ring.1 > 0.0).map(|(i, ring)| (i, ring.0 / ring.1));
        means.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| (i as f64 + 0.5) * step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    #[test]
    fn three_directions_are_few_and_sixty_are_all() {
        let mut rng = Rng::new(31);
        let mut waves = |count: usize, noise: f64| {
            let terms: Vec<[f64; 3]> = (0..count)
                .map(|i| {
                    let turn = PI * (i as f64 + 0.3) / count as f64;
                    [TAU / 12.0 * turn.cos(), TAU / 12.0 * turn.sin(), TAU * rng.uniform()]
                })
                .collect();
            let scale = (2.0 / count as f64).sqrt();
            Raster::from_fn(256, 200, |x, y| {
                let sum: f64 = terms.iter().map(|t| (t[0] * x as f64 + t[1] * y as f64 + t[2]).cos()).sum();
                scale * sum + noise * rng.normal()
            })
        };
        for noise in [0.0, 1.0] {
            assert!(!has_waves_of_every_direction(&waves(3, noise), 13.5), "{noise}");
            assert!(has_waves_of_every_direction(&waves(60, noise), 13.5), "{noise}");
        }
        // A translation of three waves that chance proposed.
        assert!(has_waves_of_every_direction(&waves(60, 0.0), 36.0));
        assert!(!has_waves_of_every_direction(&waves(3, 0.0), 36.0));
        // White noise alone has no ring.
        assert!(!has_waves_of_every_direction(&waves(3, 1e3), 13.5));
    }
}
