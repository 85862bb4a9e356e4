//! Lines: what repeats along the stroke with one period, as ridges and weaves do.
//!
//! The whole stroke is taken back to height, resampled at equal steps of place, and seen through
//! one Hann window. The floor about a bin is the median of a sixth of an octave over 0.69 (the mean
//! of an exponential variable over its median); a line stands over it by more than chance gives
//! once in a hundred strokes.
//!
//! A speed that was not measured sample by sample wanders and smears a line. The phase of the
//! strongest one, in a band about it that narrows from ± 25 to 8 %, then gives the place: a period
//! for every turn. The period is the path over the turns.

use crate::profile::{Profile, at_places, felt_height, held, spectrum};
use crate::recording::Stroke;
use crate::tool::{Quantity, Tool};
use crate::wander::{follow, hump};
use serde::Serialize;
use std::f64::consts::PI;

/// Line of a stroke.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Line {
    /// Period, m.
    pub period_m: f64,
    /// Its standard error, m.
    pub period_se_m: f64,
    /// Amplitude of the felt height, m.
    pub amplitude_m: f64,
    /// Amplitude over what the relief has in a third octave about it, dB.
    pub over_relief_db: f64,
}

/// Lines of a stroke, and what was seen beside them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Lines {
    /// Lines, the strongest first.
    pub lines: Vec<Line>,
    /// Deviation of the speed from its stated mean that the strongest line shows, a share; 0 where
    /// it was measured.
    pub wander: f64,
    /// Smeared peak that is no line: the speed wanders, and too weak a line shows too little of it.
    pub is_smeared: bool,
}

/// Chance of a false line in a stroke.
const CHANCE: f64 = 0.01;
/// Median of an exponential variable over its mean.
const MEDIAN: f64 = std::f64::consts::LN_2;
/// Distance of peaks that one smeared line breaks into, a share of its period.
const BROKEN: f64 = 0.12;
/// Hump over its third octave that is no chance, dB.
const SMEARED_DB: f64 = -5.0;
/// Line over its third octave from which its phase is trusted, dB.
const TRUSTED_DB: f64 = 0.0;
/// Amplitude that a line gains by its own phase only where the speed wanders.
const GAINED: f64 = 1.4;
/// Lines that are reported.
const MOST: usize = 12;

/// Looks for lines in a stroke; the probe's response at its mean force is taken off.
#[must_use]
pub fn find(stroke: &Stroke, tool: &Tool) -> Lines {
    if matches!(tool.quantity, Quantity::Sound(_)) {
        return Lines::default();
    }
    let heights: Vec<Vec<f64>> = stroke.axes.iter().map(|axis| felt_height(axis, stroke, tool)).collect();
    let path: Vec<f64> = (0..stroke.len())
        .scan(0.0, |at, i| {
            *at += stroke.speed_m_s.at(i).max(0.0) / stroke.rate_hz;
            Some(*at)
        })
        .collect();
    // The strongest axis holds the lines.
    let power = |height: &Vec<f64>| height.iter().map(|h| h * h).sum::<f64>();
    let Some(height) = heights.iter().max_by(|a, b| power(a).total_cmp(&power(b))) else {
        return Lines::default();
    };
    let profile = at_places(height, &path, stroke);
    let mut found = Lines { lines: peaks(&profile), wander: 0.0, is_smeared: false };
    if stroke.speed_m_s.is_measured() {
        return found;
    }
    // A smeared line breaks into peaks about its place.
    let about = |line: &Line| (line.period_m / found.lines[0].period_m - 1.0).abs() < BROKEN;
    let is_broken = found.lines.iter().filter(|line| about(line)).count() >= 2;
    let smeared = Lines { lines: Vec::new(), wander: 0.0, is_smeared: true };
    let Some(hump) = hump(&profile) else { return if is_broken { smeared } else { found } };
    let steady = found.lines.len() == 1
        || found.lines.first().is_some_and(|line| line.over_relief_db > hump.over_db - 1.0);
    if steady && !hump.is_wide {
        return found;
    }
    if hump.over_db < TRUSTED_DB {
        // Smeared, and too weak to follow.
        return Lines {
            lines: Vec::new(),
            wander: 0.0,
            is_smeared: is_broken || hump.is_wide && hump.over_db > SMEARED_DB,
        };
    }
    let (followed, wander, period_m) = follow(height, &path, stroke, hump.period_m);
    let lines = peaks(&followed);
    if lines.first().is_none_or(|line| (line.period_m / period_m - 1.0).abs() > 0.03) {
        return Lines { lines: Vec::new(), wander, is_smeared: true };
    }
    let same = found.lines.iter().filter(|line| (line.period_m / period_m - 1.0).abs() < BROKEN);
    if lines[0].amplitude_m < GAINED * same.map(|line| line.amplitude_m).fold(0.0, f64::max) {
        return found;
    }
    found.lines = lines;
    found.wander = wander;
    found
}

/// Lines that stand over the floor.
fn peaks(profile: &Profile) -> Vec<Line> {
    let (power, bin_q) = spectrum(profile);
    let (low, high) = held(profile, bin_q, power.len());
    if high <= low + 16 {
        return Vec::new();
    }
    let length_m = profile.step_m * profile.height_m.len() as f64;
    let independent = bin_q * length_m;
    let threshold = ((high - low) as f64 * independent / CHANCE).ln();
    let floors = Floors::of(&power, (low, high), independent);
    let mut lines: Vec<(usize, Line)> = Vec::new();
    for i in low + 1..high - 1 {
        let floor = floors.at(i);
        if power[i] < threshold * floor || power[i] < power[i - 1] || power[i] <= power[i + 1] {
            continue;
        }
        let [a, b, c] = [i - 1, i, i + 1].map(|i| power[i].max(f64::MIN_POSITIVE).ln());
        let shift = 0.5 * (a - c) / (a - 2.0 * b + c).min(-1e-12);
        let top = (b - 0.25 * (a - c) * shift).exp();
        let q = (i as f64 + shift) * bin_q;
        // Noise of a bin counts with the line's own amplitude²; the rest of the third octave beside
        // it.
        let amplitude = (top - floor).max(0.0).sqrt();
        let third = q * (10f64.powf(0.05) - 10f64.powf(-0.05));
        // A floor of one bin is 4/(length · 1.5) of the density.
        let relief = 2.0 * floor * third * length_m / 1.5 / 2.0;
        let snr = top / floor;
        let se_q = (6f64.sqrt() / PI) / (length_m * snr.sqrt());
        lines.push((
            i,
            Line {
                period_m: 1.0 / q,
                period_se_m: se_q / (q * q),
                amplitude_m: amplitude,
                over_relief_db: crate::db(amplitude * amplitude) - crate::db(relief),
            },
        ));
    }
    // Side lobes of a strong line are no lines.
    lines.sort_by(|a, b| b.1.amplitude_m.total_cmp(&a.1.amplitude_m));
    let mut kept: Vec<(usize, Line)> = Vec::new();
    for (i, line) in lines {
        let reach = (6.0 / independent) as usize;
        if kept.iter().all(|(other, strong)| {
            let near = i.abs_diff(*other);
            near > reach && (near > 8 * reach || line.amplitude_m > 0.05 * strong.amplitude_m)
        }) {
            kept.push((i, line));
        }
    }
    kept.into_iter().map(|(_, line)| line).take(MOST).collect()
}

/// Medians of sixths of an octave over [`MEDIAN`].
struct Floors {
    low: usize,
    medians: Vec<f64>,
}

impl Floors {
    fn of(power: &[f64], (low, high): (usize, usize), independent: f64) -> Self {
        let least = (24.0 / independent) as usize;
        let median = |at: usize| {
            let reach = ((at as f64) * 0.0595) as usize;
            let reach = reach.max(least);
            let mut near: Vec<f64> =
                power[at.saturating_sub(reach).max(low)..(at + reach + 1).min(high)].to_vec();
            let middle = near.len() / 2;
            let (_, median, _) = near.select_nth_unstable_by(middle, f64::total_cmp);
            *median / MEDIAN
        };
        let count = Self::place(high, low) as usize + 2;
        Self { low, medians: (0..count).map(|i| median(Self::bin(i, low).min(high - 1))).collect() }
    }

    /// Places 24 to an octave.
    fn place(bin: usize, low: usize) -> f64 {
        24.0 * (bin as f64 / low as f64).log2()
    }

    fn bin(place: usize, low: usize) -> usize {
        (low as f64 * 2f64.powf(place as f64 / 24.0)) as usize
    }

    fn at(&self, bin: usize) -> f64 {
        let place = Self::place(bin, self.low);
        let below = (place as usize).min(self.medians.len() - 2);
        let share = place - below as f64;
        self.medians[below].powf(1.0 - share) * self.medians[below + 1].powf(share)
    }
}
