//! Terraces: surfaces of a few heights, whose texels move by a whole step or not at all.

use crate::raster::Raster;

/// Most heights of terraces; a surface of more has slopes. Source: ours.
const MOST_HEIGHTS: usize = 64;

/// Whether a surface has 2 to [`MOST_HEIGHTS`] different heights.
pub(super) fn are_terraces(surface: &Raster) -> bool {
    let mut heights: Vec<f64> = Vec::new();
    for &height in &surface.values {
        let at = heights.partition_point(|known| *known < height);
        if heights.get(at).is_none_or(|known| *known > height) {
            if heights.len() == MOST_HEIGHTS {
                return false;
            }
            heights.insert(at, height);
        }
    }
    heights.len() > 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_heights_are_terraces_and_slopes_and_flats_are_none() {
        let of = |heights: usize| Raster::from_fn(32, 32, |x, y| ((x * 32 + y) % heights) as f64);
        assert!([2, 3, 64].into_iter().all(|heights| are_terraces(&of(heights))));
        assert!([1, 65, 1024].into_iter().all(|heights| !are_terraces(&of(heights))));
    }
}
