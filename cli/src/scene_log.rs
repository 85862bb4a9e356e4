//! Scene log: the contact log that a scene file names, for every verb that renders it.

use crate::error::CliError;
use crate::output;
use asperity::files::contact_log::{ContactLog, Names};
use asperity::files::scene_file::SceneFile;
use asperity::{BodyId, ProbeId, SurfaceId};
use std::path::Path;

/// The contact log that a scene file names, and the keys in it that are read past. Every file of
/// the scene is noted as one that is read ([`output::reads`]).
///
/// # Errors
/// When none is named, it is no log, or it speaks of a channel that the scene does not have.
pub fn load_log(file: &SceneFile) -> Result<(ContactLog, Vec<String>), CliError> {
    let path = file.contacts.as_ref().ok_or_else(|| {
        CliError::new(
            format!("{}: contacts", file.path.display()),
            "is missing",
            "write contacts = \"NAME.jsonl\", the events to render",
        )
    })?;
    output::reads(file.named_files().into_iter().chain([&*file.path, &**path]));
    let folder = file.path.parent().unwrap_or(Path::new(""));
    let devices = file.actuators.iter().flat_map(|actuator| [&actuator.equalise, &actuator.limit]);
    output::reads(devices.flatten().map(|device| folder.join(device)));
    let text = std::fs::read_to_string(path).map_err(|error| CliError::read(path, &error))?;
    let (log, unread) =
        ContactLog::parse_telling(&text, &path.display().to_string()).map_err(CliError::from_error)?;
    // A surface that an edit adds is not the file's.
    let has_frame =
        |name: &str| file.surfaces.iter().all(|entry| entry.name != name || entry.frame.is_some());
    let fits = log.check_actuators(file.actuators.len()).and_then(|()| log.check_names(&names_of(file)));
    let fits = fits.and_then(|()| log.check_places(has_frame));
    fits.map_err(|error| error.in_text(&text, &path.display().to_string()))?;
    Ok((log, unread))
}

/// The names of a scene that is not built yet: their ids are none of an engine.
fn names_of(file: &SceneFile) -> Names {
    Names {
        surfaces: file.surfaces.iter().map(|entry| (entry.name.clone(), SurfaceId::from_bits(0))).collect(),
        bodies: file.bodies.iter().map(|entry| (entry.name.clone(), BodyId::from_bits(0))).collect(),
        probes: file.probes.iter().map(|(name, _)| (name.clone(), ProbeId::from_bits(0))).collect(),
    }
}

/// A key of the log format that this version does not act on.
pub fn read_past(place: &str) -> String {
    format!("{place}: is a key of the format, but this version does not act on it")
}

/// A number with so many digits behind the point, for short lines of a log.
pub fn rounded(value: f64, digits: i32) -> f64 {
    let unit = 10f64.powi(digits);
    (value * unit).round() / unit
}
