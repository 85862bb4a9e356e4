//! The decision: the class whose templates make a noisy percept most likely.
//!
//! ```text
//! x = f + κ σ N(0, 1)        p(x | class) = mean over templates t of Π N(x; t, (κσ)² + 2 c²)
//! ```
//! f, t: features of what is asked and of a template; σ: the observer's deviation; c: what chance
//! alone makes of the level of a noise that is listened to for so long, known from theory, for both
//! sides. Nothing is fitted. Features that a trial or a template does not have are left out of
//! their product.

use crate::observer::constants::LAPSE;
use asperity_dsp::rng::Rng;

/// One thing known of a signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feature {
    /// Mostly dB; NaN where there is none.
    pub value: f64,
    /// The observer's own deviation at κ = 1.
    pub sd: f64,
    /// Effect of chance alone.
    pub chance: f64,
}

/// All that is known of one trial.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Percept {
    /// In the same order for every trial of a condition.
    pub features: Vec<Feature>,
}

impl Percept {
    /// Two senses together.
    #[must_use]
    pub fn and(mut self, other: &Self) -> Self {
        self.features.extend_from_slice(&other.features);
        self
    }

    /// Distance between two percepts in units of the observer's deviation (κ = 1).
    #[must_use]
    pub fn d_prime(&self, other: &Self) -> f64 {
        let apart = |(a, b): (&Feature, &Feature)| ((a.value - b.value) / a.sd).powi(2);
        let known = self.features.iter().zip(&other.features);
        known.map(apart).filter(|x| x.is_finite()).sum::<f64>().sqrt()
    }

    pub(crate) fn noisy(&self, kappa: f64, rng: &mut Rng) -> Self {
        let feature = |f: &Feature| Feature { value: f.value + kappa * f.sd * rng.normal(), ..*f };
        Self { features: self.features.iter().map(feature).collect() }
    }
}

/// An observer that has learnt some classes.
#[derive(Debug, Clone)]
pub struct Judge {
    classes: Vec<Vec<Percept>>,
    kappa: f64,
}

impl Judge {
    /// Learns each class from its templates; κ scales the observer's noise, 0 is none.
    #[must_use]
    pub fn new(classes: Vec<Vec<Percept>>, kappa: f64) -> Self {
        Self { classes, kappa }
    }

    /// The class that a trial is taken for.
    pub fn answer(&self, trial: &Percept, rng: &mut Rng) -> usize {
        let lapsed = self.kappa > 0.0 && rng.uniform() < LAPSE;
        let guess = (rng.uniform() * self.classes.len() as f64) as usize;
        let seen = trial.noisy(self.kappa, rng);
        if lapsed {
            return guess;
        }
        let likelihoods: Vec<f64> =
            self.classes.iter().map(|templates| self.likelihood(&seen, templates)).collect();
        let best = |a: &usize, b: &usize| likelihoods[*a].total_cmp(&likelihoods[*b]);
        (0..likelihoods.len()).max_by(best).unwrap_or(guess)
    }

    /// ln p(x | class)
    fn likelihood(&self, seen: &Percept, templates: &[Percept]) -> f64 {
        let each: Vec<f64> = templates.iter().map(|template| self.kernel(seen, template)).collect();
        let top = each.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        top + (each.iter().map(|x| (x - top).exp()).sum::<f64>() / each.len().max(1) as f64).ln()
    }

    /// ln Π N, without the constant, by as much as there are features to compare.
    fn kernel(&self, seen: &Percept, template: &Percept) -> f64 {
        let (mut sum, mut known) = (0.0, 0usize);
        for (x, t) in seen.features.iter().zip(&template.features) {
            let variance = (self.kappa * x.sd).powi(2) + x.chance.powi(2) + t.chance.powi(2);
            let term = -0.5 * (x.value - t.value).powi(2) / variance.max(1e-6);
            if term.is_finite() {
                sum += term;
                known += 1;
            }
        }
        sum * seen.features.len() as f64 / known.max(1) as f64
    }
}

/// Which class was taken for which.
#[derive(Debug, Clone, PartialEq)]
pub struct Confusion {
    /// Rows: what was asked. Columns: what was answered.
    pub counts: Vec<Vec<u32>>,
}

impl Confusion {
    /// Asks every trial of every class `repeats` times, with fresh noise of the observer each time.
    #[must_use]
    pub fn of(judge: &Judge, trials: &[Vec<Percept>], repeats: usize, seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let classes = judge.classes.len();
        let mut counts = vec![vec![0; classes]; trials.len()];
        for (row, trials) in counts.iter_mut().zip(trials) {
            for trial in trials {
                for _ in 0..repeats {
                    row[judge.answer(trial, &mut rng)] += 1;
                }
            }
        }
        Self { counts }
    }

    /// Share of right answers of a class.
    #[must_use]
    pub fn right(&self, class: usize) -> f64 {
        f64::from(self.counts[class][class]) / f64::from(self.counts[class].iter().sum::<u32>().max(1))
    }

    /// Share of right answers of all classes.
    #[must_use]
    pub fn mean(&self) -> f64 {
        (0..self.counts.len()).map(|class| self.right(class)).sum::<f64>() / self.counts.len() as f64
    }
}
