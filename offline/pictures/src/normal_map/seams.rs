//! Tiling test of a normal map, by two questions at each seam: do the slopes go on, and do the
//! heights?
//!
//! ```text
//! t = (A − N)/(F − N)        j = (mean (z_first − z_last − step)²)/(2 var z)        open: t' + j > 1.3 at either seam
//! ```
//! | symbol | here |
//! |---|---|
//! | A | mean square of the difference of slopes across the seam, both summed, of means over s × s texels, s = 1, 2, 4, 8, 16 |
//! | N | the same between neighbours inside, at whichever place of JPEG's blocks of eight it is the largest |
//! | F | the same between a border and any place |
//! | z | heights of the slopes' means over a 128th of the smaller side, integrated as of a map that ends |
//!
//! t is 0 where a seam is like any other place and 1 where both sides have nothing to do with each
//! other. The scales are weighed by how many differences there are and how much neighbours are
//! alike, k = n ((F − N)/F)²; t' = Σ k t/(Σ k + 30), so that rough or noisy maps, where no seam can
//! be seen, are taken to tile. JPEG rounds blocks apart, at a seam as anywhere else, and means of
//! blocks hardly at all. Some cuts have slopes that happen to go on; their heights do not: j is
//! about 1 in a cut, and above 0.3 together with a step of the slopes many times those next to it
//! in a smooth one. Long waves of normals that were painted or put together need not close, so that
//! j is at most what it is by its waves from a third of the seam down, each over its own power, and
//! counts the less the more of the slopes is none of any surface. A small cut has few rows, and
//! what lies near its borders may be flat on one side: a step of the normals that is 1.8 times the
//! largest one inside ends a map whatever else, because a seam of one that tiles is a place like
//! any other.
//!
//! Measured, before that last rule, on 26 public sets in twelve variants each (halved, enlarged,
//! cut, JPEG 75 to 95; numpy): 15 of 208 that tile are taken for ones that do not, all rough or
//! nearly flat and noisy; of 104 cuts 30 are taken to tile: 11 of patterns that do repeat there, 19
//! of rough or flat ones whose seam cannot be seen.

use crate::gradient_field::{Derivative, Slopes, integrate_open};
use asperity_surface::raster::Raster;
use std::f64::consts::TAU;

/// t' + j from which a map does not tile.
const ENDS: f64 = 1.3;
/// A over the mean square of the steps on both sides of a seam, and j, from which a map does not
/// tile whatever else: a smooth one.
const STEP: f64 = 12.0;
const SEEN_JUMP: f64 = 0.3;
/// Step of normals across a seam over the largest inside from which a map does not tile, and fewest
/// steps that show it. Source: ours; of 27 public sets in eight variants each those that tile stay
/// below 1.46, of 150 made ones in five below 1.64; half of the cuts are above 1.8.
const OUTSTANDING: f64 = 1.8;
const ENOUGH_STEPS: usize = 32;
/// Evidence that counts half.
const DOUBT: f64 = 30.0;
/// Sides of the means, texels.
const SCALES: [usize; 5] = [1, 2, 4, 8, 16];
/// JPEG's blocks.
const BLOCK: usize = 8;
/// Means along the smaller side whose heights are asked.
const MEANS: usize = 128;
/// Share of the slopes' power that no surface has from which heights show nothing.
const NO_SURFACE: f64 = 0.5;
/// Longest wave along a seam whose jump is asked: this many fit into it.
const FIRST_WAVE: usize = 3;
/// Largest j, and largest share of one wave in it: a cut has 1 on average.
const MOST_JUMP: f64 = 1.5;
const MOST_OF_WAVE: f64 = 3.0;

/// Tests whether slopes and heights go on across both seams.
pub(super) fn tiles(field: &Slopes) -> bool {
    let turned = Slopes { along_u: field.along_v.transposed(), along_v: field.along_u.transposed() };
    let [ju, jv] = heights_end(field);
    let ends = |slopes: &Slopes, jump: f64| {
        slopes_end(slopes) + jump > ENDS || (jump > SEEN_JUMP && has_step(slopes)) || stands_out(slopes)
    };
    !ends(field, ju) && !ends(&turned, jv)
}

/// t' from the last column to the first.
fn slopes_end(field: &Slopes) -> f64 {
    let (mut sum, mut evidence) = (0.0, 0.0);
    let width = field.along_u.width;
    for scale in SCALES.into_iter().take_while(|scale| width >= 6 * scale && field.along_u.height >= *scale) {
        let mut at = Differences::default();
        for slope in [&field.along_u, &field.along_v] {
            at.add(slope, scale);
        }
        let (across, near, far) = at.means();
        if far > near {
            let weight = at.rows * ((far - near) / far).powi(2);
            sum += weight * ((across - near) / (far - near)).clamp(-1.0, 2.0);
            evidence += weight;
        }
    }
    sum / (evidence + DOUBT)
}

/// Tests whether slopes change many times more across the seam than next to it.
fn has_step(field: &Slopes) -> bool {
    let (mut across, mut next) = (0.0, 0.0);
    for slope in [&field.along_u, &field.along_v] {
        let w = slope.width;
        for row in slope.values.chunks_exact(w) {
            across += (row[0] - row[w - 1]).powi(2);
            next += 0.5 * ((row[1] - row[0]).powi(2) + (row[w - 2] - row[w - 1]).powi(2));
        }
    }
    across > STEP * next
}

/// Tests whether the step of either normal's component across the seam, mean square of all rows, is
/// larger than any between neighbours inside: in a map that tiles a seam is a place like any other.
/// Normals, because a few walls outweigh the rest of a map's slopes.
fn stands_out(field: &Slopes) -> bool {
    let (width, rows) = (field.along_u.width, field.along_u.height);
    let mut steps = vec![[0.0; 2]; width];
    for y in 0..rows {
        let normal = |x: usize| {
            let (p, q) = (field.along_u.at(x, y), field.along_v.at(x, y));
            [p, q].map(|slope| slope / (1.0 + p * p + q * q).sqrt())
        };
        let mut before = normal(width - 1);
        for (x, step) in steps.iter_mut().enumerate() {
            let here = normal(x);
            step.iter_mut().zip(before.iter().zip(here)).for_each(|(sum, (a, b))| *sum += (b - a).powi(2));
            before = here;
        }
    }
    let Some(([across], inside)) = steps.split_first_chunk() else { return false };
    let largest = |axis: usize| inside.iter().map(|step| step[axis]).fold(0.0, f64::max);
    width >= ENOUGH_STEPS && (0..2).any(|axis| across[axis] > OUTSTANDING.powi(2) * largest(axis))
}

/// Sums of squares of differences of means of slopes.
#[derive(Default)]
struct Differences {
    rows: f64,
    across: f64,
    /// By the place of the border between both in blocks of eight, and how many.
    near: [[f64; 2]; BLOCK],
    far: f64,
}

impl Differences {
    fn add(&mut self, slope: &Raster, scale: usize) {
        let width = slope.width;
        for band in slope.values.chunks_exact(width * scale) {
            let mut sums = vec![0.0; width + 1];
            for x in 0..width {
                let column: f64 = (0..scale).map(|y| band[y * width + x]).sum();
                sums[x + 1] = sums[x] + column / (scale * scale) as f64;
            }
            let means: Vec<f64> = (0..=width - scale).map(|x| sums[x + scale] - sums[x]).collect();
            let (first, last) = (means[0], means[width - scale]);
            self.rows += 1.0;
            self.across += (first - last).powi(2);
            for (x, pair) in means.windows(scale + 1).enumerate() {
                let [square, count] = &mut self.near[(x + scale) % BLOCK];
                *square += (pair[0] - pair[scale]).powi(2);
                *count += 1.0;
            }
            let mean = means.iter().sum::<f64>() / means.len() as f64;
            let square = means.iter().map(|m| m * m).sum::<f64>() / means.len() as f64;
            self.far += square + 0.5 * (first * first + last * last) - (first + last) * mean;
        }
    }

    /// A, N and F.
    fn means(&self) -> (f64, f64, f64) {
        let near = self.near.iter().filter(|n| n[1] > 0.0).map(|n| n[0] / n[1]).fold(0.0, f64::max);
        (self.across / self.rows, near, self.far / self.rows)
    }
}

/// j at the seams of u and v.
fn heights_end(field: &Slopes) -> [f64; 2] {
    let (w, h) = (field.along_u.width, field.along_u.height);
    let texels = (w.min(h) / MEANS).max(1);
    let mut coarse = Slopes {
        along_u: means(&field.along_u, [w / texels, h / texels]),
        along_v: means(&field.along_v, [w / texels, h / texels]),
    };
    for slope in [&mut coarse.along_u, &mut coarse.along_v] {
        let mean = slope.mean();
        slope.values.iter_mut().for_each(|s| *s -= mean);
    }
    let (heights, no_surface) = nearer_surface(&mut coarse);
    let believed = (1.0 - no_surface / NO_SURFACE).max(0.0);
    let variance = heights.values.iter().map(|z| z * z).sum::<f64>() / heights.values.len() as f64;
    let jump = |z: &Raster, slope: &Raster| {
        let last = z.width - 1;
        let jump: Vec<f64> = (0..z.height)
            .map(|y| z.at(0, y) - z.at(last, y) - 0.5 * (slope.at(0, y) + slope.at(last, y)))
            .collect();
        let whole =
            jump.iter().map(|d| d * d).sum::<f64>() / (2.0 * variance * jump.len() as f64).max(1e-300);
        believed * whole.min(by_waves(&jump, z)).min(MOST_JUMP)
    };
    [jump(&heights, &coarse.along_u), jump(&heights.transposed(), &coarse.along_v.transposed())]
}

/// The heights of slopes along v that point up or down, whichever leave less, which the slopes then
/// do, and the share they leave.
fn nearer_surface(slopes: &mut Slopes) -> (Raster, f64) {
    let mut ask = || {
        let heights = integrate_open(slopes, Derivative::Exact);
        let left = no_surface(slopes, &heights);
        slopes.along_v.values.iter_mut().for_each(|q| *q = -*q);
        (heights, left)
    };
    let (up, down) = (ask(), ask());
    let (heights, left) = if up.1 <= down.1 {
        up
    } else {
        slopes.along_v.values.iter_mut().for_each(|q| *q = -*q);
        down
    };
    (without_slant(heights), left)
}

/// Power of a jump's waves over twice that of the columns', mean.
fn by_waves(jump: &[f64], heights: &Raster) -> f64 {
    let n = jump.len();
    let hann: Vec<f64> = (0..n).map(|y| 0.5 - 0.5 * (TAU * (y as f64 + 0.5) / n as f64).cos()).collect();
    let total: f64 = hann.iter().sum();
    let windowed = |column: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let mean = (0..n).map(|y| hann[y] * column(y)).sum::<f64>() / total;
        (0..n).map(|y| hann[y] * (column(y) - mean)).collect()
    };
    let power = |values: &[f64], wave: usize| {
        let turn = TAU * wave as f64 / n as f64;
        let (re, im) = values.iter().enumerate().fold((0.0, 0.0), |(re, im), (y, value)| {
            let (sin, cos) = (turn * y as f64).sin_cos();
            (re + value * cos, im + value * sin)
        });
        re * re + im * im
    };
    let jump = windowed(&|y| jump[y]);
    let columns: Vec<Vec<f64>> = (0..heights.width).map(|x| windowed(&|y| heights.at(x, y))).collect();
    let waves = FIRST_WAVE..(n / 6).max(2 * FIRST_WAVE);
    let count = waves.len() as f64;
    let share = |wave: usize| {
        let of_columns = columns.iter().map(|c| power(c, wave)).sum::<f64>() / columns.len() as f64;
        (power(&jump, wave) / (2.0 * of_columns).max(1e-300)).min(MOST_OF_WAVE)
    };
    waves.map(share).sum::<f64>() / count
}

/// Share of the power of steps between neighbouring means that these heights do not have.
fn no_surface(slopes: &Slopes, heights: &Raster) -> f64 {
    let (mut left, mut all) = (0.0, 0.0);
    for y in 0..heights.height {
        for x in 0..heights.width {
            let mut ask = |slope: &Raster, to: (usize, usize)| {
                let step = 0.5 * (slope.at(x, y) + slope.at(to.0, to.1));
                left += (heights.at(to.0, to.1) - heights.at(x, y) - step).powi(2);
                all += step * step;
            };
            if x + 1 < heights.width {
                ask(&slopes.along_u, (x + 1, y));
            }
            if y + 1 < heights.height {
                ask(&slopes.along_v, (x, y + 1));
            }
        }
    }
    if all > 0.0 { left / all } else { 0.0 }
}

/// Means of slopes over so many rectangles, as slopes of the same surface whose texels they are.
fn means(slope: &Raster, [w, h]: [usize; 2]) -> Raster {
    let size = slope.width as f64 / w as f64;
    let border = |i: usize, n: usize, of: usize| i * of / n;
    Raster::from_fn(w, h, |x, y| {
        let (left, right) = (border(x, w, slope.width), border(x + 1, w, slope.width));
        let rows = border(y, h, slope.height)..border(y + 1, h, slope.height);
        let count = (rows.len() * (right - left)) as f64;
        rows.map(|y| slope.row(y)[left..right].iter().sum::<f64>()).sum::<f64>() * size / count
    })
}

/// Heights without the plane nearest to them.
fn without_slant(mut heights: Raster) -> Raster {
    let (w, h) = (heights.width, heights.height);
    let middle = |i: usize, n: usize| i as f64 - 0.5 * (n - 1) as f64;
    let mean = heights.mean();
    let (mut u, mut v, mut uu, mut vv) = (0.0, 0.0, 0.0, 0.0);
    for (i, z) in heights.values.iter().enumerate() {
        let (x, y) = (middle(i % w, w), middle(i / w, h));
        (u, v, uu, vv) = (u + x * z, v + y * z, uu + x * x, vv + y * y);
    }
    for (i, z) in heights.values.iter_mut().enumerate() {
        *z -= mean + u / uu * middle(i % w, w) + v / vv * middle(i / w, h);
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Slopes of waves that fit into 128 texels; with steps of `blocks` at the borders of blocks of
    /// eight.
    fn waves(width: usize, blocks: f64) -> Slopes {
        let slope = |along_v: bool| {
            Raster::from_fn(width, 128, |x, y| {
                let (u, v) = (TAU * x as f64 / 128.0, TAU * y as f64 / 128.0);
                let (first, second) = (3.0 * u + 0.3, 2.0 * u - 5.0 * v + 1.7);
                let turn = f64::from(u8::from(along_v));
                let block = blocks * (7.0 * (x / 8) as f64 + 11.0 * (y / 8) as f64 + turn).sin();
                let waves =
                    if along_v { -5.0 * second.cos() } else { 3.0 * first.cos() + 2.0 * second.cos() };
                waves + 3.0 * block
            })
        };
        Slopes { along_u: slope(false), along_v: slope(true) }
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

    /// Slopes of a box on a flat ground, whose middle is `at` this column.
    fn box_on_ground(width: usize, at: f64) -> Slopes {
        let side = |d: f64| if d.abs() < 8.0 { -0.5 * (TAU * d / 16.0).sin() } else { 0.0 };
        let along_u = Raster::from_fn(width, 96, |x, _| side((x as f64 - at).abs() - 30.0));
        Slopes { along_v: along_u.map(|slope| 0.3 * slope), along_u }
    }

    /// A toy box cut through its side was taken to tile: the heights go on by chance, and most of
    /// the map is flat.
    #[test]
    fn a_cut_through_a_boxs_side_stands_out() {
        for width in [96, 150, 216] {
            let middle = 0.5 * width as f64;
            assert!(!stands_out(&box_on_ground(width, middle)), "{width}");
            let cut = box_on_ground(width, 34.0);
            assert!(stands_out(&cut) && !tiles(&cut), "{width}");
        }
        // Too few steps show nothing.
        assert!(!stands_out(&box_on_ground(24, 28.0)));
    }

    #[test]
    fn a_flat_map_tiles() {
        let flat = Raster::constant(16, 16, 0.0);
        assert!(tiles(&Slopes { along_u: flat.clone(), along_v: flat }));
    }

    #[test]
    fn smooth_waves_that_nearly_fit_do_not_tile() {
        let slopes = |x: usize, y: usize| {
            let (u, v) = (0.11 * x as f64, 0.07 * y as f64);
            [0.11 * u.cos() * v.cos(), -0.07 * u.sin() * v.sin()]
        };
        let slope = |axis: usize| Raster::from_fn(120, 90, |x, y| slopes(x, y)[axis]);
        assert!(!tiles(&Slopes { along_u: slope(0), along_v: slope(1) }));
    }

    #[test]
    fn ground_cut_where_slopes_continue_does_not_tile() {
        // Slopes repeat after 128 texels along u, heights do not: every row climbs by what its
        // neighbours do not.
        let climb = |y: usize| (TAU * 5.0 * y as f64 / 128.0).sin();
        let along_u = Raster::from_fn(128, 128, |x, y| {
            0.06 * climb(y) + (TAU * 9.0 * x as f64 / 128.0).cos() * (TAU * 4.0 * y as f64 / 128.0).cos()
        });
        let along_v = Raster::from_fn(128, 128, |x, y| {
            let (u, v) = (TAU * x as f64 / 128.0, TAU * y as f64 / 128.0);
            0.06 * x as f64 * TAU * 5.0 / 128.0 * (5.0 * v).cos()
                - 4.0 / 9.0 * (9.0 * u).sin() * (4.0 * v).sin()
        });
        assert!(!tiles(&Slopes { along_u, along_v }));
    }
}
