//! Patterns that repeat along one direction: corrugated sheets, ribs, borders of ornaments.
//!
//! The thesis asks for two translations (ch. 7); many surfaces have one. Every direction and length
//! is tried:
//!
//! 1. *Score.* Weighted mean depth of the feature matrix at all multiples of a translation in
//!    reach, at least [`LEAST_MULTIPLES`].
//! 2. *Choose.* The shortest translation that scores nearly as well as the best, and halfway
//!    between whose multiples the picture fits clearly worse: else any small shift along a stripe
//!    would do.
//! 3. *Stripes.* If every shift across the translation fits too, the pattern is a profile, and the
//!    translation is turned to be perpendicular to the stripes.
//! 4. *Average.* The strip one translation long is the mean of all in the picture.
//!
//! Its symmetry is one of the seven frieze groups (`frieze_group`).

use super::cell::read;
use super::detrend::{decimated, detrended};
use super::feature_matrix::feature_matrix;
use super::frieze_group::{FriezeGroup, frieze_group};
use super::lattice::{combine, length};
use super::minima::Fit;
use super::search::{SEARCH_SIDE, SMALLEST_SIDE};
use asperity_surface::raster::Raster;
use serde::Serialize;

/// Multiples of a translation that must lie in reach.
const LEAST_MULTIPLES: usize = 3;

/// Shortest translation, texels of the (decimated) picture.
const SHORTEST: f64 = 4.0;

/// Least mean depth at the multiples: half of the picture's variance repeats.
const LEAST_DEPTH: f64 = 0.5;

/// A shorter translation that fits this share of the best is taken.
const AS_GOOD: f64 = 0.9;

/// Largest depth halfway between the multiples, relative.
const MOST_BETWEEN: f64 = 0.8;

/// Directions that are tried over half a turn.
const DIRECTIONS: usize = 360;

/// Pattern that repeats along one direction only.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Frieze {
    /// The translation, texels; it points right, or straight down.
    pub t_px: [f64; 2],
    /// Share of the picture's variance that repeats, 0.5–1.
    pub confidence: f64,
    /// True where the pattern is constant all along its stripes.
    pub stripes: bool,
    /// Symmetry of the strip.
    pub group: FriezeGroup,
    /// Number of strips that the primitive averages.
    pub repeats: usize,
    /// One strip, its mean the picture's: columns along the translation, rows (a texel high) along
    /// its perpendicular, turned clockwise as seen on the picture. Of stripes it is as high as
    /// long.
    #[serde(skip)]
    pub primitive: Raster,
}

/// The one direction in which a picture repeats, for pictures whose pattern does not repeat along
/// two ([`super::find_lattice`]); values should be finite. At least six repeats must be in the
/// picture.
#[must_use]
pub fn find_frieze(picture: &Raster) -> Option<Frieze> {
    let side = picture.width.min(picture.height);
    if side < SMALLEST_SIDE {
        return None;
    }
    let factor = (side / SEARCH_SIDE).max(1);
    let level = detrended(&decimated(picture, factor));
    let fit = Fit::new(&feature_matrix(&level))?;
    let best = shortest_good(&fit)?;
    let stripes = fits_across(&fit, best);
    let found = if stripes { across_stripes(&fit, best) } else { polished(&fit, best, 0.5) };
    let confidence = score(&fit, found, 0.0)?.min(1.0);
    let t_px = found.map(|c| c * factor as f64);
    let (mut primitive, repeats) = strip(&detrended(picture), t_px, stripes);
    let group = frieze_group(&primitive, stripes);
    let mean = picture.mean();
    primitive = primitive.map(|v| v + mean);
    Some(Frieze { t_px, confidence, stripes, group, repeats, primitive })
}

/// Weighted mean depth at the multiples m + `offset` of a translation; nothing with too few in
/// reach.
fn score(fit: &Fit, t: [f64; 2], offset: f64) -> Option<f64> {
    let near = 0.5 * fit.reach()[0].min(fit.reach()[1]);
    let (mut sum, mut weights, mut count) = (0.0, 0.0, 0);
    for m in 0.. {
        let shift = combine(t, t, f64::from(m) + if offset == 0.0 { 1.0 } else { offset }, 0.0);
        let Some(depth) = fit.at(shift) else { break };
        let weight = 1.0 / (1.0 + (length(shift) / near).powi(2));
        sum += weight * depth;
        weights += weight;
        count += 1;
    }
    (count >= LEAST_MULTIPLES).then(|| sum / weights)
}

/// The shortest translation of nearly the best score that is no small part of one.
fn shortest_good(fit: &Fit) -> Option<[f64; 2]> {
    let longest = fit.reach()[0].max(fit.reach()[1]) / LEAST_MULTIPLES as f64;
    let mut scored: Vec<([f64; 2], f64)> = Vec::new();
    for direction in 0..DIRECTIONS {
        // From straight up over right to straight down.
        let turn = std::f64::consts::PI * ((direction + 1) as f64 / DIRECTIONS as f64 - 0.5);
        let mut size = SHORTEST;
        while size <= longest {
            let t = [size * turn.cos(), size * turn.sin()];
            if let Some(depth) = score(fit, t, 0.0).filter(|depth| *depth >= LEAST_DEPTH) {
                let between = score(fit, t, 0.5).unwrap_or(depth);
                if between < MOST_BETWEEN * depth {
                    scored.push((t, depth));
                }
            }
            size += 0.5;
        }
    }
    let best = scored.iter().map(|(_, depth)| *depth).fold(0.0, f64::max);
    let good = scored.into_iter().filter(|(_, depth)| *depth >= AS_GOOD * best);
    good.map(|(t, _)| t).min_by(|a, b| length(*a).total_cmp(&length(*b)))
}

/// Tests whether shifts across a translation fit as well as it does.
fn fits_across(fit: &Fit, t: [f64; 2]) -> bool {
    let across = ridge(fit, t);
    let depths: Vec<f64> = (1..).map_while(|k| fit.at(combine(across, across, f64::from(k), 0.0))).collect();
    let mean = depths.iter().sum::<f64>() / depths.len().max(1) as f64;
    depths.len() >= 8 && mean >= AS_GOOD * score(fit, t, 0.0).unwrap_or(f64::INFINITY)
}

/// The direction near the perpendicular of a translation along which shifts fit best, four texels
/// long.
fn ridge(fit: &Fit, t: [f64; 2]) -> [f64; 2] {
    let start = (t[0]).atan2(-t[1]);
    let mean = |turn: f64| {
        let step = [4.0 * turn.cos(), 4.0 * turn.sin()];
        let depths: Vec<f64> = (1..).map_while(|k| fit.at(combine(step, step, f64::from(k), 0.0))).collect();
        depths.iter().sum::<f64>() / depths.len().max(1) as f64
    };
    let mut best = (start, mean(start));
    for width in [0.04, 0.01, 0.002_f64] {
        let centre = best.0;
        for k in -8..=8 {
            let turn = centre + width * f64::from(k);
            let depth = mean(turn);
            if depth > best.1 {
                best = (turn, depth);
            }
        }
    }
    [4.0 * best.0.cos(), 4.0 * best.0.sin()]
}

/// The translation perpendicular to the stripes, of the length that fits best.
fn across_stripes(fit: &Fit, t: [f64; 2]) -> [f64; 2] {
    let along = ridge(fit, t);
    let normal = pointing_right([along[1] / 4.0, -along[0] / 4.0]);
    let turned = normal.map(|c| c * (t[0] * normal[0] + t[1] * normal[1]).abs());
    polished(fit, turned, 0.0)
}

/// A translation moved to where its multiples fit best, a little at a time; `sideways` 0 keeps its
/// direction.
fn polished(fit: &Fit, start: [f64; 2], sideways: f64) -> [f64; 2] {
    let mut best = start;
    for step in [0.3, 0.1, 0.03, 0.01] {
        for _ in 0..10 {
            let size = length(best);
            let along = best.map(|c| c / size);
            let across = [-along[1] * sideways, along[0] * sideways];
            let moved = [-1.0, 0.0, 1.0].into_iter().flat_map(|i| [-1.0, 0.0, 1.0].map(|j| (i, j)));
            let tried = moved.map(|(i, j)| {
                let t = combine(best, combine(along, across, i, j), 1.0, step);
                (t, score(fit, t, 0.0).unwrap_or(f64::NEG_INFINITY))
            });
            let here = score(fit, best, 0.0).unwrap_or(f64::NEG_INFINITY);
            match tried.max_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((t, depth)) if depth > here => best = t,
                _ => break,
            }
        }
    }
    pointing_right(best)
}

/// Direction or its opposite, to the right or straight down.
fn pointing_right(t: [f64; 2]) -> [f64; 2] {
    if t[0] < -1e-3 * t[1].abs() || (t[0].abs() <= 1e-3 * t[1].abs() && t[1] < 0.0) {
        t.map(|c| -c)
    } else {
        t
    }
}

/// The mean of all strips of a picture, and how many there are.
fn strip(level: &Raster, t: [f64; 2], stripes: bool) -> (Raster, usize) {
    let size = length(t);
    let along = t.map(|c| c / size);
    let across = [-along[1], along[0]];
    let corners = [[0.0, 0.0], [level.width as f64, 0.0], [0.0, level.height as f64]];
    let corners = corners.into_iter().chain([[level.width as f64, level.height as f64]]);
    let range = |axis: [f64; 2]| {
        let at = corners.clone().map(|c| c[0] * axis[0] + c[1] * axis[1]);
        (at.clone().fold(f64::INFINITY, f64::min), at.fold(f64::NEG_INFINITY, f64::max))
    };
    let ((first, last), (low, high)) = (range(along), range(across));
    let columns = (size.round() as usize).max(4).next_multiple_of(4);
    let rows = (high - low).floor() as usize;
    let mut sums = vec![0.0; columns * rows];
    let mut counts = vec![0_usize; columns * rows];
    let (from, to) = ((first / size).floor() as i64, (last / size).ceil() as i64);
    for y in 0..rows {
        for x in 0..columns {
            for m in from..=to {
                let (p, q) = (size * (m as f64 + x as f64 / columns as f64), low + y as f64);
                if let Some(value) = read(level, combine(along, across, p, q)) {
                    sums[y * columns + x] += value;
                    counts[y * columns + x] += 1;
                }
            }
        }
    }
    if stripes {
        let column = |x: usize| {
            let count: usize = (0..rows).map(|y| counts[y * columns + x]).sum();
            (0..rows).map(|y| sums[y * columns + x]).sum::<f64>() / count.max(1) as f64
        };
        let profile: Vec<f64> = (0..columns).map(column).collect();
        let repeats = ((last - first) / size) as usize;
        return (Raster::from_fn(columns, columns, |x, _| profile[x]), repeats);
    }
    // Rows that no full strip crosses are left out at both ends.
    let full = |y: &usize| counts[y * columns..(y + 1) * columns].iter().all(|&n| n > 0);
    let kept: Vec<usize> = (0..rows).filter(full).collect();
    let repeats = kept.iter().map(|&y| counts[y * columns]).max().unwrap_or(0);
    let cell = Raster::from_fn(columns, kept.len(), |x, y| {
        sums[kept[y] * columns + x] / counts[kept[y] * columns + x] as f64
    });
    (cell, repeats)
}
