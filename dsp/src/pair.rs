//! Two `f64` side by side, one register on every processor with vectors.
//!
//! Left to itself the compiler pairs other numbers than those that wait for each other. Each
//! operation is one IEEE operation a lane, so that every processor gives the same bits.

use crate::simd::{BASE, Base};
use core::ops::{Add, Mul, Sub};
use fearless_simd::f64x2;
use fearless_simd::prelude::*;

/// Two numbers.
#[derive(Debug, Clone, Copy)]
pub struct Pair(f64x2<Base>);

impl From<[f64; 2]> for Pair {
    #[inline(always)]
    fn from(lanes: [f64; 2]) -> Self {
        Self(f64x2::load_array(BASE, lanes))
    }
}

impl From<Pair> for [f64; 2] {
    #[inline(always)]
    fn from(Pair(lanes): Pair) -> Self {
        lanes.to_array()
    }
}

impl Pair {
    /// The smaller of either lane; where one is no number, the other.
    #[inline(always)]
    #[must_use]
    pub fn least(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }

    /// The larger of either lane; where one is no number, the other.
    #[inline(always)]
    #[must_use]
    pub fn greatest(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }
}

impl Pair {
    /// Either lane, or 0 where it is nearer to 0 than the same lane of `least`.
    #[inline(always)]
    #[must_use]
    pub fn or_zero_below(self, least: Self) -> Self {
        Self(self.0.abs().simd_lt(least.0).select(f64x2::splat(BASE, 0.0), self.0))
    }

    /// The first lanes of two, and the second lanes.
    #[inline(always)]
    #[must_use]
    pub fn transposed([a, b]: [Self; 2]) -> [Self; 2] {
        [Self(a.0.zip_low(b.0)), Self(a.0.zip_high(b.0))]
    }
}

macro_rules! operator {
    ($operator:ident, $method:ident) => {
        impl $operator for Pair {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
