//! Late lines: what still rings when everything else is over, and no stage has kept.
//!
//! The stages of [`crate::ways::tail_to_attack`] lose quiet partials that are heard at the end.
//! Most fall too fast to be continued back from the stage that sees them, and in the later ones
//! they are bent towards the attack, which is a thousand times as loud (of 14 lost in three
//! cowbells and a bongo, 11; the others fell to the cap of a stage of which two thirds were given
//! up afterwards). So at the end, with all modes in place, the sound after 0.2 s is looked at once
//! more. A line that it still holds becomes a mode if
//!
//! | it is | that is |
//! |---|---|
//! | heard | within 28 dB of the loudest mode in that part, by energy |
//! | alone | no mode within three half widths of the two has more than a hundredth of its energy there |
//! | paid for | continued back to the onset, all together raise the squared residual of the sound by 2 % (0.1 dB) at most |
//!
//! The modes that are there stay as they are. Where they leave less than 32 dB of that part nothing
//! is looked for.

use crate::search::limits::Limits;
use crate::search::sub_band::Level;
use crate::sinusoid::partial::Partial;
use crate::sinusoid::refinement::refine;
use crate::ways::analysis::subtract;
use crate::ways::merging::MERGED_LOSS;
use crate::ways::ranking::keep_heard;
use crate::ways::rounds::{Rounds, add_proposed};

/// Beginning of the late part, s after the onset; the fewest samples of it.
const FROM_S: f64 = 0.2;
const SHORTEST: usize = 4096;
/// Least remainder, as a part of its energy.
const LEFT: f64 = 6e-4;
/// Levels that are looked at: lines are narrow.
const LEVELS: usize = 2;
/// Places while they are looked for, over those that are left.
const UNREFINED: f64 = 1.5;
/// Steps of a joint refinement in a level.
const LEVEL_STEPS: usize = 5;
/// A mode is proven from twice its standard deviation on.
const ROUNDS: Rounds = Rounds { most: 3, merged_loss: MERGED_LOSS, proven: 4.0, steps: 3 };
/// By how many nepers a line may have fallen when the late part begins, and what that costs of its
/// own energy.
const BACK_NEPERS: f64 = 4.5;
const ENERGY_COST: f64 = 1e-3;
/// Heard, alone and paid for, as in the table.
const HEARD: f64 = 1.6e-3;
const HALF_WIDTHS: f64 = 3.0;
const BESIDE: f64 = 0.01;
const COST: f64 = 0.02;

/// The late lines of `segment` beside its `partials`, their amplitudes at its first sample.
pub(crate) fn late_lines(segment: &[f64], partials: &[Partial], limits: &Limits) -> Vec<Partial> {
    let start = (FROM_S * limits.rate_hz) as usize;
    let places = limits.max_partials.saturating_sub(partials.len());
    if segment.len() < start + SHORTEST || places == 0 {
        return Vec::new();
    }
    let residual = subtract(segment, partials);
    let late = &residual[start..];
    if energy(late) < LEFT * energy(&segment[start..]) {
        return Vec::new();
    }
    let known: Vec<Partial> = partials.iter().map(|p| p.moved(start as f64)).collect();
    let lines = heard_alone(lines(late, start, places, limits), &known, late.len());
    let at_onset = lines.iter().map(|p| p.moved(-(start as f64)));
    let bounded = at_onset.filter(|p| limits.bounds.allow(p)).collect();
    paid_for(bounded, residual, places)
}

/// Everything that rings in `late`, which begins `start` samples after the onset.
fn lines(late: &[f64], start: usize, places: usize, limits: &Limits) -> Vec<Partial> {
    let mut limits = *limits;
    limits.bounds.energy_cost = ENERGY_COST;
    limits.bounds.delta_high = limits.bounds.delta_high.min(BACK_NEPERS / start as f64);
    let most = (UNREFINED * places as f64) as usize;
    let mut found: Vec<Partial> = Vec::new();
    for level in Level::ladder(late.len()).into_iter().take(LEVELS) {
        if add_proposed(late, &mut found, level, &limits) {
            keep_heard(&mut found, late.len(), most, limits.rate_hz);
            refine(late, &mut found, &limits.bounds, LEVEL_STEPS);
        }
    }
    ROUNDS.run(late, &mut found, &limits);
    found
}

/// Lines that are heard beside the `known` modes and stand alone among them, the loudest first.
fn heard_alone(mut lines: Vec<Partial>, known: &[Partial], count: usize) -> Vec<Partial> {
    let loudest = known.iter().chain(&lines).map(|p| p.energy(count)).fold(0.0, f64::max);
    let alone = |line: &Partial| {
        known.iter().all(|p| {
            let width = p.delta.max(line.delta).max(1.0 / count as f64);
            let apart = (p.omega - line.omega).abs() > HALF_WIDTHS * width;
            apart || p.energy(count) < BESIDE * line.energy(count)
        })
    };
    lines.retain(|p| p.energy(count) > HEARD * loudest && alone(p));
    lines.sort_by(|a, b| b.energy(count).total_cmp(&a.energy(count)));
    lines
}

/// Lines, at most `places`, that `residual` can pay for, in their order.
fn paid_for(mut lines: Vec<Partial>, mut residual: Vec<f64>, places: usize) -> Vec<Partial> {
    let most = (1.0 + COST) * energy(&residual);
    let mut taken = 0;
    lines.retain(|&line| {
        let left = subtract(&residual, &[line]);
        let pays = taken < places && energy(&left) <= most;
        if pays {
            taken += 1;
            residual = left;
        }
        pays
    });
    lines
}

fn energy(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sinusoid::projection::synthesise;
    use crate::sinusoid::refinement::Bounds;
    use nalgebra::Complex;
    use std::f64::consts::PI;

    const RATE_HZ: f64 = 44_100.0;

    fn partial(hz: f64, decay_per_s: f64, amplitude: f64) -> Partial {
        Partial {
            omega: 2.0 * PI * hz / RATE_HZ,
            delta: decay_per_s / RATE_HZ,
            c: Complex::from_polar(amplitude, 0.4),
        }
    }

    fn limits(max_partials: usize) -> Limits {
        Limits {
            bounds: Bounds { delta_high: 0.03, omega_low: 0.003, ..Bounds::wide() },
            max_partials,
            kept: max_partials,
            least_energy: 0.0,
            threads: 1,
            rate_hz: RATE_HZ,
            least_noise: 0.0,
        }
    }

    #[test]
    fn a_quiet_fast_line_is_found_after_a_loud_attack() {
        // It has fallen by 2.4 nepers when the late part begins, and lies 40 dB below the attack.
        let (attack, line) = (partial(900.0, 60.0, 1.0), partial(2300.0, 12.0, 0.01));
        let mut rng = asperity_dsp::rng::Rng::new(4);
        let mut segment = synthesise(&[attack, line], 44_100);
        segment.iter_mut().for_each(|x| *x += 1e-5 * rng.normal());
        let found = late_lines(&segment, &[attack], &limits(20));
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].omega / line.omega - 1.0).abs() < 1e-4, "{found:?}");
        assert!((found[0].delta / line.delta - 1.0).abs() < 0.02, "{found:?}");
        // No place, no line.
        assert_eq!(late_lines(&segment, &[attack], &limits(1)), []);
    }

    #[test]
    fn what_exceeds_the_recordings_onset_is_no_mode() {
        // A line that began only when the attack was over.
        let (attack, line) = (partial(900.0, 60.0, 0.02), partial(2300.0, 14.0, 1.0));
        let mut segment = synthesise(&[attack], 44_100);
        let late = synthesise(&[line], 44_100);
        let from = (0.15 * RATE_HZ) as usize;
        segment[from..].iter_mut().zip(&late[from..]).for_each(|(x, y)| *x += y);
        assert_eq!(late_lines(&segment, &[attack], &limits(20)), []);
    }

    #[test]
    fn what_a_mode_leaves_of_its_own_resonance_is_no_line() {
        let (bar, beat) = (partial(1254.0, 3.0, 1.0), partial(1254.6, 3.5, 0.2));
        let segment = synthesise(&[bar, beat], 44_100);
        assert_eq!(late_lines(&segment, &[bar], &limits(20)), []);
    }
}
