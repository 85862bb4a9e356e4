//! The sub-bands of images of one size, and the reference's histograms that they are matched to.

use crate::histogram::{Histogram, Matcher};
use crate::pyramid::{Kind, Pyramid, Sampling};
use crate::raster::Raster;
use asperity_dsp::DesignError;
use asperity_fft::num_complex::Complex64;

/// Which sub-bands a pass changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Parts {
    /// The oriented ones: the document's pass.
    Oriented,
    /// These and the high residual: what a tilt, which no surface that tiles can have, leaves alone.
    AllButTheSlowest,
    /// All of them.
    All,
}

impl Parts {
    fn hold(self, kind: Kind) -> bool {
        match kind {
            Kind::Oriented { .. } => true,
            Kind::HighResidual => self != Self::Oriented,
            Kind::LowResidual => self == Self::All,
        }
    }
}

/// Memory that passes share.
#[derive(Debug, Clone, Default)]
pub(super) struct Scratch {
    pub matcher: Matcher,
    /// Half the spectra of an image and of what its matched sub-bands add up to.
    spectrum: Vec<Complex64>,
    pub sum: Vec<Complex64>,
    subband: Vec<f64>,
}

/// A pyramid and one histogram of the reference a sub-band.
#[derive(Debug, Clone)]
pub(super) struct Bands {
    pub pyramid: Pyramid,
    wanted: Vec<Histogram>,
}

impl Bands {
    /// Analyses `reference` (which tiles) by `bands` × `orientations` for images of `width` × `height`.
    pub fn new(
        reference: &Raster,
        [width, height]: [usize; 2],
        [bands, orientations]: [usize; 2],
        sampling: Sampling,
        scratch: &mut Scratch,
    ) -> Result<Self, DesignError> {
        let (w, h) = (reference.width, reference.height);
        let mut pyramid = Pyramid::new(w, h, bands, orientations, sampling).map_err(of_the_reference)?;
        let mut wanted = Vec::new();
        each_subband(&mut pyramid, reference, scratch, |_, histogram| wanted.push(histogram));
        if (w, h) != (width, height) {
            pyramid = Pyramid::new(width, height, bands, orientations, sampling)?;
        }
        Ok(Self { pyramid, wanted })
    }

    /// [`relative`] distance of each sub-band of `image`.
    pub fn distances(&mut self, image: &Raster, floor: f64, scratch: &mut Scratch) -> Vec<f64> {
        let mut distances = Vec::new();
        let wanted = &self.wanted;
        each_subband(&mut self.pyramid, image, scratch, |index, histogram| {
            distances.push(relative(&histogram, &wanted[index], floor));
        });
        distances
    }

    /// Splits `image`, gives the sub-bands of `parts` the reference's histograms and leaves half the spectrum of what all
    /// add up to in `scratch.sum`.
    pub fn match_all(&mut self, image: &[f64], parts: Parts, scratch: &mut Scratch) {
        let Scratch { matcher, spectrum, sum, subband } = scratch;
        self.pyramid.half_spectrum(image, spectrum);
        self.pyramid.clear_half_spectrum(sum);
        for (index, wanted) in self.wanted.iter().enumerate() {
            subband.clear();
            self.pyramid.split_subband(spectrum, index, subband);
            if parts.hold(self.pyramid.subbands()[index].kind) {
                matcher.run(subband, wanted);
            }
            self.pyramid.join_subband(subband, index, sum);
        }
    }
}

/// Mean distance of equal quantiles over the deviation of `to`, or over `floor` where that is larger.
pub(super) fn relative(of: &Histogram, to: &Histogram, floor: f64) -> f64 {
    of.distance(to) / to.deviation().max(floor)
}

/// Calls `each` with the histograms of the sub-bands of an image.
fn each_subband(
    pyramid: &mut Pyramid,
    image: &Raster,
    scratch: &mut Scratch,
    mut each: impl FnMut(usize, Histogram),
) {
    pyramid.half_spectrum(&image.values, &mut scratch.spectrum);
    for index in 0..pyramid.subbands().len() {
        scratch.subband.clear();
        pyramid.split_subband(&scratch.spectrum, index, &mut scratch.subband);
        each(index, scratch.matcher.histogram(&scratch.subband));
    }
}

/// An image that is too small is named.
fn of_the_reference(error: DesignError) -> DesignError {
    let field = if error.field == "image side" { "reference side" } else { error.field };
    DesignError { field, ..error }
}
