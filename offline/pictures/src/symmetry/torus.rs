//! Few repeats in a map that tiles: its seam is evidence.
//!
//! Two to four repeats a side leave the feature matrix too few nodes to be told from chance. A map
//! that tiles is drawn on a torus, and a pattern of n cells on it has waves at one in n frequencies
//! only, those of the lattice's dual:
//!
//! ```text
//! k = i (a, 0) + j (b, d)     n = a d     t1 = (W/a, −b H/n)     t2 = (0, H/d)
//! q = (s − 1/n)/(1 − 1/n)     z = q √((n − 1) M)     M = (Σ p)²/(2 Σ p²)
//! ```
//! | symbol | here |
//! |---|---|
//! | W, H | width and height of the map |
//! | p | amplitude of a wave of up to [`MOST_WAVES`] periods a side to a power of [`POWERS`]: clean patterns show by their many weak waves, noisy ones by their strong ones |
//! | s | share of Σ p at the waves of the dual |
//! | q | part of the map that repeats: 1 without noise, about 0 where nothing does |
//! | z | q in standard errors of what as many independent waves give by chance |
//!
//! Stripes lie on one line of waves, at which any number of cells across fits: without the
//! strongest line the rest must still repeat. A lattice that leaves out waves which another has and
//! which stand out of the rest is a fraction and is not taken.
//!
//! Source: ours. Measured (`lattice_of_few_repeats`, random motifs): all of 30 clean maps of two to
//! five repeats, 27 of 30 under noise of 0.05 of their deviation; under noise of 0.25 and 0.7 0.92
//! of nine cells and more, a third of 2 × 2: of few cells under noise too few waves are left to
//! tell a pattern from chance. No fraction, and none of 54 periodic maps without a pattern is
//! called one.

use super::detrend::decimated;
use super::lattice::{Lattice, length, reduced, upright};
use crate::borders::Borders;
use crate::fft2::Fft2;
use asperity_surface::raster::Raster;
use std::cmp::Ordering;
use std::collections::HashMap;

/// Periods a side up to which waves count.
const MOST_WAVES: usize = 32;
/// Powers of the amplitudes that are asked one after the other, until one of them shows a lattice.
const POWERS: [f64; 4] = [2.0, 1.0, 0.5, 0.25];
/// Numbers of cells on the map.
const CELLS: std::ops::RangeInclusive<usize> = 4..=64;
/// Longest translation over the longer side: two repeats, and the slanted one of half a row.
const LONGEST: f64 = 0.6;
/// Shortest translation over the longer side: with more repeats the feature matrix sees them.
const SHORTEST: f64 = 1.0 / 8.5;
/// Least part of the map that must repeat.
const LEAST_REPEATING: f64 = 0.5;
/// Standard errors at which a lattice is as likely as none. Some thousand lattices are tried: of
/// periodic noise, blobs and rings of waves none reaches 5.
const MERIT_LIMIT: f64 = 6.0;
/// Spectrum without the strongest line of waves.
const ACROSS_LIMIT: f64 = 4.0;
/// Share of the power outside the strongest line below which a map is striped.
const LEAST_ACROSS: f64 = 0.05;
/// A lattice of more cells is preferred while what does not repeat at it is at most this many times
/// what does not at the best, and this much more.
const AS_GOOD: (f64, f64) = (1.5, 0.02);
/// Natural logarithm of the odds from which a wave is no noise.
const BEYOND_CHANCE: f64 = 6.0;
/// Share of the power that waves have at least to count as left out: less is what drawing on texels
/// leaves of a clean pattern.
const LEAST_BETWEEN: f64 = 0.01;
/// Side from which maps are averaged down, texels: eight for the shortest wave.
const SEARCH_SIDE: usize = 8 * MOST_WAVES;

/// The lattice of a map that tiles and repeats two to eight times a side; nothing for others.
pub(super) fn tiling_lattice(map: &Raster) -> Option<Lattice> {
    if Borders::Detect.decide(map) != Borders::Periodic {
        return None;
    }
    let waves = Waves::of(&averaged_down(map));
    let powers = waves.to_the(2.0);
    if powers.across().sum() <= LEAST_ACROSS * powers.sum() {
        return None;
    }
    let lattices = Torus::all([map.width as f64, map.height as f64]);
    let mut found = POWERS.into_iter().filter_map(|power| best(&waves.to_the(power), &powers, &lattices));
    let (torus, merit) = found.next()?;
    let odds = (merit / MERIT_LIMIT).powi(2);
    let [t1_px, t2_px] = upright(torus.basis);
    Some(Lattice { t1_px, t2_px, confidence: odds / (1.0 + odds) })
}

/// Means of whole squares, where they fill the map.
fn averaged_down(map: &Raster) -> Raster {
    let side = map.width.min(map.height);
    let divides = |factor: &usize| map.width.is_multiple_of(*factor) && map.height.is_multiple_of(*factor);
    decimated(map, (1..=side / SEARCH_SIDE).rev().find(divides).unwrap_or(1))
}

/// A lattice on the torus.
#[derive(Debug, Clone, Copy)]
struct Torus {
    a: i32,
    b: i32,
    d: i32,
    /// Translations on the map, reduced, texels.
    basis: [[f64; 2]; 2],
}

impl Torus {
    /// All lattices of so few repeats on a map of this width and height.
    fn all([width, height]: [f64; 2]) -> Vec<Self> {
        let side = width.max(height);
        let mut all = Vec::new();
        for n in CELLS {
            for a in (1..=n).filter(|a| n.is_multiple_of(*a)) {
                for b in 0..a {
                    let d = n / a;
                    let slant = b as f64 * height / n as f64;
                    let basis = reduced([width / a as f64, -slant], [0.0, height / d as f64]);
                    if length(basis[1]) <= LONGEST * side && length(basis[0]) >= SHORTEST * side {
                        all.push(Self { a: a as i32, b: b as i32, d: d as i32, basis });
                    }
                }
            }
        }
        all
    }

    fn cells(&self) -> f64 {
        f64::from(self.a * self.d)
    }

    /// Tests whether all waves of another lattice are waves of this one.
    fn spans(&self, other: &Self) -> bool {
        self.holds([other.a, 0]) && self.holds([other.b, other.d])
    }

    fn holds(&self, [kx, ky]: [i32; 2]) -> bool {
        ky % self.d == 0 && (kx - self.b * (ky / self.d)) % self.a == 0
    }
}

/// Strengths of waves, one of each ± pair.
struct Waves(Vec<([i32; 2], f64)>);

impl Waves {
    fn of(map: &Raster) -> Self {
        let (width, height) = (map.width, map.height);
        let mean = map.mean();
        let centred: Vec<f64> = map.values.iter().map(|v| v - mean).collect();
        let spectrum = Fft2::new(width, height).spectrum(&centred);
        let most = |side: usize| MOST_WAVES.min((side - 1) / 2) as i32;
        let mut waves = Vec::new();
        for kx in 0..=most(width) {
            for ky in -most(height)..=most(height) {
                if kx > 0 || ky > 0 {
                    let at = kx as usize * height + ky.rem_euclid(height as i32) as usize;
                    waves.push(([kx, ky], spectrum[at].norm()));
                }
            }
        }
        Self(waves)
    }

    fn to_the(&self, power: f64) -> Self {
        Self(self.0.iter().map(|&(k, p)| (k, p.powf(power))).collect())
    }

    fn sum(&self) -> f64 {
        self.0.iter().map(|(_, p)| p).sum()
    }

    /// All waves but those of the strongest line through the origin.
    fn across(&self) -> Self {
        let mut lines: HashMap<[i32; 2], f64> = HashMap::new();
        for &(k, p) in &self.0 {
            *lines.entry(direction(k)).or_default() += p;
        }
        let strongest = lines.into_iter().max_by(|x, y| x.1.total_cmp(&y.1).then(x.0.cmp(&y.0)));
        let along = strongest.map(|(direction, _)| direction);
        Self(self.0.iter().filter(|(k, _)| Some(direction(*k)) != along).copied().collect())
    }

    /// Tests whether waves that a coarser lattice has and a finer one has not are beyond what
    /// chance makes of those that neither has: then the finer one is a fraction of the pattern's.
    fn shows_between(&self, coarser: &Torus, finer: &Torus) -> bool {
        if coarser.cells() >= finer.cells() || !coarser.spans(finer) {
            return false;
        }
        let [mut between, mut strongest, mut waves_between] = [0.0; 3];
        let [mut outside, mut waves_outside] = [0.0; 2];
        for &(k, p) in self.0.iter().filter(|(k, _)| !finer.holds(*k)) {
            if coarser.holds(k) {
                between += p;
                strongest = f64::max(strongest, p);
                waves_between += 1.0;
            } else {
                outside += p;
                waves_outside += 1.0;
            }
        }
        // Powers of noise are spread exponentially: the largest of n is near ln n times their mean.
        let by_chance =
            outside / f64::max(waves_outside, 1.0) * (f64::ln(f64::max(waves_between, 1.0)) + BEYOND_CHANCE);
        between > LEAST_BETWEEN * self.sum() && strongest > by_chance
    }

    /// Part that repeats with a lattice, and its standard errors.
    fn repeating(&self, torus: &Torus) -> (f64, f64) {
        let (mut held, mut all, mut squares) = (0.0, 0.0, 0.0);
        for &(k, p) in &self.0 {
            held += if torus.holds(k) { p } else { 0.0 };
            all += p;
            squares += p * p;
        }
        let chance = 1.0 / torus.cells();
        let q = (held / all - chance) / (1.0 - chance);
        (q, q * ((torus.cells() - 1.0) * all * all / squares).sqrt())
    }
}

/// The smallest wave on the line of a wave.
fn direction([kx, ky]: [i32; 2]) -> [i32; 2] {
    let (mut p, mut q) = (kx.abs(), ky.abs());
    while q != 0 {
        (p, q) = (q, p % q);
    }
    [kx / p, ky / p]
}

/// The lattice of most cells of those at which nearly as much repeats as at any and that leave out
/// no waves of another; its merit.
fn best(waves: &Waves, powers: &Waves, lattices: &[Torus]) -> Option<(Torus, f64)> {
    let across = waves.across();
    let clear = lattices.iter().filter_map(|torus| {
        let ((q, merit), (q_across, merit_across)) = (waves.repeating(torus), across.repeating(torus));
        let enough = q >= LEAST_REPEATING && q_across >= LEAST_REPEATING;
        (enough && merit >= MERIT_LIMIT && merit_across >= ACROSS_LIMIT).then_some((torus, q, merit))
    });
    let clear: Vec<_> = clear.collect();
    let most = clear.iter().map(|(_, q, _)| *q).fold(0.0, f64::max);
    let (factor, more) = AS_GOOD;
    let mut good: Vec<_> = clear.iter().filter(|(_, q, _)| 1.0 - q <= factor * (1.0 - most) + more).collect();
    good.sort_by(|x, y| (y.0.cells(), y.1).partial_cmp(&(x.0.cells(), x.1)).unwrap_or(Ordering::Equal));
    let whole = |torus: &Torus| lattices.iter().all(|coarser| !powers.shows_between(coarser, torus));
    let finest = good.into_iter().find(|(torus, ..)| whole(torus));
    finest.map(|(torus, _, merit)| (**torus, *merit))
}
