//! Arrangement of a surface: correlations of sub-bands with another one's, at no shift.
//!
//! ```text
//! r = mean over λ, μ of  Σ_k Ψ² Re(A B*) / √(Σ_k Ψ² |A|² · Σ_k Ψ² |B|²)
//! ```
//! A, B: spectra of the two surfaces. 1 for the same arrangement at any strength of the bands, 0 for strangers. Bands in which either
//! surface has next to nothing ([`EMPTY_BAND`]) do not count.

use super::EMPTY_BAND;
use crate::pyramid::{Kind, Pyramid};
use crate::raster::Raster;

/// Mean correlation of the oriented sub-bands of two images of the pyramid's size that tile; 0 where they share no band.
pub(super) fn correlation(a: &Raster, b: &Raster, pyramid: &mut Pyramid) -> f64 {
    let (mut spectrum_a, mut spectrum_b) = (Vec::new(), Vec::new());
    pyramid.half_spectrum(&a.values, &mut spectrum_a);
    pyramid.half_spectrum(&b.values, &mut spectrum_b);
    let all: Vec<[f64; 3]> =
        (0..pyramid.subbands().len()).map(|i| pyramid.powers(&spectrum_a, &spectrum_b, i)).collect();
    // What rounding leaves of a mean, at least: a flat surface varies by nothing else.
    let texels = a.values.len() as f64;
    let rounding = |image: &Raster| (f64::EPSILON * texels * image.mean()).powi(2) * texels;
    let least = [(0, a), (2, b)]
        .map(|(of, image)| (EMPTY_BAND.powi(2) * varying(pyramid, &all, of)).max(rounding(image)));
    let mut correlations = Vec::new();
    for (band, [aa, ab, bb]) in pyramid.subbands().iter().zip(all) {
        if matches!(band.kind, Kind::Oriented { .. }) && aa > least[0] && bb > least[1] {
            correlations.push(ab / (aa * bb).sqrt());
        }
    }
    correlations.iter().sum::<f64>() / correlations.len().max(1) as f64
}

/// Power of all sub-bands but the low residual, which holds the mean.
fn varying(pyramid: &Pyramid, all: &[[f64; 3]], of: usize) -> f64 {
    let bands = pyramid.subbands().iter().zip(all);
    bands.filter(|(band, _)| band.kind != Kind::LowResidual).map(|(_, powers)| powers[of]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pyramid::Sampling;
    use asperity_dsp::rng::Rng;

    fn noise(seed: u64) -> Raster {
        let mut rng = Rng::new(seed);
        Raster::from_fn(64, 48, |_, _| 2.0 + rng.normal())
    }

    fn of(a: &Raster, b: &Raster) -> f64 {
        correlation(a, b, &mut Pyramid::new(64, 48, 3, 4, Sampling::Reduced).unwrap())
    }

    #[test]
    fn it_is_that_of_the_sub_bands_themselves() {
        let (a, other) = (noise(1), noise(2));
        let b = Raster::from_fn(64, 48, |x, y| a.at(x, y) + 0.8 * other.at(x, y));
        let mut pyramid = Pyramid::new(64, 48, 3, 4, Sampling::Full).unwrap();
        let (split_a, split_b) = (pyramid.split(&a.values), pyramid.split(&b.values));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let band = |i: usize| {
            let (a, b) = (split_a.get(i), split_b.get(i));
            dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
        };
        let expected = (1..13).map(band).sum::<f64>() / 12.0;
        assert!((of(&a, &b) - expected).abs() < 1e-9, "{} should be {expected}", of(&a, &b));
    }

    #[test]
    fn the_same_arrangement_is_one_at_any_height_and_strangers_are_near_zero() {
        let a = noise(1);
        assert!((of(&a, &a.map(|v| 7.0 - 0.2 * v)) + 1.0).abs() < 1e-12);
        assert!((of(&a, &a) - 1.0).abs() < 1e-12 && of(&a, &noise(2)).abs() < 0.15);
        assert_eq!(of(&a, &Raster::constant(64, 48, 0.5)), 0.0);
    }
}
