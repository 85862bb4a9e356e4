//! Gains of the octaves: polynomials of the roughness for the powers of its exponent
//! ([`alpha`](super::FractalNoise::alpha)), and the fade with the footprint.

use crate::simd::Vector;

/// r = 2^(−(α − 1)/2) = 2^(−0.75 (1 − R)): the ratio of the gains of an octave and the next coarser
/// one, within 1e-6.
pub(super) const OCTAVE_RATIO: [f32; 5] =
    [0.594_603_8, 0.309_091_63, 0.080_510_76, 0.013_454_678, 0.002_338_592];

/// 1/r, within 1e-6.
pub(super) const INVERSE_OCTAVE_RATIO: [f32; 5] =
    [1.681_791_9, -0.874_249, 0.226_884_53, -0.038_360_09, 0.003_933_027_4];

/// L(R): gain of the octave of 1.024 mm cells that makes the octave about 1 mm have an rms of 1.
pub(super) const LEVEL: [f32; 5] = [6.141_755, -2.561_869_4, -0.443_945_3, 0.239_734_56, -0.097_434_45];

/// Gain beyond 1 of the finest living octave, which stands in for the tails of all finer ones.
const TAIL_BOOST: [f32; 4] = [0.092_212_5, 0.124_280_17, -0.010_080_097, 0.167_875_62];

/// Σ cₖ xᵏ
#[inline(always)]
pub(super) fn polynomial<const N: usize, V: Vector<N>>(v: V, x: V::Single, c: &[f32]) -> V::Single {
    let mut terms = c.iter().rev();
    let mut sum = v.splat(terms.next().copied().unwrap_or(0.0));
    for c in terms {
        sum = v.splat(*c) + x * sum;
    }
    sum
}

/// The nearest number within 0–1, and 0 for a NaN.
#[inline(always)]
pub(super) fn within_0_1<const N: usize, V: Vector<N>>(v: V, x: V::Single) -> V::Single {
    v.min(v.max(x, v.splat(0.0)), v.splat(1.0))
}

/// Smooth fade from 1 at 4 samples a cell to 0 at 2; exactly 1 above and 0 below.
#[inline(always)]
pub(super) fn footprint_weight<const N: usize, V: Vector<N>>(v: V, samples_per_cell: V::Single) -> V::Single {
    let s = within_0_1(v, v.splat(0.5) * samples_per_cell - v.splat(1.0));
    s * s * (v.splat(3.0) - v.splat(2.0) * s)
}

/// Gains that follow from the roughness.
#[derive(Clone, Copy)]
pub(super) struct Gains<F> {
    /// Gain of the finest octave for an rms of 1 in the octave about 1 mm.
    pub finest: F,
    /// Ratio of the next coarser one.
    pub coarser: F,
    /// Gain beyond 1 of the finest living octave.
    pub tail_boost: F,
}

/// For a roughness of 0–1, clamped.
#[inline(always)]
pub(super) fn gains<const N: usize, V: Vector<N>>(v: V, roughness: V::Single) -> Gains<V::Single> {
    let roughness = within_0_1(v, roughness);
    let r = polynomial(v, roughness, &OCTAVE_RATIO);
    let r2 = r * r;
    // The finest octave is seven below that of 1.024 mm cells.
    let finest = polynomial(v, roughness, &LEVEL) * (r2 * r2) * (r2 * r);
    Gains {
        finest,
        coarser: polynomial(v, roughness, &INVERSE_OCTAVE_RATIO),
        tail_boost: polynomial(v, roughness, &TAIL_BOOST),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fractal_noise::FractalNoise;
    use crate::simd::{BASE, Eight};

    #[test]
    fn the_polynomials_are_the_powers_they_stand_for() {
        for n in 0..=100 {
            let r = n as f32 / 100.0;
            let of = |c| f64::from(polynomial(Eight(BASE), Eight(BASE).splat(r), c)[0]);
            let exact = libm::pow(2.0, 0.5 - 0.5 * FractalNoise::alpha(f64::from(r)));
            assert!((of(&OCTAVE_RATIO) / exact - 1.0).abs() < 2e-6, "{r}");
            assert!((of(&INVERSE_OCTAVE_RATIO) * exact - 1.0).abs() < 2e-6, "{r}");
        }
    }

    #[test]
    fn an_octave_fades_between_four_and_two_samples_a_cell() {
        let weight = |samples| footprint_weight(Eight(BASE), Eight(BASE).splat(samples))[0];
        assert_eq!((weight(1.9), weight(2.0), weight(f32::NAN)), (0.0, 0.0, 0.0));
        assert_eq!((weight(4.0), weight(1e9)), (1.0, 1.0));
        assert!((weight(3.0) - 0.5).abs() < 1e-6);
    }
}
