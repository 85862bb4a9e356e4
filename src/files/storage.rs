//! Storage: where the files lie that a scene names. On a disk, in memory, in an engine's archive.
//!
//! Everything the engine reads comes through [`Files`], under paths as the scene writes them
//! (relative to the scene file).

use super::FileError;
use asperity_surface::picture::{Channel, ChannelImage, MAX_FILE_BYTES, Picture, Problem};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

/// Place of files.
///
/// ```
/// use asperity::Engine;
/// use asperity::files::Memory;
/// use asperity::surface::picture::{Picture, Samples};
///
/// let mut files = Memory::new();
/// files.add("level/scene.toml", *b"[[surface]]\nname = \"wall\"\nwidth_m = 1.0\nheight_m = 1.0\n\
///     displacement = \"../wall.png\"\nrelief_m = 1e-3\n");
/// // The renderer's own texture, decoded already.
/// files.add_picture("wall.png", Picture::new(2, 2, Samples::U8(vec![0, 255, 255, 0]))?);
/// let engine = Engine::open_from(&files, "level/scene.toml")?;
/// assert!(engine.names.surfaces.contains_key("wall"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Files {
    /// The bytes of a file.
    ///
    /// # Errors
    /// When there is no such file ([`io::ErrorKind::NotFound`]) or it cannot be read.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;

    /// The picture at that path, if it is decoded already; `None`: its file is read and decoded,
    /// which needs the feature `image`.
    fn picture(&self, _path: &Path) -> Option<Cow<'_, Picture>> {
        None
    }
}

/// The file system of this machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let file = std::fs::File::open(path)?;
        if file.metadata()?.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        let mut bytes = Vec::new();
        file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > MAX_FILE_BYTES { Err(io::ErrorKind::FileTooLarge.into()) } else { Ok(bytes) }
    }
}

/// Files and decoded pictures in memory, by path; `a/../b` and `./b` are `b`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Memory {
    entries: BTreeMap<PathBuf, (Option<Vec<u8>>, Option<Picture>)>,
}

impl Memory {
    /// No files.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file, in place of one of the same path.
    pub fn add(&mut self, path: impl AsRef<Path>, bytes: impl Into<Vec<u8>>) {
        self.entries.entry(plain(path.as_ref())).or_default().0 = Some(bytes.into());
    }

    /// Adds a picture that is decoded already, in place of one of the same path.
    pub fn add_picture(&mut self, path: impl AsRef<Path>, picture: Picture) {
        self.entries.entry(plain(path.as_ref())).or_default().1 = Some(picture);
    }
}

impl Files for Memory {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let (bytes, _) = self.entries.get(&plain(path)).ok_or(io::ErrorKind::NotFound)?;
        bytes.clone().ok_or(io::ErrorKind::NotFound.into())
    }

    fn picture(&self, path: &Path) -> Option<Cow<'_, Picture>> {
        self.entries.get(&plain(path)).and_then(|(_, picture)| picture.as_ref()).map(Cow::Borrowed)
    }
}

/// A path without detours.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if plain.file_name().is_some() => {
                plain.pop();
            }
            other => plain.push(other),
        }
    }
    plain
}

/// A file that is text.
pub(crate) fn text(files: &dyn Files, path: &Path) -> io::Result<String> {
    let mut text = String::from_utf8(files.read(path)?).map_err(|_| io::ErrorKind::InvalidData)?;
    // A mark of the byte order is no part of the text.
    if text.starts_with('\u{feff}') {
        text.remove(0);
    }
    Ok(text)
}

/// A channel of an image file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pixels {
    /// Image file.
    pub path: PathBuf,
    /// Which numbers of its pixels.
    pub channel: Channel,
}

/// One channel of a picture.
pub(crate) fn channel(files: &dyn Files, image: &Pixels) -> Result<ChannelImage, FileError> {
    let path = &image.path;
    let read = match files.picture(path) {
        Some(picture) => picture.map(image.channel),
        None => decoded(files, image),
    };
    read.map_err(|problem| match problem {
        Problem::Io(error) => FileError::read(path, &error),
        problem => FileError::from_error(format!("{}: {problem}", path.display())),
    })
}

#[cfg(feature = "image")]
fn decoded(files: &dyn Files, image: &Pixels) -> Result<ChannelImage, Problem> {
    asperity_surface::image_io::read_map(&files.read(&image.path).map_err(Problem::Io)?, image.channel)
}

#[cfg(not(feature = "image"))]
fn decoded(_files: &dyn Files, _image: &Pixels) -> Result<ChannelImage, Problem> {
    Err(Problem::NotDecoded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_of_memory_are_the_same_by_any_detour() {
        let mut files = Memory::new();
        files.add("maps/wall.txt", "brick");
        for path in ["maps/wall.txt", "./maps/wall.txt", "scenes/../maps/wall.txt", "maps/./wall.txt"] {
            assert_eq!(text(&files, Path::new(path)).unwrap(), "brick", "{path}");
        }
        assert_eq!(files.read(Path::new("wall.txt")).unwrap_err().kind(), io::ErrorKind::NotFound);
        assert_eq!(plain(Path::new("../x/../y")), Path::new("../y"));
    }

    #[test]
    fn a_folder_and_a_file_without_text_are_refused_as_such() {
        let folder = std::env::temp_dir();
        assert_eq!(Disk.read(&folder).unwrap_err().kind(), io::ErrorKind::IsADirectory);
        let mut files = Memory::new();
        files.add("latin1.toml", [0xe9]);
        assert_eq!(text(&files, Path::new("latin1.toml")).unwrap_err().kind(), io::ErrorKind::InvalidData);
    }
}
