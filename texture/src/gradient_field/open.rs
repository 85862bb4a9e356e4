//! Fields that do not tile: one-sided differences at the borders, and conjugate gradients with the formula for a mirrored
//! image as preconditioner.
//!
//! That is for true derivatives; differences of neighbours are put together by mirroring the field ([`super::mirrored`]).

use super::mirrored::{BorderShare, integrate_mirrored};
use super::{Derivative, Slopes};
use crate::fft2::{Fft2, angular_frequency};
use crate::raster::Raster;
use asperity_fft::num_complex::Complex64;

/// Most conjugate gradient steps for a field that does not tile.
const MOST_STEPS: usize = 60;
/// Residual of the normal equations, over its first value, at which they are solved.
const SOLVED: f64 = 1e-5;

/// The surface that need not tile and has these slopes as nearly as possible, mean 0. A constant slope
/// is kept: a plane comes out as a plane.
#[must_use]
pub fn integrate_open(field: &Slopes, derivative: Derivative) -> Raster {
    integrate_open_rounded(field, derivative, f64::INFINITY)
}

/// The same where the slopes have a noise of variance `noise` at the most. Only differences of neighbours, which are blind to short waves, need
/// to know.
#[must_use]
pub fn integrate_open_rounded(field: &Slopes, derivative: Derivative, noise: f64) -> Raster {
    match derivative {
        Derivative::Central | Derivative::Sobel => integrate_mirrored(field, derivative, noise),
        Derivative::Exact | Derivative::ExactOrCentral => integrate_by_steps(field, derivative),
    }
}

fn integrate_by_steps(field: &Slopes, derivative: Derivative) -> Raster {
    let (w, h) = (field.along_u.width, field.along_u.height);
    let share = match (derivative, BorderShare::of(field)) {
        (Derivative::Exact, _) | (_, BorderShare::Whole) => 1.0,
        (_, BorderShare::Half) => 0.5,
        (_, BorderShare::None) => 0.0,
    };
    let mut mirrored = Mirrored::new(w, h, derivative);
    let mut residual = transposed_difference(field, derivative, share);
    let mut solution = vec![0.0; w * h];
    let mut direction = mirrored.precondition(&residual);
    let mut product = dot(&residual, &direction);
    let target = SOLVED * SOLVED * product;
    for _ in 0..MOST_STEPS {
        if product <= target {
            break;
        }
        let surface = Raster { width: w, height: h, values: direction.clone() };
        let image = transposed_difference(&differences_with(&surface, derivative, share), derivative, share);
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
/// for the true derivative; fewer neighbours where there are no more, and `share` of the difference to the only one.
fn stencil(derivative: Derivative, share: f64, i: usize, n: usize) -> (usize, Vec<f64>) {
    const ORDERS: [&[f64]; 4] = [
        &[-0.5, 0.0, 0.5],
        &[1.0 / 12.0, -2.0 / 3.0, 0.0, 2.0 / 3.0, -1.0 / 12.0],
        &[-1.0 / 60.0, 3.0 / 20.0, -0.75, 0.0, 0.75, -3.0 / 20.0, 1.0 / 60.0],
        &[1.0 / 280.0, -4.0 / 105.0, 0.2, -0.8, 0.0, 0.8, -0.2, 4.0 / 105.0, -1.0 / 280.0],
    ];
    if n < 3 {
        return (0, if n == 2 { vec![-1.0, 1.0] } else { vec![0.0] });
    }
    if derivative == Derivative::ExactOrCentral {
        return half_way(stencil(Derivative::Exact, share, i, n), &stencil(Derivative::Central, share, i, n));
    }
    let exact = derivative == Derivative::Exact;
    let room = i.min(n - 1 - i);
    if room > 0 {
        let order = if exact { room.min(4) } else { 1 };
        return (i - order, ORDERS[order - 1].to_vec());
    }
    match (exact, i) {
        (true, 0) => (0, vec![-1.5, 2.0, -0.5]),
        (true, _) => (n - 3, vec![0.5, -2.0, 1.5]),
        (false, 0) => (0, vec![-share, share]),
        (false, _) => (n - 2, vec![-share, share]),
    }
}

/// The mean of two stencils, the first of which spans the second.
fn half_way(wide: (usize, Vec<f64>), narrow: &(usize, Vec<f64>)) -> (usize, Vec<f64>) {
    let (first, mut weights) = wide;
    weights.iter_mut().for_each(|weight| *weight *= 0.5);
    for (weight, other) in weights[narrow.0 - first..].iter_mut().zip(&narrow.1) {
        *weight += 0.5 * other;
    }
    (first, weights)
}

/// Calls `each(texel, neighbour, weight along u or 0, weight along v or 0)`.
fn visit(
    (w, h): (usize, usize),
    derivative: Derivative,
    share: f64,
    mut each: impl FnMut(usize, usize, [f64; 2]),
) {
    let columns: Vec<_> = (0..w).map(|x| stencil(derivative, share, x, w)).collect();
    // Sobel's average across, folded back at the borders.
    let across: &[(isize, f64)] =
        if derivative == Derivative::Sobel { &[(-1, 0.25), (0, 0.5), (1, 0.25)] } else { &[(0, 1.0)] };
    let fold = |i: usize, by: isize, n: usize| i.saturating_add_signed(by).min(n - 1);
    for y in 0..h {
        let row = stencil(derivative, share, y, h);
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
    differences_with(surface, derivative, 1.0)
}

fn differences_with(surface: &Raster, derivative: Derivative, share: f64) -> Slopes {
    let (w, h) = (surface.width, surface.height);
    let mut out = Slopes { along_u: Raster::constant(w, h, 0.0), along_v: Raster::constant(w, h, 0.0) };
    visit((w, h), derivative, share, |at, from, [u, v]| {
        out.along_u.values[at] += u * surface.values[from];
        out.along_v.values[at] += v * surface.values[from];
    });
    out
}

/// The transpose of [`differences_with`].
fn transposed_difference(field: &Slopes, derivative: Derivative, share: f64) -> Vec<f64> {
    let (w, h) = (field.along_u.width, field.along_u.height);
    let mut out = vec![0.0; w * h];
    visit((w, h), derivative, share, |at, from, [u, v]| {
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
