//! Four numbers that are worked on together: a state, or a column of its map.
//!
//! Products and sums are fused where the machine has FMA and not elsewhere, always in the same order:
//! two machines may differ in the last bit, two runs or two splits on one machine never do.
#![allow(unsafe_code)]

/// Four lanes.
pub(super) trait Quad: Copy {
    fn load(from: &[f64; 4]) -> Self;
    fn array(self) -> [f64; 4];
    /// The same value in every lane.
    fn splat(value: f64) -> Self;
    /// Lane `I` in every lane.
    fn spread<const I: i32>(self) -> Self;
    fn add(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    /// self · factor + sum.
    fn times_plus(self, factor: Self, sum: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    /// Each lane that is above zero, zero in place of the others and of NaN.
    fn positive(self) -> Self;
    /// Whether every lane lies in low…high; false for NaN.
    fn within(self, low: f64, high: f64) -> bool;
    /// Lane 0.
    fn first(self) -> f64;
}

/// Plain numbers.
#[derive(Clone, Copy)]
pub(super) struct Plain([f64; 4]);

impl Quad for Plain {
    #[inline(always)]
    fn load(from: &[f64; 4]) -> Self {
        Self(*from)
    }
    #[inline(always)]
    fn array(self) -> [f64; 4] {
        self.0
    }
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self([value; 4])
    }
    #[inline(always)]
    fn spread<const I: i32>(self) -> Self {
        Self([self.0[I as usize & 3]; 4])
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Self([a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]])
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Self([a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]])
    }
    #[inline(always)]
    fn times_plus(self, factor: Self, sum: Self) -> Self {
        self.mul(factor).add(sum)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Self([a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]])
    }
    #[inline(always)]
    fn positive(self) -> Self {
        Self(self.0.map(|x| if x > 0.0 { x } else { 0.0 }))
    }
    #[inline(always)]
    fn within(self, low: f64, high: f64) -> bool {
        self.0.iter().fold(true, |all, &x| all & (x >= low) & (x <= high))
    }
    #[inline(always)]
    fn first(self) -> f64 {
        self.0[0]
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use x86::Halves;
#[cfg(all(target_arch = "x86_64", feature = "std"))]
pub(super) use x86::Whole;

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::Quad;
    use core::arch::x86_64::{
        __m128d, __m256d, _CMP_GE_OQ, _CMP_LE_OQ, _mm_add_pd, _mm_and_pd, _mm_cmpge_pd, _mm_cmple_pd,
        _mm_cvtsd_f64, _mm_fmadd_pd, _mm_loadu_pd, _mm_max_pd, _mm_movemask_pd, _mm_mul_pd, _mm_set1_pd,
        _mm_setzero_pd, _mm_storeu_pd, _mm_sub_pd, _mm_unpackhi_pd, _mm_unpacklo_pd, _mm256_add_pd,
        _mm256_and_pd, _mm256_cmp_pd, _mm256_cvtsd_f64, _mm256_fmadd_pd, _mm256_loadu_pd, _mm256_max_pd,
        _mm256_movemask_pd, _mm256_mul_pd, _mm256_permute4x64_pd, _mm256_set1_pd, _mm256_setzero_pd,
        _mm256_storeu_pd, _mm256_sub_pd,
    };

    /// Two pairs: every x86-64 has them, and spreading a lane of a pair takes one cycle. `FUSED` only
    /// for code that runs after FMA was detected.
    #[derive(Clone, Copy)]
    pub(in super::super) struct Halves<const FUSED: bool>(__m128d, __m128d);

    impl<const FUSED: bool> Quad for Halves<FUSED> {
        #[inline(always)]
        fn load(from: &[f64; 4]) -> Self {
            // SAFETY: SSE2 is part of x86-64; both loads stay inside the array.
            unsafe { Self(_mm_loadu_pd(from.as_ptr()), _mm_loadu_pd(from.as_ptr().add(2))) }
        }
        #[inline(always)]
        fn array(self) -> [f64; 4] {
            let mut to = [0.0; 4];
            // SAFETY: SSE2 is part of x86-64; both stores stay inside the array.
            unsafe {
                _mm_storeu_pd(to.as_mut_ptr(), self.0);
                _mm_storeu_pd(to.as_mut_ptr().add(2), self.1);
            }
            to
        }
        #[inline(always)]
        fn splat(value: f64) -> Self {
            // SAFETY: SSE2 is part of x86-64.
            unsafe { Self(_mm_set1_pd(value), _mm_set1_pd(value)) }
        }
        #[inline(always)]
        fn spread<const I: i32>(self) -> Self {
            let half = if I < 2 { self.0 } else { self.1 };
            // SAFETY: SSE2 is part of x86-64.
            let both =
                unsafe { if I & 1 == 0 { _mm_unpacklo_pd(half, half) } else { _mm_unpackhi_pd(half, half) } };
            Self(both, both)
        }
        #[inline(always)]
        fn add(self, other: Self) -> Self {
            // SAFETY: SSE2 is part of x86-64.
            unsafe { Self(_mm_add_pd(self.0, other.0), _mm_add_pd(self.1, other.1)) }
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: SSE2 is part of x86-64.
            unsafe { Self(_mm_mul_pd(self.0, other.0), _mm_mul_pd(self.1, other.1)) }
        }
        #[inline(always)]
        fn times_plus(self, factor: Self, sum: Self) -> Self {
            if FUSED {
                // SAFETY: the fused type is used behind FMA detection only.
                unsafe { Self(_mm_fmadd_pd(self.0, factor.0, sum.0), _mm_fmadd_pd(self.1, factor.1, sum.1)) }
            } else {
                self.mul(factor).add(sum)
            }
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: SSE2 is part of x86-64.
            unsafe { Self(_mm_sub_pd(self.0, other.0), _mm_sub_pd(self.1, other.1)) }
        }
        #[inline(always)]
        fn positive(self) -> Self {
            // SAFETY: SSE2 is part of x86-64. Of a NaN and zero the instruction takes the second.
            unsafe { Self(_mm_max_pd(self.0, _mm_setzero_pd()), _mm_max_pd(self.1, _mm_setzero_pd())) }
        }
        #[inline(always)]
        fn within(self, low: f64, high: f64) -> bool {
            // SAFETY: SSE2 is part of x86-64.
            unsafe {
                let (low, high) = (_mm_set1_pd(low), _mm_set1_pd(high));
                let inside = |x| _mm_and_pd(_mm_cmpge_pd(x, low), _mm_cmple_pd(x, high));
                _mm_movemask_pd(_mm_and_pd(inside(self.0), inside(self.1))) == 0b11
            }
        }
        #[inline(always)]
        fn first(self) -> f64 {
            // SAFETY: SSE2 is part of x86-64.
            unsafe { _mm_cvtsd_f64(self.0) }
        }
    }

    /// One AVX register. Only for code that runs after AVX2 and FMA were detected.
    #[cfg_attr(not(feature = "std"), expect(dead_code))]
    #[derive(Clone, Copy)]
    pub(in super::super) struct Whole(__m256d);

    impl Quad for Whole {
        #[inline(always)]
        fn load(from: &[f64; 4]) -> Self {
            // SAFETY: the type is used behind AVX2 detection only; the load stays inside the array.
            unsafe { Self(_mm256_loadu_pd(from.as_ptr())) }
        }
        #[inline(always)]
        fn array(self) -> [f64; 4] {
            let mut to = [0.0; 4];
            // SAFETY: behind AVX2 detection; the store stays inside the array.
            unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) };
            to
        }
        #[inline(always)]
        fn splat(value: f64) -> Self {
            // SAFETY: behind AVX2 detection.
            unsafe { Self(_mm256_set1_pd(value)) }
        }
        #[inline(always)]
        fn spread<const I: i32>(self) -> Self {
            // SAFETY: behind AVX2 detection.
            unsafe {
                Self(match I {
                    0 => _mm256_permute4x64_pd::<0b00_00_00_00>(self.0),
                    1 => _mm256_permute4x64_pd::<0b01_01_01_01>(self.0),
                    2 => _mm256_permute4x64_pd::<0b10_10_10_10>(self.0),
                    _ => _mm256_permute4x64_pd::<0b11_11_11_11>(self.0),
                })
            }
        }
        #[inline(always)]
        fn add(self, other: Self) -> Self {
            // SAFETY: behind AVX2 detection.
            unsafe { Self(_mm256_add_pd(self.0, other.0)) }
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: behind AVX2 detection.
            unsafe { Self(_mm256_mul_pd(self.0, other.0)) }
        }
        #[inline(always)]
        fn times_plus(self, factor: Self, sum: Self) -> Self {
            // SAFETY: behind AVX2 and FMA detection.
            unsafe { Self(_mm256_fmadd_pd(self.0, factor.0, sum.0)) }
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: behind AVX2 detection.
            unsafe { Self(_mm256_sub_pd(self.0, other.0)) }
        }
        #[inline(always)]
        fn positive(self) -> Self {
            // SAFETY: behind AVX2 detection. Of a NaN and zero the instruction takes the second.
            unsafe { Self(_mm256_max_pd(self.0, _mm256_setzero_pd())) }
        }
        #[inline(always)]
        fn within(self, low: f64, high: f64) -> bool {
            // SAFETY: behind AVX2 detection.
            unsafe {
                let above = _mm256_cmp_pd::<_CMP_GE_OQ>(self.0, _mm256_set1_pd(low));
                let below = _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, _mm256_set1_pd(high));
                _mm256_movemask_pd(_mm256_and_pd(above, below)) == 0b1111
            }
        }
        #[inline(always)]
        fn first(self) -> f64 {
            // SAFETY: behind AVX2 detection.
            unsafe { _mm256_cvtsd_f64(self.0) }
        }
    }
}
