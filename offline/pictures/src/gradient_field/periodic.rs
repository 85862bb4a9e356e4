//! Fields that tile: slopes, the nearest integrable ones, and heights, by Fourier transforms.

use super::{Derivative, Slopes, unpack};
use crate::fft2::Fft2;
use asperity_fft::num_complex::Complex64;
use asperity_surface::raster::Raster;

/// The slopes of a surface that tiles.
#[must_use]
pub fn slopes(surface: &Raster, derivative: Derivative) -> Slopes {
    let (w, h) = (surface.width, surface.height);
    let mut fft = Fft2::new(w, h);
    let mut packed = fft.spectrum(&surface.values);
    for (place, value) in packed.iter_mut().enumerate() {
        let [dx, dy] = derivative.at_bin(place, w, h);
        // i dx Z + i · (i dy Z)
        *value *= Complex64::new(-dy, dx);
    }
    let mut image = vec![Complex64::default(); packed.len()];
    fft.inverse(&mut packed, &mut image);
    unzip(&image, w, h)
}

fn unzip(image: &[Complex64], width: usize, height: usize) -> Slopes {
    let raster = |values| Raster { width, height, values };
    Slopes {
        along_u: raster(image.iter().map(|v| v.re).collect()),
        along_v: raster(image.iter().map(|v| v.im).collect()),
    }
}

/// Projects slopes onto the nearest ones of a surface that tiles, in place; the plans are made
/// once.
#[derive(Debug)]
pub struct Projection {
    fft: Fft2,
    image: Vec<Complex64>,
    packed: Vec<Complex64>,
    heights: Vec<Complex64>,
    /// D_x, D_y and 1/|D|².
    table: Vec<[f64; 3]>,
}

impl Projection {
    /// For fields of `width` × `height`.
    #[must_use]
    pub fn new(width: usize, height: usize, derivative: Derivative) -> Self {
        let zeros = vec![Complex64::default(); width * height];
        let entry = |place| {
            let [dx, dy] = derivative.at_bin(place, width, height);
            [dx, dy, derivative.inverse_square(place, width, height)]
        };
        Self {
            fft: Fft2::new(width, height),
            image: zeros.clone(),
            packed: zeros.clone(),
            heights: zeros,
            table: (0..width * height).map(entry).collect(),
        }
    }

    /// Replaces the slopes by the nearest integrable ones.
    pub fn project(&mut self, field: &mut Slopes) {
        self.solve(field);
        for ((to, z), [dx, dy, _]) in self.packed.iter_mut().zip(&self.heights).zip(&self.table) {
            *to = *z * Complex64::new(-dy, *dx);
        }
        self.fft.inverse(&mut self.packed, &mut self.image);
        let both = field.along_u.values.iter_mut().zip(&mut field.along_v.values);
        for ((p, q), value) in both.zip(&self.image) {
            (*p, *q) = (value.re, value.im);
        }
    }

    /// The surface whose slopes are nearest, mean 0.
    #[must_use]
    pub fn heights(&mut self, field: &Slopes) -> Raster {
        self.solve(field);
        self.fft.image(&mut self.heights)
    }

    fn solve(&mut self, field: &Slopes) {
        let (w, h) = (self.fft.width(), self.fft.height());
        for (to, value) in self.image.iter_mut().zip(field.packed()) {
            *to = value;
        }
        self.fft.forward(&mut self.image, &mut self.packed);
        for (place, (to, [dx, dy, inverse])) in self.heights.iter_mut().zip(&self.table).enumerate() {
            let [p, q] = unpack(&self.packed, place, w, h);
            *to = (p * *dx + q * *dy) * Complex64::new(0.0, -*inverse);
        }
    }
}

/// The surface that tiles and has these slopes as nearly as possible, mean 0.
#[must_use]
pub fn integrate_periodic(field: &Slopes, derivative: Derivative) -> Raster {
    Projection::new(field.along_u.width, field.along_u.height, derivative).heights(field)
}
