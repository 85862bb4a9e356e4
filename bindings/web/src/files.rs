//! Files: what scenes name, in memory. Pictures come decoded: browsers do that themselves.

use crate::exchange::{done, inbox};
use asperity::files::Memory;
use asperity::surface::picture::{Picture, Samples};
use std::cell::RefCell;

thread_local! {
    static FILES: RefCell<Memory> = RefCell::new(Memory::new());
}

/// Does something with the files that are there.
pub(crate) fn with<R>(work: impl FnOnce(&Memory) -> R) -> R {
    FILES.with_borrow(work)
}

/// The inbox begins with a name of so many bytes; what follows is the content.
fn named(name_bytes: usize) -> Result<(String, Vec<u8>), String> {
    let mut bytes = inbox();
    if name_bytes > bytes.len() {
        return Err(format!("a name of {name_bytes} bytes does not fit into {}; must", bytes.len()));
    }
    let content = bytes.split_off(name_bytes);
    let name = String::from_utf8(bytes).map_err(|_| "the name is not UTF-8; must be")?;
    Ok((name, content))
}

/// Keeps a file under a name. Inbox: the name, of `name_bytes` bytes, and the content.
#[unsafe(no_mangle)]
pub extern "C" fn asp_file(name_bytes: usize) -> u32 {
    done(named(name_bytes).map(|(name, content)| FILES.with_borrow_mut(|files| files.add(name, content))))
}

/// Keeps a decoded picture under a name. Inbox: the name, and the samples, row after row from the
/// top: 1, 2 or 4 bytes each (whole numbers, whole numbers, floating point), little-endian, one to
/// four a pixel.
#[unsafe(no_mangle)]
pub extern "C" fn asp_picture(name_bytes: usize, width: u32, height: u32, sample_bytes: u32) -> u32 {
    let add = || {
        let (name, bytes) = named(name_bytes)?;
        let samples = match sample_bytes {
            1 => Samples::U8(bytes),
            2 => Samples::U16(bytes.as_chunks().0.iter().map(|pair| u16::from_le_bytes(*pair)).collect()),
            4 => Samples::F32(bytes.as_chunks().0.iter().map(|four| f32::from_le_bytes(*four)).collect()),
            other => return Err(format!("sample_bytes: {other} is refused; must be 1, 2 or 4")),
        };
        let picture = Picture::new(width, height, samples).map_err(|problem| format!("{name}: {problem}"))?;
        FILES.with_borrow_mut(|files| files.add_picture(name, picture));
        Ok(())
    };
    done(add())
}

/// Forgets all files; what was made of them stays.
#[unsafe(no_mangle)]
pub extern "C" fn asp_forget_files() {
    FILES.take();
}
