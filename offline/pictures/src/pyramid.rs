//! Complex steerable pyramid in the Fourier domain: an image as bands of wavelength and
//! orientation.
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
//! Source: document 002 names "a complex steerable filter sequence" by band and orientation and
//! leaves the functions open; they are those of E. P. Simoncelli and W. T. Freeman, "The steerable
//! pyramid: a flexible architecture for multi-scale derivative computation", ICIP 1995, and J.
//! Portilla and E. P. Simoncelli, IJCV 40, 2000. The squares sum to one at every frequency (a tight
//! frame), so the same filters put the image together again: I = Σ Ψ · (Ψ I), exactly, at any size,
//! odd ones too.
//!
//! Changed: the filters are evaluated, not looked up (pyrtools stops at 110 dB for its tables, and
//! at 44 dB for odd sizes). A real sub-band is the real part of the complex one, as in the
//! document; images and sub-bands are transformed as what they are, real, and filters known by half
//! of the plane. [`Sampling::Reduced`] keeps the samples that a band needs by its bandwidth and no
//! more; its values are those of the full band at fewer places. [`Sampling::Full`] is the
//! document's: every band as large as the image.

mod coefficients;
mod filter;
mod level;
#[cfg(test)]
mod tests;

pub use coefficients::Coefficients;

use crate::fft2::Workspace;
use asperity_dsp::DesignError;
use asperity_fft::FftPlanner;
use asperity_fft::num_complex::Complex64;
use asperity_surface::raster::Raster;
use level::Level;

/// Number of samples of a band that are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampling {
    /// Samples as its bandwidth needs: halved from band to band.
    #[default]
    Reduced,
    /// Samples as the image has.
    Full,
}

/// Which part of the spectrum a sub-band holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Part above the finest band.
    HighResidual,
    /// One band of wavelengths in one orientation.
    Oriented {
        /// 0 is the finest; each next one has twice the wavelength.
        band: usize,
        /// Direction along which the wave runs, in steps of π/K from u towards v.
        orientation: usize,
    },
    /// Part below the coarsest band, with the mean.
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

/// Filters, plans and working memory for images of one size.
#[derive(Debug, Clone)]
pub struct Pyramid {
    /// The first has the grid of the image itself.
    levels: Vec<Level>,
    filters: Vec<Filter>,
    subbands: Vec<Subband>,
    orientations: usize,
    work: Workspace,
    /// Half the spectrum of an image, between two calls of no meaning.
    spectrum: Vec<Complex64>,
}

/// Ψ on the frequencies of a level.
#[derive(Debug, Clone)]
struct Filter {
    level: usize,
    gains: Vec<f64>,
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
        let mut planner = FftPlanner::new();
        let level = |level| Level::new(&mut planner, [width, height], level, sampling);
        let mut pyramid = Self {
            levels: (0..=bands).map(level).collect(),
            filters: Vec::new(),
            subbands: Vec::new(),
            orientations,
            work: Workspace::default(),
            spectrum: Vec::new(),
        };
        (0..=bands).for_each(|level| pyramid.add_filters(level, bands));
        Ok(pyramid)
    }

    /// The sub-bands in the order of [`Coefficients`]: high residual, bands from fine to coarse
    /// with their orientations, low residual.
    #[must_use]
    pub fn subbands(&self) -> &[Subband] {
        &self.subbands
    }

    /// Texels in a row of the images it takes.
    #[must_use]
    pub fn width(&self) -> usize {
        self.levels[0].fft.width()
    }

    /// Rows of the images it takes.
    #[must_use]
    pub fn height(&self) -> usize {
        self.levels[0].fft.height()
    }

    /// Bands and orientations.
    pub(crate) fn design(&self) -> [usize; 2] {
        [self.levels.len() - 1, self.orientations]
    }

    /// Splits an image into its real sub-bands.
    ///
    /// # Panics
    /// When `values` does not hold width · height values.
    #[must_use]
    pub fn split(&mut self, values: &[f64]) -> Coefficients {
        let mut coefficients = Coefficients::default();
        self.split_into(values, &mut coefficients);
        coefficients
    }

    /// As [`Pyramid::split`] into coefficients of an earlier image, whose memory is used again.
    ///
    /// # Panics
    /// When `values` does not hold width · height values.
    pub fn split_into(&mut self, values: &[f64], coefficients: &mut Coefficients) {
        let mut spectrum = std::mem::take(&mut self.spectrum);
        self.half_spectrum(values, &mut spectrum);
        coefficients.values.clear();
        coefficients.ends.clear();
        coefficients.values.reserve_exact(self.subbands.iter().map(|band| band.width * band.height).sum());
        for index in 0..self.subbands.len() {
            self.split_subband(&spectrum, index, &mut coefficients.values);
            coefficients.ends.push(coefficients.values.len());
        }
        self.spectrum = spectrum;
    }

    /// Puts an image together from its sub-bands, edited or not.
    ///
    /// # Panics
    /// When the coefficients are those of another pyramid.
    #[must_use]
    pub fn join(&mut self, coefficients: &Coefficients) -> Raster {
        let mut image = Raster::default();
        self.join_into(coefficients, &mut image);
        image
    }

    /// As [`Pyramid::join`] into an earlier image, whose memory is used again.
    ///
    /// # Panics
    /// When the coefficients are those of another pyramid.
    pub fn join_into(&mut self, coefficients: &Coefficients, image: &mut Raster) {
        assert_eq!(coefficients.len(), self.subbands.len(), "the coefficients of this pyramid");
        let mut spectrum = std::mem::take(&mut self.spectrum);
        self.clear_half_spectrum(&mut spectrum);
        for index in 0..self.subbands.len() {
            self.join_subband(coefficients.get(index), index, &mut spectrum);
        }
        (image.width, image.height) = (self.width(), self.height());
        self.image(&spectrum, &mut image.values);
        self.spectrum = spectrum;
    }

    /// Filters for sub-bands of another sampling: most of the work of a design is to evaluate them.
    #[must_use]
    pub(crate) fn sampled(&self, sampling: Sampling) -> Self {
        let mut planner = FftPlanner::new();
        let size = [self.width(), self.height()];
        let mut other = self.clone();
        let levels = 0..self.levels.len();
        other.levels = levels.map(|level| Level::new(&mut planner, size, level, sampling)).collect();
        for (subband, filter) in other.subbands.iter_mut().zip(&other.filters) {
            let fft = &other.levels[filter.level].fft;
            (subband.width, subband.height) = (fft.width(), fft.height());
        }
        other
    }

    /// Adds the filters of one level: the oriented band λ = `level` (and the high residual on the
    /// first), or the low residual on the level after the last band.
    fn add_filters(&mut self, level: usize, bands: usize) {
        let width = self.width();
        // Distance and direction of each wave, the same for all filters of the level.
        let polar = |[wx, wy]: [f64; 2]| {
            let r = wx.hypot(wy);
            if r == 0.0 { (r, [0.0; 2]) } else { (r, [wx / r, wy / r]) }
        };
        let waves: Vec<(f64, [f64; 2])> =
            self.levels[level].frequencies(width).map(|(_, frequency)| polar(frequency)).collect();
        let radial = |kind| waves.iter().map(|(r, _)| filter::radial(kind, level, *r)).collect::<Vec<f64>>();
        if level == 0 {
            self.add_filter(level, Kind::HighResidual, radial(Kind::HighResidual));
        }
        if level == bands {
            self.add_filter(level, Kind::LowResidual, radial(Kind::LowResidual));
            return;
        }
        let band = radial(Kind::Oriented { band: level, orientation: 0 });
        for orientation in 0..self.orientations {
            let angular = filter::angular(orientation, self.orientations);
            let gain = |(radial, (r, direction)): (&f64, &(f64, [f64; 2]))| {
                if *radial == 0.0 || *r == 0.0 { *radial } else { radial * angular(*direction) }
            };
            let gains = band.iter().zip(&waves).map(gain).collect();
            self.add_filter(level, Kind::Oriented { band: level, orientation }, gains);
        }
    }

    fn add_filter(&mut self, level: usize, kind: Kind, gains: Vec<f64>) {
        let fft = &self.levels[level].fft;
        let (width, height) = (fft.width(), fft.height());
        let wavelength_px = match kind {
            Kind::HighResidual => 2.0,
            Kind::Oriented { band, .. } => 4.0 * (1_u64 << band) as f64,
            Kind::LowResidual => f64::INFINITY,
        };
        self.filters.push(Filter { level, gains });
        self.subbands.push(Subband { kind, width, height, wavelength_px });
    }

    /// Columns kx = 0 … width/2 of the spectrum of an image.
    pub(crate) fn half_spectrum(&mut self, values: &[f64], spectrum: &mut Vec<Complex64>) {
        let Level { fft, columns, .. } = &self.levels[0];
        spectrum.clear();
        spectrum.reserve_exact(columns * fft.height());
        fft.forward(values, *columns, &mut self.work, |_, column| spectrum.extend_from_slice(column));
    }

    /// Half the spectrum of nothing, for [`Pyramid::join_subband`] to add to.
    pub(crate) fn clear_half_spectrum(&self, spectrum: &mut Vec<Complex64>) {
        spectrum.clear();
        spectrum.resize(self.levels[0].columns * self.height(), Complex64::default());
    }

    /// Appends one sub-band of the image with this half spectrum to `values`.
    pub(crate) fn split_subband(&mut self, spectrum: &[Complex64], index: usize, values: &mut Vec<f64>) {
        let filter = &self.filters[index];
        let level = &self.levels[filter.level];
        let scale = 1.0 / self.levels[0].fft.len() as f64;
        level.fft.inverse_unscaled(level.columns, &mut self.work, values, |kx, column| {
            level.filtered(kx, spectrum, &filter.gains, scale, column);
        });
    }

    /// Adds what one sub-band contributes to half the spectrum of the image.
    pub(crate) fn join_subband(&mut self, values: &[f64], index: usize, spectrum: &mut [Complex64]) {
        let filter = &self.filters[index];
        let level = &self.levels[filter.level];
        let scale = self.levels[0].fft.len() as f64 / level.fft.len() as f64;
        level.fft.forward(values, level.columns, &mut self.work, |kx, column| {
            level.add_filtered(kx, column, &filter.gains, scale, spectrum);
        });
    }

    /// Sums of squares and products of one sub-band of two images with these half spectra: Σ a², Σ
    /// a b, Σ b², times the number of texels.
    pub(crate) fn powers(&self, a: &[Complex64], b: &[Complex64], index: usize) -> [f64; 3] {
        let filter = &self.filters[index];
        let (width, height) = (self.width(), self.height());
        let mut sums = [0.0; 3];
        for ((place, _), gain) in self.levels[filter.level].frequencies(width).zip(&filter.gains) {
            let kx = place / height;
            // Half the spectrum stands for both halves, but for the columns that are their own
            // mirror images.
            let weight = if (2 * kx).is_multiple_of(width) { gain * gain } else { 2.0 * gain * gain };
            let (a, b) = (a[place], b[place]);
            sums[0] += weight * a.norm_sqr();
            sums[1] += weight * (a.re * b.re + a.im * b.im);
            sums[2] += weight * b.norm_sqr();
        }
        sums
    }

    /// Adds to `sum` the cross spectrum of one sub-band of two images with these half spectra, Ψ² A
    /// B*, times `gain`.
    pub(crate) fn add_cross_spectrum(
        &self,
        [a, b]: [&[Complex64]; 2],
        index: usize,
        gain: f64,
        sum: &mut [Complex64],
    ) {
        let filter = &self.filters[index];
        for ((place, _), psi) in self.levels[filter.level].frequencies(self.width()).zip(&filter.gains) {
            sum[place] += a[place] * b[place].conj() * (gain * psi * psi);
        }
    }

    /// Replaces `values` by the image with this half spectrum.
    pub(crate) fn image(&mut self, spectrum: &[Complex64], values: &mut Vec<f64>) {
        let Level { fft, columns, .. } = &self.levels[0];
        let scale = 1.0 / fft.len() as f64;
        values.clear();
        fft.inverse_unscaled(*columns, &mut self.work, values, |kx, column| {
            let from = &spectrum[kx * fft.height()..][..fft.height()];
            column.iter_mut().zip(from).for_each(|(to, from)| *to = from * scale);
        });
    }
}
