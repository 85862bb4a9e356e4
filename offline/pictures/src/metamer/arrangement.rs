//! Arrangement of a surface: correlations of its sub-bands with another one's, in place and at the
//! shift where they are highest.
//!
//! ```text
//! r(d) = mean over λ, μ of  Σ_k Ψ² Re(A B* e^(i k d)) / √(Σ_k Ψ² |A|² · Σ_k Ψ² |B|²)
//! ```
//! A, B: spectra of the two surfaces, d: how far B is moved. 1 for the same arrangement at any
//! strength of the bands, 0 for strangers. All shifts are one inverse transform of the bands' cross
//! spectra. Bands in which either surface has next to nothing ([`EMPTY_BAND`]) do not count. The
//! highest of many thousand shifts is above 0 for strangers too: by the waves of their coarsest
//! band, of which there are a few.

use super::EMPTY_BAND;
use crate::pyramid::{Kind, Pyramid};
use asperity_fft::num_complex::Complex64;
use asperity_surface::raster::Raster;

/// Mean correlations of the oriented sub-bands of two images.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Correlation {
    /// Place of both.
    pub in_place: f64,
    /// The highest of all shifts.
    pub highest: f64,
    /// The second image, moved by this many texels along u and v, is most like the first.
    pub shift_px: [usize; 2],
}

/// Correlations of two images of the pyramid's size that tile; 0 where they share no band.
pub(super) fn correlation(a: &Raster, b: &Raster, pyramid: &mut Pyramid) -> Correlation {
    let (mut spectrum_a, mut spectrum_b) = (Vec::new(), Vec::new());
    pyramid.half_spectrum(&a.values, &mut spectrum_a);
    pyramid.half_spectrum(&b.values, &mut spectrum_b);
    let spectra = [&spectrum_a[..], &spectrum_b[..]];
    let bands = bands_of_both(a, b, spectra, pyramid);
    let share = 1.0 / bands.len().max(1) as f64;
    let in_place = bands.iter().map(|band| share * band.product / band.norm).sum();
    let mut sum = vec![Complex64::default(); spectrum_a.len()];
    let texels = a.values.len() as f64;
    for band in &bands {
        pyramid.add_cross_spectrum(spectra, band.index, share * texels / band.norm, &mut sum);
    }
    let mut by_shift = Vec::new();
    pyramid.image(&sum, &mut by_shift);
    let highest = by_shift.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    let (at, highest) = highest.map_or((0, 0.0), |(at, value)| (at, *value));
    Correlation { in_place, highest, shift_px: [at % a.width, at / a.width] }
}

/// A sub-band that both images have.
struct Band {
    index: usize,
    product: f64,
    /// √ of both powers.
    norm: f64,
}

fn bands_of_both(a: &Raster, b: &Raster, spectra: [&[Complex64]; 2], pyramid: &Pyramid) -> Vec<Band> {
    let all: Vec<[f64; 3]> =
        (0..pyramid.subbands().len()).map(|i| pyramid.powers(spectra[0], spectra[1], i)).collect();
    // What rounding leaves of a mean, at least: a flat surface varies by nothing else.
    let texels = a.values.len() as f64;
    let rounding = |image: &Raster| (f64::EPSILON * texels * image.mean()).powi(2) * texels;
    let least = [(0, a), (2, b)]
        .map(|(of, image)| (EMPTY_BAND.powi(2) * varying(pyramid, &all, of)).max(rounding(image)));
    let oriented = |index: &usize| matches!(pyramid.subbands()[*index].kind, Kind::Oriented { .. });
    let has_both = |[aa, _, bb]: [f64; 3]| aa > least[0] && bb > least[1];
    let band = |index: usize| {
        let [aa, product, bb] = all[index];
        Band { index, product, norm: (aa * bb).sqrt() }
    };
    (0..all.len()).filter(oriented).filter(|&index| has_both(all[index])).map(band).collect()
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

    fn correlations(a: &Raster, b: &Raster) -> Correlation {
        correlation(a, b, &mut Pyramid::new(64, 48, 3, 4, Sampling::Reduced).unwrap())
    }

    fn of(a: &Raster, b: &Raster) -> f64 {
        correlations(a, b).in_place
    }

    fn moved(image: &Raster, by: [usize; 2]) -> Raster {
        let (w, h) = (image.width, image.height);
        Raster::from_fn(w, h, |x, y| image.at((x + w - by[0]) % w, (y + h - by[1]) % h))
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
    fn the_same_arrangement_is_one_and_strangers_near_zero() {
        let a = noise(1);
        assert!((of(&a, &a.map(|v| 7.0 - 0.2 * v)) + 1.0).abs() < 1e-12);
        assert!((of(&a, &a) - 1.0).abs() < 1e-12 && of(&a, &noise(2)).abs() < 0.15);
        assert_eq!(of(&a, &Raster::constant(64, 48, 0.5)), 0.0);
    }

    #[test]
    fn a_surface_that_was_only_moved_is_found_where_it_went() {
        let b = noise(3);
        for by in [[0, 0], [5, 0], [63, 47], [32, 24]] {
            let found = correlations(&moved(&b, by), &b);
            assert!((found.highest - 1.0).abs() < 1e-9, "{by:?}: {found:?}");
            assert_eq!(found.shift_px, by);
        }
        let elsewhere = correlations(&moved(&b, [9, 7]), &b);
        assert!(elsewhere.in_place.abs() < 0.2, "{elsewhere:?}");
    }

    #[test]
    fn every_shifts_correlation_is_that_of_the_moved_surface() {
        let (a, b) = (noise(4), noise(5));
        let found = correlations(&a, &b);
        let [x, y] = found.shift_px;
        assert!((of(&a, &moved(&b, [x, y])) - found.highest).abs() < 1e-9, "{found:?}");
        for by in [[1, 0], [0, 1], [17, 40], [50, 3]] {
            assert!(of(&a, &moved(&b, by)) <= found.highest + 1e-9, "{by:?}");
        }
    }
}
