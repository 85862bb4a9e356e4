//! `asperity batch`: data sets of rendered strokes, shard by shard.

use crate::error::CliError;
use crate::output;
use crate::progress::Progress;
use asperity_batch::{DataSet, Outcome, Spec, Verified, verify};
use clap::{Args, Subcommand};
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// Render a data set of strokes, or a part of its shards; what is there already is kept
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Options {
    #[command(subcommand)]
    verb: Option<Verb>,
    /// Specification
    #[arg(value_name = "SPEC.toml", required = true)]
    spec: Option<PathBuf>,
    /// Folder of the shards
    #[arg(short, long = "output", value_name = "DIR", required = true)]
    output: Option<PathBuf>,
    /// Only the shards whose number mod N is I, from 0; missing: what Slurm's array task says, or
    /// all
    #[arg(long, value_name = "I/N", value_parser = share)]
    shard: Option<Share>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Compare every shard with the manifest, and render a share of the strokes again
    Verify(VerifyOptions),
}

#[derive(Debug, Args)]
struct VerifyOptions {
    /// Folder of the shards
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Share of the strokes that are rendered again and compared to the bit, 0 to 1
    #[arg(long, value_name = "F", default_value_t = 0.0, value_parser = fraction)]
    sample: f64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// The shards whose number mod `of` is `index`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Share {
    index: u64,
    of: u64,
}

fn share(text: &str) -> Result<Share, String> {
    let right = || "must be I/N, I from 0 to N − 1".to_owned();
    let (index, of) = text.split_once('/').ok_or_else(right)?;
    let (index, of) = (index.parse().map_err(|_| right())?, of.parse().map_err(|_| right())?);
    if index < of { Ok(Share { index, of }) } else { Err(right()) }
}

fn fraction(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err("must be 0 to 1".to_owned()),
    }
}

/// Number that Slurm gives an array's task; none outside an array.
fn share_of_slurm(variable: impl Fn(&str) -> Option<String>) -> Option<Share> {
    let number = |name: &str| variable(name)?.parse::<u64>().ok();
    let (task, of) = (number("SLURM_ARRAY_TASK_ID")?, number("SLURM_ARRAY_TASK_COUNT")?);
    let index = task.checked_sub(number("SLURM_ARRAY_TASK_MIN").unwrap_or(0))?;
    (index < of).then_some(Share { index, of })
}

#[derive(Debug, Serialize)]
struct Report {
    made: u64,
    kept: u64,
    shards: u64,
    shards_there: u64,
    strokes: u64,
    clipped_samples: u64,
    seconds: f64,
    warnings: Vec<String>,
}

/// Runs the verb.
///
/// # Errors
/// When the specification is refused, or a shard cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    match (&options.verb, &options.spec, &options.output) {
        (Some(Verb::Verify(options)), ..) => check(options),
        (None, Some(spec), Some(folder)) => make(options, spec, folder),
        // The command line asks for both.
        (None, ..) => Err(CliError::new("asperity batch", "has no specification", "write SPEC.toml -o DIR")),
    }
}

fn make(options: &Options, spec: &std::path::Path, folder: &std::path::Path) -> Result<(), CliError> {
    let started = Instant::now();
    let set = DataSet::open(Spec::load(spec).map_err(CliError::from_error)?, folder)
        .map_err(CliError::from_error)?;
    let says = &set.spec().says;
    let share = options.shard.or_else(|| share_of_slurm(|name| std::env::var(name).ok()));
    let share = share.unwrap_or(Share { index: 0, of: 1 });
    let mine: Vec<u64> = (share.index..set.spec().shards()).step_by(share.of as usize).collect();
    let strokes: u64 =
        mine.iter().map(|index| says.per_shard.min(says.strokes - index * says.per_shard)).sum();
    let mut progress = Progress::new("strokes", strokes);
    let mut report = Report {
        made: 0,
        kept: 0,
        shards: set.spec().shards(),
        shards_there: 0,
        strokes,
        clipped_samples: 0,
        seconds: 0.0,
        warnings: set.empty_parts().into_iter().collect(),
    };
    for index in mine {
        match set.shard(index, &mut || progress.advance(1)).map_err(CliError::from_error)? {
            Outcome::Made { clipped } => {
                report.made += 1;
                report.clipped_samples += clipped;
            }
            Outcome::Kept => report.kept += 1,
        }
    }
    drop(progress);
    report.shards_there = set.write_manifest().map_err(CliError::from_error)?.shards.len() as u64;
    report.seconds = started.elapsed().as_secs_f64();
    report.warnings.extend(set.remarks());
    if report.clipped_samples > 0 {
        report.warnings.push(format!(
            "{} samples of the sound were beyond full scale and cut off; lower output.audio.gain, or write codec = \"f32\"",
            report.clipped_samples
        ));
    }
    output::say_report(&report, options.json, || {
        format!(
            "shards made: {}, kept: {}; {} of {} are there\nwrote {}{}",
            report.made,
            report.kept,
            report.shards_there,
            report.shards,
            folder.join(asperity_batch::manifest::NAME).display(),
            output::warned(&report.warnings)
        )
    })
}

fn check(options: &VerifyOptions) -> Result<(), CliError> {
    let shards = asperity_batch::manifest::Manifest::load(&options.folder).map_err(CliError::from_error)?;
    let mut progress = Progress::new("shards", shards.map_or(0, |manifest| manifest.shards.len() as u64));
    let found =
        verify(&options.folder, options.sample, &mut || progress.advance(1)).map_err(CliError::from_error)?;
    drop(progress);
    output::say_report(&found, options.json, || {
        let Verified { shards, missing, rendered } = found;
        format!(
            "{shards} shards hold what the manifest says, {missing} are not there yet; {rendered} strokes rendered again to the same bits"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_a_place_among_as_many() {
        assert_eq!(share("17/1000"), Ok(Share { index: 17, of: 1000 }));
        for wrong in ["3/3", "3", "-1/3", "1/0", "a/b", "1/2/3"] {
            assert!(share(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn an_array_task_of_slurm_is_a_share() {
        let of = |pairs: &'static [(&str, &str)]| {
            share_of_slurm(|name| {
                pairs.iter().find(|(key, _)| *key == name).map(|(_, value)| (*value).to_owned())
            })
        };
        let all =
            &[("SLURM_ARRAY_TASK_ID", "5"), ("SLURM_ARRAY_TASK_COUNT", "8"), ("SLURM_ARRAY_TASK_MIN", "1")];
        assert_eq!(of(all), Some(Share { index: 4, of: 8 }));
        assert_eq!(of(&[("SLURM_ARRAY_TASK_ID", "5")]), None);
        assert_eq!(of(&[]), None);
    }
}
