//! Slopes of a surface that does not tile, by the waves of its mirror image.
//!
//! A surface that goes on mirrored tiles, and differences of it are those of the map with their
//! signs turned. Steps from texel to texel ([`super::steps`]) are such differences, which no wave
//! escapes: true slopes are made into steps first. Central differences and Sobel's are mirrored as
//! they are, borders as in [`super::border_share`]. In each case one transform solves the least
//! squares exactly.

use super::bands::{Bands, Seen};
use super::border_share::BorderShare;
use super::mirror_transform::{Mirror, MirrorTransform, Waves, frequencies};
use super::noise::Noise;
use super::steps;
use super::walls::{Walls, gain};
use super::wiener::Wiener;
use super::{Derivative, Slopes};
use asperity_surface::raster::Raster;
use std::f64::consts::PI;

/// Most that steps are raised where the slopes' integrals miss a part of a wave; what is raised
/// rings at the borders.
const RAISED: f64 = 1.4;

/// Waves of slopes or steps along u and v.
pub(super) struct Open {
    p: Waves,
    q: Waves,
    /// Frequencies of the columns and the rows, radians per texel.
    along_u: Vec<f64>,
    along_v: Vec<f64>,
    /// Continuation of the surface.
    mirror: Mirror,
    /// True where p and q are steps made of true slopes.
    steps: bool,
    width: usize,
    height: usize,
}

impl Open {
    /// Field of slopes taken by `derivative`; all that are neither central nor Sobel's are true
    /// slopes.
    pub fn of(field: &Slopes, derivative: Derivative) -> Self {
        let (width, height) = (field.along_u.width, field.along_u.height);
        let mut transform = MirrorTransform::default();
        let mut waves = |p: &Raster, q: &Raster, odd: Mirror, even: Mirror| {
            [transform.forward(p, [odd, even]), transform.forward(q, [even, odd])]
        };
        let steps = !matches!(derivative, Derivative::Central | Derivative::Sobel);
        let (mirror, [p, q]) = if steps {
            let (p, q) = (steps::along_u(&field.along_u), steps::along_v(&field.along_v));
            (Mirror::EvenBetween, waves(&p, &q, Mirror::OddAt, Mirror::EvenBetween))
        } else if BorderShare::of(field) == BorderShare::None {
            let p = Raster::from_fn(width - 2, height, |x, y| field.along_u.at(x + 1, y));
            let q = Raster::from_fn(width, height - 2, |x, y| field.along_v.at(x, y + 1));
            (Mirror::EvenAt, waves(&p, &q, Mirror::OddAt, Mirror::EvenAt))
        } else {
            let [p, q] = halved_at_borders(field);
            (Mirror::EvenBetween, waves(&p, &q, Mirror::OddBetween, Mirror::EvenBetween))
        };
        let (along_u, along_v) = (frequencies(p.along_u), frequencies(p.along_v));
        Self { p, q, along_u, along_v, mirror, steps, width, height }
    }

    /// Turns the slopes along v over.
    pub fn turn_v(&mut self) {
        self.q.values.iter_mut().for_each(|q| *q = -*q);
    }

    /// D* (P, Q) at every place, and its power with what else is seen.
    fn seen(&self, derivative: Derivative) -> (Vec<f64>, Vec<Seen>) {
        let raised = |frequencies: &[f64]| -> Vec<f64> {
            frequencies
                .iter()
                .map(|&omega| if self.steps { raised(omega, derivative) } else { 1.0 })
                .collect()
        };
        let (raised_u, raised_v) = (raised(&self.along_u), raised(&self.along_v));
        let (mut alongs, mut seen) = (Vec::new(), Vec::new());
        for (kx, &wx) in self.along_u.iter().enumerate() {
            for (ky, &wy) in self.along_v.iter().enumerate() {
                let place = kx * self.along_v.len() + ky;
                let [dx, dy] = if self.steps {
                    [wx, wy].map(|w| 2.0 * (0.5 * w).sin())
                } else {
                    derivative.symbol([wx, wy])
                };
                // Cosines fall where sines are positive.
                let (p, q) = (-raised_u[kx] * self.p.values[place], -raised_v[ky] * self.q.values[place]);
                let (square, along, across) = (dx * dx + dy * dy, p * dx + q * dy, p * dy - q * dx);
                let across = if square > 0.0 { across * across / square } else { 0.0 };
                alongs.push(along);
                seen.push(Seen { square, along: along * along, across });
            }
        }
        (alongs, seen)
    }

    /// Statistics at every place.
    pub fn all_seen(&self, derivative: Derivative) -> Vec<Seen> {
        self.seen(derivative).1
    }

    /// The surface; `noise` is a slope's variance at the most.
    pub fn heights(self, derivative: Derivative, noise: f64, walls: Walls) -> Raster {
        let (mut waves, seen) = self.seen(derivative);
        let bands = Bands::new(&self.along_u, &self.along_v, PI / self.width.max(self.height) as f64);
        // Cosines and sines have a quarter of the power of a spectrum's lines.
        let noise = Noise::of(0.25 * noise * (self.width * self.height) as f64, &bands, &seen);
        let wiener = Wiener::measured(&bands, noise, &seen);
        for (place, (wave, seen)) in waves.iter_mut().zip(&seen).enumerate() {
            *wave *= wiener.gain(place, seen);
        }
        waves[0] = 0.0;
        if !walls.are_none() {
            let [axis_u, axis_v] = [&self.along_u, &self.along_v].map(|along| walls.axis(along));
            let places = axis_u.iter().flat_map(|&u| axis_v.iter().map(move |&v| (u, v)));
            waves.iter_mut().zip(places).for_each(|(wave, (u, v))| *wave *= gain(u, v));
        }
        let waves = Waves { values: waves, ..self.p };
        let made = MirrorTransform::default().inverse(&waves, self.width, self.height, self.mirror);
        let mean = made.mean();
        made.map(|z| z - mean)
    }
}

/// Filter that makes steps of true slopes' integrals, and of slopes half way between true and
/// central ones.
fn raised(omega: f64, derivative: Derivative) -> f64 {
    let missed = steps::seen_inside(omega).max(1.0 / RAISED).recip();
    let taken = if derivative == Derivative::ExactOrCentral && omega > 0.0 {
        omega / super::half_way(omega)
    } else {
        1.0
    };
    missed * taken
}

/// Slopes along u and v with half of the difference to the only neighbour at the borders.
fn halved_at_borders(field: &Slopes) -> [Raster; 2] {
    let [mut p, mut q] = [field.along_u.clone(), field.along_v.clone()];
    if BorderShare::of(field) == BorderShare::Whole {
        let (w, h) = (p.width, p.height);
        for y in 0..h {
            p.values[y * w] *= 0.5;
            p.values[y * w + w - 1] *= 0.5;
        }
        for x in 0..w {
            q.values[x] *= 0.5;
            q.values[(h - 1) * w + x] *= 0.5;
        }
    }
    [p, q]
}

/// The surface that need not tile and has these slopes as nearly as possible, mean 0. A constant
/// slope is kept: a plane comes out as a plane.
#[must_use]
pub fn integrate_open(field: &Slopes, derivative: Derivative) -> Raster {
    integrate_open_rounded(field, derivative, f64::INFINITY)
}

/// Integral where the slopes have a noise: `noise` is the variance in each that rounding leaves at
/// the most; what is more is measured.
#[must_use]
pub fn integrate_open_rounded(field: &Slopes, derivative: Derivative, noise: f64) -> Raster {
    Open::of(field, derivative).heights(derivative, noise, Walls::NONE)
}
