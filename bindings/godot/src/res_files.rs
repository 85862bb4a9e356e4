//! Files: what scenes name, from `res://`, `user://` or the disk, through Godot, so that exported
//! projects find them in their pack.

use crate::picture;
use asperity::files::{Files, Memory};
use asperity::surface::picture::Picture;
use godot::classes::{FileAccess, ResourceLoader, Texture2D};
use godot::global::Error;
use godot::prelude::*;
use std::borrow::Cow;
use std::io;
use std::path::Path;

/// A project's files, and in front of them what lies in memory already.
#[derive(Default)]
pub(crate) struct ResFiles {
    pub memory: Memory,
}

/// A path as Godot writes it: Rust's parent of `res://a` is `res:`.
fn godot_path(path: &Path) -> String {
    let text = path.to_string_lossy().replace('\\', "/");
    for root in ["res:", "user:"] {
        if let Some(rest) = text.strip_prefix(root) {
            return format!("{root}//{}", rest.trim_start_matches('/'));
        }
    }
    text
}

impl Files for ResFiles {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        if let Ok(bytes) = self.memory.read(path) {
            return Ok(bytes);
        }
        let path = godot_path(path);
        if !FileAccess::file_exists(&path) {
            return Err(io::ErrorKind::NotFound.into());
        }
        let bytes = FileAccess::get_file_as_bytes(&path).to_vec();
        match FileAccess::get_open_error() {
            Error::OK => Ok(bytes),
            error => Err(io::Error::other(format!("Godot says {error:?}"))),
        }
    }

    /// In an exported project only the imported texture is left of a picture.
    fn picture(&self, path: &Path) -> Option<Cow<'_, Picture>> {
        if let Some(picture) = self.memory.picture(path) {
            return Some(picture);
        }
        let path = godot_path(path);
        if FileAccess::file_exists(&path) || !ResourceLoader::singleton().exists(&path) {
            return None;
        }
        let texture = ResourceLoader::singleton().load(&path)?.try_cast::<Texture2D>().ok()?;
        picture::of(&texture, "texture").ok().map(|(picture, _)| Cow::Owned(picture))
    }
}
