//! Picture of a surface from strokes: recorded and played spectra at each speed, and the octaves.

use asperity_plot::{Axis, Figure, Layer, Panel, Series, palette};
use asperity_stroke::StrokeSurface;

/// Speeds that are drawn.
const DRAWN: usize = 6;
/// Panels a row.
const A_ROW: usize = 3;

pub(super) fn svg(name: &str, found: &StrokeSurface) -> String {
    let mut figure = Figure::new(format!("{name}: a surface from a stroke")).subtitle(format!(
        "α {:.2}, {:.0} % of the recorded levels explained, {:.1} dB beside them",
        found.law.alpha,
        100.0 * found.explained,
        found.beside_db
    ));
    for warning in &found.warnings {
        figure = figure.subtitle(format!("warning: {warning}"));
    }
    let groups: Vec<usize> = (0..found.groups.len()).take(DRAWN).collect();
    let all = found.levels.iter().flat_map(|level| [level.2, level.3]);
    let (low, high) = all
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), db| (f64::min(low, db), f64::max(high, db)));
    for row in groups.chunks(A_ROW) {
        figure.row(180.0, row.iter().map(|group| spectra(found, *group, (low - 3.0, high + 3.0))));
    }
    let octaves = found.octaves.iter();
    let points = |of: &dyn Fn(&asperity_stroke::relief::Octave) -> bool| -> Vec<[f64; 2]> {
        let kept = octaves.clone().filter(|octave| of(octave) && octave.rms_m > 0.0);
        kept.map(|octave| [octave.wavelength_m, 20.0 * (1e6 * octave.rms_m).log10()]).collect()
    };
    let dots = |label: &str, colour: &str, points| Layer::Dots {
        label: label.to_owned(),
        colour: colour.to_owned(),
        points,
        radius_px: vec![4.0],
        names: Vec::new(),
    };
    let panel = Panel::new(
        "felt height by octaves of wavelength",
        Axis::log("wavelength", "m"),
        Axis::new("rms, dB re 1 µm", ""),
    )
    .with(dots("read from the recording", palette::AUDIO, points(&|octave| !octave.is_extrapolated)))
    .with(dots("continued", palette::HAPTIC, points(&|octave| octave.is_extrapolated)));
    figure.row(180.0, [panel]);
    figure.svg()
}

fn spectra(found: &StrokeSurface, group: usize, (low, high): (f64, f64)) -> Panel {
    let own = || found.levels.iter().filter(move |level| level.0 == group);
    let recorded: Vec<[f64; 2]> = own().map(|level| [level.1, level.2]).collect();
    let played: Vec<[f64; 2]> = own().map(|level| [level.1, level.3]).collect();
    let of = &found.groups[group];
    let title = format!("{:.0} mm/s, {:.1} N", 1e3 * of.speed_m_s, of.force_n);
    let axis = Axis::new("third octaves, dB", "").range(low, high);
    Panel::new(title, Axis::log("frequency", "Hz"), axis)
        .with(Layer::line("recorded", palette::AUDIO, Series::Points(recorded)))
        .with(Layer::line("played", palette::HAPTIC, Series::Points(played)))
}
