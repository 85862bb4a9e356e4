//! The noise of slopes, read from what no surface has.
//!
//! What lies across D, |D_y P − D_x Q|²/|D|², is noise alone, and as much of it lies along D.
//! Rounding is known beforehand ([`crate::normal_map`]) and alike at all frequencies: N is what
//! rounding leaves, and never more than what lies across. The rounding of a pattern that repeats
//! falls on few frequencies and is the stronger there: by Σ a² / 2 Σ a of the powers a across.
//!
//! More than rounding can leave lies across the slopes of a map that was resized or saved as JPEG.
//! Such noise is coloured (JPEG keeps half as many texels of two of three colours, and rounds short
//! waves the most), and its parts in both slopes are alike: where red and green lost their own
//! short waves, both follow brightness, and what is left lies along D in one diagonal and across D
//! in the other. Noise of a covariance C leaves nᵀ C n along a direction n, as much as lies across
//! D a quarter turn away; noise that follows the surface's own waves lies in their sector. N of a
//! sector's ring and its neighbours is the larger of both means, and Σ a² / 2 Σ a where it falls on
//! few frequencies.

use super::bands::{Bands, Seen, UNSEEN};

/// Power of a single frequency, over that expected of its ring and the noise, from which it is a
/// line of its own: noise reaches it once in e¹² frequencies.
pub(super) const LINE: f64 = 12.0;
/// Power across D over that of rounding from which it is something else.
const NOT_ROUNDING: f64 = 2.0;
/// Standard deviations of gathered noise that a ring has to exceed. Source: ours.
const SURE: f64 = 3.0;
/// Frequency of waves of three texels, radians per texel.
const SHORT: f64 = std::f64::consts::TAU / 3.0;
/// Fewest frequencies that show a ring's noise. Source: ours, their mean is within 12 % of it.
const ENOUGH: f64 = 64.0;

/// The noise of one slope, power of a frequency, by [`Bands`].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Noise {
    levels: Vec<Level>,
    /// Number of rings of a sector, and the first of waves shorter than three texels.
    rings: usize,
    short: usize,
}

/// The noise of one band: over all its frequencies, and where there is any.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Level {
    mean: f64,
    gathered: f64,
    is_rounding: bool,
}

impl Noise {
    /// From the most that rounding leaves, and what is seen at every place.
    pub fn of(most: f64, bands: &Bands, seen: &[Seen]) -> Self {
        let visible = || seen.iter().skip(1).filter(|s| s.square >= UNSEEN).map(|s| s.across);
        let (count, sum, squares) =
            visible().fold((0.0, 0.0, 0.0), |(n, s, q), a| (n + 1.0, s + a, q + a * a));
        let mean = most.min(sum / f64::max(count, 1.0));
        // Squares have twice the mean's square where powers are those of noise: distributed
        // exponentially.
        let gathered = if sum > 0.0 { (0.5 * squares / sum).max(mean) } else { mean };
        let rounding = Level { mean, gathered, is_rounding: true };
        let mut noise = Self {
            levels: vec![rounding; bands.count()],
            rings: bands.rings,
            short: (SHORT / bands.width) as usize,
        };
        if sum > 0.0 {
            let coloured = sum > NOT_ROUNDING * most * count;
            let measured = by_bands(bands, seen);
            for (band, (level, measured)) in noise.levels.iter_mut().zip(measured).enumerate() {
                let short = band % noise.rings >= noise.short;
                if coloured || (short && measured.mean > NOT_ROUNDING * most) {
                    *level = measured;
                }
            }
        }
        noise
    }

    /// Noise of a slope at a band's frequencies.
    pub fn mean(&self, band: usize) -> f64 {
        self.levels[band].mean
    }

    /// Noise where there is any.
    pub fn gathered(&self, band: usize) -> f64 {
        self.levels[band].gathered
    }

    /// Power taken off a line: rounding is known apart from the surface's own lines, other noise
    /// falls on them.
    pub fn of_line(&self, band: usize) -> f64 {
        let level = &self.levels[band];
        if level.is_rounding { level.mean } else { level.gathered }
    }

    /// Largest addition of the noise to a band's Σ |D_x* P + D_y* Q|² beyond that of noise spread
    /// over all frequencies, from the band's Σ |D|⁴ and the number of its frequencies: both
    /// standard deviations for many, an exponential's tail for few. Noise that is measured is known
    /// so well that nothing is added, but for waves shorter than three texels, where a surface is
    /// the weakest: one standard deviation.
    pub fn excess(&self, band: usize, under: f64, places: f64) -> f64 {
        let Level { mean, gathered, is_rounding } = self.levels[band];
        let deviation = (mean * (2.0 * gathered - mean)).sqrt() - mean;
        // k and −k are one.
        let many = deviation * (2.0 * under).sqrt();
        let few = LINE * (gathered - mean) * 2.0 * (under / places.max(1.0)).sqrt();
        match is_rounding {
            true => SURE * many + few,
            false if band % self.rings >= self.short => many,
            false => 0.0,
        }
    }
}

/// Power across D in each band or a quarter turn away, whichever is more, over so many neighbouring
/// rings that there are enough frequencies.
fn by_bands(bands: &Bands, seen: &[Seen]) -> Vec<Level> {
    let rings = bands.rings;
    // Count, Σ a and Σ a² of all rings of a sector below.
    let mut below = vec![[0.0; 3]; bands.count() / rings * (rings + 1)];
    for (place, at) in seen.iter().enumerate().skip(1).filter(|(_, at)| at.square >= UNSEEN) {
        let band = bands.of(place);
        let sums = &mut below[band / rings * (rings + 1) + band % rings + 1];
        let both = [1.0, at.across, at.across * at.across];
        sums.iter_mut().zip(both).for_each(|(sum, value)| *sum += value);
    }
    for sector in below.chunks_mut(rings + 1) {
        for ring in 0..rings {
            let before = sector[ring];
            sector[ring + 1].iter_mut().zip(before).for_each(|(to, before)| *to += before);
        }
    }
    let around = |band: usize| {
        let (sector, ring) = (&below[band / rings * (rings + 1)..][..=rings], band % rings);
        let mut reach = ring / 16;
        loop {
            let (low, high) = (ring.saturating_sub(reach), (ring + reach + 1).min(rings));
            let [count, sum, squares] = [0, 1, 2].map(|i| sector[high][i] - sector[low][i]);
            if count >= ENOUGH || (low == 0 && high == rings) {
                let mean = if count > 0.0 { sum / count } else { 0.0 };
                let gathered = if sum > 0.0 { 0.5 * squares / sum } else { 0.0 };
                return Level { mean, gathered: gathered.max(mean), is_rounding: false };
            }
            reach += 1;
        }
    };
    let larger = |band: usize| {
        let (own, turned) = (around(band), around(bands.across(band)));
        if own.mean > turned.mean { own } else { turned }
    };
    (0..bands.count()).map(larger).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    #[test]
    fn noise_on_a_ninth_of_the_frequencies_is_estimated_ninefold() {
        let mut rng = Rng::new(6);
        let frequencies: Vec<f64> = (0..300).map(|k| 0.01 * f64::from(k)).collect();
        let bands = Bands::new(&frequencies, &frequencies, 0.01);
        let across = |i: usize, rng: &mut Rng| {
            if i.is_multiple_of(9) { -18.0 * (1.0 - rng.uniform()).ln() } else { 0.0 }
        };
        let seen: Vec<Seen> =
            (0..90_000).map(|i| Seen { square: 1.0, along: 0.0, across: across(i, &mut rng) }).collect();
        let Level { mean, gathered, is_rounding } = Noise::of(2.2, &bands, &seen).levels[50];
        assert!(is_rounding);
        assert!((mean - 2.0).abs() < 0.1 && (gathered - 18.0).abs() < 1.0, "{mean} {gathered}");
        // Three times what rounding leaves is not rounding.
        let other = Noise::of(0.7, &bands, &seen);
        assert!(!other.levels[200].is_rounding && (other.mean(200) - 2.0).abs() < 0.6);
        assert!((other.gathered(200) - 18.0).abs() < 5.0, "{}", other.gathered(200));
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
        assert!((noise.mean(50) - 1.0).abs() < 1e-9 && (noise.mean(150) - 9.0).abs() < 1e-9);
    }

    #[test]
    fn noise_that_both_slopes_share_is_known_by_its_direction() {
        // p = −q, as where JPEG left brightness alone: along D it has (D_x − D_y)²/|D|² of its
        // power, across D the rest, which is nothing in one diagonal.
        let n = 128;
        let frequencies: Vec<f64> = (0..n).map(|k| crate::fft2::angular_frequency(k, n)).collect();
        let bands = Bands::new(&frequencies, &frequencies, 0.05);
        let of = |place: usize| {
            let (dx, dy) = (frequencies[place / n], frequencies[place % n]);
            let square = dx * dx + dy * dy;
            (square, (dx - dy).powi(2), (dx + dy).powi(2) / square.max(1e-12))
        };
        let seen: Vec<Seen> =
            (0..n * n).map(of).map(|(square, along, across)| Seen { square, along, across }).collect();
        let noise = Noise::of(0.01, &bands, &seen);
        for (x, y, power) in [(40, 40, 2.0), (40, 88, 2.0), (40, 0, 1.0)] {
            let found = noise.mean(bands.of(x * n + y));
            assert!((found - power).abs() < 0.15, "{x} {y}: {found}");
        }
    }
}
