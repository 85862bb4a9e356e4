//! A surface from strokes: all stages, in order.

use crate::StrokeError;
use crate::checks;
use crate::colour::{self, Colour, LEAST_SPEEDS};
use crate::compliance::{self, Compliance};
use crate::db;
use crate::floor::{self, Floor};
use crate::lines::{self, Line};
use crate::models::{self, Models};
use crate::octave_noise;
use crate::octaves::{self, MicroRelief};
use crate::power_law::PowerLaw;
use crate::recording::{Stroke, Window, respond, windows};
use crate::relief::{self, Group, Octave, Spectrum};
use crate::tool::{Quantity, Tool};
use asperity_dsp::fractal_noise::OCTAVES;

/// Knowledge beside the recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Probe and recorded quantity.
    pub tool: Tool,
    /// Relative error of each constant of the probe.
    pub probe_error: f64,
    /// Response of the rig, (Hz, dB) in rising order; solved for where it is missing and speeds
    /// differ.
    pub colour: Option<Vec<(f64, f64)>>,
}

/// Relative error of the constants of a preset: they are fits and assumptions.
pub const PROBE_ERROR: f64 = 0.1;

/// Surface found in strokes.
#[derive(Debug, Clone, PartialEq)]
pub struct StrokeSurface {
    /// Third octaves of the felt height.
    pub bands: Vec<relief::Band>,
    /// Octaves of the felt height, coarsest first.
    pub octaves: Vec<Octave>,
    /// Standard error that the probe's constants bring to each octave, dB.
    pub probe_se_db: Vec<f64>,
    /// Power law of the ground.
    pub law: PowerLaw,
    /// Lines, the strongest first.
    pub lines: Vec<Line>,
    /// Deviation of the speed that the lines show, a share; 0 where it was measured.
    pub wander: f64,
    /// Response of the rig; empty where one speed cannot tell, or it was handed in.
    pub colour: Vec<Colour>,
    /// Gain of each doubling of force beside the contact law, dB; none where forces do not differ.
    pub force_db_per_octave: Option<f64>,
    /// Coefficient of friction, where something showed it.
    pub friction: Option<f64>,
    /// Sinking of the ground, where a displacement under a changing force showed it.
    pub compliance: Option<Compliance>,
    /// Share of the variance of recorded third-octave levels that the surface as it plays explains,
    /// with the rig's colour.
    pub explained: f64,
    /// Rms of what it leaves, dB.
    pub beside_db: f64,
    /// Rms of the contact's changing force over its mean.
    pub lift: f64,
    /// Micro-relief for a scene.
    pub relief: MicroRelief,
    /// Speeds, forces and times that were recorded.
    pub groups: Vec<Group>,
    /// Recorded and played levels of third octaves at each group: (group, Hz, dB, dB).
    pub levels: Vec<(usize, f64, f64, f64)>,
    /// Remarks on the recording.
    pub warnings: Vec<String>,
}

/// Length of a window, s: long ones where the speed is steady.
const WINDOW_S: [f64; 2] = [0.4, 1.5];
/// Deviation of a measured speed from which windows are short, a share.
const STEADY: f64 = 0.03;
/// Lowest frequency that sound is read from, Hz: pressing at the pace of a hand does not sound, and
/// is taken off what is heard.
const SOUND_FROM_HZ: f64 = 120.0;
/// Band that published models hold, Hz.
const MODELS_HZ: (f64, f64) = (17.0, 450.0);
/// Highest frequency that is read, Hz.
const HIGH_HZ: f64 = 3000.0;
/// Agreement of two lines' periods, a share.
const SAME_LINE: f64 = 0.01;

/// Surface of strokes; `tangential_n` is the force along the surface, where it was recorded.
///
/// # Errors
/// When a recording is no stroke, or the model does not explain it.
pub fn fit(
    strokes: &[Stroke],
    tangential_n: Option<&[f64]>,
    options: &Options,
) -> Result<StrokeSurface, StrokeError> {
    if strokes.is_empty() {
        return Err(StrokeError::new("recording", "no stroke", "name at least one file"));
    }
    strokes.iter().try_for_each(checks::refuse)?;
    let mut warnings = Vec::new();
    let steady = strokes.iter().all(is_steady);
    let length_s = WINDOW_S[usize::from(steady && strokes.iter().all(|stroke| stroke.seconds() > 4.0))];
    let mut all: Vec<Window> = Vec::new();
    let mut floors = Vec::new();
    for (index, stroke) in strokes.iter().enumerate() {
        let mut own = windows(stroke, index, length_s);
        respond(&mut own, &options.tool);
        let floor = floor::find(&own);
        checks::stands_over_floor(&floor, &mut warnings)?;
        floors.push(floor);
        all.extend(own);
    }
    let longest_s = strokes.iter().map(Stroke::seconds).fold(0.0, f64::max);
    let low_hz = match options.tool.quantity {
        Quantity::Sound(_) => SOUND_FROM_HZ,
        _ => (50.0 / longest_s).clamp(if steady { 5.0 } else { 12.0 }, 40.0),
    };
    let found: Vec<lines::Lines> = strokes.iter().map(|stroke| lines::find(stroke, &options.tool)).collect();
    let (common, wander) = common_lines(strokes, &found, &mut warnings);
    let compliance = compliance::find(strokes, &options.tool, &mut warnings);
    let friction = tangential_n.and_then(|force| friction(strokes, force, &mut warnings));
    let mut surface =
        solve((&all, &floors), options, (low_hz, HIGH_HZ), &common, colour::LEVEL_DB, warnings)?;
    surface.wander = wander;
    surface.friction = friction;
    surface.compliance = compliance;
    Ok(surface)
}

/// Surface of published models.
///
/// # Errors
/// When they leave no level.
pub fn fit_models(read: &Models, options: &Options) -> Result<StrokeSurface, StrokeError> {
    let none = |window: &Window| Floor {
        density: vec![0.0; window.density.len()],
        from_standstill: true,
        over_signal_db: f64::NEG_INFINITY,
    };
    let floors: Vec<Floor> = read.windows.iter().map(none).collect();
    let mut windows = read.windows.clone();
    respond(&mut windows, &options.tool);
    let warnings = vec!["models of a few poles hold no lines: octaves only".to_owned()];
    let mut surface = solve((&windows, &floors), options, MODELS_HZ, &[], models::LEVEL_DB, warnings)?;
    surface.friction = read.friction;
    Ok(surface)
}

fn is_steady(stroke: &Stroke) -> bool {
    if !stroke.speed_m_s.is_measured() {
        return true;
    }
    let mean = stroke.speed_m_s.mean(0, stroke.len());
    let square = (0..stroke.len()).map(|i| (stroke.speed_m_s.at(i) / mean - 1.0).powi(2)).sum::<f64>()
        / stroke.len() as f64;
    square.sqrt() < STEADY
}

/// Lines that every stroke agrees on; what keeps its frequency instead is the rig's.
fn common_lines(strokes: &[Stroke], found: &[lines::Lines], warnings: &mut Vec<String>) -> (Vec<Line>, f64) {
    let wander = found.iter().map(|lines| lines.wander).fold(0.0, f64::max);
    if found.iter().any(|lines| lines.is_smeared) {
        warnings.push(
            "the speed wanders: a line is smeared and too weak to follow; record the speed as a column, or stroke steadily".to_owned(),
        );
    }
    let [first, others @ ..] = found else { return (Vec::new(), wander) };
    let speed = |stroke: &Stroke| stroke.speed_m_s.mean(0, stroke.len());
    let speeds: Vec<f64> = strokes.iter().map(speed).collect();
    let range =
        speeds.iter().copied().fold(0.0, f64::max) / speeds.iter().copied().fold(f64::INFINITY, f64::min);
    if others.is_empty() || range < 1.2 {
        if let Some(line) = first.lines.first().filter(|_| !strokes[0].speed_m_s.is_measured()) {
            let hz = speeds[0] / line.period_m;
            warnings.push(format!(
                "a line of {:.3} mm ({hz:.0} Hz): one speed cannot tell it from a resonance of the tool; record a second speed",
                1e3 * line.period_m
            ));
        }
        return (first.lines.clone(), wander);
    }
    let same = |a: &Line, b: &Line| (a.period_m / b.period_m - 1.0).abs() < SAME_LINE;
    let common: Vec<Line> = first
        .lines
        .iter()
        .filter(|line| others.iter().all(|lines| lines.lines.iter().any(|other| same(line, other))))
        .map(|line| {
            let all: Vec<Line> = found
                .iter()
                .filter_map(|lines| lines.lines.iter().find(|other| same(line, other)).copied())
                .collect();
            let count = all.len() as f64;
            Line {
                period_m: all.iter().map(|line| line.period_m).sum::<f64>() / count,
                amplitude_m: (all.iter().map(|line| line.amplitude_m.powi(2)).sum::<f64>() / count).sqrt(),
                period_se_m: line.period_se_m / count.sqrt(),
                over_relief_db: line.over_relief_db,
            }
        })
        .collect();
    for (i, line) in first.lines.iter().enumerate().take(3) {
        let hz = speeds[0] / line.period_m;
        let fixed = others
            .iter()
            .zip(&speeds[1..])
            .all(|(lines, v)| lines.lines.iter().any(|other| (v / other.period_m / hz - 1.0).abs() < 0.02));
        if fixed && !common.iter().any(|known| same(known, line)) && i < 3 {
            warnings
                .push(format!("{hz:.0} Hz stays at every speed: a resonance of the tool, not of the ground"));
        }
    }
    (common, wander)
}

/// Mean of the tangential force over the pressing one while it moves.
fn friction(strokes: &[Stroke], tangential_n: &[f64], warnings: &mut Vec<String>) -> Option<f64> {
    let stroke = strokes.first()?;
    let (mut along, mut pressed, mut size) = (0.0, 0.0, 0.0);
    for (i, force) in tangential_n.iter().enumerate().take(stroke.len()) {
        if stroke.speed_m_s.at(i) > crate::recording::STANDSTILL_M_S {
            along += force;
            size += force.abs();
            pressed += stroke.force_n.at(i);
        }
    }
    if along.abs() < 0.2 * size {
        warnings.push("the tangential force changes its sign: friction is the mean of its size".to_owned());
        return Some(size / pressed);
    }
    Some(along.abs() / pressed)
}

fn solve(
    (all, floors): (&[Window], &[Floor]),
    options: &Options,
    band_hz: (f64, f64),
    lines: &[Line],
    level_db: f64,
    mut warnings: Vec<String>,
) -> Result<StrokeSurface, StrokeError> {
    let tool = &options.tool;
    let groups = relief::groups(all);
    let lift = checks::lift(all, tool, floors);
    checks::stays_down(lift, tool, &mut warnings)?;
    let colour_db = |hz: f64| options.colour.as_deref().map_or(0.0, |table| interpolated(table, hz));
    let several = colour::speed_range(&groups) >= LEAST_SPEEDS;
    // Levels that wander by decibels show no tilt of a rig.
    let with_colour = options.colour.is_none() && several && level_db < 1.0;
    if !several && options.colour.is_none() {
        warnings.push(
            "one speed: the rig's own colour counts as ground; strokes at a second speed, twice as fast, tell them apart".to_owned(),
        );
    }
    let lines_q: Vec<(f64, f64)> =
        lines.iter().map(|line| (1.0 / line.period_m, 0.003 / line.period_m)).collect();
    let levels = relief::levels((all, &groups), floors, band_hz, &lines_q, &colour_db);
    let parted = colour::part(&levels, &groups, with_colour, level_db);
    if parted.bands.len() < 4 {
        return Err(StrokeError::new(
            "recording",
            format!("{} third octaves stand over the noise floor", parted.bands.len()),
            "at least 4 must: record longer, press harder, stroke faster",
        ));
    }
    let tip_radius_m = tool.sounding().tip_radius_m;
    let law = PowerLaw::through(&parted.bands, tip_radius_m);
    let spectrum = Spectrum::new(&parted.bands);
    let octaves: Vec<Octave> =
        (0..OCTAVES).map(|octave| spectrum.octave(octave_noise::wavelength_m(octave))).collect();
    let middle = &groups[0];
    let probe_se_db = octaves
        .iter()
        .map(|octave| {
            tool.uncertainty_db(middle.speed_m_s / octave.wavelength_m, middle.force_n, options.probe_error)
        })
        .collect();
    let relief = octaves::playing(&spectrum, &law, tip_radius_m);
    let rig: Vec<(f64, f64)> = parted.colour.iter().map(|c| (c.frequency_hz, c.gain_db)).collect();
    let recorded: Vec<(usize, f64, f64, f64)> = levels
        .iter()
        .map(|level| {
            let group = &groups[level.group];
            let through = db(tool.power_at(level.frequency_hz, group.force_n) / group.speed_m_s);
            let played = relief.level_db(level.band) + interpolated(&rig, level.frequency_hz);
            (level.group, level.frequency_hz, level.level_db + through, played + through)
        })
        .collect();
    let count = recorded.len().max(1) as f64;
    let mean = recorded.iter().map(|level| level.2).sum::<f64>() / count;
    let variance = recorded.iter().map(|level| (level.2 - mean).powi(2)).sum::<f64>() / count;
    let left = recorded.iter().map(|level| (level.2 - level.3).powi(2)).sum::<f64>() / count;
    if law.alpha < 0.0 {
        warnings.push(format!(
            "α {:.2}: ground that is the rougher the finer one looks is none; the probe's constants, or its skin (ridge_m), are not those of the recording",
            law.alpha
        ));
    }
    if let Some(gain) = parted.force_db_per_octave.filter(|gain| gain.abs() > 1.5) {
        warnings.push(format!("levels change by {gain:+.1} dB a doubling of force beside the probe's law: soft ground, or another probe"));
    }
    Ok(StrokeSurface {
        relief,
        bands: parted.bands,
        octaves,
        probe_se_db,
        law,
        lines: lines.to_vec(),
        wander: 0.0,
        colour: parted.colour,
        force_db_per_octave: parted.force_db_per_octave,
        friction: None,
        compliance: None,
        explained: (1.0 - left / variance.max(1e-12)).max(0.0),
        beside_db: left.sqrt(),
        lift,
        groups,
        levels: recorded,
        warnings,
    })
}

/// Value of a table between its rows; beyond them the end's.
fn interpolated(table: &[(f64, f64)], hz: f64) -> f64 {
    let next = table.partition_point(|row| row.0 <= hz);
    match (next.checked_sub(1).and_then(|i| table.get(i)), table.get(next)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (hz / a.0).ln() / (b.0 / a.0).ln(),
        (Some(row), None) | (None, Some(row)) => row.1,
        (None, None) => 0.0,
    }
}
