//! Lattice textures: one primitive cell and two translations, without end and without tile memory.
//!
//! ```text
//! h(p) = cell(a mod 1, b mod 1)        p = a · t1 + b · t2
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | cell | a raster of heights; its columns run along t1, its rows along t2, texel centres at (i + ½)/N |
//! | t1, t2 | `t1_m`, `t2_m`: any two translations that are not parallel |
//!
//! Source: chapter 7 of the texture-analysis thesis describes a symmetric texture by its primitive
//! and the integer combinations of two translations; this is the engine's end of that description.
//! Ours: the cell is read with an interpolating cubic B-spline whose coefficients are periodic, so
//! that height, slope and curvature run through cell borders as through any other point; where the
//! contact's footprint does not resolve the texels, copies of the cell smoothed by 1–4–6–4–1 at
//! dyadic scales take over (not thinned out, so that any cell size will do), down to its mean.

use crate::height_field::{
    Extension, HeightField, MAX_BLOCK, PathBlock, Properties, SurfaceBlock, WavelengthBand,
};
use crate::raster::Raster;
use asperity_dsp::DesignError;
use asperity_dsp::limits::combined as limits;

/// Most texels along an edge of a cell.
pub const MAX_CELL: usize = 4096;
/// Pole of the cubic B-spline's inverse filter, √3 − 2.
const POLE: f64 = -0.267_949_192_431_122_7;

/// A texture that repeats along two translations.
#[derive(Debug, Clone)]
pub struct Lattice {
    width: usize,
    height: usize,
    /// Spline coefficients, finest first; the last level is the mean alone.
    levels: Vec<Vec<f64>>,
    mean_m: f64,
    /// Rows turn a position in metres into a and b.
    inverse: [[f64; 2]; 2],
    texel_m: f64,
    longest_m: f64,
}

impl Lattice {
    /// A lattice of a cell of heights in metres.
    ///
    /// ```
    /// use asperity_surface::{lattice::Lattice, raster::Raster};
    ///
    /// // Bumps of 0.1 mm, 2 mm apart, in rows 60° to each other.
    /// let bump = |t: usize| 0.5 - 0.5 * (t as f64 / 16.0 * std::f64::consts::TAU).cos();
    /// let cell = Raster::from_fn(16, 16, |x, y| 1e-4 * bump(x) * bump(y));
    /// let lattice = Lattice::new(&cell, [2e-3, 0.0], [1e-3, 1.732e-3])?;
    /// let ((here_m, _), (there_m, _)) = (lattice.at([5e-4, 3e-4]), lattice.at([25e-4, 3e-4]));
    /// assert!((here_m - there_m).abs() < 1e-12);
    /// # Ok::<(), asperity_dsp::DesignError>(())
    /// ```
    ///
    /// # Errors
    /// When the cell is empty, larger than [`MAX_CELL`], not filled or not finite, or when the
    /// translations are parallel (an angle below 1°), shorter than 1 µm or longer than 1 km.
    pub fn new(cell: &Raster, t1_m: [f64; 2], t2_m: [f64; 2]) -> Result<Self, DesignError> {
        let edge = |n: usize| (1..=MAX_CELL).contains(&n);
        DesignError::check("cell.width", cell.width as f64, "1 to 4096 texels", |_| edge(cell.width))?;
        DesignError::check("cell.height", cell.height as f64, "1 to 4096 texels", |_| edge(cell.height))?;
        let (found, wanted) = (cell.values.len(), cell.width * cell.height);
        DesignError::check("cell.values", found as f64, "width · height values", |_| found == wanted)?;
        for &value in &cell.values {
            DesignError::check("cell.values", value, "finite heights in metres", |_| true)?;
        }
        let (l1, l2) = (libm::hypot(t1_m[0], t1_m[1]), libm::hypot(t2_m[0], t2_m[1]));
        limits::STEP_LENGTH_M.check("t1_m", l1)?;
        limits::STEP_LENGTH_M.check("t2_m", l2)?;
        let area = t1_m[0] * t2_m[1] - t1_m[1] * t2_m[0];
        DesignError::check(
            "t2_m",
            area / (l1 * l2),
            "at least 1° away from t1_m (sine of the angle)",
            |s| s.abs() > 0.0174,
        )?;
        let inverse = [[t2_m[1] / area, -t2_m[0] / area], [-t1_m[1] / area, t1_m[0] / area]];
        Ok(Self {
            width: cell.width,
            height: cell.height,
            levels: levels(cell),
            mean_m: cell.mean(),
            inverse,
            texel_m: (l1 / cell.width as f64).min(l2 / cell.height as f64),
            longest_m: l1.max(l2),
        })
    }

    /// Height and slope along u and v at a position, for a footprint of 0: the definition.
    #[must_use]
    pub fn at(&self, position_m: [f64; 2]) -> (f64, [f64; 2]) {
        let ab = self.coordinates(position_m);
        self.spline(&self.levels[0], ab)
    }

    /// a mod 1 and b mod 1.
    #[inline]
    fn coordinates(&self, p: [f64; 2]) -> [f64; 2] {
        self.inverse.map(|row| {
            let t = row[0] * p[0] + row[1] * p[1];
            t - t.floor()
        })
    }

    /// Value and gradient (in metres) of one level.
    fn spline(&self, coefficients: &[f64], [a, b]: [f64; 2]) -> (f64, [f64; 2]) {
        let (columns, wx, dx) = taps(a, self.width);
        let (rows, wy, dy) = taps(b, self.height);
        let (mut value, mut along_a, mut along_b) = (0.0, 0.0, 0.0);
        for (j, &row) in rows.iter().enumerate() {
            let line = &coefficients[row * self.width..(row + 1) * self.width];
            let (mut v, mut d) = (0.0, 0.0);
            for (i, &column) in columns.iter().enumerate() {
                v += wx[i] * line[column];
                d += dx[i] * line[column];
            }
            value += wy[j] * v;
            along_a += wy[j] * d;
            along_b += dy[j] * v;
        }
        let (along_a, along_b) = (along_a * self.width as f64, along_b * self.height as f64);
        let [ra, rb] = self.inverse;
        (value, [along_a * ra[0] + along_b * rb[0], along_a * ra[1] + along_b * rb[1]])
    }

    /// One level of smoothing, the mean above the last.
    fn level(&self, index: usize, ab: [f64; 2]) -> (f64, [f64; 2]) {
        match self.levels.get(index) {
            Some(coefficients) => self.spline(coefficients, ab),
            None => (self.mean_m, [0.0; 2]),
        }
    }

    fn height_at(&self, position_m: [f64; 2], footprint_m: f64) -> (f64, [f64; 2]) {
        let ab = self.coordinates(position_m);
        // Two samples a texel leave the spline's own band whole.
        let scale = 2.0 * footprint_m / self.texel_m;
        if scale <= 1.0 {
            return self.spline(&self.levels[0], ab);
        }
        let level = libm::log2(scale).min(self.levels.len() as f64);
        let (low, share) = (level as usize, level - level.floor());
        let (h0, g0) = self.level(low, ab);
        if share == 0.0 {
            return (h0, g0);
        }
        let (h1, g1) = self.level(low + 1, ab);
        let mix = |a: f64, b: f64| a + share * (b - a);
        (mix(h0, h1), [mix(g0[0], g1[0]), mix(g0[1], g1[1])])
    }
}

/// Cubic B-spline taps of a periodic axis of `n` texels: indices, weights, derivatives a texel.
#[inline]
pub(crate) fn taps(t: f64, n: usize) -> ([usize; 4], [f64; 4], [f64; 4]) {
    let x = t * n as f64 - 0.5;
    let floor = x.floor();
    let f = x - floor;
    let first = floor as isize - 1;
    let indices = core::array::from_fn(|k| (first + k as isize).rem_euclid(n as isize) as usize);
    let (f2, g) = (f * f, 1.0 - f);
    let f3 = f2 * f;
    let weights = [
        g * g * g / 6.0,
        (4.0 - 6.0 * f2 + 3.0 * f3) / 6.0,
        (1.0 + 3.0 * f + 3.0 * f2 - 3.0 * f3) / 6.0,
        f3 / 6.0,
    ];
    let slopes = [-0.5 * g * g, 1.5 * f2 - 2.0 * f, 0.5 + f - 1.5 * f2, 0.5 * f2];
    (indices, weights, slopes)
}

/// Spline coefficients of the cell and of its smoothed copies.
fn levels(cell: &Raster) -> Vec<Vec<f64>> {
    let (w, h) = (cell.width, cell.height);
    let mut smooth = cell.values.clone();
    let mut levels = vec![prefiltered(smooth.clone(), w, h)];
    let mut step = 1;
    while step < w.max(h) {
        smooth = smoothed(&smooth, w, h, step);
        levels.push(prefiltered(smooth.clone(), w, h));
        step *= 2;
    }
    levels
}

/// 1–4–6–4–1 along both axes with `step` texels between the taps.
fn smoothed(values: &[f64], w: usize, h: usize, step: usize) -> Vec<f64> {
    const KERNEL: [f64; 5] = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];
    // Two taps to the left, without going below 0.
    let first = |i: usize, n: usize| i + 2 * step * (n - 1);
    let mut rows = vec![0.0; w * h];
    for (i, out) in rows.iter_mut().enumerate() {
        let (x, y) = (i % w, i / w);
        *out = (0..5).map(|k| KERNEL[k] * values[y * w + (first(x, w) + k * step) % w]).sum();
    }
    let mut both = vec![0.0; w * h];
    for (i, out) in both.iter_mut().enumerate() {
        let (x, y) = (i % w, i / w);
        *out = (0..5).map(|k| KERNEL[k] * rows[(first(y, h) + k * step) % h * w + x]).sum();
    }
    both
}

/// Samples to periodic spline coefficients, rows then columns.
fn prefiltered(mut values: Vec<f64>, w: usize, h: usize) -> Vec<f64> {
    for row in values.chunks_exact_mut(w) {
        prefilter(row);
    }
    let mut column = vec![0.0; h];
    for x in 0..w {
        for (y, c) in column.iter_mut().enumerate() {
            *c = values[y * w + x];
        }
        prefilter(&mut column);
        for (y, &c) in column.iter().enumerate() {
            values[y * w + x] = c;
        }
    }
    values
}

/// The inverse of (1, 4, 1)/6 on a circle: a causal and an anticausal pass, each begun with the sum
/// over all earlier turns.
pub(crate) fn prefilter(line: &mut [f64]) {
    let n = line.len();
    let turns = 1.0 / (1.0 - POLE.powi(n as i32));
    let (mut sum, mut power) = (0.0, 1.0);
    for k in 0..n {
        sum += power * line[(n - k) % n];
        power *= POLE;
    }
    line[0] = 6.0 * sum * turns;
    for i in 1..n {
        line[i] = 6.0 * line[i] + POLE * line[i - 1];
    }
    let (mut sum, mut power) = (0.0, POLE);
    for k in 0..n {
        sum += power * line[(n - 1 + k) % n];
        power *= POLE;
    }
    line[n - 1] = -sum * turns;
    for i in (0..n - 1).rev() {
        line[i] = POLE * (line[i + 1] - line[i]);
    }
}

impl HeightField for Lattice {
    fn properties(&self, tile_m: [f64; 2]) -> Properties {
        // A tile repeats if each of its sides is a whole number of cells along both translations.
        let whole = |side: [f64; 2]| {
            self.inverse.iter().all(|row| {
                let cells = row[0] * side[0] + row[1] * side[1];
                (cells - cells.round()).abs() < 1e-9 * (1.0 + cells.abs())
            })
        };
        let repeats = whole([tile_m[0], 0.0]) && whole([0.0, tile_m[1]]);
        let band = WavelengthBand { shortest_m: 2.0 * self.texel_m, longest_m: self.longest_m };
        Properties {
            reach_m: self.levels[0].iter().fold(0.0, |reach, c| reach.max(c.abs())),
            extension: if repeats { Extension::Same } else { Extension::Fresh },
            is_stateless: true,
            ..Properties::of(band)
        }
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let n = path.len().min(MAX_BLOCK);
        out.clear(n);
        out.roughness[..n].fill(0.0);
        out.friction[..n].fill(0.0);
        for i in 0..n {
            (out.height_m[i], out.gradient[i]) = self.height_at(path.position_m[i], path.footprint_m[i]);
        }
    }
}
