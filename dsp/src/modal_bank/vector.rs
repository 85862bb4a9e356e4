//! The few vector operations the bank needs, for each instruction set.
//!
//! Every method is `unsafe` because it may only run on a processor that has the instructions of its
//! type; `Kernel` makes sure of that once, when it is detected. All methods inline into a function that
//! enables those instructions.
#![allow(unsafe_code)]

use super::LANES;
use super::design::{HOT, Lanes, TURN, place};
use super::sums::{self, TurnSums};

/// A few `f32` side by side.
pub(super) trait Vector: Copy {
    /// `f32` in one vector; divides [`LANES`].
    const LEN: usize;
    /// Whether coefficients are read once a chunk, into registers or the stack; otherwise every use reads the group, which
    /// is faster where it is one operand of the multiplication.
    const KEEPS_COEFFICIENTS: bool;
    /// How many groups go best at once.
    const GROUPS_AT_ONCE: usize;
    /// All lanes `x`.
    unsafe fn splat(x: f32) -> Self;
    /// Reads `LEN` values.
    unsafe fn load(from: *const f32) -> Self;
    /// Reads `LEN` values of an array whose halves have changed places; `from` is where they lie.
    #[inline(always)]
    unsafe fn load_swapped(from: *const f32) -> Self {
        // SAFETY: passed on from the caller. A vector no longer than a half lies in one piece.
        unsafe { Self::load(from) }
    }
    /// The lanes from `lane` on of coefficient `i`, wherever [`place`] has put them.
    #[inline(always)]
    unsafe fn load_placed(hot: &[Lanes; HOT], i: usize, lane: usize) -> Self {
        // SAFETY: passed on from the caller: there are LEN lanes from `lane` on.
        unsafe {
            match i % 2 {
                1 if Self::LEN == LANES => Self::load_swapped(hot[i].as_ptr()),
                _ => Self::load(hot[i].as_ptr().add(place(i, lane))),
            }
        }
    }
    /// Writes `LEN` values.
    unsafe fn store(self, to: *mut f32);
    /// self + other.
    unsafe fn add(self, other: Self) -> Self;
    /// self − other.
    unsafe fn sub(self, other: Self) -> Self;
    /// self · by + plus; one rounding where the processor has it.
    unsafe fn mul_add(self, by: Self, plus: Self) -> Self;
    /// The same for a large `self` and small `plus`. Where products are rounded apart, that of the part of `by` beyond
    /// 1 is, which is exact from 0.5 on.
    #[inline(always)]
    unsafe fn mul_add_near_one(self, by: Self, plus: Self) -> Self {
        // SAFETY: passed on from the caller.
        unsafe { self.mul_add(by, plus) }
    }
    /// As [`sums::samples`].
    #[inline(always)]
    unsafe fn samples(turn: &TurnSums) -> [f32; TURN] {
        sums::samples(turn)
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use x86::Sse as Baseline;

#[cfg(not(target_arch = "x86_64"))]
pub(super) use Plain as Baseline;

/// Four lanes in plain Rust.
#[cfg(not(target_arch = "x86_64"))]
#[derive(Clone, Copy)]
#[repr(C, align(16))]
pub(super) struct Plain([f32; 4]);

#[cfg(not(target_arch = "x86_64"))]
impl Vector for Plain {
    const LEN: usize = 4;
    const KEEPS_COEFFICIENTS: bool = true;
    const GROUPS_AT_ONCE: usize = 4;
    #[inline(always)]
    unsafe fn splat(x: f32) -> Self {
        Self([x; 4])
    }
    #[inline(always)]
    unsafe fn load(from: *const f32) -> Self {
        // SAFETY: the caller hands LEN readable values; unaligned reads are allowed.
        unsafe { from.cast::<[f32; 4]>().read_unaligned() }.into()
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f32) {
        // SAFETY: the caller hands LEN writable values; unaligned writes are allowed.
        unsafe { to.cast::<[f32; 4]>().write_unaligned(self.0) }
    }
    #[inline(always)]
    unsafe fn add(self, other: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] + other.0[i]))
    }
    #[inline(always)]
    unsafe fn sub(self, other: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] - other.0[i]))
    }
    #[inline(always)]
    unsafe fn mul_add(self, by: Self, plus: Self) -> Self {
        // Two roundings: a fused multiply-add would be a library call on the baseline.
        Self(core::array::from_fn(|i| self.0[i] * by.0[i] + plus.0[i]))
    }
    #[inline(always)]
    unsafe fn mul_add_near_one(self, by: Self, plus: Self) -> Self {
        let whole = |by: f32| if by >= 0.5 { 1.0 } else { 0.0 };
        Self(core::array::from_fn(|i| {
            let (x, whole) = (self.0[i], whole(by.0[i]));
            x * whole + (x * (by.0[i] - whole) + plus.0[i])
        }))
    }
}

#[cfg(not(target_arch = "x86_64"))]
impl From<[f32; 4]> for Plain {
    #[inline(always)]
    fn from(lanes: [f32; 4]) -> Self {
        Self(lanes)
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) mod x86 {
    //! AVX2 with FMA, and AVX-512.
    use super::super::sums::Row;
    use super::{TURN, TurnSums, Vector};
    use core::arch::x86_64::*;

    macro_rules! vector {
        ($name:ident, $raw:ty, $len:literal, $many:literal, $groups:literal, $set1:ident, $load:ident, $load_swapped:ident, $store:ident, $add:ident,
         $sub:ident, $fmadd:ident) => {
            impl Vector for $name {
                const LEN: usize = $len;
                const KEEPS_COEFFICIENTS: bool = $many;
                const GROUPS_AT_ONCE: usize = $groups;
                #[inline(always)]
                unsafe fn splat(x: f32) -> Self {
                    // SAFETY: the trait's contract: the processor has this instruction set.
                    Self(unsafe { $set1(x) })
                }
                #[inline(always)]
                unsafe fn load(from: *const f32) -> Self {
                    // SAFETY: as above, and the caller hands LEN readable values.
                    Self(unsafe { $load(from) })
                }
                #[inline(always)]
                unsafe fn load_swapped(from: *const f32) -> Self {
                    // SAFETY: as above.
                    Self(unsafe { $load_swapped(from) })
                }
                #[inline(always)]
                unsafe fn store(self, to: *mut f32) {
                    // SAFETY: as above, and the caller hands LEN writable values.
                    unsafe { $store(to, self.0) }
                }
                #[inline(always)]
                unsafe fn add(self, other: Self) -> Self {
                    // SAFETY: the trait's contract.
                    Self(unsafe { $add(self.0, other.0) })
                }
                #[inline(always)]
                unsafe fn sub(self, other: Self) -> Self {
                    // SAFETY: the trait's contract.
                    Self(unsafe { $sub(self.0, other.0) })
                }
                #[inline(always)]
                unsafe fn mul_add(self, by: Self, plus: Self) -> Self {
                    // SAFETY: the trait's contract.
                    Self(unsafe { $fmadd(self.0, by.0, plus.0) })
                }
                #[inline(always)]
                unsafe fn samples(turn: &TurnSums) -> [f32; TURN] {
                    // SAFETY: both sets include AVX.
                    unsafe { samples_avx(turn) }
                }
            }
        };
    }

    /// Four lanes of the baseline, SSE2: two roundings where the others have one.
    #[derive(Clone, Copy)]
    pub(in super::super) struct Sse(__m128);

    impl Vector for Sse {
        const LEN: usize = 4;
        const KEEPS_COEFFICIENTS: bool = true;
        const GROUPS_AT_ONCE: usize = 4;
        #[inline(always)]
        unsafe fn splat(x: f32) -> Self {
            // SAFETY: SSE is part of the base of this architecture.
            Self(unsafe { _mm_set1_ps(x) })
        }
        #[inline(always)]
        unsafe fn load(from: *const f32) -> Self {
            // SAFETY: as above, and the caller hands LEN readable values.
            Self(unsafe { _mm_loadu_ps(from) })
        }
        #[inline(always)]
        unsafe fn store(self, to: *mut f32) {
            // SAFETY: as above, and the caller hands LEN writable values.
            unsafe { _mm_storeu_ps(to, self.0) }
        }
        #[inline(always)]
        unsafe fn add(self, other: Self) -> Self {
            // SAFETY: SSE is part of the base of this architecture.
            Self(unsafe { _mm_add_ps(self.0, other.0) })
        }
        #[inline(always)]
        unsafe fn sub(self, other: Self) -> Self {
            // SAFETY: SSE is part of the base of this architecture.
            Self(unsafe { _mm_sub_ps(self.0, other.0) })
        }
        #[inline(always)]
        unsafe fn mul_add(self, by: Self, plus: Self) -> Self {
            // SAFETY: SSE is part of the base of this architecture.
            Self(unsafe { _mm_add_ps(_mm_mul_ps(self.0, by.0), plus.0) })
        }
        #[inline(always)]
        unsafe fn mul_add_near_one(self, by: Self, plus: Self) -> Self {
            // SAFETY: SSE is part of the base of this architecture.
            unsafe {
                let whole = _mm_and_ps(_mm_cmpge_ps(by.0, _mm_set1_ps(0.5)), _mm_set1_ps(1.0));
                let rest = self.mul_add(Self(_mm_sub_ps(by.0, whole)), plus);
                Self(_mm_add_ps(_mm_mul_ps(self.0, whole), rest.0))
            }
        }
    }

    /// Eight lanes.
    #[derive(Clone, Copy)]
    pub(in super::super) struct Avx2(__m256);
    vector!(
        Avx2,
        __m256,
        8,
        false,
        4,
        _mm256_set1_ps,
        _mm256_loadu_ps,
        load_swapped_eight,
        _mm256_storeu_ps,
        _mm256_add_ps,
        _mm256_sub_ps,
        _mm256_fmadd_ps
    );

    /// Sixteen lanes.
    #[derive(Clone, Copy)]
    pub(in super::super) struct Avx512(__m512);
    vector!(
        Avx512,
        __m512,
        16,
        true,
        3,
        _mm512_set1_ps,
        _mm512_loadu_ps,
        load_swapped_sixteen,
        _mm512_storeu_ps,
        _mm512_add_ps,
        _mm512_sub_ps,
        _mm512_fmadd_ps
    );

    /// One vector of eight lanes is one half.
    #[inline(always)]
    unsafe fn load_swapped_eight(from: *const f32) -> __m256 {
        // SAFETY: passed on from the caller.
        unsafe { _mm256_loadu_ps(from) }
    }

    /// Sixteen lanes whose halves have changed places.
    #[inline(always)]
    unsafe fn load_swapped_sixteen(from: *const f32) -> __m512 {
        // SAFETY: the caller has AVX-512F and hands 16 readable values.
        unsafe {
            let x = _mm512_loadu_ps(from);
            _mm512_shuffle_f32x4::<0b01_00_11_10>(x, x)
        }
    }

    /// The upper eight lanes of a row onto its lower eight.
    #[inline(always)]
    unsafe fn halves(row: &Row) -> __m256 {
        // SAFETY: a row holds 16 values; the processor has AVX.
        unsafe { _mm256_add_ps(_mm256_loadu_ps(row.0.as_ptr()), _mm256_loadu_ps(row.0.as_ptr().add(8))) }
    }

    /// As [`super::sums::samples`], eight lanes at a time, then by horizontal adds.
    #[inline(always)]
    unsafe fn samples_avx(turn: &TurnSums) -> [f32; TURN] {
        let mut sums = [0.0; TURN];
        // SAFETY: `sums` holds 4 values; the processor has AVX.
        unsafe {
            let (last, one, minus) = (halves(&turn.0[0]), halves(&turn.0[1]), halves(&turn.0[2]));
            let (two, first) = (halves(&turn.0[3]), halves(&turn.0[4]));
            let (even, odd) = (_mm256_add_ps(one, minus), _mm256_sub_ps(one, minus));
            let second = _mm256_fmadd_ps(two, _mm256_set1_ps(2.0), odd);
            let third = _mm256_fmadd_ps(two, _mm256_set1_ps(4.0), even);
            let fourth = _mm256_add_ps(_mm256_fmadd_ps(two, _mm256_set1_ps(8.0), odd), first);
            let a = _mm256_hadd_ps(_mm256_add_ps(_mm256_add_ps(last, two), even), second);
            let b = _mm256_hadd_ps(third, fourth);
            let quads = _mm256_hadd_ps(a, b);
            let low_and_high = (_mm256_castps256_ps128(quads), _mm256_extractf128_ps::<1>(quads));
            _mm_storeu_ps(sums.as_mut_ptr(), _mm_add_ps(low_and_high.0, low_and_high.1));
        }
        sums
    }
}

#[cfg(target_arch = "aarch64")]
pub(super) mod neon {
    //! NEON, which every 64-bit ARM has.
    use super::Vector;
    use core::arch::aarch64::*;

    /// Four lanes.
    #[derive(Clone, Copy)]
    pub(in super::super) struct Neon(float32x4_t);

    impl Vector for Neon {
        const LEN: usize = 4;
        const KEEPS_COEFFICIENTS: bool = true;
        const GROUPS_AT_ONCE: usize = 4;
        #[inline(always)]
        unsafe fn splat(x: f32) -> Self {
            // SAFETY: NEON is part of the base of this architecture.
            Self(unsafe { vdupq_n_f32(x) })
        }
        #[inline(always)]
        unsafe fn load(from: *const f32) -> Self {
            // SAFETY: as above, and the caller hands LEN readable values.
            Self(unsafe { vld1q_f32(from) })
        }
        #[inline(always)]
        unsafe fn store(self, to: *mut f32) {
            // SAFETY: as above, and the caller hands LEN writable values.
            unsafe { vst1q_f32(to, self.0) }
        }
        #[inline(always)]
        unsafe fn add(self, other: Self) -> Self {
            // SAFETY: NEON is part of the base of this architecture.
            Self(unsafe { vaddq_f32(self.0, other.0) })
        }
        #[inline(always)]
        unsafe fn sub(self, other: Self) -> Self {
            // SAFETY: NEON is part of the base of this architecture.
            Self(unsafe { vsubq_f32(self.0, other.0) })
        }
        #[inline(always)]
        unsafe fn mul_add(self, by: Self, plus: Self) -> Self {
            // SAFETY: NEON is part of the base of this architecture.
            Self(unsafe { vfmaq_f32(plus.0, self.0, by.0) })
        }
    }
}
