//! Heights from slopes that were rounded: what a derivative hardly sees is not taken from noise.
//!
//! ```text
//! Z(k) = (D_x* P + D_y* Q) / (|D|² + N / S(k))        N / S = the noise of one slope over the surface's power
//! ```
//! (N. Wiener's filter.) Where a derivative is nearly blind, |D|² → 0, plain division blows rounding up: Sobel's does so along both
//! edges of the spectrum. N is known ([`crate::normal_map`]), and never more than what lies across D, which no surface has; S(k) is read from the slopes themselves: along D they
//! carry |D|² S + N, so that in every ring of one frequency
//! ```text
//! S = Σ (|D_x* P + D_y* Q|² / |D|² − N) |D|² / Σ |D|⁴
//! ```
//! is the estimate with the least error. A surface's power is taken to fall with frequency: rings where the estimate rises are joined with
//! those below them (pool adjacent violators; R. Barlow et al., "Statistical Inference under Order Restrictions",
//! 1972), which also says what the power is where nothing of it is seen. A line (patterns that repeat are made of them) that stands out of
//! its ring counts for itself and not for its ring. The rounding of a pattern that repeats does so too: it falls on few
//! frequencies and is the stronger there. What lies across D tells how strong (Σ a² / 2 Σ a of its powers a); lines and rings
//! have to exceed that. Eight sectors of directions are measured apart, for surfaces with a grain.
//!
//! Measured (`tests/normal_map.rs`) against division with a threshold: 8-bit Sobel ridges lose 1.96 % of their heights in place
//! of 2.63 % (1.86 % if the true power of every frequency were known), wood 0.08 in place of 0.12 %; waves of one length, 11 to 26 texels,
//! told how they were made, 0.01–0.5 % (up to 1.1 % when all frequencies up to the waves' were believed for their sake).

use super::{Derivative, Slopes, unpack};
use crate::fft2::{Fft2, angular_frequency};
use crate::raster::Raster;
use asperity_fft::num_complex::Complex64;
use std::f64::consts::PI;

/// Sectors of directions whose power is measured apart. Ours: 4 to 24 differ by less than a tenth of the error.
const SECTORS: usize = 8;
/// Power of a single frequency, over that expected of its ring and the noise, from which it is a line of its own: noise reaches it once in
/// e¹² frequencies.
const LINE: f64 = 12.0;
/// Power across D over that of rounding from which it is something else.
const NOT_ROUNDING: f64 = 2.0;
/// Standard deviations of gathered noise that a ring has to exceed. Source: ours.
const SURE: f64 = 3.0;
/// How often lines are looked for at the most, weaker ones once the stronger are known.
const ROUNDS: usize = 4;
/// |D|² from which a line is believed.
const LEAST_OF_LINE: f64 = 0.01;
/// |D|² below which a derivative sees nothing.
const UNSEEN: f64 = 1e-9;

/// The surface that tiles whose slopes these are but for a noise of variance `noise` at the most in each, mean 0.
#[must_use]
pub fn integrate_rounded(field: &Slopes, derivative: Derivative, noise: f64) -> Raster {
    let (w, h) = (field.along_u.width, field.along_u.height);
    let mut image = field.packed();
    let mut packed = vec![Complex64::default(); image.len()];
    let mut fft = Fft2::new(w, h);
    fft.forward(&mut image, &mut packed);
    // |D|², D* (P, Q) / i, and the power across D.
    let seen = |place| {
        let [dx, dy] = derivative.at_bin(place, w, h);
        let [p, q] = unpack(&packed, place, w, h);
        let along = (p * dx + q * dy) * Complex64::new(0.0, -1.0);
        (dx * dx + dy * dy, along, (p * dy - q * dx).norm_sqr())
    };
    let across = (1..w * h).map(seen).filter(|s| s.0 >= UNSEEN).map(|(square, _, across)| across / square);
    let noise = Noise::of(noise * (w * h) as f64, across);
    let power = Power::measured(w, h, noise, |place| {
        let (square, along, _) = seen(place);
        (square, along.norm_sqr())
    });
    let height = |place| {
        let (square, along, _) = seen(place);
        let power = power.of(place, square, along.norm_sqr());
        let filtered = along / (square + noise.mean / power);
        if square < UNSEEN || power <= 0.0 { Complex64::default() } else { filtered }
    };
    let mut heights: Vec<Complex64> = (0..w * h).map(height).collect();
    heights[0] = Complex64::default();
    fft.image(&mut heights)
}

/// The noise of one slope, power of a frequency.
#[derive(Debug, Clone, Copy)]
struct Noise {
    /// Over all frequencies.
    mean: f64,
    /// Where there is any.
    gathered: f64,
}

impl Noise {
    /// From the most there can be, and the power across D of every frequency seen.
    fn of(most: f64, across: impl Iterator<Item = f64>) -> Self {
        let (count, sum, squares) = across.fold((0.0, 0.0, 0.0), |(n, s, q), a| (n + 1.0, s + a, q + a * a));
        let mean = if count > 0.0 { most.min(sum / count) } else { most };
        // What is more than rounding says nothing of how rounding gathers.
        if sum == 0.0 || sum > NOT_ROUNDING * most * count {
            return Self { mean, gathered: mean };
        }
        // Squares have twice the mean's square where powers are those of noise: distributed exponentially.
        Self { mean, gathered: (0.5 * squares / sum).max(mean) }
    }

    /// What the noise may add to a ring's Σ |D_x* P + D_y* Q|² beyond what noise spread over all frequencies may, from the ring's
    /// Σ |D|⁴ and the number of its frequencies: both standard deviations for many, an exponential's tail for few.
    fn excess(self, under: f64, places: f64) -> f64 {
        let deviation = (self.mean * (2.0 * self.gathered - self.mean)).sqrt() - self.mean;
        // k and −k are one.
        let many = SURE * deviation * (2.0 * under).sqrt();
        let few = LINE * (self.gathered - self.mean) * 2.0 * (under / places.max(1.0)).sqrt();
        many + few
    }
}

/// The power spectrum of a surface by directions and rings, never rising with frequency, and its lines.
struct Power {
    width: usize,
    height: usize,
    rings: usize,
    noise: Noise,
    /// Sector after sector.
    power: Vec<f64>,
}

impl Power {
    /// From |D|² and |D_x* P + D_y* Q|² at every place.
    fn measured(width: usize, height: usize, noise: Noise, seen: impl Fn(usize) -> (f64, f64)) -> Self {
        let rings = 1 + ring(width / 2 * height + height / 2, width, height);
        let mut found = Self { width, height, rings, noise, power: vec![f64::INFINITY; SECTORS * rings] };
        // A line raises its ring, and rings below it, until it is known.
        for _ in 0..ROUNDS {
            let mut sums = vec![[0.0; 2]; SECTORS * rings];
            let mut places = vec![0.0; SECTORS * rings];
            for place in 1..width * height {
                let (square, along) = seen(place);
                if square >= UNSEEN && found.line(place, square, along).is_none() {
                    let ring = found.ring(place);
                    let [over, under] = &mut sums[ring];
                    *over += along - noise.mean * square;
                    *under += square * square;
                    places[ring] += 1.0;
                }
            }
            for ([over, under], places) in sums.iter_mut().zip(places) {
                *over -= noise.excess(*under, places);
            }
            let power: Vec<f64> = sums.chunks(rings).flat_map(never_rising).collect();
            let settled = power == found.power;
            found.power = power;
            if settled {
                break;
            }
        }
        found
    }

    fn ring(&self, place: usize) -> usize {
        sector(place, self.width, self.height) * self.rings + ring(place, self.width, self.height)
    }

    /// The power of a line at a place with this |D|² and |D_x* P + D_y* Q|², if there is one.
    fn line(&self, place: usize, square: f64, along: f64) -> Option<f64> {
        let own = along / square.max(UNSEEN) - self.noise.mean;
        let expected = self.noise.gathered + square * self.power[self.ring(place)];
        (square >= LEAST_OF_LINE && own >= LINE * expected).then_some(own / square)
    }

    /// That of a line, or that of the ring.
    fn of(&self, place: usize, square: f64, along: f64) -> f64 {
        self.line(place, square, along).unwrap_or_else(|| self.power[self.ring(place)])
    }
}

/// Which sector of directions a frequency lies in; k and −k lie in the same.
fn sector(place: usize, width: usize, height: usize) -> usize {
    let (wx, wy) = (angular_frequency(place / height, width), angular_frequency(place % height, height));
    // The sectors' middles, not their edges, lie on the axes, and the smallest step decides no sector.
    let turn = wy.atan2(wx).rem_euclid(PI) / PI * SECTORS as f64;
    (turn + 0.5) as usize % SECTORS
}

/// Which ring of frequencies, as wide as the finest step of either side.
fn ring(place: usize, width: usize, height: usize) -> usize {
    let (wx, wy) = (angular_frequency(place / height, width), angular_frequency(place % height, height));
    (wx.hypot(wy) * width.max(height) as f64 / (2.0 * PI)).round() as usize
}

/// Σ over / Σ under ring by ring, rings joined until none is above the one before.
fn never_rising(sums: &[[f64; 2]]) -> Vec<f64> {
    let mut joined: Vec<(f64, f64, usize)> = Vec::with_capacity(sums.len());
    for &[over, under] in sums {
        let mut last = (over, under, 1);
        while let Some(&before) = joined.last() {
            let seen = last.1 > 0.0 && before.1 > 0.0;
            if seen && last.0 * before.1 <= before.0 * last.1 {
                break;
            }
            last = (before.0 + last.0, before.1 + last.1, before.2 + last.2);
            joined.pop();
        }
        joined.push(last);
    }
    let value = |over: f64, under: f64| if under > 0.0 { over.max(0.0) / under } else { 0.0 };
    joined.iter().flat_map(|&(over, under, n)| std::iter::repeat_n(value(over, under), n)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradient_field::slopes;

    #[test]
    fn rings_are_joined_until_the_power_falls() {
        let falling =
            never_rising(&[[0.0, 0.0], [8.0, 1.0], [3.0, 1.0], [5.0, 1.0], [0.0, 0.0], [-1.0, 2.0]]);
        assert_eq!(falling, [8.0, 8.0, 4.0, 4.0, 4.0, 0.0]);
    }

    #[test]
    fn slopes_without_noise_give_the_surface_back() {
        let surface = Raster::from_fn(48, 35, |x, y| {
            let (u, v) = (2.0 * PI * x as f64 / 48.0, 2.0 * PI * y as f64 / 35.0);
            (3.0 * u).cos() + 0.7 * (2.0 * u - 5.0 * v + 0.4).sin()
        });
        for derivative in crate::gradient_field::DERIVATIVES {
            let made = integrate_rounded(&slopes(&surface, derivative), derivative, 0.0);
            for (a, b) in made.values.iter().zip(&surface.values) {
                assert!((a - b).abs() < 1e-11, "{derivative:?}");
            }
        }
    }

    #[test]
    fn noise_on_one_frequency_in_nine_is_known_for_nine_times_as_strong() {
        let mut rng = asperity_dsp::rng::Rng::new(6);
        let powers: Vec<f64> =
            (0..90_000).map(|i| if i % 9 == 0 { -18.0 * (1.0 - rng.uniform()).ln() } else { 0.0 }).collect();
        let noise = Noise::of(2.2, powers.iter().copied());
        assert!((noise.mean - 2.0).abs() < 0.1 && (noise.gathered - 18.0).abs() < 1.0, "{noise:?}");
        // Three times what rounding leaves is not rounding.
        let other = Noise::of(0.7, powers.into_iter());
        assert_eq!((other.mean, other.gathered), (0.7, 0.7));
    }

    #[test]
    fn slopes_that_are_all_noise_have_no_height() {
        let mut rng = asperity_dsp::rng::Rng::new(5);
        let mut noise = || Raster::from_fn(64, 64, |_, _| rng.normal());
        let field = Slopes { along_u: noise(), along_v: noise() };
        let power = |r: Raster| r.values.iter().map(|z| z * z).sum::<f64>();
        let believed = power(integrate_rounded(&field, Derivative::Central, 1e-9));
        let filtered = power(integrate_rounded(&field, Derivative::Central, 1.0));
        assert!(filtered < 0.2 * believed, "{filtered} of {believed}");
    }
}
