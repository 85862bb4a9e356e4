//! `asperity study analyse`: tables of answers with intervals, and the sources' figures beside.

mod table;

use super::examples;
use super::spec::Protocol;
use crate::error::CliError;
use crate::output;
use asperity_evidence::statistics::{self, Estimate};
use clap::Args;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// First line of a file of answers.
pub const HEADER: &str = "participant,trial,protocol,stimulus,shown,answer,correct,response_ms,time";
/// Fewest participants over whom a share is resampled.
const SEVERAL: usize = 5;

/// Tables of answers with 95 % intervals
#[derive(Debug, Args)]
pub struct Options {
    /// Answer files, one a participant
    #[arg(value_name = "ANSWERS.csv", required = true)]
    answers: Vec<PathBuf>,
    /// Share of right answers at a threshold
    #[arg(long, value_name = "SHARE", default_value_t = 0.75, value_parser = part)]
    at: f64,
    /// Share of right guesses in a staircase: 0.5 of two intervals, 0 of yes and no
    #[arg(long, value_name = "SHARE", default_value_t = 0.5, value_parser = part)]
    chance: f64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

fn part(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|share| (0.0..0.98).contains(share))
        .ok_or_else(|| "must be 0 to 0.98".to_owned())
}

/// A row of an answer file.
#[derive(Debug, Clone, PartialEq)]
struct Answer {
    participant: String,
    protocol: String,
    stimulus: String,
    shown: String,
    answer: String,
    correct: Option<bool>,
}

/// Result, as `--json` prints it.
#[derive(Debug, Serialize)]
struct Report {
    protocol: Protocol,
    n: usize,
    participants: usize,
    attention: Value,
    share_correct: Value,
    d_prime: Option<f64>,
    confusion: Value,
    stimuli: Vec<Value>,
    ratings: Vec<Value>,
    trend: Value,
    threshold: Value,
    paper: Value,
}

/// Runs the verb.
///
/// # Errors
/// When a file is none of answers, or they are of several protocols.
pub fn run(options: &Options) -> Result<(), CliError> {
    if options.at <= options.chance {
        let what = format!("{} is no more than chance, {}", options.at, options.chance);
        return Err(CliError::new("--at", what, "must lie above --chance"));
    }
    let mut answers = Vec::new();
    for path in &options.answers {
        answers.extend(read(path)?);
    }
    let report = report(&answers, options)?;
    output::say_report(&report, options.json, || table::lines(&report))
}

fn read(path: &Path) -> Result<Vec<Answer>, CliError> {
    let text = std::fs::read_to_string(path).map_err(|error| CliError::read(path, &error))?;
    let mut lines = text.trim_start_matches('\u{feff}').lines();
    if lines.next().is_none_or(|line| line.trim_end() != HEADER) {
        let right = format!("the first line must be {HEADER}");
        return Err(CliError::file(path, "is no file of answers", right));
    }
    let mut answers = Vec::new();
    for (index, line) in lines.enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let at = || format!("{}: line {}", path.display(), index + 2);
        let fields = fields(line);
        let [participant, _, protocol, stimulus, shown, answer, correct, _, _] = fields.as_slice() else {
            let what = format!("has {} fields", fields.len());
            return Err(CliError::new(at(), what, "nine, as in the first line, a row a line"));
        };
        let correct = match correct.as_str() {
            "1" | "true" => Some(true),
            "0" | "false" => Some(false),
            "" => None,
            other => {
                return Err(CliError::new(at(), format!("correct is {other:?}"), "must be 1, 0 or nothing"));
            }
        };
        let [participant, protocol, stimulus, shown, answer] =
            [participant, protocol, stimulus, shown, answer].map(Clone::clone);
        answers.push(Answer { participant, protocol, stimulus, shown, answer, correct });
    }
    Ok(answers)
}

/// Fields of a line of CSV.
fn fields(line: &str) -> Vec<String> {
    let mut rows = csv::ReaderBuilder::new().has_headers(false).from_reader(line.as_bytes());
    let row = rows.records().next().and_then(Result::ok).unwrap_or_default();
    row.iter().map(str::to_owned).collect()
}

fn report(answers: &[Answer], options: &Options) -> Result<Report, CliError> {
    let (checks, asked): (Vec<&Answer>, Vec<&Answer>) =
        answers.iter().partition(|answer| answer.protocol == "attention");
    if asked.is_empty() {
        let right = "must have a row an answer under the heading, all of one protocol";
        return Err(CliError::new("answers", "hold none", right));
    }
    let mut protocols: Vec<&str> = asked.iter().map(|answer| &*answer.protocol).collect();
    protocols.sort_unstable();
    protocols.dedup();
    let [protocol] = protocols.as_slice() else {
        let what = format!("of protocols {protocols:?}");
        return Err(CliError::new(
            "answers",
            what,
            "must all be of one protocol: analyse each study by itself",
        ));
    };
    let known = serde_json::from_value(json!(protocol));
    let protocol: Protocol = known.map_err(|_| {
        let right = "must be identification, abx, rating or staircase";
        CliError::new("answers", format!("the protocol {protocol:?} is unknown"), right)
    })?;
    let people = by(&asked, |answer| &answer.participant);
    let failed = by(&checks, |answer| &answer.participant)
        .into_iter()
        .map(|(who, of)| (who.to_owned(), of.iter().filter(|check| check.correct == Some(false)).count()))
        .filter(|(_, failed)| *failed > 0)
        .collect::<BTreeMap<_, _>>();
    let (right, judged) = right_of(&asked);
    let is_rating = protocol == Protocol::Rating;
    let named = protocol == Protocol::Identification || protocol == Protocol::Abx;
    let confusion = confusion(&asked, protocol);
    let alternatives = confusion.1.len().max(2);
    let d_prime = match protocol {
        Protocol::Identification => Some(statistics::d_prime(right, judged, alternatives)),
        Protocol::Abx => Some(statistics::d_prime_abx(right, judged)),
        _ => None,
    };
    Ok(Report {
        protocol,
        n: asked.len(),
        participants: people.len(),
        attention: json!({ "asked": checks.len(), "failed": failed }),
        share_correct: if judged > 0 && !is_rating { share(&asked) } else { Value::Null },
        d_prime: d_prime.filter(|_| judged > 0),
        paper: examples::paper(protocol, &confusion.0),
        confusion: if named {
            json!({ "labels": confusion.0, "answers": confusion.1, "counts": confusion.2 })
        } else {
            Value::Null
        },
        stimuli: if is_rating { Vec::new() } else { stimuli(&asked) },
        ratings: if is_rating { ratings(&asked) } else { Vec::new() },
        trend: if is_rating { trend(&asked) } else { Value::Null },
        threshold: if protocol == Protocol::Staircase { thresholds(&asked, options)? } else { Value::Null },
    })
}

fn by<'a>(answers: &[&'a Answer], key: impl Fn(&'a Answer) -> &'a str) -> BTreeMap<&'a str, Vec<&'a Answer>> {
    let mut groups: BTreeMap<&str, Vec<&Answer>> = BTreeMap::new();
    for answer in answers {
        groups.entry(key(answer)).or_default().push(answer);
    }
    groups
}

fn right_of(answers: &[&Answer]) -> (usize, usize) {
    let right = answers.iter().filter(|answer| answer.correct == Some(true)).count();
    (right, answers.iter().filter(|answer| answer.correct.is_some()).count())
}

/// Finite ends of an interval, null for the others.
fn estimated(estimate: Estimate) -> Value {
    let end = |x: f64| if x.is_finite() { json!(x) } else { Value::Null };
    json!({ "value": estimate.value, "ci95": estimate.ci95.map(end) })
}

/// Share of right answers: Wilson's interval over answers, and the bootstrap's over participants.
fn share(answers: &[&Answer]) -> Value {
    let (right, judged) = right_of(answers);
    let mut value = estimated(statistics::share(right, judged));
    let people = by(answers, |answer| &answer.participant);
    if people.len() >= SEVERAL {
        let shares: Vec<f64> = people
            .values()
            .map(|of| right_of(of))
            .filter(|(_, judged)| *judged > 0)
            .map(|(right, judged)| right as f64 / judged as f64)
            .collect();
        value["ci95_participants"] = estimated(statistics::mean(&shares, 1))["ci95"].clone();
    }
    value
}

/// Rows, columns and counts: what was presented against what was answered.
fn confusion(answers: &[&Answer], protocol: Protocol) -> (Vec<String>, Vec<String>, Vec<Vec<usize>>) {
    let row = |answer: &Answer| match protocol {
        Protocol::Abx => answer.shown.clone(),
        _ => answer.stimulus.clone(),
    };
    let mut rows: Vec<String> = answers.iter().map(|answer| row(answer)).collect();
    rows.sort_by_key(|name| (examples::order(name), name.clone()));
    rows.dedup();
    let mut columns = rows.clone();
    let mut others: Vec<String> = answers.iter().map(|answer| answer.answer.clone()).collect();
    others.sort();
    others.dedup();
    // Labels that are no stimuli, and stimuli without a label of their own.
    columns.retain(|name| others.contains(name) || answers.iter().any(|a| a.shown == *name));
    columns.extend(others.into_iter().filter(|name| !rows.contains(name)));
    let mut counts = vec![vec![0; columns.len()]; rows.len()];
    for answer in answers {
        let at = |names: &[String], name: &str| names.iter().position(|one| one == name);
        if let (Some(r), Some(c)) = (at(&rows, &row(answer)), at(&columns, &answer.answer)) {
            counts[r][c] += 1;
        }
    }
    (rows, columns, counts)
}

fn stimuli(answers: &[&Answer]) -> Vec<Value> {
    let groups = by(answers, |answer| &answer.stimulus);
    let each = groups
        .into_iter()
        .map(|(name, of)| json!({ "name": name, "n": of.len(), "share_correct": share(&of) }));
    each.collect()
}

fn ratings(answers: &[&Answer]) -> Vec<Value> {
    let mut rows = Vec::new();
    for (scale, of) in by(answers, |answer| &answer.shown) {
        for (name, of) in by(&of, |answer| &answer.stimulus) {
            let people = means(&of);
            let mut row = estimated(statistics::mean(&people, 1));
            row["stimulus"] = json!(name);
            row["scale"] = json!(scale);
            row["n"] = json!(of.len());
            let mut all: Vec<f64> = of.iter().filter_map(|answer| answer.answer.parse().ok()).collect();
            all.sort_by(f64::total_cmp);
            let at = |part: f64| all.get((part * (all.len().max(1) - 1) as f64).round() as usize);
            row["quartiles"] = json!([at(0.25), at(0.5), at(0.75)]);
            rows.push(row);
        }
    }
    rows
}

/// Mean rating of each participant.
fn means(answers: &[&Answer]) -> Vec<f64> {
    let people = by(answers, |answer| &answer.participant);
    let mean = |of: &Vec<&Answer>| {
        let values: Vec<f64> = of.iter().filter_map(|answer| answer.answer.parse().ok()).collect();
        values.iter().sum::<f64>() / values.len() as f64
    };
    people.values().map(mean).filter(|mean| mean.is_finite()).collect()
}

/// Slope of each participant's ratings over the numbers at the ends of the stimuli's names, as the
/// correlation of the two, where all names end in numbers.
fn trend(answers: &[&Answer]) -> Value {
    let number = |name: &str| -> Option<f64> { name.rsplit([' ', '×']).next()?.parse().ok() };
    if answers.iter().any(|answer| number(&answer.stimulus).is_none()) {
        return Value::Null;
    }
    let correlations: Vec<f64> = by(answers, |answer| &answer.participant)
        .values()
        .map(|of| {
            let points = of.iter().filter_map(|a| Some((number(&a.stimulus)?, a.answer.parse().ok()?)));
            correlation(&points.collect::<Vec<(f64, f64)>>())
        })
        .filter(|r| r.is_finite())
        .collect();
    if correlations.is_empty() { Value::Null } else { estimated(statistics::mean(&correlations, 1)) }
}

fn correlation(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let sum = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>();
    let (xx, yy) = (sum(&|p| (p.0 - x).powi(2)), sum(&|p| (p.1 - y).powi(2)));
    sum(&|p| (p.0 - x) * (p.1 - y)) / (xx * yy).sqrt()
}

/// Each participant's threshold; of several the geometric mean, where levels are above 0.
fn thresholds(answers: &[&Answer], options: &Options) -> Result<Value, CliError> {
    let mut each = Vec::new();
    for (who, of) in by(answers, |answer| &answer.participant) {
        for (stimulus, of) in by(&of, |answer| &answer.stimulus) {
            let mut points = Vec::new();
            for answer in of {
                let level = answer.shown.parse().ok().filter(|level: &f64| level.is_finite());
                let (Some(level), Some(right)) = (level, answer.correct) else {
                    let what = format!("a staircase of {who} has the level {:?}", answer.shown);
                    return Err(CliError::new("shown", what, "must be a number, beside correct 0 or 1"));
                };
                points.push((level, right));
            }
            each.push((who, stimulus, statistics::threshold(&points, options.chance, options.at)));
        }
    }
    let found: Vec<Estimate> = each.iter().filter_map(|(_, _, one)| *one).collect();
    let all = match found.as_slice() {
        [] => return Ok(Value::Null),
        [one] => *one,
        several => {
            let is_log = several.iter().all(|one| one.value > 0.0);
            let scaled: Vec<f64> =
                several.iter().map(|one| if is_log { one.value.ln() } else { one.value }).collect();
            let back = |x: f64| if is_log { x.exp() } else { x };
            let mean = statistics::mean(&scaled, 1);
            Estimate { value: back(mean.value), ci95: mean.ci95.map(back) }
        }
    };
    let mut value = estimated(all);
    value["at"] = json!(options.at);
    let row = |(who, stimulus, one): (&str, &str, Option<Estimate>)| {
        let mut row = one.map_or_else(|| json!({ "value": null, "ci95": [null, null] }), estimated);
        row["participant"] = json!(who);
        row["stimulus"] = json!(stimulus);
        row
    };
    value["each"] = Value::Array(each.into_iter().map(row).collect());
    Ok(value)
}
