//! Variation: equal impacts that do not sound the same again.
//!
//! | body | impact at variation v, with ξ ~ N(0, 1) drawn for each |
//! |---|---|
//! | whose positions are takes | (1 − v) of it at the one asked for, v of it at another: never one twice in a row |
//! | has shapes | at the place asked for + v · [`SPREAD`] · size · ξ along each axis |
//! | neither | the first row with takes that are made of each position: its modes as [`SPREAD`] · size · ξ away from there |
//!
//! A shape near a place p is a wave, φ(p + δ) = φ(p) cos kδ + ξ sin kδ, whose k grows with the root
//! of the frequency as in plates and bars; half a wave of the lowest mode is as long as the body.
//! Blows on the last two are a tenth harder or softer (contact time · exp(v · [`HARDER`] · ξ));
//! what was recorded holds that already. Both numbers are assumed. Bands of noise begin with a seed
//! of their own each time.

use crate::model::modal_model::{MAX_POSITIONS, ModalModel};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use std::borrow::Cow;
use std::f64::consts::PI;

/// Spread of the places that somebody hits who means one, in sizes of the body.
const SPREAD: f64 = 0.02;
/// Spread of the logarithm of the contact time.
const HARDER: f64 = 0.1;
/// Takes that are made of a position, at most.
const MADE: usize = 7;

/// Draws for the impacts on one body.
#[derive(Debug, Clone)]
pub(crate) struct Variation {
    amount: f64,
    rng: Rng,
    kind: Kind,
    /// Take of the last impact.
    last: Option<usize>,
}

/// Source of what differs.
#[derive(Debug, Clone, Copy)]
enum Kind {
    /// Number of recorded takes, the first included.
    Takes(usize),
    /// Number of positions, and of the takes that were made of each.
    Positions(usize, usize),
    /// Places of its surface, so far apart, m.
    Shapes(f64),
}

impl Kind {
    fn of(model: &ModalModel) -> Self {
        let positions = model.position_count();
        match (&model.shapes, model.takes) {
            (Some(shapes), _) => Self::Shapes(SPREAD * shapes.size_m()),
            (None, true) => Self::Takes(positions),
            (None, false) => Self::Positions(positions, MADE.min((MAX_POSITIONS - positions) / positions)),
        }
    }
}

/// Differences of one impact from the one that was reported.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Varied {
    /// Another of the body's positions, and its share of the impact.
    pub(crate) other: (usize, f32),
    /// Seed of the bands of noise; 0 = the body's own.
    pub(crate) seed: u32,
    /// Factor of the contact time.
    pub(crate) softer: f64,
    /// Distance from the place asked for, m.
    pub(crate) aside_m: [f64; 3],
}

impl Varied {
    /// No difference.
    pub(crate) const NONE: Self = Self { other: (0, 0.0), seed: 0, softer: 1.0, aside_m: [0.0; 3] };
}

impl Variation {
    /// Draws by `seed`; none at an amount of 0.
    pub(crate) fn new(amount: f64, model: &ModalModel, seed: u64) -> Option<Self> {
        let (rng, kind) = (Rng::new(seed ^ 0x7a6b), Kind::of(model));
        (amount > 0.0).then_some(Self { amount, rng, kind, last: None })
    }

    /// Differences of the next impact, at one of the body's positions.
    pub(crate) fn draw(&mut self, asked: usize) -> Varied {
        let seed = self.rng.next_u32() | 1;
        let by = self.amount as f32;
        match self.kind {
            Kind::Takes(takes) => Varied { other: (self.another(takes), by), seed, ..Varied::NONE },
            Kind::Positions(positions, made) => {
                let asked = asked.min(positions - 1);
                let take = self.another(1 + made);
                let other = take.checked_sub(1).map_or(asked, |take| positions + asked * made + take);
                Varied { other: (other, by), seed, softer: self.softer(), ..Varied::NONE }
            }
            Kind::Shapes(spread_m) => {
                let aside_m = [(); 3].map(|()| spread_m * self.amount * self.rng.normal());
                Varied { aside_m, seed, softer: self.softer(), ..Varied::NONE }
            }
        }
    }

    fn softer(&mut self) -> f64 {
        libm::exp(HARDER * self.amount * self.rng.normal())
    }

    /// A take that is not the last one, all others equally likely.
    fn another(&mut self, takes: usize) -> usize {
        let last = self.last.filter(|_| takes > 1);
        let nth = (self.rng.uniform() * (takes - usize::from(last.is_some())) as f64) as usize;
        let take = nth + usize::from(last.is_some_and(|last| nth >= last));
        self.last = Some(take);
        take
    }
}

/// A model whose impacts vary: with takes of each position where it has none and no shapes.
pub(crate) fn with_takes(model: &ModalModel, amount: f64, seed: u64) -> Cow<'_, ModalModel> {
    let Kind::Positions(positions, made) = Kind::of(model) else { return Cow::Borrowed(model) };
    if amount == 0.0 {
        return Cow::Borrowed(model);
    }
    let mut rng = Rng::new(seed ^ 0x7a6c);
    let lowest_hz = model.modes.iter().fold(f64::INFINITY, |least, mode| least.min(mode.frequency_hz));
    let mut take = |position: usize| -> Vec<f64> {
        let aside = SPREAD * rng.normal();
        let at = |mode: Mode| {
            let waves = PI * (mode.frequency_hz / lowest_hz).sqrt() * aside;
            mode.amplitude * (libm::cos(waves) + rng.normal() * libm::sin(waves))
        };
        model.modes_at(position).map(at).collect()
    };
    let takes = (0..positions).flat_map(|position| std::iter::repeat_n(position, made));
    let made: Vec<Vec<f64>> = takes.map(&mut take).collect();
    let positions = model.positions.iter().cloned().chain(made).collect();
    Cow::Owned(ModalModel { positions, ..model.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::material::Material;
    use crate::model::stock::Stock;

    fn bar() -> ModalModel {
        Stock::Bar.modes(&Material::STEEL, 0.3).unwrap()
    }

    #[test]
    fn no_take_comes_twice_in_a_row_and_all_come_equally_often() {
        let amplitudes = |gain: f64| bar().modes.iter().map(|mode| gain * mode.amplitude).collect();
        let family = bar().with_positions(vec![amplitudes(0.9), amplitudes(1.1)]).unwrap();
        let mut variation = Variation::new(1.0, &ModalModel { takes: true, ..family }, 5).unwrap();
        let drawn: Vec<usize> = (0..3000).map(|_| variation.draw(0).other.0).collect();
        assert!(drawn.windows(2).all(|pair| pair[0] != pair[1]));
        for take in 0..3 {
            let share = drawn.iter().filter(|drawn| **drawn == take).count();
            assert!((900..1100).contains(&share), "take {take}: {share} of 3000");
        }
        // What was recorded is as hard as it was.
        assert!((0..100).all(|_| variation.draw(0).softer == 1.0));
    }

    #[test]
    fn places_keep_takes_of_their_own() {
        let body = bar();
        let [positions, most] = [body.position_count(), with_takes(&body, 1.0, 3).position_count()];
        assert_eq!([positions, most], [3, 3 + 3 * 4]);
        let mut variation = Variation::new(1.0, &body, 5).unwrap();
        for asked in [0, 1, 2, 9] {
            let own = asked.min(2);
            let takes: Vec<usize> = (0..200).map(|_| variation.draw(asked).other.0).collect();
            let is_own = |take: usize| take == own || (3 + 4 * own..7 + 4 * own).contains(&take);
            assert!(takes.iter().all(|take| is_own(*take)), "{asked}: {takes:?}");
        }
    }

    #[test]
    fn draws_are_those_of_the_seed_and_nothing_is_drawn_at_zero() {
        let draws = |seed| {
            let mut variation = Variation::new(0.5, &bar(), seed).unwrap();
            [(); 20].map(|()| variation.draw(0))
        };
        assert_eq!(draws(1), draws(1));
        assert_ne!(draws(1), draws(2));
        assert!(draws(1).iter().all(|varied| varied.other.1 == 0.5 && varied.seed != 0));
        assert!(Variation::new(0.0, &bar(), 1).is_none());
        assert_eq!(with_takes(&bar(), 0.0, 1).position_count(), 3);
    }

    #[test]
    fn made_takes_differ_more_where_modes_are_finer() {
        let body = bar();
        let varied = with_takes(&body, 1.0, 3);
        let spread_db = |mode: usize| {
            let own = body.modes[mode].amplitude;
            let db = |take: &Vec<f64>| (20.0 * (take[mode] / own).abs().log10()).powi(2);
            (varied.positions[2..6].iter().map(db).sum::<f64>() / 4.0).sqrt()
        };
        let (low, high) = (spread_db(0), (5..8).map(spread_db).sum::<f64>() / 3.0);
        assert!(low < 1.5 && high > 2.0 * low, "{low} and {high} dB");
        // A body that was recorded more than once keeps its takes.
        let family = ModalModel { takes: true, ..bar() };
        assert_eq!(*with_takes(&family, 1.0, 9), family);
    }
}
