//! The report as a picture and as a table.

use super::Row;
use super::end_to_end::Preset;
use super::from_reports::Stroke;
use super::shed::LoadLevel;
use asperity_plot::{Axis, Figure, Layer, Panel, Series, palette};
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

/// The front in one plot.
#[must_use]
pub fn svg(cpu: &str, rows: &[Row], presets: &[Preset]) -> String {
    let mut figure = Figure::new("Speed against error")
        .subtitle(format!(
            "one thread of {cpu}; error = rms of the difference over the reference's alternating rms"
        ))
        .subtitle("lower left is better");
    figure.row(420.0, [overview(rows, presets)]);
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
    let mut text = "\n## levels of load\n\nReference: level 0. Ten fingers on ten bodies of 500 modes that differ by 60 dB, and a strike on one; the ear by a masking model at 70 dB SPL: share of the cells of an ERB \
                    and 20 ms within 1 dB, and what 99 % are within. Felt: third octaves, 63 Hz–2 kHz, worst and mean.\n\n| level | leaves out | ns a sample | of level 0 | stroke | strike | felt |\n|--:|---|--:|--:|--:|--:|--:|\n"
        .to_owned();
    for LoadLevel { level, leaves_out, ns_per_sample, share, stroke, strike, felt_worst_db, felt_mean_db } in
        levels
    {
        let missed = |missed: &super::excitation::Missed| {
            format!("{:.1} %, {:.1} dB", 100.0 * missed.within_1_db, missed.excitation_db)
        };
        let _ = writeln!(
            text,
            "| {level} | {leaves_out} | {ns_per_sample:.0} | {share:.2} | {} | {} | {felt_worst_db:.1}, {felt_mean_db:.1} dB |",
            missed(stroke),
            missed(strike)
        );
    }
    text
}

/// An error in dB.
fn decibels(error: f64) -> String {
    if error > 0.0 { format!("{:.1} dB", 20.0 * error.log10()) } else { "exact".to_owned() }
}

/// Axes that stand on the page; all others are in the JSON file.
const ON_THE_PAGE: [&str; 6] =
    ["integrator", "path", "map filter", "noise octaves", "mode culling", "number format"];

/// Choices that the engine offers, a line each, and what each axis is compared with.
fn choices_table(rows: &[Row]) -> String {
    let mut text = "\n## choices\n\n| of | choice | ns a sample | error |\n|---|---|--:|--:|\n".to_owned();
    let axes = axes(rows);
    let (shown, others): (Vec<_>, Vec<_>) =
        axes.into_iter().partition(|(axis, _)| ON_THE_PAGE.contains(axis));
    for row in shown.iter().flat_map(|(_, members)| members) {
        let Row { axis, choice, ns_per_sample, error, .. } = row;
        let (note, error_db) = (note(row), decibels(*error));
        let _ = writeln!(text, "| {axis} | {choice}{note} | {ns_per_sample:.2} | {error_db} |");
    }
    text += "\nErrors are those of the worst case, against: ";
    let references = shown.iter().filter_map(|(axis, members)| Some((axis, members.first()?.reference)));
    let references: Vec<String> =
        references.map(|(axis, reference)| format!("*{axis}*: {reference}")).collect();
    text += &references.join(". ");
    if !others.is_empty() {
        let names: Vec<&str> = others.iter().map(|(axis, _)| *axis).collect();
        let _ = write!(text, ".\n\nIn `speed_vs_error.json`, with every case: {}", names.join("; "));
    }
    text + ".\n"
}

/// Printed part, without strokes, levels of load and stability.
#[must_use]
pub fn markdown(cpu: &str, rows: &[Row], presets: &[Preset]) -> String {
    let text = format!(
        "# Speed against error\n\nOne thread of {cpu}. Error: rms of the difference over the alternating rms of the reference.\n"
    );
    text + &presets_table(presets) + &choices_table(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(choice: &str, ns_per_sample: f64, error: f64) -> Row {
        Row::of(("test", choice), ns_per_sample, error, "truth")
    }

    #[test]
    fn the_page_has_a_line_for_every_choice() {
        let rows = [row("a", 10.0, 0.0), row("b", 5.0, 1e-3)].map(|row| Row { axis: "path", ..row });
        let other = Row { axis: "block size", ..row("c", 1.0, 1.0) };
        let text = markdown("cpu", &[rows[0].clone(), rows[1].clone(), other], &[]);
        assert!(text.contains("| path | a | 10.00 | exact |"), "{text}");
        assert!(text.contains("| path | b | 5.00 | -60.0 dB |"), "{text}");
        assert!(text.contains("*path*: truth") && text.contains("with every case: block size"), "{text}");
        assert!(!text.contains("| c |"), "{text}");
    }
}
