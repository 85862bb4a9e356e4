//! Whole files: written beside their name and renamed, so that a file is there whole or not at all.

use asperity::files::FileError;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

/// Writes a file by a function.
///
/// # Errors
/// When the folder cannot be written or the disk is full; then nothing is left behind.
pub fn write_with(
    path: &Path,
    fill: impl FnOnce(BufWriter<File>) -> io::Result<()>,
) -> Result<(), FileError> {
    let temporary = Temporary(path.with_file_name(temporary_name(path)));
    let write = || {
        let file = File::create(&temporary.0)?;
        // Held until the file has its name. Who clears up after killed runs sees by it that this
        // one is alive: the system takes a dead process's lock away.
        let held = file.try_clone()?;
        let _ = held.try_lock();
        fill(BufWriter::with_capacity(1 << 18, file))?;
        fs::rename(&temporary.0, path)
    };
    let written = write();
    written.map_err(|error| FileError::write(path, &error))
}

/// A name that no other process on any machine that shares the folder, and no other thread, writes
/// to at the same time.
fn temporary_name(path: &Path) -> String {
    static BEGAN: OnceLock<u128> = OnceLock::new();
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let since = || SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos());
    let began = BEGAN.get_or_init(since);
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    format!(".{name}.{}-{began:x}-{}.part", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed))
}

/// Removed when it is let go, also by work that is left by unwinding; once renamed there is nothing
/// to remove.
struct Temporary(PathBuf);

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// Writes bytes.
///
/// # Errors
/// As [`write_with`].
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    write_with(path, |mut file| file.write_all(bytes).and_then(|()| file.flush()))
}

/// Writes a whole file, unless it is there already and holds these bytes.
///
/// # Errors
/// As [`write_with`].
pub fn write_once(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    if fs::read(path).is_ok_and(|there| there == bytes) { Ok(()) } else { write(path, bytes) }
}
