//! Seeded numbers: a counter-based hash for noise lattices and a small stream generator.
//!
//! The hash is the 32-bit finaliser of PCG (M. E. O'Neill, "PCG: A Family of Simple Fast
//! Space-Efficient Statistically Good Algorithms for Random Number Generation", 2014, RXS-M-XS).
//! Same seed, same numbers, on every platform and in every version of this crate.

/// Mixes 32 bits; neighbouring inputs give unrelated outputs.
#[inline]
#[must_use]
pub const fn hash_u32(x: u32) -> u32 {
    let state = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// A stream of seeded numbers (PCG-32 output function on a 64-bit counter).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rng {
    state: u64,
}

impl Rng {
    /// A stream that depends on all 64 bits of the seed.
    ///
    /// ```
    /// use asperity_dsp::rng::Rng;
    ///
    /// let (mut a, mut b) = (Rng::new(7), Rng::new(7));
    /// assert!((0..100).all(|_| a.uniform() == b.uniform()));
    /// ```
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        let mut rng = Self { state: seed.wrapping_add(1_442_695_040_888_963_407) };
        let _ = rng.next_u32();
        rng
    }

    /// 32 random bits.
    #[inline]
    pub const fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let xorshifted = (((old >> 18) ^ old) >> 27) as u32;
        xorshifted.rotate_right((old >> 59) as u32)
    }

    /// Uniform in [0, 1).
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        f64::from(self.next_u32()) * (1.0 / 4_294_967_296.0)
    }

    /// Normal with mean 0 and standard deviation 1 (Box–Muller, one of the pair).
    pub fn normal(&mut self) -> f64 {
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.uniform()));
        radius * libm::cos(2.0 * core::f64::consts::PI * self.uniform())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_numbers_have_the_moments_of_their_distribution() {
        let mut rng = Rng::new(7);
        let n = 200_000;
        let (mut mean, mut square) = (0.0, 0.0);
        for _ in 0..n {
            let x = rng.uniform();
            mean += x / f64::from(n);
            square += x * x / f64::from(n);
        }
        assert!((mean - 0.5).abs() < 0.003 && (square - 1.0 / 3.0).abs() < 0.003);
    }

    #[test]
    fn normal_numbers_have_unit_variance_and_no_mean() {
        let mut rng = Rng::new(8);
        let n = 200_000;
        let (mut mean, mut square) = (0.0, 0.0);
        for _ in 0..n {
            let x = rng.normal();
            mean += x / f64::from(n);
            square += x * x / f64::from(n);
        }
        assert!(mean.abs() < 0.01 && (square - 1.0).abs() < 0.015);
    }

    #[test]
    fn hashing_a_counter_flips_half_of_the_bits() {
        let flips: u32 = (0..4096).map(|i| (hash_u32(i) ^ hash_u32(i + 1)).count_ones()).sum();
        assert!((f64::from(flips) / 4096.0 - 16.0).abs() < 0.3);
    }

    #[test]
    fn a_seed_names_the_same_stream_for_ever() {
        let mut rng = Rng::new(1);
        let first: [u32; 3] = [rng.next_u32(), rng.next_u32(), rng.next_u32()];
        assert_eq!(first, [1_412_771_199, 1_791_099_446, 124_312_908]);
        assert_eq!(hash_u32(0), 129_708_002);
    }
}
