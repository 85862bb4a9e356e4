//! Box, information and correlation dimension: the relief's columns cut into grid cubes.
//!
//! A grey value is the height of a cuboid on its texel (thesis §6.2). The relief is then closed: a
//! texel's column has a top and walls down to its lower neighbours, and its neighbours' walls stand
//! on its border. With p_i the share of cube i in all (column, cube) pairs that touch, over the
//! touched cubes of side δ: D_B = slope of ln N, D_I of −Σ p ln p, D_C of −ln Σ p², each against ln
//! 1/δ (thesis Def. 6.4; lemma 6.1 lost the logarithm before N in print).
//!
//! | symbol | here |
//! |---|---|
//! | δ | [`CUBE_SIDES`], texels, of them those up to half the shorter side |
//! | cuboid's walls | [`Columns`]: from the lowest to the highest of the texel and its four neighbours |
//! | p_i | columns in a cube over all such pairs |
//!
//! The document is silent about the vertical unit and the sides of its cubes. Ours makes the range
//! of heights a quarter of the shorter side, so that the estimates depend neither on contrast nor
//! on the unit of height. The range was swept from an eighth to twice the side at 256², with
//! thirteen sets of sides: a quarter and 1 to 64 texels come nearest to the document's table, and
//! as there the three then agree with each other and with those of 130, 185 and 235 texels.
//! `analysis_table cubes` prints both tables. (Counting the tops alone, without walls, a rough
//! surface has fewer points than small cubes: D_B stayed at 1.97, 1.99, 1.93 where the document has
//! 2.22, 2.36, 2.44.)

use super::{DimensionError, check, slope};
use asperity_surface::raster::Raster;

/// Sides of the cubes, texels (and units of height).
pub const CUBE_SIDES: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];

/// Units of height from the lowest to the highest texel, a texel of the shorter side.
const LEVELS_PER_TEXEL: f64 = 0.25;

/// Most units of height: they are kept in bytes.
const MOST_LEVELS: usize = 256;

/// The three dimensions that grid cubes give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubeDimensions {
    /// D_B, from the number of touched cubes.
    pub box_counting: f64,
    /// D_I, from the entropy of the occupation.
    pub information: f64,
    /// D_C, from the chance that two columns share a cube.
    pub correlation: f64,
}

/// Box, information and correlation dimension of a picture. Where cubes of one side leave a strip
/// of texels, their numbers are scaled to the whole picture.
///
/// # Errors
/// See [`DimensionError`].
pub fn cube_dimensions(picture: &Raster) -> Result<CubeDimensions, DimensionError> {
    check(picture)?;
    let (low, high) = picture.range();
    if high <= low {
        return Err(DimensionError::Flat);
    }
    let shorter = picture.width.min(picture.height);
    let levels = ((LEVELS_PER_TEXEL * shorter as f64) as usize).min(MOST_LEVELS);
    let scale = (levels - 1) as f64 / (high - low);
    let columns = Columns::new(&picture.map(|v| ((v - low) * scale).round()), levels);

    let most = shorter / 2;
    let mut lines = [(); 3].map(|()| Vec::new());
    for side in CUBE_SIDES.into_iter().filter(|side| *side <= most) {
        let occupation = columns.occupation(side);
        let resolution = -(side as f64).ln();
        lines[0].push((resolution, (occupation.cubes / occupation.covered).ln()));
        lines[1].push((resolution, occupation.entropy - occupation.covered.ln()));
        lines[2].push((resolution, -(occupation.coincidence * occupation.covered).ln()));
    }
    Ok(CubeDimensions {
        box_counting: slope(&lines[0]),
        information: slope(&lines[1]),
        correlation: slope(&lines[2]),
    })
}

/// The heights that each texel's column and the walls on its border take, in whole units, both ends
/// included.
struct Columns {
    width: usize,
    height: usize,
    levels: usize,
    spans: Vec<[u8; 2]>,
}

/// Filling of the cubes of one side by the columns of a relief.
struct Occupation {
    /// N: number of cubes that a column touches.
    cubes: f64,
    /// −Σ p ln p.
    entropy: f64,
    /// Σ p².
    coincidence: f64,
    /// Share of the picture that whole cubes cover.
    covered: f64,
}

impl Columns {
    fn new(heights: &Raster, levels: usize) -> Self {
        let (width, height) = (heights.width, heights.height);
        let span = |i: usize| {
            let (x, y) = (i % width, i / width);
            let beside = [
                heights.at(x.saturating_sub(1), y),
                heights.at((x + 1).min(width - 1), y),
                heights.at(x, y.saturating_sub(1)),
                heights.at(x, (y + 1).min(height - 1)),
            ];
            let here = heights.at(x, y);
            [beside.into_iter().fold(here, f64::min) as u8, beside.into_iter().fold(here, f64::max) as u8]
        };
        Self { width, height, levels, spans: (0..width * height).map(span).collect() }
    }

    fn occupation(&self, side: usize) -> Occupation {
        let (columns, rows) = (self.width / side, self.height / side);
        let layers = self.levels.div_ceil(side);
        let mut counts: Vec<u32> = Vec::new();
        // How many more columns touch a cube than the one below it.
        let mut rise = vec![0_i32; layers + 1];
        for top in (0..rows * side).step_by(side) {
            for left in (0..columns * side).step_by(side) {
                rise.fill(0);
                for y in top..top + side {
                    for &[low, high] in &self.spans[y * self.width + left..][..side] {
                        rise[low as usize / side] += 1;
                        rise[high as usize / side + 1] -= 1;
                    }
                }
                let mut touching = 0;
                for change in &rise[..layers] {
                    touching += change;
                    if touching > 0 {
                        counts.push(touching.unsigned_abs());
                    }
                }
            }
        }
        let pairs: f64 = counts.iter().map(|&n| f64::from(n)).sum();
        let shares = || counts.iter().map(|&n| f64::from(n) / pairs);
        Occupation {
            cubes: counts.len() as f64,
            entropy: -shares().map(|p| p * p.ln()).sum::<f64>(),
            coincidence: shares().map(|p| p * p).sum(),
            covered: (columns * rows * side * side) as f64 / (self.width * self.height) as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_has_dimension_two_by_all_three_counts() {
        // Its steps' walls are touched from both sides, which the smallest cubes notice: 2.071 by
        // box counting, 2.092 by information.
        let plane = Raster::from_fn(256, 256, |x, _| x as f64);
        let found = cube_dimensions(&plane).unwrap();
        for d in [found.box_counting, found.information, found.correlation] {
            assert!((d - 2.0).abs() < 0.1, "{d}");
        }
    }

    #[test]
    fn a_wall_is_as_high_as_the_step_it_closes() {
        // Two flats, 63 units apart, with one step: 2 × 64 columns' walls beside 64 × 62 tops.
        let step = Columns::new(&Raster::from_fn(64, 64, |x, _| if x < 32 { 0.0 } else { 63.0 }), 64);
        assert_eq!(step.occupation(1).cubes, (64 * 62 + 2 * 64 * 64) as f64);
        assert_eq!(step.occupation(64).cubes, 1.0);
    }

    #[test]
    fn neither_contrast_nor_unit_changes_the_dimensions() {
        let relief = |gain: f64, offset: f64| {
            Raster::from_fn(128, 96, |x, y| {
                gain * (((x * 37 + y * 91) % 53) as f64 + ((x * y) % 17) as f64) + offset
            })
        };
        let (one, other) =
            (cube_dimensions(&relief(1.0, 0.0)).unwrap(), cube_dimensions(&relief(0.25, 8.0)).unwrap());
        assert_eq!(one, other);
    }
}
