//! The program `asperity`.
//!
//! One file a verb; what verbs share is here:
//!
//! | file | what every verb uses it for |
//! |---|---|
//! | [`error`] | one line that says what is wrong and what would be right |
//! | [`output`] | files that appear complete, together, or not at all |
//! | [`progress`] | a bar on a terminal, after a second, and nothing in a pipe |
//! | [`wav`], [`csv`] | samples and tables on disk |
//! | [`plot`] | pictures as SVG |
//!
//! A verb is a file with `pub struct Options` (derives `clap::Args`) and `pub fn run(options: &Options)
//! -> Result<(), CliError>`, one variant of [`Verb`] and one arm of [`run`].
//!
//! Exit status: 0 done, 1 bad input or a failed run, 2 wrong usage.

mod build;
mod csv;
mod demo;
mod error;
mod output;
mod plot;
mod progress;
mod render;
mod scene_file;
#[allow(dead_code)]
mod texture_analyze;
mod wav;

use clap::{Parser, Subcommand, error::ErrorKind};
use error::CliError;
use std::process::ExitCode;

/// Touch into signal: from contact events and texture maps to vibrotactile channels and modal audio.
#[derive(Debug, Parser)]
#[command(name = "asperity", version, about, disable_help_subcommand = true)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

/// What to do.
#[derive(Debug, Subcommand)]
enum Verb {
    Render(render::Options),
}

fn run(verb: Verb) -> Result<(), CliError> {
    match verb {
        Verb::Render(options) => render::run(&options),
    }
}

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(refusal) => return usage(&refusal),
    };
    // A panic is a defect of ours; whoever runs the program still gets one line and a status.
    std::panic::set_hook(Box::new(|_| {}));
    let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| run(arguments.verb)));
    match outcome {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(error)) => {
            eprintln!("{error}");
            ExitCode::from(1)
        }
        Err(payload) => {
            eprintln!("{}", CliError::defect(payload.as_ref()));
            ExitCode::from(1)
        }
    }
}

/// Help and version go to stdout; every other refusal of the command line is one line and status 2.
fn usage(refusal: &clap::Error) -> ExitCode {
    match refusal.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            let _ = refusal.print();
            ExitCode::SUCCESS
        }
        _ => {
            eprintln!("{}", error::usage_line(refusal));
            ExitCode::from(2)
        }
    }
}
