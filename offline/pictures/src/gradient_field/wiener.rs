//! Wiener weights of a slope field: the surface's share of what is seen at a frequency.
//!
//! ```text
//! Z(k) = (D_x* P + D_y* Q) / (|D|² + N / S(k))        N / S = the noise of one slope over the surface's power
//! ```
//! (N. Wiener's filter.) Where a derivative is nearly blind, |D|² → 0, plain division blows noise
//! up: Sobel's does so along both edges of the spectrum. S(k) is read from the slopes themselves:
//! along D they carry |D|² S + N, so that in every ring of one frequency
//! ```text
//! S = Σ (|D_x* P + D_y* Q|² / |D|² − N) |D|² / Σ |D|⁴
//! ```
//! is the estimate with the least error; N is [`Noise`]. A surface's power is taken to fall with
//! frequency: rings where the estimate rises are joined with those below them (pool adjacent
//! violators; R. Barlow et al., "Statistical Inference under Order Restrictions", 1972), which also
//! says what the power is where nothing of it is seen. A line (patterns that repeat are made of
//! them) that stands out of its ring counts for itself and not for its ring; lines and rings have
//! to exceed what noise may gather. Eight sectors of directions are measured apart, for surfaces
//! with a grain.
//!
//! Measured (`tests/normal_map.rs`) against division with a threshold: 8-bit Sobel ridges lose 1.96
//! % of their heights in place of 2.63 % (1.86 % if the true power of every frequency were known),
//! wood 0.08 in place of 0.12 %; waves of one length, 11 to 26 texels, told how they were made,
//! 0.01–0.5 % (up to 1.1 % when all frequencies up to the waves' were believed for their sake).

use super::bands::{Bands, Seen, UNSEEN};
use super::noise::{LINE, Noise};

/// Largest number of searches for lines, weaker ones once the stronger are known.
const ROUNDS: usize = 4;
/// |D|² from which a line is believed.
const LEAST_OF_LINE: f64 = 0.01;
/// The power spectrum of a surface by directions and rings, never rising with frequency, its lines,
/// and the noise of its slopes.
pub(super) struct Wiener<'a> {
    bands: &'a Bands,
    noise: Noise,
    /// Sector after sector.
    power: Vec<f64>,
}

impl<'a> Wiener<'a> {
    /// From what is seen at every place.
    pub fn measured(bands: &'a Bands, noise: Noise, seen: &[Seen]) -> Self {
        let power = vec![f64::INFINITY; bands.count()];
        let mut found = Self { bands, noise, power };
        // A line raises its ring, and rings below it, until it is known.
        for _ in 0..ROUNDS {
            let power = found.rings_without_lines(seen);
            let settled = power == found.power;
            found.power = power;
            if settled {
                break;
            }
        }
        found
    }

    fn rings_without_lines(&self, seen: &[Seen]) -> Vec<f64> {
        let rings = self.bands.rings;
        let mut sums = vec![[0.0; 2]; self.bands.count()];
        let mut places = vec![0.0; self.bands.count()];
        for (place, at) in seen.iter().enumerate().skip(1) {
            if at.square >= UNSEEN && self.line(place, at).is_none() {
                let band = self.bands.of(place);
                let [over, under] = &mut sums[band];
                *over += at.along - self.noise.mean(self.bands.of(place)) * at.square;
                *under += at.square * at.square;
                places[band] += 1.0;
            }
        }
        for (band, ([over, under], places)) in sums.iter_mut().zip(places).enumerate() {
            *over -= self.noise.excess(band, *under, places);
        }
        sums.chunks(rings).flat_map(never_rising).collect()
    }

    /// The power of a line, if there is one.
    fn line(&self, place: usize, at: &Seen) -> Option<f64> {
        let band = self.bands.of(place);
        let own = at.along / at.square.max(UNSEEN) - self.noise.of_line(band);
        let expected = self.noise.gathered(band) + at.square * self.power[band];
        (at.square >= LEAST_OF_LINE && own >= LINE * expected).then_some(own / at.square)
    }

    /// 1/(|D|² + N/S).
    pub fn gain(&self, place: usize, at: &Seen) -> f64 {
        let band = self.bands.of(place);
        let (power, noise) = match self.line(place, at) {
            Some(power) => (power, self.noise.of_line(band)),
            None => (self.power[band], self.noise.mean(band)),
        };
        if at.square < UNSEEN || power <= 0.0 {
            return 0.0;
        }
        1.0 / (at.square + noise / power)
    }
}

/// Σ over / Σ under ring by ring, rings joined until none is above the one before.
pub(super) fn never_rising(sums: &[[f64; 2]]) -> Vec<f64> {
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

    #[test]
    fn rings_are_joined_until_the_power_falls() {
        let falling =
            never_rising(&[[0.0, 0.0], [8.0, 1.0], [3.0, 1.0], [5.0, 1.0], [0.0, 0.0], [-1.0, 2.0]]);
        assert_eq!(falling, [8.0, 8.0, 4.0, 4.0, 4.0, 0.0]);
    }
}
