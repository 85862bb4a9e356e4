//! Sign of the relief: whether bright is high, and how sure a picture makes of it.
//!
//! Brightness alone does not separate hills from hollows. Occlusion and cast shadows give a few
//! places much less light than the rest, but nothing gives a few places much more of it, so a tail
//! towards dark speaks for dark is deep; a tail towards bright is paint, wear or gloss and speaks
//! for nothing:
//! ```text
//! confidence = ¼ − ¼ · skewness, 0.1 … 0.95        decided from 0.5, that is from a skewness of −1
//! ```
//! Skewness is that of the picture between 4 texels and a quarter of its side, and waves of 2 to 8
//! texels must have a tail as well (−0.7 or less): shadows lie in narrow places, while panels of
//! two colours and holes in a bright ceiling are skewed as a whole and not there. Measured on 37
//! public map sets (colour against displacement, light taken out by their makers): a skewness of −1
//! alone decided 4, with correlations of 0.35, 0.06, −0.47 and −0.59; with the fine waves none is
//! decided, and dark is high (below −0.1) in 13 of them. Neither a weaker tail, nor curvature, nor
//! colour shows which. Without such a tail the sign is a guess, and called one. A light that was
//! given decides; one that was found is taken to come from above, a guess as well.

use crate::light::{band, skewness};
use asperity_surface::raster::Raster;

/// Confidence from which the sign counts as decided.
pub const DECIDED: f64 = 0.5;
/// The most of a guess.
const GUESS: f64 = 0.45;
/// Waves that shadows must show in as well, texels: cracks and pits are narrow.
const FINE_PX: [f64; 2] = [2.0, 8.0];
/// Skewness of them from which they show a tail. Source: ours; −1.3 for grooves of two texels,
/// −0.46, 0.0, −0.37 and 0.38 in the four public sets that are skewed as a whole.
const FINE_TAIL: f64 = -0.7;
/// Confidence of a light that was found: which end of its axis it comes from is custom.
pub const FOUND_LIGHT: f64 = 0.4;

/// Which way up the heights are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sign {
    /// Heights were turned over: bright is deep.
    pub bright_is_deep: bool,
    /// 0 (nothing known) – 1 (given); decided from [`DECIDED`].
    pub confidence: f64,
}

impl Sign {
    /// Told by the user.
    pub(crate) const fn given(bright_is_deep: bool) -> Self {
        Self { bright_is_deep, confidence: 1.0 }
    }

    /// Sign under a light that was found in the picture.
    pub(crate) const fn of_found_light() -> Self {
        Self { bright_is_deep: false, confidence: FOUND_LIGHT }
    }

    /// Dark is deep, as sure as the picture's shadows say: a guess unless they show in fine waves
    /// too.
    pub(crate) fn of_brightness(picture: &Raster) -> Self {
        let longest_px = (picture.width.min(picture.height) as f64 / 4.0).max(8.0);
        let tail = skewness(&band(picture, [4.0, longest_px]));
        let confidence = (0.25 - 0.25 * tail).clamp(0.1, 0.95);
        let is_guess = confidence < DECIDED || !has_narrow_shadows(picture);
        Self { bright_is_deep: false, confidence: if is_guess { confidence.min(GUESS) } else { confidence } }
    }

    /// Tests whether it is more than a guess.
    #[must_use]
    pub fn is_decided(&self) -> bool {
        self.confidence >= DECIDED
    }
}

/// Tests whether fine waves have a tail towards dark.
fn has_narrow_shadows(picture: &Raster) -> bool {
    skewness(&band(picture, FINE_PX)) <= FINE_TAIL
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    /// An even wall with dark discs of one size on it.
    fn spots(radius: f64) -> Raster {
        let mut rng = Rng::new(12);
        let centres: Vec<[f64; 2]> =
            (0..24).map(|_| [256.0 * rng.uniform(), 256.0 * rng.uniform()]).collect();
        Raster::from_fn(256, 256, |x, y| {
            let inside = |c: &[f64; 2]| (x as f64 - c[0]).hypot(y as f64 - c[1]) < radius;
            if centres.iter().any(inside) { 0.2 } else { 0.7 + 0.01 * rng.normal() }
        })
    }

    #[test]
    fn blots_that_are_broad_and_even_decide_nothing() {
        let sign = Sign::of_brightness(&spots(12.0));
        assert!(!sign.is_decided(), "{sign:?}");
    }

    #[test]
    fn pits_of_two_texels_radius_are_shadows() {
        let sign = Sign::of_brightness(&spots(2.0));
        assert!(sign.is_decided() && !sign.bright_is_deep, "{sign:?}");
    }
}
