//! Picture port: the heights of a surface that changes, sand for instance, tile by tile.
//!
//! The simulation writes what changed once a frame (60 a second) and the audio half has no part in
//! it.

use crate::link::outlet::{Opened, PortKind, PortSetup};
use crate::model::error::AddError;
use crate::model::id::SurfaceId;
pub use asperity_surface::moving_picture::PictureReader as PicturePort;

/// A port of pictures. Its reading end draws the tiles that have [changed](PicturePort::changed)
/// since it last looked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Picture {
    /// Surface; one whose source never changes is refused.
    pub surface: SurfaceId,
}

impl PortKind for Picture {
    type Port = PicturePort;

    fn open(self, setup: &PortSetup<'_>) -> Result<Opened<PicturePort>, AddError> {
        let picture = setup.picture(self.surface).ok_or(AddError::NeverChanges)?;
        Ok(Opened { outlet: None, port: picture.reader() })
    }
}
