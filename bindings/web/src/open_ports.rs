//! The ports that a page has open.

use asperity::live::ports::{LevelsPort, PicturePort};

/// The ports that are open.
#[derive(Default)]
pub(crate) struct Ports {
    pub levels: Option<LevelsPort>,
    pub picture: Option<PicturePort>,
}
