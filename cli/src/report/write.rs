//! The report as a picture and as a table.

use super::Row;
use crate::plot::{Axis, Figure, Layer, Panel, Series, palette};
use std::fmt::Write;

/// Errors below this are drawn here: a logarithmic axis has no zero.
const FLOOR: f64 = 1e-8;

fn axes(rows: &[Row]) -> Vec<(&'static str, Vec<&Row>)> {
    let mut axes: Vec<(&'static str, Vec<&Row>)> = Vec::new();
    for row in rows {
        match axes.iter_mut().find(|(axis, _)| *axis == row.axis) {
            Some((_, members)) => members.push(row),
            None => axes.push((row.axis, vec![row])),
        }
    }
    axes
}

fn place(row: &Row) -> [f64; 2] {
    [row.error.max(FLOOR), row.ns_per_sample * 1e-9]
}

/// The choices that no other beats in both time and error, from the most accurate on.
fn front(rows: &[&Row]) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = rows.iter().map(|row| place(row)).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut best = f64::INFINITY;
    points.retain(|point| {
        let better = point[1] < best;
        best = best.min(point[1]);
        better
    });
    points
}

fn panel(axis: &str, rows: &[&Row]) -> Panel {
    let points: Vec<[f64; 2]> = rows.iter().map(|row| place(row)).collect();
    let front = front(rows);
    // What is on the front is larger.
    let radius_px = points.iter().map(|point| if front.contains(point) { 6.0 } else { 3.5 }).collect();
    let ends = |of: usize| {
        let values = points.iter().map(|point| point[of]);
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(0.0, f64::max))
    };
    let ((low, high), (fast, slow)) = (ends(0), ends(1));
    Panel::new(
        axis,
        Axis::log("error", "").range(low / 4.0, (high * 30.0).max(low * 100.0)),
        Axis::log("time a sample", "s").range(fast / 1.6, (slow * 1.6).max(fast * 4.0)),
    )
    .with(Layer::Line {
        label: "nothing is better in both".to_owned(),
        colour: palette::IMPACT.to_owned(),
        width_px: 1.2,
        fill: None,
        dashed: true,
        data: Series::Points(front),
    })
    .with(Layer::Dots {
        label: String::new(),
        colour: palette::PAD.to_owned(),
        points,
        radius_px,
        names: rows.iter().map(|row| row.choice.clone()).collect(),
    })
}

/// One panel an axis, its Pareto front drawn in.
#[must_use]
pub fn svg(cpu: &str, rows: &[Row]) -> String {
    let mut figure = Figure::new("Speed against error")
        .subtitle(format!(
            "one thread of {cpu}; error = rms of the difference over the reference's alternating rms"
        ))
        .subtitle("lower left is better; errors of exactly zero are drawn at 10⁻⁸");
    let mut panels: Vec<Panel> = axes(rows).iter().map(|(axis, members)| panel(axis, members)).collect();
    while !panels.is_empty() {
        let rest = panels.split_off(panels.len().min(2));
        figure.row(230.0, std::mem::replace(&mut panels, rest));
    }
    figure.svg()
}

/// What a choice is besides its name on the command line.
fn note(row: &Row) -> &'static str {
    match (row.axis, row.choice.as_str()) {
        ("integrator", "semi-implicit-euler-explicit") => " (the paper's equations as written)",
        ("integrator", "semi-implicit-euler") => " (the paper's, its damper centred in time)",
        ("integrator", "exact-event") => " (default)",
        _ => "",
    }
}

/// One table an axis.
#[must_use]
pub fn markdown(cpu: &str, rows: &[Row]) -> String {
    let mut text = format!(
        "# Speed against error\n\nOne thread of {cpu}. Error: rms of the difference over the alternating rms of the reference.\n"
    );
    for (axis, members) in axes(rows) {
        let reference = members.first().map_or("", |row| row.reference);
        let _ = write!(
            text,
            "\n## {axis}\n\nReference: {reference}.\n\n| choice | ns a sample | error | dB |\n|---|--:|--:|--:|\n"
        );
        for row in members {
            let decibels =
                if row.error > 0.0 { format!("{:.1}", 20.0 * row.error.log10()) } else { "exact".to_owned() };
            let _ = writeln!(
                text,
                "| {}{} | {:.2} | {:.2e} | {decibels} |",
                row.choice,
                note(row),
                row.ns_per_sample,
                row.error
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(choice: &str, ns_per_sample: f64, error: f64) -> Row {
        Row { axis: "test", choice: choice.to_owned(), ns_per_sample, error, reference: "truth" }
    }

    #[test]
    fn the_front_holds_only_what_nothing_beats() {
        let rows = [row("a", 10.0, 1e-5), row("b", 5.0, 1e-3), row("c", 7.0, 1e-2), row("d", 1.0, 1e-1)];
        let members: Vec<&Row> = rows.iter().collect();
        let front = front(&members);
        assert_eq!(front.iter().map(|point| point[0]).collect::<Vec<_>>(), [1e-5, 1e-3, 1e-1]);
    }

    #[test]
    fn the_table_has_a_row_for_every_choice() {
        let text = markdown("cpu", &[row("a", 10.0, 0.0), row("b", 5.0, 1e-3)]);
        assert!(
            text.contains("| a | 10.00 | 0.00e0 | exact |")
                && text.contains("| b | 5.00 | 1.00e-3 | -60.0 |")
        );
        assert!(svg("cpu", &[row("a", 10.0, 0.0)]).contains("test"));
    }
}
