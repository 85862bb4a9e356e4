//! Cubic B-spline through the texels of a map: smooth height and analytic slope anywhere.
//!
//! ```text
//! h(t) = Σ c_k β³(t − k)      c: chosen so that h(i) = texel i      t: texels, centres at integers
//! ```
//! The coefficients c come from the two recursions c⁺ᵢ = sᵢ + z c⁺ᵢ₋₁, cᵢ = z (cᵢ₊₁ − c⁺ᵢ), z = √3
//! − 2, gain 6 (M. Unser, "Splines: a perfect fit for signal and image processing", IEEE SPM 1999),
//! run along rows and columns over the map as it goes on beyond its edges. Why: over 12.8 texels a
//! period a stroke's velocity is clean to 63 dB; bilinear interpolation buzzes at the texel rate
//! (17 dB).

mod cell;
mod place;
#[cfg(test)]
mod tests;
mod vector;
mod working;

use crate::raster::Raster;
use crate::wrap::Wrap;
use asperity_dsp::simd::{Level, at_level};
use cell::Cell;
pub use cell::Samples;
use place::Axis;
pub use place::Places;
use std::ops::Range;
use vector::{Four, Rows, Vector};
pub(crate) use working::Working;

/// The pole of the prefilter, √3 − 2.
const POLE: f64 = -0.267_949_192_431_122_7;
/// Texels beyond each edge over which the recursions settle: |z|⁴⁰ = 1e-23.
const SETTLE: usize = 40;
/// Coefficients kept beyond each edge, so that any 4 × 4 neighbourhood is contiguous. A clamped map
/// needs more: its slope beyond the edge falls by |z| a texel until it is cut off at `REACH`.
const PAD: usize = 14;
/// Distance beyond the first and last texel centre at which a clamped map is still evaluated,
/// texels.
const REACH: f64 = 12.0;

/// Columns that are filtered at once: rows of a large map are filtered once for each strip, which
/// takes less time than a copy of all of it takes memory.
const STRIP: usize = 1056;

/// Coefficients are asked for ahead of a stroke over so many texels a block at most.
const FARTHEST_AHEAD: f64 = 12.0;

/// A cubic B-spline over a map, coefficients in `f32` (their rounding is 1e-7 of the relief's
/// magnitude: 0.2 nm over 4 mm).
#[derive(Debug, Clone)]
pub struct Spline {
    stride: usize,
    coefficients: Vec<f32>,
    axes: [Axis; 2],
    level: Level,
}

impl Spline {
    /// The spline through `value` of a raster's (not empty) numbers, which spans `extent_m`.
    pub fn new(raster: &Raster, value: impl Fn(f64) -> f64, extent_m: [f64; 2], wrap: Wrap) -> Self {
        let stride = raster.width + 2 * PAD;
        let mut coefficients = vec![0.0; stride * (raster.height + 2 * PAD)];
        for left in (0..stride).step_by(STRIP) {
            let strip = left..(left + STRIP).min(stride);
            prefilter_strip(raster, &value, wrap, strip, &mut coefficients);
        }
        Self {
            stride,
            coefficients,
            axes: [Axis::new(raster.width, extent_m[0], wrap), Axis::new(raster.height, extent_m[1], wrap)],
            level: Level::detect(),
        }
    }

    /// Texels per metre along u and v.
    #[inline]
    pub fn texels_per_metre(&self) -> [f64; 2] {
        self.axes.map(|axis| axis.texels_per_metre())
    }

    /// The values at the texels, to the rounding of the coefficients.
    pub fn texels(&self) -> Raster {
        let [width, height] = self.axes.map(|axis| axis.len());
        let at = |x: usize, y: usize| {
            let weights = [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0];
            let row = |dy: usize| {
                let first = (y + PAD - 1 + dy) * self.stride + x + PAD - 1;
                let near = &self.coefficients[first..first + 3];
                near.iter().zip(weights).map(|(c, w)| w * f64::from(*c)).sum::<f64>()
            };
            (0..3).zip(weights).map(|(dy, w)| w * row(dy)).sum()
        };
        Raster::from_fn(width, height, at)
    }

    /// The value, and the slope if `SLOPES`, at each of up to
    /// [`MAX_BLOCK`](crate::height_field::MAX_BLOCK) positions; (0, 0) is the top left corner of
    /// the map. The bits are those of each position alone. `places` are found on the way, unless a
    /// map of the same grid has done so for the same positions. Where the corners are known that
    /// all positions lie between, one cell that holds both is found from them.
    pub fn sample_block<const SLOPES: bool>(
        &self,
        position_m: &[[f64; 2]],
        bounds_m: Option<&[[f64; 2]; 2]>,
        places: &mut Places,
        out: &mut Samples,
    ) {
        at_level!(
            self.level,
            s => self.sample_block_in_lanes::<4, _, _, SLOPES>(Four(s), Four(s), (position_m, bounds_m), places, out),
            wide s => self.sample_block_in_lanes::<8, _, _, SLOPES>(vector::Eight(s), Four(s), (position_m, bounds_m), places, out)
        );
    }

    /// [`Self::sample_block`], N positions side by side. A slow finger stays in a cell for many
    /// samples, whose polynomial is found once.
    #[inline(always)]
    fn sample_block_in_lanes<const N: usize, V: Vector<N>, R: Rows, const SLOPES: bool>(
        &self,
        v: V,
        rows: R,
        (position_m, bounds_m): (&[[f64; 2]], Option<&[[f64; 2]; 2]>),
        places: &mut Places,
        out: &mut Samples,
    ) {
        if !SLOPES
            && let Some(bounds_m) = bounds_m
            && let Some([column, row]) = places.find_in_one_cell(v, &self.axes, bounds_m, position_m)
        {
            let cell = self.cell(rows, column, row);
            return cell.block::<N, V, SLOPES>(v, places.by_axis(), (0, places.len()), out);
        }
        places.find(&self.axes, position_m);
        let mut start = 0;
        while start < places.len() {
            let end = places.end_of_cell(v, start);
            let [column, row] = places.texel(start);
            let cell = self.cell(rows, column, row);
            // What is written beyond the cell's samples is overwritten by the next cell's.
            cell.block::<N, V, SLOPES>(v, places.by_axis(), (start, end), out);
            start = end;
        }
        self.prefetch(rows, places);
    }

    /// Says which coefficients the next block will probably need. Rows lie far apart in memory: a
    /// stroke down a large map meets new ones all the time, and would wait for each.
    #[inline(always)]
    fn prefetch<R: Rows>(&self, rows: R, places: &Places) {
        let Some((last, step)) = places.ahead() else { return };
        let [columns, lines] = step.map(|texels| texels.abs().min(FARTHEST_AHEAD));
        let steps = (columns.max(lines) / 3.0) as usize + 1;
        for i in 1..=steps {
            let along = i as f64 / steps as f64;
            let start = self.first(last[0] + along * step[0], last[1] + along * step[1]);
            for j in 0..4 {
                if let Some(coefficient) = self.coefficients.get(start + j * self.stride) {
                    rows.prefetch(coefficient);
                }
            }
        }
    }

    /// The polynomial between texel (column, row) and the next.
    #[inline(always)]
    fn cell<R: Rows>(&self, rows: R, column: f64, row: f64) -> Cell {
        let start = self.first(column, row);
        let four = |j: usize| {
            let row = self.coefficients.get(start + j * self.stride..);
            row.and_then(<[f32]>::first_chunk).unwrap_or(&[0.0; 4])
        };
        Cell::new(rows, [four(0), four(1), four(2), four(3)])
    }

    /// Place where the 4 × 4 coefficients around texel (column, row) and the next begin.
    #[inline(always)]
    fn first(&self, column: f64, row: f64) -> usize {
        self.axes[1].first(row) * self.stride + self.axes[0].first(column)
    }
}

/// Coefficients of these columns of all rows, with [`PAD`] more on every side.
fn prefilter_strip(
    raster: &Raster,
    value: impl Fn(f64) -> f64,
    wrap: Wrap,
    strip: Range<usize>,
    coefficients: &mut [f32],
) {
    let (n, stride) = (raster.width, raster.width + 2 * PAD);
    let extension =
        |len: usize| (0..len + 2 * SETTLE).map(move |i| wrap.index(i as i64 - SETTLE as i64, len));
    let columns: Vec<usize> = extension(n).collect();
    let mut line = vec![0.0; columns.len()];
    let mut causal: Vec<f64> = Vec::with_capacity(strip.len() * (raster.height + 2 * SETTLE));
    for y in extension(raster.height) {
        prefilter_row(raster.row(y), &value, &columns, &mut line);
        let start = causal.len();
        causal.extend(line[SETTLE - PAD..][strip.clone()].iter().map(|c| 6.0 * c));
        let (above, row) = causal.split_at_mut(start);
        let above = &above[start.saturating_sub(strip.len())..];
        row.iter_mut().zip(above).for_each(|(out, above)| *out += POLE * above);
    }
    let mut next = vec![0.0; strip.len()];
    for (i, causal) in causal.chunks_exact(strip.len()).enumerate().rev() {
        next.iter_mut().zip(causal).for_each(|(next, causal)| *next = POLE * (*next - causal));
        let y = i.wrapping_sub(SETTLE - PAD);
        if y < raster.height + 2 * PAD {
            let out = &mut coefficients[y * stride..][strip.clone()];
            out.iter_mut().zip(&next).for_each(|(out, c)| *out = (6.0 * c) as f32);
        }
    }
}

/// Coefficients of a row, a sixth of them, with [`SETTLE`] more on either side.
fn prefilter_row(row: &[f64], value: impl Fn(f64) -> f64, columns: &[usize], line: &mut [f64]) {
    line.iter_mut().zip(columns).for_each(|(out, &i)| *out = value(row[i]));
    let mut causal = 0.0;
    for out in line.iter_mut() {
        causal = *out + POLE * causal;
        *out = causal;
    }
    let mut next = 0.0;
    for out in line.iter_mut().rev() {
        next = POLE * (next - *out);
        *out = next;
    }
}
