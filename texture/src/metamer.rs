//! Tactile metamers: a surface rearranged until it feels like a reference.
//!
//! ```text
//! S'_{λ,μ} = F_r⁻¹(F_c(S_{λ,μ}))        I' = Σ Ψ_{λ,μ} S'_{λ,μ}
//! ```
//! Every sub-band S of the original's steerable pyramid ([`crate::pyramid`]) is given the histogram of
//! the reference's; the result keeps the spatial arrangement of the original and, to a finger, the feel
//! of the reference (document 002, which describes a granted US patent).
//!
//! | symbol | here |
//! |---|---|
//! | I_c, I_r | `original`, `reference`: heights in one unit |
//! | λ, μ | [`MetamerOptions::bands`], [`MetamerOptions::orientations`] (document: 4, 4 for 256²) |
//! | F_r⁻¹(F_c(·)) | [`crate::histogram`] |
//!
//! What we changed, and its measured effect (re-analysed distance of the sub-bands, W1/σ, mean):
//! the document matches the bands once. Filters overlap, so that joining the bands spoils their
//! histograms again: 0.09–0.42 is left. [`Method::Iterated`], the default, also matches the two residuals
//! and the heights themselves and repeats (as D. J. Heeger and J. R. Bergen, "Pyramid-based texture
//! analysis/synthesis", SIGGRAPH 1995, do from noise): at most 0.02 is left. [`Method::Spectrum`] takes
//! the amplitude spectrum of the reference instead, as the document's claims allow.
//!
//! Images that do not tile are analysed through their periodic component ([`crate::borders`]).

use crate::borders::{Borders, SplitBorders};
use crate::histogram::{Histogram, Matcher};
use crate::pyramid::{Kind, Pyramid, Sampling};
use crate::raster::Raster;
use crate::resample::{resample, resample_spectrum};
use asperity_dsp::DesignError;
use rustfft::num_complex::Complex64;

/// Bands of the document's experiment (256 × 256 texels on 40 × 40 mm).
pub const BANDS: usize = 4;
/// Orientations of the document's experiment.
pub const ORIENTATIONS: usize = 4;
/// Passes of the default method. Source: ours, the fewest that leave a mean band distance below 0.02
/// on wood, grid, Brownian and ridge surfaces matched to each other.
pub const PASSES: usize = 30;

/// How the original is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The document's: oriented bands once, nothing else.
    SinglePass,
    /// Bands, residuals and heights, this many times.
    Iterated(usize),
    /// The reference's amplitude spectrum with the original's phases.
    Spectrum,
}

/// What to match and how.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MetamerOptions {
    /// Bands of wavelength, an octave each.
    pub bands: usize,
    /// Orientations of each band.
    pub orientations: usize,
    /// How the original is changed.
    pub method: Method,
    /// Whether the images tile.
    pub borders: Borders,
    /// Size of a texel of the original over that of the reference; 1 when both have the same scale.
    pub scale: f64,
}

impl Default for MetamerOptions {
    fn default() -> Self {
        Self {
            bands: BANDS,
            orientations: ORIENTATIONS,
            method: Method::Iterated(PASSES),
            borders: Borders::Detect,
            scale: 1.0,
        }
    }
}

/// How far one sub-band is from the reference's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandDistance {
    /// Which sub-band.
    pub kind: Kind,
    /// Wavelength at its peak, texels of the original.
    pub wavelength_px: f64,
    /// Mean distance between equal quantiles, over the reference's standard deviation, before.
    pub before: f64,
    /// The same on re-analysis of the result.
    pub after: f64,
}

/// The result.
#[derive(Debug, Clone, PartialEq)]
pub struct Metamer {
    /// As large as the original, in the reference's unit of height.
    pub image: Raster,
    /// One entry a sub-band, from fine to coarse, with the residuals first and last.
    pub bands: Vec<BandDistance>,
    /// Whether the images were taken to tile.
    pub tileable: bool,
}

impl Metamer {
    /// Mean distance of the oriented bands before.
    #[must_use]
    pub fn mean_before(&self) -> f64 {
        self.mean(|band| band.before)
    }

    /// Mean distance of the oriented bands after, on re-analysis.
    #[must_use]
    pub fn mean_after(&self) -> f64 {
        self.mean(|band| band.after)
    }

    fn mean(&self, of: impl Fn(&BandDistance) -> f64) -> f64 {
        let oriented = self.bands.iter().filter(|band| matches!(band.kind, Kind::Oriented { .. }));
        let (sum, count) = oriented.fold((0.0, 0.0), |(sum, count), band| (sum + of(band), count + 1.0));
        sum / count
    }
}

/// Makes `original` feel like `reference`. `progress` is told the fraction done.
///
/// # Errors
/// When an image holds numbers that are not finite, when one is too small for the bands (each side at
/// least 2^(bands + 1) texels, the reference after scaling), or when `scale` is not within 1/64–64.
pub fn metamer(
    original: &Raster,
    reference: &Raster,
    options: &MetamerOptions,
    mut progress: impl FnMut(f64),
) -> Result<Metamer, DesignError> {
    check_finite("original", original)?;
    check_finite("reference", reference)?;
    DesignError::check("scale", options.scale, "within 1/64 to 64", |s| (1.0 / 64.0..=64.0).contains(&s))?;
    let borders = options.borders.decide(reference);
    let ours = SplitBorders::of(original, borders);
    let theirs = SplitBorders::of(&scaled(reference, options.scale), borders);
    let mut target = Target::new(&theirs.periodic, options)?;
    let mut work = Work::new(original, options)?;
    let before = target.distances(&ours.periodic, options)?;
    let mut image = match options.method {
        Method::SinglePass => work.pass(&ours.periodic, &target, Parts::OrientedBands),
        Method::Iterated(passes) => {
            let mut image = ours.periodic.clone();
            for pass in 0..passes {
                work.matcher.run(&mut image.values, &target.heights);
                image = work.pass(&image, &target, Parts::Everything);
                progress((pass + 1) as f64 / passes as f64);
            }
            image
        }
        Method::Spectrum => with_amplitudes(&ours.periodic, &theirs.periodic, &mut work),
    };
    let after = target.distances(&image, options)?;
    ours.add_borders(&mut image, &theirs);
    let bands = before.into_iter().zip(after);
    let bands = bands.map(|(mut band, after)| {
        band.after = after.before;
        band
    });
    Ok(Metamer { image, bands: bands.collect(), tileable: borders == Borders::Periodic })
}

fn check_finite(field: &'static str, image: &Raster) -> Result<(), DesignError> {
    let bad = image.values.iter().copied().find(|v| !v.is_finite());
    bad.map_or(Ok(()), |value| Err(DesignError { field, value, expected: "an image of finite numbers" }))
}

/// The reference on the original's texels.
fn scaled(reference: &Raster, scale: f64) -> Raster {
    let side = |n: usize| ((n as f64 / scale).round() as usize).max(1);
    let (width, height) = (side(reference.width), side(reference.height));
    if (width, height) == (reference.width, reference.height) {
        return reference.clone();
    }
    resample(reference, width, height)
}

/// The reference's histograms.
struct Target {
    bands: Vec<Histogram>,
    heights: Histogram,
    /// Histograms at full sampling and their deviations: what distances are measured against.
    full: Vec<Histogram>,
}

impl Target {
    fn new(reference: &Raster, options: &MetamerOptions) -> Result<Self, DesignError> {
        let histograms = |sampling| -> Result<Vec<Histogram>, DesignError> {
            let mut pyramid = design(reference, options, sampling)?;
            let split = pyramid.split(&reference.values);
            Ok((0..split.len()).map(|i| Histogram::new(split.get(i))).collect())
        };
        Ok(Self {
            bands: histograms(SAMPLING)?,
            heights: Histogram::new(reference.values.clone()),
            full: histograms(Sampling::Full)?,
        })
    }

    /// Distances of an image's sub-bands, in `before`.
    fn distances(
        &mut self,
        image: &Raster,
        options: &MetamerOptions,
    ) -> Result<Vec<BandDistance>, DesignError> {
        let mut pyramid = design(image, options, Sampling::Full)?;
        let split = pyramid.split(&image.values);
        // A sub-band that the reference does not have cannot be measured in its own deviations.
        let floor = 1e-6 * self.heights.deviation().max(f64::MIN_POSITIVE);
        let subbands = pyramid.subbands().iter().enumerate().zip(&self.full);
        Ok(subbands
            .map(|((index, subband), reference)| {
                let distance = Histogram::new(split.get(index)).distance(reference);
                let before = distance / reference.deviation().max(floor);
                BandDistance { kind: subband.kind, wavelength_px: subband.wavelength_px, before, after: 0.0 }
            })
            .collect())
    }
}

/// Sampling of the passes: full, as in the document.
const SAMPLING: Sampling = Sampling::Full;

fn design(image: &Raster, options: &MetamerOptions, sampling: Sampling) -> Result<Pyramid, DesignError> {
    Pyramid::new(image.width, image.height, options.bands, options.orientations, sampling)
}

/// Which sub-bands a pass changes.
#[derive(Clone, Copy, PartialEq)]
enum Parts {
    OrientedBands,
    Everything,
}

/// Plans and buffers of the passes.
struct Work {
    pyramid: Pyramid,
    matcher: Matcher,
    pair: Vec<Complex64>,
    half: Vec<f64>,
    spare: Vec<Complex64>,
}

impl Work {
    fn new(original: &Raster, options: &MetamerOptions) -> Result<Self, DesignError> {
        let pyramid = design(original, options, SAMPLING)?;
        Ok(Self {
            pyramid,
            matcher: Matcher::default(),
            pair: Vec::new(),
            half: Vec::new(),
            spare: Vec::new(),
        })
    }

    /// Splits, matches every sub-band and joins.
    fn pass(&mut self, image: &Raster, target: &Target, parts: Parts) -> Raster {
        let spectrum = self.pyramid.fft().spectrum(&image.values);
        let mut sum = vec![Complex64::default(); spectrum.len()];
        let mut next = 0;
        for index in 0..self.pyramid.pair_count() {
            self.pair.resize(self.pyramid.pair_len(index), Complex64::default());
            self.pyramid.split_pair(&spectrum, index, &mut self.spare, &mut self.pair);
            for half in 0..self.pyramid.pair_subbands(index) {
                let kind = self.pyramid.subbands()[next].kind;
                if parts == Parts::Everything || matches!(kind, Kind::Oriented { .. }) {
                    self.match_half(half, &target.bands[next]);
                }
                next += 1;
            }
            self.pyramid.join_pair(&mut self.pair, index, &mut self.spare, &mut sum);
        }
        self.pyramid.fft().image(&mut sum)
    }

    fn match_half(&mut self, half: usize, reference: &Histogram) {
        self.half.clear();
        self.half.extend(self.pair.iter().map(|v| if half == 0 { v.re } else { v.im }));
        self.matcher.run(&mut self.half, reference);
        for (place, &value) in self.pair.iter_mut().zip(&self.half) {
            *(if half == 0 { &mut place.re } else { &mut place.im }) = value;
        }
    }
}

/// The original's phases with the reference's amplitudes.
fn with_amplitudes(original: &Raster, reference: &Raster, work: &mut Work) -> Raster {
    let amplitudes = resample_spectrum(reference, original.width, original.height);
    let mut spectrum = work.pyramid.fft().spectrum(&original.values);
    for (value, &amplitude) in spectrum.iter_mut().zip(&amplitudes) {
        let norm = value.norm();
        *value = if norm > 0.0 { *value * (amplitude / norm) } else { Complex64::default() };
    }
    // The mean is a height, not an amplitude: it keeps its sign.
    spectrum[0] = Complex64::new(reference.mean() * original.values.len() as f64, 0.0);
    work.pyramid.fft().image(&mut spectrum)
}
