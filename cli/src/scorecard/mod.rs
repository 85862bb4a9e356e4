//! `asperity scorecard`: every figure that README claims, measured here and now beside its anchor,
//! failures first.
//!
//! A part is a function of [`PARTS`] that gives rows and confusion matrices. Rows are the same in
//! every run, but for those whose names begin with `speed`.

mod measured;
mod page;

use crate::error::CliError;
use crate::output::{self, Outputs, ensure_folder};
use crate::progress::Progress;
use asperity_evidence::observer::{constants, second};
use clap::Args;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Measure every claimed figure on this machine: one page and a JSON file
#[derive(Debug, Args)]
pub struct Options {
    /// Folder for index.html and scorecard.json
    #[arg(short, long = "output", value_name = "DIR")]
    output: PathBuf,
    /// Recordings of hits to fit as well, a folder
    #[arg(long, value_name = "DIR")]
    recordings: Option<PathBuf>,
    /// Fewer trials and no long references: another, coarser set of rows
    #[arg(long)]
    quick: bool,
    /// Print the JSON object too
    #[arg(long)]
    json: bool,
}

/// One figure beside its anchor.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    name: String,
    /// Anchor in words.
    reference: String,
    /// Source of the anchor.
    source: &'static str,
    ours: f64,
    /// Lowest and highest that pass; an end that is open is null.
    bound: [Option<f64>; 2],
    pass: bool,
    command: &'static str,
}

/// A confusion matrix: shares, a row what was asked.
#[derive(Debug, Clone, Serialize)]
pub struct Matrix {
    labels: Vec<String>,
    observer: &'static str,
    ours: Vec<Vec<f64>>,
    /// The source's, where it is printed as numbers.
    paper: Option<Vec<Vec<f64>>>,
}

/// Rows and matrices of a part.
#[derive(Debug, Default)]
pub struct Part {
    rows: Vec<Row>,
    confusion: BTreeMap<String, Matrix>,
}

impl Part {
    /// Adds a row; it passes within its bounds.
    fn row(
        &mut self,
        name: impl Into<String>,
        ours: f64,
        bound: [Option<f64>; 2],
        (reference, source, command): (impl Into<String>, &'static str, &'static str),
    ) {
        let pass = bound[0].is_none_or(|low| ours >= low) && bound[1].is_none_or(|high| ours <= high);
        // A figure that is none has failed.
        let pass = pass && ours.is_finite();
        self.rows.push(Row {
            name: name.into(),
            reference: reference.into(),
            source,
            ours,
            bound,
            pass,
            command,
        });
    }
}

/// Measures a part; `true` for the quick one.
type Measure = fn(bool) -> Result<Part, CliError>;

/// Every part, in the order of the page.
const PARTS: [(&str, Measure); 8] = [
    ("kernels", measured::kernels),
    ("fit", measured::fit),
    ("six plates", measured::six_plates),
    ("seven materials", measured::seven_materials),
    ("growth", measured::growth_laws),
    ("ports", measured::ports),
    ("sources", measured::sources),
    ("speed", measured::speed),
];

#[derive(Debug, Serialize)]
struct Observer {
    name: &'static str,
    sha256: String,
}

/// `scorecard.json`.
#[derive(Debug, Serialize)]
pub struct Card {
    version: &'static str,
    quick: bool,
    observers: [Observer; 2],
    rows: Vec<Row>,
    confusion: BTreeMap<String, Matrix>,
}

/// Runs the verb.
///
/// # Errors
/// When the folder cannot be written, or a part fails by a defect.
pub fn run(options: &Options) -> Result<(), CliError> {
    ensure_folder(&options.output)?;
    let mut progress = Progress::new("measuring", PARTS.len() as u64);
    let mut parts = Vec::new();
    if let Some(folder) = &options.recordings {
        parts.push(measured::recordings(folder, options.quick)?);
    }
    for (name, measure) in PARTS {
        parts.push(measure(options.quick).map_err(|error| error.within(name))?);
        progress.advance(1);
    }
    drop(progress);
    let card = card(options.quick, parts);
    let mut outputs = Outputs::new();
    let json = serde_json::to_string_pretty(&card).map_err(CliError::from_error)?;
    outputs.write(&options.output.join("scorecard.json"), format!("{json}\n").as_bytes())?;
    outputs.write(&options.output.join("index.html"), page::html(&card).as_bytes())?;
    outputs.commit()?;
    if options.json {
        output::say(&json);
        return Ok(());
    }
    output::say(&summary(&card.rows));
    output::say(&format!("wrote {}", options.output.join("index.html").display()));
    Ok(())
}

/// The card of some parts, failures first.
fn card(quick: bool, parts: Vec<Part>) -> Card {
    let observers = [
        Observer { name: "first", sha256: constants::constants_sha256() },
        Observer { name: "second", sha256: second::constants_sha256() },
    ];
    let (mut rows, mut confusion) = (Vec::new(), BTreeMap::new());
    for part in parts {
        rows.extend(part.rows);
        confusion.extend(part.confusion);
    }
    rows.sort_by_key(|row: &Row| row.pass);
    Card { version: env!("CARGO_PKG_VERSION"), quick, observers, rows, confusion }
}

/// Rows, and the names of those outside their bounds.
fn summary(rows: &[Row]) -> String {
    let failed: Vec<&str> = rows.iter().filter(|row| !row.pass).map(|row| &*row.name).collect();
    let count = asperity_plot::counted(rows.len() as u64, "row");
    let colon = if failed.is_empty() { "" } else { ": " };
    format!("{count}, {} outside their bounds{colon}{}", failed.len(), failed.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_outside_its_bound_and_one_without_number_fail() {
        let mut part = Part::default();
        for (ours, bound) in [(0.5, [Some(0.6), None]), (0.7, [Some(0.6), None]), (f64::NAN, [None, None])] {
            part.row("x", ours, bound, ("", "", ""));
        }
        assert_eq!(part.rows.iter().map(|row| row.pass).collect::<Vec<_>>(), [false, true, false]);
        part.rows.sort_by_key(|row| row.pass);
        assert!(!part.rows[0].pass && part.rows[2].pass);
    }

    #[test]
    fn a_row_that_was_made_to_fail_is_shown_first_and_named() {
        let mut part = Part::default();
        for (name, most) in [("holds", 1.0), ("made to fail", 0.4), ("holds too", 1.0)] {
            part.row(name, 0.5, [None, Some(most)], ("an anchor", "own reference", "asperity report -o DIR"));
        }
        let card = card(false, vec![part]);
        assert_eq!(card.rows[0].name, "made to fail");
        assert_eq!(summary(&card.rows), "3 rows, 1 outside their bounds: made to fail");
        let page = page::html(&card);
        let first = page.split_once("<tr class=").unwrap().1;
        assert!(first.starts_with("\"fails\"><td>made to fail</td>"), "{first}");
        assert!(page.contains("<code>asperity report -o DIR</code>"));
    }
}
