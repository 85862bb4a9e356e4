//! Surfaces from maps that lie in files.

use super::{Surface, SurfaceError};
use asperity_surface::height_map::{Extent, HeightMap};
use asperity_surface::image_io;
use asperity_surface::picture::Channel;
use asperity_surface::wrap::Wrap;
use std::path::Path;

impl Surface {
    /// A surface from a displacement map and a roughness map (grey PNG or JPEG, any size),
    /// repeated.
    ///
    /// # Errors
    /// When a map cannot be read or the extent is impossible; the message names the file.
    pub fn from_maps(
        displacement: impl AsRef<Path>,
        roughness: impl AsRef<Path>,
        extent: Extent,
    ) -> Result<Self, SurfaceError> {
        let heights = image_io::load_map(displacement, Channel::Luma)?.debanded(Wrap::Repeat);
        let map = HeightMap::new(&heights, extent, Wrap::Repeat)?;
        drop(heights); // One map at a time is as much memory as large ones need.
        let map = map.with_roughness_map(&image_io::load_map(roughness, Channel::Luma)?.raster)?;
        Ok(Self::new(map, extent.width_m, extent.height_m)?)
    }

    /// A surface from a displacement map alone, repeated; its roughness is the middle of the scale
    /// by default.
    ///
    /// # Errors
    /// As [`from_maps`](Self::from_maps).
    pub fn from_displacement(displacement: impl AsRef<Path>, extent: Extent) -> Result<Self, SurfaceError> {
        let heights = image_io::load_map(displacement, Channel::Luma)?.debanded(Wrap::Repeat);
        let map = HeightMap::new(&heights, extent, Wrap::Repeat)?;
        Ok(Self::new(map, extent.width_m, extent.height_m)?)
    }
}
