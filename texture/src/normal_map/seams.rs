//! Whether a normal map tiles: its slopes on both sides of a seam against those of columns that have nothing to do with each other.
//!
//! ```text
//! across = mean (a − b)² across the seam        far = its mean over a border and all columns        near = between a border and the column next to it
//! ```
//! with both slopes summed. A map that tiles has across ≈ near. JPEG rounds the texels on both sides of a seam apart, and blurs those on one side
//! of it together: there it is many times near, but still below far, which it is in a map cut from a larger one. JPEG does the same at the
//! borders of its blocks of eight texels, by which it is known.
//!
//! Measured over 17 map sets of others, whole, halved, cropped, each also as JPEG: across/far 0.03–0.85 where they tile, and above that only where JPEG left little of
//! the relief; 0.88–1.7 where they do not, and below that only where no seam can be seen (across < 1.6² near in four sets of five).

use crate::gradient_field::Slopes;
use crate::raster::Raster;

/// Largest across/far of a map that tiles. Source: ours, see above.
const UNLIKE: f64 = 0.85;
/// across/near up to which nothing is seen of a seam.
const UNSEEN: f64 = 1.25 * 1.25;
/// The same of a map that tiles where nothing is known of JPEG.
const FROM_NOISE: f64 = 12.0;
/// Share of steps across the borders of blocks that are larger than the steps on both sides of them, from which a map was a JPEG. Chance gives ⅓, maps that were none
/// up to 0.35, JPEGs 0.36–0.69.
const BLOCKS: f64 = 0.37;
/// Fewest steps that tell.
const FEWEST: f64 = 500.0;

/// Whether slopes go on across both seams.
pub(super) fn tiles(field: &Slopes) -> bool {
    let turned = Slopes { along_u: transposed(&field.along_u), along_v: transposed(&field.along_v) };
    let jpeg =
        [&field.along_u, &field.along_v, &turned.along_u, &turned.along_v].iter().any(|s| has_blocks(s));
    [field, &turned].iter().all(|field| goes_on(field, jpeg))
}

/// Whether slopes go on from the last column to the first.
fn goes_on(field: &Slopes, jpeg: bool) -> bool {
    let (mut across, mut near, mut far) = (0.0, 0.0, 0.0);
    for slope in [&field.along_u, &field.along_v] {
        let w = slope.width;
        for row in slope.values.chunks_exact(w) {
            let (first, last) = (row[0], row[w - 1]);
            across += (first - last).powi(2);
            near += 0.5 * ((row[1] - first).powi(2) + (row[w - 2] - last).powi(2));
            let mean = row.iter().sum::<f64>() / w as f64;
            let square = row.iter().map(|s| s * s).sum::<f64>() / w as f64;
            far += square + 0.5 * (first * first + last * last) - (first + last) * mean;
        }
    }
    across <= UNSEEN * near || (across <= UNLIKE * far && (jpeg || across <= FROM_NOISE * near))
}

/// Whether steps from the last column of JPEG's blocks of eight to the next are larger than their neighbours more often than chance has it.
fn has_blocks(slope: &Raster) -> bool {
    let (mut larger, mut all) = (0.0, 0.0);
    for row in slope.values.chunks_exact(slope.width) {
        for border in (8..slope.width.saturating_sub(1)).step_by(8) {
            let step = |x: usize| (row[x] - row[x - 1]).abs();
            let [before, at, after] = [border - 1, border, border + 1].map(step);
            if before.max(at).max(after) > 0.0 {
                all += 1.0;
                larger += f64::from(u8::from(at > before && at > after));
            }
        }
    }
    all >= FEWEST && larger > BLOCKS * all
}

fn transposed(raster: &Raster) -> Raster {
    Raster::from_fn(raster.height, raster.width, |x, y| raster.at(y, x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Waves that fit into 128 texels; with steps of `blocks` at the borders of blocks of eight.
    fn waves(width: usize, blocks: f64) -> Slopes {
        let wave = |x: usize, y: usize, turn: f64| {
            let (u, v) = (TAU * x as f64 / 128.0, TAU * y as f64 / 128.0);
            let block = blocks * (7.0 * (x / 8) as f64 + 11.0 * (y / 8) as f64 + turn).sin();
            (3.0 * u + turn).cos() + (2.0 * u - 5.0 * v + turn).sin() + block
        };
        let slope = |turn: f64| Raster::from_fn(width, 128, |x, y| wave(x, y, turn));
        Slopes { along_u: slope(0.3), along_v: slope(1.7) }
    }

    #[test]
    fn waves_that_fit_tile_even_in_blocks_and_cut_ones_do_not() {
        for blocks in [0.0, 0.1, 0.5] {
            assert!(tiles(&waves(128, blocks)), "{blocks}");
        }
        for width in [82, 100, 114] {
            assert!(!tiles(&waves(width, 0.0)), "{width}");
        }
    }

    #[test]
    fn a_flat_map_tiles() {
        let flat = Raster::constant(16, 16, 0.0);
        assert!(tiles(&Slopes { along_u: flat.clone(), along_v: flat }));
    }

    #[test]
    fn smooth_waves_that_nearly_fit_do_not_tile() {
        let slope = |turn: f64| {
            Raster::from_fn(120, 90, |x, y| (0.11 * x as f64 + turn).sin() * (0.07 * y as f64).cos())
        };
        assert!(!tiles(&Slopes { along_u: slope(0.0), along_v: slope(1.5) }));
    }
}
