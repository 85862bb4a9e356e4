//! Sign of the relief: whether bright is high, and how sure a picture makes of it.
//!
//! Brightness alone does not tell hills from hollows. Occlusion and cast shadows give a few places much less light than the
//! rest, but nothing gives a few places much more of it, so a tail towards dark speaks for dark is deep; a tail
//! towards bright is paint, wear or gloss and speaks for nothing:
//! ```text
//! confidence = ¼ − ¼ · skewness, 0.1 … 0.95        decided from 0.5, that is from a skewness of −1
//! ```
//! Skewness is that of the picture between 4 texels and a quarter of its side. Measured on 37 public map sets (colour against
//! displacement, light taken out by their makers): 2 of them are below −1, both with dark deep (correlation 0.1 and 0.3); dark is high in a
//! third of the others, and neither a weaker tail (of 6 below −0.8, 4 were right), nor curvature, nor colour tells which. The limit was
//! set on these sets. Without such a tail the sign is a
//! guess, and called one. A light that was told decides; one that was found is taken to come from above, a guess as well.

use crate::light::{band, skewness};
use crate::raster::Raster;

/// Confidence from which the sign counts as decided.
pub const DECIDED: f64 = 0.5;
/// Confidence of a light that was found: which end of its axis it comes from is custom.
pub const FOUND_LIGHT: f64 = 0.4;

/// Which way up the heights are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sign {
    /// Heights were turned over: bright is deep.
    pub bright_is_deep: bool,
    /// 0 (nothing known) – 1 (told); decided from [`DECIDED`].
    pub confidence: f64,
}

impl Sign {
    /// Told by the user.
    pub(crate) const fn told(bright_is_deep: bool) -> Self {
        Self { bright_is_deep, confidence: 1.0 }
    }

    /// Of a light that was found in the picture.
    pub(crate) const fn of_found_light() -> Self {
        Self { bright_is_deep: false, confidence: FOUND_LIGHT }
    }

    /// Dark is deep, as sure as the picture's shadows say.
    pub(crate) fn of_brightness(picture: &Raster) -> Self {
        let longest_px = (picture.width.min(picture.height) as f64 / 4.0).max(8.0);
        let tail = skewness(&band(picture, [4.0, longest_px]));
        Self { bright_is_deep: false, confidence: (0.25 - 0.25 * tail).clamp(0.1, 0.95) }
    }

    /// Whether it is more than a guess.
    #[must_use]
    pub fn is_decided(&self) -> bool {
        self.confidence >= DECIDED
    }
}
