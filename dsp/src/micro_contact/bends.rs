//! What a profile does between two samples beside the cubic through them, where it is known midway too.
//!
//! ```text
//! s(0) = 4/3 (m₊ − m₋) − 1/6 (h₊ − h₋)        bend = quartic(h₀, h₁, s(0), s(1), m) − cubic(h₀, h₁, (h₊ − h₋)/2 …)
//! ```
//! h are heights at samples and m those midway between. Slopes of differences over half a sample and the height midway make the profile
//! exact to the fourth degree, where a Catmull-Rom cubic is to the second: what passes within four samples is missed by a twentieth of
//! what the cubic misses. All terms are differences, and they add: of a sum of reliefs only those that need it have to be looked at midway.

/// c₁ … c₄ of the polynomial over a sample beyond the cubic's, m.
pub type Bend = [f64; 4];

/// Samples that have to be known before the first bend.
const KNOWN: u8 = 3;

/// The last heights at samples and midway, of which bends come.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bends {
    /// At the last three samples, oldest first, m.
    at_m: [f64; 3],
    /// Midway between them, m.
    midway_m: [f64; 2],
    known: u8,
}

impl Bends {
    /// Takes the height at the next sample, and that midway from the sample before; the bend that ends at the sample before, zero where too
    /// little is known yet.
    #[must_use]
    pub fn next(&mut self, at_m: f64, midway_m: f64) -> Bend {
        let ([h0, h1, h2], h3) = (self.at_m, at_m);
        let ([m0, m1], m2) = (self.midway_m, midway_m);
        (self.at_m, self.midway_m) = ([h1, h2, h3], [m1, m2]);
        if self.known < KNOWN {
            self.known += 1;
            return [0.0; 4];
        }
        let (first, last) = (h2 - h0, h3 - h1);
        // Slopes at both ends beyond the cubic's, and the height midway beyond that of the cubic with the new slopes.
        let begin = (4.0 * (m1 - m0) - 2.0 * first) * (1.0 / 3.0);
        let end = (4.0 * (m2 - m1) - 2.0 * last) * (1.0 / 3.0);
        let slopes = (0.5 * first + begin) - (0.5 * last + end);
        let middle = 16.0 * ((m1 - 0.5 * (h1 + h2)) - 0.125 * slopes);
        [begin, middle - (2.0 * begin + end), (begin + end) - 2.0 * middle, middle]
    }

    /// What comes next has nothing to do with what was.
    pub fn forget(&mut self) {
        self.known = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_its_bend_a_cubic_is_a_polynomial_of_the_fourth_degree_to_rounding() {
        let height = |x: f64| 3.0 - 0.7 * x + 0.3 * x * x - 0.11 * x * x * x + 0.013 * x * x * x * x;
        let mut bends = Bends::default();
        for n in 0..20 {
            let at = f64::from(n);
            let bend = bends.next(height(at), height(at - 0.5));
            if n < 3 {
                assert_eq!(bend, [0.0; 4]);
                continue;
            }
            let [before, inside, after] =
                [0.0, 1.0, 2.0].map(|k| height(at - 2.0 + k) - height(at - 3.0 + k));
            let cubic = [
                0.5 * (before + inside),
                1.5 * inside - before - 0.5 * after,
                0.5 * (before + after) - inside,
                0.0,
            ];
            for x in [0.0, 0.2, 0.5, 0.9, 1.0] {
                let rise = (0..4).rev().fold(0.0, |sum, k| x * (sum + cubic[k] + bend[k]));
                let wanted = height(at - 2.0 + x) - height(at - 2.0);
                assert!((rise - wanted).abs() < 1e-9, "{n}, {x}: {rise} and not {wanted}");
            }
        }
        bends.forget();
        assert_eq!(bends.next(5.0, 4.0), [0.0; 4]);
    }
}
