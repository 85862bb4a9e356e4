//! Cubic B-spline through the texels of a map: smooth height and analytic slope anywhere.
//!
//! ```text
//! h(t) = Σ c_k β³(t − k)      c: chosen so that h(i) = texel i      t: texels, centres at integers
//! ```
//! The coefficients c come from the two recursions c⁺ᵢ = sᵢ + z c⁺ᵢ₋₁, cᵢ = z (cᵢ₊₁ − c⁺ᵢ), z = √3 − 2, gain 6
//! (M. Unser, "Splines: a perfect fit for signal and image processing", IEEE SPM 1999), run along rows
//! and columns over the map as it goes on beyond its edges. Why: over 12.8 texels a period a stroke's
//! velocity is clean to 63 dB; bilinear interpolation buzzes at the texel rate (17 dB).

mod simd;

use crate::height_field::MAX_BLOCK;
use crate::raster::Raster;
use crate::wrap::Wrap;

/// The pole of the prefilter, √3 − 2.
const POLE: f64 = -0.267_949_192_431_122_7;
/// Texels beyond each edge over which the recursions settle: |z|⁴⁰ = 1e-23.
const SETTLE: usize = 40;
/// Coefficients kept beyond each edge, so that any 4 × 4 neighbourhood is contiguous. A clamped map
/// needs more: its slope beyond the edge falls by |z| a texel until it is cut off at `REACH`.
const PAD: usize = 14;
/// How far beyond the first and last texel centre a clamped map is still evaluated, texels.
const REACH: f64 = 12.0;

/// A cubic B-spline over a map, coefficients in `f32` (their rounding is 1e-7 of the relief's
/// magnitude: 0.2 nm over 4 mm).
#[derive(Debug, Clone)]
pub struct Spline {
    stride: usize,
    coefficients: Vec<f32>,
    axes: [Axis; 2],
}

/// What turns a texel coordinate into a place along one axis.
#[derive(Debug, Clone, Copy)]
struct Axis {
    wrap: Wrap,
    len: f64,
    per_period: f64,
    texels_per_metre: f64,
    last_first: i64,
}

/// Value and slope at a point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// Value of the map.
    pub value: f64,
    /// Its slope along u and v, per metre.
    pub gradient: [f64; 2],
}

/// Positions evaluated side by side.
const LANES: usize = 4;
/// Places of a block and of the lanes beyond its end.
const ROOM: usize = MAX_BLOCK + LANES;

/// Values and slopes of a block, each on its own so that lanes fill vectors.
#[derive(Debug, Clone)]
pub struct Samples {
    /// Values of the map.
    pub value: [f64; ROOM],
    /// Slopes along u, per metre.
    pub slope_u: [f64; ROOM],
    /// Slopes along v, per metre.
    pub slope_v: [f64; ROOM],
}

impl Samples {
    /// Nothing yet.
    pub const EMPTY: Self = Self { value: [0.0; ROOM], slope_u: [0.0; ROOM], slope_v: [0.0; ROOM] };
}

/// [`Place`]s of a block.
struct Places {
    texel: [f64; ROOM],
    fraction: [f64; ROOM],
    slope: [f64; ROOM],
}

impl Places {
    const EMPTY: Self = Self { texel: [0.0; ROOM], fraction: [0.0; ROOM], slope: [0.0; ROOM] };
}

/// Where along one axis: the texel before, how far beyond it (0–1), and slope per metre for a slope of
/// 1 per texel (negative in a mirrored copy, 0 beyond a clamped edge).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Place {
    texel: f64,
    fraction: f64,
    slope: f64,
}

/// The spline between four texels as a polynomial, Σ aᵢⱼ xⁱ yʲ with x, y the fractions.
#[derive(Debug, Clone, Copy)]
struct Cell {
    /// By power of y, then of x.
    powers: [[f64; 4]; 4],
}

impl Spline {
    /// The spline through a raster (not empty) that spans `extent_m`.
    pub fn new(raster: &Raster, extent_m: [f64; 2], wrap: Wrap) -> Self {
        let rows = prefilter_rows(raster, wrap);
        let both = transpose(&prefilter_rows(&transpose(&rows), wrap));
        Self {
            stride: both.width,
            coefficients: both.values.iter().map(|&c| c as f32).collect(),
            axes: [Axis::new(raster.width, extent_m[0], wrap), Axis::new(raster.height, extent_m[1], wrap)],
        }
    }

    /// Texels per metre along u and v.
    #[inline]
    pub fn texels_per_metre(&self) -> [f64; 2] {
        self.axes.map(|axis| axis.texels_per_metre)
    }

    /// Value and slope at a position; (0, 0) is the top left corner of the map.
    #[inline]
    pub fn sample(&self, position_m: [f64; 2]) -> Sample {
        let (x, y) = (self.axes[0].place(position_m[0]), self.axes[1].place(position_m[1]));
        self.cell(x.texel, y.texel).at(&x, &y)
    }

    /// Value and slope at each of up to [`MAX_BLOCK`] positions, the same bits as [`Self::sample`]: a
    /// slow finger stays in a cell for many samples, whose polynomial is found once.
    pub fn sample_block(&self, position_m: &[[f64; 2]], out: &mut Samples) {
        simd::sample_block(self, position_m, out);
    }

    #[inline(always)]
    fn sample_block_in_lanes(&self, position_m: &[[f64; 2]], out: &mut Samples) {
        let len = position_m.len().min(MAX_BLOCK);
        let [mut x, mut y] = [Places::EMPTY; 2];
        self.axes[0].places(position_m, 0, &mut x);
        self.axes[1].places(position_m, 1, &mut y);
        let mut start = 0;
        while start < len {
            let (column, row) = (x.texel[start], y.texel[start]);
            let same = |n: &usize| x.texel[*n] == column && y.texel[*n] == row;
            let end = start + 1 + (start + 1..len).take_while(same).count();
            let cell = self.cell(column, row);
            // Whole lanes: what is written beyond the cell's samples is overwritten by the next cell's.
            for n in (start..end).step_by(LANES) {
                cell.at_lanes(&x, &y, n, out);
            }
            start = end;
        }
    }

    /// The polynomial between texel (column, row) and the next.
    #[inline(always)]
    fn cell(&self, column: f64, row: f64) -> Cell {
        let start = self.axes[1].first(row) * self.stride + self.axes[0].first(column);
        let mut c = [[0.0; 4]; 4];
        for (j, row) in c.iter_mut().enumerate() {
            let start = start + j * self.stride;
            if let Some(four) = self.coefficients[start..].first_chunk::<4>() {
                *row = four.map(f64::from);
            }
        }
        Cell { powers: to_powers(transposed(to_powers(c))) }
    }
}

/// Four B-spline coefficients c₀ … c₃ in each lane → the powers 0 … 3 of the fraction from c₁ to c₂.
#[inline(always)]
fn to_powers(c: [[f64; 4]; 4]) -> [[f64; 4]; 4] {
    let mut out = [[0.0; 4]; 4];
    for n in 0..4 {
        out[0][n] = (c[0][n] + 4.0 * c[1][n] + c[2][n]) * (1.0 / 6.0);
        out[1][n] = 0.5 * (c[2][n] - c[0][n]);
        out[2][n] = 0.5 * (c[0][n] + c[2][n]) - c[1][n];
        out[3][n] = (c[3][n] - c[0][n] + 3.0 * (c[1][n] - c[2][n])) * (1.0 / 6.0);
    }
    out
}

#[inline(always)]
fn transposed(m: [[f64; 4]; 4]) -> [[f64; 4]; 4] {
    let mut out = m;
    for (i, row) in out.iter_mut().enumerate() {
        for (j, value) in row.iter_mut().enumerate() {
            *value = m[j][i];
        }
    }
    out
}

impl Cell {
    /// [`Self::at`] for the places from `n` on, side by side.
    #[inline(always)]
    fn at_lanes(&self, x: &Places, y: &Places, n: usize, out: &mut Samples) {
        let p = &self.powers;
        let lanes = |values: &[f64; ROOM]| -> [f64; LANES] { std::array::from_fn(|i| values[n + i]) };
        let (t, u) = (lanes(&x.fraction), lanes(&y.fraction));
        let (x_slope, y_slope) = (lanes(&x.slope), lanes(&y.slope));
        let (mut level, mut rise) = ([[0.0; LANES]; 4], [[0.0; LANES]; 4]);
        for j in 0..4 {
            for i in 0..LANES {
                level[j][i] = ((p[3][j] * t[i] + p[2][j]) * t[i] + p[1][j]) * t[i] + p[0][j];
                rise[j][i] = (3.0 * p[3][j] * t[i] + 2.0 * p[2][j]) * t[i] + p[1][j];
            }
        }
        for i in 0..LANES {
            let (level, rise, u) = (level.map(|l| l[i]), rise.map(|r| r[i]), u[i]);
            out.value[n + i] = ((level[3] * u + level[2]) * u + level[1]) * u + level[0];
            out.slope_u[n + i] = (((rise[3] * u + rise[2]) * u + rise[1]) * u + rise[0]) * x_slope[i];
            out.slope_v[n + i] = ((3.0 * level[3] * u + 2.0 * level[2]) * u + level[1]) * y_slope[i];
        }
    }

    #[inline]
    fn at(&self, x: &Place, y: &Place) -> Sample {
        // powers[i][j] belongs to xⁱ yʲ; the four powers of y side by side.
        let p = &self.powers;
        let t = x.fraction;
        let (mut level, mut rise) = ([0.0; 4], [0.0; 4]);
        for j in 0..4 {
            level[j] = ((p[3][j] * t + p[2][j]) * t + p[1][j]) * t + p[0][j];
            rise[j] = (3.0 * p[3][j] * t + 2.0 * p[2][j]) * t + p[1][j];
        }
        let t = y.fraction;
        Sample {
            value: ((level[3] * t + level[2]) * t + level[1]) * t + level[0],
            gradient: [
                (((rise[3] * t + rise[2]) * t + rise[1]) * t + rise[0]) * x.slope,
                ((3.0 * level[3] * t + 2.0 * level[2]) * t + level[1]) * y.slope,
            ],
        }
    }
}

/// Largest whole number not above x, for |x| < 2⁵¹: adding a large number rounds. `f64::floor` is a
/// library call on plain x86-64.
#[inline(always)]
fn floor(x: f64) -> f64 {
    const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5 · 2⁵²
    let rounded = (x + ROUND) - ROUND;
    if rounded > x { rounded - 1.0 } else { rounded }
}

impl Axis {
    fn new(len: usize, extent_m: f64, wrap: Wrap) -> Self {
        let period = if wrap == Wrap::Mirror { 2 * len } else { len };
        Self {
            wrap,
            len: len as f64,
            per_period: 1.0 / period as f64,
            texels_per_metre: len as f64 / extent_m,
            last_first: (len + 2 * PAD - 4) as i64,
        }
    }

    /// Where the positions of a block are; for the usual maps, which repeat, in a loop without branches.
    #[inline(always)]
    fn places(&self, position_m: &[[f64; 2]], axis: usize, out: &mut Places) {
        let places = out.texel.iter_mut().zip(&mut out.fraction).zip(&mut out.slope);
        let repeats = Self { wrap: Wrap::Repeat, ..*self };
        let all = position_m.iter().take(MAX_BLOCK).zip(places);
        if self.wrap == Wrap::Repeat {
            for (position, ((texel, fraction), slope)) in all {
                let place = repeats.place(position[axis]);
                (*texel, *fraction, *slope) = (place.texel, place.fraction, place.slope);
            }
        } else {
            for (position, ((texel, fraction), slope)) in all {
                let place = self.place(position[axis]);
                (*texel, *fraction, *slope) = (place.texel, place.fraction, place.slope);
            }
        }
    }

    /// Where a position is.
    #[inline(always)]
    fn place(&self, position_m: f64) -> Place {
        let n = self.len;
        let t = position_m * self.texels_per_metre - 0.5;
        // Beyond this no fraction of a texel is left in an f64.
        let t = if t.abs() < 1e15 { t } else { 0.0 };
        let (t, slope) = match self.wrap {
            Wrap::Repeat => (t - n * floor((t + 0.5) * self.per_period), self.texels_per_metre),
            Wrap::Clamp => {
                let inside = t.clamp(-REACH, n - 1.0 + REACH);
                (inside, if inside == t { self.texels_per_metre } else { 0.0 })
            }
            Wrap::Mirror => {
                let t = t - 2.0 * n * floor((t + 0.5) * self.per_period);
                if t <= n - 0.5 {
                    (t, self.texels_per_metre)
                } else {
                    (2.0 * n - 1.0 - t, -self.texels_per_metre)
                }
            }
        };
        let texel = floor(t);
        Place { texel, fraction: t - texel, slope }
    }

    /// Index of the first of the four coefficients around a texel and the next. Rounding at the seam may
    /// reach one texel beyond it, which is there; the clamp is for certainty.
    #[inline]
    fn first(&self, texel: f64) -> usize {
        (texel as i64 + PAD as i64 - 1).clamp(0, self.last_first) as usize
    }
}

/// Coefficients of every row, with [`PAD`] more on either side.
fn prefilter_rows(raster: &Raster, wrap: Wrap) -> Raster {
    let n = raster.width;
    let index: Vec<usize> = (0..n + 2 * SETTLE).map(|i| wrap.index(i as i64 - SETTLE as i64, n)).collect();
    let width = n + 2 * PAD;
    let mut values = Vec::with_capacity(width * raster.height);
    let mut line = vec![0.0; index.len()];
    for y in 0..raster.height {
        let row = raster.row(y);
        let mut causal = row[index[0]] / (1.0 - POLE);
        for (out, &i) in line.iter_mut().zip(&index) {
            causal = row[i] + POLE * causal;
            *out = causal;
        }
        let mut next = causal * POLE / (POLE - 1.0);
        for out in line.iter_mut().rev() {
            next = POLE * (next - *out);
            *out = next;
        }
        values.extend(line[SETTLE - PAD..SETTLE + n + PAD].iter().map(|c| 6.0 * c));
    }
    Raster { width, height: raster.height, values }
}

/// Rows become columns; in tiles, so that a large map does not miss the cache at every texel.
pub fn transpose(raster: &Raster) -> Raster {
    const TILE: usize = 32;
    let (w, h) = (raster.width, raster.height);
    let mut values = vec![0.0; w * h];
    for y0 in (0..h).step_by(TILE) {
        for x0 in (0..w).step_by(TILE) {
            for y in y0..h.min(y0 + TILE) {
                for x in x0..w.min(x0 + TILE) {
                    values[x * h + y] = raster.values[y * w + x];
                }
            }
        }
    }
    Raster { width: h, height: w, values }
}
