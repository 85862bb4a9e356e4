//! Likeness of surfaces to the touch: the strokes of [`abx`], felt by the
//! [`observer`](crate::observer) with people's thresholds and difference limens.
//!
//! ```text
//! d′² = xᵀ C⁻¹ x      x = m_a − m_b,  C = diag(σ² + (v_a + v_b)/2) + σ̄² 1 1ᵀ over the third octaves
//! ```
//! m, v: mean and variance of a feature over the strokes of a surface; σ: the observer's own
//! deviation, σ̄ their mean: a level that changes in all bands at once is noticed no better than
//! one that changes in a single band (ours; of independent bands, two cuts of one surface that
//! differ by 2 dB lay further apart than two materials). d′ is what one stroke gives somebody who
//! knows both surfaces: 1 is about a just noticeable difference. Both surfaces are stroked at the
//! same places, directions, speeds and forces, so that a surface is at distance 0 from itself.

use crate::abx::{self, FOLDS, RATE_HZ, Size};
use crate::observer::constants::THIRD_OCTAVES;
use crate::observer::touch::{Unit, felt};
use crate::observer::{Judge, Percept};
use asperity::files::FileError;
use asperity_dsp::rng::Rng;
use asperity_pictures::borders::Borders;
use asperity_surface::raster::Raster;

/// Samples of a stroke that become one: touch ends at 1 kHz.
const EVERY: usize = 8;

/// Percepts of strokes over a surface (heights 0–1).
///
/// # Errors
/// When the engine refuses the surface.
pub fn percepts(
    heights: &Raster,
    tiles: bool,
    size: Size,
    count: usize,
    seed: u64,
) -> Result<Vec<Percept>, FileError> {
    abx::displacements(heights, tiles, size, (count, seed), |samples| {
        let low = samples.chunks_exact(EVERY).map(|x| x.iter().map(|x| f64::from(*x)).sum::<f64>());
        let low: Vec<f64> = low.map(|sum| sum / EVERY as f64).collect();
        felt(&low, RATE_HZ / EVERY as f64, Unit::Displacement, None)
    })
}

/// Share of strokes that the observer, who has learned from the others, puts on the right surface.
#[must_use]
pub fn right_answers(a: &[Percept], b: &[Percept]) -> f64 {
    let mut rng = Rng::new(1);
    let mut right = 0;
    for fold in 0..FOLDS {
        let (learn_a, test_a) = abx::split(a, fold);
        let (learn_b, test_b) = abx::split(b, fold);
        let judge = Judge::new(vec![learn_a, learn_b], 1.0);
        let mut count = |trials: &[Percept], class| {
            right += trials.iter().filter(|trial| judge.answer(trial, &mut rng) == class).count();
        };
        count(&test_a, 0);
        count(&test_b, 1);
    }
    right as f64 / (a.len() + b.len()).max(1) as f64
}

/// A surface as strokes show it: mean, variance and the observer's deviation of each feature.
#[derive(Debug, Clone)]
pub struct Impression {
    features: Vec<[f64; 3]>,
}

impl Impression {
    /// The impression of `count` strokes over a map (heights 0–1) of this width and relief, m.
    ///
    /// # Errors
    /// When the engine refuses the surface.
    pub fn of(
        map: &Raster,
        width_m: f64,
        relief_m: f64,
        (count, seed): (usize, u64),
    ) -> Result<Self, FileError> {
        let size = Size { texel_m: width_m / map.width as f64, relief_m };
        let tiles = Borders::Detect.decide(map) == Borders::Periodic;
        let percepts = percepts(map, tiles, size, count, seed)?;
        let features = percepts.first().map_or(0, |percept| percept.features.len());
        let moments = |feature: usize| {
            let values = || percepts.iter().map(|percept| percept.features[feature].value);
            let mean = values().sum::<f64>() / count as f64;
            let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / count as f64;
            [mean, variance, percepts[0].features[feature].sd]
        };
        Ok(Self { features: (0..features).map(moments).collect() })
    }

    /// d′ between two surfaces.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        let each = self.features.iter().zip(&other.features);
        let terms: Vec<[f64; 3]> = each
            .map(|([m, v, sd], [n, w, _])| [m - n, 1.0 / (sd * sd + 0.5 * (v + w)), *sd])
            .map(|term| if term[0].is_finite() { term } else { [0.0; 3] })
            .collect();
        let alone: f64 = terms.iter().map(|[x, weight, _]| x * x * weight).sum();
        // Sherman–Morrison.
        let levels = &terms[..THIRD_OCTAVES.min(terms.len())];
        let over = |of: fn(&[f64; 3]) -> f64| levels.iter().map(of).sum::<f64>();
        let common = (over(|[_, _, sd]| *sd) / levels.len().max(1) as f64).powi(2);
        let shift = over(|[x, weight, _]| x * weight).powi(2);
        (alone - common * shift / (1.0 + common * over(|[_, weight, _]| *weight))).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn grid(period: f64, height: f64) -> Raster {
        let wave = |i: usize| (TAU * i as f64 / period).sin();
        Raster::from_fn(64, 64, |x, y| 0.5 + 0.25 * height * (wave(x) + wave(y)))
    }

    #[test]
    fn below_every_threshold_the_observer_sees_one_surface() {
        let size = Size { texel_m: 1.5e-4, relief_m: 1e-7 };
        let strokes = |period, seed| percepts(&grid(period, 1.0), true, size, 60, seed).unwrap();
        let share = right_answers(&strokes(16.0, 1), &strokes(8.0, 2));
        assert!((share - 0.5).abs() < 0.13, "{share}");
        let levels = |period, seed| abx::strokes(&grid(period, 1.0), true, size, 60, seed).unwrap();
        let share = abx::right_answers(&levels(16.0, 1), &levels(8.0, 2));
        assert!(share > 0.9, "{share}");
    }

    #[test]
    fn a_surface_is_nearest_to_itself_and_farther_when_changed() {
        let impression = |height| Impression::of(&grid(8.0, height), 0.0096, 1e-4, (30, 7)).unwrap();
        let original = impression(1.0);
        let distances = [1.0, 0.9, 0.5, 0.1].map(|height| original.distance(&impression(height)));
        assert!(distances[0] == 0.0 && distances.is_sorted(), "{distances:?}");
        // 0.9 dB in all bands is less than what is just noticed, 20 dB are not missed: a level that
        // all bands share counts once.
        assert!(distances[1] < 1.0 && distances[3] > 1.5, "{distances:?}");
    }
}
