//! The program `asperity`.
//!
//! One file a verb; what verbs share is here:
//!
//! | file | what every verb uses it for |
//! |---|---|
//! | [`error`] | one line that says what is wrong and what would be right |
//! | [`output`] | files that appear complete, together, or not at all, and never over an input |
//! | [`paths`] | which arguments are read and which written |
//! | [`progress`] | a bar on a terminal, after a second, and nothing in a pipe |
//! | [`wav`], [`csv`], [`columns`] | samples and tables on disk |
//!
//! A verb is a file with `pub struct Options` (derives `clap::Args`) and `pub fn run(options:
//! &Options) -> Result<(), CliError>`, one variant of [`Verb`] and one arm of [`run`].
//!
//! Exit status: 0 done, 1 bad input or a failed run, 2 wrong usage.

mod answer;
mod arguments;
#[cfg(feature = "data-sets")]
mod batch;
#[cfg(not(feature = "data-sets"))]
#[path = "no_batch.rs"]
mod batch;
mod bench_scene;
mod columns;
mod csv;
mod demo;
mod device;
mod error;
mod evidence;
mod export;
mod fit;
mod haptic;
mod headroom;
mod import;
mod measure;
mod modes;
mod output;
mod paths;
mod play;
mod progress;
mod render;
mod report;
mod scene_log;
mod scorecard;
mod shapes;
mod sounds;
mod strike;
mod stroke;
mod study;
mod texture;
mod unwrap;
mod wav;
mod web;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand, error::ErrorKind};
use error::CliError;
use std::process::ExitCode;

/// Touch into signal: from contact events and texture maps to vibrotactile channels and modal
/// audio.
#[derive(Debug, Parser)]
#[command(name = "asperity", version, about, disable_help_subcommand = true)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

/// Verbs.
#[derive(Debug, Subcommand)]
enum Verb {
    Demo(demo::Options),
    Strike(Box<strike::Options>),
    Stroke(Box<stroke::Options>),
    Fit(Box<fit::Options>),
    Modes(Box<modes::Options>),
    Haptic(Box<haptic::Options>),
    Device(device::Options),
    Import(import::Options),
    Export(export::Options),
    Render(render::Options),
    Play(play::Options),
    /// Make surfaces from pictures and from other surfaces
    #[command(subcommand)]
    Texture(texture::Verb),
    Headroom(headroom::Options),
    Report(report::Options),
    Evidence(evidence::Options),
    Web(web::Options),
    Batch(batch::Options),
    Study(study::Options),
    Scorecard(scorecard::Options),
}

fn run(verb: Verb) -> Result<(), CliError> {
    match verb {
        Verb::Demo(options) => demo::run(&options),
        Verb::Strike(options) => strike::run(&options),
        Verb::Stroke(options) => stroke::run(&options),
        Verb::Fit(options) => fit::run(&options),
        Verb::Modes(options) => modes::run(&options),
        Verb::Haptic(options) => haptic::run(&options),
        Verb::Device(options) => device::run(&options),
        Verb::Import(options) => import::run(&options),
        Verb::Export(options) => export::run(&options),
        Verb::Render(options) => render::run(&options),
        Verb::Play(options) => play::run(&options),
        Verb::Texture(verb) => texture::run(verb),
        Verb::Headroom(options) => headroom::run(&options),
        Verb::Report(options) => report::run(&options),
        Verb::Evidence(options) => evidence::run(&options),
        Verb::Web(options) => web::run(&options),
        Verb::Batch(options) => batch::run(&options),
        Verb::Study(options) => study::run(&options),
        Verb::Scorecard(options) => scorecard::run(&options),
    }
}

fn main() -> ExitCode {
    let given = with_negative_numbers(Arguments::command()).try_get_matches();
    let parsed = given.and_then(|given| Ok((Arguments::from_arg_matches(&given)?, given)));
    let (arguments, given) = match parsed {
        Ok(parsed) => parsed,
        Err(refusal) => return usage(&refusal),
    };
    // A panic is a defect of ours; whoever runs the program still gets one line and a status.
    std::panic::set_hook(Box::new(|_| {}));
    let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        paths::check(&given).and_then(|()| run(arguments.verb))
    }));
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

/// Verbs whose options take numbers below 0 for numbers, so that their ranges answer.
fn with_negative_numbers(verb: clap::Command) -> clap::Command {
    let names: Vec<String> = verb.get_subcommands().map(|verb| verb.get_name().to_owned()).collect();
    let takes = |option: clap::Arg| {
        let is_value = option.get_action().takes_values() && !option.is_positional();
        if is_value { option.allow_negative_numbers(true) } else { option }
    };
    names
        .into_iter()
        .fold(verb.mut_args(takes), |verb, name| verb.mut_subcommand(name, with_negative_numbers))
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
