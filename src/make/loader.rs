//! The loader: files, maps and makers that every thing of a scene is loaded with.

use super::maps::Maps;
use crate::files::Files;
use crate::files::scene_file::MakeSource;
use asperity_surface::sand::SandWorker;
use std::cell::RefCell;

/// Files, maps and makers of a scene.
#[derive(Clone, Copy)]
pub(crate) struct Loader<'a> {
    pub files: &'a dyn Files,
    /// Maps that were made for other things of the scene.
    pub maps: &'a Maps,
    /// Makers of sources that the engine does not know.
    pub own: &'a [(&'a str, MakeSource)],
    /// For sources that name none.
    pub seed: u64,
    /// Place for the workers of sand that is simulated elsewhere; none = it is simulated within the
    /// source.
    pub workers: Option<&'a RefCell<Vec<SandWorker>>>,
}
