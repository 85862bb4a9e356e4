//! Fractal dimension of a grey-value picture taken as a relief: how rough it feels, as one number.
//!
//! Source: thesis ch. 6 (Reuter's four estimators, Tab. 6.1) and Gneiting, Ševčíková & Percival,
//! "Estimators of fractal dimension", Statistical Science 27 (2012), for the recommended one.
//! Grey is height; a plane has D = 2, a surface that fills space has D = 3.
//!
//! | estimator | what it counts | file |
//! |---|---|---|
//! | box D_B, information D_I, correlation D_C | grid cubes of side δ ∈ {1, 2, … 64} that a texel's column or its walls touch | `grid_cubes` |
//! | probability D_P (Voss) | surface points in the cube of side L ∈ {3, 5, 7, 9, 13, 17} round each point | `probability` |
//! | recommended | height differences along every row and column, and their median | `transect` |
//!
//! The dimension becomes the roughness R of the engine's micro-noise in closed form, exact for
//! ideal fractional Brownian surfaces: H = 3 − D, profile power spectrum 1/f^α with α = 2H + 1 = 7
//! − 2D, and Hasti's α = 2.5 − 1.5 R gives R = (D − 2.25)/0.75, clamped to 0–1 ([`roughness`]).
//!
//! The document is silent about the vertical scale of the cubes, and it decides everything; each
//! file says what we chose and what it changed. Measured on exact Brownian surfaces (256 × 256, D
//! 2.1–2.9, `examples/analysis_table.rs` prints the table): the recommended estimator errs by 0.005
//! on the mean, the probability dimension by 0.04, the grid cubes by 0.15 because they saturate as
//! they do in the document's own table near 2.44).

mod conditions;
mod grid_cubes;
mod local;
mod probability;
mod transect;

pub use conditions::{COLOUR_LIMIT, ColourSums, Condition, colour_fraction, conditions};
pub use grid_cubes::{CUBE_SIDES, CubeDimensions, cube_dimensions};
pub use local::{LocalMap, local_map};
pub use probability::{PROBABILITY_SIDES, probability_dimension};
pub use transect::{Transects, transects};

use asperity_dsp::fractal_noise::FractalNoise;
use asperity_surface::raster::Raster;
use serde::Serialize;

/// Smallest width and height the estimators accept, texels: the longest cube must fit twice.
pub const SMALLEST_SIDE: usize = 64;

/// Why a picture has no fractal dimension.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DimensionError {
    /// Too few texels for the estimators' scales.
    #[error(
        "the picture is {width} × {height} texels; the fractal dimension needs at least {SMALLEST_SIDE} × {SMALLEST_SIDE}"
    )]
    TooSmall {
        /// Texels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// A value that is NaN or infinite.
    #[error("texel ({x}, {y}) is not a finite number; every height must be finite")]
    NotFinite {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
    },
    /// Most neighbouring texels are equal: there is no relief to measure.
    #[error("the picture is flat: a dimension needs grey values that vary from texel to texel")]
    Flat,
}

/// The five estimates of one picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FractalDimension {
    /// Box dimension D_B.
    #[serde(rename = "box")]
    pub box_counting: f64,
    /// Information dimension D_I.
    pub information: f64,
    /// Correlation dimension D_C.
    pub correlation: f64,
    /// Probability dimension D_P, heights scaled as its file says.
    pub probability: f64,
    /// The one to use: transects, median.
    pub recommended: f64,
}

/// Everything this file computes of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct DimensionReport {
    /// The estimates.
    pub dimension: FractalDimension,
    /// Hurst index H = 3 − D of the recommended estimate, 0–1.
    pub hurst: f64,
    /// Exponent α of the profile's power spectrum 1/f^α.
    pub spectral_exponent: f64,
    /// Roughness R of the engine, 0–1.
    pub roughness: f64,
    /// Input conditions of the document that the picture does not meet.
    pub conditions: Vec<Condition>,
}

/// All five estimates and the input conditions of one picture; the dimension does not depend on the
/// unit of height. Symmetry is judged by `symmetry::find_lattice`, which costs more than everything
/// here, so the caller adds [`Condition::Symmetric`] if it wants it; [`Condition::Coloured`] needs
/// the colours.
///
/// # Errors
/// See [`DimensionError`].
pub fn fractal_dimension(picture: &Raster) -> Result<DimensionReport, DimensionError> {
    let along = transects(picture)?;
    let cubes = cube_dimensions(picture)?;
    let dimension = FractalDimension {
        box_counting: cubes.box_counting,
        information: cubes.information,
        correlation: cubes.correlation,
        probability: probability_dimension(picture)?,
        recommended: along.dimension,
    };
    Ok(DimensionReport {
        dimension,
        hurst: hurst(along.dimension),
        spectral_exponent: spectral_exponent(along.dimension),
        roughness: roughness(along.dimension),
        conditions: conditions(picture, &along),
    })
}

/// Hurst index H = 3 − D, clamped to 0–1.
#[must_use]
pub fn hurst(dimension: f64) -> f64 {
    (3.0 - dimension).clamp(0.0, 1.0)
}

/// α = 7 − 2D of the power spectrum 1/f^α of a profile across the surface.
#[must_use]
pub fn spectral_exponent(dimension: f64) -> f64 {
    7.0 - 2.0 * dimension
}

/// Hasti's roughness R = (D − 2.25)/0.75, clamped to 0–1.
#[must_use]
pub fn roughness(dimension: f64) -> f64 {
    FractalNoise::roughness(spectral_exponent(dimension))
}

/// Refuses what no estimator can read.
fn check(picture: &Raster) -> Result<(), DimensionError> {
    let (width, height) = (picture.width, picture.height);
    if width < SMALLEST_SIDE || height < SMALLEST_SIDE || picture.values.len() != width * height {
        return Err(DimensionError::TooSmall { width, height });
    }
    match picture.values.iter().position(|v| !v.is_finite()) {
        Some(i) => Err(DimensionError::NotFinite { x: i % width, y: i / width }),
        None => Ok(()),
    }
}

/// Slope of the least-squares line through points (x, y).
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (sum_x, sum_y) = points.iter().fold((0.0, 0.0), |(a, b), &(x, y)| (a + x, b + y));
    let (mean_x, mean_y) = (sum_x / n, sum_y / n);
    let (covariance, variance) = points.iter().fold((0.0, 0.0), |(c, v), &(x, y)| {
        (c + (x - mean_x) * (y - mean_y), v + (x - mean_x) * (x - mean_x))
    });
    covariance / variance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dimension_becomes_the_papers_exponent_and_roughness() {
        for (dimension, r) in [(2.25, 0.0), (2.5, 1.0 / 3.0), (2.625, 0.5), (3.0, 1.0), (2.1, 0.0)] {
            assert!((roughness(dimension) - r).abs() < 1e-15);
            if dimension >= 2.25 {
                assert!((spectral_exponent(dimension) - (2.5 - 1.5 * r)).abs() < 1e-15);
            }
            assert!((hurst(dimension) - (3.0 - dimension)).abs() < 1e-15);
        }
    }

    #[test]
    fn pictures_without_relief_or_with_bad_texels_are_refused_by_name() {
        assert_eq!(fractal_dimension(&Raster::constant(128, 128, 0.5)), Err(DimensionError::Flat));
        let small = Raster::constant(128, 16, 0.5);
        assert_eq!(fractal_dimension(&small), Err(DimensionError::TooSmall { width: 128, height: 16 }));
        let mut broken = Raster::from_fn(64, 64, |x, y| (x * y) as f64);
        broken.values[64 * 3 + 5] = f64::NAN;
        assert_eq!(fractal_dimension(&broken), Err(DimensionError::NotFinite { x: 5, y: 3 }));
    }

    #[test]
    fn the_slope_of_a_line_is_its_slope() {
        let points: Vec<(f64, f64)> =
            (0..7).map(|i| (f64::from(i * i), 3.0 - 1.5 * f64::from(i * i))).collect();
        assert!((slope(&points) + 1.5).abs() < 1e-12);
    }
}
