//! Variation: equal impacts that do not sound the same again.
//!
//! | body | impact at variation v, with ξ ~ N(0, 1) drawn for each |
//! |---|---|
//! | has strike positions | (1 − v) of it at the position asked for, v of it at another: never one twice in a row |
//! | has shapes | at the place asked for + v · [`SPREAD`] · size · ξ along each axis |
//! | neither | the first row with takes that are made: each of its modes as [`SPREAD`] · size · ξ away from where the body is struck |
//!
//! A shape near a place p is a wave, φ(p + δ) = φ(p) cos kδ + ξ sin kδ, whose k grows with the root
//! of the frequency as in plates and bars; half a wave of the lowest mode is as long as the body.
//! Blows on the last two are a tenth harder or softer (contact time · exp(v · [`HARDER`] · ξ)); what
//! was recorded holds that already. Both numbers are assumed. Bands of noise begin with a seed of
//! their own each time.

use crate::model::modal_model::ModalModel;
use asperity_dsp::rng::Rng;
use std::borrow::Cow;
use std::f64::consts::PI;

/// Spread of the places that somebody hits who means one, in sizes of the body.
const SPREAD: f64 = 0.02;
/// Spread of the logarithm of the contact time.
const HARDER: f64 = 0.1;
/// Takes that are made for a body that has none, besides its own.
const MADE: usize = 7;

/// Draws for the impacts on one body.
#[derive(Debug, Clone)]
pub(crate) struct Variation {
    amount: f64,
    rng: Rng,
    /// Takes to choose from, the first included; 1 for a body with shapes.
    takes: usize,
    recorded: bool,
    last: Option<usize>,
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
    /// Distance from the place asked for, in sizes of the body.
    pub(crate) aside: [f64; 3],
}

impl Varied {
    /// No difference.
    pub(crate) const NONE: Self = Self { other: (0, 0.0), seed: 0, softer: 1.0, aside: [0.0; 3] };
}

impl Variation {
    /// Draws by `seed`; none at an amount of 0.
    pub(crate) fn new(amount: f64, model: &ModalModel, seed: u64) -> Option<Self> {
        let takes = if needs_takes(model) { 1 + MADE } else { model.position_count() };
        let (recorded, takes) = (model.position_count() > 1, if model.shapes.is_some() { 1 } else { takes });
        (amount > 0.0).then(|| Self { amount, rng: Rng::new(seed ^ 0x7a6b), takes, recorded, last: None })
    }

    /// Differences of the next impact.
    pub(crate) fn draw(&mut self) -> Varied {
        let mut spread = |by: f64| by * self.amount * self.rng.normal();
        let softer = spread(if self.recorded { 0.0 } else { HARDER }).exp();
        let aside = if self.takes > 1 { [0.0; 3] } else { [(); 3].map(|()| spread(SPREAD)) };
        let seed = self.rng.next_u32() | 1;
        Varied { other: (self.another(), self.amount as f32), seed, softer, aside }.of(self.takes)
    }

    /// A take that is not the last one, all others equally likely.
    fn another(&mut self) -> usize {
        let choices = self.takes - usize::from(self.last.is_some() && self.takes > 1);
        let nth = (self.rng.uniform() * choices as f64) as usize;
        let take = nth + usize::from(self.takes > 1 && self.last.is_some_and(|last| nth >= last));
        self.last = Some(take);
        take
    }
}

impl Varied {
    /// A body of one take has no other.
    fn of(self, takes: usize) -> Self {
        if takes > 1 { self } else { Self { other: (0, 0.0), ..self } }
    }
}

/// Tests whether the body is always struck at the same place.
fn needs_takes(model: &ModalModel) -> bool {
    model.shapes.is_none() && model.position_count() == 1
}

/// A model whose impacts vary: with takes where it has none of its own.
pub(crate) fn with_takes(model: &ModalModel, amount: f64, seed: u64) -> Cow<'_, ModalModel> {
    if amount == 0.0 || !needs_takes(model) {
        return Cow::Borrowed(model);
    }
    let mut rng = Rng::new(seed ^ 0x7a6c);
    let lowest_hz = model.modes.iter().fold(f64::INFINITY, |least, mode| least.min(mode.frequency_hz));
    let take = |_| -> Vec<f64> {
        let aside = SPREAD * rng.normal();
        let at = |mode: &asperity_dsp::mode::Mode| {
            let waves = PI * (mode.frequency_hz / lowest_hz).sqrt() * aside;
            mode.amplitude * (waves.cos() + rng.normal() * waves.sin())
        };
        model.modes.iter().map(at).collect()
    };
    let positions = (0..MADE).map(take).collect();
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
        let mut variation = Variation::new(1.0, &family, 5).unwrap();
        let drawn: Vec<usize> = (0..3000).map(|_| variation.draw().other.0).collect();
        assert!(drawn.windows(2).all(|pair| pair[0] != pair[1]));
        for take in 0..3 {
            let share = drawn.iter().filter(|drawn| **drawn == take).count();
            assert!((900..1100).contains(&share), "take {take}: {share} of 3000");
        }
        // What was recorded is as hard as it was.
        assert!((0..100).all(|_| variation.draw().softer == 1.0 && variation.draw().aside == [0.0; 3]));
    }

    #[test]
    fn draws_are_those_of_the_seed_and_nothing_is_drawn_at_zero() {
        let draws = |seed| {
            let mut variation = Variation::new(0.5, &bar(), seed).unwrap();
            [(); 20].map(|()| variation.draw())
        };
        assert_eq!(draws(1), draws(1));
        assert_ne!(draws(1), draws(2));
        assert!(draws(1).iter().all(|varied| varied.other.1 == 0.5 && varied.seed != 0));
        assert!(Variation::new(0.0, &bar(), 1).is_none());
        assert_eq!(with_takes(&bar(), 0.0, 1).position_count(), 1);
    }

    #[test]
    fn made_takes_differ_more_where_modes_are_finer() {
        let body = bar();
        let varied = with_takes(&body, 1.0, 3);
        assert_eq!(varied.position_count(), 1 + MADE);
        let spread_db = |mode: usize| {
            let own = body.modes[mode].amplitude;
            let db = |take: &Vec<f64>| (20.0 * (take[mode] / own).abs().log10()).powi(2);
            (varied.positions.iter().map(db).sum::<f64>() / MADE as f64).sqrt()
        };
        let (low, high) = (spread_db(0), (5..8).map(spread_db).sum::<f64>() / 3.0);
        assert!(low < 1.5 && high > 2.0 * low, "{low} and {high} dB");
        // A body that was recorded more than once keeps its takes.
        let family = varied.clone().into_owned();
        assert_eq!(*with_takes(&family, 1.0, 9), family);
    }
}
