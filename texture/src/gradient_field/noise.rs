//! The noise of slopes, read from what no surface has.
//!
//! What lies across D, |D_y P − D_x Q|²/|D|², is noise alone, and as much of it lies along D. Rounding is known beforehand
//! ([`crate::normal_map`]) and alike at all frequencies: N is what rounding leaves, and never more than what lies across. The
//! rounding of a pattern that repeats falls on few frequencies and is the stronger there: by Σ a² / 2 Σ a of the powers a across.
//!
//! More than rounding can leave lies across the slopes of a map that was resized or saved as JPEG. Such noise is coloured (JPEG keeps half as many
//! texels of two of three colours, and rounds short waves the most): there N is the mean of what lies across in a ring of frequencies and its neighbours.

use super::wiener::{Bands, Seen, UNSEEN};

/// Power of a single frequency, over that expected of its ring and the noise, from which it is a line of its own: noise reaches it once in
/// e¹² frequencies.
pub(super) const LINE: f64 = 12.0;
/// Power across D over that of rounding from which it is something else.
const NOT_ROUNDING: f64 = 2.0;
/// Standard deviations of gathered noise that a ring has to exceed. Source: ours.
const SURE: f64 = 3.0;
/// Fewest frequencies that tell a ring's noise. Source: ours, their mean is within 12 % of it.
const ENOUGH: f64 = 64.0;

/// The noise of one slope, power of a frequency.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Noise {
    /// Rounding's: over all frequencies, and where there is any.
    Rounding { mean: f64, gathered: f64 },
    /// Anything else's, by rings.
    Coloured(Vec<f64>),
}

impl Noise {
    /// From the most that rounding leaves, and what is seen at every place.
    pub fn of(most: f64, bands: &Bands, seen: &[Seen]) -> Self {
        let told = || seen.iter().skip(1).filter(|s| s.square >= UNSEEN).map(|s| s.across);
        let (count, sum, squares) = told().fold((0.0, 0.0, 0.0), |(n, s, q), a| (n + 1.0, s + a, q + a * a));
        if sum == 0.0 {
            return Self::Rounding { mean: 0.0, gathered: 0.0 };
        }
        if sum > NOT_ROUNDING * most * count {
            return Self::Coloured(by_rings(bands, seen));
        }
        let mean = most.min(sum / count);
        // Squares have twice the mean's square where powers are those of noise: distributed exponentially.
        Self::Rounding { mean, gathered: (0.5 * squares / sum).max(mean) }
    }

    /// That of a slope at a ring's frequencies.
    pub fn mean(&self, ring: usize) -> f64 {
        match self {
            Self::Rounding { mean, .. } => *mean,
            Self::Coloured(rings) => rings[ring],
        }
    }

    /// The same where there is any.
    pub fn gathered(&self, ring: usize) -> f64 {
        match self {
            Self::Rounding { gathered, .. } => *gathered,
            Self::Coloured(rings) => rings[ring],
        }
    }

    /// What the noise may add to a ring's Σ |D_x* P + D_y* Q|² beyond what noise spread over all frequencies may, from the ring's
    /// Σ |D|⁴ and the number of its frequencies: both standard deviations for many, an exponential's tail for few.
    pub fn excess(&self, ring: usize, under: f64, places: f64) -> f64 {
        let (mean, gathered) = (self.mean(ring), self.gathered(ring));
        let deviation = (mean * (2.0 * gathered - mean)).sqrt() - mean;
        // k and −k are one.
        let many = SURE * deviation * (2.0 * under).sqrt();
        let few = LINE * (gathered - mean) * 2.0 * (under / places.max(1.0)).sqrt();
        many + few
    }
}

/// Mean power across D of each ring, joined with its neighbours until there are enough frequencies.
fn by_rings(bands: &Bands, seen: &[Seen]) -> Vec<f64> {
    // Sums over all rings below.
    let mut below = vec![[0.0; 2]; bands.rings + 1];
    for (place, at) in seen.iter().enumerate().skip(1).filter(|(_, at)| at.square >= UNSEEN) {
        let [sum, count] = &mut below[bands.ring(place) + 1];
        *sum += at.across;
        *count += 1.0;
    }
    for ring in 0..bands.rings {
        let before = below[ring];
        below[ring + 1].iter_mut().zip(before).for_each(|(to, before)| *to += before);
    }
    let mean = |ring: usize| {
        let mut reach = ring / 16;
        loop {
            let (low, high) = (ring.saturating_sub(reach), (ring + reach + 1).min(bands.rings));
            let [sum, count] = [0, 1].map(|i| below[high][i] - below[low][i]);
            if count >= ENOUGH || (low == 0 && high == bands.rings) {
                return if count > 0.0 { sum / count } else { 0.0 };
            }
            reach += 1;
        }
    };
    (0..bands.rings).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    #[test]
    fn noise_on_one_frequency_in_nine_is_known_for_nine_times_as_strong() {
        let mut rng = Rng::new(6);
        let frequencies: Vec<f64> = (0..300).map(|k| 0.01 * f64::from(k)).collect();
        let bands = Bands::new(&frequencies, &frequencies, 0.01);
        let across = |i: usize, rng: &mut Rng| {
            if i.is_multiple_of(9) { -18.0 * (1.0 - rng.uniform()).ln() } else { 0.0 }
        };
        let seen: Vec<Seen> =
            (0..90_000).map(|i| Seen { square: 1.0, along: 0.0, across: across(i, &mut rng) }).collect();
        let Noise::Rounding { mean, gathered } = Noise::of(2.2, &bands, &seen) else { panic!("rounding") };
        assert!((mean - 2.0).abs() < 0.1 && (gathered - 18.0).abs() < 1.0, "{mean} {gathered}");
        // Three times what rounding leaves is not rounding.
        let other = Noise::of(0.7, &bands, &seen);
        assert!(matches!(other, Noise::Coloured(_)) && (other.mean(200) - 2.0).abs() < 0.6, "{other:?}");
    }

    #[test]
    fn coloured_noise_is_known_ring_by_ring() {
        let frequencies: Vec<f64> = (0..200).map(|k| 0.015 * f64::from(k)).collect();
        let bands = Bands::new(&frequencies, &frequencies, 0.015);
        let seen: Vec<Seen> = (0..40_000)
            .map(|place| Seen {
                square: 1.0,
                along: 0.0,
                across: if bands.ring(place) < 100 { 1.0 } else { 9.0 },
            })
            .collect();
        let noise = Noise::of(0.1, &bands, &seen);
        assert!((noise.mean(50) - 1.0).abs() < 1e-9 && (noise.mean(150) - 9.0).abs() < 1e-9, "{noise:?}");
    }
}
