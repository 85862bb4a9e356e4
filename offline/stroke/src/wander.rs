//! Wander of an unrecorded speed: smeared lines, and the place that a strong one gives.

use crate::profile::{Profile, at_places, held, spectrum};
use crate::recording::Stroke;
use crate::running_sums;
use asperity_fft::FftPlanner;
use asperity_fft::num_complex::Complex;
use std::f64::consts::PI;

/// Half widths of the bands about the strongest line in which its phase is followed.
const FOLLOWED: [f64; 3] = [0.25, 0.12, 0.08];
/// Cutoff to which the followed phase is smoothed, Hz.
const WANDER_HZ: f64 = 6.0;

/// Smeared line.
pub(crate) struct Hump {
    pub(crate) period_m: f64,
    pub(crate) over_db: f64,
    pub(crate) is_wide: bool,
}

/// Strongest hump of the spectrum in bands of a twelfth of an octave over what is half an octave
/// about it.
pub(crate) fn hump(profile: &Profile) -> Option<Hump> {
    let (power, bin_q) = spectrum(profile);
    let (low, high) = held(profile, bin_q, power.len());
    let independent = bin_q * profile.step_m * profile.height_m.len() as f64;
    if high <= low + 64 {
        return None;
    }
    let sums = running_sums(&power);
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

/// Place by the phase of the strongest line: the profile over it, the wander, and the line's
/// period.
pub(crate) fn follow(
    height_m: &[f64],
    path_m: &[f64],
    stroke: &Stroke,
    period_m: f64,
) -> (Profile, f64, f64) {
    let mut path = path_m.to_vec();
    let total_m = path.last().copied().unwrap_or(0.0);
    let mut period_m = period_m;
    for half in FOLLOWED {
        let profile = at_places(height_m, &path, stroke);
        let phase = phase_along(&profile, 1.0 / period_m, half);
        let turns = (phase[phase.len() - 1] - phase[0]) / (2.0 * PI);
        let covered_m = profile.step_m * (phase.len() - 1) as f64;
        period_m = covered_m / turns.abs().max(1e-9);
        // Place within the stated path: where the phase says, on the period that the whole path
        // has.
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
    let sums = running_sums(&phase);
    (0..count)
        .map(|i| {
            let reach = reach.min(i).min(count - 1 - i);
            (sums[i + reach + 1] - sums[i - reach]) / (2 * reach + 1) as f64 + slope * i as f64
        })
        .collect()
}
