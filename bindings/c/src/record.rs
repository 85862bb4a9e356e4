//! Recordings: what is reported and edited, as a contact log that renders to the same samples.

use crate::entry::enter;
use crate::handles::{SCENES, asp_scene};
use crate::status::{ASP_FILE, Failure};
use crate::text;
use asperity::files::FileError;
use std::ffi::c_char;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Records from now on, in memory, what is reported and how the scene is edited, each with the time
/// at which the engine applies it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_record_start(scene: *mut asp_scene) -> i32 {
    enter(|| {
        let mut half = SCENES.hold(scene as usize)?;
        let names = half.names.clone();
        half.scene.start_recording(&names);
        Ok(())
    })
}

/// Ends the recording and writes it to `path` (JSON Lines); it is whole or not there. NULL throws
/// it away.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_record_stop(scene: *mut asp_scene, path: *const c_char) -> i32 {
    enter(|| {
        let path = text::optional(path, "path")?.map(Path::new);
        let log = SCENES.hold(scene as usize)?.scene.stop_recording();
        let Some(path) = path else { return Ok(()) };
        let mut beside = path.as_os_str().to_owned();
        beside.push(".part");
        let beside = PathBuf::from(beside);
        let write = || {
            let mut out = std::io::BufWriter::new(fs::File::create(&beside)?);
            log.write(&mut out)?;
            out.flush()?;
            fs::rename(&beside, path)
        };
        write().map_err(|error| {
            // It may never have been made.
            let _ = fs::remove_file(&beside);
            Failure::new(ASP_FILE, FileError::write(path, &error))
        })
    })
}
