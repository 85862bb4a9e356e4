//! One resonance, one mode: partials that only together describe one decay become one.
//!
//! A real resonance is an exponential to 20–40 dB. Over noise far below that, every criterion that
//! models noise alone (noise edge, Wald, Rao) spends two or three partials on the rest: a decay of
//! 0.4 dB rms off the exponential came out as three modes within 1.4 Hz, the strongest with half
//! its true T60. What decides here is how much of the *resonance* is lost. For partials that lie
//! within each other's half-bandwidths,
//!
//! ```text
//! s[n] = Σ c_i z_iⁿ      loss = min_{c, z} ‖s − c zⁿ‖² / ‖s‖²
//! ```
//! all in closed form ([`geometric_sums`]); the group that loses least is tried first, and stays
//! merged if the refitted loss is under [`MERGED_LOSS`]. Real doublets beat: merging two equal
//! modes 1 Hz apart with a T60 of 2 s loses 5 %. Used only on recordings whose residual is more
//! than noise, so that what *is* a sum of exponentials in noise keeps every mode that the data
//! prove.

use crate::proof::suspicion::cancels;
use crate::sinusoid::geometric_sum::geometric_sums;
use crate::sinusoid::partial::Partial;
use crate::sinusoid::projection::synthesise;
use crate::sinusoid::refinement::{Bounds, refine};
use nalgebra::Complex;

type C = Complex<f64>;

/// Largest part of a resonance's energy that its one mode may miss: 18 dB, a beat of 2 dB.
pub const MERGED_LOSS: f64 = 0.016;
/// Limit for two that all but cancel: what a mode plus rounding turns into when nothing else is
/// left to explain. 50 dB, far below what a real doublet loses.
const CANCELLED_LOSS: f64 = 1e-5;
/// Factor that is tried: the closed form has nothing of what neighbours can take over.
const PROPOSED_LOSS: f64 = 0.06;
/// Refinement steps of a trial.
const REFIT_STEPS: usize = 3;
/// Most partials that are tried as one resonance.
const LARGEST_GROUP: usize = 4;
/// Partials within so many half-bandwidths of the narrower one may be one resonance.
const HALF_WIDTHS: f64 = 3.0;
/// Halvings of the search for the best single pole.
const HALVINGS: usize = 18;

/// Merges what is one resonance in `signal`; says how many partials went.
///
/// The closed form proposes; what decides is the squared residual after the merged partial and its
/// neighbours have been refitted, which may rise by the part `most_lost` of the resonance's energy
/// ([`MERGED_LOSS`], for one).
pub fn merge_resonances(
    signal: &[f64],
    partials: &mut Vec<Partial>,
    bounds: &Bounds,
    most_lost: f64,
) -> usize {
    merge(signal, partials, bounds, most_lost, LARGEST_GROUP, |_| true)
}

/// Merges pairs of giants that all but cancel and are one mode to 50 dB, in any recording: below a
/// noise of −120 dB, rounding alone makes them significant. Says how many partials went.
pub fn merge_cancelling(signal: &[f64], partials: &mut Vec<Partial>, bounds: &Bounds) -> usize {
    merge(signal, partials, bounds, CANCELLED_LOSS, 2, |pair| cancels(&pair[0], &pair[1]))
}

fn merge(
    signal: &[f64],
    partials: &mut Vec<Partial>,
    bounds: &Bounds,
    most_lost: f64,
    largest: usize,
    may: impl Fn(&[Partial]) -> bool,
) -> usize {
    let before = partials.len();
    let mut residual = synthesise(partials, signal.len());
    residual.iter_mut().zip(signal).for_each(|(r, s)| *r = s - *r);
    let mut refused: Vec<Vec<Partial>> = Vec::new();
    let mut merged_one = true;
    while std::mem::take(&mut merged_one) {
        for group in proposals(partials, signal.len(), largest, &may) {
            // A group whose members were refitted meanwhile is proposed again in the next round.
            if refused.contains(&group.parts) || !group.parts.iter().all(|p| partials.contains(p)) {
                continue;
            }
            match tried(&residual, partials, &group, bounds, most_lost) {
                Some((merged, left)) => {
                    *partials = merged;
                    residual = left;
                    merged_one = true;
                }
                None => refused.push(group.parts),
            }
        }
    }
    before - partials.len()
}

/// Partials that may be one.
struct Group {
    parts: Vec<Partial>,
    merged: Partial,
    loss: f64,
    energy: f64,
}

/// The partials with the group replaced, and the residual then; `None` when too much is lost.
fn tried(
    residual: &[f64],
    partials: &[Partial],
    group: &Group,
    bounds: &Bounds,
    most_lost: f64,
) -> Option<(Vec<Partial>, Vec<f64>)> {
    let count = residual.len();
    let others = |p: &Partial| !group.parts.contains(p);
    let (near, far): (Vec<Partial>, Vec<Partial>) =
        partials.iter().filter(|p| others(p)).partition(|p| touches(p, &group.merged, count));
    let mut target = synthesise(&[group.parts.as_slice(), &near].concat(), count);
    target.iter_mut().zip(residual).for_each(|(t, r)| *t += r);
    let mut local = near;
    local.push(group.merged);
    let refitted = refine(&target, &mut local, bounds, REFIT_STEPS);
    let energy = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let lost = energy(&refitted.residual) - energy(residual);
    // Σ |c zⁿ|² is twice the energy of the real signal.
    if lost > most_lost * 0.5 * group.energy {
        return None;
    }
    local.extend(far);
    local.sort_by(|a, b| a.omega.total_cmp(&b.omega));
    Some((local, refitted.residual))
}

/// Groups that may be one resonance, least loss first.
fn proposals(
    partials: &[Partial],
    count: usize,
    largest: usize,
    may: &impl Fn(&[Partial]) -> bool,
) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for k in 0..partials.len() {
        let near = around(partials, k, count);
        // Two halves can each be further from one exponential than their sum with a third.
        for size in 2..=near.len().min(largest) {
            let mut parts: Vec<Partial> = near[..size].iter().map(|&i| partials[i]).collect();
            parts.sort_by(|a, b| a.omega.total_cmp(&b.omega));
            if !may(&parts) {
                continue;
            }
            let (loss, energy, merged) = single(parts.clone(), count);
            if loss < PROPOSED_LOSS && groups.iter().all(|g| g.parts != parts) {
                groups.push(Group { parts, merged, loss, energy });
            }
        }
    }
    groups.sort_by(|a, b| a.loss.total_cmp(&b.loss));
    groups
}

/// Tests whether two partials lie within their half-bandwidths, or within three of the narrower
/// one.
fn touches(a: &Partial, b: &Partial, count: usize) -> bool {
    let gap = (a.omega - b.omega).abs();
    gap <= (a.delta + b.delta + 1.0 / count as f64).max(HALF_WIDTHS * a.delta.min(b.delta))
}

/// `k` and those that touch it, nearest pole first, at most [`LARGEST_GROUP`].
fn around(partials: &[Partial], k: usize, count: usize) -> Vec<usize> {
    let own = &partials[k];
    let gap = |i: usize| (partials[i].omega - own.omega).hypot(partials[i].delta - own.delta);
    let mut near: Vec<usize> = (0..partials.len()).filter(|&i| touches(&partials[i], own, count)).collect();
    near.sort_by(|&a, &b| gap(a).total_cmp(&gap(b)));
    near.truncate(LARGEST_GROUP);
    near
}

/// The part of the energy of a sum that the one partial nearest to it misses, that energy, and the
/// partial.
pub(crate) fn single(parts: Vec<Partial>, count: usize) -> (f64, f64, Partial) {
    let widest = parts.iter().map(|p| p.delta).fold(1.0 / count as f64, f64::max);
    let sum = Sum { parts, count };
    let energy = sum.energy();
    let nearest = sum.parts[0];
    if energy <= 1e-300 {
        return (1.0, energy, nearest);
    }
    let starts = sum.parts.iter().map(|p| (sum.explained(p.omega, p.delta), p.omega, p.delta));
    let mut best = starts.fold((-1.0, 0.0, 0.0), |best, next| if next.0 > best.0 { next } else { best });
    let mut step = widest;
    for _ in 0..HALVINGS {
        // A step that helps is tried again, so that the search can walk.
        for _ in 0..8 {
            let (_, omega, delta) = best;
            let tried = [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step)].map(|(dw, dd)| {
                let (omega, delta) = (omega + dw, (delta + dd).max(0.0));
                (sum.explained(omega, delta), omega, delta)
            });
            let next = tried.into_iter().fold(best, |best, next| if next.0 > best.0 { next } else { best });
            if next.0 <= best.0 {
                break;
            }
            best = next;
        }
        step *= 0.5;
    }
    let (explained, omega, delta) = best;
    (1.0 - explained / energy, energy, Partial { omega, delta, c: sum.amplitude(omega, delta) })
}

/// Σ c zⁿ over `count` samples.
struct Sum {
    parts: Vec<Partial>,
    count: usize,
}

impl Sum {
    /// Σ conj(zᵃⁿ) zᵇⁿ.
    fn product(&self, a: &Partial, b: &Partial) -> C {
        let n = self.count as f64;
        geometric_sums(a.pole().conj() * b.pole(), a.power(n).conj() * b.power(n), self.count)[0]
    }

    fn energy(&self) -> f64 {
        let cross = |a: &Partial, b: &Partial| (a.c.conj() * b.c * self.product(a, b)).re;
        self.parts.iter().map(|a| self.parts.iter().map(|b| cross(a, b)).sum::<f64>()).sum()
    }

    fn amplitude(&self, omega: f64, delta: f64) -> C {
        let pole = Partial { omega, delta, c: C::new(1.0, 0.0) };
        let pull: C = self.parts.iter().map(|p| p.c * self.product(&pole, p)).sum();
        pull / self.product(&pole, &pole).re
    }

    fn explained(&self, omega: f64, delta: f64) -> f64 {
        let pole = Partial { omega, delta, c: C::new(1.0, 0.0) };
        self.amplitude(omega, delta).norm_sqr() * self.product(&pole, &pole).re
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 44_100.0;

    fn partial(hz: f64, decay_per_s: f64, amplitude: f64, phase: f64) -> Partial {
        Partial {
            omega: 2.0 * std::f64::consts::PI * hz / RATE_HZ,
            delta: decay_per_s / RATE_HZ,
            c: C::from_polar(amplitude, phase),
        }
    }

    #[test]
    fn three_partials_that_mend_one_decay_become_one() {
        // What the fit once made of a vibraphone bar.
        let mut partials = vec![
            partial(1254.3, 4.1, 0.6, 0.1),
            partial(1254.77, 3.2, 0.35, -0.2),
            partial(1255.7, 17.0, 0.08, 2.5),
            partial(1300.0, 3.0, 0.1, 0.0),
        ];
        let signal = synthesise(&partials, 88_200);
        assert_eq!(merge_resonances(&signal, &mut partials, &Bounds::wide(), MERGED_LOSS), 2);
        let hz = partials[0].omega * RATE_HZ / (2.0 * std::f64::consts::PI);
        assert!((hz - 1254.45).abs() < 0.3, "{hz}");
    }

    #[test]
    fn giants_that_cancel_become_the_mode_they_are() {
        // What the fit once made of a struck body without any noise.
        let mut giants = vec![
            partial(861.3580, 93.1477, 0.859_775_4, 1.749_905),
            partial(861.3601, 93.1722, 0.851_372_2, -1.389_568),
            partial(900.0, 20.0, 0.01, 0.0),
        ];
        let signal = synthesise(&giants, 66_150);
        assert_eq!(merge_cancelling(&signal, &mut giants, &Bounds::wide()), 1, "{giants:?}");
        assert!(giants.iter().all(|p| p.c.norm() < 0.02), "{giants:?}");
    }

    #[test]
    fn doublets_that_beat_stay_two() {
        for (gap_hz, level) in [(1.0, 1.0), (2.0, 0.3), (4.0, 0.2)] {
            let mut pair = vec![partial(700.0, 3.45, 1.0, 0.3), partial(700.0 + gap_hz, 3.45, level, 1.0)];
            let signal = synthesise(&pair, 88_200);
            assert_eq!(
                merge_resonances(&signal, &mut pair, &Bounds::wide(), MERGED_LOSS),
                0,
                "{gap_hz} Hz, {level}"
            );
            pair[1].c = -level * pair[0].c;
            let signal = synthesise(&pair, 88_200);
            assert_eq!(merge_cancelling(&signal, &mut pair, &Bounds::wide()), 0, "{gap_hz} Hz, {level}");
        }
    }

    #[test]
    fn halves_of_one_mode_are_put_together_exactly() {
        let mut halves = vec![partial(500.0, 5.0, 0.4, 0.7), partial(500.0, 5.0, 0.6, 0.7)];
        let signal = synthesise(&halves, 44_100);
        assert_eq!(merge_resonances(&signal, &mut halves, &Bounds::wide(), MERGED_LOSS), 1);
        assert!((halves[0].c - C::from_polar(1.0, 0.7)).norm() < 1e-6, "{halves:?}");
    }
}
