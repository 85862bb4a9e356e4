//! `asperity batch` of a program that was built without data sets: says so.

use crate::error::CliError;
use clap::Args;

/// Render a data set of strokes (this program was built without)
#[derive(Debug, Args)]
pub struct Options {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    _anything: Vec<String>,
}

/// Runs the verb.
///
/// # Errors
/// Always.
pub fn run(_options: &Options) -> Result<(), CliError> {
    let right = "run `cargo run --release -p asperity-cli -- batch`, which builds them";
    Err(CliError::new("asperity batch", "this program was built without data sets", right))
}
