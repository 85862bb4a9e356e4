//! Box, information and correlation dimension: the relief cut into grid cubes.
//!
//! For cubes of side δ let p_i be the share of all surface points in cube i, over the occupied ones:
//! D_B = slope of ln N, D_I of −Σ p ln p, D_C of −ln Σ p², each against ln 1/δ (thesis Def. 6.4; lemma 6.1
//! lost the logarithm before N in print).
//!
//! | symbol | here |
//! |---|---|
//! | δ | [`CUBE_SIDES`], texels and grey levels |
//! | p_i | points in a cube over `points` |
//!
//! The vertical unit is one of 256 grey levels between the lowest and the highest height, as in the document's pictures, so
//! that the estimates depend neither on contrast nor on the unit of height. Rough surfaces then have
//! fewer points than cubes and the count saturates: the document measures 2.22, 2.36, 2.44 for true 2.2, 2.5, 2.8.

use super::{DimensionError, check, slope};
use crate::raster::Raster;

/// Sides of the cubes, texels (and grey levels).
pub const CUBE_SIDES: [usize; 5] = [2, 4, 8, 16, 32];

/// Grey levels between the lowest and the highest height.
const LEVELS: usize = 256;

/// The three dimensions that grid cubes give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubeDimensions {
    /// D_B, from the number of occupied cubes.
    pub box_counting: f64,
    /// D_I, from the entropy of the occupation.
    pub information: f64,
    /// D_C, from the chance that two points share a cube.
    pub correlation: f64,
}

/// Box, information and correlation dimension of a picture. Texels beyond the last whole cube of the
/// largest side are left out, so that every side sees the same points.
///
/// # Errors
/// See [`DimensionError`].
pub fn cube_dimensions(picture: &Raster) -> Result<CubeDimensions, DimensionError> {
    check(picture)?;
    let (low, high) = picture.range();
    if high <= low {
        return Err(DimensionError::Flat);
    }
    let largest = CUBE_SIDES[CUBE_SIDES.len() - 1];
    let (width, height) = (picture.width / largest * largest, picture.height / largest * largest);
    let scale = (LEVELS - 1) as f64 / (high - low);
    let levels = Raster::from_fn(width, height, |x, y| ((picture.at(x, y) - low) * scale).round());

    let mut lines = [[(0.0, 0.0); CUBE_SIDES.len()]; 3];
    for (i, &side) in CUBE_SIDES.iter().enumerate() {
        let occupation = occupation(&levels, side);
        let resolution = -(side as f64).ln();
        lines[0][i] = (resolution, occupation.cubes.ln());
        lines[1][i] = (resolution, occupation.entropy);
        lines[2][i] = (resolution, -occupation.coincidence.ln());
    }
    Ok(CubeDimensions {
        box_counting: slope(&lines[0]),
        information: slope(&lines[1]),
        correlation: slope(&lines[2]),
    })
}

/// How the points of a relief fill the cubes of one side.
struct Occupation {
    /// N: number of cubes with a point.
    cubes: f64,
    /// −Σ p ln p.
    entropy: f64,
    /// Σ p².
    coincidence: f64,
}

fn occupation(levels: &Raster, side: usize) -> Occupation {
    let points = levels.values.len() as f64;
    let mut column = vec![0_u32; LEVELS / side];
    let mut found = Occupation { cubes: 0.0, entropy: 0.0, coincidence: 0.0 };
    for top in (0..levels.height).step_by(side) {
        for left in (0..levels.width).step_by(side) {
            column.fill(0);
            for y in top..top + side {
                for &level in &levels.row(y)[left..left + side] {
                    column[level as usize / side] += 1;
                }
            }
            for &inside in column.iter().filter(|&&n| n > 0) {
                let p = f64::from(inside) / points;
                found.cubes += 1.0;
                found.entropy -= p * p.ln();
                found.coincidence += p * p;
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_has_dimension_two_by_all_three_counts() {
        let plane = Raster::from_fn(256, 256, |x, _| x as f64);
        let found = cube_dimensions(&plane).unwrap();
        for d in [found.box_counting, found.information, found.correlation] {
            assert!((d - 2.0).abs() < 1e-12, "{d}");
        }
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
