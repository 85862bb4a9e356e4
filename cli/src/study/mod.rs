//! `asperity study`: tests with people as a page that works without a network, and the tables of
//! their answers.

mod analyse;
mod examples;
mod serve;
mod spec;
mod stimuli;

use crate::error::CliError;
use crate::output::{self, Outputs, ensure_folder};
use clap::{Args, Subcommand};
use serde_json::json;
use sha2::{Digest, Sha256};
use spec::Study;
use std::path::{Path, PathBuf};

/// Ask people: a page for listening and touch tests, and the analysis of its answers
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Options {
    #[command(subcommand)]
    verb: Option<Verb>,
    /// Study: what is asked, of which scenes or WAV files
    #[arg(value_name = "STUDY.toml", required_unless_present = "example")]
    study: Option<PathBuf>,
    /// Write a study of the sources into the folder instead: DIR/study.toml and its scenes
    #[arg(long, value_name = "NAME", conflicts_with = "study", value_parser = clap::builder::PossibleValuesParser::new(examples::NAMES))]
    example: Option<String>,
    /// Folder of the page, or of the example; index.html is opened as it is
    #[arg(short, long = "output", value_name = "DIR", required = true)]
    output: Option<PathBuf>,
    /// Serve the page on the loopback address as well, and save answers to DIR/answers
    #[arg(long)]
    serve: bool,
    /// Port to serve on; 0 = one that is free
    #[arg(long, value_name = "N", default_value_t = 0)]
    port: u16,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Analyse(analyse::Options),
}

/// Runs the verb.
///
/// # Errors
/// When the study or an answer file is refused, or a file cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    if let Some(Verb::Analyse(options)) = &options.verb {
        return analyse::run(options);
    }
    let Some(folder) = &options.output else { return Ok(()) };
    ensure_folder(folder)?;
    if let Some(name) = &options.example {
        examples::write(name, folder)?;
        let study = folder.join("study.toml");
        output::say(&format!("wrote {}", study.display()));
        if !options.serve {
            let next = folder.join("page");
            output::say(&format!("next: asperity study {} --serve -o {}", study.display(), next.display()));
            return Ok(());
        }
        return page(&study, &folder.join("page"), options);
    }
    options.study.as_ref().map_or(Ok(()), |study| page(study, folder, options))
}

/// Writes the page of a study and serves it where that is asked.
fn page(study: &Path, folder: &Path, options: &Options) -> Result<(), CliError> {
    output::reads([study]);
    let text = std::fs::read(study).map_err(|error| CliError::read(study, &error))?;
    let study = Study::load(study)?;
    ensure_folder(&folder.join("stimuli"))?;
    let mut outputs = Outputs::new();
    let (shown, loudest, warnings) = stimuli::write(&study, folder, &mut outputs)?;
    let id: String = Sha256::digest(&text).iter().take(6).map(|byte| format!("{byte:02x}")).collect();
    let embedded = json!({
        "id": id, "title": study.title, "protocol": study.protocol, "trials": study.trials, "seed": study.seed,
        "training": study.training, "attention": study.attention, "reversals": study.reversals,
        "consent": study.consent, "instructions": study.instructions, "question": study.question,
        "labels": study.labels, "scales": study.scales, "stimuli": shown, "loudest": loudest,
    });
    let html = include_str!("page/study.html")
        .replace("@TITLE@", &study.title.replace('&', "&amp;").replace('<', "&lt;"))
        .replace("@SCRIPT@", include_str!("page/study.js"))
        .replace("@STUDY@", &embedded.to_string().replace('<', "\\u003c"));
    let page = folder.join("index.html");
    outputs.write(&page, html.as_bytes())?;
    outputs.commit()?;
    output::say(&format!("wrote {}{}", page.display(), output::warned(&warnings)));
    if options.serve { serve::serve(folder, options.port) } else { Ok(()) }
}
