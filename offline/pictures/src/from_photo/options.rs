//! Options of `from_photo`: what is known about a photograph, and the size of its heights.

use crate::light::Light;
use crate::shape_from_shading::Method;
use asperity_dsp::DesignError;
use asperity_surface::raster::Raster;

/// Size of a texel when nobody says: 40 mm over 256 texels (document 002, document 004 §8.3: 40
/// mm).
pub const TEXEL_M: f64 = 0.04 / 256.0;

/// Facts given about a photograph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhotoOptions {
    /// Place of the light; `None`: estimated.
    pub light: Option<Light>,
    /// Method that finds heights; `None`: by what the light allows.
    pub method: Option<Method>,
    /// True where bright is deep: heights are turned over.
    pub bright_is_deep: bool,
    /// Size of a texel, m.
    pub texel_m: f64,
    /// Height from the lowest to the highest point, m; `None`: what contrast and texel size give.
    pub relief_m: Option<f64>,
    /// Factor on the heights that contrast gives, for this camera and light
    /// ([`super::calibration`]); does not matter to a relief that is given.
    pub calibration: f64,
    /// Factor on the heights, whatever gave them.
    pub exaggeration: f64,
    /// The coarsest divisor of a JPEG's slow waves of brightness, levels of 255, over the pixels
    /// that a texel's side has; 0 where the picture was none. What such a file cannot hold is no
    /// relief.
    pub jpeg_divisor: f64,
}

impl Default for PhotoOptions {
    fn default() -> Self {
        Self {
            light: None,
            method: None,
            bright_is_deep: false,
            texel_m: TEXEL_M,
            relief_m: None,
            calibration: 1.0,
            exaggeration: 1.0,
            jpeg_divisor: 0.0,
        }
    }
}

/// Scale of heights in texels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    /// Metres of a texel of height.
    pub metres_per_px: f64,
    /// Height from the lowest to the highest point, m.
    pub relief_m: f64,
}

/// Range of heights, texels, that is rounding and no relief.
const NOTHING_PX: f64 = 1e-9;

impl PhotoOptions {
    /// The scale of these heights: given, or as contrast gives it.
    pub(super) fn scale(&self, heights_px: &Raster) -> Scale {
        let (low, high) = heights_px.range();
        let range_px = high - low;
        if range_px <= NOTHING_PX {
            return Scale { metres_per_px: 0.0, relief_m: 0.0 };
        }
        let given_m = self.relief_m.unwrap_or(range_px * self.texel_m * self.calibration);
        let relief_m = given_m * self.exaggeration;
        Scale { metres_per_px: relief_m / range_px, relief_m }
    }
}

pub(super) fn check(picture: &Raster, options: &PhotoOptions) -> Result<(), DesignError> {
    let smaller = picture.width.min(picture.height) as f64;
    DesignError::check("photo side", smaller, "at least 16 texels", |n| n >= 16.0)?;
    if let Some(&value) = picture.values.iter().find(|v| !v.is_finite()) {
        return Err(DesignError { field: "photo", value, expected: "finite at every texel" });
    }
    DesignError::check("texel_m", options.texel_m, "above 0 m and at most 1 m", |t| t > 0.0 && t <= 1.0)?;
    let range = "above 0 and at most 100";
    DesignError::check("exaggeration", options.exaggeration, range, |e| e > 0.0 && e <= 100.0)?;
    let range = "above 0 and at most 1e6";
    DesignError::check("calibration", options.calibration, range, |c| c > 0.0 && c <= 1e6)?;
    let range = "0 to 65535";
    DesignError::check("jpeg_divisor", options.jpeg_divisor, range, |d| (0.0..=65_535.0).contains(&d))?;
    if let Some(relief_m) = options.relief_m {
        DesignError::check("relief_m", relief_m, "above 0 m and at most 1 m", |r| r > 0.0 && r <= 1.0)?;
    }
    Ok(())
}
