//! Two `f64` side by side, one register on every x86-64 processor.
//!
//! Left to itself the compiler pairs other numbers than those that wait for each other. Each operation is one IEEE
//! operation a lane, so that every processor gives the same bits.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::{
    __m128d, _mm_add_pd, _mm_cvtsd_f64, _mm_mul_pd, _mm_set_pd, _mm_sub_pd, _mm_unpackhi_pd,
};
use core::ops::{Add, Mul, Sub};

/// Two numbers.
#[derive(Debug, Clone, Copy)]
pub struct Pair(Lanes);

#[cfg(target_arch = "x86_64")]
type Lanes = __m128d;
#[cfg(not(target_arch = "x86_64"))]
type Lanes = [f64; 2];

#[cfg(target_arch = "x86_64")]
impl From<[f64; 2]> for Pair {
    #[inline(always)]
    fn from([a, b]: [f64; 2]) -> Self {
        // SAFETY: every x86-64 processor has SSE2.
        Self(unsafe { _mm_set_pd(b, a) })
    }
}

#[cfg(target_arch = "x86_64")]
impl From<Pair> for [f64; 2] {
    #[inline(always)]
    fn from(Pair(x): Pair) -> Self {
        // SAFETY: as above.
        unsafe { [_mm_cvtsd_f64(x), _mm_cvtsd_f64(_mm_unpackhi_pd(x, x))] }
    }
}

#[cfg(not(target_arch = "x86_64"))]
impl From<[f64; 2]> for Pair {
    #[inline(always)]
    fn from(lanes: [f64; 2]) -> Self {
        Self(lanes)
    }
}

#[cfg(not(target_arch = "x86_64"))]
impl From<Pair> for [f64; 2] {
    #[inline(always)]
    fn from(Pair(lanes): Pair) -> Self {
        lanes
    }
}

macro_rules! operator {
    ($operator:ident, $method:ident, $instruction:ident) => {
        impl $operator for Pair {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                return Self(unsafe { $instruction(self.0, other.0) });
                #[cfg(not(target_arch = "x86_64"))]
                return Self([self.0[0].$method(other.0[0]), self.0[1].$method(other.0[1])]);
            }
        }
    };
}

operator!(Add, add, _mm_add_pd);
operator!(Sub, sub, _mm_sub_pd);
operator!(Mul, mul, _mm_mul_pd);
