//! Brownian surfaces and paths: relief of a given fractal dimension.
//!
//! ```text
//! E[(X(p + r) − X(p))²] ∝ |r|^{2H}        dimension of a path 2 − H, of a surface 3 − H
//! ```
//!
//! | method | what it gives |
//! |---|---|
//! | [`Method::Exact`], plane | fractional Brownian motion itself: circulant embedding after Davies & Harte (1987) for paths, after M. L. Stein (2002) for surfaces: a compactly supported covariance that differs from the wanted one by a parabola, and a random tilt that adds the parabola back |
//! | [`Method::Exact`], periodic | the same law with \|r\| replaced by the chord of a circle (for surfaces: of a torus), sin(π r/N)·N/π: it repeats without a seam, and its power H is exact where r is small against N. A power 2H ≤ 2 of a Euclidean chord has a non-negative spectrum, so that nothing is approximated |
//! | [`Method::Midpoint`] | random midpoint displacement, the document's construction, with its means and variances corrected; see [`midpoint`] |
//!
//! Source: chapter 6 of the texture-analysis thesis (definitions 6.7 and 6.8, theorems 6.1 and 6.2,
//! §6.3.2). What we changed: the default is exact, because midpoint displacement follows the law
//! only between a point and its neighbours; its dimension is right all the same. Measured
//! dimensions are in the tests.
//!
//! Generators run when a surface is made and use the heap. What they make is a [`Raster`] of
//! heights to be read as a height map: wrap it with *repeat* when periodic, with *mirror* when not
//! (an open surface has a step where its ends meet).

mod fourier;
pub mod midpoint;
pub mod rendering;

use crate::raster::Raster;
use asperity_dsp::DesignError;
use asperity_dsp::limits::brownian as limits;
use asperity_dsp::rng::Rng;
use fourier::{Complex, forward_2d, forward_lines};

/// Largest edge of a periodic surface, samples.
pub const MAX_PERIODIC_SIZE: usize = 4096;
/// Largest edge of an open surface, samples: its embedding is 2.9 (H ≤ 0.75) or 5.7 times as wide
/// and takes 0.13 or 0.54 GB while it is made.
pub const MAX_OPEN_SIZE: usize = 1024;
/// Longest path, samples.
pub const MAX_PATH: usize = 1 << 22;

/// Method that makes a Brownian relief.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// By circulant embedding: exact.
    #[default]
    Exact,
    /// By random midpoint displacement, the document's way; never periodic.
    Midpoint,
}

/// A Brownian relief to be made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrownianDesign {
    /// Index H, above 0 and below 1: smaller is rougher.
    pub hurst: f64,
    /// Samples along an edge, at least 4.
    pub size: usize,
    /// Seed.
    pub seed: u64,
    /// Method.
    pub method: Method,
    /// Repeats without a seam.
    pub periodic: bool,
    /// Root mean square of the heights about their mean, metres, at or above 0.
    pub rms_m: f64,
}

impl BrownianDesign {
    /// A periodic, exact relief of 512 samples along an edge.
    #[must_use]
    pub fn new(hurst: f64, rms_m: f64, seed: u64) -> Self {
        Self { hurst, size: 512, seed, method: Method::Exact, periodic: true, rms_m }
    }

    /// Makes the surface: heights in metres with mean 0.
    ///
    /// # Errors
    /// When H, the size or the rms is out of its range, or a periodic surface is asked of
    /// [`Method::Midpoint`].
    pub fn surface(&self) -> Result<Raster, DesignError> {
        self.check(if self.periodic { MAX_PERIODIC_SIZE } else { MAX_OPEN_SIZE })?;
        let mut rng = Rng::new(self.seed);
        let values = match (self.method, self.periodic) {
            (Method::Midpoint, _) => midpoint::raw_surface(self.hurst, self.size, &mut rng),
            (Method::Exact, true) => torus(self.hurst, self.size, &mut rng),
            (Method::Exact, false) => plane(self.hurst, self.size, &mut rng),
        };
        Ok(Raster { width: self.size, height: self.size, values: scaled(values, self.rms_m) })
    }

    /// Makes the path: heights in metres with mean 0.
    ///
    /// # Errors
    /// As [`BrownianDesign::surface`].
    pub fn path(&self) -> Result<Vec<f64>, DesignError> {
        self.check(MAX_PATH)?;
        let mut rng = Rng::new(self.seed);
        let values = match (self.method, self.periodic) {
            (Method::Midpoint, _) => midpoint::path(self.hurst, self.size, &mut rng),
            (Method::Exact, true) => circle(self.hurst, self.size, &mut rng),
            (Method::Exact, false) => line(self.hurst, self.size, &mut rng),
        };
        Ok(scaled(values, self.rms_m))
    }

    fn check(&self, most: usize) -> Result<(), DesignError> {
        limits::HURST.check("hurst", self.hurst)?;
        let fits = |n: f64| (4.0..=most as f64).contains(&n);
        let size = self.size as f64;
        DesignError::check("size", size, "4 to 1024 (open) or 4096 (periodic) samples along an edge", fits)?;
        limits::RMS_M.check("rms_m", self.rms_m)?;
        let possible = !(self.periodic && self.method == Method::Midpoint);
        let wanted = "false for midpoint displacement, which cannot repeat";
        DesignError::check("periodic", f64::from(u8::from(self.periodic)), wanted, |_| possible)?;
        Ok(())
    }
}

/// Heights about their mean, brought to an rms.
fn scaled(mut values: Vec<f64>, rms: f64) -> Vec<f64> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    let gain = if square > 0.0 { rms / square.sqrt() } else { 0.0 };
    for v in &mut values {
        *v = (*v - mean) * gain;
    }
    values
}

/// Turns eigenvalues of a circulant covariance into the spectrum of a random field with it.
/// Rounding leaves eigenvalues of −1e-13 of the largest where they are 0.
fn colour(eigenvalues: &mut [Complex], rng: &mut Rng) {
    let n = eigenvalues.len() as f64;
    for value in eigenvalues {
        let amplitude = (value.re.max(0.0) / n).sqrt();
        *value = Complex::new(amplitude * rng.normal(), amplitude * rng.normal());
    }
}

/// −(chord²)^H on a circle of n samples is a covariance up to a constant, which has no spectrum.
fn circle(hurst: f64, n: usize, rng: &mut Rng) -> Vec<f64> {
    let mut field: Vec<Complex> =
        (0..n).map(|i| Complex::new(-libm::pow(sine_squared(i, n), hurst), 0.0)).collect();
    forward_lines(&mut field, n);
    field[0] = Complex::default();
    colour(&mut field, rng);
    forward_lines(&mut field, n);
    field.into_iter().map(|c| c.re).collect()
}

/// Relief on the torus in four dimensions that a periodic square is.
fn torus(hurst: f64, n: usize, rng: &mut Rng) -> Vec<f64> {
    let chord: Vec<f64> = (0..n).map(|i| sine_squared(i, n)).collect();
    let mut field: Vec<Complex> =
        (0..n * n).map(|i| Complex::new(-libm::pow(chord[i % n] + chord[i / n], hurst), 0.0)).collect();
    forward_2d(&mut field, n);
    field[0] = Complex::default();
    colour(&mut field, rng);
    forward_2d(&mut field, n);
    field.into_iter().map(|c| c.re).collect()
}

fn sine_squared(i: usize, n: usize) -> f64 {
    libm::sin(core::f64::consts::PI * i as f64 / n as f64).powi(2)
}

/// Davies–Harte: fractional Gaussian noise on a circle of 2n increments, of which n − 1 are added
/// up.
fn line(hurst: f64, n: usize, rng: &mut Rng) -> Vec<f64> {
    let power = |k: f64| libm::pow(k.abs(), 2.0 * hurst);
    let covariance = |k: f64| 0.5 * (power(k + 1.0) - 2.0 * power(k) + power(k - 1.0));
    let mut field: Vec<Complex> =
        (0..2 * n).map(|i| Complex::new(covariance(i.min(2 * n - i) as f64), 0.0)).collect();
    forward_lines(&mut field, 2 * n);
    colour(&mut field, rng);
    forward_lines(&mut field, 2 * n);
    let mut height = 0.0;
    (0..n)
        .map(|i| {
            let here = height;
            height += field[i].re;
            here
        })
        .collect()
}

/// Stein's covariance: c0 − r^α + c2 r² up to r = 1, β (R − r)³ / r up to R, 0 beyond; α = 2H.
#[derive(Debug, Clone, Copy)]
struct Stein {
    alpha: f64,
    beta: f64,
    c0: f64,
    c2: f64,
    radius: f64,
}

impl Stein {
    fn new(hurst: f64) -> Self {
        let alpha = 2.0 * hurst;
        if alpha <= 1.5 {
            return Self { alpha, beta: 0.0, c0: 1.0 - 0.5 * alpha, c2: 0.5 * alpha, radius: 1.0 };
        }
        let radius = 2.0_f64;
        let beta = alpha * (2.0 - alpha) / (3.0 * radius * (radius * radius - 1.0));
        let c2 = 0.5 * (alpha - beta * (radius - 1.0).powi(2) * (radius + 2.0));
        let c0 = beta * (radius - 1.0).powi(3) + 1.0 - c2;
        Self { alpha, beta, c0, c2, radius }
    }

    fn at(&self, r: f64) -> f64 {
        if r <= 1.0 {
            self.c0 - libm::pow(r, self.alpha) + self.c2 * r * r
        } else if r <= self.radius {
            self.beta * (self.radius - r).powi(3) / r
        } else {
            0.0
        }
    }
}

/// A square of n samples whose diagonal fits into the disc where Stein's covariance is exact.
fn plane(hurst: f64, n: usize, rng: &mut Rng) -> Vec<f64> {
    let stein = Stein::new(hurst);
    let half = even_size((stein.radius * core::f64::consts::SQRT_2 * n as f64).ceil() as usize);
    let (m, step) = (2 * half, stein.radius / half as f64);
    let mut field: Vec<Complex> = (0..m * m)
        .map(|i| {
            let lag = |k: usize| k.min(m - k) as f64 * step;
            Complex::new(stein.at(libm::hypot(lag(i % m), lag(i / m))), 0.0)
        })
        .collect();
    forward_2d(&mut field, m);
    colour(&mut field, rng);
    forward_2d(&mut field, m);
    let tilt = [rng.normal(), rng.normal()].map(|g| g * (2.0 * stein.c2).sqrt() * step);
    (0..n * n)
        .map(|i| {
            let (x, y) = (i % n, i / n);
            field[y * m + x].re + tilt[0] * x as f64 + tilt[1] * y as f64
        })
        .collect()
}

/// The next size whose prime factors are 2, 3 and 5, where Fourier transforms are fast.
fn even_size(least: usize) -> usize {
    let smooth = |mut n: usize| {
        for p in [2, 3, 5] {
            while n.is_multiple_of(p) {
                n /= p;
            }
        }
        n == 1
    };
    (least..).find(|&n| smooth(n)).unwrap_or(least)
}
