//! Complex steerable pyramid in the Fourier domain: an image as bands of wavelength and orientation.
//!
//! With r = √(ωx² + ωy²) the angular frequency in radians per texel and θ its direction,
//! ```text
//! H(r)    = cos(π/2 · log2(r/π)) on [π/2, π], 0 below, 1 above        L(r) = √(1 − H(r)²)
//! Ψ_high  = H(r)
//! Ψ_{λ,μ} = L(r) L(2r) … L(2^λ r) · H(2^{λ+1} r) · a |cos(θ − πμ/K)|^{K−1}
//! Ψ_low   = L(r) L(2r) … L(2^S r)
//! a       = 2^{K−1} (K−1)! / √(K (2K−2)!)
//! ```
//! | symbol | here |
//! |---|---|
//! | λ = 0 … S−1 | [`Kind::Oriented`] `band`: 0 is the finest |
//! | μ = 0 … K−1 | [`Kind::Oriented`] `orientation`: the wave runs along πμ/K from the u axis towards v |
//! | S, K | [`Pyramid::new`] `bands`, `orientations` |
//!
//! Source: document 002 names "a complex steerable filter sequence" by band and orientation and leaves
//! the functions open; they are those of E. P. Simoncelli and W. T. Freeman, "The steerable pyramid: a
//! flexible architecture for multi-scale derivative computation", ICIP 1995, and J. Portilla and
//! E. P. Simoncelli, IJCV 40, 2000. The squares sum to one at every frequency (a tight frame), so the
//! same filters put the image together again: I = Σ Ψ · (Ψ I), exactly, at any size, odd ones too.
//!
//! Changed: the filters are evaluated, not looked up (pyrtools stops at 110 dB for its tables, and at
//! 44 dB for odd sizes). A real sub-band is the real part of the complex one, as in the document;
//! two of them travel through one complex transform. [`Sampling::Reduced`] keeps the samples that a
//! band needs by its bandwidth and no more; its values are those of the full band at fewer places.
//! [`Sampling::Full`] is the document's: every band as large as the image.

use crate::fft2::{Fft2, angular_frequency};
use crate::raster::Raster;
use asperity_dsp::DesignError;
use rustfft::num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};

/// How many samples of a band are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampling {
    /// As many as its bandwidth needs: halved from band to band.
    #[default]
    Reduced,
    /// As many as the image has.
    Full,
}

/// Which part of the spectrum a sub-band holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// What lies above the finest band.
    HighResidual,
    /// One band of wavelengths in one orientation.
    Oriented {
        /// 0 is the finest; each next one has twice the wavelength.
        band: usize,
        /// Direction along which the wave runs, in steps of π/K from u towards v.
        orientation: usize,
    },
    /// What lies below the coarsest band, with the mean.
    LowResidual,
}

/// One sub-band: what it is and how it is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Subband {
    /// Which part of the spectrum.
    pub kind: Kind,
    /// Samples in a row.
    pub width: usize,
    /// Rows of samples.
    pub height: usize,
    /// Wavelength at the peak of the filter, texels; 2 for the high residual, ∞ for the low one.
    pub wavelength_px: f64,
}

/// Filters and plans for images of one size.
#[derive(Debug, Clone)]
pub struct Pyramid {
    fft: Fft2,
    levels: Vec<Level>,
    pairs: Vec<Pair>,
    subbands: Vec<Subband>,
    orientations: usize,
}

/// The sub-bands of one image, two real ones to a complex array; see [`Coefficients::get`].
#[derive(Debug, Clone, PartialEq)]
pub struct Coefficients {
    pairs: Vec<Vec<Complex64>>,
    /// Pair and half (0 = real, 1 = imaginary) of each sub-band.
    places: Vec<(usize, usize)>,
}

/// A rectangle of low frequencies and the grid on which they are sampled.
#[derive(Debug, Clone)]
struct Level {
    /// Frequencies kept: at most `crop` of the image's in each direction.
    crop: [usize; 2],
    fft: Fft2,
}

/// Two filters on the frequencies of a level: Ψ_a + i Ψ_b.
#[derive(Debug, Clone)]
struct Pair {
    level: usize,
    subbands: usize,
    filter: Vec<Complex64>,
}

impl Pyramid {
    /// Designs a pyramid of `bands` × `orientations` for images of `width` × `height`.
    ///
    /// # Errors
    /// When there is no band, more than 16 orientations or none, or when the image is too small for
    /// the coarsest band: each side must be at least 2^(bands + 1) texels.
    pub fn new(
        width: usize,
        height: usize,
        bands: usize,
        orientations: usize,
        sampling: Sampling,
    ) -> Result<Self, DesignError> {
        DesignError::check("bands", bands as f64, "1 to 12", |b| (1.0..=12.0).contains(&b))?;
        DesignError::check("orientations", orientations as f64, "1 to 16", |k| (1.0..=16.0).contains(&k))?;
        let least = (1_u64 << (bands + 1)) as f64;
        let smaller = width.min(height) as f64;
        DesignError::check("image side", smaller, "at least 2^(bands + 1) texels", |n| n >= least)?;
        let mut pyramid = Self {
            fft: Fft2::new(width, height),
            levels: Vec::new(),
            pairs: Vec::new(),
            subbands: Vec::new(),
            orientations,
        };
        for level in 0..=bands {
            pyramid.levels.push(Level::new(width, height, level, sampling));
            pyramid.add_filters(level, bands);
        }
        Ok(pyramid)
    }

    /// The sub-bands in the order of [`Coefficients`]: high residual, bands from fine to coarse with
    /// their orientations, low residual.
    #[must_use]
    pub fn subbands(&self) -> &[Subband] {
        &self.subbands
    }

    /// Texels in a row of the images it takes.
    #[must_use]
    pub fn width(&self) -> usize {
        self.fft.width()
    }

    /// Rows of the images it takes.
    #[must_use]
    pub fn height(&self) -> usize {
        self.fft.height()
    }

    /// Splits an image into its real sub-bands.
    ///
    /// # Panics
    /// When `values` does not hold width · height values.
    #[must_use]
    pub fn split(&mut self, values: &[f64]) -> Coefficients {
        let spectrum = self.fft.spectrum(values);
        let mut pairs = Vec::with_capacity(self.pairs.len());
        let mut work = Vec::new();
        for index in 0..self.pairs.len() {
            let mut image = vec![Complex64::default(); self.levels[self.pairs[index].level].fft.len()];
            self.split_pair(&spectrum, index, &mut work, &mut image);
            pairs.push(image);
        }
        Coefficients { pairs, places: self.places() }
    }

    /// Puts an image together from its sub-bands, edited or not. The coefficients are used as
    /// working memory and left undefined.
    ///
    /// # Panics
    /// When the coefficients are those of another pyramid.
    #[must_use]
    pub fn join(&mut self, coefficients: &mut Coefficients) -> Raster {
        let mut spectrum = vec![Complex64::default(); self.fft.len()];
        let mut work = Vec::new();
        for (index, image) in coefficients.pairs.iter_mut().enumerate() {
            self.join_pair(image, index, &mut work, &mut spectrum);
        }
        self.fft.image(&mut spectrum)
    }

    /// The complex (analytic) sub-bands of the oriented kinds: their real parts are those of
    /// [`Pyramid::split`], their moduli the local amplitude whatever the phase.
    ///
    /// # Panics
    /// When `values` does not hold width · height values.
    #[must_use]
    pub fn split_complex(&mut self, values: &[f64]) -> Vec<(Subband, Vec<Complex64>)> {
        let spectrum = self.fft.spectrum(values);
        let (mut work, mut out) = (Vec::new(), Vec::new());
        for (index, (pair, half)) in self.places().into_iter().enumerate() {
            let Kind::Oriented { orientation, .. } = self.subbands[index].kind else { continue };
            let mut filter = self.pairs[pair].clone();
            let (sin, cos) = (PI * orientation as f64 / self.orientations as f64).sin_cos();
            let level = &self.levels[filter.level];
            level.visit(self.fft.width(), self.fft.height(), |place, _, [wx, wy]| {
                let gain = if half == 0 { filter.filter[place].re } else { filter.filter[place].im };
                let along = wx * cos + wy * sin;
                let side = if along > 0.0 { 2.0 } else { 0.0 };
                filter.filter[place] = Complex64::new(gain * side, 0.0);
            });
            let mut image = vec![Complex64::default(); level.fft.len()];
            std::mem::swap(&mut self.pairs[pair], &mut filter);
            self.split_pair(&spectrum, pair, &mut work, &mut image);
            std::mem::swap(&mut self.pairs[pair], &mut filter);
            out.push((self.subbands[index], image));
        }
        out
    }

    /// Adds the filters of one level: the oriented band λ = `level` (and the high residual on the
    /// first), or the low residual on the level after the last band.
    fn add_filters(&mut self, level: usize, bands: usize) {
        let mut kinds = Vec::new();
        if level == 0 {
            kinds.push(Kind::HighResidual);
        }
        if level == bands {
            kinds.push(Kind::LowResidual);
        } else {
            let oriented = |orientation| Kind::Oriented { band: level, orientation };
            kinds.extend((0..self.orientations).map(oriented));
        }
        let grid = &self.levels[level];
        for both in kinds.chunks(2) {
            let mut filter = vec![Complex64::default(); grid.crop[0] * grid.crop[1]];
            grid.visit(self.fft.width(), self.fft.height(), |place, _, omega| {
                let gain = |kind: Option<&Kind>| kind.map_or(0.0, |k| self.gain(*k, level, omega));
                filter[place] = Complex64::new(gain(both.first()), gain(both.get(1)));
            });
            self.pairs.push(Pair { level, subbands: both.len(), filter });
        }
        let (width, height) = (grid.fft.width(), grid.fft.height());
        self.subbands.extend(kinds.into_iter().map(|kind| {
            let wavelength_px = match kind {
                Kind::HighResidual => 2.0,
                Kind::Oriented { band, .. } => 4.0 * (1_u64 << band) as f64,
                Kind::LowResidual => f64::INFINITY,
            };
            Subband { kind, width, height, wavelength_px }
        }));
    }

    /// Ψ at one frequency; `lows` is how often the low-pass has been applied before the band.
    fn gain(&self, kind: Kind, lows: usize, [wx, wy]: [f64; 2]) -> f64 {
        let r = wx.hypot(wy);
        match kind {
            Kind::HighResidual => high(r),
            Kind::LowResidual => low_chain(r, lows),
            Kind::Oriented { band, orientation } => {
                let radial = low_chain(r, band) * high(r * (1_u64 << (band + 1)) as f64);
                if radial == 0.0 {
                    return 0.0;
                }
                let k = self.orientations;
                let cos = (wy.atan2(wx) - PI * orientation as f64 / k as f64).cos().abs();
                radial * angular_norm(k) * cos.powi(k as i32 - 1)
            }
        }
    }

    /// Where each sub-band sits.
    fn places(&self) -> Vec<(usize, usize)> {
        let pairs = self.pairs.iter().enumerate();
        pairs.flat_map(|(pair, of)| (0..of.subbands).map(move |half| (pair, half))).collect()
    }

    /// One pair of sub-bands from the spectrum of an image.
    pub(crate) fn split_pair(
        &mut self,
        spectrum: &[Complex64],
        index: usize,
        work: &mut Vec<Complex64>,
        image: &mut [Complex64],
    ) {
        let pair = &self.pairs[index];
        let level = &mut self.levels[pair.level];
        work.clear();
        work.resize(level.fft.len(), Complex64::default());
        let scale = 1.0 / self.fft.len() as f64;
        level.runs(self.fft.width(), self.fft.height(), |run| {
            let filter = &pair.filter[run.crop..run.crop + run.len];
            let from = &spectrum[run.full..run.full + run.len];
            let to = &mut work[run.level..run.level + run.len];
            for ((to, &from), &gain) in to.iter_mut().zip(from).zip(filter) {
                *to = from * gain * scale;
            }
        });
        level.fft.inverse_low_unscaled(work, image, level.crop[0]);
    }

    /// Adds what one pair of sub-bands contributes to the spectrum of the image, plus i times
    /// something whose image is real: the real part of the inverse transform is the image.
    pub(crate) fn join_pair(
        &mut self,
        image: &mut [Complex64],
        index: usize,
        work: &mut Vec<Complex64>,
        spectrum: &mut [Complex64],
    ) {
        let pair = &self.pairs[index];
        let level = &mut self.levels[pair.level];
        work.resize(level.fft.len(), Complex64::default());
        level.fft.forward_low(image, work, level.crop[0]);
        let scale = self.fft.len() as f64 / level.fft.len() as f64;
        level.runs(self.fft.width(), self.fft.height(), |run| {
            let filter = &pair.filter[run.crop..run.crop + run.len];
            let from = &work[run.level..run.level + run.len];
            let to = &mut spectrum[run.full..run.full + run.len];
            for ((to, &from), gain) in to.iter_mut().zip(from).zip(filter) {
                *to += from * gain.conj() * scale;
            }
        });
    }

    /// Number of complex arrays in [`Coefficients`].
    pub(crate) fn pair_count(&self) -> usize {
        self.pairs.len()
    }

    /// Sub-bands in the pair: 2, or 1 in the last one of a level with an odd count.
    pub(crate) fn pair_subbands(&self, index: usize) -> usize {
        self.pairs[index].subbands
    }

    /// Samples of each sub-band in the pair.
    pub(crate) fn pair_len(&self, index: usize) -> usize {
        self.levels[self.pairs[index].level].fft.len()
    }

    /// The transforms of whole images.
    pub(crate) fn fft(&mut self) -> &mut Fft2 {
        &mut self.fft
    }
}

impl Coefficients {
    /// Number of sub-bands.
    #[must_use]
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// The values of one sub-band, row by row, in the order of [`Pyramid::subbands`].
    ///
    /// # Panics
    /// When there is no such sub-band.
    #[must_use]
    pub fn get(&self, index: usize) -> Vec<f64> {
        let (pair, half) = self.places[index];
        self.pairs[pair].iter().map(|v| if half == 0 { v.re } else { v.im }).collect()
    }

    /// Replaces the values of one sub-band.
    ///
    /// # Panics
    /// When there is no such sub-band or `values` is not as long as it.
    pub fn set(&mut self, index: usize, values: &[f64]) {
        let (pair, half) = self.places[index];
        assert_eq!(values.len(), self.pairs[pair].len(), "a sub-band keeps its size");
        for (place, &value) in self.pairs[pair].iter_mut().zip(values) {
            *(if half == 0 { &mut place.re } else { &mut place.im }) = value;
        }
    }
}

/// A run of frequencies that lie side by side in the image's spectrum, the crop and the level.
struct Run {
    full: usize,
    crop: usize,
    level: usize,
    len: usize,
}

impl Level {
    /// The frequencies that survive `halvings` of the band's upper edge, and their grid.
    fn new(width: usize, height: usize, halvings: usize, sampling: Sampling) -> Self {
        let side = |n: usize| n.div_ceil(1 << halvings);
        let crop = [side(width), side(height)];
        let [w, h] = if sampling == Sampling::Full { [width, height] } else { crop };
        Self { crop, fft: Fft2::new(w, h) }
    }

    /// Calls `each` with the runs of frequencies of this level. The filters are zero at and above
    /// the crop's own Nyquist frequency, so it does not matter on which side that bin is kept.
    fn runs(&self, width: usize, height: usize, mut each: impl FnMut(Run)) {
        let [crop_w, crop_h] = self.crop;
        let (level_w, level_h) = (self.fft.width(), self.fft.height());
        debug_assert!(crop_w <= width && crop_h <= level_h);
        let upper = crop_h / 2 + 1;
        for kx in 0..crop_w {
            let below = crop_w - kx;
            let negative = kx > crop_w / 2;
            let full = if negative { width - below } else { kx } * height;
            let level = if negative { level_w - below } else { kx } * level_h;
            let crop = kx * crop_h;
            let upper = upper.min(crop_h);
            each(Run { full, crop, level, len: upper });
            let len = crop_h - upper;
            if len > 0 {
                each(Run {
                    full: full + height - len,
                    crop: crop + upper,
                    level: level + level_h - len,
                    len,
                });
            }
        }
    }

    /// Calls `each` with place in the crop, place in the image's spectrum and angular frequency.
    fn visit(&self, width: usize, height: usize, mut each: impl FnMut(usize, usize, [f64; 2])) {
        self.runs(width, height, |run| {
            for i in 0..run.len {
                let full = run.full + i;
                let omega =
                    [angular_frequency(full / height, width), angular_frequency(full % height, height)];
                each(run.crop + i, full, omega);
            }
        });
    }
}

/// H(r).
fn high(r: f64) -> f64 {
    if r >= PI {
        1.0
    } else if r <= FRAC_PI_2 {
        0.0
    } else {
        (FRAC_PI_2 * (r / PI).log2()).cos()
    }
}

/// L(r) L(2r) … L(2^last r).
fn low_chain(r: f64, last: usize) -> f64 {
    // Below half of the band edge every earlier factor is one, above it the last but one is zero
    // unless r lies in its octave: only these two can differ from 0 and 1.
    let low = |r: f64| {
        if r >= PI {
            0.0
        } else if r <= FRAC_PI_2 {
            1.0
        } else {
            // √(1 − cos²) without cancellation.
            (FRAC_PI_2 * (r / PI).log2()).sin().abs()
        }
    };
    (0..=last).map(|i| low(r * (1_u64 << i) as f64)).product()
}

/// 2^{K−1} (K−1)! / √(K (2K−2)!): the squared orientations sum to one.
fn angular_norm(orientations: usize) -> f64 {
    let factorial = |n: usize| (1..=n).map(|i| i as f64).product::<f64>();
    let k = orientations;
    2.0_f64.powi(k as i32 - 1) * factorial(k - 1) / (k as f64 * factorial(2 * k - 2)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    fn noise(width: usize, height: usize, seed: u64) -> Raster {
        let mut rng = Rng::new(seed);
        Raster::from_fn(width, height, |_, _| rng.normal())
    }

    fn snr_db(signal: &[f64], other: &[f64]) -> f64 {
        let error: f64 = signal.iter().zip(other).map(|(a, b)| (a - b) * (a - b)).sum();
        10.0 * (signal.iter().map(|a| a * a).sum::<f64>() / error).log10()
    }

    #[test]
    fn the_round_trip_is_exact_at_even_odd_and_oblong_sizes() {
        for (w, h, s, k) in
            [(256, 256, 4, 4), (255, 255, 4, 4), (129, 200, 3, 5), (37, 41, 2, 1), (64, 48, 3, 2)]
        {
            for sampling in [Sampling::Reduced, Sampling::Full] {
                let image = noise(w, h, 11);
                let mut pyramid = Pyramid::new(w, h, s, k, sampling).unwrap();
                let mut split = pyramid.split(&image.values);
                let back = pyramid.join(&mut split);
                let db = snr_db(&image.values, &back.values);
                assert!(db > 290.0, "{w} × {h}, {s} × {k}, {sampling:?}: {db} dB");
            }
        }
    }

    #[test]
    fn squared_filters_sum_to_one_at_every_frequency() {
        for (w, h, s, k) in [(64, 64, 3, 4), (63, 45, 3, 6), (50, 64, 2, 3)] {
            let pyramid = Pyramid::new(w, h, s, k, Sampling::Reduced).unwrap();
            let mut sum = vec![0.0; w * h];
            for pair in &pyramid.pairs {
                pyramid.levels[pair.level].visit(w, h, |place, full, _| {
                    sum[full] += pair.filter[place].norm_sqr();
                });
            }
            for value in sum {
                assert!((value - 1.0).abs() < 1e-12, "{w} × {h}: {value}");
            }
        }
    }

    #[test]
    fn reduced_bands_are_the_full_bands_at_fewer_places() {
        let image = noise(64, 64, 12);
        let full = Pyramid::new(64, 64, 3, 4, Sampling::Full).unwrap().split(&image.values);
        let mut reduced = Pyramid::new(64, 64, 3, 4, Sampling::Reduced).unwrap();
        let few = reduced.split(&image.values);
        for (index, band) in reduced.subbands().iter().enumerate() {
            let (many, few) = (full.get(index), few.get(index));
            let step = 64 / band.width;
            for y in 0..band.height {
                for x in 0..band.width {
                    let difference = few[y * band.width + x] - many[y * step * 64 + x * step];
                    assert!(difference.abs() < 1e-13, "{band:?}");
                }
            }
        }
    }

    #[test]
    fn a_wave_lands_in_the_band_of_its_length_and_direction() {
        // 8 texels long, running along v: band 1, orientation 2 of 4.
        let wave = Raster::from_fn(64, 64, |_, y| (2.0 * PI * y as f64 / 8.0).cos());
        let mut pyramid = Pyramid::new(64, 64, 3, 4, Sampling::Reduced).unwrap();
        let split = pyramid.split(&wave.values);
        let energy = |i: usize| {
            let values = split.get(i);
            values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64
        };
        let strongest = (0..split.len()).max_by(|&a, &b| energy(a).total_cmp(&energy(b))).unwrap();
        assert_eq!(pyramid.subbands()[strongest].kind, Kind::Oriented { band: 1, orientation: 2 });
        // In closed form: Ψ = a at the peak of the band (H = L-chain = 1 there), cos² has mean ½.
        let expected = 0.5 * angular_norm(4).powi(2);
        assert!((energy(strongest) - expected).abs() < 1e-12);
    }

    #[test]
    fn complex_bands_have_the_real_bands_as_real_parts_and_steady_moduli() {
        let wave = Raster::from_fn(48, 64, |_, y| (2.0 * PI * y as f64 / 8.0 + 0.3).cos());
        let mut pyramid = Pyramid::new(48, 64, 3, 4, Sampling::Reduced).unwrap();
        let split = pyramid.split(&wave.values);
        let complex = pyramid.split_complex(&wave.values);
        assert_eq!(complex.len(), 12);
        for (i, (band, values)) in complex.iter().enumerate() {
            let real = split.get(i + 1);
            assert!(values.iter().zip(&real).all(|(c, r)| (c.re - r).abs() < 1e-13), "{band:?}");
        }
        let (_, values) = &complex[4 + 2];
        let modulus = values[0].norm();
        assert!(modulus > 0.5 && values.iter().all(|v| (v.norm() - modulus).abs() < 1e-12));
    }

    #[test]
    fn impossible_designs_are_refused_by_name() {
        let refused = |w, h, s, k| Pyramid::new(w, h, s, k, Sampling::Full).unwrap_err().field;
        assert_eq!(refused(64, 64, 0, 4), "bands");
        assert_eq!(refused(64, 64, 4, 0), "orientations");
        assert_eq!(refused(31, 64, 4, 4), "image side");
    }
}
