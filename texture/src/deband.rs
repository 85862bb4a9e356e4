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
use crate::spline::transpose;
use crate::wrap::Wrap;

/// Radii of the running means, texels.
const RADII: [usize; 6] = [1, 2, 4, 8, 16, 32];
/// Largest distance of a smooth map from the stored number, steps: rounding, and a little for
/// values that were rounded twice.
const TOLERANCE_STEPS: f64 = 0.52;
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
        let once = smooth(map, radius, wrap);
        let twice = smooth(&once, radius, wrap);
        let mut candidate = once;
        for (b, bb) in candidate.values.iter_mut().zip(&twice.values) {
            *b = 2.0 * *b - bb;
        }
        let mut doubt = candidate.clone();
        for (doubt, q) in doubt.values.iter_mut().zip(&map.values) {
            *doubt = if (*doubt - q).abs() > TOLERANCE_STEPS * step { 1.0 } else { 0.0 };
        }
        if doubt.mean() == 1.0 {
            break;
        }
        let doubt = smooth(&doubt, radius, wrap);
        let mut used = false;
        for ((out, b), doubt) in result.values.iter_mut().zip(&candidate.values).zip(&doubt.values) {
            let trust = (1.0 - doubt / RULED_OUT).max(0.0);
            used |= trust > 0.0;
            *out += trust * (b - *out);
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

/// Three running means of 2 · radius + 1 texels along rows and along columns.
fn smooth(map: &Raster, radius: usize, wrap: Wrap) -> Raster {
    transpose(&smooth_rows(&transpose(&smooth_rows(map, radius, wrap)), radius, wrap))
}

fn smooth_rows(map: &Raster, radius: usize, wrap: Wrap) -> Raster {
    let n = map.width;
    let reach = 3 * radius;
    let index: Vec<usize> = (0..n + 2 * reach).map(|i| wrap.index(i as i64 - reach as i64, n)).collect();
    let mut values = Vec::with_capacity(map.values.len());
    let mut line = vec![0.0; index.len()];
    for y in 0..map.height {
        let row = map.row(y);
        line.resize(index.len(), 0.0);
        for (out, &i) in line.iter_mut().zip(&index) {
            *out = row[i];
        }
        for _ in 0..3 {
            running_mean(&mut line, radius);
        }
        values.extend_from_slice(&line);
    }
    Raster { width: n, height: map.height, values }
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
