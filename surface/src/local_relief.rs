//! Local relief power: how much relief a map has about a place, at the scales of the micro-relief.
//!
//! ```text
//! P(cell) = Σ over lags s   mean over the cell of  max over u, v of  ((h(−2s) − 4h(−s) + 6h − 4h(s) + h(2s)) / 16)²
//! s       = 1, 2, 4, … texels up to 2 mm
//! ```
//! A fourth difference is the whole amplitude of a wave of 2 s and nothing of a plain or of a hill:
//! of one of 47 mm it keeps 3·10⁻⁴ at 2 mm. So P is the mean square of what the map has between two
//! texels and about 4 mm, and 0 where it is flat, whatever its resolution.

use crate::height_field::PowerKind;
use crate::raster::Raster;
use crate::tiled::floor;
use crate::wrap::Wrap;

/// Longest lag, m.
const LONGEST_LAG_M: f64 = 2e-3;
/// Cells of the picture of P along the longer side of a map.
const CELLS: usize = 128;

/// Distance in cells from the origin at which no fraction of one is left in a number.
const MOST_CELLS: f64 = 1e15;

/// P over a tile.
#[derive(Debug, Clone)]
pub(crate) struct LocalRelief {
    power_m2: Raster,
    cells_per_m: [f64; 2],
    wrap: Wrap,
}

impl LocalRelief {
    /// Relief of a map of which `height_m` makes metres, `size_m` along u and v.
    pub fn new(map: &Raster, height_m: impl Fn(f64) -> f64, size_m: [f64; 2], wrap: Wrap) -> Self {
        let (w, h) = (map.width, map.height);
        let (width, height) = (w.min(CELLS), h.min(CELLS));
        let texel_m = [size_m[0] / w as f64, size_m[1] / h as f64];
        let mut power = vec![0.0; width * height];
        let mut lag = 1;
        while lag == 1 || lag as f64 * texel_m[0].min(texel_m[1]) <= LONGEST_LAG_M {
            add_lag(map, &height_m, lag, wrap, &mut power, [width, height]);
            lag *= 2;
        }
        let power_m2 = Raster { width, height, values: power };
        Self { power_m2, cells_per_m: [width as f64 / size_m[0], height as f64 / size_m[1]], wrap }
    }

    /// Adds P at each place, m²: between the four nearest cells, which a finger shares for many
    /// samples.
    pub fn add_along(&self, position_m: &[[f64; 2]], power_m2: &mut [f64]) {
        let mut corners = Corners { left: f64::NAN, top: f64::NAN, rows_m2: [[0.0; 2]; 2] };
        for (position_m, power_m2) in position_m.iter().zip(power_m2) {
            let [x, y] = self.place(*position_m);
            if !corners.hold(x, y) {
                corners = self.corners(x, y);
            }
            *power_m2 += corners.between(x, y);
        }
    }

    /// Relief, added to nothing, of places between two corners; not one by one where all of it is
    /// 0, or `fills_m2` and more.
    pub fn along(
        &self,
        position_m: &[[f64; 2]],
        bounds_m: [[f64; 2]; 2],
        fills_m2: f64,
        power_m2: &mut [f64],
    ) -> PowerKind {
        let [low_m, high_m] = bounds_m;
        let ([x, y], [far_x, far_y]) = (self.place(low_m), self.place(high_m));
        if x.abs() < MOST_CELLS && y.abs() < MOST_CELLS {
            let corners = self.corners(x, y);
            if corners.hold(x, y) && corners.hold(far_x, far_y) {
                // All of them lie between the same four.
                let [[a, b], [c, d]] = corners.rows_m2;
                // What lies between four numbers misses their range by the rounding of its sum at
                // most.
                if [a, b, c, d].iter().all(|power_m2| *power_m2 >= (1.0 + 1e-12) * fills_m2) {
                    return PowerKind::Full;
                }
                if [a, b, c, d] == [0.0; 4] {
                    return PowerKind::None;
                }
                for (position_m, power_m2) in position_m.iter().zip(power_m2) {
                    let [x, y] = self.place(*position_m);
                    *power_m2 = corners.between(x, y);
                }
                return PowerKind::EachSample;
            }
        }
        power_m2.fill(0.0);
        self.add_along(position_m, power_m2);
        PowerKind::EachSample
    }

    #[inline(always)]
    fn place(&self, [u_m, v_m]: [f64; 2]) -> [f64; 2] {
        [u_m * self.cells_per_m[0] - 0.5, v_m * self.cells_per_m[1] - 0.5]
    }

    #[inline(always)]
    fn corners(&self, x: f64, y: f64) -> Corners {
        let Raster { width, height, ref values } = self.power_m2;
        let (left, top) = (floor(x), floor(y));
        let (column, row) = (left as i64, top as i64);
        let [a, b] = self.wrap.index_and_next(column, width);
        let [c, d] = self.wrap.index_and_next(row, height);
        let (c, d) = (c * width, d * width);
        Corners { left, top, rows_m2: [[values[c + a], values[c + b]], [values[d + a], values[d + b]]] }
    }
}

/// The four cells about a place, by rows, and where the first of them is.
struct Corners {
    left: f64,
    top: f64,
    rows_m2: [[f64; 2]; 2],
}

impl Corners {
    /// Tests whether a place lies between them.
    fn hold(&self, x: f64, y: f64) -> bool {
        x >= self.left && x < self.left + 1.0 && y >= self.top && y < self.top + 1.0
    }

    fn between(&self, x: f64, y: f64) -> f64 {
        let (fx, fy) = (x - self.left, y - self.top);
        let [first, second] = self.rows_m2.map(|[left, right]| left * (1.0 - fx) + right * fx);
        first * (1.0 - fy) + second * fy
    }
}

/// Adds one lag's mean squares to the cells; looks at every texel of short lags, at every half lag
/// of long ones.
fn add_lag(
    map: &Raster,
    height_m: impl Fn(f64) -> f64,
    lag: usize,
    wrap: Wrap,
    power: &mut [f64],
    cells: [usize; 2],
) {
    let (w, h) = (map.width, map.height);
    let stride = (lag / 2).max(1).min(w.div_ceil(cells[0])).min(h.div_ceil(cells[1]));
    let mut counts = vec![0u32; power.len()];
    let mut sums = vec![0.0; power.len()];
    let reach = 2 * lag as i64;
    let taps = |len: usize, at: usize| {
        [-reach, -reach / 2, reach / 2, reach].map(|d| wrap.index(at as i64 + d, len))
    };
    for y in (0..h).step_by(stride) {
        let rows = taps(h, y).map(|row| row * w);
        let here = y * w;
        for x in (0..w).step_by(stride) {
            let columns = taps(w, x);
            let at = |index: usize| height_m(map.values[index]);
            let middle = 6.0 * at(here + x);
            let fourth =
                |far: [f64; 2], near: [f64; 2]| (far[0] + far[1] - 4.0 * (near[0] + near[1]) + middle) / 16.0;
            let [a, b, c, d] = columns.map(|column| at(here + column));
            let along_u = fourth([a, d], [b, c]);
            let [a, b, c, d] = rows.map(|row| at(row + x));
            let along_v = fourth([a, d], [b, c]);
            let cell = y * cells[1] / h * cells[0] + x * cells[0] / w;
            sums[cell] += (along_u * along_u).max(along_v * along_v);
            counts[cell] += 1;
        }
    }
    for ((power, sum), count) in power.iter_mut().zip(&sums).zip(&counts) {
        *power += sum / f64::from((*count).max(1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::bounds;

    impl LocalRelief {
        fn at(&self, position_m: [f64; 2]) -> f64 {
            let mut power_m2 = [0.0];
            self.add_along(&[position_m], &mut power_m2);
            power_m2[0]
        }
    }

    #[test]
    fn a_cell_that_is_kept_changes_no_bit() {
        let ridge = picture(256, |x, y| 4e-3 * (-((x - y) / 1e-3).powi(2)).exp());
        let way: Vec<[f64; 2]> = (0..4000)
            .map(|n| {
                let turn = f64::from(n) * 0.01;
                [-0.05 + 1e-4 * f64::from(n), 0.07 + 0.03 * turn.sin()]
            })
            .chain([[f64::NAN, 0.0], [0.07, 0.07], [1e30, 0.07], [0.07, 0.07]])
            .collect();
        let mut along = vec![0.0; way.len()];
        ridge.add_along(&way, &mut along);
        for (at, power_m2) in way.iter().zip(along) {
            assert_eq!(power_m2.to_bits(), ridge.at(*at).to_bits(), "{at:?}");
        }
        // The same by blocks whose bounds are known.
        let across: Vec<[f64; 2]> = (0..8000).map(|n| [1e-5 * f64::from(n), 0.05]).collect();
        let mut said = [0; 3];
        for fills_m2 in [1e-7, 1e-12] {
            for way in way[..4000].chunks(16).chain(across.chunks(16)) {
                let mut block = [f64::NAN; 16];
                let how = ridge.along(way, bounds(way), fills_m2, &mut block[..way.len()]);
                said[how as usize] += 1;
                for (at, power_m2) in way.iter().zip(block) {
                    let alone_m2 = ridge.at(*at);
                    match how {
                        PowerKind::None => assert_eq!(alone_m2, 0.0, "{at:?}"),
                        PowerKind::Full => assert!(alone_m2 >= fills_m2, "{at:?}"),
                        PowerKind::EachSample => assert_eq!(power_m2.to_bits(), alone_m2.to_bits(), "{at:?}"),
                    }
                }
            }
        }
        assert!(said.iter().all(|times| *times > 0), "{said:?}");
    }

    fn picture(n: usize, height_m: impl Fn(f64, f64) -> f64) -> LocalRelief {
        let at = |i: usize| (i as f64 + 0.5) / n as f64 * 0.14;
        let values = (0..n * n).map(|i| height_m(at(i % n), at(i / n))).collect();
        LocalRelief::new(&Raster { width: n, height: n, values }, |m| m, [0.14; 2], Wrap::Repeat)
    }

    #[test]
    fn a_ridge_counts_where_it_is_at_any_resolution() {
        for n in [256, 512, 1024] {
            let ridge = picture(n, |x, _| 4e-3 * (-((x - 0.07) / 1e-3).powi(2)).exp());
            assert!(ridge.at([0.07, 0.05]).sqrt() > 1e-4, "{n}: {}", ridge.at([0.07, 0.05]));
            assert!(ridge.at([0.1, 0.05]) < 1e-24 && ridge.at([0.0, 0.05]) < 1e-24, "{n}");
            let hills = picture(n, |x, _| 2e-3 * (x / 0.14 * 6.0 * std::f64::consts::PI).sin());
            assert!(hills.at([0.03, 0.05]).sqrt() < 1.5e-6, "{n}: {}", hills.at([0.03, 0.05]).sqrt());
        }
    }

    #[test]
    fn a_grating_counts_by_about_its_rms() {
        for n in [512, 1024] {
            let grating = picture(n, |x, _| 1e-5 * (x / 1e-3 * 2.0 * std::f64::consts::PI).sin());
            let rms_m = grating.at([0.05, 0.05]).sqrt();
            assert!((0.5..2.0).contains(&(rms_m / 7.1e-6)), "{n}: {rms_m}");
        }
    }
}
