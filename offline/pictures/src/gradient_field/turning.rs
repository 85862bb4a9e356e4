//! Curl of a slope field: tests integrability and identifies the derivative stencil.
//!
//! Only with the derivative that made the slopes is D_y P = D_x Q. What is left across D, |D_y P −
//! D_x Q|²/|D|², is then the noise of the slopes, with any other derivative more. By how much more,
//! in units of the noise, is the logarithm of the likelihood ratio of the two: a derivative is
//! ruled out when that is above [`RULED_OUT`] and what it leaves exceeds what the best one leaves
//! clearly. Corrugations, and waves as long along u as along v, leave nothing with any derivative:
//! their slopes agree up to a factor, and their map is the same to the last bit. A derivative that
//! is blind to waves which the map has is ruled out by [`super::blind`]. Source of the tests: ours.

use super::bands::Seen;
use super::blind::made_blind;
use super::tiling::Tiling;
use super::{DERIVATIVES, Derivative, Slopes, differences};
use crate::fft2::{Fft2, angular_frequency};
use crate::histogram::median;
use asperity_fft::num_complex::Complex64;
use asperity_surface::raster::Raster;
use std::f64::consts::TAU;

/// Power over that of the noise from which a frequency counts as signal.
const CLEAR_OF_NOISE: f64 = 8.0;
/// Logarithm of a likelihood ratio that rules a derivative out. Source: ours; over 19 kinds of
/// surfaces the derivative that made a map came to 3.3 at the most, on waves of two directions.
const RULED_OUT: f64 = 20.0;
/// Highest frequency along either axis that a surface that does not tile is asked about, radians
/// per texel: differences of eighth order are within 0.7 % of the true derivative there, those of
/// neighbours 22 % below it.
const HIGHEST_ASKED: f64 = 1.2;
/// A derivative is only ruled out by one that leaves at most this fraction of what it leaves.
const CLEARLY: f64 = 0.85;
/// Limit where the best one leaves more than rounding: what is no rounding in a map made by others
/// (resizing, JPEG) is neither derivative's. Source: ours; 0.04–0.4 for the derivative that made a
/// map, 0.5–1 for others in real maps.
const CLEARLY_OF_OTHER_NOISE: f64 = 0.5;
/// Mean power across D over that of rounding from which it is something else.
const NOT_ROUNDING: f64 = 2.0;

/// Distance of slopes from those of any surface, 0–1: the share of their power that lies across D,
/// Σ |D_y P − D_x Q|²/|D|² / Σ (|P|² + |Q|²), where the slopes stand out of their noise (eight
/// times the median power). A field that does not tile must come as its periodic component.
#[must_use]
pub fn curl(field: &Slopes, derivative: Derivative) -> f64 {
    share_across(&Tiling::of(field).all_seen(derivative))
}

/// Share at every place.
pub(super) fn share_across(seen: &[Seen]) -> f64 {
    let visible = || seen.iter().skip(1).filter(|at| at.square > 0.0);
    let power = |at: &Seen| at.along / at.square + at.across;
    let floor = CLEAR_OF_NOISE * median(visible().map(power).collect());
    let (turning, all) = visible()
        .filter(|at| power(at) >= floor)
        .fold((0.0, 0.0), |(turning, all), at| (turning + at.across, all + power(at)));
    if all == 0.0 { 0.0 } else { turning / all }
}

/// Power of the slopes and what lies across each of [`DERIVATIVES`], at the same frequencies.
pub(super) struct Evidence {
    power: Vec<f64>,
    across: [Vec<f64>; DERIVATIVES.len()],
    /// Which derivatives are blind to waves that the map has.
    blind: [bool; DERIVATIVES.len()],
    /// Power that rounding leaves in each slope.
    rounding: f64,
}

impl Evidence {
    /// Share of a surface that tiles; rounding leaves a variance of `noise` in each slope.
    pub fn of_tiling(tiling: &Tiling, noise: f64) -> Self {
        let power: Vec<f64> = (0..tiling.len()).map(|place| tiling.power(place)).collect();
        let across =
            DERIVATIVES.map(|d| tiling.all_seen(d)[1..].iter().map(|at| at.across).collect::<Vec<_>>());
        let ([along_u, along_v], step) = tiling.frequencies();
        let noise = noise * tiling.len() as f64;
        let blind = DERIVATIVES.map(|d| made_blind(d, &power, [&along_u, &along_v], step, noise));
        Self { power: power[1..].to_vec(), across, blind, rounding: noise }
    }

    /// Share of a surface that does not tile: each derivative's turning is taken by its own
    /// differences, away from the borders, and under a window. Only long waves are asked, whose
    /// true derivative differences can take.
    pub fn of_inside(field: &Slopes, noise: f64) -> Self {
        let (w, h) = (field.along_u.width, field.along_u.height);
        let [across_u, across_v] = [w, h].map(|n| (0..n).map(|i| hann(i, n)).collect::<Vec<_>>());
        let mut fft = Fft2::new(w, h);
        let mut spectrum = |raster: &Raster| {
            let rows = raster.values.chunks_exact(w).zip(&across_v);
            let values: Vec<f64> = rows
                .flat_map(|(row, weight)| row.iter().zip(&across_u).map(move |(v, u)| v * u * weight))
                .collect();
            fft.spectrum(&values)
        };
        let [along_u, along_v] = [w, h].map(|n| (0..n).map(|k| angular_frequency(k, n)).collect::<Vec<_>>());
        // The window mixes neighbouring frequencies: where the noise of the turning vanishes it
        // says nothing.
        let least = 3.0 * TAU / w.min(h) as f64;
        let asked = |place: usize| {
            let [wx, wy] = [along_u[place / h].abs(), along_v[place % h].abs()];
            wx.max(wy) < HIGHEST_ASKED && wx.hypot(wy) > least
        };
        let places: Vec<usize> = (1..w * h).filter(|&place| asked(place)).collect();
        let sum = |p: &Complex64, q: &Complex64| p.norm_sqr() + q.norm_sqr();
        let (p, q) = (spectrum(&field.along_u), spectrum(&field.along_v));
        let all: Vec<f64> = p.iter().zip(&q).map(|(p, q)| sum(p, q)).collect();
        let across = DERIVATIVES.map(|derivative| {
            let mut turning = differences::along_v(&field.along_u, derivative);
            let of_q = differences::along_u(&field.along_v, derivative);
            turning.values.iter_mut().zip(&of_q.values).for_each(|(a, b)| *a -= b);
            let spectrum = spectrum(&turning);
            places
                .iter()
                .map(|&place| spectrum[place].norm_sqr() / derivative.square_at(place, w, h))
                .collect()
        });
        let squares = |weights: &[f64]| weights.iter().map(|w| w * w).sum::<f64>();
        let noise = noise * squares(&across_u) * squares(&across_v);
        let step = TAU / w.max(h) as f64;
        let blind = DERIVATIVES.map(|d| made_blind(d, &all, [&along_u, &along_v], step, noise));
        Self { power: places.iter().map(|&place| all[place]).collect(), across, blind, rounding: noise }
    }

    /// The derivatives that may have made the slopes, the likeliest first, never none; and whether
    /// the likeliest leaves no more than rounding. Where more is left (resized maps, JPEG) the
    /// derivative that leaves the least was not what made half of them.
    pub fn possible(&self) -> (Vec<Derivative>, bool) {
        // The noise where there is any: that of a pattern that repeats falls on few frequencies and
        // is the stronger there.
        let noise_with = |across: &Vec<f64>| {
            let (sum, squares) =
                across.iter().fold((0.0, 0.0), |(sum, squares), a| (sum + a, squares + a * a));
            (sum, if sum > 0.0 { squares / sum } else { 0.0 })
        };
        let noises = self.across.iter().map(noise_with);
        let noise = noises.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, noise)| noise);
        let floor = CLEAR_OF_NOISE * noise.max(median(self.power.clone()));
        let signal = |across: &Vec<f64>| -> f64 {
            across
                .iter()
                .zip(&self.power)
                .filter(|(_, power)| **power > floor)
                .map(|(across, _)| across)
                .sum()
        };
        let mut left: Vec<_> = DERIVATIVES.into_iter().zip(self.across.iter().map(signal)).collect();
        left.sort_by(|a, b| a.1.total_cmp(&b.1));
        let best = left[0].0;
        // Who leaves no more than rounding made the map; nobody else's map may hold what he is
        // blind to.
        let clean = self.mean_across(best) <= NOT_ROUNDING * self.rounding;
        let sees = |derivative| clean || !self.blind[place_of(derivative)];
        left.retain(|&(derivative, _)| sees(derivative));
        let (least, clearly) = (left[0].1, if clean { CLEARLY } else { CLEARLY_OF_OTHER_NOISE });
        let possible = |turning: f64| turning - least <= RULED_OUT * noise || least > clearly * turning;
        let left =
            left.into_iter().filter(|&(_, turning)| possible(turning)).map(|(derivative, _)| derivative);
        (left.collect(), clean)
    }

    fn mean_across(&self, derivative: Derivative) -> f64 {
        let across = &self.across[place_of(derivative)];
        across.iter().sum::<f64>() / across.len().max(1) as f64
    }
}

fn place_of(derivative: Derivative) -> usize {
    DERIVATIVES.iter().position(|&d| d == derivative).unwrap_or(0)
}

fn hann(i: usize, n: usize) -> f64 {
    0.5 - 0.5 * (TAU * (i as f64 + 0.5) / n as f64).cos()
}
