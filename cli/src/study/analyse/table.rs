//! The report of an analysis as lines of text.

use super::Report;
use serde_json::Value;

/// The report as lines.
pub fn lines(report: &Report) -> String {
    let counted = asperity_plot::counted(report.participants as u64, "participant");
    let mut lines = vec![format!("{} answers of {counted}", report.n)];
    let interval = |value: &Value| {
        let end = |i: usize| value["ci95"][i].as_f64().map_or("?".to_owned(), |x| format!("{x:.3}"));
        format!("{:.3} ({}–{})", value["value"].as_f64().unwrap_or(f64::NAN), end(0), end(1))
    };
    if !report.share_correct.is_null() {
        let d_prime = report.d_prime.map_or(String::new(), |d| format!(", d′ {d:.2}"));
        lines.push(format!("right {}{d_prime}", interval(&report.share_correct)));
    }
    let share = |row: &Value| {
        format!("{}: right {}", row["name"].as_str().unwrap_or(""), interval(&row["share_correct"]))
    };
    let rated = |row: &Value| {
        let text = |key: &str| row[key].as_str().unwrap_or("").to_owned();
        format!("{}, {}: {}", text("stimulus"), text("scale"), interval(row))
    };
    lines.extend(report.stimuli.iter().map(share));
    lines.extend(report.ratings.iter().map(rated));
    let rows = report.confusion["labels"].as_array().into_iter().flatten();
    if let Some(answers) = report.confusion["answers"].as_array() {
        lines.push(format!(
            "answered: {}",
            answers.iter().filter_map(Value::as_str).collect::<Vec<_>>().join(", ")
        ));
    }
    for (label, counts) in rows.zip(report.confusion["counts"].as_array().into_iter().flatten()) {
        lines.push(format!("{:>16} {counts}", label.as_str().unwrap_or("")));
    }
    if !report.trend.is_null() {
        lines.push(format!("correlation with the number in the name {}", interval(&report.trend)));
    }
    if !report.threshold.is_null() {
        let at = 100.0 * report.threshold["at"].as_f64().unwrap_or(f64::NAN);
        lines.push(format!("threshold at {at:.1} % right {}", interval(&report.threshold)));
    }
    if let Some(failed) = report.attention["failed"].as_object().filter(|failed| !failed.is_empty()) {
        lines.push(format!("checks of attention failed: {failed:?}"));
    }
    if let Some(source) = report.paper["source"].as_str() {
        lines.push(format!("the source: {source}"));
    }
    lines.join("\n")
}
