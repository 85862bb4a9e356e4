//! Files: from the disk, or from wherever a program keeps its assets.

use crate::entry::{array, enter};
use crate::image::{asp_image, picture};
use crate::sized::{self, sized};
use crate::status::{ASP_BAD_ARGUMENT, Failure};
use asperity::files::{Disk, Files, Memory};
use asperity::surface::picture::Picture;
use std::borrow::Cow;
use std::cell::Cell;
use std::ffi::{CString, c_char, c_void};
use std::io;
use std::path::Path;

/// Most bytes of a file.
const MAX_BYTES: usize = 1 << 30;

/// Receiver of a file's bytes: valid within that one call of its function.
pub struct asp_sink {
    bytes: Option<Vec<u8>>,
    picture: Option<Picture>,
}

/// Asked for the file at `path` (as the scene writes it, relative to the scene file). Puts its
/// bytes with `asp_sink_bytes`, or a decoded picture with `asp_sink_picture`, and gives 0; anything
/// else: there is no such file.
pub type asp_read =
    Option<unsafe extern "C" fn(user: *mut c_void, path: *const c_char, sink: *mut asp_sink) -> i32>;

/// Source of files; `asp_files_init` fills it. NULL wherever it is asked for means the disk.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_files {
    /// Size of this struct, bytes.
    pub struct_size: u32,
    /// 0.
    pub reserved: u32,
    /// Given to `read` as it is.
    pub user: *mut c_void,
    /// Called on the thread that asked for something to be loaded, before that call returns; NULL =
    /// the disk.
    pub read: asp_read,
}

sized!(asp_files);

/// Fills files with its size and the disk.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_files_init(files: *mut asp_files) {
    sized::init(files);
}

/// Puts the bytes of a file that was asked for; they are copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_sink_bytes(sink: *mut asp_sink, bytes: *const u8, size: usize) -> i32 {
    enter(|| {
        let sink = sink_of(sink)?;
        sink.bytes = Some(array(bytes, size, MAX_BYTES, "bytes")?.to_vec());
        Ok(())
    })
}

/// Puts a picture that was asked for and is decoded already; it is copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_sink_picture(sink: *mut asp_sink, image: *const asp_image) -> i32 {
    enter(|| {
        let sink = sink_of(sink)?;
        crate::entry::aligned(image, "image")?;
        // SAFETY: not null and aligned; that it is an image is the caller's promise.
        sink.picture = Some(picture(unsafe { &*image }, "image")?);
        Ok(())
    })
}

thread_local! {
    /// The sink that is open on this thread; any other address is none.
    static OPEN: Cell<*mut asp_sink> = const { Cell::new(std::ptr::null_mut()) };
}

fn sink_of<'a>(sink: *mut asp_sink) -> Result<&'a mut asp_sink, Failure> {
    if sink.is_null() || OPEN.get() != sink {
        let right = "give the one that asp_read was called with, before it returns";
        return Err(Failure::new(ASP_BAD_ARGUMENT, format!("sink: is not open; {right}")));
    }
    // SAFETY: it is the address that `ask` has put there, whose sink lives until `ask` takes it
    // away again.
    Ok(unsafe { &mut *sink })
}

/// A program's files, and in front of them what lies in memory already.
pub(crate) struct Given {
    files: asp_files,
    pub(crate) memory: Memory,
}

impl Given {
    /// Files as they are given; null is the disk.
    pub(crate) fn new(files: *const asp_files) -> Result<Self, Failure> {
        let files = if files.is_null() { sized::Sized32::initial() } else { sized::read(files, "files")? };
        Ok(Self { files, memory: Memory::new() })
    }

    fn ask(&self, path: &Path) -> Option<asp_sink> {
        let read = self.files.read?;
        let name = CString::new(path.to_string_lossy().replace('\\', "/")).ok()?;
        let mut sink = asp_sink { bytes: None, picture: None };
        let before = OPEN.replace(&raw mut sink);
        // SAFETY: the program's own function, with what it was given for it.
        let answer = unsafe { read(self.files.user, name.as_ptr(), &raw mut sink) };
        OPEN.set(before);
        (answer == 0).then_some(sink)
    }
}

impl Files for Given {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        if let Ok(bytes) = self.memory.read(path) {
            return Ok(bytes);
        }
        if self.files.read.is_none() {
            return Disk.read(path);
        }
        self.ask(path).and_then(|sink| sink.bytes).ok_or(io::ErrorKind::NotFound.into())
    }

    fn picture(&self, path: &Path) -> Option<Cow<'_, Picture>> {
        if let Some(picture) = self.memory.picture(path) {
            return Some(picture);
        }
        self.ask(path)?.picture.map(Cow::Owned)
    }
}
