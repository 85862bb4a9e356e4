//! Tactile metamers: a surface rearranged until it feels like a reference.
//!
//! ```text
//! S'_{λ,μ} = F_r⁻¹(F_c(S_{λ,μ}))        I' = Σ Ψ_{λ,μ} S'_{λ,μ}
//! ```
//! Every sub-band S of the original's steerable pyramid ([`crate::pyramid`]) is given the histogram
//! of the reference's; the result keeps the spatial arrangement of the original and, to a finger,
//! the feel of the reference (document 002, which describes a granted US patent).
//!
//! | symbol | here |
//! |---|---|
//! | I_c, I_r | `original`, `reference`: heights in one unit |
//! | λ, μ | [`MetamerOptions::bands`], [`MetamerOptions::orientations`] (document: 4, 4 for 256²) |
//! | F_r⁻¹(F_c(·)) | [`crate::histogram`] |
//!
//! What we changed, and its measured effect (re-analysed distance of the sub-bands, W1/σ, mean):
//! the document matches the bands once. Filters overlap, so that joining the bands spoils their
//! histograms again: 0.09–0.74 is left. [`Method::Iterated`], the default, also matches the two
//! residuals and the heights themselves and repeats (as D. J. Heeger and J. R. Bergen,
//! "Pyramid-based texture analysis/synthesis", SIGGRAPH 1995, do from noise): 0.002–0.02 is left.
//! It imposes the reference's spectral envelope ([`crate::spectral_envelope`]) between passes,
//! because a sub-band is an octave wide and a finger feels how the power lies within it. The
//! heights come last in each pass: plateaus stay flat, and no height leaves the reference's range.
//! Coarse grids settle before fine ones (`metamer/level.rs`).
//!
//! A surface that does not come within [`REACH`] so is tried again with a memory of what the
//! heights took back (terraces, surfaces of at most 64 heights, begin so, with more passes on fine
//! grids, again and again over all grids, and from the smooth ground under them:
//! `metamer/terraces.rs`), then with momentum, which gives up more of the original's arrangement,
//! and then from mixtures of the original and the reference: of bars or holes of two heights that
//! repeat exactly hardly any other arrangement has the same sub-bands. [`Metamer::borrowed`] states
//! how much was taken, and [`MetamerOptions::borrow`] limits it. [`Method::Spectrum`] takes the
//! amplitude spectrum of the reference instead, as the document's claims allow.
//!
//! | reference (256²) | left before, heights | left now, heights, taken of the reference |
//! |---|---|---|
//! | walkway, 63 % flat floor | 0.034, clipped to 0.18 | 0.020, 0.000, 0 |
//! | diamond plate | 0.062 | 0.008, 0.000, 0 |
//! | perforated sheet, two heights | 0.11 | 0.018, 0.000, 0.25 |
//! | black and white grid | 0.049, clipped to 0.18 | 0.019, 0.000, 0.25 |
//!
//! Images that do not tile are analysed through their periodic component ([`crate::borders`]), each
//! by its own borders. The result has the original's steps at its borders, as strong as the
//! reference's, where both have some, and tiles otherwise. What a reference at another scale has
//! beyond its own range after resampling is cut off.

mod arrangement;
mod bands;
mod level;
mod search;
mod spectrum;
mod statistics;
mod terraces;

pub use statistics::Statistics;

use crate::borders::Borders;
use crate::pyramid::Subband;
use asperity_dsp::DesignError;
use asperity_surface::raster::Raster;

/// Bands of the document's experiment (256 × 256 texels on 40 × 40 mm).
pub const BANDS: usize = 4;
/// Orientations of the document's experiment.
pub const ORIENTATIONS: usize = 4;
/// Passes of the default method on a grid of 256 × 256 texels; coarser grids get more, finer ones
/// fewer. Source: ours, the fewest that leave a mean band distance below 0.02 on wood, grid,
/// Brownian and ridge surfaces and on maps of metal, leather, rock and grass matched to each other.
pub const PASSES: usize = 20;
/// Mean distance of the oriented bands that counts as near enough.
pub const REACH: f64 = 0.02;
/// Shares of the reference's own arrangement that are tried one after the other while the result is
/// not near enough.
pub const BORROWED: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 0.9];
/// Deviation of a sub-band over that of the heights (−40 dB) below which its distance is measured
/// against this deviation instead of its own.
pub const EMPTY_BAND: f64 = 0.01;

/// Way of changing the original.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The document's: oriented bands once, nothing else.
    SinglePass,
    /// Sub-bands, residuals, heights and spectral envelope, this many times.
    Iterated(usize),
    /// The reference's amplitude spectrum with the original's phases.
    Spectrum,
}

/// Match and its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MetamerOptions {
    /// Bands of wavelength, an octave each.
    pub bands: usize,
    /// Orientations of each band.
    pub orientations: usize,
    /// Way of changing the original.
    pub method: Method,
    /// True where the images tile.
    pub borders: Borders,
    /// Size of a texel of the original over that of the reference; 1 when both have the same scale.
    pub scale: f64,
    /// Mean distance of the oriented bands at which [`Method::Iterated`] ends before its passes are
    /// done; all of them where there is none.
    pub until: Option<f64>,
    /// Largest share of the reference's own arrangement (0–1) that may be taken where the
    /// original's does not come within `until`, or [`REACH`].
    pub borrow: f64,
}

impl Default for MetamerOptions {
    fn default() -> Self {
        Self {
            bands: BANDS,
            orientations: ORIENTATIONS,
            method: Method::Iterated(PASSES),
            borders: Borders::Detect,
            scale: 1.0,
            until: None,
            borrow: 1.0,
        }
    }
}

/// Distance of an image from a reference: mean distances between equal quantiles, over the
/// reference's standard deviation.
#[derive(Debug, Clone, PartialEq)]
pub struct Distance {
    /// One a sub-band, from fine to coarse, with the residuals first and last.
    pub subbands: Vec<f64>,
    /// Mean over the oriented sub-bands.
    pub mean: f64,
    /// Distance of the heights themselves.
    pub heights: f64,
}

/// The result.
#[derive(Debug, Clone, PartialEq)]
pub struct Metamer {
    /// As large as the original, in the reference's unit of height. [`Method::Iterated`] leaves no
    /// height outside the reference's range, the other methods do.
    pub image: Raster,
    /// Subject of the distances.
    pub subbands: Vec<Subband>,
    /// Distance of the original.
    pub before: Distance,
    /// Distance of `image`, analysed anew.
    pub after: Distance,
    /// True where `image` tiles.
    pub tileable: bool,
    /// Passes done on the image's own grid.
    pub passes: usize,
    /// Share of the reference's own arrangement in the surface that the passes began with. A
    /// surface of few heights that repeats exactly (a grid, a perforated sheet) admits hardly any
    /// other. What is left of either arrangement in the end the correlations show.
    pub borrowed: f64,
    /// Mean correlation of the oriented sub-bands with the original's: 1 where its arrangement is
    /// kept, 0 where nothing of it is left.
    pub correlation_with_original: f64,
    /// Correlation with the reference's, laid out over the original's size and moved to where it is
    /// highest: a grid that was moved is still the grid. Strangers of 256² texels reach 0.07–0.1
    /// so.
    pub correlation_with_reference: f64,
    /// Shift of the reference for that along u and v, texels.
    pub shift_from_reference_px: [usize; 2],
}

/// Makes `original` feel like `reference`. `progress` gets the fraction done.
///
/// # Errors
/// When an image holds numbers that are not finite, when one is too small for the bands (each side
/// at least 2^(bands + 1) texels, the reference after scaling), or when `scale` is not within
/// 1/64–64.
pub fn metamer(
    original: &Raster,
    reference: &Raster,
    options: &MetamerOptions,
    progress: impl FnMut(f64),
) -> Result<Metamer, DesignError> {
    check_finite("original", original)?;
    Statistics::new(reference, original.width, original.height, options)?.metamer(
        original,
        |image| image,
        progress,
    )
}

fn check_finite(field: &'static str, image: &Raster) -> Result<(), DesignError> {
    let bad = image.values.iter().copied().find(|v| !v.is_finite());
    bad.map_or(Ok(()), |value| Err(DesignError { field, value, expected: "an image of finite numbers" }))
}
