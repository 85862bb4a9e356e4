//! The document's input conditions: what a picture must be for its dimension to mean roughness.
//!
//! Thesis §6.2 asks for homogeneity, one colour, no repeated pattern and no preferred direction,
//! and gives no test for any. Ours compare directions and places by the mean absolute second
//! difference over two texels, which a slow tilt does not move. Limits stand above the largest
//! value on 90 exact Brownian surfaces (256², D 2.1–2.9), where all conditions hold by
//! construction.

use super::local::local_map;
use super::transect::Transects;
use asperity_surface::raster::Raster;
use serde::Serialize;

/// Largest ratio of the mean second differences along two perpendicular directions (Brownian:
/// 1.03).
pub const DIRECTION_LIMIT: f64 = 1.15;

/// Largest difference of the Hurst index between rows and columns (Brownian: 0.13).
pub const DIRECTION_HURST_LIMIT: f64 = 0.15;

/// Largest ratio of the activity of the places at the upper and the lower quartile (Brownian:
/// 1.08).
pub const PLACE_LIMIT: f64 = 1.3;

/// Largest standard deviation of the dimension over windows of a quarter of the picture (Brownian:
/// 0.05).
pub const PLACE_DIMENSION_LIMIT: f64 = 0.1;

/// Largest rms of the colour differences over the rms of the grey values.
pub const COLOUR_LIMIT: f64 = 0.25;

/// An input condition that does not hold, with the figure that says so.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// A pattern repeats itself; the figure is the confidence of its lattice, 0–1.
    Symmetric(f64),
    /// One direction is rougher: ratio of the mean height differences along two perpendicular ones.
    Directed(f64),
    /// The Hurst index along rows and columns differs by this much.
    DirectedHurst(f64),
    /// Some places have more relief than others: ratio of the quartiles of activity.
    Inhomogeneous(f64),
    /// The dimension itself changes from place to place: its standard deviation.
    InhomogeneousDimension(f64),
    /// Madogram and second differences give dimensions this far apart: blur, edges or noise at the
    /// scale of a few texels, where a Brownian surface would look the same at all of them.
    NotSelfSimilar(f64),
    /// Colour carries information that grey does not: rms of the colour differences over that of
    /// grey.
    Coloured(f64),
}

impl std::fmt::Display for Condition {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Symmetric(confidence) => {
                write!(
                    f,
                    "a pattern repeats (confidence {confidence:.2}): the dimension mixes pattern and roughness, analyse the residual"
                )
            }
            Self::Directed(ratio) => {
                write!(
                    f,
                    "preferred direction: relief is {ratio:.2} times stronger along one direction than across it"
                )
            }
            Self::DirectedHurst(difference) => {
                write!(
                    f,
                    "preferred direction: the dimension along rows and columns differs by {difference:.2}"
                )
            }
            Self::Inhomogeneous(ratio) => {
                write!(
                    f,
                    "not homogeneous: relief varies {ratio:.2}-fold between the places of the picture, use the local map"
                )
            }
            Self::InhomogeneousDimension(spread) => {
                write!(
                    f,
                    "not homogeneous: the dimension varies by ±{spread:.2} between the places of the picture, use the local map"
                )
            }
            Self::NotSelfSimilar(difference) => {
                write!(
                    f,
                    "not self-similar at the scale of texels (blur, edges or steps): two estimates of the dimension differ by {difference:.2}"
                )
            }
            Self::Coloured(fraction) => {
                write!(
                    f,
                    "coloured: colour differences are {fraction:.2} of the grey differences, grey may not be height"
                )
            }
        }
    }
}

/// The conditions on direction and homogeneity that `picture` does not meet.
pub fn conditions(picture: &Raster, along: &Transects) -> Vec<Condition> {
    let mut broken = Vec::new();
    let ratio = direction_ratio(picture);
    if ratio > DIRECTION_LIMIT {
        broken.push(Condition::Directed(ratio));
    }
    let hurst = (along.hurst_rows - along.hurst_columns).abs();
    if hurst > DIRECTION_HURST_LIMIT {
        broken.push(Condition::DirectedHurst(hurst));
    }
    if along.disagree() {
        let second = along.second_dimension.unwrap_or(2.0);
        broken.push(Condition::NotSelfSimilar((second - along.madogram_dimension).abs()));
    }
    let ratio = place_ratio(picture);
    if ratio > PLACE_LIMIT {
        broken.push(Condition::Inhomogeneous(ratio));
    }
    let spread = dimension_spread(picture);
    if spread > PLACE_DIMENSION_LIMIT {
        broken.push(Condition::InhomogeneousDimension(spread));
    }
    broken
}

/// Rms of red − grey and blue − grey about their means over the rms of grey about its mean, with
/// grey the mean of the three. An even tint gives 0. Above [`COLOUR_LIMIT`] the picture is
/// coloured.
#[must_use]
pub fn colour_fraction(red: &Raster, green: &Raster, blue: &Raster) -> f64 {
    let mut sums = ColourSums::default();
    for ((&r, &g), &b) in red.values.iter().zip(&green.values).zip(&blue.values) {
        sums.add([r, g, b]);
    }
    sums.fraction()
}

/// [`colour_fraction`] of texels that come one by one.
#[derive(Debug, Clone, Copy, Default)]
pub struct ColourSums {
    texels: f64,
    /// Sums and sums of squares of red − grey, blue − grey and grey.
    sums: [[f64; 2]; 3],
}

impl ColourSums {
    /// One texel more: red, green and blue in any unit.
    pub fn add(&mut self, [red, green, blue]: [f64; 3]) {
        let grey = (red + green + blue) / 3.0;
        self.texels += 1.0;
        for ([sum, squares], value) in self.sums.iter_mut().zip([red - grey, blue - grey, grey]) {
            *sum += value;
            *squares += value * value;
        }
    }

    /// The fraction of all texels so far.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        let n = self.texels.max(1.0);
        let [red, blue, grey] = self.sums.map(|[sum, squares]| (squares / n - (sum / n).powi(2)).max(0.0));
        if red + blue <= 0.0 { 0.0 } else { ((red + blue) / grey).sqrt() }
    }
}

/// |h(p + d) − 2h(p) + h(p − d)| of a texel at least two from the border: blind to a slow tilt.
#[inline]
fn second_difference(picture: &Raster, x: usize, y: usize, direction: (isize, isize)) -> f64 {
    let step = direction.1 * picture.width as isize + direction.0;
    let here = y * picture.width + x;
    let value = |offset: isize| picture.values[here.wrapping_add_signed(offset)];
    (value(step) - 2.0 * value(0) + value(-step)).abs()
}

/// Largest ratio, either way, of the mean second differences along rows and columns and along both
/// diagonals.
fn direction_ratio(picture: &Raster) -> f64 {
    const DIRECTIONS: [(isize, isize); 4] = [(2, 0), (0, 2), (2, 2), (-2, 2)];
    let mut sums = [0.0_f64; 4];
    for y in 2..picture.height - 2 {
        for x in 2..picture.width - 2 {
            for (sum, direction) in sums.iter_mut().zip(DIRECTIONS) {
                *sum += second_difference(picture, x, y, direction);
            }
        }
    }
    let ratio = |a: f64, b: f64| (a / b).max(b / a);
    ratio(sums[0], sums[1]).max(ratio(sums[2], sums[3]))
}

/// Upper over lower quartile of the mean second difference in 8 × 8 places.
fn place_ratio(picture: &Raster) -> f64 {
    const PLACES: usize = 8;
    let mut activity = vec![0.0_f64; PLACES * PLACES];
    let (columns, rows) = (picture.width - 4, picture.height - 4);
    for y in 0..rows {
        for x in 0..columns {
            let place = y * PLACES / rows * PLACES + x * PLACES / columns;
            activity[place] += second_difference(picture, x + 2, y + 2, (2, 0))
                + second_difference(picture, x + 2, y + 2, (0, 2));
        }
    }
    activity.sort_by(f64::total_cmp);
    activity[3 * PLACES * PLACES / 4] / activity[PLACES * PLACES / 4]
}

/// Standard deviation of the dimension over windows of a quarter of the picture that do not
/// overlap.
fn dimension_spread(picture: &Raster) -> f64 {
    let window = picture.width.min(picture.height) / 4;
    let Ok(map) = local_map(picture, window, window) else { return 0.0 };
    let values = &map.dimension.values;
    let mean = map.dimension.mean();
    (values.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / values.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::transects;
    use super::*;
    use asperity_dsp::rng::Rng;

    fn broken(picture: &Raster) -> Vec<Condition> {
        conditions(picture, &transects(picture).unwrap())
    }

    #[test]
    fn wood_grain_is_directed() {
        let mut rng = Rng::new(4);
        let lines: Vec<f64> = (0..128).map(|_| rng.normal()).collect();
        let wood = Raster::from_fn(128, 128, |_, y| lines[y] + 0.2 * rng.normal());
        assert!(broken(&wood).iter().any(|c| matches!(c, Condition::Directed(ratio) if *ratio > 3.0)));
    }

    #[test]
    fn a_smooth_and_a_rough_half_are_not_homogeneous() {
        let mut rng = Rng::new(5);
        let halves =
            Raster::from_fn(128, 128, |x, y| if x < 64 { 0.1 * (x + 2 * y) as f64 } else { rng.normal() });
        let found = broken(&halves);
        assert!(found.iter().any(|c| matches!(c, Condition::Inhomogeneous(_))));
        assert!(found.iter().any(|c| matches!(c, Condition::InhomogeneousDimension(_))));
    }

    #[test]
    fn a_tint_is_not_colour_but_a_red_patch_is() {
        let grey = Raster::from_fn(64, 64, |x, y| ((x * 31 + y * 17) % 64) as f64 / 64.0);
        let tinted = colour_fraction(&grey.map(|v| v + 0.2), &grey, &grey.map(|v| v - 0.1));
        assert!(tinted < 1e-6, "{tinted}");
        let patch = Raster::from_fn(64, 64, |x, y| grey.at(x, y) + if x < 32 { 0.5 } else { 0.0 });
        assert!(colour_fraction(&patch, &grey, &grey) > COLOUR_LIMIT);
    }
}
