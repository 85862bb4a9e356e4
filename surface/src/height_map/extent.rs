//! Extent of a map: the patch of surface it covers, and why a map is refused.

use crate::raster::Raster;

/// The patch of surface a map covers.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Extent {
    /// Size along u, metres.
    pub width_m: f64,
    /// Size along v, metres.
    pub height_m: f64,
    /// Height of value 1 over value 0, metres: negative for depth maps, 1 for maps in metres.
    pub relief_m: f64,
}

/// Why a map cannot be made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// A size that is not a size.
    #[error("{field}: {value} is refused; must be finite{}", if *.field == "relief_m" { "" } else { " and above 0 m" })]
    Extent {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// No texels, or not as many as width × height.
    #[error("a map of {width} × {height} texels with {values} values is refused; at least 1 × 1, all there")]
    Shape {
        /// Texels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Number of values.
        values: usize,
    },
    /// A texel that is no number.
    #[error("the value at column {x}, row {y} is not finite; only finite values make a map")]
    NotFinite {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
    },
    /// Roughness outside its range.
    #[error("roughness: {0} is refused; must be 0 to 1")]
    Roughness(f64),
}

impl Extent {
    pub(super) fn check(&self) -> Result<(), MapError> {
        for (field, value) in [("width_m", self.width_m), ("height_m", self.height_m)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(MapError::Extent { field, value });
            }
        }
        if !self.relief_m.is_finite() {
            return Err(MapError::Extent { field: "relief_m", value: self.relief_m });
        }
        Ok(())
    }
}

pub(super) fn check(raster: &Raster) -> Result<(), MapError> {
    let Raster { width, height, ref values } = *raster;
    if values.is_empty() || width.checked_mul(height) != Some(values.len()) {
        return Err(MapError::Shape { width, height, values: values.len() });
    }
    match values.iter().position(|v| !v.is_finite()) {
        Some(at) => Err(MapError::NotFinite { x: at % width, y: at / width }),
        None => Ok(()),
    }
}
