//! Paths of the command line: which arguments are read, which are written, and what a written one
//! ends in.
//!
//! [`check`] runs before the verb. It hands every file that is read to [`output::reads`], so that
//! no verb can write over it, and refuses an output that is an input, or whose name says that it
//! holds something else. What a verb reads besides (maps of a scene, buffers of a document) it
//! hands over itself.

use crate::error::CliError;
use crate::output;
use clap::ArgMatches;
use std::path::{Path, PathBuf};

/// Arguments that name files to read.
const READ: [&str; 25] = [
    "strokes",
    "ring",
    "colour",
    "scene",
    "recording",
    "recordings",
    "further",
    "merge",
    "mesh",
    "body",
    "bodies",
    "damping_from",
    "input",
    "device",
    "document",
    "photo",
    "known",
    "normals",
    "original",
    "reference",
    "spec",
    "what",
    "study",
    "answers",
    "bake",
];

/// Arguments that are pictures or folders of pictures to read.
const READ_PICTURES: [&str; 3] = ["image", "maps", "folder"];

/// Arguments that name files to write, and what the file ends in; `None` where the verb itself says
/// so.
const WRITTEN: [(&str, Option<&str>); 8] = [
    ("output", None),
    ("port", None),
    ("plot", Some("svg")),
    ("csv", Some("csv")),
    ("residual", Some("wav")),
    ("resynthesis", Some("wav")),
    ("primitive", Some("png")),
    ("stl", Some("stl")),
];

/// Verbs whose `--output` is one file of a kind that its name must say.
const OUTPUTS: [(&str, &str); 6] = [
    ("device", "toml"),
    ("fit", "json"),
    ("modes", "json"),
    ("metamer", "png"),
    ("from-normals", "png"),
    ("brownian", "png"),
];

/// Hands over what the command line reads and checks what it writes.
///
/// # Errors
/// When an output is an input, or ends as another kind of file does.
pub fn check(arguments: &ArgMatches) -> Result<(), CliError> {
    let Some((verb, arguments)) = innermost(arguments) else { return Ok(()) };
    // A scene that is tuned while it plays is written back: that is what the page is for.
    if verb == "play" {
        return Ok(());
    }
    output::reads(READ.iter().chain(&READ_PICTURES).flat_map(|name| values(arguments, name)));
    for (name, ending) in WRITTEN {
        let of_verb = OUTPUTS.iter().find(|(of, _)| name == "output" && *of == verb);
        let ending = ending.or(of_verb.map(|(_, ending)| *ending));
        for path in values(arguments, name) {
            output::refuse_input(&path)?;
            ending.map_or(Ok(()), |ending| ends_in(&path, ending))?;
        }
    }
    Ok(())
}

/// The verb that runs, and its arguments: `texture metamer` is `metamer`.
fn innermost(arguments: &ArgMatches) -> Option<(&str, &ArgMatches)> {
    let (verb, inner) = arguments.subcommand()?;
    Some(innermost(inner).unwrap_or((verb, inner)))
}

/// Paths that an argument holds: flags and numbers of the same name hold none.
fn values(arguments: &ArgMatches, name: &str) -> Vec<PathBuf> {
    let paths = arguments.try_get_many::<PathBuf>(name).ok().flatten().into_iter().flatten().cloned();
    let texts =
        arguments.try_get_many::<String>(name).ok().flatten().into_iter().flatten().map(PathBuf::from);
    paths.chain(texts).collect()
}

/// Tests whether a file's name ends with one of these, in any case.
pub fn has_end(path: &Path, ends: &[&str]) -> bool {
    path.extension().is_some_and(|end| ends.iter().any(|known| end.eq_ignore_ascii_case(known)))
}

/// A file's name without folder, ending, and the kind before it: `pan.take1` of
/// `pan.take1.modes.json`.
pub fn without_ends(path: &Path) -> String {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let kind = [".modes", ".haptic", ".audio"].iter().find_map(|kind| stem.strip_suffix(kind));
    kind.map_or(stem.clone(), str::to_owned)
}

/// Refuses a path that ends as another kind of file does.
///
/// # Errors
/// When it does.
pub fn ends_in(path: &Path, ending: &str) -> Result<(), CliError> {
    if has_end(path, &[ending]) {
        return Ok(());
    }
    Err(CliError::file(
        path,
        format!("is not named as what it will hold: .{ending}"),
        format!("must end in .{ending}"),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Arguments;
    use clap::{Command, CommandFactory};
    use std::any::TypeId;

    fn paths(command: &Command, found: &mut Vec<String>) {
        let is_path =
            |argument: &&clap::Arg| argument.get_value_parser().type_id() == TypeId::of::<PathBuf>();
        found.extend(command.get_arguments().filter(is_path).map(|argument| argument.get_id().to_string()));
        command.get_subcommands().for_each(|inner| paths(inner, found));
    }

    #[test]
    fn every_path_of_the_command_line_is_read_or_written() {
        let mut found = Vec::new();
        paths(&Arguments::command(), &mut found);
        assert!(found.len() > 30, "{found:?}");
        for name in found {
            let read = READ.contains(&name.as_str()) || READ_PICTURES.contains(&name.as_str());
            let written = WRITTEN.iter().any(|(written, _)| *written == name);
            assert!(read != written, "{name}: add it to READ or to WRITTEN");
        }
    }

    #[test]
    fn flags_that_are_named_as_outputs_of_other_verbs_are_no_paths() {
        for line in [
            &["asperity", "render", "a.toml", "-o", "a", "--plot"][..],
            &["asperity", "render", "a.toml", "-o", "a"],
        ] {
            check(&Arguments::command().try_get_matches_from(line).unwrap()).unwrap();
        }
    }

    #[test]
    fn a_modes_file_named_as_a_recording_is_refused() {
        for (line, ending) in [
            (&["asperity", "fit", "pan.wav", "-o", "pan2.wav"][..], ".json"),
            (&["asperity", "modes", "pan.obj", "-o", "pan.wav"], ".json"),
            (&["asperity", "fit", "pan.wav", "-o", "pan.json", "--plot", "pan.wav"], ".svg"),
            (&["asperity", "texture", "metamer", "a.png", "b.png", "-o", "c.wav"], ".png"),
        ] {
            let arguments = Arguments::command().try_get_matches_from(line).unwrap();
            let refused = check(&arguments).unwrap_err().to_string();
            assert!(refused.contains("wav: ") && refused.ends_with(ending), "{refused}");
        }
    }
}
