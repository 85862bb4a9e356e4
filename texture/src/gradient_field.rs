//! Heights from slopes: the surface whose derivatives are nearest to a given field, in the mean square.
//!
//! ```text
//! Z(k) = (D_x* P + D_y* Q) / (|D_x|² + |D_y|²)        Z(0) = 0
//! ```
//! | symbol | here |
//! |---|---|
//! | P, Q | spectra of the slopes along u and v, height per texel |
//! | D_x, D_y | the derivative that made them, [`Derivative`] |
//!
//! Source: R. T. Frankot and R. Chellappa, "A method for enforcing integrability in shape from shading
//! algorithms", IEEE PAMI 10, 1988. Changed: the paper divides by i ω; slopes that somebody computed by
//! differences of texels are put together by the same differences. Which ones they were can be read
//! from the slopes: only with the right ones is D_y P = D_x Q ([`curl`]).
//!
//! A field that does not tile is not taken to repeat: there the same least squares are solved by
//! conjugate gradients, one-sided differences at the borders, with the formula above for a mirrored
//! image as preconditioner.

use crate::fft2::{Fft2, angular_frequency};
use crate::raster::Raster;
use rustfft::num_complex::Complex64;

/// How slopes were taken from heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derivative {
    /// The true derivative, as normals baked from geometry are.
    Exact,
    /// Half the difference of the neighbours on both sides.
    Central,
    /// The same, averaged across with weights ¼, ½, ¼, as many height-to-normal converters do.
    Sobel,
}

/// Every [`Derivative`].
pub const DERIVATIVES: [Derivative; 3] = [Derivative::Exact, Derivative::Central, Derivative::Sobel];

/// Most conjugate gradient steps for a field that does not tile.
const MOST_STEPS: usize = 60;
/// Residual of the normal equations, over its first value, at which they are solved.
const SOLVED: f64 = 1e-5;
/// |D|² below which a frequency in the upper half of the spectrum is left at zero: a difference that
/// does not see a wave (neighbours two apart are equal) cannot tell its height.
const BLIND: f64 = 0.004;
/// The same for [`Derivative::Sobel`], which is nearly blind to many more. Less of it keeps more of sharp creases (2.2 % of
/// the heights of ridges are lost at 0.002, 2.6 % here; 8 bits cost 1.9 % even if the true spectrum is known) and
/// lets more noise into smooth surfaces.
const SOBEL_BLIND: f64 = 0.01;
/// Power over the median power from which a frequency counts as signal.
const CLEAR_OF_NOISE: f64 = 8.0;

impl Derivative {
    /// D_x / i and D_y / i at one frequency, radians per texel.
    #[must_use]
    pub fn symbol(self, [wx, wy]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Exact => [wx, wy],
            Self::Central => [wx.sin(), wy.sin()],
            Self::Sobel => [wx.sin() * 0.5 * (1.0 + wy.cos()), wy.sin() * 0.5 * (1.0 + wx.cos())],
        }
    }

    /// [`Derivative::symbol`] in a `width` × `height` transform: the exact derivative of the highest
    /// frequency of an even side is zero at every texel.
    fn at_bin(self, place: usize, width: usize, height: usize) -> [f64; 2] {
        let (kx, ky) = (place / height, place % height);
        let [mut dx, mut dy] = self.symbol([angular_frequency(kx, width), angular_frequency(ky, height)]);
        if 2 * kx == width {
            dx = 0.0;
        }
        if 2 * ky == height {
            dy = 0.0;
        }
        [dx, dy]
    }

    /// 1/|D|², or 0 where the derivative is blind.
    fn inverse_square(self, place: usize, width: usize, height: usize) -> f64 {
        let [dx, dy] = self.at_bin(place, width, height);
        let square = dx * dx + dy * dy;
        let (wx, wy) = (angular_frequency(place / height, width), angular_frequency(place % height, height));
        let upper_half = wx.hypot(wy) > std::f64::consts::FRAC_PI_2;
        let blind = if self == Self::Sobel { SOBEL_BLIND } else { BLIND };
        if square == 0.0 || (upper_half && square < blind) { 0.0 } else { 1.0 / square }
    }
}

/// A field of slopes: dz/du and dz/dv, height per texel, equally large.
#[derive(Debug, Clone, PartialEq)]
pub struct Slopes {
    /// Along u (to the right).
    pub along_u: Raster,
    /// Along v (downwards).
    pub along_v: Raster,
}

impl Slopes {
    /// p + i q, so that one transform serves both.
    fn packed(&self) -> Vec<Complex64> {
        let both = self.along_u.values.iter().zip(&self.along_v.values);
        both.map(|(&p, &q)| Complex64::new(p, q)).collect()
    }

    /// Mean squared length of the slopes.
    #[must_use]
    pub fn power(&self) -> f64 {
        let square = |r: &Raster| r.values.iter().map(|v| v * v).sum::<f64>();
        (square(&self.along_u) + square(&self.along_v)) / self.along_u.values.len().max(1) as f64
    }
}

/// The spectra of both slopes from that of p + i q, at one place.
fn unpack(packed: &[Complex64], place: usize, width: usize, height: usize) -> [Complex64; 2] {
    let (kx, ky) = (place / height, place % height);
    let mirror = (width - kx) % width * height + (height - ky) % height;
    let (a, b) = (packed[place], packed[mirror].conj());
    [(a + b) * 0.5, (a - b) * Complex64::new(0.0, -0.5)]
}

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

/// How far slopes are from being those of any surface, 0–1: the share of their power that lies across D,
/// Σ |D_y P − D_x Q|²/|D|² / Σ (|P|² + |Q|²), where the slopes stand out of their noise (eight times the median
/// power). A field that does not tile must come as its periodic component.
#[must_use]
pub fn curl(field: &Slopes, derivative: Derivative) -> f64 {
    let (w, h) = (field.along_u.width, field.along_u.height);
    let mut image = field.packed();
    let mut packed = vec![Complex64::default(); image.len()];
    Fft2::new(w, h).forward(&mut image, &mut packed);
    let power = |place| unpack(&packed, place, w, h).iter().map(Complex64::norm_sqr).sum::<f64>();
    let mut powers: Vec<f64> = (1..packed.len()).map(power).collect();
    let middle = powers.len() / 2;
    let floor = CLEAR_OF_NOISE * *powers.select_nth_unstable_by(middle, f64::total_cmp).1;
    let (mut turning, mut all) = (0.0, 0.0);
    for place in 1..packed.len() {
        let [p, q] = unpack(&packed, place, w, h);
        let [dx, dy] = derivative.at_bin(place, w, h);
        if p.norm_sqr() + q.norm_sqr() < floor {
            continue;
        }
        let square = dx * dx + dy * dy;
        if square > 0.0 {
            turning += (p * dy - q * dx).norm_sqr() / square;
            all += p.norm_sqr() + q.norm_sqr();
        }
    }
    if all == 0.0 { 0.0 } else { turning / all }
}

/// Projects slopes onto the nearest ones of a surface that tiles, in place; the plans are made once.
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

/// The surface that need not tile and has these slopes as nearly as possible, mean 0. A constant slope
/// is kept: a plane comes out as a plane.
#[must_use]
pub fn integrate_open(field: &Slopes, derivative: Derivative) -> Raster {
    let (w, h) = (field.along_u.width, field.along_u.height);
    let mut mirrored = Mirrored::new(w, h, derivative);
    let mut residual = transposed_difference(field, derivative);
    let mut solution = vec![0.0; w * h];
    let mut direction = mirrored.precondition(&residual);
    let mut product = dot(&residual, &direction);
    let target = SOLVED * SOLVED * product;
    for _ in 0..MOST_STEPS {
        if product <= target {
            break;
        }
        let surface = Raster { width: w, height: h, values: direction.clone() };
        let image = transposed_difference(&differences(&surface, derivative), derivative);
        let step = product / dot(&direction, &image);
        for ((z, d), (r, a)) in solution.iter_mut().zip(&direction).zip(residual.iter_mut().zip(&image)) {
            *z += step * d;
            *r -= step * a;
        }
        let preconditioned = mirrored.precondition(&residual);
        let next = dot(&residual, &preconditioned);
        for (d, p) in direction.iter_mut().zip(&preconditioned) {
            *d = p + next / product * *d;
        }
        product = next;
    }
    let mean = solution.iter().sum::<f64>() / solution.len() as f64;
    Raster { width: w, height: h, values: solution.iter().map(|z| z - mean).collect() }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The weights of a difference at position `i` of `n`: (first neighbour, weights). Inside, eighth order
/// for the true derivative; fewer neighbours where there are no more.
fn stencil(derivative: Derivative, i: usize, n: usize) -> (usize, &'static [f64]) {
    const ORDERS: [&[f64]; 4] = [
        &[-0.5, 0.0, 0.5],
        &[1.0 / 12.0, -2.0 / 3.0, 0.0, 2.0 / 3.0, -1.0 / 12.0],
        &[-1.0 / 60.0, 3.0 / 20.0, -0.75, 0.0, 0.75, -3.0 / 20.0, 1.0 / 60.0],
        &[1.0 / 280.0, -4.0 / 105.0, 0.2, -0.8, 0.0, 0.8, -0.2, 4.0 / 105.0, -1.0 / 280.0],
    ];
    if n < 3 {
        return if n == 2 { (0, &[-1.0, 1.0]) } else { (0, &[0.0]) };
    }
    let room = i.min(n - 1 - i);
    if room == 0 {
        return match (derivative, i) {
            (Derivative::Exact, 0) => (0, &[-1.5, 2.0, -0.5]),
            (Derivative::Exact, _) => (n - 3, &[0.5, -2.0, 1.5]),
            (_, 0) => (0, &[-1.0, 1.0]),
            _ => (n - 2, &[-1.0, 1.0]),
        };
    }
    let order = if derivative == Derivative::Exact { room.min(4) } else { 1 };
    (i - order, ORDERS[order - 1])
}

/// Calls `each(texel, neighbour, weight along u or 0, weight along v or 0)`.
fn visit(w: usize, h: usize, derivative: Derivative, mut each: impl FnMut(usize, usize, [f64; 2])) {
    let columns: Vec<_> = (0..w).map(|x| stencil(derivative, x, w)).collect();
    // Sobel's average across, folded back at the borders.
    let across: &[(isize, f64)] =
        if derivative == Derivative::Sobel { &[(-1, 0.25), (0, 0.5), (1, 0.25)] } else { &[(0, 1.0)] };
    let fold = |i: usize, by: isize, n: usize| i.saturating_add_signed(by).min(n - 1);
    for y in 0..h {
        let row = stencil(derivative, y, h);
        for (x, (first, weights)) in columns.iter().enumerate() {
            for &(by, share) in across {
                let (yy, xx) = (fold(y, by, h), fold(x, by, w));
                for (k, &weight) in weights.iter().enumerate() {
                    each(y * w + x, yy * w + first + k, [share * weight, 0.0]);
                }
                for (k, &weight) in row.1.iter().enumerate() {
                    each(y * w + x, (row.0 + k) * w + xx, [0.0, share * weight]);
                }
            }
        }
    }
}

/// Slopes of a surface that does not tile.
#[must_use]
pub fn differences(surface: &Raster, derivative: Derivative) -> Slopes {
    let (w, h) = (surface.width, surface.height);
    let mut out = Slopes { along_u: Raster::constant(w, h, 0.0), along_v: Raster::constant(w, h, 0.0) };
    visit(w, h, derivative, |at, from, [u, v]| {
        out.along_u.values[at] += u * surface.values[from];
        out.along_v.values[at] += v * surface.values[from];
    });
    out
}

/// The transpose of [`differences`].
fn transposed_difference(field: &Slopes, derivative: Derivative) -> Vec<f64> {
    let (w, h) = (field.along_u.width, field.along_u.height);
    let mut out = vec![0.0; w * h];
    visit(w, h, derivative, |at, from, [u, v]| {
        out[from] += u * field.along_u.values[at] + v * field.along_v.values[at];
    });
    out
}

/// The inverse of |D|² for an image that goes on mirrored.
struct Mirrored {
    fft: Fft2,
    width: usize,
    height: usize,
    gain: Vec<f64>,
    image: Vec<Complex64>,
    spectrum: Vec<Complex64>,
}

impl Mirrored {
    fn new(width: usize, height: usize, derivative: Derivative) -> Self {
        let (w, h) = (2 * width, 2 * height);
        // The differences used go blind towards the highest frequencies: 4/3 of a sine is near enough.
        let gain = |place| {
            let [dx, dy] = match derivative {
                Derivative::Exact => Derivative::Central.at_bin(place, w, h).map(|d| 4.0 / 3.0 * d),
                other => other.at_bin(place, w, h),
            };
            let (wx, wy) = (angular_frequency(place / h, w), angular_frequency(place % h, h));
            let square = match derivative {
                Derivative::Exact if wx.abs().max(wy.abs()) < 1.8 => wx * wx + wy * wy,
                _ => dx * dx + dy * dy,
            };
            let floor = if wx.hypot(wy) > std::f64::consts::FRAC_PI_2 { 0.2 } else { 0.0 };
            if place == 0 { 0.0 } else { 1.0 / square.max(floor) }
        };
        let zeros = vec![Complex64::default(); w * h];
        let gain = (0..w * h).map(gain).collect();
        Self { fft: Fft2::new(w, h), width, height, gain, image: zeros.clone(), spectrum: zeros }
    }

    fn precondition(&mut self, values: &[f64]) -> Vec<f64> {
        let (w, h) = (self.width, self.height);
        for y in 0..2 * h {
            let row = y.min(2 * h - 1 - y) * w;
            for x in 0..2 * w {
                let value = values[row + x.min(2 * w - 1 - x)];
                self.image[y * 2 * w + x] = Complex64::new(value, 0.0);
            }
        }
        self.fft.forward(&mut self.image, &mut self.spectrum);
        for (value, gain) in self.spectrum.iter_mut().zip(&self.gain) {
            *value *= *gain;
        }
        self.fft.inverse(&mut self.spectrum, &mut self.image);
        let mut out = Vec::with_capacity(w * h);
        for y in 0..h {
            out.extend(self.image[y * 2 * w..y * 2 * w + w].iter().map(|v| v.re));
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn waves(width: usize, height: usize) -> Raster {
        let surface = Raster::from_fn(width, height, |x, y| {
            let (u, v) = (TAU * x as f64 / width as f64, TAU * y as f64 / height as f64);
            (3.0 * u).cos() + 0.7 * (2.0 * u - 5.0 * v + 0.4).sin() + 0.3 * (7.0 * v).cos()
        });
        let mean = surface.mean();
        surface.map(|z| z - mean)
    }

    fn worst(a: &Raster, b: &Raster) -> f64 {
        a.values.iter().zip(&b.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn slopes_of_waves_are_their_derivatives_and_integrate_back() {
        let surface = waves(48, 35);
        let field = slopes(&surface, Derivative::Exact);
        let (u, v) = (TAU * 5.0 / 48.0, TAU * 9.0 / 35.0);
        let p = TAU / 48.0 * (-3.0 * (3.0 * u).sin() + 1.4 * (2.0 * u - 5.0 * v + 0.4).cos());
        assert!((field.along_u.at(5, 9) - p).abs() < 1e-12);
        for derivative in DERIVATIVES {
            let field = slopes(&surface, derivative);
            assert!(curl(&field, derivative) < 1e-25);
            assert!(worst(&integrate_periodic(&field, derivative), &surface) < 1e-11);
        }
    }

    #[test]
    fn the_right_derivative_has_the_smallest_curl() {
        let surface = waves(40, 40);
        for made in DERIVATIVES {
            let field = slopes(&surface, made);
            for other in DERIVATIVES.into_iter().filter(|&d| d != made) {
                assert!(curl(&field, other) > 1e4 * curl(&field, made), "{made:?} taken for {other:?}");
            }
        }
    }

    #[test]
    fn a_surface_that_does_not_tile_comes_back_with_its_tilt() {
        let surface = Raster::from_fn(61, 44, |x, y| {
            let (x, y) = (x as f64 / 10.0, y as f64 / 10.0);
            0.3 * x - 0.2 * y + (x * y * 0.4).sin() + 0.1 * x * x
        });
        let mean = surface.mean();
        let surface = surface.map(|z| z - mean);
        for derivative in DERIVATIVES {
            let field = differences(&surface, derivative);
            let made = integrate_open(&field, derivative);
            let (low, high) = surface.range();
            let error = worst(&made, &surface) / (high - low);
            assert!(error < 1e-3, "{derivative:?}: {error} of the range");
        }
    }

    #[test]
    fn open_differences_of_a_smooth_surface_are_its_derivative() {
        let field = differences(
            &Raster::from_fn(40, 30, |x, y| (0.3 * x as f64).sin() * (0.2 * y as f64).cos()),
            Derivative::Exact,
        );
        let exact = 0.3 * (0.3 * 20.0_f64).cos() * (0.2 * 11.0_f64).cos();
        assert!((field.along_u.at(20, 11) - exact).abs() < 1e-7);
    }

    #[test]
    fn projecting_removes_what_turns_and_keeps_the_rest() {
        let surface = waves(32, 32);
        let field = slopes(&surface, Derivative::Exact);
        let turning = slopes(&waves(32, 32), Derivative::Exact);
        let mut mixed = field.clone();
        // A field of rotated slopes has no height at all.
        for i in 0..mixed.along_u.values.len() {
            mixed.along_u.values[i] -= 0.5 * turning.along_v.values[i];
            mixed.along_v.values[i] += 0.5 * turning.along_u.values[i];
        }
        Projection::new(32, 32, Derivative::Exact).project(&mut mixed);
        assert!(worst(&mixed.along_u, &field.along_u) < 1e-12);
        assert!(worst(&mixed.along_v, &field.along_v) < 1e-12);
    }
}
