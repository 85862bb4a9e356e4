//! Patterns of known lattice, the disturbances of the lattice table, and pictures without any.

#![allow(dead_code, reason = "each user takes what it needs")]

use asperity_dsp::rng::Rng;
use asperity_surface::raster::Raster;
use std::f64::consts::TAU;

/// A kind of plane lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    Square,
    Rectangular,
    Rhombic,
    Oblique,
    Hexagonal,
}

pub const KINDS: [Kind; 5] = [Kind::Square, Kind::Rectangular, Kind::Rhombic, Kind::Oblique, Kind::Hexagonal];

/// What a row of the table does to a clean pattern.
#[derive(Debug, Clone, Copy)]
pub enum Stress {
    Clean,
    /// White noise of this standard deviation; the pattern has 1.
    Noise(f64),
    /// A brightness ramp of this height across the picture.
    Gradient(f64),
    /// A smooth displacement of this rms, texels.
    Warp(f64),
}

pub const ROWS: [(&str, Stress); 7] = [
    ("clean", Stress::Clean),
    ("noise 0.5", Stress::Noise(0.5)),
    ("noise 1", Stress::Noise(1.0)),
    ("noise 2", Stress::Noise(2.0)),
    ("gradient", Stress::Gradient(5.0)),
    ("warp 1 px", Stress::Warp(1.0)),
    ("warp 2 px", Stress::Warp(2.0)),
];

/// A random basis of a kind: shortest translation 16–36 texels, any rotation.
pub fn basis(kind: Kind, rng: &mut Rng) -> [[f64; 2]; 2] {
    let a = 16.0 + 20.0 * rng.uniform();
    let (ratio, degrees): (f64, f64) = match kind {
        Kind::Square => (1.0, 90.0),
        Kind::Rectangular => (1.2 + 0.5 * rng.uniform(), 90.0),
        Kind::Rhombic => (1.0, 67.0 + 16.0 * rng.uniform()),
        Kind::Oblique => (1.15 + 0.4 * rng.uniform(), 68.0 + 14.0 * rng.uniform()),
        Kind::Hexagonal => (1.0, 60.0),
    };
    let turn = TAU * rng.uniform();
    let other = turn + degrees.to_radians();
    [[a * turn.cos(), a * turn.sin()], [a * ratio * other.cos(), a * ratio * other.sin()]]
}

/// A cell of a few Gaussian blobs at random places, no two cells alike.
pub struct Motif {
    blobs: Vec<[f64; 4]>,
    basis: [[f64; 2]; 2],
}

impl Motif {
    pub fn new(basis: [[f64; 2]; 2], rng: &mut Rng) -> Self {
        let size = basis[0][0].hypot(basis[0][1]);
        let blob = |i: usize, rng: &mut Rng| {
            let height = if i == 0 { 1.0 } else { 0.4 + 0.8 * rng.uniform() };
            let sign = if i % 3 == 2 { -1.0 } else { 1.0 };
            [rng.uniform(), rng.uniform(), size * (0.09 + 0.11 * rng.uniform()), sign * height]
        };
        Self { blobs: (0..4).map(|i| blob(i, rng)).collect(), basis }
    }

    /// Height at a point of the plane, texels.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let [a, b] = self.basis;
        let area = a[0] * b[1] - a[1] * b[0];
        let (u, v) = ((x * b[1] - y * b[0]) / area, (a[0] * y - a[1] * x) / area);
        let mut sum = 0.0;
        for blob in &self.blobs {
            let (du, dv) = (u - blob[0] - (u - blob[0]).round(), v - blob[1] - (v - blob[1]).round());
            for m in -1..=1 {
                for n in -1..=1 {
                    let (p, q) = (du + f64::from(m), dv + f64::from(n));
                    let (px, py) = (p * a[0] + q * b[0], p * a[1] + q * b[1]);
                    sum += blob[3] * (-(px * px + py * py) / (2.0 * blob[2] * blob[2])).exp();
                }
            }
        }
        sum
    }
}

/// A picture of standard deviation 1 before stress.
pub fn picture(kind: Kind, stress: Stress, size: usize, seed: u64) -> (Raster, [[f64; 2]; 2]) {
    let mut rng = Rng::new(seed);
    let basis = basis(kind, &mut rng);
    let motif = Motif::new(basis, &mut rng);
    let warp = match stress {
        Stress::Warp(rms) => Some((smooth(size, rms, &mut rng), smooth(size, rms, &mut rng))),
        _ => None,
    };
    let pattern = Raster::from_fn(size, size, |x, y| {
        let (dx, dy) = warp.as_ref().map_or((0.0, 0.0), |(u, v)| (u.at(x, y), v.at(x, y)));
        motif.at(x as f64 + dx, y as f64 + dy)
    });
    let pattern = normalised(&pattern);
    let turn = TAU * rng.uniform();
    let lit = Raster::from_fn(size, size, |x, y| {
        pattern.at(x, y)
            + match stress {
                Stress::Noise(sigma) => sigma * rng.normal(),
                Stress::Gradient(height) => {
                    height * (x as f64 * turn.cos() + y as f64 * turn.sin()) / size as f64
                }
                _ => 0.0,
            }
    });
    (lit, basis)
}

/// Whether a found lattice is the true one: its basis is whole in the true basis and spans all of
/// it, each vector within a tenth.
pub fn is_lattice(found: [[f64; 2]; 2], truth: [[f64; 2]; 2]) -> bool {
    let [a, b] = truth;
    let area = a[0] * b[1] - a[1] * b[0];
    let whole = |t: [f64; 2]| [(t[0] * b[1] - t[1] * b[0]) / area, (a[0] * t[1] - a[1] * t[0]) / area];
    let (p, q) = (whole(found[0]), whole(found[1]));
    let near = p.iter().chain(&q).all(|c| (c - c.round()).abs() < 0.1);
    let (p, q) = (p.map(f64::round), q.map(f64::round));
    near && (p[0] * q[1] - p[1] * q[0]).abs() == 1.0
}

/// Mean 0, standard deviation 1.
pub fn normalised(raster: &Raster) -> Raster {
    let mean = raster.mean();
    let variance =
        raster.values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / raster.values.len() as f64;
    raster.map(|v| (v - mean) / variance.sqrt())
}

/// A smooth random field of this rms: a few long waves.
pub fn smooth(size: usize, rms: f64, rng: &mut Rng) -> Raster {
    let waves: Vec<[f64; 4]> = (0..8)
        .map(|_| {
            let (k, turn) = (1.0 + 2.5 * rng.uniform(), TAU * rng.uniform());
            [k * turn.cos(), k * turn.sin(), TAU * rng.uniform(), 1.0]
        })
        .collect();
    let field = Raster::from_fn(size, size, |x, y| {
        let (x, y) = (x as f64 / size as f64, y as f64 / size as f64);
        waves.iter().map(|w| w[3] * (TAU * (w[0] * x + w[1] * y) + w[2]).cos()).sum()
    });
    normalised(&field).map(|v| rms * v)
}

/// Blobs of one size at random places: dense, even, and without a pattern.
pub fn blobs(size: usize, radius: f64, seed: u64) -> Raster {
    let mut rng = Rng::new(seed);
    let count = (size as f64 / (2.0 * radius)).powi(2) as usize;
    let centres: Vec<[f64; 2]> =
        (0..count).map(|_| [size as f64 * rng.uniform(), size as f64 * rng.uniform()]).collect();
    let mut picture = Raster::constant(size, size, 0.0);
    for centre in centres {
        let reach = (3.0 * radius) as isize;
        for y in -reach..=reach {
            for x in -reach..=reach {
                let (px, py) = (centre[0] as isize + x, centre[1] as isize + y);
                if px >= 0 && py >= 0 && px < size as isize && py < size as isize {
                    let (dx, dy) = (px as f64 - centre[0], py as f64 - centre[1]);
                    picture.values[py as usize * size + px as usize] +=
                        (-(dx * dx + dy * dy) / (radius * radius)).exp();
                }
            }
        }
    }
    picture
}

/// Blobs that keep a distance, as grains and cells do: no pattern, but every grain has neighbours
/// at about the same distance.
pub fn grains(size: usize, radius: f64, seed: u64) -> Raster {
    let mut rng = Rng::new(seed);
    let mut centres: Vec<[f64; 2]> = Vec::new();
    for _ in 0..20 * (size as f64 / radius).powi(2) as usize {
        let candidate = [size as f64 * rng.uniform(), size as f64 * rng.uniform()];
        if centres.iter().all(|c| (c[0] - candidate[0]).hypot(c[1] - candidate[1]) > 1.9 * radius) {
            centres.push(candidate);
        }
    }
    Raster::from_fn(size, size, |x, y| {
        let nearest =
            centres.iter().map(|c| (c[0] - x as f64).hypot(c[1] - y as f64)).fold(f64::INFINITY, f64::min);
        (1.0 - (nearest / radius).powi(2)).max(0.0).sqrt()
    })
}

/// Stripes across: a pattern along one direction only.
pub fn stripes(size: usize, period: f64, turn: f64, noise: f64, seed: u64) -> Raster {
    let mut rng = Rng::new(seed);
    Raster::from_fn(size, size, |x, y| {
        (TAU * (x as f64 * turn.cos() + y as f64 * turn.sin()) / period).cos() + noise * rng.normal()
    })
}

/// Waves of any direction whose lengths are nearly one, within this share of it: every place looks
/// alike and nothing repeats.
pub fn ring_of_waves(size: usize, length: f64, share: f64, seed: u64) -> Raster {
    let mut rng = Rng::new(seed);
    let waves: Vec<[f64; 3]> = (0..120)
        .map(|_| {
            let k = TAU / length * (1.0 + share * (2.0 * rng.uniform() - 1.0));
            let turn = TAU * rng.uniform();
            [k * turn.cos(), k * turn.sin(), TAU * rng.uniform()]
        })
        .collect();
    Raster::from_fn(size, size, |x, y| {
        waves.iter().map(|w| (w[0] * x as f64 + w[1] * y as f64 + w[2]).cos()).sum::<f64>()
    })
}
