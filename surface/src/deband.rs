//! Removes the terraces of a coarsely quantised map where it is gentle enough for them to be felt.
//!
//! 8 bits over 4 mm of relief are 15.7 µm a step. On a gentle ramp the steps leave 0.9 µm rms
//! between 40 and 1000 Hz under a finger at 0.1 m/s, nine times what can be felt; on a busy map
//! nobody feels them.
//!
//! For each radius from 1 to 32 texels the map q is smoothed by B (three running means along rows
//! and columns) with its bias taken back, b = 2 B q − B B q. Where b stays within half a step of q
//! all over the kernel's neighbourhood, it is as good an explanation of the stored numbers as q
//! itself, and takes its place; elsewhere the smaller radius (or q) stays. The largest radius that
//! explains the numbers wins. A busy texture contradicts even the smallest and is left as it is. No
//! texel moves by more than `TOLERANCE_STEPS` of a step.
//!
//! Steps are rounding only where there are many of them: a map of black and white, or of 4 or 16
//! even greys, shows edges (a constant at half height is within half a step of both levels of a
//! grating, and would be glass). So a map keeps its steps where one is above [`COARSEST_STEP`] of
//! white, or where its range has fewer than [`FEWEST_STEPS`] of them.
//!
//! Measured (`tests/height_map_figures.rs`): ramps of 3 to 40 texels a step fall from 2–4 µm to
//! below 0.004 µm in the band.

use crate::raster::Raster;
use crate::wrap::Wrap;
use std::ops::Range;

/// Radii of the running means, texels.
const RADII: [usize; 6] = [1, 2, 4, 8, 16, 32];
/// Largest distance of a smooth map from the stored number, steps: rounding, and a little for
/// values that were rounded twice.
const TOLERANCE_STEPS: f64 = 0.52;
/// Smallest side of a tile that is smoothed at once, texels, and how many radii it has at least:
/// the tile and nine radii on every side are in memory.
const TILE: usize = 256;
const MARGINS: usize = 16;
/// Share of contradicting texels in a neighbourhood that rules a radius out.
const RULED_OUT: f64 = 0.04;
/// Steps finer than this share of the range are left alone: over 4 mm, 1 µm.
pub const FINEST_STEP: f64 = 1.0 / 4000.0;
/// Steps coarser than this share of white are edges, not rounding: those of 6 bits.
pub const COARSEST_STEP: f64 = 1.0 / 63.0;
/// Steps between the lowest and the highest level of a map from which they are taken for rounding.
pub const FEWEST_STEPS: f64 = 4.0;

/// The map without terraces. `step` is the distance of neighbouring levels, as a share of white; a
/// map without steps, with steps finer than [`FINEST_STEP`], coarser than [`COARSEST_STEP`] or
/// fewer than [`FEWEST_STEPS`] comes back unchanged.
#[must_use]
pub fn deband(map: &Raster, step: f64, wrap: Wrap) -> Raster {
    let (low, high) = map.range();
    let is_rounding = (FINEST_STEP..=COARSEST_STEP * (1.0 + 1e-9)).contains(&step);
    if !is_rounding || high - low < (FEWEST_STEPS - 1e-9) * step {
        return map.clone();
    }
    let mut result = map.clone();
    for radius in RADII {
        if 2 * radius >= map.width.max(map.height) {
            break;
        }
        let mut used = false;
        let side = TILE.max(MARGINS * radius);
        for top in (0..map.height).step_by(side) {
            for left in (0..map.width).step_by(side) {
                let tile = [left..(left + side).min(map.width), top..(top + side).min(map.height)];
                used |= smooth_tile(map, step, wrap, radius, tile, &mut result);
            }
        }
        if !used {
            break;
        }
    }
    let furthest = TOLERANCE_STEPS * step;
    for (out, q) in result.values.iter_mut().zip(&map.values) {
        *out = out.clamp(q - furthest, q + furthest);
    }
    result
}

/// Columns and rows of a map.
type Tile = [Range<usize>; 2];

/// Puts what explains a tile of the map over this radius into its place; returns if anything does.
/// Tile by tile a large map needs little memory beside its own, and the numbers of a tile stay in
/// the cache.
fn smooth_tile(
    map: &Raster,
    step: f64,
    wrap: Wrap,
    radius: usize,
    [columns, rows]: Tile,
    result: &mut Raster,
) -> bool {
    let reach = 3 * radius;
    let extension = |of: &Range<usize>, len: usize, margins: usize| -> Vec<usize> {
        let margin = (margins * reach) as i64;
        (of.start as i64 - margin..of.end as i64 + margin).map(|i| wrap.index(i, len)).collect()
    };
    let cut = |margins: usize| {
        let (columns, rows) =
            (extension(&columns, map.width, margins), extension(&rows, map.height, margins));
        Raster::from_fn(columns.len(), rows.len(), |x, y| map.at(columns[x], rows[y]))
    };
    let once = smooth(cut(3), radius);
    let mut candidate = smooth(once.clone(), radius);
    let mut doubt = cut(1);
    for y in 0..candidate.height {
        let once = &once.row(y + reach)[reach..];
        let at = y * candidate.width;
        let found = candidate.values[at..].iter_mut().zip(once).take(doubt.width);
        for ((b, once), doubt) in found.zip(&mut doubt.values[at..]) {
            *b = 2.0 * once - *b;
            *doubt = if (*b - *doubt).abs() > TOLERANCE_STEPS * step { 1.0 } else { 0.0 };
        }
    }
    drop(once);
    let doubt = smooth(doubt, radius);
    let mut used = false;
    for (y, row) in rows.enumerate() {
        let out = &mut result.values[row * map.width..][columns.clone()];
        let candidate = &candidate.row(y + reach)[reach..];
        for ((out, b), doubt) in out.iter_mut().zip(candidate).zip(doubt.row(y)) {
            let trust = (1.0 - doubt / RULED_OUT).max(0.0);
            used |= trust > 0.0;
            *out += trust * (b - *out);
        }
    }
    used
}

/// Three running means of 2 · radius + 1 texels along rows and along columns; the map loses three
/// radii on every side.
fn smooth(map: Raster, radius: usize) -> Raster {
    let Raster { width: before, mut height, mut values } = map;
    let width = before - 6 * radius;
    let mut line = Vec::with_capacity(before);
    for y in 0..height {
        line.clear();
        line.extend_from_slice(&values[y * before..][..before]);
        (0..3).for_each(|_| running_mean(&mut line, radius));
        values[y * width..][..width].copy_from_slice(&line);
    }
    for _ in 0..3 {
        running_mean_of_rows(&mut values, width, &mut height, radius);
    }
    values.truncate(width * height);
    Raster { width, height, values }
}

/// [`running_mean`] of every column; `height` rows become fewer.
fn running_mean_of_rows(values: &mut [f64], width: usize, height: &mut usize, radius: usize) {
    let size = 2 * radius + 1;
    *height -= 2 * radius;
    let mut sum = vec![0.0; width];
    for row in values.chunks_exact(width).take(size - 1) {
        sum.iter_mut().zip(row).for_each(|(sum, v)| *sum += v);
    }
    for y in 0..*height {
        let (first, last) = values[y * width..].split_at_mut((size - 1) * width);
        for ((sum, first), last) in sum.iter_mut().zip(first).zip(&*last) {
            *sum += last;
            let used = *first;
            *first = *sum / size as f64;
            *sum -= used;
        }
    }
}

/// The mean of every 2 · radius + 1 neighbours, in place; the line loses `radius` at either end.
fn running_mean(line: &mut Vec<f64>, radius: usize) {
    let size = 2 * radius + 1;
    let len = line.len() - 2 * radius;
    let mut sum: f64 = line[..size - 1].iter().sum();
    // Output i is written where input i has just been used for the last time.
    for i in 0..len {
        sum += line[i + size - 1];
        let first = line[i];
        line[i] = sum / size as f64;
        sum -= first;
    }
    line.truncate(len);
}
