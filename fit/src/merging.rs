//! One resonance, one mode: partials that only together describe one decay become one.
//!
//! A real resonance is an exponential to 20–40 dB. Over noise far below that, every criterion that
//! knows noise alone (noise edge, Wald, Rao) spends two or three partials on the rest: a decay of 0.4 dB
//! rms off the exponential came out as three modes within 1.4 Hz, the strongest with half its true T60.
//! What decides here is how much of the *resonance* is lost. For partials that lie within each other's
//! half-bandwidths,
//!
//! ```text
//! s[n] = Σ c_i z_iⁿ      loss = min_{c, z} ‖s − c zⁿ‖² / ‖s‖²
//! ```
//! all in closed form ([`geometric_sums`]); the group that loses least is merged first, as long as the
//! loss stays under [`MERGED_LOSS`]. Real doublets beat: merging two equal modes 1 Hz apart with a T60 of
//! 2 s loses 5 %. Used only on recordings whose residual is more than noise, so that what *is*
//! a sum of exponentials in noise keeps every mode that the data prove.

use crate::geometric_sum::geometric_sums;
use crate::partial::Partial;
use nalgebra::Complex;

type C = Complex<f64>;

/// Largest part of a resonance's energy that its one mode may miss: 18 dB, a beat of 2 dB.
pub const MERGED_LOSS: f64 = 0.016;
/// Most partials that are tried as one resonance.
const LARGEST_GROUP: usize = 4;
/// Halvings of the search for the best single pole.
const HALVINGS: usize = 18;

/// Merges what is one resonance; says how many partials went. `loss` is [`MERGED_LOSS`] or a caller's own.
pub fn merge_resonances(partials: &mut Vec<Partial>, count: usize, loss: f64) -> usize {
    let before = partials.len();
    while let Some((gone, merged)) = best_group(partials, count, loss) {
        for &k in gone.iter().rev() {
            partials.remove(k);
        }
        partials.push(merged);
        partials.sort_by(|a, b| a.omega.total_cmp(&b.omega));
    }
    before - partials.len()
}

/// The group (ascending) whose merging loses least, and what it becomes.
fn best_group(partials: &[Partial], count: usize, most: f64) -> Option<(Vec<usize>, Partial)> {
    let mut best: Option<(f64, Vec<usize>, Partial)> = None;
    for k in 0..partials.len() {
        let near = around(partials, k, count);
        // Two halves can each be further from one exponential than their sum with a third.
        for size in 2..=near.len() {
            let parts: Vec<Partial> = near[..size].iter().map(|&i| partials[i]).collect();
            let (loss, merged) = single(parts, count);
            if loss < best.as_ref().map_or(most, |best| best.0) {
                let mut group = near[..size].to_vec();
                group.sort_unstable();
                best = Some((loss, group, merged));
            }
        }
    }
    best.map(|(_, group, merged)| (group, merged))
}

/// `k` and those its half-bandwidth touches, nearest pole first, at most [`LARGEST_GROUP`].
fn around(partials: &[Partial], k: usize, count: usize) -> Vec<usize> {
    let own = &partials[k];
    let gap = |i: usize| (partials[i].omega - own.omega).hypot(partials[i].delta - own.delta);
    let touches = |i: &usize| {
        let other = &partials[*i];
        (other.omega - own.omega).abs() <= other.delta + own.delta + 1.0 / count as f64
    };
    let mut near: Vec<usize> = (0..partials.len()).filter(touches).collect();
    near.sort_by(|&a, &b| gap(a).total_cmp(&gap(b)));
    near.truncate(LARGEST_GROUP);
    near
}

/// The one partial nearest to the sum of several, and the part of the sum's energy it misses.
fn single(parts: Vec<Partial>, count: usize) -> (f64, Partial) {
    let widest = parts.iter().map(|p| p.delta).fold(1.0 / count as f64, f64::max);
    let sum = Sum { parts, count };
    let energy = sum.energy();
    let nearest = sum.parts[0];
    if energy <= 1e-300 {
        return (1.0, nearest);
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
    (1.0 - explained / energy, Partial { omega, delta, c: sum.amplitude(omega, delta) })
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
        assert_eq!(merge_resonances(&mut partials, 88_200, MERGED_LOSS), 2);
        let hz = partials[0].omega * RATE_HZ / (2.0 * std::f64::consts::PI);
        assert!((hz - 1254.45).abs() < 0.3, "{hz}");
    }

    #[test]
    fn doublets_that_beat_stay_two() {
        for (gap_hz, level) in [(1.0, 1.0), (2.0, 0.3), (4.0, 0.2)] {
            let mut pair = vec![partial(700.0, 3.45, 1.0, 0.3), partial(700.0 + gap_hz, 3.45, level, 1.0)];
            assert_eq!(merge_resonances(&mut pair, 88_200, MERGED_LOSS), 0, "{gap_hz} Hz, {level}");
        }
    }

    #[test]
    fn halves_of_one_mode_are_put_together_exactly() {
        let mut halves = vec![partial(500.0, 5.0, 0.4, 0.7), partial(500.0, 5.0, 0.6, 0.7)];
        assert_eq!(merge_resonances(&mut halves, 44_100, MERGED_LOSS), 1);
        assert!((halves[0].c - C::from_polar(1.0, 0.7)).norm() < 1e-6, "{halves:?}");
    }
}
