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

/// Lean of a map's mean normal beyond which it is none, and below which one is level, degrees.
const MOST_LEAN: f64 = 45.0;
const LEVEL: f64 = 15.0;
/// Exponents of the two gammas that are undone: of a map that was darkened (sRGB taken for light)
/// and of one that was brightened.
const UNDONE: [f64; 2] = [1.0 / 2.2, 2.2];
/// Remedy for a map that went through a gamma.
const THROUGH_GAMMA: &str = "normals as numbers, where a flat place has red and green of half: this map was saved through a gamma (sRGB); undo that first (in Blender: Non-Color)";
/// Mean of a channel that can be a map's blue.
const LEAST_BLUE: f64 = 0.65;

/// Refuses what is no map of normals; a map of two channels, whose blue is the same everywhere,
/// says nothing.
pub(super) fn check(red: &Raster, green: &Raster, blue: &Raster) -> Result<(), DesignError> {
    let (low, high) = blue.range();
    if low == high {
        return Ok(());
    }
    let map = [red, green, blue];
    let (down, lean) = (pointing_down(map, 1.0), lean_deg(map, 1.0));
    let (share, angle) = if UNDONE.iter().any(|&gamma| is_level(map, gamma)) {
        (THROUGH_GAMMA, THROUGH_GAMMA)
    } else {
        (
            "at most 0.02 of its normals pointing down (blue below half); a photograph is for `from-photo`",
            "a mean normal that leans by at most 45 degrees (more blue than red and green); a photograph is for `from-photo`",
        )
    };
    DesignError::check("normal map", down, share, |down| down <= MOST_DOWN)?;
    DesignError::check("normal map", lean, angle, |lean| lean <= MOST_LEAN).map(drop)
}

/// Tests whether these would be the normals of a surface if they had not gone through a gamma.
fn is_level(map: [&Raster; 3], gamma: f64) -> bool {
    let blue = map[2].values.iter().map(|b| b.powf(gamma)).sum::<f64>() / map[2].values.len() as f64;
    blue >= LEAST_BLUE && pointing_down(map, gamma) <= MOST_DOWN && lean_deg(map, gamma) <= LEVEL
}

/// Share of normals that point down.
fn pointing_down([_, _, blue]: [&Raster; 3], gamma: f64) -> f64 {
    blue.values.iter().filter(|b| b.powf(gamma) < 0.5).count() as f64 / blue.values.len() as f64
}

/// Angle between the mean normal and straight up, degrees.
fn lean_deg(map: [&Raster; 3], gamma: f64) -> f64 {
    let mean = |c: &Raster| c.values.iter().map(|x| x.powf(gamma)).sum::<f64>() / c.values.len() as f64;
    let [x, y, z] = map.map(|c| 2.0 * mean(c) - 1.0);
    x.hypot(y).atan2(z).to_degrees()
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
    fn a_map_that_went_through_a_gamma_is_told_so() {
        let of = |x: usize, y: usize| {
            [0.4 + 0.2 * (x % 2) as f64, 0.4 + 0.2 * (y % 2) as f64, 0.84 + 0.02 * (x % 2) as f64]
        };
        let error = checked(|x, y| of(x, y).map(|c| c.powf(2.4))).unwrap_err();
        assert!(error.expected.contains("gamma") && !error.expected.contains("photo"), "{error:?}");
        // Grey ones of either kind, and blue ones that lean, are no such maps.
        for colour in [[0.1; 3], [0.48; 3], [0.8; 3], [0.9, 0.5, 0.7], [0.1, 0.3, 0.8]] {
            let error = checked(|x, _| colour.map(|c| c + 0.01 * (x % 2) as f64)).unwrap_err();
            assert!(!error.expected.contains("gamma"), "{colour:?}: {error:?}");
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
