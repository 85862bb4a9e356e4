//! Lines: what repeats along the stroke with one period, as ridges and weaves do.
//!
//! The whole stroke is taken back to height, resampled at equal steps of place, and seen through one
//! Hann window. The floor about a bin is the median of a sixth of an octave over 0.69 (the mean of an
//! exponential variable over its median); a line stands over it by more than chance gives once in a
//! hundred strokes.
//!
//! Where nobody measured the speed sample by sample, its wander smears a line. The phase of the
//! strongest one, in a band about it that narrows from ± 25 to 8 %, then tells the place: a period
//! for every turn. The period is the path over the turns.

use crate::recording::Stroke;
use crate::tool::{Quantity, Tool};
use asperity_fft::FftPlanner;
use asperity_fft::num_complex::Complex;
use std::f64::consts::PI;

/// Line of a stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
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
    /// Deviation of the speed from its told mean that the strongest line shows, a share; 0 where it
    /// was measured.
    pub wander: f64,
    /// Smeared peak that is no line: the speed wanders, and too weak a line tells too little of it.
    pub is_smeared: bool,
}

/// Band of the recording that lines are looked for in, Hz.
const BAND_HZ: (f64, f64) = (15.0, 1200.0);
/// Chance of a false line in a stroke.
const CHANCE: f64 = 0.01;
/// Median of an exponential variable over its mean.
const MEDIAN: f64 = std::f64::consts::LN_2;
/// Bins of the padded spectrum for one of the unpadded.
const PADDED: usize = 4;
/// Half widths of the bands about the strongest line in which its phase is followed.
const FOLLOWED: [f64; 3] = [0.25, 0.12, 0.08];
/// Cutoff to which the followed phase is smoothed, Hz.
const WANDER_HZ: f64 = 6.0;
/// Distance of peaks that one smeared line breaks into, a share of its period.
const BROKEN: f64 = 0.12;
/// Hump over its third octave that is no chance, dB.
const SMEARED_DB: f64 = -5.0;
/// Line over its third octave from which its phase is trusted, dB.
const TRUSTED_DB: f64 = 0.0;
/// Lines that are told.
const MOST: usize = 12;

/// A height at equal steps of place.
struct Profile {
    height_m: Vec<f64>,
    step_m: f64,
    mean_speed_m_s: f64,
    rate_hz: f64,
}

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
    let is_broken = found.lines.iter().filter(|line| about(line)).count() >= 3;
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
    found.lines = lines;
    found.wander = wander;
    found
}

/// Felt height of an axis within [`BAND_HZ`].
fn felt_height(axis: &[f64], stroke: &Stroke, tool: &Tool) -> Vec<f64> {
    let length = axis.len().next_power_of_two();
    let mean = axis.iter().sum::<f64>() / axis.len().max(1) as f64;
    let mut bins: Vec<Complex<f64>> = axis.iter().map(|x| Complex::new(x - mean, 0.0)).collect();
    bins.resize(length, Complex::default());
    let mut planner = FftPlanner::new();
    planner.plan_fft_forward(length).process(&mut bins);
    let force_n = stroke.force_n.mean(0, stroke.len());
    let bin_hz = stroke.rate_hz / length as f64;
    let top_hz = BAND_HZ.1.min(0.4 * stroke.rate_hz);
    for i in 0..=length / 2 {
        let hz = i as f64 * bin_hz;
        let gain = if (BAND_HZ.0..top_hz).contains(&hz) {
            tool.inverse(hz, force_n) / length as f64
        } else {
            Complex::default()
        };
        bins[i] *= gain;
        if i > 0 && i < length / 2 {
            bins[length - i] *= gain.conj();
        }
    }
    planner.plan_fft_inverse(length).process(&mut bins);
    bins[..axis.len()].iter().map(|bin| bin.re).collect()
}

/// Heights at equal steps of place, by cubics through the samples.
fn at_places(height_m: &[f64], path_m: &[f64], stroke: &Stroke) -> Profile {
    let total_m = path_m.last().copied().unwrap_or(0.0);
    let count = height_m.len();
    let step_m = total_m / count.max(1) as f64;
    let mut after = 0;
    let at = |i: usize| height_m[i.min(count - 1)];
    let heights = (0..count)
        .map(|i| {
            let x = (i as f64 + 0.5) * step_m;
            while after + 1 < count && path_m[after] < x {
                after += 1;
            }
            let before = after.saturating_sub(1);
            let span = (path_m[after] - path_m[before]).max(1e-30);
            let t = ((x - path_m[before]) / span).clamp(0.0, 1.0);
            let (p0, p1, p2, p3) = (at(before.saturating_sub(1)), at(before), at(after), at(after + 1));
            p1 + 0.5
                * t
                * (p2 - p0 + t * (2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3 + t * (3.0 * (p1 - p2) + p3 - p0)))
        })
        .collect();
    Profile { height_m: heights, step_m, mean_speed_m_s: total_m / stroke.seconds(), rate_hz: stroke.rate_hz }
}

/// Padded power spectrum of a profile through a Hann window: amplitude² of a sine in a bin.
fn spectrum(profile: &Profile) -> (Vec<f64>, f64) {
    let count = profile.height_m.len();
    let length = (PADDED * count).next_power_of_two();
    let mut bins: Vec<Complex<f64>> = profile
        .height_m
        .iter()
        .enumerate()
        .map(|(i, h)| Complex::new(h * (0.5 - 0.5 * (2.0 * PI * i as f64 / count as f64).cos()), 0.0))
        .collect();
    bins.resize(length, Complex::default());
    FftPlanner::new().plan_fft_forward(length).process(&mut bins);
    let scale = (4.0 / count as f64).powi(2);
    let power = bins[..length / 2].iter().map(|bin| scale * bin.norm_sqr()).collect();
    (power, 1.0 / (length as f64 * profile.step_m))
}

/// Range of bins that holds the band that was kept.
fn held(profile: &Profile, bin_q: f64, bins: usize) -> (usize, usize) {
    let v = profile.mean_speed_m_s.max(1e-9);
    let top_hz = BAND_HZ.1.min(0.4 * profile.rate_hz);
    let low = (1.3 * BAND_HZ.0 / v / bin_q) as usize;
    let high = (0.8 * top_hz / v / bin_q) as usize;
    (low.max(8), high.min(bins))
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
        // Noise of a bin counts with the line's own amplitude²; the rest of the third octave beside it.
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

/// Smeared line.
struct Hump {
    period_m: f64,
    over_db: f64,
    is_wide: bool,
}

/// Strongest hump of the spectrum in bands of a twelfth of an octave over what is half an octave
/// about it.
fn hump(profile: &Profile) -> Option<Hump> {
    let (power, bin_q) = spectrum(profile);
    let (low, high) = held(profile, bin_q, power.len());
    let independent = bin_q * profile.step_m * profile.height_m.len() as f64;
    if high <= low + 64 {
        return None;
    }
    let mut sums = vec![0.0; power.len() + 1];
    for (i, value) in power.iter().enumerate() {
        sums[i + 1] = sums[i] + value;
    }
    let mean = |from: usize, to: usize| {
        let (from, to) = (from.max(low), to.min(high));
        (sums[to.max(from)] - sums[from]) / (to.max(from + 1) - from) as f64
    };
    let mut best: Option<(f64, usize)> = None;
    let mut at = (1.2 * low as f64) as usize;
    while 1.2 * (at as f64) < high as f64 {
        let inner = (at as f64 * 0.05) as usize;
        let outer = (at as f64 * 0.3) as usize;
        let own = mean(at - inner, at + inner + 1);
        let about = (mean(at.saturating_sub(outer), at - inner) * mean(at + inner + 1, at + outer)).sqrt();
        // Chance: so many independent bins make the mean.
        let bins = (2.0 * inner as f64 * independent).max(1.0);
        let score = (own / about.max(f64::MIN_POSITIVE)).ln() * bins.sqrt();
        if best.is_none_or(|(least, _)| score > least) && score > 7.0 {
            best = Some((score, at));
        }
        at += (inner / 4).max(1);
    }
    let (_, at) = best?;
    let inner = (at as f64 * 0.06) as usize;
    let range = at - inner..at + inner + 1;
    let top = range.clone().max_by(|a, b| power[*a].total_cmp(&power[*b]))?;
    let whole: f64 = power[range.clone()].iter().sum();
    let peak: f64 = {
        let reach = (3.0 / independent) as usize;
        power[top.saturating_sub(reach)..top + reach + 1].iter().sum()
    };
    let centre = range.clone().map(|i| i as f64 * power[i]).sum::<f64>() / whole;
    let outer = (at as f64 * 0.3) as usize;
    let about = (mean(at.saturating_sub(outer), at - inner) * mean(at + inner + 1, at + outer)).sqrt();
    let own = whole - about * range.len() as f64;
    let third = about * at as f64 * (10f64.powf(0.05) - 10f64.powf(-0.05));
    Some(Hump {
        period_m: 1.0 / (centre * bin_q),
        over_db: crate::db(own.max(0.0) / third.max(f64::MIN_POSITIVE)),
        is_wide: peak - about * 6.0 / independent < 0.6 * own,
    })
}

/// Place by the phase of the strongest line: the profile over it, the wander, and the line's period.
fn follow(height_m: &[f64], path_m: &[f64], stroke: &Stroke, period_m: f64) -> (Profile, f64, f64) {
    let mut path = path_m.to_vec();
    let total_m = path.last().copied().unwrap_or(0.0);
    let mut period_m = period_m;
    for half in FOLLOWED {
        let profile = at_places(height_m, &path, stroke);
        let phase = phase_along(&profile, 1.0 / period_m, half);
        let turns = (phase[phase.len() - 1] - phase[0]) / (2.0 * PI);
        let covered_m = profile.step_m * (phase.len() - 1) as f64;
        period_m = covered_m / turns.abs().max(1e-9);
        // Place within the told path: where the phase says, on the period that the whole path has.
        let begin = phase[0];
        let places: Vec<f64> = phase.iter().map(|phase| (phase - begin) / (2.0 * PI) * period_m).collect();
        path = path
            .iter()
            .map(|at| {
                let i = (at / profile.step_m).clamp(0.0, (places.len() - 1) as f64);
                let below = (i as usize).min(places.len() - 2);
                let share = i - below as f64;
                places[below] + share * (places[below + 1] - places[below])
            })
            .collect();
        // Places never turn back.
        for i in 1..path.len() {
            path[i] = path[i].max(path[i - 1]);
        }
        let end = path.last().copied().unwrap_or(1.0).max(1e-12);
        path.iter_mut().for_each(|at| *at *= total_m / end);
    }
    let speed: Vec<f64> = {
        let block = (stroke.rate_hz / 10.0) as usize;
        path.chunks(block.max(1))
            .filter(|part| part.len() > 1)
            .map(|part| (part[part.len() - 1] - part[0]) / (part.len() - 1) as f64 * stroke.rate_hz)
            .collect()
    };
    let mean = speed.iter().sum::<f64>() / speed.len().max(1) as f64;
    let deviation =
        (speed.iter().map(|v| (v / mean - 1.0).powi(2)).sum::<f64>() / speed.len().max(1) as f64).sqrt();
    (at_places(height_m, &path, stroke), deviation, period_m)
}

/// Unwrapped phase of a line along the profile, smoothed to [`WANDER_HZ`].
fn phase_along(profile: &Profile, q: f64, half: f64) -> Vec<f64> {
    let count = profile.height_m.len();
    let length = count.next_power_of_two();
    let mut bins: Vec<Complex<f64>> = profile.height_m.iter().map(|h| Complex::new(*h, 0.0)).collect();
    bins.resize(length, Complex::default());
    let mut planner = FftPlanner::new();
    planner.plan_fft_forward(length).process(&mut bins);
    let bin_q = 1.0 / (length as f64 * profile.step_m);
    for (i, bin) in bins.iter_mut().enumerate() {
        let at = i as f64 * bin_q;
        let away = ((at / q - 1.0) / half).abs();
        let gain = if i >= length / 2 || away > 1.0 { 0.0 } else { 0.5 + 0.5 * (PI * away).cos() };
        *bin *= gain;
    }
    planner.plan_fft_inverse(length).process(&mut bins);
    let mut turned = 0.0;
    let mut last = bins[0].arg();
    let mut phase: Vec<f64> = bins[..count]
        .iter()
        .map(|bin| {
            let step = bin.arg() - last;
            last = bin.arg();
            turned += step - 2.0 * PI * (step / (2.0 * PI)).round();
            turned
        })
        .collect();
    let reach = (0.44 * profile.mean_speed_m_s / WANDER_HZ / profile.step_m) as usize;
    // Of the deviation from a straight phase, so that the ends do not bend.
    let slope = (phase[count - 1] - phase[0]) / (count - 1) as f64;
    phase.iter_mut().enumerate().for_each(|(i, phase)| *phase -= slope * i as f64);
    let mut sums = vec![0.0; count + 1];
    for (i, value) in phase.iter().enumerate() {
        sums[i + 1] = sums[i] + value;
    }
    (0..count)
        .map(|i| {
            let reach = reach.min(i).min(count - 1 - i);
            (sums[i + reach + 1] - sums[i - reach]) / (2 * reach + 1) as f64 + slope * i as f64
        })
        .collect()
}
