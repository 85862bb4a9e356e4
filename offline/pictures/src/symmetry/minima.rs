//! Minima of the feature matrix: the shifts at which a picture fits itself best.

use super::detrend::blurred;
use super::feature_matrix::FeatureMatrix;
use asperity_surface::raster::Raster;

/// Standard deviation of the blur that keeps a noisy floor from breaking one minimum into many,
/// texels.
const BLUR: f64 = std::f64::consts::SQRT_2;

/// A minimum must be the lowest within this many texels along x and y.
const APART: usize = 2;

/// A shift of good fit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Minimum {
    /// The shift, texels.
    pub shift: [f64; 2],
    /// 1 − distortion over the matrix's median: 1 for a perfect fit, 0 for an ordinary shift.
    pub depth: f64,
}

/// Fit of shifts: 1 − SFM over its median, blurred, and readable between texels.
pub(super) struct Fit {
    depth: Raster,
    reach: [f64; 2],
    /// Mean over all shifts.
    pub mean: f64,
    /// Standard deviation over all shifts.
    pub deviation: f64,
}

impl Fit {
    /// Nothing if every shift fits perfectly: a picture without relief.
    pub fn new(matrix: &FeatureMatrix) -> Option<Self> {
        Self::blurred(matrix, BLUR)
    }

    /// Fit with a blur of one texel, for minima that are known to be there: less of it, less of a
    /// lopsided neighbourhood pulls at them.
    pub fn sharp(matrix: &FeatureMatrix) -> Option<Self> {
        Self::blurred(matrix, 1.0)
    }

    fn blurred(matrix: &FeatureMatrix, sigma: f64) -> Option<Self> {
        let mut sorted = matrix.values.values.clone();
        let middle = sorted.len() / 2;
        let (_, &mut median, _) = sorted.select_nth_unstable_by(middle, f64::total_cmp);
        if median <= 0.0 {
            return None;
        }
        let depth = blurred(&matrix.values, sigma).map(|v| 1.0 - v / median);
        let mean = depth.mean();
        let variance =
            depth.values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / depth.values.len() as f64;
        Some(Self {
            depth,
            reach: [matrix.reach_x as f64, matrix.reach_y as f64],
            mean,
            deviation: variance.sqrt(),
        })
    }

    /// Depth at a shift by cubic (Catmull–Rom) reading; nothing beyond the reach.
    pub fn at(&self, shift: [f64; 2]) -> Option<f64> {
        let (x, y) = (shift[0] + self.reach[0], shift[1] + self.reach[1]);
        let (left, top) = (x.floor(), y.floor());
        let inside = left >= 1.0
            && top >= 1.0
            && left + 2.0 < self.depth.width as f64
            && top + 2.0 < self.depth.height as f64;
        if !inside {
            return None;
        }
        let (across, down) = (cubic_weights(x - left), cubic_weights(y - top));
        let (i, j) = (left as usize - 1, top as usize - 1);
        let row = |j: usize| {
            let texels = &self.depth.row(j)[i..i + 4];
            texels.iter().zip(across).map(|(d, w)| d * w).sum::<f64>()
        };
        Some((0..4).map(|k| down[k] * row(j + k)).sum())
    }

    /// Largest shift along x and y, texels.
    pub fn reach(&self) -> [f64; 2] {
        self.reach
    }

    /// All minima in the right half plane, deepest first; the others are their mirror images.
    /// Shifts shorter than `shortest` are left out.
    pub fn minima(&self, shortest: f64) -> Vec<Minimum> {
        let depth = &self.depth;
        let mut found = Vec::new();
        for y in APART..depth.height - APART {
            for x in APART..depth.width - APART {
                let shift = [x as f64 - self.reach[0], y as f64 - self.reach[1]];
                let right = shift[0] > 0.0 || (shift[0] == 0.0 && shift[1] > 0.0);
                if right && shift[0].hypot(shift[1]) >= shortest && self.is_peak(x, y) {
                    let (offset, value) = self.vertex(x, y);
                    found.push(Minimum { shift: [shift[0] + offset[0], shift[1] + offset[1]], depth: value });
                }
            }
        }
        found.sort_by(|a, b| b.depth.total_cmp(&a.depth));
        found
    }

    fn is_peak(&self, x: usize, y: usize) -> bool {
        let here = self.depth.at(x, y);
        for j in y - APART..=y + APART {
            for i in x - APART..=x + APART {
                let other = self.depth.at(i, j);
                // Of equals the first in reading order is the peak.
                if other > here || (other == here && (j, i) < (y, x)) {
                    return false;
                }
            }
        }
        true
    }

    /// Vertex of the paraboloid through the neighbours: offset within half a texel, and depth
    /// there.
    fn vertex(&self, x: usize, y: usize) -> ([f64; 2], f64) {
        let d = |i: isize, j: isize| self.depth.at(x.wrapping_add_signed(i), y.wrapping_add_signed(j));
        let here = d(0, 0);
        let (gx, gy) = (0.5 * (d(1, 0) - d(-1, 0)), 0.5 * (d(0, 1) - d(0, -1)));
        let (cx, cy) = (d(1, 0) - 2.0 * here + d(-1, 0), d(0, 1) - 2.0 * here + d(0, -1));
        let mixed = 0.25 * (d(1, 1) - d(-1, 1) - d(1, -1) + d(-1, -1));
        let determinant = cx * cy - mixed * mixed;
        if determinant <= 0.0 {
            return ([0.0; 2], here);
        }
        let offset = [(mixed * gy - cy * gx) / determinant, (mixed * gx - cx * gy) / determinant]
            .map(|o| o.clamp(-0.5, 0.5));
        (offset, here + 0.5 * (gx * offset[0] + gy * offset[1]))
    }
}

/// Catmull–Rom weights of the four texels round a point a fraction `t` behind the second.
pub(super) fn cubic_weights(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        0.5 * (-t + 2.0 * t2 - t3),
        0.5 * (2.0 - 5.0 * t2 + 3.0 * t3),
        0.5 * (t + 4.0 * t2 - 3.0 * t3),
        0.5 * (t3 - t2),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::feature_matrix::feature_matrix;
    use super::*;

    #[test]
    fn the_deepest_minima_of_a_grid_are_its_periods() {
        let turn = std::f64::consts::TAU;
        let (px, py) = (13.4, 17.7);
        let grid =
            Raster::from_fn(128, 128, |x, y| (turn * x as f64 / px).cos() + (turn * y as f64 / py).cos());
        let fit = Fit::new(&feature_matrix(&grid)).unwrap();
        let minima = fit.minima(4.0);
        for period in [[px, 0.0], [0.0, py], [px, py]] {
            let near = minima
                .iter()
                .map(|m| (m.shift[0] - period[0]).hypot(m.shift[1] - period[1]))
                .fold(f64::INFINITY, f64::min);
            assert!(near < 0.1, "{period:?}: {near}");
        }
        assert!(Fit::new(&feature_matrix(&Raster::constant(32, 32, 1.0))).is_none());
    }
}
