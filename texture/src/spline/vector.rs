//! Numbers side by side: what the polynomial of a cell needs, for each instruction set.
//!
//! A value of [`Portable`], `Avx2` or `Avx512` stands for the right to use that instruction set, so that a kernel
//! written over [`Vector`] is safe code. Each operation is one IEEE operation a lane, never fused, so that every
//! set gives the same bits. All inline into a function that enables the set.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

/// An instruction set that works on N `f64` at once.
pub(super) trait Vector<const N: usize>: Copy {
    /// N `f64`.
    type Lanes: Copy;
    fn splat(self, x: f64) -> Self::Lanes;
    fn load(self, from: &[f64; N]) -> Self::Lanes;
    fn store(self, x: Self::Lanes, to: &mut [f64; N]);
    fn add(self, a: Self::Lanes, b: Self::Lanes) -> Self::Lanes;
    fn sub(self, a: Self::Lanes, b: Self::Lanes) -> Self::Lanes;
    fn mul(self, a: Self::Lanes, b: Self::Lanes) -> Self::Lanes;
    /// How many lanes from the first on are equal numbers.
    fn equal_lanes(self, a: Self::Lanes, b: Self::Lanes) -> usize;
}

/// Four rows of four, as a cell has them.
pub(super) trait Rows: Vector<4> {
    fn widen(self, from: &[f32; 4]) -> Self::Lanes;
    fn transpose(self, rows: [Self::Lanes; 4]) -> [Self::Lanes; 4];
    /// Says that the number at `at` will soon be read; nothing else happens.
    fn prefetch(self, at: &f32);
}

/// Whatever the compiler makes of arrays.
#[derive(Clone, Copy)]
pub(super) struct Portable;

impl<const N: usize> Vector<N> for Portable {
    type Lanes = [f64; N];
    #[inline(always)]
    fn splat(self, x: f64) -> [f64; N] {
        [x; N]
    }
    #[inline(always)]
    fn load(self, from: &[f64; N]) -> [f64; N] {
        *from
    }
    #[inline(always)]
    fn store(self, x: [f64; N], to: &mut [f64; N]) {
        *to = x;
    }
    #[inline(always)]
    fn add(self, a: [f64; N], b: [f64; N]) -> [f64; N] {
        std::array::from_fn(|i| a[i] + b[i])
    }
    #[inline(always)]
    fn sub(self, a: [f64; N], b: [f64; N]) -> [f64; N] {
        std::array::from_fn(|i| a[i] - b[i])
    }
    #[inline(always)]
    fn mul(self, a: [f64; N], b: [f64; N]) -> [f64; N] {
        std::array::from_fn(|i| a[i] * b[i])
    }
    #[inline(always)]
    fn equal_lanes(self, a: [f64; N], b: [f64; N]) -> usize {
        a.iter().zip(b).take_while(|(a, b)| **a == *b).count()
    }
}

impl Rows for Portable {
    #[inline(always)]
    fn widen(self, from: &[f32; 4]) -> [f64; 4] {
        from.map(f64::from)
    }
    #[inline(always)]
    fn transpose(self, rows: [[f64; 4]; 4]) -> [[f64; 4]; 4] {
        std::array::from_fn(|i| rows.map(|row| row[i]))
    }
    #[inline(always)]
    fn prefetch(self, _: &f32) {}
}

/// A bit for each lane.
///
/// # Safety
/// The processor has AVX.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn equal_in_256(a: __m256d, b: __m256d) -> u32 {
    // SAFETY: AVX by the caller.
    unsafe { _mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_EQ_OQ)) as u32 }
}

/// A bit for each lane.
///
/// # Safety
/// The processor has AVX-512F.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn equal_in_512(a: __m512d, b: __m512d) -> u32 {
    // SAFETY: AVX-512F by the caller.
    unsafe { u32::from(_mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ)) }
}

/// An instruction set of x86: its name, its lanes and the instructions of [`Vector`] in order.
#[cfg(target_arch = "x86_64")]
macro_rules! instruction_set {
    ($(#[$doc:meta])* $set:ident, $n:literal, $lanes:ty, $splat:ident, $load:ident, $store:ident, $add:ident, $sub:ident, $mul:ident, $equal:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub(super) struct $set(());

        impl $set {
            /// # Safety
            /// The processor has the instruction set.
            #[inline(always)]
            pub(super) unsafe fn new() -> Self {
                Self(())
            }
        }

        impl Vector<$n> for $set {
            type Lanes = $lanes;
            #[inline(always)]
            fn splat(self, x: f64) -> $lanes {
                // SAFETY: `self` exists only where the processor has the instruction set.
                unsafe { $splat(x) }
            }
            #[inline(always)]
            fn load(self, from: &[f64; $n]) -> $lanes {
                // SAFETY: as above; the array is as long as the vector.
                unsafe { $load(from.as_ptr()) }
            }
            #[inline(always)]
            fn store(self, x: $lanes, to: &mut [f64; $n]) {
                // SAFETY: as above.
                unsafe { $store(to.as_mut_ptr(), x) }
            }
            #[inline(always)]
            fn add(self, a: $lanes, b: $lanes) -> $lanes {
                // SAFETY: as above.
                unsafe { $add(a, b) }
            }
            #[inline(always)]
            fn sub(self, a: $lanes, b: $lanes) -> $lanes {
                // SAFETY: as above.
                unsafe { $sub(a, b) }
            }
            #[inline(always)]
            fn mul(self, a: $lanes, b: $lanes) -> $lanes {
                // SAFETY: as above.
                unsafe { $mul(a, b) }
            }
            #[inline(always)]
            fn equal_lanes(self, a: $lanes, b: $lanes) -> usize {
                // SAFETY: as above.
                unsafe { $equal(a, b) }.trailing_ones() as usize
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
instruction_set!(
    /// 256-bit vectors.
    Avx2, 4, __m256d, _mm256_set1_pd, _mm256_loadu_pd, _mm256_storeu_pd, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, equal_in_256
);
#[cfg(target_arch = "x86_64")]
instruction_set!(
    /// 512-bit vectors.
    Avx512, 8, __m512d, _mm512_set1_pd, _mm512_loadu_pd, _mm512_storeu_pd, _mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd, equal_in_512
);

#[cfg(target_arch = "x86_64")]
impl Rows for Avx2 {
    #[inline(always)]
    fn widen(self, from: &[f32; 4]) -> __m256d {
        // SAFETY: `self` exists only where the processor has AVX2; the array is as long as the vector.
        unsafe { _mm256_cvtps_pd(_mm_loadu_ps(from.as_ptr())) }
    }
    #[inline(always)]
    fn transpose(self, [a, b, c, d]: [__m256d; 4]) -> [__m256d; 4] {
        // SAFETY: as above.
        unsafe {
            let (ab, ab_odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
            let (cd, cd_odd) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
            [
                _mm256_permute2f128_pd(ab, cd, 0x20),
                _mm256_permute2f128_pd(ab_odd, cd_odd, 0x20),
                _mm256_permute2f128_pd(ab, cd, 0x31),
                _mm256_permute2f128_pd(ab_odd, cd_odd, 0x31),
            ]
        }
    }
    #[inline(always)]
    fn prefetch(self, at: &f32) {
        // SAFETY: every processor with AVX2 has it, and it reads nothing.
        unsafe { _mm_prefetch(std::ptr::from_ref(at).cast(), _MM_HINT_T0) }
    }
}
