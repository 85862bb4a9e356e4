//! Corrections of a profile between two samples beside the cubic through them, where it is
//! known midway too, or at every quarter.
//!
//! ```text
//! s(0) = 4/3 (m₊ − m₋) − 1/6 (h₊ − h₋)        bend = quartic(h₀, h₁, s(0), s(1), m) − cubic(h₀, h₁, (h₊ − h₋)/2 …)
//! ```
//! h are heights at samples and m those midway between. Slopes of differences over half a sample
//! and the height midway make the profile exact to the fourth degree, where a Catmull-Rom cubic is
//! to the second: gradient noise that passes within four samples is missed by a twenty-fifth of
//! what the cubic misses. Known at the quarters, each half is such a quartic over half the way: a
//! three-hundredth. More differences bring little: the noise bends as it likes from cell to cell.
//! All terms are differences, and they add: of a sum of reliefs only those that need it have to be
//! looked at between samples.
//!
//! Four samples are worked out side by side, product and sum apart: the same bits on every set of
//! instructions and in any blocks.
//!
//! *Price.* Some 390 lines of code: this file, two of the three kinds of `ExactEvent::run_on`,
//! `CleanGround`, and in the engine `voice/between` and the overlay's short waves. Gain: a light
//! stroke errs by −80 / −59 dB, felt / heard, where midway alone leaves −50 / −37 and the cubic
//! more.
//!
//! *Measured instead of it:* two or four steps a sample of everything from the path to the pad. Rms
//! errors of the contact force on the named cases of `asperity report`, as one step with looks, two
//! and four (which still look where they miss too much):
//!
//! | steps | time | smooth | bouncing | steep | fast |
//! |---|---|---|---|---|---|
//! | one | 1 | −106 | −80 | −71 | −61 dB |
//! | two | 1.7 | −118 | −93 | −101 | −50 |
//! | four | 2.4 | −131 | −105 | −113 | −74 |
//!
//! A look midway costs 200 instructions a sample of some 1400 (callgrind, AVX2), a step the map,
//! all octaves and the pad once more; and where the ground passes fastest two steps miss more
//! than looks do.

use super::guard::MAX_HEIGHT_M;
use crate::simd::{Level, Set, at_level};
use fearless_simd::f64x4;
use fearless_simd::prelude::*;

/// c₁ … c₄ of the polynomial over a sample beyond the cubic's, m.
pub type QuarticCorrection = [f64; 4];

/// Ground between samples; entry n belongs to the sample that ends at height n − 1.
#[derive(Debug, Clone, Copy)]
pub enum SubSampleProfile<'a> {
    /// Nothing: it is the cubic.
    AtSamples,
    /// Its heights midway: a bend each.
    Midway(&'a [QuarticCorrection]),
    /// Its heights at every quarter: a bend for each half, the second seen from midway.
    Quarters(&'a [[QuarticCorrection; 2]]),
}

impl<'a> SubSampleProfile<'a> {
    /// The first so many samples, and the rest.
    #[inline(always)]
    pub(super) fn split_at(self, count: usize) -> (Self, Self) {
        match self {
            Self::AtSamples => (self, self),
            Self::Midway(quartic_correction) => {
                let (first, rest) = quartic_correction.split_at(count.min(quartic_correction.len()));
                (Self::Midway(first), Self::Midway(rest))
            }
            Self::Quarters(halves) => {
                let (first, rest) = halves.split_at(count.min(halves.len()));
                (Self::Quarters(first), Self::Quarters(rest))
            }
        }
    }

    /// Tests whether so many samples of it are known, none of them beyond what a height may be.
    pub(super) fn is_sound(self, count: usize) -> bool {
        match self {
            Self::AtSamples => true,
            Self::Midway(quartic_correction) => {
                quartic_correction.len() == count && are_valid(quartic_correction)
            }
            Self::Quarters(halves) => halves.len() == count && are_valid(halves.as_flattened()),
        }
    }
}

/// Tests whether all of them can be.
#[inline(always)]
pub(super) fn are_valid(quartic_correction: &[QuarticCorrection]) -> bool {
    quartic_correction.as_flattened().iter().fold(true, |good, c| good & (c.abs() <= MAX_HEIGHT_M))
}

/// Samples that have to be known before the first bend.
const KNOWN: usize = 3;
/// Samples worked out at a time.
const CHUNK: usize = 32;
/// A vector's numbers.
const WIDE: usize = 4;

/// Heights of a stretch behind the last ones before it, and room for a whole vector at the end.
struct Row([f64; KNOWN + CHUNK + WIDE]);

impl Row {
    /// Values of before, and the next of a stretch; the last old ones become those of the stretch.
    #[inline(always)]
    fn new<const N: usize>(old: &mut [f64; N], new: &[f64]) -> Self {
        let mut row = [0.0; KNOWN + CHUNK + WIDE];
        row[..N].copy_from_slice(old);
        row[N..N + new.len()].copy_from_slice(new);
        old.copy_from_slice(&row[new.len()..new.len() + N]);
        Self(row)
    }

    /// Four of them.
    #[inline(always)]
    fn at<S: Set>(&self, s: S, at: usize) -> f64x4<S> {
        f64x4::from_slice(s, &self.0[at..at + WIDE])
    }
}

/// The last heights at samples and between them, of which bends come.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct QuarticCorrections {
    /// At the last three samples, oldest first, m.
    at_m: [f64; KNOWN],
    /// Midway to the last two, m.
    midway_m: [f64; 2],
    /// In the first half of the way to the last of them, and in the second half of the way to the
    /// last two, m.
    first_m: [f64; 1],
    second_m: [f64; 2],
    known: usize,
}

impl QuarticCorrections {
    /// Takes heights at samples and midway from the sample before each; the bends that end at the
    /// sample before each, zero where too little is known yet. All slices are equally long.
    pub fn midway(
        &mut self,
        level: Level,
        at_m: &[f64],
        midway_m: &[f64],
        quartic_correction: &mut [QuarticCorrection],
    ) {
        let all = at_m.chunks(CHUNK).zip(midway_m.chunks(CHUNK)).zip(quartic_correction.chunks_mut(CHUNK));
        for ((at_m, midway_m), quartic_correction) in all {
            let rows = (Row::new(&mut self.at_m, at_m), Row::new(&mut self.midway_m, midway_m));
            at_level!(level.at_most_256_bits(), s => {
                for (k, quartic_correction) in quartic_correction.chunks_mut(WIDE).enumerate() {
                    let turned = s.transpose(midway(s, &rows, WIDE * k));
                    for (bend, turned) in quartic_correction.iter_mut().zip(turned) {
                        *bend = turned.to_array();
                    }
                }
            });
            self.begin(quartic_correction);
        }
    }

    /// Corrections with heights at the quarters: one in the first half of the way from the
    /// sample before, one in the second.
    pub fn quarters(
        &mut self,
        level: Level,
        at_m: &[f64],
        midway_m: &[f64],
        [first_m, second_m]: [&[f64]; 2],
        quartic_correction: &mut [[QuarticCorrection; 2]],
    ) {
        let between = first_m.chunks(CHUNK).zip(second_m.chunks(CHUNK));
        let all = at_m
            .chunks(CHUNK)
            .zip(midway_m.chunks(CHUNK))
            .zip(between)
            .zip(quartic_correction.chunks_mut(CHUNK));
        for (((at_m, midway_m), (first_m, second_m)), quartic_correction) in all {
            let rows = (Row::new(&mut self.at_m, at_m), Row::new(&mut self.midway_m, midway_m));
            let quarters = (Row::new(&mut self.first_m, first_m), Row::new(&mut self.second_m, second_m));
            at_level!(level.at_most_256_bits(), s => {
                for (k, quartic_correction) in quartic_correction.chunks_mut(WIDE).enumerate() {
                    let [first, second] = quarters_of(s, &rows, &quarters, WIDE * k);
                    let turned = s.transpose(first).into_iter().zip(s.transpose(second));
                    for (bend, (first, second)) in quartic_correction.iter_mut().zip(turned) {
                        *bend = [first.to_array(), second.to_array()];
                    }
                }
            });
            self.begin(quartic_correction);
        }
    }

    /// The first are none.
    #[inline(always)]
    fn begin<B: Flat>(&mut self, quartic_correction: &mut [B]) {
        let unknown = (KNOWN - self.known).min(quartic_correction.len());
        quartic_correction[..unknown].iter_mut().for_each(|bend| *bend = B::NONE);
        self.known += unknown;
    }

    /// Breaks the chain: the next heights have nothing to do with those of before.
    pub fn forget(&mut self) {
        self.known = 0;
    }
}

/// Flat bend.
trait Flat {
    const NONE: Self;
}

impl Flat for QuarticCorrection {
    const NONE: Self = [0.0; 4];
}

impl Flat for [QuarticCorrection; 2] {
    const NONE: Self = [[0.0; 4]; 2];
}

/// Corrections of four samples, coefficient by coefficient.
#[inline(always)]
fn midway<S: Set>(s: S, (at, mid): &(Row, Row), n: usize) -> [f64x4<S>; 4] {
    let splat = |x: f64| -> f64x4<S> { f64x4::splat(s, x) };
    let (half, two, four, third) = (splat(0.5), splat(2.0), splat(4.0), splat(1.0 / 3.0));
    let (h0, h1, h2, h3) = (at.at(s, n), at.at(s, n + 1), at.at(s, n + 2), at.at(s, n + 3));
    let (m0, m1, m2) = (mid.at(s, n), mid.at(s, n + 1), mid.at(s, n + 2));
    let (first, last) = (h2 - h0, h3 - h1);
    // Slopes at both ends beyond the cubic's, and the height midway beyond that of the cubic with
    // the new slopes.
    let begin = (four * (m1 - m0) - two * first) * third;
    let end = (four * (m2 - m1) - two * last) * third;
    let slopes = (half * first + begin) - (half * last + end);
    let middle = splat(16.0) * ((m1 - half * (h1 + h2)) - splat(0.125) * slopes);
    [begin, middle - (two * begin + end), (begin + end) - two * middle, middle]
}

/// Corrections in halves.
#[inline(always)]
fn quarters_of<S: Set>(
    s: S,
    (at, mid): &(Row, Row),
    (first, second): &(Row, Row),
    n: usize,
) -> [[f64x4<S>; 4]; 2] {
    let splat = |x: f64| -> f64x4<S> { f64x4::splat(s, x) };
    let (half, three_halves) = (splat(0.5), splat(1.5));
    let (h0, h1, h2, h3) = (at.at(s, n), at.at(s, n + 1), at.at(s, n + 2), at.at(s, n + 3));
    let (m0, m1, m2) = (mid.at(s, n), mid.at(s, n + 1), mid.at(s, n + 2));
    let (a1, a2) = (first.at(s, n), first.at(s, n + 1));
    let (b0, b1) = (second.at(s, n), second.at(s, n + 1));
    let (before, inside, after) = (h1 - h0, h2 - h1, h3 - h2);
    let k1 = half * (before + inside);
    let k2 = (three_halves * inside - before) - half * after;
    let k3 = half * (before + after) - inside;
    // Slopes a half sample, where it begins, midway and where it ends.
    let s0 = slope(s, [b0, a1], m1 - m0);
    let s1 = slope(s, [a1, b1], inside);
    let s2 = slope(s, [b1, a2], m2 - m1);
    let [c1, c2, c3, c4] = quartic(s, m1 - h1, [s0, s1], a1 - h1);
    let [d1, d2, d3, d4] = quartic(s, h2 - m1, [s1, s2], b1 - m1);
    // The cubic, seen from midway.
    let (slope, curve) = (k1 + (k2 + splat(0.75) * k3), k2 + three_halves * k3);
    [[c1 - k1, c2 - k2, c3 - k3, c4], [d1 - slope, d2 - curve, d3 - k3, d4]]
}

// Not closures: those take no instructions of their set, and each product would be a call.

/// The slope a half sample, from the heights a quarter before and after and the rise from a half
/// before to a half after.
#[inline(always)]
fn slope<S: Set>(s: S, [low, high]: [f64x4<S>; 2], rise: f64x4<S>) -> f64x4<S> {
    (f64x4::splat(s, 8.0) * (high - low) - rise) * f64x4::splat(s, 1.0 / 6.0)
}

/// The quartic of a half sample, in coefficients a whole sample, from its rise, the slopes at its
/// ends and its height midway.
#[inline(always)]
fn quartic<S: Set>(s: S, rise: f64x4<S>, [begin, end]: [f64x4<S>; 2], middle: f64x4<S>) -> [f64x4<S>; 4] {
    let splat = |x: f64| -> f64x4<S> { f64x4::splat(s, x) };
    let two = splat(2.0);
    let bump = splat(16.0) * ((middle - splat(0.5) * rise) - splat(0.125) * (begin - end));
    let square = (splat(3.0) * rise - (two * begin + end)) + bump;
    let cube = (begin + end) - two * (rise + bump);
    [two * begin, splat(4.0) * square, splat(8.0) * cube, splat(16.0) * bump]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn height(x: f64) -> f64 {
        3.0 - 0.7 * x + 0.3 * x * x - 0.11 * x * x * x + 0.013 * x * x * x * x
    }

    fn rise(c: [f64; 4], x: f64) -> f64 {
        c.iter().rev().fold(0.0, |sum, c| x * (sum + c))
    }

    fn sum(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [0, 1, 2, 3].map(|k| a[k] + b[k])
    }

    /// Samples of the profile.
    const COUNT: usize = 50;

    /// Heights at them, so much later.
    fn heights(later: f64) -> [f64; COUNT] {
        core::array::from_fn(|n| height(0.1 * (n as f64 + later)))
    }

    /// Corrections of them, taken in such blocks.
    fn quartic_correction(
        level: Level,
        cuts: usize,
    ) -> ([QuarticCorrection; COUNT], [[QuarticCorrection; 2]; COUNT]) {
        let [at, first, mid, second] = [0.0, -0.75, -0.5, -0.25].map(heights);
        let (mut by_mid, mut by_quarters) = (QuarticCorrections::default(), QuarticCorrections::default());
        let (mut quartic_correction, mut halves) = ([[0.0; 4]; COUNT], [[[0.0; 4]; 2]; COUNT]);
        for (k, (quartic_correction, halves)) in
            quartic_correction.chunks_mut(cuts).zip(halves.chunks_mut(cuts)).enumerate()
        {
            let now = k * cuts..k * cuts + quartic_correction.len();
            by_mid.midway(level, &at[now.clone()], &mid[now.clone()], quartic_correction);
            let quarters = [&first[now.clone()], &second[now.clone()]];
            by_quarters.quarters(level, &at[now.clone()], &mid[now], quarters, halves);
        }
        (quartic_correction, halves)
    }

    #[test]
    fn with_its_bend_a_cubic_is_a_quartic_to_rounding() {
        let (quartic_correction, halves) = quartic_correction(Level::detect(), 50);
        assert_eq!((&quartic_correction[..3], &halves[..3]), (&[[0.0; 4]; 3][..], &[[[0.0; 4]; 2]; 3][..]));
        let at = |x: f64| height(0.1 * x);
        for (n, (bend, [first, second])) in quartic_correction.iter().zip(&halves).enumerate().skip(3) {
            let end = n as f64 - 1.0;
            let [before, inside, after] = [-1.0, 0.0, 1.0].map(|k| at(end + k) - at(end + k - 1.0));
            let square = 1.5 * inside - before - 0.5 * after;
            let cubic = [0.5 * (before + inside), square, 0.5 * (before + after) - inside, 0.0];
            let [c1, c2, c3, _] = cubic;
            let midway = [c1 + c2 + 0.75 * c3, c2 + 1.5 * c3, c3, 0.0];
            for x in [0.0, 0.2, 0.5, 0.9, 1.0] {
                let wanted = at(end - 1.0 + x) - at(end - 1.0);
                let found = rise(sum(cubic, *bend), x);
                assert!((found - wanted).abs() < 1e-12, "{n}, {x}: {found} and not {wanted}");
                let wanted = at(end - 1.0 + 0.5 * x) - at(end - 1.0);
                let found = rise(sum(cubic, *first), 0.5 * x);
                assert!((found - wanted).abs() < 1e-12, "{n}, first half, {x}: {found} and not {wanted}");
                let wanted = at(end - 0.5 + 0.5 * x) - at(end - 0.5);
                let found = rise(sum(midway, *second), 0.5 * x);
                assert!((found - wanted).abs() < 1e-12, "{n}, second half, {x}: {found} and not {wanted}");
            }
        }
    }

    #[test]
    fn bends_have_the_same_bits_on_every_instruction_set() {
        let whole = quartic_correction(Level::detect(), 50);
        for level in Level::available() {
            for cuts in [1, 2, 3, 7, 33, 50] {
                assert!(quartic_correction(level, cuts) == whole, "{level:?}, {cuts}");
            }
        }
    }

    #[test]
    fn what_is_forgotten_bends_nothing() {
        let mut quartic_correction = QuarticCorrections::default();
        let mut out = [[1.0; 4]; 4];
        quartic_correction.midway(Level::detect(), &[1.0, 2.0, 4.0, 3.0], &[0.0; 4], &mut out);
        assert!(out[..3] == [[0.0; 4]; 3] && out[3] != [0.0; 4]);
        quartic_correction.forget();
        quartic_correction.midway(Level::detect(), &[5.0], &[4.0], &mut out[3..]);
        assert_eq!(out[3], [0.0; 4]);
    }
}
