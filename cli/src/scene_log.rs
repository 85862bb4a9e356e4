//! Scene log: the contact log that a scene file names, for every verb that renders it.

use crate::error::CliError;
use asperity::files::contact_log::{ContactLog, LogEvent};
use asperity::files::scene_file::SceneFile;
use std::path::Path;

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
    check_actuators(&log, path, file.actuators.len())?;
    Ok((log, unread))
}

/// A contact on a channel that is not there would be felt nowhere.
fn check_actuators(log: &ContactLog, path: &Path, channels: usize) -> Result<(), CliError> {
    for line in &log.lines {
        let hand = match &line.event {
            LogEvent::Begin { touching, .. } => &touching.hand,
            LogEvent::Impact { hand, .. } => hand,
            LogEvent::Move { .. } | LogEvent::End { .. } | LogEvent::Edit(_) => continue,
        };
        if let Some(actuator) = hand.actuator.filter(|actuator| usize::from(*actuator) >= channels) {
            let what = format!("actuator {actuator} at t = {} s is not in the scene", line.t);
            let right = format!("must be below {channels}, the number of [[actuator]] tables");
            return Err(CliError::new("actuator", what, right).within(path.display()));
        }
    }
    Ok(())
}

/// A key of the log format that this version does not act on.
pub fn read_past(place: &str) -> String {
    format!("{place}: is a key of the format, but this version does not act on it")
}
