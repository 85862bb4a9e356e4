//! Maps, made once: a picture that was read, decoded and filtered serves everything of the scene
//! that asks for the same one.
//!
//! A scene whose levels follow from a reference stroke is built twice, and surfaces share pictures;
//! decoding and filtering three pairs of 1024² maps takes half a second. A copy of a [`HeightMap`]
//! shares its samples.

use crate::files::storage::{self, Pixels};
use crate::files::{FileError, Files};
use asperity_surface::height_map::{Extent, HeightMap};
use asperity_surface::picture::ChannelImage;
use asperity_surface::raster::Raster;
use asperity_surface::wrap::Wrap;
use std::cell::RefCell;

/// Conversion of a picture to the values of a map.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Values {
    /// Its greys, white 1.
    AsTheyAre,
    /// Its greys, with the steps of few bits smoothed.
    Debanded,
}

/// Parts of a map.
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
    fn make(&self, files: &dyn Files, maps: &Maps) -> Result<HeightMap, FileError> {
        let read = maps.read(&self.image, self.values.key(), files)?;
        let mut raster = self.values.of(read, self.wrap);
        if self.invert {
            raster.values.iter_mut().for_each(|value| *value = 1.0 - *value);
        }
        HeightMap::new(&raster, self.extent, self.wrap)
            .map_err(|error| FileError::from_error(error).within(self.image.path.display()))
    }
}

/// Channels of a picture that are read past, and the key that would name them.
fn remark(image: &Pixels, read: &ChannelImage, key: &str) -> Option<String> {
    let ignored = read.ignored?;
    let path = image.path.display();
    Some(format!("{path}: {ignored}; write {key} = \"r\", \"g\", \"b\" or \"a\" if one of these is the map"))
}

impl Values {
    /// The key that names a channel of such a picture.
    fn key(self) -> &'static str {
        match self {
            Self::AsTheyAre => "roughness_channel",
            Self::Debanded => "channel",
        }
    }

    fn of(self, read: ChannelImage, wrap: Wrap) -> Raster {
        match self {
            Self::AsTheyAre => read.raster,
            Self::Debanded => read.debanded(wrap),
        }
    }
}

/// The maps that were made so far.
#[derive(Default)]
pub struct Maps {
    made: RefCell<Vec<(MapOf, HeightMap)>>,
    remarks: RefCell<Vec<String>>,
}

impl Maps {
    /// Doubts about the pictures that were read, a line each.
    pub fn remarks(&self) -> Vec<String> {
        self.remarks.borrow().clone()
    }

    /// One channel of a picture, which `key` of a scene file names; what is doubtful in it is kept.
    pub(crate) fn read(
        &self,
        image: &Pixels,
        key: &str,
        files: &dyn Files,
    ) -> Result<ChannelImage, FileError> {
        let read = storage::channel(files, image)?;
        let remark = remark(image, &read, key).filter(|remark| !self.remarks.borrow().contains(remark));
        self.remarks.borrow_mut().extend(remark);
        Ok(read)
    }

    /// The map of that description.
    pub(crate) fn get(&self, of: MapOf, files: &dyn Files) -> Result<HeightMap, FileError> {
        if let Some((_, map)) = self.made.borrow().iter().find(|(made, _)| *made == of) {
            return Ok(map.clone());
        }
        let map = of.make(files, self)?;
        self.made.borrow_mut().push((of, map.clone()));
        Ok(map)
    }
}

crate::opaque::debug_by_name!(Maps);
