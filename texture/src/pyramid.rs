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

mod coefficients;
mod filter;
mod level;
#[cfg(test)]
mod tests;

pub use coefficients::Coefficients;

use crate::fft2::Fft2;
use crate::raster::Raster;
use asperity_dsp::DesignError;
use level::Level;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

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
                let gain = |kind: Option<&Kind>| {
                    kind.map_or(0.0, |k| filter::gain(*k, self.orientations, level, omega))
                };
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
