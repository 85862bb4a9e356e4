//! Four numbers that are worked on together: a state, or a column of its map.
//!
//! Products and sums are fused where the level has a fused multiply-add and not elsewhere, always
//! in the same order: two machines may differ in the last bit, two runs or two splits on one
//! machine never do.

use crate::simd::Set;
use fearless_simd::prelude::*;
use fearless_simd::{f64x2, f64x4};

/// Four lanes. A value stands for the right to use its instructions: others are made by it.
pub(super) trait F64x4: Copy {
    /// Four numbers.
    fn load(self, from: &[f64; 4]) -> Self;
    fn array(self) -> [f64; 4];
    /// One value in every lane.
    fn splat(self, value: f64) -> Self;
    /// Lane `I` in every lane.
    fn spread<const I: usize>(self) -> Self;
    fn add(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    /// self · factor + sum.
    fn times_plus(self, factor: Self, sum: Self) -> Self;
    /// Lane 0.
    fn first(self) -> f64;
    /// The square root of a number, at least 0.
    #[inline(always)]
    fn root(self, x: f64) -> f64 {
        libm::sqrt(x)
    }
}

/// One vector, as wide as the level has it.
impl<S: Set> F64x4 for f64x4<S> {
    #[inline(always)]
    fn load(self, from: &[f64; 4]) -> Self {
        Self::load_array_ref(self.token(), from)
    }
    #[inline(always)]
    fn array(self) -> [f64; 4] {
        self.to_array()
    }
    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        SimdBase::splat(self.token(), value)
    }
    #[inline(always)]
    fn spread<const I: usize>(self) -> Self {
        SimdBase::splat(self.token(), self[I])
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self + other
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self * other
    }
    #[inline(always)]
    fn times_plus(self, factor: Self, sum: Self) -> Self {
        if S::FUSED { self.mul_add(factor, sum) } else { self * factor + sum }
    }
    #[inline(always)]
    fn first(self) -> f64 {
        self[0]
    }
    #[inline(always)]
    fn root(self, x: f64) -> f64 {
        // The library's is an older instruction, which waits for the upper half of the register.
        f64x2::splat(self.token(), x).sqrt()[0]
    }
}

/// Another vector whose products and sums round apart even where the level could fuse them: for
/// what gave those bits before it was worked out four at a time.
#[derive(Clone, Copy)]
pub(super) struct Unfused<Q>(pub Q);

impl<Q: F64x4> F64x4 for Unfused<Q> {
    #[inline(always)]
    fn load(self, from: &[f64; 4]) -> Self {
        Self(self.0.load(from))
    }
    #[inline(always)]
    fn array(self) -> [f64; 4] {
        self.0.array()
    }
    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        Self(self.0.splat(value))
    }
    #[inline(always)]
    fn spread<const I: usize>(self) -> Self {
        Self(self.0.spread::<I>())
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0.add(other.0))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0.mul(other.0))
    }
    #[inline(always)]
    fn times_plus(self, factor: Self, sum: Self) -> Self {
        self.mul(factor).add(sum)
    }
    #[inline(always)]
    fn first(self) -> f64 {
        self.0.first()
    }
    #[inline(always)]
    fn root(self, x: f64) -> f64 {
        self.0.root(x)
    }
}

/// Two pairs: spreading a lane of a pair takes one cycle where one of four takes three.
#[derive(Clone, Copy)]
pub(super) struct F64x2Pair<S: Set>(f64x2<S>, f64x2<S>);

impl<S: Set> F64x2Pair<S> {
    /// Zeros.
    #[inline(always)]
    pub fn zero(token: S) -> Self {
        let zero = f64x2::splat(token, 0.0);
        Self(zero, zero)
    }
}

impl<S: Set> F64x4 for F64x2Pair<S> {
    #[inline(always)]
    fn load(self, [a, b, c, d]: &[f64; 4]) -> Self {
        let token = self.0.token();
        Self(f64x2::load_array(token, [*a, *b]), f64x2::load_array(token, [*c, *d]))
    }
    #[inline(always)]
    fn array(self) -> [f64; 4] {
        [self.0[0], self.0[1], self.1[0], self.1[1]]
    }
    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        let both = f64x2::splat(self.0.token(), value);
        Self(both, both)
    }
    #[inline(always)]
    fn spread<const I: usize>(self) -> Self {
        let half = if I < 2 { self.0 } else { self.1 };
        let both = if I.is_multiple_of(2) { half.zip_low(half) } else { half.zip_high(half) };
        Self(both, both)
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0, self.1 * other.1)
    }
    #[inline(always)]
    fn times_plus(self, factor: Self, sum: Self) -> Self {
        if S::FUSED {
            Self(self.0.mul_add(factor.0, sum.0), self.1.mul_add(factor.1, sum.1))
        } else {
            self.mul(factor).add(sum)
        }
    }
    #[inline(always)]
    fn first(self) -> f64 {
        self.0[0]
    }
}
