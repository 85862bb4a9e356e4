//! Whole files: written beside their name and renamed, so that a file is there whole or not at all.

use asperity::files::FileError;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes a file by a function.
///
/// # Errors
/// When the folder cannot be written or the disk is full; then nothing is left behind.
pub fn write_with(
    path: &Path,
    fill: impl FnOnce(BufWriter<File>) -> io::Result<()>,
) -> Result<(), FileError> {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let temporary = path.with_file_name(format!(".{name}.{}.part", std::process::id()));
    let written = File::create(&temporary)
        .and_then(|file| fill(BufWriter::with_capacity(1 << 18, file)))
        .and_then(|()| fs::rename(&temporary, path));
    written.map_err(|error| {
        let _ = fs::remove_file(&temporary);
        FileError::write(path, &error)
    })
}

/// Writes bytes.
///
/// # Errors
/// As [`write_with`].
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    write_with(path, |mut file| file.write_all(bytes).and_then(|()| file.flush()))
}

/// The same, unless the file is there already and holds them.
///
/// # Errors
/// As [`write_with`].
pub fn write_once(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    if fs::read(path).is_ok_and(|there| there == bytes) { Ok(()) } else { write(path, bytes) }
}
