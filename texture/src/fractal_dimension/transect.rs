//! The recommended estimator: the madogram along every row and column.
//!
//! For one transect V(k) = mean |h(i + k) − h(i)|, which grows as k^H, so H = log₂ V(2)/V(1); the
//! dimension is D = 3 − median of H over all rows and columns (Gneiting et al. 2012, "transect
//! variation", p = 1). The first absolute power rather than the square is what lets 8-bit maps through: rounding
//! two heights changes their difference, but the mean absolute difference over a relief that crosses the levels at random
//! phases stays what it was, and the median over hundreds of transects throws away scratches and seams.
//!
//! | symbol | here |
//! |---|---|
//! | V(1), V(2) | [`madogram`] |
//! | H of rows, of columns | [`Transects::hurst_rows`], [`Transects::hurst_columns`] |

use super::{DimensionError, check};
use crate::raster::Raster;

/// What the transects of a picture say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transects {
    /// Fractal dimension of the surface, 2–3 for a fractal relief.
    pub dimension: f64,
    /// Median Hurst index along the rows.
    pub hurst_rows: f64,
    /// Median Hurst index along the columns.
    pub hurst_columns: f64,
}

/// Dimension of a picture from its rows and columns. Transects without relief count for nothing.
///
/// # Errors
/// See [`DimensionError`]; [`DimensionError::Flat`] also if more than half of all transects have no relief.
pub fn transects(picture: &Raster) -> Result<Transects, DimensionError> {
    check(picture)?;
    let rows = row_indices(picture);
    let columns = column_indices(picture);
    let all: Vec<f64> = rows.iter().chain(&columns).copied().collect();
    if 2 * all.len() < picture.width + picture.height {
        return Err(DimensionError::Flat);
    }
    let hurst = median(all).ok_or(DimensionError::Flat)?;
    Ok(Transects {
        dimension: 3.0 - hurst,
        hurst_rows: median(rows).unwrap_or(hurst),
        hurst_columns: median(columns).unwrap_or(hurst),
    })
}

/// Hurst indices of all rows that have relief.
fn row_indices(picture: &Raster) -> Vec<f64> {
    (0..picture.height)
        .filter_map(|y| {
            let row = picture.row(y);
            index(madogram(row, 1), madogram(row, 2))
        })
        .collect()
}

/// The same of all columns, summed row by row so that memory is read in order.
fn column_indices(picture: &Raster) -> Vec<f64> {
    let sums = [1, 2].map(|lag| {
        let mut sum = vec![0.0; picture.width];
        for y in lag..picture.height {
            for ((total, a), b) in sum.iter_mut().zip(picture.row(y)).zip(picture.row(y - lag)) {
                *total += (a - b).abs();
            }
        }
        sum
    });
    let rows = picture.height as f64;
    sums[0].iter().zip(&sums[1]).filter_map(|(one, two)| index(one / (rows - 1.0), two / (rows - 2.0))).collect()
}

/// V(lag) of one transect.
fn madogram(heights: &[f64], lag: usize) -> f64 {
    let sum: f64 = heights[lag..].iter().zip(heights).map(|(a, b)| (a - b).abs()).sum();
    sum / (heights.len() - lag) as f64
}

/// log₂ V(2)/V(1); nothing for a transect without relief.
fn index(one: f64, two: f64) -> Option<f64> {
    (one > 0.0 && two > 0.0).then(|| (two / one).log2())
}

/// Median; nothing of nothing.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    let (below, &mut upper, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    if below.len() > middle || values.len() % 2 == 1 {
        return Some(upper);
    }
    let lower = values[..middle].iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Some(0.5 * (lower + upper))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_has_dimension_two_and_white_noise_three() {
        let plane = Raster::from_fn(100, 90, |x, y| 0.3 * x as f64 + 0.1 * y as f64);
        assert!((transects(&plane).unwrap().dimension - 2.0).abs() < 1e-12);
        let mut rng = asperity_dsp::rng::Rng::new(1);
        let noise = Raster::from_fn(256, 256, |_, _| rng.normal());
        assert!((transects(&noise).unwrap().dimension - 3.0).abs() < 0.01);
    }

    #[test]
    fn the_median_of_an_even_number_lies_between_the_middle_two() {
        assert_eq!(median(vec![4.0, 1.0, 3.0, 2.0]), Some(2.5));
        assert_eq!(median(vec![5.0, 1.0, 3.0]), Some(3.0));
        assert_eq!(median(vec![]), None);
    }

    #[test]
    fn a_scratch_across_the_map_does_not_change_its_dimension() {
        let mut rng = asperity_dsp::rng::Rng::new(2);
        let mut walks = Raster::constant(128, 128, 0.0);
        for y in 0..128 {
            let mut height = 0.0;
            for x in 0..128 {
                height += rng.normal();
                walks.values[y * 128 + x] = height;
            }
        }
        let whole = transects(&walks).unwrap().hurst_rows;
        for value in &mut walks.values[40 * 128..43 * 128] {
            *value = 0.0;
        }
        assert!((transects(&walks).unwrap().hurst_rows - whole).abs() < 0.01);
        assert!((whole - 0.5).abs() < 0.03);
    }
}
