//! Numbers side by side: what the polynomial of a cell needs, for each instruction set.
//!
//! Each operation is one IEEE operation a lane, never fused, so that every set gives the same bits.
//! All inline into a function that enables the set.

use asperity_dsp::simd::Set;
use asperity_dsp::simd::fearless_simd::prelude::*;
use asperity_dsp::simd::fearless_simd::{f32x4, f64x4, f64x8};
use std::ops::{Add, Mul, Sub};

/// Several `f64`.
pub(super) trait Lanes: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}

/// An instruction set that works on N `f64` at once.
pub(super) trait Vector<const N: usize>: Copy {
    /// N `f64`.
    type Lanes: Lanes;
    fn splat(self, x: f64) -> Self::Lanes;
    fn load(self, from: &[f64; N]) -> Self::Lanes;
    fn store(self, x: Self::Lanes, to: &mut [f64; N]);
    /// Number of lanes from the first on that hold equal numbers.
    fn equal_lanes(self, a: Self::Lanes, b: Self::Lanes) -> usize;
}

/// Four rows of four, as a cell has them.
pub(super) trait Rows: Vector<4> {
    fn widen(self, from: &[f32; 4]) -> Self::Lanes;
    fn transpose(self, rows: [Self::Lanes; 4]) -> [Self::Lanes; 4];
    /// Says that the number at `at` will soon be read; nothing else happens.
    fn prefetch(self, at: &f32);
}

/// Four numbers at once.
#[derive(Clone, Copy)]
pub(super) struct Four<S>(pub S);

/// Eight numbers at once.
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))] // Nobody else has vectors of 512 bits.
#[derive(Clone, Copy)]
pub(super) struct Eight<S>(pub S);

macro_rules! vector {
    ($name:ident, $n:literal, $lanes:ident) => {
        impl<S: Set> Lanes for $lanes<S> {}
        impl<S: Set> Vector<$n> for $name<S> {
            type Lanes = $lanes<S>;
            #[inline(always)]
            fn splat(self, x: f64) -> $lanes<S> {
                $lanes::splat(self.0, x)
            }
            #[inline(always)]
            fn load(self, from: &[f64; $n]) -> $lanes<S> {
                $lanes::load_array_ref(self.0, from)
            }
            #[inline(always)]
            fn store(self, x: $lanes<S>, to: &mut [f64; $n]) {
                x.store_array(to);
            }
            #[inline(always)]
            fn equal_lanes(self, a: $lanes<S>, b: $lanes<S>) -> usize {
                a.simd_eq(b).to_bitmask().trailing_ones() as usize
            }
        }
    };
}
vector!(Four, 4, f64x4);
vector!(Eight, 8, f64x8);

impl<S: Set> Rows for Four<S> {
    #[inline(always)]
    fn widen(self, from: &[f32; 4]) -> f64x4<S> {
        let (low, high) = f32x4::load_array_ref(self.0, from).widen();
        low.combine(high)
    }
    #[inline(always)]
    fn transpose(self, rows: [f64x4<S>; 4]) -> [f64x4<S>; 4] {
        self.0.transpose(rows)
    }
    #[inline(always)]
    fn prefetch(self, at: &f32) {
        self.0.prefetch(at);
    }
}
