//! Messages that change a surface while it is touched.

use crate::sand::SandLaw;
use crate::solid_noise::SolidNoiseParameters;

/// A change of a surface: plain data, sent from the game half and applied by the audio half at an
/// absolute sample through [`crate::height_field::HeightField::change`], without a click.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SurfaceChange {
    /// New parameters of solid noise.
    SolidNoise(SolidNoiseParameters),
    /// New factor of a [`crate::combine::Scale`].
    Scale(f64),
    /// New position of a [`crate::combine::Crossfade`], 0 = all of the first source, 1 = all of the
    /// second.
    Crossfade(f64),
    /// New weights of a [`crate::combine::BandSplit`]: below and above its wavelength.
    BandSplit([f64; 2]),
    /// Another force law for sand.
    Sand(SandLaw),
}
