//! AVX2 on eight numbers, AVX-512 on sixteen.
#![allow(unsafe_code)]

use super::Vector;
use core::arch::x86_64::*;

/// 256-bit vectors.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(());

/// 512-bit vectors.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(());

impl Avx2 {
    /// # Safety
    /// The processor has AVX2.
    #[inline(always)]
    pub(crate) unsafe fn new() -> Self {
        Self(())
    }
}

impl Avx512 {
    /// # Safety
    /// The processor has AVX-512 F, DQ, BW and VL.
    #[inline(always)]
    pub(crate) unsafe fn new() -> Self {
        Self(())
    }
}

/// Methods that are one instruction on one register, or on the two registers of N `f64`.
macro_rules! instructions {
    ($($name:ident($($a:ident: $in:ty),*) -> $out:ty = $instruction:ident;)*) => {
        $(#[inline(always)]
        fn $name(self $(, $a: $in)*) -> $out {
            // SAFETY: `self` exists only where the processor has the instruction set.
            unsafe { $instruction($($a),*) }
        })*
    };
}
macro_rules! doubles {
    ($($name:ident = $instruction:ident;)*) => {
        $(#[inline(always)]
        fn $name(self, a: Self::Double, b: Self::Double) -> Self::Double {
            // SAFETY: `self` exists only where the processor has the instruction set.
            unsafe { [$instruction(a[0], b[0]), $instruction(a[1], b[1])] }
        })*
    };
}

/// [min u, min v, −max u, −max v] from four of each.
///
/// # Safety
/// The processor has AVX.
#[inline(always)]
unsafe fn bounds(min: [__m256d; 2], max: [__m256d; 2]) -> [f64; 4] {
    // SAFETY: AVX by the caller; the array has the size of the vector.
    unsafe {
        let sign = _mm256_set1_pd(-0.0);
        let max = [_mm256_xor_pd(max[0], sign), _mm256_xor_pd(max[1], sign)];
        let a = _mm256_min_pd(_mm256_unpacklo_pd(min[0], min[1]), _mm256_unpackhi_pd(min[0], min[1]));
        let b = _mm256_min_pd(_mm256_unpacklo_pd(max[0], max[1]), _mm256_unpackhi_pd(max[0], max[1]));
        let all = _mm256_min_pd(_mm256_permute2f128_pd(a, b, 0x20), _mm256_permute2f128_pd(a, b, 0x31));
        core::mem::transmute(all)
    }
}

/// # Safety
/// The processor has AVX2.
#[inline(always)]
unsafe fn all_reach(a: &[f64; 4], b: &[f64; 4]) -> bool {
    // SAFETY: AVX by the caller; both reads are inside the arrays.
    unsafe {
        let short = _mm256_cmp_pd(_mm256_loadu_pd(a.as_ptr()), _mm256_loadu_pd(b.as_ptr()), _CMP_NGE_UQ);
        _mm256_testz_pd(short, short) == 1
    }
}

/// # Safety
/// The processor has AVX.
#[inline(always)]
unsafe fn extremes(min: __m128, max: __m128) -> (f32, f32) {
    // SAFETY: AVX by the caller.
    unsafe {
        let (min, max) = (_mm_min_ps(min, _mm_movehl_ps(min, min)), _mm_max_ps(max, _mm_movehl_ps(max, max)));
        let (low, high) = (_mm_movehdup_ps(min), _mm_movehdup_ps(max));
        (_mm_cvtss_f32(_mm_min_ss(min, low)), _mm_cvtss_f32(_mm_max_ss(max, high)))
    }
}

impl Vector<8> for Avx2 {
    type Single = __m256;
    type Word = __m256i;
    /// Lanes 0, 1, 4, 5 and lanes 2, 3, 6, 7: halves of both interleave in one instruction.
    type Double = [__m256d; 2];

    instructions! {
        splat(x: f32) -> __m256 = _mm256_set1_ps;
        add(a: __m256, b: __m256) -> __m256 = _mm256_add_ps;
        sub(a: __m256, b: __m256) -> __m256 = _mm256_sub_ps;
        mul(a: __m256, b: __m256) -> __m256 = _mm256_mul_ps;
        div(a: __m256, b: __m256) -> __m256 = _mm256_div_ps;
        min(a: __m256, b: __m256) -> __m256 = _mm256_min_ps;
        max(a: __m256, b: __m256) -> __m256 = _mm256_max_ps;
        add_word(a: __m256i, b: __m256i) -> __m256i = _mm256_add_epi32;
        mul_word(a: __m256i, b: __m256i) -> __m256i = _mm256_mullo_epi32;
        and(a: __m256i, b: __m256i) -> __m256i = _mm256_and_si256;
        or(a: __m256i, b: __m256i) -> __m256i = _mm256_or_si256;
        xor(a: __m256i, b: __m256i) -> __m256i = _mm256_xor_si256;
        signed_to_single(x: __m256i) -> __m256 = _mm256_cvtepi32_ps;
        all_reach(a: &[f64; 4], b: &[f64; 4]) -> bool = all_reach;
    }
    doubles! {
        add_double = _mm256_add_pd;
        sub_double = _mm256_sub_pd;
        mul_double = _mm256_mul_pd;
        min_double = _mm256_min_pd;
        max_double = _mm256_max_pd;
    }

    #[inline(always)]
    fn equal(self, a: __m256, b: __m256) -> bool {
        // SAFETY: `self` exists only where the processor has AVX2.
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_NEQ_UQ)) == 0 }
    }
    #[inline(always)]
    fn splat_last(self, x: __m256i) -> __m256i {
        // SAFETY: as above.
        unsafe { _mm256_permutevar8x32_epi32(x, _mm256_set1_epi32(7)) }
    }
    #[inline(always)]
    fn last(self, x: __m256i) -> u32 {
        // SAFETY: as above.
        unsafe { _mm256_extract_epi32(x, 7) as u32 }
    }
    #[inline(always)]
    fn extremes(self, x: __m256) -> (f32, f32) {
        // SAFETY: `self` exists only where the processor has AVX2.
        unsafe {
            let (low, high) = (_mm256_castps256_ps128(x), _mm256_extractf128_ps(x, 1));
            extremes(_mm_min_ps(low, high), _mm_max_ps(low, high))
        }
    }
    #[inline(always)]
    fn flip(self, x: __m256, bits: __m256i) -> __m256 {
        // SAFETY: as above.
        unsafe { _mm256_xor_ps(x, _mm256_castsi256_ps(bits)) }
    }
    #[inline(always)]
    fn splat_word(self, x: u32) -> __m256i {
        // SAFETY: as above.
        unsafe { _mm256_set1_epi32(x as i32) }
    }
    #[inline(always)]
    fn left(self, a: __m256i, bits: u32) -> __m256i {
        // SAFETY: as above.
        unsafe { _mm256_sllv_epi32(a, _mm256_set1_epi32(bits as i32)) }
    }
    #[inline(always)]
    fn right(self, a: __m256i, bits: u32) -> __m256i {
        // SAFETY: as above.
        unsafe { _mm256_srlv_epi32(a, _mm256_set1_epi32(bits as i32)) }
    }
    #[inline(always)]
    fn add_if_less(self, a: __m256i, b: __m256i, c: __m256i) -> __m256i {
        // SAFETY: as above.
        unsafe { _mm256_sub_epi32(a, _mm256_cmpgt_epi32(c, b)) }
    }
    #[inline(always)]
    fn splat_double(self, x: f64) -> [__m256d; 2] {
        // SAFETY: as above.
        [unsafe { _mm256_set1_pd(x) }; 2]
    }
    #[inline(always)]
    fn low_half(self, x: [__m256d; 2]) -> __m256i {
        // SAFETY: as above.
        unsafe {
            let (a, b) = (_mm256_castpd_ps(x[0]), _mm256_castpd_ps(x[1]));
            _mm256_castps_si256(_mm256_shuffle_ps(a, b, 0b10_00_10_00))
        }
    }
    #[inline(always)]
    fn high_half(self, x: [__m256d; 2]) -> __m256i {
        // SAFETY: as above.
        unsafe {
            let (a, b) = (_mm256_castpd_ps(x[0]), _mm256_castpd_ps(x[1]));
            _mm256_castps_si256(_mm256_shuffle_ps(a, b, 0b11_01_11_01))
        }
    }
    #[inline(always)]
    fn bounds(self, u: [__m256d; 2], v: [__m256d; 2]) -> [f64; 4] {
        // SAFETY: as above.
        unsafe {
            bounds(
                [_mm256_min_pd(u[0], u[1]), _mm256_min_pd(v[0], v[1])],
                [_mm256_max_pd(u[0], u[1]), _mm256_max_pd(v[0], v[1])],
            )
        }
    }
    #[inline(always)]
    fn load(self, from: &[f64; 8]) -> __m256 {
        let from = from.as_ptr();
        // SAFETY: as above; both reads are inside the array.
        unsafe {
            let (a, b) = (_mm256_loadu_pd(from), _mm256_loadu_pd(from.add(4)));
            _mm256_set_m128(_mm256_cvtpd_ps(b), _mm256_cvtpd_ps(a))
        }
    }
    #[inline(always)]
    fn load_points(self, from: &[[f64; 2]; 8]) -> [[__m256d; 2]; 2] {
        // SAFETY: as above; a point has the size of the vector.
        unsafe {
            let a = _mm256_set_m128d(_mm_loadu_pd(from[4].as_ptr()), _mm_loadu_pd(from[0].as_ptr()));
            let b = _mm256_set_m128d(_mm_loadu_pd(from[5].as_ptr()), _mm_loadu_pd(from[1].as_ptr()));
            let c = _mm256_set_m128d(_mm_loadu_pd(from[6].as_ptr()), _mm_loadu_pd(from[2].as_ptr()));
            let d = _mm256_set_m128d(_mm_loadu_pd(from[7].as_ptr()), _mm_loadu_pd(from[3].as_ptr()));
            [
                [_mm256_unpacklo_pd(a, b), _mm256_unpacklo_pd(c, d)],
                [_mm256_unpackhi_pd(a, b), _mm256_unpackhi_pd(c, d)],
            ]
        }
    }
    #[inline(always)]
    fn add_to(self, x: __m256, to: &mut [f64; 8]) {
        let to = to.as_mut_ptr();
        // SAFETY: as above; all reads and writes are inside the array.
        unsafe {
            let low = _mm256_cvtps_pd(_mm256_castps256_ps128(x));
            let high = _mm256_cvtps_pd(_mm256_extractf128_ps(x, 1));
            _mm256_storeu_pd(to, _mm256_add_pd(_mm256_loadu_pd(to), low));
            _mm256_storeu_pd(to.add(4), _mm256_add_pd(_mm256_loadu_pd(to.add(4)), high));
        }
    }
}

impl Vector<16> for Avx512 {
    type Single = __m512;
    type Word = __m512i;
    /// The lower and the upper eight lanes.
    type Double = [__m512d; 2];

    instructions! {
        splat(x: f32) -> __m512 = _mm512_set1_ps;
        add(a: __m512, b: __m512) -> __m512 = _mm512_add_ps;
        sub(a: __m512, b: __m512) -> __m512 = _mm512_sub_ps;
        mul(a: __m512, b: __m512) -> __m512 = _mm512_mul_ps;
        div(a: __m512, b: __m512) -> __m512 = _mm512_div_ps;
        min(a: __m512, b: __m512) -> __m512 = _mm512_min_ps;
        max(a: __m512, b: __m512) -> __m512 = _mm512_max_ps;
        add_word(a: __m512i, b: __m512i) -> __m512i = _mm512_add_epi32;
        mul_word(a: __m512i, b: __m512i) -> __m512i = _mm512_mullo_epi32;
        and(a: __m512i, b: __m512i) -> __m512i = _mm512_and_si512;
        or(a: __m512i, b: __m512i) -> __m512i = _mm512_or_si512;
        xor(a: __m512i, b: __m512i) -> __m512i = _mm512_xor_si512;
        signed_to_single(x: __m512i) -> __m512 = _mm512_cvtepi32_ps;
        all_reach(a: &[f64; 4], b: &[f64; 4]) -> bool = all_reach;
    }
    doubles! {
        add_double = _mm512_add_pd;
        sub_double = _mm512_sub_pd;
        mul_double = _mm512_mul_pd;
        min_double = _mm512_min_pd;
        max_double = _mm512_max_pd;
    }

    #[inline(always)]
    fn equal(self, a: __m512, b: __m512) -> bool {
        // SAFETY: `self` exists only where the processor has AVX-512 F, DQ, BW and VL.
        unsafe { _mm512_cmp_ps_mask(a, b, _CMP_NEQ_UQ) == 0 }
    }
    #[inline(always)]
    fn splat_last(self, x: __m512i) -> __m512i {
        // SAFETY: as above.
        unsafe { _mm512_permutexvar_epi32(_mm512_set1_epi32(15), x) }
    }
    #[inline(always)]
    fn last(self, x: __m512i) -> u32 {
        // SAFETY: as above.
        unsafe { _mm_extract_epi32(_mm512_extracti32x4_epi32(x, 3), 3) as u32 }
    }
    #[inline(always)]
    fn extremes(self, x: __m512) -> (f32, f32) {
        // SAFETY: `self` exists only where the processor has AVX-512 F, DQ, BW and VL.
        unsafe {
            let (low, high) = (_mm512_castps512_ps256(x), _mm512_extractf32x8_ps(x, 1));
            let (min, max) = (_mm256_min_ps(low, high), _mm256_max_ps(low, high));
            extremes(
                _mm_min_ps(_mm256_castps256_ps128(min), _mm256_extractf128_ps(min, 1)),
                _mm_max_ps(_mm256_castps256_ps128(max), _mm256_extractf128_ps(max, 1)),
            )
        }
    }
    #[inline(always)]
    fn flip(self, x: __m512, bits: __m512i) -> __m512 {
        // SAFETY: as above.
        unsafe { _mm512_xor_ps(x, _mm512_castsi512_ps(bits)) }
    }
    #[inline(always)]
    fn splat_word(self, x: u32) -> __m512i {
        // SAFETY: as above.
        unsafe { _mm512_set1_epi32(x as i32) }
    }
    #[inline(always)]
    fn left(self, a: __m512i, bits: u32) -> __m512i {
        // SAFETY: as above.
        unsafe { _mm512_sllv_epi32(a, _mm512_set1_epi32(bits as i32)) }
    }
    #[inline(always)]
    fn right(self, a: __m512i, bits: u32) -> __m512i {
        // SAFETY: as above.
        unsafe { _mm512_srlv_epi32(a, _mm512_set1_epi32(bits as i32)) }
    }
    #[inline(always)]
    fn add_if_less(self, a: __m512i, b: __m512i, c: __m512i) -> __m512i {
        // SAFETY: as above.
        unsafe { _mm512_mask_add_epi32(a, _mm512_cmplt_epi32_mask(b, c), a, _mm512_set1_epi32(1)) }
    }
    #[inline(always)]
    fn splat_double(self, x: f64) -> [__m512d; 2] {
        // SAFETY: as above.
        [unsafe { _mm512_set1_pd(x) }; 2]
    }
    #[inline(always)]
    fn low_half(self, x: [__m512d; 2]) -> __m512i {
        // SAFETY: as above.
        unsafe {
            let even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
            _mm512_permutex2var_epi32(_mm512_castpd_si512(x[0]), even, _mm512_castpd_si512(x[1]))
        }
    }
    #[inline(always)]
    fn high_half(self, x: [__m512d; 2]) -> __m512i {
        // SAFETY: as above.
        unsafe {
            let odd = _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
            _mm512_permutex2var_epi32(_mm512_castpd_si512(x[0]), odd, _mm512_castpd_si512(x[1]))
        }
    }
    #[inline(always)]
    fn bounds(self, u: [__m512d; 2], v: [__m512d; 2]) -> [f64; 4] {
        // SAFETY: as above.
        unsafe {
            let (min_u, min_v) = (_mm512_min_pd(u[0], u[1]), _mm512_min_pd(v[0], v[1]));
            let (max_u, max_v) = (_mm512_max_pd(u[0], u[1]), _mm512_max_pd(v[0], v[1]));
            let min = [
                _mm256_min_pd(_mm512_castpd512_pd256(min_u), _mm512_extractf64x4_pd(min_u, 1)),
                _mm256_min_pd(_mm512_castpd512_pd256(min_v), _mm512_extractf64x4_pd(min_v, 1)),
            ];
            let max = [
                _mm256_max_pd(_mm512_castpd512_pd256(max_u), _mm512_extractf64x4_pd(max_u, 1)),
                _mm256_max_pd(_mm512_castpd512_pd256(max_v), _mm512_extractf64x4_pd(max_v, 1)),
            ];
            bounds(min, max)
        }
    }
    #[inline(always)]
    fn load(self, from: &[f64; 16]) -> __m512 {
        let from = from.as_ptr();
        // SAFETY: as above; both reads are inside the array.
        unsafe {
            let (a, b) = (_mm512_loadu_pd(from), _mm512_loadu_pd(from.add(8)));
            _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(a)), _mm512_cvtpd_ps(b), 1)
        }
    }
    #[inline(always)]
    fn load_points(self, from: &[[f64; 2]; 16]) -> [[__m512d; 2]; 2] {
        let from = from.as_ptr().cast::<f64>();
        // SAFETY: as above; all reads are inside the array.
        unsafe {
            let (a, b) = (_mm512_loadu_pd(from), _mm512_loadu_pd(from.add(8)));
            let (c, d) = (_mm512_loadu_pd(from.add(16)), _mm512_loadu_pd(from.add(24)));
            let (x, y) =
                (_mm512_setr_epi64(0, 2, 4, 6, 8, 10, 12, 14), _mm512_setr_epi64(1, 3, 5, 7, 9, 11, 13, 15));
            [
                [_mm512_permutex2var_pd(a, x, b), _mm512_permutex2var_pd(c, x, d)],
                [_mm512_permutex2var_pd(a, y, b), _mm512_permutex2var_pd(c, y, d)],
            ]
        }
    }
    #[inline(always)]
    fn add_to(self, x: __m512, to: &mut [f64; 16]) {
        let to = to.as_mut_ptr();
        // SAFETY: as above; all reads and writes are inside the array.
        unsafe {
            let low = _mm512_cvtps_pd(_mm512_castps512_ps256(x));
            let high = _mm512_cvtps_pd(_mm512_extractf32x8_ps(x, 1));
            _mm512_storeu_pd(to, _mm512_add_pd(_mm512_loadu_pd(to), low));
            _mm512_storeu_pd(to.add(8), _mm512_add_pd(_mm512_loadu_pd(to.add(8)), high));
        }
    }
}
