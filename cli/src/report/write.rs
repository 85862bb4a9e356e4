//! The report as a picture and as a table.

use super::Row;
use super::end_to_end::Preset;
use super::from_reports::Stroke;
use super::shed::LoadLevel;
use crate::plot::{Axis, Figure, Layer, Panel, Series, palette};
use std::fmt::Write;

/// Errors below this are drawn here: a logarithmic axis has no zero.
const FLOOR: f64 = 1e-8;

/// Choices of an axis whose panel stands beside another.
const MOST_BESIDE_ANOTHER: usize = 10;

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

/// The engine at a glance: its presets, from reports to what leaves it, over the integrators alone.
fn overview(rows: &[Row], presets: &[Preset]) -> Panel {
    let whole: Vec<[f64; 2]> = presets
        .iter()
        .map(|preset| [10f64.powf(preset.error_db / 20.0), preset.ns_per_sample * 1e-9])
        .collect();
    let integrators: Vec<&Row> = rows.iter().filter(|row| row.axis == "integrator").collect();
    let alone = |error: fn(&Row) -> f64| -> Vec<[f64; 2]> {
        integrators.iter().map(|row| [error(row).max(FLOOR), row.ns_per_sample * 1e-9]).collect()
    };
    let all = || whole.iter().copied().chain(alone(|row| row.worst)).chain(alone(|row| row.geometric_mean));
    let ends = |of: usize| {
        let values = all().map(|point| point[of]);
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(0.0, f64::max))
    };
    let ((low, high), (fast, slow)) = (ends(0), ends(1));
    let dots =
        |label: &str, colour: &str, points: Vec<[f64; 2]>, radius: f64, names: Vec<String>| Layer::Dots {
            label: label.to_owned(),
            colour: colour.to_owned(),
            points,
            radius_px: vec![radius],
            names,
        };
    let names = presets.iter().map(|preset| preset.preset.to_owned()).collect();
    Panel::new(
        "the engine at a glance",
        Axis::log("error", "").range(low / 3.0, high * 6.0),
        Axis::log("time a sample, one contact", "s").range(fast / 2.0, slow * 2.0),
    )
    .with(Layer::line(
        "presets against the whole chain in f64 at 16 times the rate",
        palette::IMPACT,
        Series::Points(whole.clone()),
    ))
    .with(dots("", palette::IMPACT, whole, 8.0, names))
    .with(dots(
        "integrators alone, geometric mean of all cases",
        palette::PAD,
        alone(|row| row.geometric_mean),
        5.0,
        integrators.iter().map(|row| row.choice.clone()).collect(),
    ))
}

/// One panel an axis, its Pareto front drawn in.
#[must_use]
pub fn svg(cpu: &str, rows: &[Row], presets: &[Preset]) -> String {
    let mut figure = Figure::new("Speed against error")
        .subtitle(format!(
            "one thread of {cpu}; error = rms of the difference over the reference's alternating rms"
        ))
        .subtitle("lower left is better; errors of exactly zero are drawn at 10⁻⁸");
    if !presets.is_empty() {
        figure.row(420.0, [overview(rows, presets)]);
    }
    // Many names need room.
    let (crowded, mut others): (Vec<_>, Vec<_>) =
        axes(rows).into_iter().partition(|(_, members)| members.len() > MOST_BESIDE_ANOTHER);
    while !others.is_empty() {
        let rest = others.split_off(others.len().min(2));
        figure.row(230.0, others.iter().map(|(axis, members)| panel(axis, members)).collect::<Vec<_>>());
        others = rest;
    }
    for (axis, members) in &crowded {
        figure.row(420.0, [panel(axis, members)]);
    }
    figure.svg()
}

/// Description of a choice besides its name on the command line.
fn note(row: &Row) -> &'static str {
    match (row.axis, row.choice.as_str()) {
        ("integrator", "semi-implicit-euler-explicit") => " (the paper's equations as written)",
        ("integrator", "semi-implicit-euler") => " (the paper's, its damper centred in time)",
        ("integrator", "exact-event") => " (default)",
        _ => "",
    }
}

/// The presets, and what each case costs them.
fn presets_table(presets: &[Preset]) -> String {
    let Some(first) = presets.first() else { return String::new() };
    let mut text = "\n## end to end\n\nReference: the whole chain in f64 at 16 times the rate, from the same path; dB, felt / heard. Where a case is \
                    *chaotic* no waveform can be compared, and it does not count.\n\n| preset | ns a sample | error | "
        .to_owned();
    for case in &first.cases {
        let note = if case.contractive { "" } else { " (*chaotic*)" };
        let _ = write!(text, "{}{note} | ", case.name);
    }
    text += "share of the stages |\n|---|--:|--:|";
    text += &"---|".repeat(first.cases.len() + 1);
    for preset in presets {
        let _ =
            write!(text, "\n| {} | {:.0} | {:.1} dB |", preset.preset, preset.ns_per_sample, preset.error_db);
        for case in &preset.cases {
            let _ = write!(text, " {:.0} / {:.0} |", case.felt_db, case.heard_db);
        }
        let shares: Vec<String> =
            preset.stages.iter().map(|(stage, share)| format!("{stage} {:.1} %", 100.0 * share)).collect();
        let _ = write!(text, " {} |", shares.join(", "));
    }
    text + "\n"
}

/// Costs of sparse reports.
#[must_use]
pub fn strokes_table(strokes: &[Stroke]) -> String {
    let mut text = "\n## from 60 reports a second\n\nReference: the same hand, reported 2000 times a second. Waveforms, and the median \
                    difference of third-octave levels in frames of 100 ms; felt / heard.\n\n| ground | path | waveform | levels |\n|---|---|--:|--:|\n"
        .to_owned();
    for Stroke { name, path, felt_db, heard_db, felt_levels_db, heard_levels_db } in strokes {
        let _ = writeln!(
            text,
            "| {name} | {path} | {felt_db:.1} / {heard_db:.1} dB | {felt_levels_db:.2} / {heard_levels_db:.2} dB |"
        );
    }
    text
}

/// Parts left out at each level of load.
#[must_use]
pub fn load_table(levels: &[LoadLevel]) -> String {
    let mut text = "\n## levels of load\n\nReference: level 0. Ten fingers on one body of 256 modes that differ by 60 dB, and a strike on it; the ear by a masking model at 70 dB SPL: share of the cells of an ERB \
                    and 20 ms within 1 dB, and what 99 % are within. Felt: third octaves, 63 Hz–2 kHz, worst and mean.\n\n| level | leaves out | ns a sample | stroke | strike | felt |\n|--:|---|--:|--:|--:|--:|\n"
        .to_owned();
    for LoadLevel { level, leaves_out, ns_per_sample, stroke, strike, felt_worst_db, felt_mean_db } in levels
    {
        let missed = |missed: &super::excitation::Missed| {
            format!("{:.1} %, {:.1} dB", 100.0 * missed.within_1_db, missed.excitation_db)
        };
        let _ = writeln!(
            text,
            "| {level} | {leaves_out} | {ns_per_sample:.0} | {} | {} | {felt_worst_db:.1}, {felt_mean_db:.1} dB |",
            missed(stroke),
            missed(strike)
        );
    }
    text
}

/// An error in dB.
fn decibels(error: f64) -> String {
    if error > 0.0 { format!("{:.1}", 20.0 * error.log10()) } else { "exact".to_owned() }
}

/// The choices of an axis; where they have them, how late they are, what the ear misses, and the worst of each named case, dB.
fn axis_table(members: &[&Row]) -> String {
    let late = members.iter().any(|row| row.latency_ms.is_some());
    let heard = members.iter().any(|row| row.excitation_db.is_some());
    let names = || members.iter().flat_map(|row| &row.cases).map(|case| case.name);
    let mut cases: Vec<&str> = Vec::new();
    names().for_each(|name| {
        if !cases.contains(&name) {
            cases.push(name);
        }
    });
    let mut text = "| choice | ns a sample | error | dB |".to_owned();
    text += if late { " late, ms |" } else { "" };
    text += if heard { " 99 % of ERB × 20 ms cells within |" } else { "" };
    cases.iter().for_each(|case| {
        let _ = write!(text, " {case} |");
    });
    text += &format!("\n|---|{}\n", "--:|".repeat(3 + usize::from(late) + usize::from(heard) + cases.len()));
    for row in members {
        let (choice, ns, error) = (&row.choice, row.ns_per_sample, row.error);
        let _ = write!(text, "| {choice}{} | {ns:.2} | {error:.2e} | {} |", note(row), decibels(error));
        if late {
            let _ = write!(text, " {} |", row.latency_ms.map_or_else(String::new, |ms| format!("{ms:.1}")));
        }
        if heard {
            let _ =
                write!(text, " {} |", row.excitation_db.map_or_else(String::new, |db| format!("{db:.1} dB")));
        }
        for name in &cases {
            let of = row.cases.iter().find(|case| case.name == *name);
            let worst = of.map(|case| {
                [case.displacement, case.contact_force, Some(case.output)]
                    .into_iter()
                    .flatten()
                    .fold(0.0, f64::max)
            });
            let _ = write!(text, " {} |", worst.map_or_else(String::new, decibels));
        }
        text.push('\n');
    }
    text
}

/// One table an axis.
#[must_use]
pub fn markdown(cpu: &str, rows: &[Row], presets: &[Preset]) -> String {
    let mut text = format!(
        "# Speed against error\n\nOne thread of {cpu}. Error: rms of the difference over the alternating rms of the reference.\n"
    );
    text += &presets_table(presets);
    for (axis, members) in axes(rows) {
        let reference = members.first().map_or("", |row| row.reference);
        let _ = write!(text, "\n## {axis}\n\nReference: {reference}.\n\n");
        text += &axis_table(&members);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(choice: &str, ns_per_sample: f64, error: f64) -> Row {
        Row::of(("test", choice), ns_per_sample, error, "truth")
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
        let text = markdown("cpu", &[row("a", 10.0, 0.0), row("b", 5.0, 1e-3)], &[]);
        assert!(
            text.contains("| a | 10.00 | 0.00e0 | exact |")
                && text.contains("| b | 5.00 | 1.00e-3 | -60.0 |")
        );
        assert!(svg("cpu", &[row("a", 10.0, 0.0)], &[]).contains("test"));
    }
}
