//! Arguments that several verbs take, and those of a verb that another one runs.

use crate::error::CliError;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Command};
use std::ffi::OsString;
use std::path::Path;

/// Options of a verb as `asperity VERB INPUT -o OUTPUT` has them.
///
/// # Errors
/// When the verb needs more options than these.
pub fn plain<T: Args>(input: &Path, output: &Path) -> Result<T, CliError> {
    let mut output_is = OsString::from("--output=");
    output_is.push(output);
    let command = T::augment_args(Command::new("asperity").no_binary_name(true));
    let matches = command.try_get_matches_from([output_is, "--".into(), input.into()]);
    matches.and_then(|matches| T::from_arg_matches(&matches)).map_err(CliError::from_error)
}

/// Words that an option takes, what `--help` says of each, and what they mean.
pub type Words<T, const N: usize> = [(&'static str, &'static str, T); N];

/// The meaning of one of the words.
pub fn one_of<T, const N: usize>(words: Words<T, N>) -> impl TypedValueParser<Value = T>
where
    T: Copy + Send + Sync + 'static,
{
    let known = PossibleValuesParser::new(words.map(|(word, help, _)| PossibleValue::new(word).help(help)));
    known.try_map(move |written| {
        words.iter().find(|(word, ..)| *word == written).map(|(.., meaning)| *meaning).ok_or("is not known")
    })
}

/// The word that means this; the first if none does.
pub fn word_of<T: PartialEq>(words: &[(&'static str, &'static str, T)], meant: T) -> &'static str {
    words.iter().find(|(.., meaning)| *meaning == meant).unwrap_or(&words[0]).0
}

/// A number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("must be a number above 0".to_owned()),
    }
}

/// Three numbers with commas between them; `right` is what they would be.
pub fn three(text: &str, right: &str) -> Result<[f64; 3], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let numbers = numbers.ok().and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
    numbers.ok_or_else(|| format!("must be three numbers{right}"))
}
