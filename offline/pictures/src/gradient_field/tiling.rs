//! Slopes of a surface that tiles, by frequencies.

use super::bands::{Bands, Seen};
use super::noise::Noise;
use super::walls::{Walls, gain};
use super::wiener::Wiener;
use super::{Derivative, Slopes, unpack};
use crate::fft2::{Fft2, angular_frequency};
use asperity_fft::num_complex::Complex64;
use asperity_surface::raster::Raster;
use std::f64::consts::TAU;

/// The spectra of slopes along u and v.
pub(super) struct Tiling {
    fft: Fft2,
    packed: Vec<Complex64>,
    /// −1 when green was turned.
    sign_of_v: f64,
}

impl Tiling {
    pub fn of(field: &Slopes) -> Self {
        let mut image = field.packed();
        let mut packed = vec![Complex64::default(); image.len()];
        let mut fft = Fft2::new(field.along_u.width, field.along_u.height);
        fft.forward(&mut image, &mut packed);
        Self { fft, packed, sign_of_v: 1.0 }
    }

    /// Turns the slopes along v over.
    pub fn turn_v(&mut self) {
        self.sign_of_v = -self.sign_of_v;
    }

    /// Number of frequencies.
    pub fn len(&self) -> usize {
        self.packed.len()
    }

    /// The spectra P and Q at one place.
    fn slopes(&self, place: usize) -> [Complex64; 2] {
        let [p, q] = unpack(&self.packed, place, self.fft.width(), self.fft.height());
        [p, q * self.sign_of_v]
    }

    /// |P|² + |Q|².
    pub fn power(&self, place: usize) -> f64 {
        self.slopes(place).iter().map(Complex64::norm_sqr).sum()
    }

    /// D* (P, Q) / i, and its power with what else is seen.
    fn seen(&self, place: usize, derivative: Derivative) -> (Complex64, Seen) {
        let [dx, dy] = derivative.at_bin(place, self.fft.width(), self.fft.height());
        let [p, q] = self.slopes(place);
        let square = dx * dx + dy * dy;
        let along = (p * dx + q * dy) * Complex64::new(0.0, -1.0);
        let across = if square > 0.0 { (p * dy - q * dx).norm_sqr() / square } else { 0.0 };
        (along, Seen { square, along: along.norm_sqr(), across })
    }

    /// Statistics at every place.
    pub fn all_seen(&self, derivative: Derivative) -> Vec<Seen> {
        (0..self.len()).map(|place| self.seen(place, derivative).1).collect()
    }

    /// Angular frequencies of the columns and of the rows, and the smaller step.
    pub fn frequencies(&self) -> ([Vec<f64>; 2], f64) {
        let sides = [self.fft.width(), self.fft.height()];
        let frequencies = sides.map(|n| (0..n).map(|k| angular_frequency(k, n)).collect());
        (frequencies, TAU / sides[0].max(sides[1]) as f64)
    }

    /// The surface; `noise` is a slope's variance at the most.
    pub fn heights(mut self, derivative: Derivative, noise: f64, walls: Walls) -> Raster {
        let ([along_u, along_v], step) = self.frequencies();
        let seen = self.all_seen(derivative);
        let bands = Bands::new(&along_u, &along_v, step);
        let noise = Noise::of(noise * self.len() as f64, &bands, &seen);
        let wiener = Wiener::measured(&bands, noise, &seen);
        let height = |(place, at): (usize, &Seen)| self.seen(place, derivative).0 * wiener.gain(place, at);
        let mut heights: Vec<Complex64> = seen.iter().enumerate().map(height).collect();
        heights[0] = Complex64::default();
        if !walls.are_none() {
            let [axis_u, axis_v] = [&along_u, &along_v].map(|along| walls.axis(along));
            let places = axis_u.iter().flat_map(|&u| axis_v.iter().map(move |&v| (u, v)));
            heights.iter_mut().zip(places).for_each(|(height, (u, v))| *height *= gain(u, v));
        }
        self.fft.image(&mut heights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradient_field::slopes;
    use asperity_dsp::rng::Rng;

    #[test]
    fn slopes_without_noise_give_the_surface_back() {
        let surface = Raster::from_fn(48, 35, |x, y| {
            let (u, v) = (TAU * x as f64 / 48.0, TAU * y as f64 / 35.0);
            (3.0 * u).cos() + 0.7 * (2.0 * u - 5.0 * v + 0.4).sin()
        });
        for derivative in crate::gradient_field::DERIVATIVES {
            let made = Tiling::of(&slopes(&surface, derivative)).heights(derivative, 0.0, Walls::NONE);
            for (a, b) in made.values.iter().zip(&surface.values) {
                assert!((a - b).abs() < 1e-11, "{derivative:?}");
            }
        }
    }

    #[test]
    fn slopes_that_are_all_noise_have_no_height() {
        let mut rng = Rng::new(5);
        let mut noise = || Raster::from_fn(64, 64, |_, _| rng.normal());
        let field = Slopes { along_u: noise(), along_v: noise() };
        let power = |r: Raster| r.values.iter().map(|z| z * z).sum::<f64>();
        let believed = power(crate::gradient_field::integrate_periodic(&field, Derivative::Central));
        // Whether the noise is known for rounding or not.
        for rounding in [1.0, 1e-9] {
            let filtered = power(Tiling::of(&field).heights(Derivative::Central, rounding, Walls::NONE));
            assert!(filtered < 0.2 * believed, "{rounding}: {filtered} of {believed}");
        }
    }
}
