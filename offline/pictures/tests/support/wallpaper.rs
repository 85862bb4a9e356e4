//! Motifs of all 17 wallpaper groups, from the generators the International Tables list for the
//! conventional cell.

#![allow(dead_code, reason = "each user takes what it needs")]

use asperity_dsp::rng::Rng;
use asperity_pictures::symmetry::WallpaperGroup::{self, *};
use asperity_surface::raster::Raster;
use std::f64::consts::TAU;

/// x → a·x + b·y + c, y → d·x + e·y + f.
type Generator = [f64; 6];

const CENTRING: Generator = [1.0, 0.0, 0.5, 0.0, 1.0, 0.5];
const TWOFOLD: Generator = [-1.0, 0.0, 0.0, 0.0, -1.0, 0.0];
const MIRROR: Generator = [-1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
const GLIDE: Generator = [-1.0, 0.0, 0.0, 0.0, 1.0, 0.5];
const FOURFOLD: Generator = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0];
const DIAGONAL_GLIDE: Generator = [-1.0, 0.0, 0.5, 0.0, 1.0, 0.5];
const THREEFOLD: Generator = [0.0, -1.0, 0.0, 1.0, -1.0, 0.0];
const SIXFOLD: Generator = [1.0, -1.0, 0.0, 1.0, 0.0, 0.0];

fn generators(group: WallpaperGroup) -> Vec<Generator> {
    match group {
        P1 => vec![],
        P2 => vec![TWOFOLD],
        Pm => vec![MIRROR],
        Pg => vec![GLIDE],
        Cm => vec![MIRROR, CENTRING],
        Pmm => vec![MIRROR, TWOFOLD],
        Pmg => vec![TWOFOLD, [-1.0, 0.0, 0.5, 0.0, 1.0, 0.0]],
        Pgg => vec![TWOFOLD, DIAGONAL_GLIDE],
        Cmm => vec![MIRROR, TWOFOLD, CENTRING],
        P4 => vec![FOURFOLD],
        P4m => vec![FOURFOLD, MIRROR],
        P4g => vec![FOURFOLD, DIAGONAL_GLIDE],
        P3 => vec![THREEFOLD],
        P3m1 => vec![THREEFOLD, [0.0, -1.0, 0.0, -1.0, 0.0, 0.0]],
        P31m => vec![THREEFOLD, [0.0, 1.0, 0.0, 1.0, 0.0, 0.0]],
        P6 => vec![SIXFOLD],
        P6m => vec![SIXFOLD, [0.0, 1.0, 0.0, 1.0, 0.0, 0.0]],
    }
}

/// A conventional cell that the group needs: side, ratio, angle.
fn conventional(group: WallpaperGroup, rng: &mut Rng) -> [[f64; 2]; 2] {
    let area = 900.0 + 900.0 * rng.uniform();
    let (ratio, degrees): (f64, f64) = match group {
        P1 | P2 => (1.2 + 0.3 * rng.uniform(), 70.0 + 12.0 * rng.uniform()),
        P4 | P4m | P4g => (1.0, 90.0),
        P3 | P3m1 | P31m | P6 | P6m => (1.0, 120.0),
        Cm | Cmm => (1.2 + 0.4 * rng.uniform(), 90.0),
        _ => (1.2 + 0.3 * rng.uniform(), 90.0),
    };
    let area = if matches!(group, Cm | Cmm) { 2.0 * area } else { area };
    let a = (area / (ratio * degrees.to_radians().sin())).sqrt();
    let turn = TAU * rng.uniform();
    let other = turn + degrees.to_radians();
    [[a * turn.cos(), a * turn.sin()], [a * ratio * other.cos(), a * ratio * other.sin()]]
}

/// A clean picture of a group.
pub fn picture(group: WallpaperGroup, size: usize, seed: u64) -> Raster {
    let mut rng = Rng::new(seed);
    let basis = conventional(group, &mut rng);
    let mut blobs: Vec<[f64; 4]> = Vec::new();
    let cell = (basis[0][0] * basis[1][1] - basis[0][1] * basis[1][0]).abs();
    for i in 0..4 {
        let seed_blob = [rng.uniform(), rng.uniform()];
        let orbit = orbit(seed_blob, &generators(group));
        // Larger orbits have smaller blobs, so that they stay apart.
        let radius = (0.5 + 0.4 * rng.uniform()) * (cell / (4 * orbit.len()) as f64 / TAU).sqrt();
        let height = if i % 2 == 0 { 1.0 } else { -0.4 - 0.5 * rng.uniform() };
        blobs.extend(orbit.into_iter().map(|[u, v]| [u, v, radius, height]));
    }
    let [a, b] = basis;
    let area = a[0] * b[1] - a[1] * b[0];
    Raster::from_fn(size, size, |x, y| {
        let (x, y) = (x as f64, y as f64);
        let (u, v) = ((x * b[1] - y * b[0]) / area, (a[0] * y - a[1] * x) / area);
        let mut sum = 0.0;
        for [p, q, radius, height] in &blobs {
            let (du, dv) = (u - p - (u - p).round(), v - q - (v - q).round());
            for m in -1..=1 {
                for n in -1..=1 {
                    let (s, t) = (du + f64::from(m), dv + f64::from(n));
                    let (px, py) = (s * a[0] + t * b[0], s * a[1] + t * b[1]);
                    sum += height * (-(px * px + py * py) / (2.0 * radius * radius)).exp();
                }
            }
        }
        sum
    })
}

/// All images of a point within the cell.
fn orbit(start: [f64; 2], generators: &[Generator]) -> Vec<[f64; 2]> {
    let mut points = vec![start];
    let mut next = 0;
    while next < points.len() {
        let [x, y] = points[next];
        for [a, b, c, d, e, f] in generators {
            let image = [(a * x + b * y + c).rem_euclid(1.0), (d * x + e * y + f).rem_euclid(1.0)];
            let known = points.iter().any(|p| {
                (0..2).all(|k| {
                    let gap = p[k] - image[k];
                    (gap - gap.round()).abs() < 1e-9
                })
            });
            if !known {
                points.push(image);
            }
        }
        next += 1;
    }
    points
}
