//! The sub-bands of images of one size, and how those of the reference are spread, which they are
//! matched to.

use crate::distribution::Distribution;
use crate::histogram::Matcher;
use crate::pyramid::{Kind, Pyramid, Sampling};
use asperity_dsp::DesignError;
use asperity_fft::num_complex::Complex64;
use asperity_surface::raster::Raster;

/// Which sub-bands a pass changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Parts {
    /// The oriented ones and the high residual: what a tilt, which no surface that tiles can have,
    /// leaves alone.
    AllButTheSlowest,
    /// All of them.
    All,
}

impl Parts {
    fn hold(self, kind: Kind) -> bool {
        match kind {
            Kind::Oriented { .. } | Kind::HighResidual => true,
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

/// A pyramid and one distribution of the reference a sub-band.
#[derive(Debug, Clone)]
pub(super) struct Bands {
    pub pyramid: Pyramid,
    wanted: Vec<Distribution>,
}

impl Bands {
    /// Analyses `reference` (which tiles) by `bands` × `orientations` for images of `width` ×
    /// `height`; every band is as large as the image.
    pub fn new(
        reference: &Raster,
        [width, height]: [usize; 2],
        [bands, orientations]: [usize; 2],
        scratch: &mut Scratch,
    ) -> Result<Self, DesignError> {
        let (w, h) = (reference.width, reference.height);
        let design = |w, h| Pyramid::new(w, h, bands, orientations, Sampling::Full);
        let mut pyramid = design(w, h).map_err(of_the_reference)?;
        let mut wanted = Vec::new();
        each_subband(&mut pyramid, reference, scratch, |_, values| wanted.push(Distribution::new(values)));
        if (w, h) != (width, height) {
            pyramid = design(width, height)?;
        }
        Ok(Self { pyramid, wanted })
    }

    /// Bands of the same reference, as large as their waves need.
    pub fn reduced(&self, reference: &Raster, scratch: &mut Scratch) -> Result<Self, DesignError> {
        let pyramid = self.pyramid.sampled(Sampling::Reduced);
        let mut theirs = pyramid.clone();
        if [reference.width, reference.height] != [pyramid.width(), pyramid.height()] {
            let [bands, orientations] = pyramid.design();
            theirs = Pyramid::new(reference.width, reference.height, bands, orientations, Sampling::Reduced)?;
        }
        let mut wanted = Vec::new();
        each_subband(&mut theirs, reference, scratch, |_, values| wanted.push(Distribution::new(values)));
        Ok(Self { pyramid, wanted })
    }

    /// Mean distance of equal quantiles of each sub-band of `image`, over the deviation of the
    /// reference's or over `floor` where that is larger.
    pub fn distances(&mut self, image: &Raster, floor: f64, scratch: &mut Scratch) -> Vec<f64> {
        let mut distances = Vec::new();
        let wanted = &self.wanted;
        each_subband(&mut self.pyramid, image, scratch, |index, values| {
            let wanted = &wanted[index];
            let distance = Distribution::on_the_bins_of(values, wanted).distance(wanted);
            distances.push(distance / wanted.deviation().max(floor));
        });
        distances
    }

    /// Splits `image`, spreads the sub-bands of `parts` like the reference's and leaves half the
    /// spectrum of what all add up to in `scratch.sum`.
    pub fn match_all(&mut self, image: &[f64], parts: Parts, scratch: &mut Scratch) {
        let Scratch { matcher, spectrum, sum, subband } = scratch;
        self.pyramid.half_spectrum(image, spectrum);
        self.pyramid.clear_half_spectrum(sum);
        for (index, wanted) in self.wanted.iter().enumerate() {
            subband.clear();
            self.pyramid.split_subband(spectrum, index, subband);
            if parts.hold(self.pyramid.subbands()[index].kind) {
                wanted.give_to(subband, matcher);
            }
            self.pyramid.join_subband(subband, index, sum);
        }
    }
}

/// Calls `each` with the values of the sub-bands of an image.
fn each_subband(
    pyramid: &mut Pyramid,
    image: &Raster,
    scratch: &mut Scratch,
    mut each: impl FnMut(usize, &[f64]),
) {
    pyramid.half_spectrum(&image.values, &mut scratch.spectrum);
    for index in 0..pyramid.subbands().len() {
        scratch.subband.clear();
        pyramid.split_subband(&scratch.spectrum, index, &mut scratch.subband);
        each(index, &scratch.subband);
    }
}

/// An image that is too small is named.
fn of_the_reference(error: DesignError) -> DesignError {
    let field = if error.field == "image side" { "reference side" } else { error.field };
    DesignError { field, ..error }
}
