//! Scene log: the contact log that a scene file names, for every verb that renders it.

use crate::error::CliError;
use asperity::files::contact_log::ContactLog;
use asperity::files::scene_file::SceneFile;

/// The contact log that a scene file names, and the keys in it that are read past.
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
    let text = std::fs::read_to_string(path).map_err(|error| CliError::read(path, &error))?;
    let (log, unread) =
        ContactLog::parse_telling(&text, &path.display().to_string()).map_err(CliError::told)?;
    let felt = log.check_actuators(file.actuators.len());
    felt.map_err(|error| CliError::told(error).within(path.display()))?;
    Ok((log, unread))
}

/// A key of the log format that this version does not act on.
pub fn read_past(place: &str) -> String {
    format!("{place}: is a key of the format, but this version does not act on it")
}
