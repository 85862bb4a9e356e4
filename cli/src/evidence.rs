//! `asperity evidence NAME -o DIR`: a figure or table of the sources, computed again.

use crate::error::CliError;
use crate::output::{self, Outputs, ensure_folder};
use crate::progress::Progress;
use asperity_evidence::sources::ALL;
use clap::Args;
use std::path::PathBuf;

/// Compute a figure or table of the sources again and put it beside what is printed
#[derive(Debug, Args)]
pub struct Options {
    /// Name of the figure or table, as --list has it
    #[arg(value_name = "NAME", required_unless_present = "list")]
    pub name: Option<String>,
    /// Folder for evidence.json
    #[arg(short, long = "output", value_name = "DIR", required_unless_present = "list")]
    pub output: Option<PathBuf>,
    /// List the names
    #[arg(long)]
    pub list: bool,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Runs the verb.
///
/// # Errors
/// When the name is unknown or the folder cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let (false, Some(name), Some(folder)) = (options.list, &options.name, &options.output) else {
        let names: Vec<_> = ALL.iter().map(|entry| (entry.name, entry.title)).collect();
        if options.json {
            return output::say_json(
                &serde_json::json!({"names": names.iter().map(|(name, _)| name).collect::<Vec<_>>()}),
            );
        }
        names.iter().for_each(|(name, title)| output::say(&format!("{name:14} {title}")));
        return Ok(());
    };
    let entry = ALL.iter().find(|entry| entry.name == name).ok_or_else(|| {
        let known = ALL.map(|entry| entry.name).join(", ");
        CliError::new("NAME", format!("\"{name}\" is unknown"), format!("must be one of: {known}"))
    })?;
    let path = folder.join("evidence.json");
    output::refuse_input(&path)?;
    let progress = Progress::new("computing", 1);
    let evidence = entry.run().map_err(|error| CliError::new(entry.name, error, "please report it"))?;
    drop(progress);
    ensure_folder(folder)?;
    let mut outputs = Outputs::new();
    outputs.write_json(&path, &evidence)?;
    outputs.commit()?;
    output::say_report(&evidence, options.json, || format!("{}\nwrote {}", evidence.sentence, path.display()))
}
