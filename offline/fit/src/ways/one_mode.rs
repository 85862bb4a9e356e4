//! One mode for one resonance, at the end of an analysis from the tail.
//!
//! The stages each describe a resonance as it is from their beginning on, so that one whose first
//! milliseconds are no part of its decay (the striker, the room) comes out as its mode and a few
//! faster ones beside it, which sum to the right wave and mean nothing apart: given other decays
//! (`--material`) they cancel or double it. Of two modes within three half widths of the narrower
//! one
//!
//! | | becomes | as long as it costs, of the two's energy |
//! |---|---|---|
//! | one is of the tail | that one, as it is | 10 dB |
//! | one rings on and the other falls at least 2.5 times as fast | the slower one, as it is | 10 dB |
//! | both are over soon | the one mode nearest to their sum | 10 dB |
//! | both ring on | the same, if its decay is the longer one's to a seventh | 16 dB |
//!
//! What falls by 2 nepers in 50 ms is over soon. Two that ring on alike are given 16 dB in the
//! first row too: they may beat, and a doublet that does loses more. The cheapest go first, and all
//! together may cost 1 dB of signal to error, or what leaves 20 dB of it.

use crate::search::limits::Limits;
use crate::sinusoid::partial::Partial;
use crate::sinusoid::refinement::{Bounds, refine};
use crate::ways::analysis::subtract;
use crate::ways::merging::single;

/// One resonance lies within so many half widths.
const HALF_WIDTHS: f64 = 3.0;
/// A mode that falls so many times as fast as another does not beat with it.
const FASTER: f64 = 2.5;
/// Over soon is what falls by so many nepers within so long, s.
const OVER_NEPERS: f64 = 2.0;
const OVER_S: f64 = 0.05;
/// Cost of one mode in place of two, as a part of their energy; the same where they may beat.
const BESIDE: f64 = 0.1;
const BEATING: f64 = 0.025;
/// By how much the decay of what rings on may change.
const SAME_DECAY: f64 = 0.15;
/// Cost of all: so many times the squared residual, or what leaves so much of the sound.
const COST: f64 = 1.26;
const LEFT: f64 = 0.01;
/// Most rounds, and steps of the refit after each.
const ROUNDS: usize = 10;
const STEPS: usize = 4;

/// Makes one mode of what is one resonance in `attack`; `target` is the `segment` without its
/// `tail`, whose modes stay as they are.
pub(crate) fn one_mode_each(
    segment: &[f64],
    target: &[f64],
    tail: &[Partial],
    attack: &mut Vec<Partial>,
    limits: &Limits,
    bounds: &Bounds,
) {
    let energy = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let may_leave = (COST * energy(&subtract(target, attack))).max(LEFT * energy(segment));
    for _ in 0..ROUNDS {
        let budget = may_leave - energy(&subtract(target, attack));
        let all = [tail, attack.as_slice()].concat();
        let view =
            View { all: &all, tail: tail.len(), count: segment.len(), rate_hz: limits.rate_hz, bounds };
        let Some(fewer) = view.fewer(budget) else { break };
        *attack = fewer;
        refine(target, attack, bounds, STEPS);
    }
}

/// All modes, those of the tail first.
struct View<'a> {
    all: &'a [Partial],
    tail: usize,
    count: usize,
    rate_hz: f64,
    bounds: &'a Bounds,
}

/// Two that may be one.
struct Pair {
    parts: [usize; 2],
    one: Partial,
    /// In energy, and as a part of that of the two.
    cost: f64,
    share: f64,
}

impl View<'_> {
    /// The modes that are not of the tail, fewer by what `budget` allows, each in one pair at most;
    /// `None` if there is nothing to do.
    fn fewer(&self, budget: f64) -> Option<Vec<Partial>> {
        let mut pairs: Vec<Pair> =
            (self.tail..self.all.len()).flat_map(|b| (0..b).filter_map(move |a| self.pair([a, b]))).collect();
        pairs.sort_by(|a, b| a.share.total_cmp(&b.share));
        let (mut gone, mut spent) = (vec![false; self.all.len()], 0.0);
        let mut ones = Vec::new();
        for pair in pairs {
            let free = pair.parts.iter().all(|&k| k < self.tail || !gone[k]);
            if !free || spent + pair.cost > budget {
                continue;
            }
            spent += pair.cost;
            pair.parts.iter().for_each(|&k| gone[k] = true);
            // One of the tail stays where it is.
            if pair.parts[0] >= self.tail {
                ones.push(pair.one);
            }
        }
        let kept = (self.tail..self.all.len()).filter(|&k| !gone[k]).map(|k| self.all[k]);
        let mut fewer: Vec<Partial> = kept.chain(ones).collect();
        fewer.sort_by(|a, b| a.omega.total_cmp(&b.omega));
        (fewer.len() < self.all.len() - self.tail).then_some(fewer)
    }

    /// The two as one, if that costs little; only the first can be of the tail.
    fn pair(&self, parts: [usize; 2]) -> Option<Pair> {
        let [a, b] = parts.map(|k| self.all[k]);
        let of_tail = parts[0] < self.tail;
        let (slow, fast) = if a.delta < b.delta { (a, b) } else { (b, a) };
        if (a.omega - b.omega).abs() >= HALF_WIDTHS * slow.delta.max(1.0 / self.count as f64) {
            return None;
        }
        let rings_on = slow.delta < OVER_NEPERS / (OVER_S * self.rate_hz);
        let alike = fast.delta < FASTER * slow.delta;
        let (loss, squares, nearest) = single(vec![a, b], self.count);
        // Σ |c zⁿ|² is twice the energy of the real signal.
        let energy = 0.5 * squares;
        let (one, cost) = if of_tail {
            (a, b.energy(self.count))
        } else if rings_on && !alike {
            (slow, fast.energy(self.count))
        } else {
            (nearest, loss * energy)
        };
        let decay_stays = (one.delta / slow.delta - 1.0).abs() <= SAME_DECAY;
        if (!of_tail && rings_on && !decay_stays) || !self.bounds.allow(&one) {
            return None;
        }
        let share = cost / energy.max(1e-300);
        let most = if rings_on && alike { BEATING } else { BESIDE };
        (share <= most).then_some(Pair { parts, one, cost, share })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sinusoid::projection::synthesise;
    use nalgebra::Complex;
    use std::f64::consts::PI;

    const RATE_HZ: f64 = 44_100.0;

    fn partial(hz: f64, decay_per_s: f64, amplitude: f64, phase: f64) -> Partial {
        Partial {
            omega: 2.0 * PI * hz / RATE_HZ,
            delta: decay_per_s / RATE_HZ,
            c: Complex::from_polar(amplitude, phase),
        }
    }

    /// Remainder of `attack` beside `tail` in their own sum and a little noise.
    fn left(tail: &[Partial], attack: &[Partial]) -> Vec<Partial> {
        let mut segment = synthesise(&[tail, attack].concat(), 44_100);
        let mut rng = asperity_dsp::rng::Rng::new(3);
        segment.iter_mut().for_each(|x| *x += 0.01 * rng.normal());
        let target = subtract(&segment, tail);
        let limits = Limits {
            bounds: Bounds::wide(),
            max_partials: 10,
            kept: 10,
            least_energy: 0.0,
            threads: 1,
            rate_hz: RATE_HZ,
            least_noise: 0.0,
        };
        let mut attack = attack.to_vec();
        one_mode_each(&segment, &target, tail, &mut attack, &limits, &Bounds::wide());
        attack
    }

    #[test]
    fn a_bar_that_begins_with_its_mallet_is_one_decaying_mode() {
        let bar = partial(1254.5, 3.4, 0.7, 0.1);
        assert_eq!(left(&[bar], &[partial(1255.2, 40.0, 0.15, -2.6)]), []);
        // Found in one stage: the same.
        let kept = left(&[], &[bar, partial(1255.2, 40.0, 0.15, -2.6)]);
        assert_eq!(kept.len(), 1, "{kept:?}");
        assert!((kept[0].delta / bar.delta - 1.0).abs() < 0.1, "{kept:?}");
    }

    #[test]
    fn doublets_that_beat_stay_two_beside_the_tail_and_after_it() {
        let (a, b) = (partial(700.0, 3.45, 1.0, 0.3), partial(701.0, 3.45, 0.8, 1.0));
        assert_eq!(left(&[a], &[b]).len(), 1);
        assert_eq!(left(&[], &[a, b]).len(), 2);
    }

    #[test]
    fn modes_apart_stay_apart() {
        let two = [partial(700.0, 60.0, 1.0, 0.3), partial(760.0, 80.0, 0.8, 1.0)];
        assert_eq!(left(&[], &two).len(), 2);
    }
}
