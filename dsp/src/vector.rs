//! Numbers side by side: the operations the micro-relief needs, for each instruction set.
//!
//! A value of [`Portable`], `Avx2` or `Avx512` stands for the right to use that instruction set, so that a kernel
//! written over [`Vector`] is safe code. Every operation is one IEEE operation a lane (never fused), or one on
//! integers, so that every instruction set gives the same bits. All inline into a function that enables the set.

#[cfg(target_arch = "x86_64")]
mod x86;
#[cfg(target_arch = "x86_64")]
pub(crate) use x86::{Avx2, Avx512};

/// An instruction set that works on N numbers at once.
pub(crate) trait Vector<const N: usize>: Copy {
    /// N `f32`.
    type Single: Copy;
    /// N `u32`.
    type Word: Copy;
    /// N `f64`.
    type Double: Copy;

    fn splat(self, x: f32) -> Self::Single;
    fn add(self, a: Self::Single, b: Self::Single) -> Self::Single;
    fn sub(self, a: Self::Single, b: Self::Single) -> Self::Single;
    fn mul(self, a: Self::Single, b: Self::Single) -> Self::Single;
    fn div(self, a: Self::Single, b: Self::Single) -> Self::Single;
    /// The smaller one; b if either is no number.
    fn min(self, a: Self::Single, b: Self::Single) -> Self::Single;
    /// The larger one; b if either is no number.
    fn max(self, a: Self::Single, b: Self::Single) -> Self::Single;
    /// Whether all lanes are equal numbers.
    fn equal(self, a: Self::Single, b: Self::Single) -> bool;
    /// Smallest and largest lane of numbers.
    fn extremes(self, x: Self::Single) -> (f32, f32);
    /// Each lane with its bits changed where those of `bits` are set.
    fn flip(self, x: Self::Single, bits: Self::Word) -> Self::Single;

    fn splat_word(self, x: u32) -> Self::Word;
    fn add_word(self, a: Self::Word, b: Self::Word) -> Self::Word;
    fn mul_word(self, a: Self::Word, b: Self::Word) -> Self::Word;
    fn and(self, a: Self::Word, b: Self::Word) -> Self::Word;
    fn or(self, a: Self::Word, b: Self::Word) -> Self::Word;
    fn xor(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// Shifts by less than 32 bits.
    fn left(self, a: Self::Word, bits: u32) -> Self::Word;
    fn right(self, a: Self::Word, bits: u32) -> Self::Word;
    /// a, and 1 more where b < c as signed numbers.
    fn add_if_less(self, a: Self::Word, b: Self::Word, c: Self::Word) -> Self::Word;
    /// The nearest `f32` of signed numbers.
    fn signed_to_single(self, x: Self::Word) -> Self::Single;
    /// The last lane in all lanes.
    fn splat_last(self, x: Self::Word) -> Self::Word;
    /// The last lane.
    fn last(self, x: Self::Word) -> u32;

    fn splat_double(self, x: f64) -> Self::Double;
    fn add_double(self, a: Self::Double, b: Self::Double) -> Self::Double;
    fn sub_double(self, a: Self::Double, b: Self::Double) -> Self::Double;
    fn mul_double(self, a: Self::Double, b: Self::Double) -> Self::Double;
    /// The smaller one; b if either is no number.
    fn min_double(self, a: Self::Double, b: Self::Double) -> Self::Double;
    /// The larger one; b if either is no number.
    fn max_double(self, a: Self::Double, b: Self::Double) -> Self::Double;
    /// The lower 32 bits of each.
    fn low_half(self, x: Self::Double) -> Self::Word;
    /// The upper 32 bits of each.
    fn high_half(self, x: Self::Double) -> Self::Word;
    /// [min u, min v, −max u, −max v] over the lanes of numbers.
    fn bounds(self, u: Self::Double, v: Self::Double) -> [f64; 4];

    /// The nearest `f32` of each.
    fn load(self, from: &[f64; N]) -> Self::Single;
    /// Both coordinates of each.
    fn load_points(self, from: &[[f64; 2]; N]) -> [Self::Double; 2];
    fn add_to(self, x: Self::Single, to: &mut [f64; N]);
    /// Whether each of four numbers is at least the one at its place in `b`.
    fn all_reach(self, a: &[f64; 4], b: &[f64; 4]) -> bool;
}

/// Whatever the compiler makes of arrays.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

/// Lane by lane.
#[inline(always)]
fn each<const N: usize, A: Copy, B: Copy, C: Copy + Default>(
    a: [A; N],
    b: [B; N],
    f: impl Fn(A, B) -> C,
) -> [C; N] {
    let mut out = [C::default(); N];
    for n in 0..N {
        out[n] = f(a[n], b[n]);
    }
    out
}

#[inline(always)]
fn smaller<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

#[inline(always)]
fn larger<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

impl<const N: usize> Vector<N> for Portable {
    type Single = [f32; N];
    type Word = [u32; N];
    type Double = [f64; N];

    #[inline(always)]
    fn splat(self, x: f32) -> [f32; N] {
        [x; N]
    }
    #[inline(always)]
    fn add(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        each(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        each(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        each(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        each(a, b, |a, b| a / b)
    }
    #[inline(always)]
    fn min(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        each(a, b, smaller)
    }
    #[inline(always)]
    fn max(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        each(a, b, larger)
    }
    #[inline(always)]
    fn equal(self, a: [f32; N], b: [f32; N]) -> bool {
        a == b
    }
    #[inline(always)]
    fn extremes(self, x: [f32; N]) -> (f32, f32) {
        (x.into_iter().fold(f32::INFINITY, smaller), x.into_iter().fold(f32::NEG_INFINITY, larger))
    }
    #[inline(always)]
    fn flip(self, x: [f32; N], bits: [u32; N]) -> [f32; N] {
        each(x, bits, |x, bits| f32::from_bits(x.to_bits() ^ bits))
    }

    #[inline(always)]
    fn splat_word(self, x: u32) -> [u32; N] {
        [x; N]
    }
    #[inline(always)]
    fn add_word(self, a: [u32; N], b: [u32; N]) -> [u32; N] {
        each(a, b, u32::wrapping_add)
    }
    #[inline(always)]
    fn mul_word(self, a: [u32; N], b: [u32; N]) -> [u32; N] {
        each(a, b, u32::wrapping_mul)
    }
    #[inline(always)]
    fn and(self, a: [u32; N], b: [u32; N]) -> [u32; N] {
        each(a, b, |a, b| a & b)
    }
    #[inline(always)]
    fn or(self, a: [u32; N], b: [u32; N]) -> [u32; N] {
        each(a, b, |a, b| a | b)
    }
    #[inline(always)]
    fn xor(self, a: [u32; N], b: [u32; N]) -> [u32; N] {
        each(a, b, |a, b| a ^ b)
    }
    #[inline(always)]
    fn left(self, a: [u32; N], bits: u32) -> [u32; N] {
        each(a, a, |a, _| a << (bits & 31))
    }
    #[inline(always)]
    fn right(self, a: [u32; N], bits: u32) -> [u32; N] {
        each(a, a, |a, _| a >> (bits & 31))
    }
    #[inline(always)]
    fn add_if_less(self, a: [u32; N], b: [u32; N], c: [u32; N]) -> [u32; N] {
        let less = each(b, c, |b, c| u32::from((b as i32) < (c as i32)));
        each(a, less, u32::wrapping_add)
    }
    #[inline(always)]
    fn signed_to_single(self, x: [u32; N]) -> [f32; N] {
        each(x, x, |x, _| x as i32 as f32)
    }
    #[inline(always)]
    fn splat_last(self, x: [u32; N]) -> [u32; N] {
        [x[N - 1]; N]
    }
    #[inline(always)]
    fn last(self, x: [u32; N]) -> u32 {
        x[N - 1]
    }

    #[inline(always)]
    fn splat_double(self, x: f64) -> [f64; N] {
        [x; N]
    }
    #[inline(always)]
    fn add_double(self, a: [f64; N], b: [f64; N]) -> [f64; N] {
        each(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub_double(self, a: [f64; N], b: [f64; N]) -> [f64; N] {
        each(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul_double(self, a: [f64; N], b: [f64; N]) -> [f64; N] {
        each(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn min_double(self, a: [f64; N], b: [f64; N]) -> [f64; N] {
        each(a, b, smaller)
    }
    #[inline(always)]
    fn max_double(self, a: [f64; N], b: [f64; N]) -> [f64; N] {
        each(a, b, larger)
    }
    #[inline(always)]
    fn low_half(self, x: [f64; N]) -> [u32; N] {
        each(x, x, |x, _| x.to_bits() as u32)
    }
    #[inline(always)]
    fn high_half(self, x: [f64; N]) -> [u32; N] {
        each(x, x, |x, _| (x.to_bits() >> 32) as u32)
    }
    #[inline(always)]
    fn bounds(self, u: [f64; N], v: [f64; N]) -> [f64; 4] {
        let least = |x: [f64; N]| x.into_iter().fold(f64::INFINITY, smaller);
        let most = |x: [f64; N]| x.into_iter().fold(f64::NEG_INFINITY, larger);
        [least(u), least(v), -most(u), -most(v)]
    }

    #[inline(always)]
    fn load(self, from: &[f64; N]) -> [f32; N] {
        each(*from, *from, |x, _| x as f32)
    }
    #[inline(always)]
    fn load_points(self, from: &[[f64; 2]; N]) -> [[f64; N]; 2] {
        [each(*from, *from, |p, _| p[0]), each(*from, *from, |p, _| p[1])]
    }
    #[inline(always)]
    fn add_to(self, x: [f32; N], to: &mut [f64; N]) {
        for n in 0..N {
            to[n] += f64::from(x[n]);
        }
    }
    #[inline(always)]
    fn all_reach(self, a: &[f64; 4], b: &[f64; 4]) -> bool {
        a.iter().zip(b).all(|(a, b)| a >= b)
    }
}
