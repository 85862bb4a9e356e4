//! Numbers side by side: the operations the micro-relief needs, for each instruction set.
//!
//! [`Eight`] numbers go through 256 bits (two vectors where there are 128), [`Sixteen`] through
//! 512. Every operation is one IEEE operation a lane (never fused), or one on integers, so that
//! every instruction set gives the same bits. All inline into a function that enables the set.

use super::Set;
use core::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Shl, Shr, Sub};
use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f32x16, f64x4, f64x8, i32x8, i32x16, u32x8, u32x16};

/// Several `f32`.
pub(crate) trait Single:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
}

/// Several `u32`; they are shifted by less than 32 bits.
pub(crate) trait Word:
    Copy
    + Add<Output = Self>
    + Mul<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Shl<u32, Output = Self>
    + Shr<u32, Output = Self>
{
}

/// An instruction set that works on N numbers at once.
pub(crate) trait Vector<const N: usize>: Copy {
    /// N `f32`.
    type Single: Single;
    /// N `u32`.
    type Word: Word;
    /// N `f64`.
    type Double: Copy;

    fn splat(self, x: f32) -> Self::Single;
    /// The smaller one; b if either is no number.
    fn min(self, a: Self::Single, b: Self::Single) -> Self::Single;
    /// The larger one; b if either is no number.
    fn max(self, a: Self::Single, b: Self::Single) -> Self::Single;
    /// Tests whether all lanes are equal numbers.
    fn equal(self, a: Self::Single, b: Self::Single) -> bool;
    /// Smallest and largest lane of numbers.
    fn extremes(self, x: Self::Single) -> (f32, f32);
    /// The first lane.
    fn first(self, x: Self::Single) -> f32;
    /// Each lane with its bits changed where those of `bits` are set.
    fn flip(self, x: Self::Single, bits: Self::Word) -> Self::Single;

    fn splat_word(self, x: u32) -> Self::Word;
    /// a, and 1 more where b < c as signed numbers.
    fn add_if_less(self, a: Self::Word, b: Self::Word, c: Self::Word) -> Self::Word;
    /// The nearest `f32` of signed numbers.
    fn signed_to_single(self, x: Self::Word) -> Self::Single;
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
    /// Tests whether each of four numbers is at least the one at its place in `b`.
    fn all_reach(self, a: &[f64; 4], b: &[f64; 4]) -> bool;
}

/// Eight numbers at once.
#[derive(Clone, Copy)]
pub(crate) struct Eight<S>(pub S);

/// Sixteen numbers at once.
#[derive(Clone, Copy)]
pub(crate) struct Sixteen<S>(pub S);

/// Least of four numbers in all four.
#[inline(always)]
fn four_least<S: Simd>(x: f64x4<S>) -> f64x4<S> {
    x
}

/// Lesser of each of eight numbers and the one four places further.
#[inline(always)]
fn eight_least<S: Simd>(x: f64x8<S>) -> f64x4<S> {
    let (low, high) = x.split();
    low.min(high)
}

/// The least of each of four vectors of numbers.
#[inline(always)]
fn least_of_each<S: Set>(s: S, rows: [f64x4<S>; 4]) -> [f64; 4] {
    let [a, b, c, d] = s.transpose(rows);
    a.min(b).min(c.min(d)).to_array()
}

#[inline(always)]
fn eight_points<S: Set>(s: S, from: &[[f64; 2]; 8]) -> [[f64x4<S>; 2]; 2] {
    s.points(from)
}

#[inline(always)]
fn eight_low<S: Set>(s: S, x: [f64x4<S>; 2]) -> u32x8<S> {
    s.low_words(x)
}

#[inline(always)]
fn eight_high<S: Set>(s: S, x: [f64x4<S>; 2]) -> u32x8<S> {
    s.high_words(x)
}

/// True where sixteen numbers go through one register.
const fn one_register<S: Set>() -> bool {
    S::f32s::LEN == 16
}

#[inline(always)]
fn sixteen_points<S: Set>(s: S, from: &[[f64; 2]; 16]) -> [[f64x8<S>; 2]; 2] {
    if one_register::<S>() {
        let part = |i: usize| f64x8::from_slice(s, &from.as_flattened()[8 * i..8 * i + 8]);
        let ((x0, y0), (x1, y1)) = (part(0).deinterleave(part(1)), part(2).deinterleave(part(3)));
        return [[x0, x1], [y0, y1]];
    }
    let [low, high] = [0, 8].map(|i| from[i..].first_chunk().unwrap_or(&[[0.0; 2]; 8]));
    let ([[x0, x1], [y0, y1]], [[x2, x3], [y2, y3]]) = (s.points(low), s.points(high));
    [[x0.combine(x1), x2.combine(x3)], [y0.combine(y1), y2.combine(y3)]]
}

#[inline(always)]
fn sixteen_low<S: Set>(s: S, [a, b]: [f64x8<S>; 2]) -> u32x16<S> {
    if one_register::<S>() {
        return a.bitcast::<u32x16<S>>().unzip_low(b.bitcast::<u32x16<S>>());
    }
    let ((a0, a1), (b0, b1)) = (a.split(), b.split());
    s.low_words([a0, a1]).combine(s.low_words([b0, b1]))
}

#[inline(always)]
fn sixteen_high<S: Set>(s: S, [a, b]: [f64x8<S>; 2]) -> u32x16<S> {
    if one_register::<S>() {
        return a.bitcast::<u32x16<S>>().unzip_high(b.bitcast::<u32x16<S>>());
    }
    let ((a0, a1), (b0, b1)) = (a.split(), b.split());
    s.high_words([a0, a1]).combine(s.high_words([b0, b1]))
}

macro_rules! vector {
    (
        $name:ident, $n:literal, $single:ident, $word:ident, $signed:ident, $double:ident,
        $four:ident, $points:ident, $low:ident, $high:ident
    ) => {
        impl<S: Set> Single for $single<S> {}
        impl<S: Set> Word for $word<S> {}
        impl<S: Set> Vector<$n> for $name<S> {
            type Single = $single<S>;
            type Word = $word<S>;
            /// Half of the lanes each, in an order that the loading of points makes and the halves
            /// of words undo.
            type Double = [$double<S>; 2];

            #[inline(always)]
            fn splat(self, x: f32) -> $single<S> {
                $single::splat(self.0, x)
            }
            #[inline(always)]
            fn min(self, a: $single<S>, b: $single<S>) -> $single<S> {
                if SECOND_WINS { a.min(b) } else { a.simd_lt(b).select(a, b) }
            }
            #[inline(always)]
            fn max(self, a: $single<S>, b: $single<S>) -> $single<S> {
                if SECOND_WINS { a.max(b) } else { a.simd_gt(b).select(a, b) }
            }
            #[inline(always)]
            fn equal(self, a: $single<S>, b: $single<S>) -> bool {
                a.simd_eq(b).all_true()
            }
            #[inline(always)]
            fn extremes(self, x: $single<S>) -> (f32, f32) {
                (x.reduce_min(), x.reduce_max())
            }
            #[inline(always)]
            fn first(self, x: $single<S>) -> f32 {
                x[0]
            }
            #[inline(always)]
            fn flip(self, x: $single<S>, bits: $word<S>) -> $single<S> {
                (x.bitcast::<$word<S>>() ^ bits).bitcast()
            }

            #[inline(always)]
            fn splat_word(self, x: u32) -> $word<S> {
                $word::splat(self.0, x)
            }
            #[inline(always)]
            fn add_if_less(self, a: $word<S>, b: $word<S>, c: $word<S>) -> $word<S> {
                let less = b.bitcast::<$signed<S>>().simd_lt(c.bitcast::<$signed<S>>());
                // A lane that is true is −1.
                a - less.to_vector().bitcast::<$word<S>>()
            }
            #[inline(always)]
            fn signed_to_single(self, x: $word<S>) -> $single<S> {
                x.bitcast::<$signed<S>>().to_float()
            }
            #[inline(always)]
            fn last(self, x: $word<S>) -> u32 {
                x[$n - 1]
            }

            #[inline(always)]
            fn splat_double(self, x: f64) -> [$double<S>; 2] {
                [$double::splat(self.0, x); 2]
            }
            #[inline(always)]
            fn add_double(self, a: [$double<S>; 2], b: [$double<S>; 2]) -> [$double<S>; 2] {
                [a[0] + b[0], a[1] + b[1]]
            }
            #[inline(always)]
            fn sub_double(self, a: [$double<S>; 2], b: [$double<S>; 2]) -> [$double<S>; 2] {
                [a[0] - b[0], a[1] - b[1]]
            }
            #[inline(always)]
            fn mul_double(self, a: [$double<S>; 2], b: [$double<S>; 2]) -> [$double<S>; 2] {
                [a[0] * b[0], a[1] * b[1]]
            }
            #[inline(always)]
            fn min_double(self, a: [$double<S>; 2], b: [$double<S>; 2]) -> [$double<S>; 2] {
                let min = |a: $double<S>, b: $double<S>| {
                    if SECOND_WINS { a.min(b) } else { a.simd_lt(b).select(a, b) }
                };
                [min(a[0], b[0]), min(a[1], b[1])]
            }
            #[inline(always)]
            fn max_double(self, a: [$double<S>; 2], b: [$double<S>; 2]) -> [$double<S>; 2] {
                let max = |a: $double<S>, b: $double<S>| {
                    if SECOND_WINS { a.max(b) } else { a.simd_gt(b).select(a, b) }
                };
                [max(a[0], b[0]), max(a[1], b[1])]
            }
            #[inline(always)]
            fn low_half(self, x: [$double<S>; 2]) -> $word<S> {
                $low(self.0, x)
            }
            #[inline(always)]
            fn high_half(self, x: [$double<S>; 2]) -> $word<S> {
                $high(self.0, x)
            }
            #[inline(always)]
            fn bounds(self, u: [$double<S>; 2], v: [$double<S>; 2]) -> [f64; 4] {
                least_of_each(
                    self.0,
                    [
                        $four(u[0].min(u[1])),
                        $four(v[0].min(v[1])),
                        $four(-u[0].max(u[1])),
                        $four(-v[0].max(v[1])),
                    ],
                )
            }

            #[inline(always)]
            fn load(self, from: &[f64; $n]) -> $single<S> {
                let (low, high) = from.split_at($n / 2);
                $double::from_slice(self.0, low).narrow($double::from_slice(self.0, high))
            }
            #[inline(always)]
            fn load_points(self, from: &[[f64; 2]; $n]) -> [[$double<S>; 2]; 2] {
                $points(self.0, from)
            }
            #[inline(always)]
            fn add_to(self, x: $single<S>, to: &mut [f64; $n]) {
                let (low, high) = x.widen();
                let (to_low, to_high) = to.split_at_mut($n / 2);
                (low + $double::from_slice(self.0, to_low)).store_slice(to_low);
                (high + $double::from_slice(self.0, to_high)).store_slice(to_high);
            }
            #[inline(always)]
            fn all_reach(self, a: &[f64; 4], b: &[f64; 4]) -> bool {
                f64x4::load_array_ref(self.0, a).simd_ge(f64x4::load_array_ref(self.0, b)).all_true()
            }
        }
    };
}

/// True where the smaller of two numbers is the second one if either is none, as on x86; elsewhere
/// it is asked for.
const SECOND_WINS: bool = cfg!(target_arch = "x86_64");

vector!(Eight, 8, f32x8, u32x8, i32x8, f64x4, four_least, eight_points, eight_low, eight_high);
vector!(Sixteen, 16, f32x16, u32x16, i32x16, f64x8, eight_least, sixteen_points, sixteen_low, sixteen_high);
