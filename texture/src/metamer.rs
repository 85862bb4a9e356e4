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
//! analysis/synthesis", SIGGRAPH 1995, do from noise): at most 0.02 is left (0.004–0.013 measured). It imposes the reference's
//! spectral envelope ([`crate::spectral_envelope`]) between passes, because a sub-band is an octave wide and a finger feels
//! how the power lies within it: without it a machine tells such metamers apart in 0.62–0.78 of the strokes, with it in
//! 0.50–0.56, and 0.5 is chance. Matching overshoots on purpose from the third pass on only: a sub-band far stronger
//! than the reference's would turn over, and the arrangement with it. [`Method::Spectrum`] takes
//! the amplitude spectrum of the reference instead, as the document's claims allow.
//!
//! Images that do not tile are analysed through their periodic component ([`crate::borders`]).

use crate::borders::{Borders, SplitBorders};
use crate::fft2::Fft2;
use crate::histogram::{Histogram, Matcher};
use crate::pyramid::{Kind, Pyramid, Sampling, Subband};
use crate::raster::Raster;
use crate::spectral_envelope::Envelope;
use crate::spectral_resample::{resample, resample_spectrum};
use asperity_dsp::DesignError;
use asperity_fft::num_complex::Complex64;

/// Bands of the document's experiment (256 × 256 texels on 40 × 40 mm).
pub const BANDS: usize = 4;
/// Orientations of the document's experiment.
pub const ORIENTATIONS: usize = 4;
/// Passes of the default method. Source: ours, the fewest that leave a mean band distance below 0.02
/// on wood, grid, Brownian and ridge surfaces matched to each other.
pub const PASSES: usize = 20;
/// How far the first pass moves the heights towards their histogram; later passes less, the last not
/// at all, so that the bands have the last word. All the way every time would lock a surface of
/// few distinct heights (a grid) into the first one that fits: the bands would be undone exactly.
const HEIGHT_STEP: f64 = 0.4;
/// How far each pass moves the surface along the change that matching the bands makes. Beyond 1: the
/// change is the same from pass to pass, only smaller; at 1.7 twenty passes do what fifty do at 1.
const BAND_STEP: f64 = 1.7;
/// First passes that go no further than the change itself: only once the amplitudes are near the reference's does
/// overshooting not turn the original's sub-bands over.
const GENTLE_PASSES: usize = 2;
/// Most that imposing the envelope changes an amplitude in one pass.
const MOST_GAIN: f64 = 2.0;
/// Deviation of a sub-band over that of the heights (−40 dB) below which its distance is measured
/// against this deviation instead of its own.
pub const EMPTY_BAND: f64 = 0.01;

/// How the original is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The document's: oriented bands once, nothing else.
    SinglePass,
    /// Sub-bands, residuals, heights and spectral envelope, this many times.
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
    /// Distance of the heights themselves before, over the reference's standard deviation.
    pub heights_before: f64,
    /// The same after.
    pub heights_after: f64,
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
    progress: impl FnMut(f64),
) -> Result<Metamer, DesignError> {
    check_finite("original", original)?;
    check_finite("reference", reference)?;
    DesignError::check("scale", options.scale, "within 1/64 to 64", |s| (1.0 / 64.0..=64.0).contains(&s))?;
    let borders = options.borders.decide(reference);
    let ours = SplitBorders::of(original, borders);
    let theirs = SplitBorders::of(&scaled(reference, options.scale), borders);
    let mut work = Work::new(&theirs.periodic, options).map_err(of_the_reference)?;
    let target = work.target(&theirs.periodic);
    if (theirs.periodic.width, theirs.periodic.height) != (original.width, original.height) {
        work = Work::new(original, options)?;
    }
    let (before, heights_before) = work.distances(&ours.periodic, &target);
    let mut image = match options.method {
        Method::SinglePass => work.single_pass(&ours.periodic, &target),
        Method::Iterated(passes) => work.iterate(&ours.periodic, &target, passes, progress),
        Method::Spectrum => with_amplitudes(&ours.periodic, &theirs.periodic),
    };
    let (after, heights_after) = work.distances(&image, &target);
    ours.add_borders(&mut image, &theirs);
    let subbands = work.pyramid.subbands().iter().zip(before.into_iter().zip(after));
    let distance = |(subband, (before, after)): (&Subband, (f64, f64))| BandDistance {
        kind: subband.kind,
        wavelength_px: subband.wavelength_px,
        before,
        after,
    };
    Ok(Metamer {
        image,
        bands: subbands.map(distance).collect(),
        heights_before,
        heights_after,
        tileable: borders == Borders::Periodic,
    })
}

fn check_finite(field: &'static str, image: &Raster) -> Result<(), DesignError> {
    let bad = image.values.iter().copied().find(|v| !v.is_finite());
    bad.map_or(Ok(()), |value| Err(DesignError { field, value, expected: "an image of finite numbers" }))
}

/// An image that is too small is named.
fn of_the_reference(error: DesignError) -> DesignError {
    let field = if error.field == "image side" { "reference side" } else { error.field };
    DesignError { field, ..error }
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

/// The reference's histograms and envelope.
struct Target {
    bands: Vec<Histogram>,
    heights: Histogram,
    envelope: Vec<f64>,
}

/// What a pass changes.
#[derive(Clone, Copy, PartialEq)]
enum Parts {
    OrientedBands,
    Subbands,
    SubbandsAndEnvelope,
}

/// Plans and memory for images of one size.
struct Work {
    /// Every band is as large as the image, as in the document.
    pyramid: Pyramid,
    envelope: Envelope,
    matcher: Matcher,
    /// Half the spectra of an image and of what its matched sub-bands add up to.
    spectrum: Vec<Complex64>,
    sum: Vec<Complex64>,
    subband: Vec<f64>,
}

impl Work {
    fn new(image: &Raster, options: &MetamerOptions) -> Result<Self, DesignError> {
        let (width, height) = (image.width, image.height);
        Ok(Self {
            pyramid: Pyramid::new(width, height, options.bands, options.orientations, Sampling::Full)?,
            envelope: Envelope::new(width, height),
            matcher: Matcher::default(),
            spectrum: Vec::new(),
            sum: Vec::new(),
            subband: Vec::new(),
        })
    }

    /// What an image is to be matched to.
    fn target(&mut self, reference: &Raster) -> Target {
        let mut bands = Vec::new();
        self.each_subband(reference, |_, histogram| bands.push(histogram));
        let envelope = self.envelope.power(&self.spectrum);
        Target { bands, heights: self.matcher.histogram(&reference.values), envelope }
    }

    /// Distances of an image's sub-bands and of its heights.
    fn distances(&mut self, image: &Raster, target: &Target) -> (Vec<f64>, f64) {
        // A sub-band that the reference does not have cannot be measured in its own deviations.
        let floor = EMPTY_BAND * target.heights.deviation().max(f64::MIN_POSITIVE);
        let relative = |of: Histogram, to: &Histogram| of.distance(to) / to.deviation().max(floor);
        let mut bands = Vec::new();
        self.each_subband(image, |index, histogram| bands.push(relative(histogram, &target.bands[index])));
        (bands, relative(self.matcher.histogram(&image.values), &target.heights))
    }

    /// Calls `each` with the sub-bands of an image and leaves its spectrum in `spectrum`.
    fn each_subband(&mut self, image: &Raster, mut each: impl FnMut(usize, Histogram)) {
        self.pyramid.half_spectrum(&image.values, &mut self.spectrum);
        for index in 0..self.pyramid.subbands().len() {
            self.subband.clear();
            self.pyramid.split_subband(&self.spectrum, index, &mut self.subband);
            each(index, self.matcher.histogram(&self.subband));
        }
    }

    /// The document's: the oriented bands once.
    fn single_pass(&mut self, original: &Raster, target: &Target) -> Raster {
        let mut made = original.clone();
        self.pass(original, target, Parts::OrientedBands, &mut made.values);
        made
    }

    /// Repeats passes over everything; the last one goes all the way and no further.
    fn iterate(
        &mut self,
        original: &Raster,
        target: &Target,
        passes: usize,
        mut progress: impl FnMut(f64),
    ) -> Raster {
        let mut image = original.clone();
        let mut made = Vec::new();
        for pass in 1..=passes {
            made.clone_from(&image.values);
            self.matcher.run(&mut made, &target.heights);
            step(&mut image.values, &made, HEIGHT_STEP * (passes - pass) as f64 / passes as f64);
            let last = pass == passes;
            let parts = if last { Parts::Subbands } else { Parts::SubbandsAndEnvelope };
            self.pass(&image, target, parts, &mut made);
            let all_the_way = last || pass <= GENTLE_PASSES;
            step(&mut image.values, &made, if all_the_way { 1.0 } else { BAND_STEP });
            progress(pass as f64 / passes as f64);
        }
        image
    }

    /// Splits, matches every sub-band and joins.
    fn pass(&mut self, image: &Raster, target: &Target, parts: Parts, made: &mut Vec<f64>) {
        self.pyramid.half_spectrum(&image.values, &mut self.spectrum);
        if parts == Parts::SubbandsAndEnvelope {
            self.envelope.impose(&mut self.spectrum, &target.envelope, MOST_GAIN);
        }
        self.pyramid.clear_half_spectrum(&mut self.sum);
        for (index, reference) in target.bands.iter().enumerate() {
            self.subband.clear();
            self.pyramid.split_subband(&self.spectrum, index, &mut self.subband);
            let kind = self.pyramid.subbands()[index].kind;
            if parts != Parts::OrientedBands || matches!(kind, Kind::Oriented { .. }) {
                self.matcher.run(&mut self.subband, reference);
            }
            self.pyramid.join_subband(&self.subband, index, &mut self.sum);
        }
        self.pyramid.image(&self.sum, made);
    }
}

/// Moves `values` by `fraction` of the way to `goal`.
fn step(values: &mut [f64], goal: &[f64], fraction: f64) {
    for (value, goal) in values.iter_mut().zip(goal) {
        *value += fraction * (goal - *value);
    }
}

/// The original's phases with the reference's amplitudes.
fn with_amplitudes(original: &Raster, reference: &Raster) -> Raster {
    let mut fft = Fft2::new(original.width, original.height);
    let amplitudes = resample_spectrum(reference, original.width, original.height);
    let mut spectrum = fft.spectrum(&original.values);
    for (value, &amplitude) in spectrum.iter_mut().zip(&amplitudes) {
        let norm = value.norm();
        *value = if norm > 0.0 { *value * (amplitude / norm) } else { Complex64::default() };
    }
    // The mean is a height, not an amplitude: it keeps its sign.
    spectrum[0] = Complex64::new(reference.mean() * original.values.len() as f64, 0.0);
    fft.image(&mut spectrum)
}
