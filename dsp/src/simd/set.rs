//! Set of instructions beyond the vectors of `fearless_simd`: how it rounds, and the few operations
//! that crate has no name for.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f64x4, u32x8};

/// A set the kernels are compiled for.
pub trait Set: Simd {
    /// True where a · b + c is one operation with one rounding.
    const FUSED: bool;

    /// Within each four lanes: the sums of neighbours of `a`, then those of `b`.
    #[inline(always)]
    fn add_neighbours(self, a: f32x8<Self>, b: f32x8<Self>) -> f32x8<Self> {
        let ((a0, a1), (b0, b1)) = (a.split(), b.split());
        let low = a0.unzip_low(b0) + a0.unzip_high(b0);
        low.combine(a1.unzip_low(b1) + a1.unzip_high(b1))
    }

    /// The halves of a vector change places.
    #[inline(always)]
    fn swap_halves(self, x: Self::f32s) -> Self::f32s {
        let half = Self::f32s::LEN / 2;
        Self::f32s::from_fn(self, |i| x[(i + half) % (2 * half)])
    }

    /// Rows become columns.
    #[inline(always)]
    fn transpose(self, [a, b, c, d]: [f64x4<Self>; 4]) -> [f64x4<Self>; 4] {
        let ((a0, a1), (b0, b1)) = (a.split(), b.split());
        let ((c0, c1), (d0, d1)) = (c.split(), d.split());
        [
            a0.zip_low(b0).combine(c0.zip_low(d0)),
            a0.zip_high(b0).combine(c0.zip_high(d0)),
            a1.zip_low(b1).combine(c1.zip_low(d1)),
            a1.zip_high(b1).combine(c1.zip_high(d1)),
        ]
    }

    /// Both coordinates of eight points, four a vector, in the order that [`Self::low_words`] and
    /// [`Self::high_words`] expect.
    #[inline(always)]
    fn points(self, from: &[[f64; 2]; 8]) -> [[f64x4<Self>; 2]; 2] {
        let part = |i: usize| f64x4::from_slice(self, &from.as_flattened()[4 * i..4 * i + 4]);
        let ((x0, y0), (x1, y1)) = (part(0).deinterleave(part(1)), part(2).deinterleave(part(3)));
        [[x0, x1], [y0, y1]]
    }

    /// The lower 32 bits of each number that [`Self::points`] has loaded, in the order of the
    /// points.
    #[inline(always)]
    fn low_words(self, [a, b]: [f64x4<Self>; 2]) -> u32x8<Self> {
        a.bitcast::<u32x8<Self>>().unzip_low(b.bitcast::<u32x8<Self>>())
    }

    /// The upper ones.
    #[inline(always)]
    fn high_words(self, [a, b]: [f64x4<Self>; 2]) -> u32x8<Self> {
        a.bitcast::<u32x8<Self>>().unzip_high(b.bitcast::<u32x8<Self>>())
    }

    /// Says that the number at `at` will soon be read; nothing else happens.
    #[inline(always)]
    fn prefetch(self, _at: &f32) {}
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::Set;
    use core::arch::x86_64::*;
    use fearless_simd::prelude::*;
    use fearless_simd::{Avx2, Avx512, Sse2, f32x8, f32x16, f64x2, f64x4, u32x8};

    #[inline(always)]
    #[allow(unsafe_code)]
    fn prefetch(at: &f32) {
        // SAFETY: every x86-64 processor has it, and it reads nothing.
        unsafe { _mm_prefetch(core::ptr::from_ref(at).cast(), _MM_HINT_T0) }
    }

    impl Set for Sse2 {
        const FUSED: bool = false;
        #[inline(always)]
        fn prefetch(self, at: &f32) {
            prefetch(at);
        }
    }

    /// 256-bit registers, whose halves horizontal sums and interleaving keep apart.
    macro_rules! set {
        ($set:ident $(, $wide:item)?) => {
            impl Set for $set {
                const FUSED: bool = true;
                $(#[inline(always)]
                $wide)?
                #[inline(always)]
                fn add_neighbours(self, a: f32x8<Self>, b: f32x8<Self>) -> f32x8<Self> {
                    fearless_simd::kernel!(
                        #[inline(always)]
                        fn add(token: $set, a: f32x8<$set>, b: f32x8<$set>) -> f32x8<$set> {
                            _mm256_hadd_ps(a.into(), b.into()).simd_into(token)
                        }
                    );
                    add(self, a, b)
                }
                #[inline(always)]
                fn transpose(self, rows: [f64x4<Self>; 4]) -> [f64x4<Self>; 4] {
                    fearless_simd::kernel!(
                        #[inline(always)]
                        fn turn(token: $set, rows: [f64x4<$set>; 4]) -> [f64x4<$set>; 4] {
                            let [a, b, c, d] = rows.map(|row| -> __m256d { row.into() });
                            let (ab, ab_odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
                            let (cd, cd_odd) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
                            [
                                _mm256_permute2f128_pd(ab, cd, 0x20).simd_into(token),
                                _mm256_permute2f128_pd(ab_odd, cd_odd, 0x20).simd_into(token),
                                _mm256_permute2f128_pd(ab, cd, 0x31).simd_into(token),
                                _mm256_permute2f128_pd(ab_odd, cd_odd, 0x31).simd_into(token),
                            ]
                        }
                    );
                    turn(self, rows)
                }
                /// The lower half of each register holds points of the first four, the upper half
                /// of the others: nothing crosses over.
                #[inline(always)]
                fn points(self, from: &[[f64; 2]; 8]) -> [[f64x4<Self>; 2]; 2] {
                    fearless_simd::kernel!(
                        #[inline(always)]
                        fn part(token: $set, a: f64x4<$set>, b: f64x4<$set>) -> [f64x4<$set>; 2] {
                            let (a, b): (__m256d, __m256d) = (a.into(), b.into());
                            [_mm256_unpacklo_pd(a, b).simd_into(token), _mm256_unpackhi_pd(a, b).simd_into(token)]
                        }
                    );
                    let [p, q, r, s, t, u, v, w] = from;
                    let two = |low: &[f64; 2], high: &[f64; 2]| {
                        f64x2::load_array_ref(self, low).combine(f64x2::load_array_ref(self, high))
                    };
                    let [x0, y0] = part(self, two(p, t), two(q, u));
                    let [x1, y1] = part(self, two(r, v), two(s, w));
                    [[x0, x1], [y0, y1]]
                }
                #[inline(always)]
                fn low_words(self, [a, b]: [f64x4<Self>; 2]) -> u32x8<Self> {
                    fearless_simd::kernel!(
                        #[inline(always)]
                        fn low(token: $set, a: f64x4<$set>, b: f64x4<$set>) -> u32x8<$set> {
                            let (a, b) = (_mm256_castpd_ps(a.into()), _mm256_castpd_ps(b.into()));
                            _mm256_castps_si256(_mm256_shuffle_ps::<0b10_00_10_00>(a, b)).simd_into(token)
                        }
                    );
                    low(self, a, b)
                }
                #[inline(always)]
                fn high_words(self, [a, b]: [f64x4<Self>; 2]) -> u32x8<Self> {
                    fearless_simd::kernel!(
                        #[inline(always)]
                        fn high(token: $set, a: f64x4<$set>, b: f64x4<$set>) -> u32x8<$set> {
                            let (a, b) = (_mm256_castpd_ps(a.into()), _mm256_castpd_ps(b.into()));
                            _mm256_castps_si256(_mm256_shuffle_ps::<0b11_01_11_01>(a, b)).simd_into(token)
                        }
                    );
                    high(self, a, b)
                }
                #[inline(always)]
                fn prefetch(self, at: &f32) {
                    prefetch(at);
                }
            }
        };
    }
    set!(Avx2);
    set!(
        Avx512,
        fn swap_halves(self, x: f32x16<Self>) -> f32x16<Self> {
            fearless_simd::kernel!(
                #[inline(always)]
                fn swap(token: Avx512, x: f32x16<Avx512>) -> f32x16<Avx512> {
                    let x: __m512 = x.into();
                    _mm512_shuffle_f32x4::<0b01_00_11_10>(x, x).simd_into(token)
                }
            );
            swap(self, x)
        }
    );
}

#[cfg(target_arch = "aarch64")]
impl Set for fearless_simd::Neon {
    const FUSED: bool = true;
}

#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
impl Set for fearless_simd::WasmSimd128 {
    const FUSED: bool = false;
}

#[cfg(not(any(target_arch = "x86_64", all(target_arch = "wasm32", target_feature = "simd128"))))]
impl Set for fearless_simd::Fallback {
    const FUSED: bool = false;
}
