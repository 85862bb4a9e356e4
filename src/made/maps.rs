//! Maps, made once: a picture that was read, decoded and filtered serves everything of the scene that asks for the same one.
//!
//! A scene whose levels follow from a reference stroke is built twice, and surfaces share pictures; decoding and filtering three pairs of
//! 1024² maps takes half a second. A copy of a [`HeightMap`] shares its samples.

use crate::files::storage::{self, Pixels};
use crate::files::{FileError, Files};
use asperity_texture::height_map::{Extent, HeightMap};
use asperity_texture::picture::ChannelImage;
use asperity_texture::raster::Raster;
use asperity_texture::wrap::Wrap;
use std::cell::RefCell;

/// How a picture becomes the values of a map.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Values {
    /// Its greys, white 1.
    AsTheyAre,
    /// Its greys, with the steps of few bits smoothed.
    Debanded,
}

/// What a map is made of.
#[derive(Clone, PartialEq)]
pub(crate) struct MapOf {
    pub image: Pixels,
    pub values: Values,
    /// White and black exchanged.
    pub invert: bool,
    pub extent: Extent,
    pub wrap: Wrap,
}

impl MapOf {
    fn make(&self, files: &dyn Files) -> Result<HeightMap, FileError> {
        let read = storage::channel(files, &self.image)?;
        let raster = self.values.of(read, self.wrap);
        let raster = if self.invert { raster.map(|value| 1.0 - value) } else { raster };
        HeightMap::new(&raster, self.extent, self.wrap)
            .map_err(|error| FileError::told(error).within(self.image.path.display()))
    }
}

impl Values {
    fn of(self, read: ChannelImage, wrap: Wrap) -> Raster {
        match self {
            Self::AsTheyAre => read.raster,
            Self::Debanded => read.debanded(wrap),
        }
    }
}

/// The maps that were made so far.
#[derive(Default)]
pub struct Maps(RefCell<Vec<(MapOf, HeightMap)>>);

impl Maps {
    /// The map of that description.
    pub(crate) fn get(&self, of: MapOf, files: &dyn Files) -> Result<HeightMap, FileError> {
        if let Some((_, map)) = self.0.borrow().iter().find(|(made, _)| *made == of) {
            return Ok(map.clone());
        }
        let map = of.make(files)?;
        self.0.borrow_mut().push((of, map.clone()));
        Ok(map)
    }
}
