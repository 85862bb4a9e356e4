//! Rectangles of low frequencies: which frequencies of an image a level keeps, and where they lie
//! on its own grid.

use super::Sampling;
use crate::fft2::{RealFft2, angular_frequency};
use asperity_fft::FftPlanner;
use asperity_fft::num_complex::Complex64;

/// A rectangle of low frequencies and the grid on which they are sampled. Of the frequencies along
/// u only those from zero up count: the others follow, as images are real.
#[derive(Debug, Clone)]
pub(super) struct Level {
    /// Frequencies along u that are kept: zero and up.
    pub columns: usize,
    /// Frequencies along v that are kept: zero and up, and negative ones.
    rows: [usize; 2],
    /// Rows of the image, and so frequencies along v in its spectrum.
    height: usize,
    pub fft: RealFft2,
}

impl Level {
    /// The frequencies that survive `halvings` of the band's upper edge, and their grid.
    pub fn new(
        planner: &mut FftPlanner,
        [width, height]: [usize; 2],
        halvings: usize,
        sampling: Sampling,
    ) -> Self {
        let side = |n: usize| n.div_ceil(1 << halvings);
        let crop = [side(width), side(height)];
        let [w, h] = if sampling == Sampling::Full { [width, height] } else { crop };
        // Filters are zero at and above the Nyquist frequency of a crop that is not the whole
        // spectrum.
        let columns = if halvings == 0 { width / 2 + 1 } else { crop[0].div_ceil(2) };
        let upper = if halvings == 0 { height / 2 + 1 } else { crop[1].div_ceil(2) };
        let rows = [upper, crop[1].div_ceil(2) - 1];
        Self { columns, rows, height, fft: RealFft2::new(planner, w, h) }
    }

    /// A column of the level's spectrum: that of the image where it is kept, times the filter and
    /// `scale`.
    pub fn filtered(
        &self,
        kx: usize,
        spectrum: &[Complex64],
        filter: &[f64],
        scale: f64,
        to: &mut [Complex64],
    ) {
        let [upper, lower] = self.rows;
        let from = &spectrum[kx * self.height..][..self.height];
        let filter = &filter[kx * (upper + lower)..][..upper + lower];
        let product = |to: &mut [Complex64], from: &[Complex64], filter: &[f64]| {
            for ((to, from), gain) in to.iter_mut().zip(from).zip(filter) {
                *to = from * (gain * scale);
            }
        };
        let negative = to.len() - lower;
        product(&mut to[..upper], &from[..upper], &filter[..upper]);
        to[upper..negative].fill(Complex64::default());
        product(&mut to[negative..], &from[self.height - lower..], &filter[upper..]);
    }

    /// Adds to the spectrum of the image a column of the level's, times the filter and `scale`.
    pub fn add_filtered(
        &self,
        kx: usize,
        column: &[Complex64],
        filter: &[f64],
        scale: f64,
        spectrum: &mut [Complex64],
    ) {
        let [upper, lower] = self.rows;
        let to = &mut spectrum[kx * self.height..][..self.height];
        let filter = &filter[kx * (upper + lower)..][..upper + lower];
        let add = |to: &mut [Complex64], from: &[Complex64], filter: &[f64]| {
            for ((to, from), gain) in to.iter_mut().zip(from).zip(filter) {
                *to += from * (gain * scale);
            }
        };
        add(&mut to[..upper], &column[..upper], &filter[..upper]);
        add(&mut to[self.height - lower..], &column[column.len() - lower..], &filter[upper..]);
    }

    /// The kept frequencies of an image `width` wide in the order of the filters: place in half the
    /// spectrum of the image and angular frequency along u and v.
    pub fn frequencies(&self, width: usize) -> impl Iterator<Item = (usize, [f64; 2])> {
        let ([upper, lower], height) = (self.rows, self.height);
        (0..self.columns).flat_map(move |kx| {
            let rows = (0..upper).chain(height - lower..height);
            rows.map(move |ky| {
                (kx * height + ky, [angular_frequency(kx, width), angular_frequency(ky, height)])
            })
        })
    }
}
