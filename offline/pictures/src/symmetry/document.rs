//! The lattice as the thesis finds it, with the settings its user tunes: for comparison with
//! [`super::find_lattice`], which has none.
//!
//! 1. Minima of the feature matrix at or below a threshold are a cloud of points.
//! 2. The two directions q1, q2 in which the cloud, projected, is most concentrated: (1/n²) Σ_ij
//!    e^{−λ|a_i − a_j|} (Def. 7.8), at least [`APART_DEG`] from each other.
//! 3. Along q1 the length is where the sum of normal distributions over all distances of the cloud,
//!    projected in the direction q2, is largest; along q2 the same.
//!
//! | symbol | here |
//! |---|---|
//! | threshold | [`DocumentSearch::threshold`], share of the matrix's median (the document's user turns a slider) |
//! | λ | [`LAMBDA_PER_PX`] (not printed; ours) |
//! | σ of the normals | [`SIGMA_PX`] (not printed; ours) |
//! | mean (squared) distortion, Def. 7.7 | [`Distortion`] |

use super::detrend::decimated;
use super::feature_matrix::{Distortion, FeatureMatrix, absolute_feature_matrix, feature_matrix};
use super::lattice::{Lattice, combine, length, reduced, solve, upright};
use super::search::SMALLEST_SIDE;
use asperity_surface::raster::Raster;

/// Fall of the concentration with the distance, 1/texel.
pub const LAMBDA_PER_PX: f64 = 0.5;

/// Deviation of the normal distribution that a distance stands for, texels.
pub const SIGMA_PX: f64 = 1.0;

/// Least angle between the two directions, degrees.
pub const APART_DEG: usize = 15;

/// Shifts up to this many texels are no minima of a pattern: every picture fits itself there.
const SHORTEST: f64 = 4.0;

/// Most points of the cloud, the deepest first.
const MOST_POINTS: usize = 300;

/// Larger pictures are averaged down: the absolute distortion is summed shift by shift.
const LARGEST_SIDE: usize = 256;

/// Parameters that the method's user tunes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DocumentSearch {
    /// Which distortion is averaged.
    pub distortion: Distortion,
    /// Minima up to this share of the matrix's median count, 0–1. The best fixed one moves from 0.3
    /// to 0.85 between clean and noisy patterns.
    pub threshold: f64,
}

impl Default for DocumentSearch {
    fn default() -> Self {
        Self { distortion: Distortion::Squared, threshold: 0.5 }
    }
}

/// The lattice by the document's method; nothing where fewer than three minima are deep enough or
/// the picture is small. Its confidence is the mean depth of the matrix at the lattice's nodes, 1 −
/// distortion over median.
#[must_use]
pub fn document_lattice(picture: &Raster, search: &DocumentSearch) -> Option<Lattice> {
    let side = picture.width.min(picture.height);
    if side < SMALLEST_SIDE {
        return None;
    }
    let factor = side.div_ceil(LARGEST_SIDE);
    let small = decimated(picture, factor);
    let matrix = match search.distortion {
        Distortion::Squared => feature_matrix(&small),
        Distortion::Absolute => absolute_feature_matrix(&small),
    };
    let mut sorted = matrix.values.values.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    let cloud = cloud(&matrix, search.threshold * median);
    if cloud.len() < 6 {
        return None;
    }
    let [q1, q2] = directions(&cloud);
    let t1 = q1.map(|c| c * spacing(&cloud, q1, q2));
    let t2 = q2.map(|c| c * spacing(&cloud, q2, q1));
    let [a, b] = upright(reduced(t1, t2));
    let confidence = mean_depth(&matrix, median, [a, b]).clamp(0.0, 1.0);
    let scaled = |t: [f64; 2]| t.map(|c| c * factor as f64);
    Some(Lattice { t1_px: scaled(a), t2_px: scaled(b), confidence })
}

/// Local minima at or below a limit, with their mirror images.
fn cloud(matrix: &FeatureMatrix, limit: f64) -> Vec<[f64; 2]> {
    let (reach_x, reach_y) = (matrix.reach_x as isize, matrix.reach_y as isize);
    let mut found: Vec<([f64; 2], f64)> = Vec::new();
    for dy in -reach_y + 1..reach_y {
        for dx in -reach_x + 1..reach_x {
            let (here, shift) = (matrix.at(dx, dy), [dx as f64, dy as f64]);
            let neighbours = (-1..=1).flat_map(|j| (-1..=1).map(move |i| (i, j)));
            // Of equals the first in reading order.
            let lowest = |(i, j): (isize, isize)| {
                let other = matrix.at(dx + i, dy + j);
                other > here || (other == here && (j, i) >= (0, 0))
            };
            if here <= limit && length(shift) >= SHORTEST && neighbours.into_iter().all(lowest) {
                found.push((shift, here));
            }
        }
    }
    found.sort_by(|a, b| a.1.total_cmp(&b.1).then(length(a.0).total_cmp(&length(b.0))));
    found.into_iter().take(MOST_POINTS).map(|(shift, _)| shift).collect()
}

/// The direction of the greatest concentration, and of the greatest that is clearly another.
fn directions(cloud: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let at = |degree: usize| {
        let turn = (degree as f64).to_radians();
        [turn.cos(), turn.sin()]
    };
    let concentration = |q: [f64; 2]| {
        let projected: Vec<f64> = cloud.iter().map(|p| p[1] * q[0] - p[0] * q[1]).collect();
        let pair = |a: &f64| projected.iter().map(|b| (-LAMBDA_PER_PX * (a - b).abs()).exp()).sum::<f64>();
        projected.iter().map(pair).sum::<f64>()
    };
    let all: Vec<f64> = (0..180).map(|degree| concentration(at(degree))).collect();
    let best = |apart: &dyn Fn(usize) -> bool| {
        let degrees = (0..180).filter(|degree| apart(*degree));
        degrees.max_by(|a, b| all[*a].total_cmp(&all[*b])).unwrap_or(0)
    };
    let first = best(&|_| true);
    let between = |degree: usize| degree.abs_diff(first).min(180 - degree.abs_diff(first));
    [at(first), at(best(&|degree| between(degree) >= APART_DEG))]
}

/// The most likely distance along `q` of points projected in the direction `other`, texels.
fn spacing(cloud: &[[f64; 2]], q: [f64; 2], other: [f64; 2]) -> f64 {
    let places: Vec<f64> = cloud.iter().map(|p| solve(q, other, *p)[0]).collect();
    let pairs = places.iter().enumerate().flat_map(|(i, a)| places[..i].iter().map(move |b| (a - b).abs()));
    let distances: Vec<f64> = pairs.filter(|d| *d >= SHORTEST).collect();
    let likely = |d: f64| distances.iter().map(|e| (-0.5 * ((d - e) / SIGMA_PX).powi(2)).exp()).sum::<f64>();
    let longest = distances.iter().copied().fold(SHORTEST, f64::max);
    let tried = (0..).map(|k| SHORTEST + 0.25 * f64::from(k)).take_while(|d| *d <= longest);
    tried.map(|d| (d, likely(d))).max_by(|a, b| a.1.total_cmp(&b.1)).map_or(SHORTEST, |(d, _)| d)
}

/// Mean of 1 − distortion over median at the nodes in reach.
fn mean_depth(matrix: &FeatureMatrix, median: f64, [a, b]: [[f64; 2]; 2]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    let most = (matrix.reach_x.max(matrix.reach_y) as f64 / length(a)).ceil() as i64 + 1;
    for (m, n) in (-most..=most).flat_map(|m| (-most..=most).map(move |n| (m, n))) {
        let node = combine(a, b, m as f64, n as f64).map(|c| c.round() as isize);
        let inside = node[0].unsigned_abs() <= matrix.reach_x && node[1].unsigned_abs() <= matrix.reach_y;
        if inside && (m, n) != (0, 0) {
            sum += 1.0 - matrix.at(node[0], node[1]) / median.max(f64::MIN_POSITIVE);
            count += 1.0;
        }
    }
    sum / f64::max(count, 1.0)
}
