//! The page: a table of rows, failures first, and confusion matrices.

use super::{Card, Matrix, Row};
use std::fmt::Write;

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:64rem;margin:2rem auto;padding:0 1rem;color:#1b1b1b}\
    table{border-collapse:collapse;margin:1rem 0}td,th{padding:.3rem .6rem;border-bottom:1px solid #bbb;text-align:left;vertical-align:top}\
    tr.fails td:first-child{border-left:.4rem solid #a11212}tr.holds td:first-child{border-left:.4rem solid #2c7a2c}\
    .matrix td{text-align:right;border:1px solid #ddd}code{font-size:.85em}";

/// The whole page: one file that asks for nothing.
pub fn html(card: &Card) -> String {
    let failed = card.rows.iter().filter(|row| !row.pass).count();
    let mut page = format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Scorecard</title><style>{STYLE}</style>\
         <h1>Scorecard of asperity {}</h1><p>{} rows, {failed} outside their bounds (first).</p>",
        card.version,
        card.rows.len()
    );
    page += "<table><thead><tr><th>figure</th><th>ours</th><th>bound</th><th>anchor</th><th>command</th></tr></thead><tbody>";
    card.rows.iter().for_each(|row| page += &line(row));
    page += "</tbody></table>";
    card.confusion.iter().for_each(|(name, matrix)| page += &table(name, matrix));
    for observer in &card.observers {
        let _ = write!(
            page,
            "<p>Constants of the {} observer: <code>{}</code></p>",
            observer.name, observer.sha256
        );
    }
    page + "</html>\n"
}

fn line(row: &Row) -> String {
    let end = |end: Option<f64>| end.map_or("…".to_owned(), short);
    let class = if row.pass { "holds" } else { "fails" };
    format!(
        "<tr class=\"{class}\"><td>{}</td><td>{}</td><td>{} – {}</td><td>{} ({})</td><td><code>{}</code></td></tr>",
        row.name,
        short(row.ours),
        end(row.bound[0]),
        end(row.bound[1]),
        row.reference,
        row.source,
        row.command
    )
}

fn short(value: f64) -> String {
    if value != 0.0 && (value.abs() < 1e-2 || value.abs() >= 1e4) {
        format!("{value:.1e}")
    } else {
        format!("{value:.2}")
    }
}

fn table(name: &str, matrix: &Matrix) -> String {
    let head: String = matrix.labels.iter().map(|label| format!("<th scope=\"col\">{label}</th>")).collect();
    let mut out = format!("<h2>{name}</h2><table class=\"matrix\"><tr><td></td>{head}</tr>");
    for (label, row) in matrix.labels.iter().zip(&matrix.ours) {
        // Dark text on white to blue.
        let cell = |share: &f64| {
            format!("<td style=\"background:rgb({0},{0},255)\">{share:.2}</td>", 255 - (110.0 * share) as u8)
        };
        let cells: String = row.iter().map(cell).collect();
        let _ = write!(out, "<tr><th scope=\"row\">{label}</th>{cells}</tr>");
    }
    out + "</table>"
}
