//! Texel coordinates of positions on a map.

use super::vector::Vector;
use super::{PAD, REACH};
use crate::height_field::MAX_BLOCK;
use crate::wrap::Wrap;

/// Most positions that a processor looks at side by side.
const MOST_LANES: usize = 8;
/// Places of a short block.
const FEW: usize = 2 * MOST_LANES;
/// Places of a block and of the lanes beyond its end.
pub(super) const ROOM: usize = MAX_BLOCK + MOST_LANES;

/// Conversion of a texel coordinate to a place along one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Axis {
    wrap: Wrap,
    len: f64,
    per_period: f64,
    texels_per_metre: f64,
    last_first: i64,
}

/// A texel, and the first of the copy of the map that it belongs to.
#[derive(Clone, Copy)]
struct OnlyTexel {
    copy: f64,
    texel: f64,
}

/// Place along one axis: the texel before, the distance beyond it (0–1), and slope per metre for a
/// slope of 1 per texel (negative in a mirrored copy, 0 beyond a clamped edge).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Place {
    pub(super) texel: f64,
    pub(super) fraction: f64,
    pub(super) slope: f64,
}

/// [`Place`]s of a block along one axis, each number on its own so that lanes fill vectors.
#[derive(Debug, Clone)]
pub(super) struct AxisPlaces {
    texel: [f64; ROOM],
    fraction: [f64; ROOM],
    slope: [f64; ROOM],
}

/// Places of the positions of a block; found once for all maps of one grid.
#[derive(Debug, Clone)]
pub struct Places {
    /// The grid that they were found for.
    axes: Option<[Axis; 2]>,
    /// The grid of which all lie in one cell, if only that and their fractions are known.
    one_cell: Option<[Axis; 2]>,
    len: usize,
    columns: AxisPlaces,
    rows: AxisPlaces,
}

impl Places {
    /// None yet.
    pub const fn new() -> Self {
        Self { axes: None, one_cell: None, len: 0, columns: AxisPlaces::EMPTY, rows: AxisPlaces::EMPTY }
    }

    /// The next positions are others.
    pub fn forget(&mut self) {
        (self.axes, self.one_cell) = (None, None);
    }

    /// The cell, column and row, in which all positions lie that are between two corners, if that
    /// can be told from the corners; how far beyond it each is, is then found and nothing else.
    #[inline(always)]
    pub(super) fn find_in_one_cell<const N: usize, V: Vector<N>>(
        &mut self,
        v: V,
        axes: &[Axis; 2],
        [low_m, high_m]: &[[f64; 2]; 2],
        position_m: &[[f64; 2]],
    ) -> Option<[f64; 2]> {
        let column = axes[0].only_texel(low_m[0], high_m[0])?;
        let row = axes[1].only_texel(low_m[1], high_m[1])?;
        if self.one_cell != Some(*axes) {
            (self.axes, self.one_cell) = (None, Some(*axes));
            self.len = position_m.len().min(MAX_BLOCK);
            self.find_beyond(v, axes, [column, row], position_m);
        }
        Some([column.texel, row.texel])
    }

    #[inline(always)]
    fn find_beyond<const N: usize, V: Vector<N>>(
        &mut self,
        v: V,
        axes: &[Axis; 2],
        only: [OnlyTexel; 2],
        position_m: &[[f64; 2]],
    ) {
        let fractions = [&mut self.columns.fraction, &mut self.rows.fraction];
        let (some, last) = position_m.as_chunks::<N>();
        for ((fractions, axis), (along, only)) in
            fractions.into_iter().zip(axes).zip([0, 1].into_iter().zip(only))
        {
            let (texels_per_metre, half) = (v.splat(axis.texels_per_metre), v.splat(0.5));
            let (copy, texel) = (v.splat(only.copy), v.splat(only.texel));
            let (whole, rest) = fractions.as_chunks_mut::<N>();
            for (fraction, position_m) in whole.iter_mut().zip(some) {
                let t = v.load(&position_m.map(|at_m| at_m[along])) * texels_per_metre;
                v.store(t - half - copy - texel, fraction);
            }
            let first = some.len() * N;
            for (fraction, position_m) in
                whole.as_flattened_mut().iter_mut().chain(rest).skip(first).zip(last)
            {
                *fraction = axis.extension(only, position_m[along]);
            }
        }
    }

    /// Finds the places of positions, up to [`MAX_BLOCK`] of them, unless they are those of this
    /// grid already.
    #[inline(always)]
    pub(super) fn find(&mut self, axes: &[Axis; 2], position_m: &[[f64; 2]]) {
        if self.axes == Some(*axes) {
            return;
        }
        (self.axes, self.one_cell) = (Some(*axes), None);
        self.len = position_m.len().min(MAX_BLOCK);
        // Two sizes, because loops of known length do without a remainder; so long most blocks are.
        if let Ok(few) = <&[_; FEW]>::try_from(position_m) {
            self.find_all(axes, few);
        } else if let Some(most) = position_m.first_chunk::<MAX_BLOCK>() {
            self.find_all(axes, most);
        } else {
            // What lies beyond the last is found as well and means nothing.
            let mut some = [[0.0; 2]; MAX_BLOCK];
            some.iter_mut().zip(position_m).for_each(|(to, at_m)| *to = *at_m);
            self.find_all(axes, &some);
        }
    }

    #[inline(always)]
    fn find_all<const N: usize>(&mut self, axes: &[Axis; 2], position_m: &[[f64; 2]; N]) {
        // For the usual maps, which repeat, in a loop without branches.
        if axes.iter().all(|axis| axis.wrap == Wrap::Repeat) {
            self.find_each(axes.map(|axis| Axis { wrap: Wrap::Repeat, ..axis }), position_m);
        } else {
            self.find_each(*axes, position_m);
        }
    }

    #[inline(always)]
    fn find_each<const N: usize>(&mut self, [along_u, along_v]: [Axis; 2], position_m: &[[f64; 2]; N]) {
        let Self { columns, rows, .. } = self;
        for (n, [u_m, v_m]) in position_m.iter().enumerate() {
            let (column, row) = (along_u.place(*u_m), along_v.place(*v_m));
            (columns.texel[n], columns.fraction[n], columns.slope[n]) =
                (column.texel, column.fraction, column.slope);
            (rows.texel[n], rows.fraction[n], rows.slope[n]) = (row.texel, row.fraction, row.slope);
        }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Column and row of the texel before a place.
    #[inline(always)]
    pub(super) fn texel(&self, n: usize) -> [f64; 2] {
        [self.columns.texel[n], self.rows.texel[n]]
    }

    /// One past the last place in a row that lies between the same texels as place `start`.
    #[inline(always)]
    pub(super) fn end_of_cell<const N: usize, V: Vector<N>>(&self, v: V, start: usize) -> usize {
        let [column, row] = self.texel(start).map(|texel| v.splat(texel));
        let mut end = start;
        while end < self.len {
            let columns = v.equal_lanes(v.load(room(&self.columns.texel, end)), column);
            let rows = v.equal_lanes(v.load(room(&self.rows.texel, end)), row);
            let same = columns.min(rows);
            end += same;
            if same < N {
                break;
            }
        }
        // At least the place itself, whatever it is: a loop over cells must end.
        end.max(start + 1).min(self.len)
    }

    /// The texel at the end of the block, and how far it is from the one at its beginning: as far
    /// again, the next block will end. `None` for a finger that stays.
    #[inline(always)]
    pub(super) fn ahead(&self) -> Option<([f64; 2], [f64; 2])> {
        let last = self.texel(self.len.checked_sub(1)?);
        let first = self.texel(0);
        let step = [last[0] - first[0], last[1] - first[1]];
        (step != [0.0; 2]).then_some((last, step))
    }

    /// The places along u and along v.
    #[inline(always)]
    pub(super) fn by_axis(&self) -> [&AxisPlaces; 2] {
        [&self.columns, &self.rows]
    }
}

impl AxisPlaces {
    const EMPTY: Self = Self { texel: [0.0; ROOM], fraction: [0.0; ROOM], slope: [0.0; ROOM] };

    /// Distances of N places from `n` on beyond their texels.
    #[inline(always)]
    pub(super) fn fraction<const N: usize>(&self, n: usize) -> &[f64; N] {
        room(&self.fraction, n)
    }

    /// Their slopes.
    #[inline(always)]
    pub(super) fn slope<const N: usize>(&self, n: usize) -> &[f64; N] {
        room(&self.slope, n)
    }
}

/// N places from `n` on; a block has room for whole vectors.
#[inline(always)]
fn room<const N: usize>(values: &[f64; ROOM], n: usize) -> &[f64; N] {
    values.get(n..).and_then(<[f64]>::first_chunk).unwrap_or(const { &[0.0; N] })
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
    pub(super) fn new(len: usize, extent_m: f64, wrap: Wrap) -> Self {
        let period = if wrap == Wrap::Mirror { 2 * len } else { len };
        Self {
            wrap,
            len: len as f64,
            per_period: 1.0 / period as f64,
            texels_per_metre: len as f64 / extent_m,
            last_first: (len + 2 * PAD - 4) as i64,
        }
    }

    /// Texels per metre.
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.len as usize
    }

    pub(super) fn texels_per_metre(&self) -> f64 {
        self.texels_per_metre
    }

    /// The texel before all positions between two, of a map that repeats: [`place`](Self::place)
    /// grows with the position within a copy of the map, so that what is alike at both ends is so
    /// between them. None where it differs.
    #[inline(always)]
    fn only_texel(&self, low_m: f64, high_m: f64) -> Option<OnlyTexel> {
        let [low, high] = [low_m, high_m].map(|at_m| at_m * self.texels_per_metre - 0.5);
        let copies = [low, high].map(|t| self.len * floor((t + 0.5) * self.per_period));
        let texels = [floor(low - copies[0]), floor(high - copies[1])];
        let alike = copies[0] == copies[1] && texels[0] == texels[1] && low.abs() < 1e15 && high.abs() < 1e15;
        (alike && self.wrap == Wrap::Repeat).then_some(OnlyTexel { copy: copies[0], texel: texels[0] })
    }

    /// Distance of a position beyond that texel, by the steps of [`place`](Self::place).
    #[inline(always)]
    fn extension(&self, only: OnlyTexel, position_m: f64) -> f64 {
        ((position_m * self.texels_per_metre - 0.5) - only.copy) - only.texel
    }

    /// Place of a position.
    #[inline(always)]
    pub(super) fn place(&self, position_m: f64) -> Place {
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

    /// Index of the first of the four coefficients around a texel and the next. Rounding at the
    /// seam may reach one texel beyond it, which is there; the clamp is for certainty.
    #[inline]
    pub(super) fn first(&self, texel: f64) -> usize {
        (texel as i64 + PAD as i64 - 1).clamp(0, self.last_first) as usize
    }
}
