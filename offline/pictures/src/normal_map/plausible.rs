//! Normals that a surface of heights can have.
//!
//! ```text
//! share of texels with n_z < 0 ≤ MOST_DOWN        hypot(mean n_x, mean n_y) ≤ mean n_z
//! ```
//! Photographs fail the first when they are dark or even in blue, and the second when they are
//! bright: there red, green and blue are alike, where a normal map is blue. Integrated they would
//! give a surface that has nothing to do with theirs, and say nothing.

use asperity_dsp::DesignError;
use asperity_surface::raster::Raster;

/// Share of texels whose normal may point down. Source: ours; at most 0.1 % of 41 public maps, 0.8
/// % and more of all photographs that do not lean.
pub const MOST_DOWN: f64 = 0.02;

/// Refuses what is no map of normals; a map of two channels, whose blue is the same everywhere,
/// says nothing.
pub(super) fn check(red: &Raster, green: &Raster, blue: &Raster) -> Result<(), DesignError> {
    let (low, high) = blue.range();
    if low == high {
        return Ok(());
    }
    let count = blue.values.len() as f64;
    let down = blue.values.iter().filter(|&&b| b < 0.5).count() as f64 / count;
    let expected =
        "at most 0.02 of its normals pointing down (blue below half); a photograph is for `from-photo`";
    DesignError::check("normal map", down, expected, |share| share <= MOST_DOWN)?;
    let [x, y, z] = [red, green, blue].map(|c| 2.0 * c.mean() - 1.0);
    let lean = x.hypot(y).atan2(z).to_degrees();
    let expected = "a mean normal that leans by at most 45 degrees (more blue than red and green); a photograph is for `from-photo`";
    DesignError::check("normal map", lean, expected, |lean| lean <= 45.0).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(colour: impl Fn(usize, usize) -> [f64; 3]) -> Result<(), DesignError> {
        let channel = |k: usize| Raster::from_fn(16, 16, |x, y| colour(x, y)[k]);
        check(&channel(0), &channel(1), &channel(2))
    }

    #[test]
    fn photographs_dark_grey_and_bright_are_refused_in_words() {
        let grey = |level: f64| move |x: usize, y: usize| [level + 0.01 * ((x * 7 + y * 3) % 5) as f64; 3];
        for level in [0.1, 0.48, 0.8, 0.95] {
            let error = checked(grey(level)).unwrap_err();
            assert!(
                error.field == "normal map" && error.expected.contains("from-photo"),
                "{level}: {error:?}"
            );
        }
    }

    #[test]
    fn steep_tilted_averaged_and_two_channel_normals_are_not() {
        // Leaning by 40°; half as long as a unit vector; blue never written.
        assert!(checked(|x, _| [0.5 + 0.3 * (x % 2) as f64, 0.65, 0.9]).is_ok());
        assert!(checked(|x, y| [0.5 + 0.2 * ((x + y) % 2) as f64, 0.5, 0.6 + 0.1 * (y % 2) as f64]).is_ok());
        assert!(checked(|x, y| [x as f64 / 15.0, y as f64 / 15.0, 0.0]).is_ok());
    }
}
