//! Lattice search among the minima of the feature matrix, which may find none.
//!
//! The document cuts the minima with a threshold its user tunes, and no threshold serves all
//! pictures: the best fixed one moves from 0.3 to 0.85 between clean and noisy patterns. Ours has
//! none:
//!
//! 1. *Sweep.* The deepest n minima, n in `SWEEP`, and those down to a share of the deepest, each
//!    give candidates: all pairs of the shortest among them, reduced.
//! 2. *Refine.* Each candidate is fitted to the minima near its nodes by least squares, outwards
//!    from the centre.
//! 3. *Score.* Mean depth of the matrix over the nodes beyond the first ring, near ones counting
//!    more (a warped pattern loses its far nodes first), over its mean, in standard errors of as
//!    many random shifts. Chance minima propose, but do not predict others.
//! 4. *Choose.* The best score among the even ones: a multiple of the true cell has fewer nodes, so
//!    its score is lower; a fraction of it is uneven, that is, the nodes outside one of its coarser
//!    lattices fit worse than those on it.
//! 5. *Refuse* scores below [`MERIT_LIMIT`], and lattices at whose half translations the picture
//!    fits nearly as well, however often they are halved: stripes fit themselves at any shift along
//!    them. Then the next best are tried.
//!
//!    So are pictures whose waves of a translation's length have every direction.
//! 6. *Coarsen.* A lattice is given up for a coarser one, of up to nine times its cell a step,
//!    whose nodes fit better than can be chance: a cell with two nearly equal halves, or frames
//!    whose gap is a quarter of their period, which fit themselves in part at every quarter. So it
//!    is for any other larger cell that was proposed: a gap and a side that are no multiples of
//!    each other have no fraction in common.
//! 7. *Sharpen.* The basis is fitted again where the border of the picture counts less.
//!
//! Measured (`analysis_table lattice`, five kinds, 24 patterns each, 256²): all right under noise
//! to σ = 2, gradient and warp of 1 texel, 0.992 under warp of 2 texels (0.988 of 240 other
//! patterns). All of 1064 squares in frames (`analysis_table framed`), of which 38 in 864 were once
//! given a quarter or a fifth of their lattice.

use super::detrend::{decimated, detrended};
use super::every_direction::has_waves_of_every_direction;
use super::feature_matrix::{feature_matrix, tapered_feature_matrix};
use super::lattice::{Lattice, combine, cross, length, reduced, upright};
use super::minima::{Fit, Minimum};
use super::nodes::{CLEARLY_UNEVEN, COARSER, Mean, Nodes, coarser, coarser_lattices, for_each_node};
use super::torus::tiling_lattice;
use asperity_surface::raster::Raster;

/// Numbers of deepest minima that propose lattices.
const SWEEP: [usize; 16] = [2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64, 91, 128, 181, 256, 362];

/// Depths, as a share of the deepest, down to which minima propose lattices.
const DEPTH_SWEEP: [f64; 6] = [0.95, 0.9, 0.8, 0.65, 0.5, 0.35];

/// Number of the shortest of each of them that are paired.
const PAIRED: usize = 7;

/// The nodes outside every coarser lattice must fit at least this well, relative to those on it.
const EVEN_LIMIT: f64 = 0.89;

/// Half translations that fit better than this share of the nodes mean that the pattern does not
/// repeat in one of the directions, or on no scale we can see. Above [`EVEN_LIMIT`]: what is too
/// uneven to divide the cell must not refuse it.
const HALF_LIMIT: f64 = 0.92;

/// Cells this many times as large are no other fit of the same.
const LARGER: f64 = 1.2;

/// Most candidates that are tried, the best first, before a picture is taken not to repeat along
/// two directions.
const MOST_TRIED: usize = 8;

/// Shortest translation, texels of the (decimated) picture.
const SHORTEST: f64 = 4.0;

/// Pictures are averaged down until the shorter side is at most twice this, texels.
pub(super) const SEARCH_SIDE: usize = 384;

/// Cells in a picture up to which its lattice is sharpened. With more the border does not matter.
const FEW_CELLS: f64 = 3000.0;

/// Smallest width and height in which a pattern is sought, texels.
pub const SMALLEST_SIDE: usize = 24;

/// The merit at which a lattice is as likely as none, standard errors. Of 312 pictures without a
/// pattern (Brownian surfaces, blobs, packed grains, stripes, white noise) none reaches 3.8;
/// patterns with 7 periods or more reach 5.9 under any stress of the table, with 5 periods about 5.
pub const MERIT_LIMIT: f64 = 5.0;

/// The lattice of a picture's pattern, or nothing if no pattern repeats along two directions. There
/// is no threshold to tune; values should be finite, their unit does not matter. Five repeats a
/// side are needed, two of a map that tiles.
#[must_use]
pub fn find_lattice(picture: &Raster) -> Option<Lattice> {
    let found = best_lattice(picture).filter(|lattice| lattice.confidence >= 0.5);
    found.or_else(|| tiling_lattice(picture))
}

/// The best lattice there is, however unlikely; nothing for pictures that are flat or small.
#[must_use]
pub fn best_lattice(picture: &Raster) -> Option<Lattice> {
    let side = picture.width.min(picture.height);
    if side < SMALLEST_SIDE {
        return None;
    }
    let factor = (side / SEARCH_SIDE).max(1);
    let whole = search(&decimated(picture, factor), factor as f64);
    if factor == 1 || whole.is_some_and(|lattice| lattice.confidence >= 0.5) {
        return whole;
    }
    // Averaging may have washed a fine pattern out: look at the middle at full resolution.
    let middle = search(&central(picture, 2 * SEARCH_SIDE), 1.0);
    [whole, middle].into_iter().flatten().max_by(|a, b| a.confidence.total_cmp(&b.confidence))
}

/// The middle of a picture, at most `side` texels wide and high.
fn central(picture: &Raster, side: usize) -> Raster {
    let (width, height) = (picture.width.min(side), picture.height.min(side));
    let (left, top) = ((picture.width - width) / 2, (picture.height - height) / 2);
    Raster::from_fn(width, height, |x, y| picture.at(left + x, top + y))
}

/// The best lattice of a picture, its translations multiplied by `scale`.
fn search(picture: &Raster, scale: f64) -> Option<Lattice> {
    let level = detrended(picture);
    let fit = Fit::new(&feature_matrix(&level))?;
    let minima = fit.minima(SHORTEST);
    let scored = candidates(&fit, &minima);
    let mut even: Vec<Candidate> = scored.iter().copied().filter(|c| c.even).collect();
    even.sort_by(|a, b| b.merit.total_cmp(&a.merit));
    let mut tried = even.iter().take(MOST_TRIED).map(|&best| {
        let chosen = coarse_enough(&fit, &minima, finest(&fit, &minima, best));
        let chosen = outdone(&fit, &chosen, &scored).map_or(chosen, |o| coarse_enough(&fit, &minima, o));
        divided(&fit, &minima, chosen)
    });
    // The first that repeats along two directions; else the best, with no merit at all.
    let (chosen, merit) = match tried.find(|(_, repeats)| *repeats) {
        Some((found, _)) if has_waves_of_every_direction(&level, length(found.basis[0])) => (found, 0.0),
        Some((found, _)) => (found, found.merit),
        None => (*even.first()?, 0.0),
    };
    let confidence = confidence(merit);
    let sharp = if confidence < 0.5 { chosen.basis } else { sharpened(&level, chosen.basis) };
    let [t1_px, t2_px] = upright(sharp).map(|t| [t[0] * scale, t[1] * scale]);
    Some(Lattice { t1_px, t2_px, confidence })
}

/// The basis of a picture of few cells, fitted again where its border counts less: a mark that the
/// border cuts fits better a little further out, and pulls the minima there. (Five cells of 16
/// texels: 16.17 before, 16.02 after.)
fn sharpened(even: &Raster, basis: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let cells = (even.width * even.height) as f64 / cross(basis[0], basis[1]).abs();
    if cells > FEW_CELLS {
        return basis;
    }
    let again = Fit::sharp(&tapered_feature_matrix(even))
        .and_then(|fit| refined(&fit, &fit.minima(SHORTEST), basis))
        .filter(|again| near(again, &basis));
    again.unwrap_or(basis)
}

/// Tests whether two bases span one lattice to a tenth of a cell.
fn near(a: &[[f64; 2]; 2], b: &[[f64; 2]; 2]) -> bool {
    let whole =
        |t: &[f64; 2]| super::lattice::solve(b[0], b[1], *t).iter().all(|c| (c - c.round()).abs() < 0.1);
    let area = cross(a[0], a[1]) / cross(b[0], b[1]);
    a.iter().all(whole) && (area.abs() - 1.0).abs() < 0.2
}

/// 0 for no merit, 0.5 at the limit, towards 1 beyond.
fn confidence(merit: f64) -> f64 {
    let odds = (merit.max(0.0) / MERIT_LIMIT).powi(2);
    odds / (1.0 + odds)
}

/// A lattice and how well it fits.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    basis: [[f64; 2]; 2],
    /// Weighted mean depth over all nodes.
    score: f64,
    /// Mean depth at the nodes that did not propose the lattice, in standard errors of as many
    /// random shifts.
    merit: f64,
    /// True where no coarser lattice holds all the good nodes.
    even: bool,
}

/// All lattices that the sweep proposes, refined and scored.
fn candidates(fit: &Fit, minima: &[Minimum]) -> Vec<Candidate> {
    let mut found: Vec<Candidate> = Vec::new();
    let mut tried: Vec<[[f64; 2]; 2]> = Vec::new();
    // By number, and by depth: where thousands of nodes are equally deep, no number of them holds
    // the shortest.
    let deepest = minima.first().map_or(0.0, |m| m.depth);
    let by_depth = DEPTH_SWEEP.map(|share| minima.partition_point(|m| m.depth >= share * deepest));
    for count in SWEEP.into_iter().filter(|n| *n < 2 * minima.len()).chain(by_depth) {
        let mut shortest: Vec<&Minimum> = minima.iter().take(count).collect();
        shortest.sort_by(|a, b| length(a.shift).total_cmp(&length(b.shift)));
        shortest.truncate(PAIRED);
        for (i, a) in shortest.iter().enumerate() {
            for b in &shortest[..i] {
                let Some(basis) = usable(fit, a.shift, b.shift) else { continue };
                if tried.iter().any(|other| same(other, &basis)) {
                    continue;
                }
                tried.push(basis);
                if let Some(candidate) = refined(fit, minima, basis).and_then(|refined| scored(fit, refined))
                {
                    found.push(candidate);
                }
            }
        }
    }
    found
}

/// Divides the cell by 2 or 3 as long as the finer lattice fits evenly and has more merit: the
/// sweep may have met only a multiple.
fn finest(fit: &Fit, minima: &[Minimum], start: Candidate) -> Candidate {
    let mut best = start;
    loop {
        let [a, b] = best.basis;
        let finer = COARSER.iter().filter_map(|&(k, i, j)| {
            // (i·a + j·b)/k together with the old basis: replace the translation it depends on.
            let between = combine(a, b, i / k, j / k);
            let other = if i == 0.0 { a } else { b };
            let basis = refined(fit, minima, usable(fit, between, other)?)?;
            scored(fit, basis).filter(|c| c.even && c.merit > best.merit)
        });
        match finer.max_by(|x, y| x.merit.total_cmp(&y.merit)) {
            // A refinement that slid back to the old cell must not loop for ever.
            Some(c) if cross(c.basis[0], c.basis[1]) < 0.7 * cross(a, b) => best = c,
            _ => return best,
        }
    }
}

/// Multiplies the cell as long as the nodes that are left out then fit worse than can be chance: a
/// cell with two nearly equal halves, or one at which only some of the pattern's lines meet others.
/// What is too even for the candidates, which must bear noise, may be clearly uneven in a clean
/// picture.
fn coarse_enough(fit: &Fit, minima: &[Minimum], start: Candidate) -> Candidate {
    let all = coarser_lattices();
    let mut best = start;
    loop {
        let [a, b] = best.basis;
        let nodes = Nodes::new(fit, best.basis);
        let contrast = all.iter().map(|split| (split, nodes.unevenness(*split)));
        let worst =
            contrast.filter(|(_, errors)| *errors > CLEARLY_UNEVEN).max_by(|x, y| x.1.total_cmp(&y.1));
        let Some((&split, _)) = worst else { return best };
        let [p, q] = coarser(a, b, split);
        let coarser = usable(fit, p, q).and_then(|t| refined(fit, minima, t)).and_then(|t| scored(fit, t));
        match coarser {
            Some(c) if cross(c.basis[0], c.basis[1]) > 1.5 * cross(a, b) => best = c,
            _ => return best,
        }
    }
}

/// The proposed lattice of a larger cell, if there is one, whose nodes fit better than this one's
/// by more than can be chance: lines that frames have in common with their neighbours fit
/// themselves at distances that divide no translation.
fn outdone(fit: &Fit, chosen: &Candidate, proposed: &[Candidate]) -> Option<Candidate> {
    let area = |c: &Candidate| cross(c.basis[0], c.basis[1]).abs();
    let nodes = Nodes::new(fit, chosen.basis);
    let larger = proposed.iter().filter(|c| area(c) > LARGER * area(chosen) && c.score > chosen.score);
    let compared = larger.map(|c| (c, nodes.worse_than(&Nodes::new(fit, c.basis))));
    let better = compared.filter(|(_, errors)| *errors > CLEARLY_UNEVEN);
    better.max_by(|x, y| x.0.merit.total_cmp(&y.0.merit)).map(|(c, _)| *c)
}

/// The reduced basis of two shifts, if a picture of this size can show it.
fn usable(fit: &Fit, a: [f64; 2], b: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let [short, long] = reduced(a, b);
    // Reduced bases have angles from 60° to 120°; flatter ones come from parallel shifts.
    let flat = cross(short, long) < 0.8 * length(short) * length(long);
    let inside = |t: [f64; 2]| t[0].abs() < fit.reach()[0] - 1.0 && t[1].abs() < fit.reach()[1] - 1.0;
    (!flat && length(short) >= SHORTEST && inside(short) && inside(long)).then_some([short, long])
}

/// Tests whether two bases differ by less than half a texel.
fn same(a: &[[f64; 2]; 2], b: &[[f64; 2]; 2]) -> bool {
    (0..2).all(|i| (a[i][0] - b[i][0]).abs() < 0.5 && (a[i][1] - b[i][1]).abs() < 0.5)
}

/// Least-squares fit of a basis to the minima near its nodes, ring by ring.
fn refined(fit: &Fit, minima: &[Minimum], start: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    let mut basis = start;
    for reach in [1.5, 2.5, 4.5, 1e9] {
        let tolerance = (0.2 * length(basis[0])).min(3.0);
        // Normal equations of Σ w |m·t1 + n·t2 − shift|², the same matrix for x and y.
        let (mut mm, mut mn, mut nn) = (0.0, 0.0, 0.0);
        let (mut m_shift, mut n_shift) = ([0.0; 2], [0.0; 2]);
        for minimum in minima.iter().filter(|m| m.depth > 0.0) {
            let [m, n] = super::lattice::solve(basis[0], basis[1], minimum.shift).map(f64::round);
            let node = combine(basis[0], basis[1], m, n);
            let miss = length(combine(node, minimum.shift, 1.0, -1.0));
            if miss > tolerance || m.abs().max(n.abs()) > reach || (m == 0.0 && n == 0.0) {
                continue;
            }
            let weight = minimum.depth;
            mm += weight * m * m;
            mn += weight * m * n;
            nn += weight * n * n;
            for axis in 0..2 {
                m_shift[axis] += weight * m * minimum.shift[axis];
                n_shift[axis] += weight * n * minimum.shift[axis];
            }
        }
        let determinant = mm * nn - mn * mn;
        if determinant <= 1e-9 * mm * nn {
            return None;
        }
        let t1 = [0, 1].map(|axis| (nn * m_shift[axis] - mn * n_shift[axis]) / determinant);
        let t2 = [0, 1].map(|axis| (mm * n_shift[axis] - mn * m_shift[axis]) / determinant);
        basis = usable(fit, t1, t2)?;
    }
    Some(basis)
}

/// Scores a basis over its nodes in the right half plane; nothing if too few are in reach.
fn scored(fit: &Fit, basis: [[f64; 2]; 2]) -> Option<Candidate> {
    let (mut all, mut predicted) = (Mean::default(), Mean::default());
    let mut split = [(); COARSER.len()].map(|()| (Mean::default(), Mean::default()));
    for_each_node(fit, basis, [0.0; 2], |m, n, depth, weight| {
        all.add(depth, weight);
        if m.abs().max(n.abs()) > 1.0 {
            predicted.add(depth, weight);
        }
        for ((inside, outside), (modulus, i, j)) in split.iter_mut().zip(COARSER) {
            let on = (i * m + j * n).rem_euclid(modulus) == 0.0;
            if on { inside.add(depth, weight) } else { outside.add(depth, weight) }
        }
    });
    let even = split.iter().all(|(inside, outside)| outside.value() >= EVEN_LIMIT * inside.value());
    (predicted.count >= 3).then(|| Candidate {
        basis,
        score: all.value(),
        merit: (predicted.value() - fit.mean) / (fit.deviation * predicted.spread()),
        even,
    })
}

/// Divides the cell as long as the nodes moved by half a translation fit nearly as well as the
/// nodes. Whether that comes to an end: a pattern that does not repeat in one of the directions has
/// no shortest translation there.
fn divided(fit: &Fit, minima: &[Minimum], start: Candidate) -> (Candidate, bool) {
    let mut best = start;
    while let Some(finer) = half_that_fits(fit, &best) {
        let again = usable(fit, finer[0], finer[1])
            .and_then(|t| refined(fit, minima, t))
            .and_then(|t| scored(fit, t));
        match again {
            Some(c) if cross(c.basis[0], c.basis[1]) < 0.7 * cross(best.basis[0], best.basis[1]) => best = c,
            _ => return (best, false),
        }
    }
    (best, true)
}

/// The finer lattice whose additional nodes, moved by half a translation, fit nearly as well as the
/// nodes, and not clearly worse.
fn half_that_fits(fit: &Fit, lattice: &Candidate) -> Option<[[f64; 2]; 2]> {
    let [a, b] = lattice.basis;
    let half = |t: [f64; 2]| [0.5 * t[0], 0.5 * t[1]];
    let (sum, difference) = (combine(a, b, 0.5, 0.5), combine(a, b, 0.5, -0.5));
    // Each with the finer lattice it makes, in which the nodes are those of a coarser one.
    let halves = [
        ([0.5, 0.0], [half(a), b], (2.0, 1.0, 0.0)),
        ([0.0, 0.5], [a, half(b)], (2.0, 0.0, 1.0)),
        ([0.5, 0.5], [sum, difference], (2.0, 1.0, 1.0)),
    ];
    let depths = halves.map(|(offset, finer, split)| {
        let mut between = Mean::default();
        for_each_node(fit, lattice.basis, offset, |_, _, depth, weight| between.add(depth, weight));
        let fits = between.value() > HALF_LIMIT * lattice.score
            && Nodes::new(fit, finer).unevenness(split) < CLEARLY_UNEVEN;
        (fits, between.value(), finer)
    });
    depths.into_iter().filter(|d| d.0).max_by(|x, y| x.1.total_cmp(&y.1)).map(|(_, _, finer)| finer)
}
