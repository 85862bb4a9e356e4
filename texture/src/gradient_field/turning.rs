//! What turns in a field of slopes, which no surface has, and which derivative may have made it.
//!
//! Only with the derivative that made the slopes is D_y P = D_x Q. What is left across D, |D_y P − D_x Q|²/|D|², is then the noise of
//! the slopes, with any other derivative more. By how much more, in units of the noise, is the logarithm of the likelihood ratio
//! of the two: a derivative is ruled out when that is above [`RULED_OUT`] and what it leaves exceeds what the best one leaves clearly.
//! Corrugations, and waves as long along u as along v, leave nothing with any derivative: their slopes agree up to a
//! factor, and their map is the same to the last bit. Source of the test: ours.

use super::{DERIVATIVES, Derivative, Slopes, differences, unpack};
use crate::fft2::{Fft2, angular_frequency};
use crate::raster::Raster;
use asperity_fft::num_complex::Complex64;
use std::f64::consts::TAU;

/// Power over that of the noise from which a frequency counts as signal.
const CLEAR_OF_NOISE: f64 = 8.0;
/// Logarithm of a likelihood ratio that rules a derivative out. Source: ours; over 19 kinds of surfaces the derivative that made
/// a map came to 3.3 at the most, on waves of two directions.
const RULED_OUT: f64 = 20.0;
/// Highest frequency along either axis that a surface that does not tile is asked about, radians per texel: differences of eighth order are
/// within 0.7 % of the true derivative there, those of neighbours 22 % below it.
const HIGHEST_ASKED: f64 = 1.2;
/// A derivative is only ruled out by one that leaves at most this fraction of what it leaves: what is no rounding in a map made by others
/// (resizing, JPEG) is neither derivative's.
const CLEARLY: f64 = 0.85;

/// The spectra of slopes along u and v.
struct Spectra {
    packed: Vec<Complex64>,
    width: usize,
    height: usize,
}

impl Spectra {
    fn of(field: &Slopes) -> Self {
        let (width, height) = (field.along_u.width, field.along_u.height);
        let mut image = field.packed();
        let mut packed = vec![Complex64::default(); image.len()];
        Fft2::new(width, height).forward(&mut image, &mut packed);
        Self { packed, width, height }
    }

    fn power(&self, place: usize) -> f64 {
        unpack(&self.packed, place, self.width, self.height).iter().map(Complex64::norm_sqr).sum()
    }

    /// |D_y P − D_x Q|²/|D|²; nothing where the derivative is blind.
    fn across(&self, place: usize, derivative: Derivative) -> Option<f64> {
        let [p, q] = unpack(&self.packed, place, self.width, self.height);
        let [dx, dy] = derivative.at_bin(place, self.width, self.height);
        let square = dx * dx + dy * dy;
        (square > 0.0).then(|| (p * dy - q * dx).norm_sqr() / square)
    }
}

/// How far slopes are from being those of any surface, 0–1: the share of their power that lies across D,
/// Σ |D_y P − D_x Q|²/|D|² / Σ (|P|² + |Q|²), where the slopes stand out of their noise (eight times the median
/// power). A field that does not tile must come as its periodic component.
#[must_use]
pub fn curl(field: &Slopes, derivative: Derivative) -> f64 {
    let spectra = Spectra::of(field);
    let floor =
        CLEAR_OF_NOISE * median((1..spectra.packed.len()).map(|place| spectra.power(place)).collect());
    let (mut turning, mut all) = (0.0, 0.0);
    for place in 1..spectra.packed.len() {
        let power = spectra.power(place);
        if let Some(across) = spectra.across(place, derivative).filter(|_| power >= floor) {
            turning += across;
            all += power;
        }
    }
    if all == 0.0 { 0.0 } else { turning / all }
}

/// The derivatives that may have made the slopes of a surface that tiles, the likeliest first; never none.
#[must_use]
pub fn possible_derivatives(field: &Slopes) -> Vec<Derivative> {
    let spectra = Spectra::of(field);
    let places = 1..spectra.packed.len();
    let power = places.clone().map(|place| spectra.power(place)).collect();
    let across =
        DERIVATIVES.map(|d| places.clone().map(|place| spectra.across(place, d).unwrap_or(0.0)).collect());
    Evidence { power, across }.possible()
}

/// The same of a surface that does not tile: each derivative's turning is taken by its own differences, away from the borders, and
/// under a window. Only long waves are asked, whose true derivative differences can take.
#[must_use]
pub fn possible_derivatives_inside(field: &Slopes) -> Vec<Derivative> {
    let (w, h) = (field.along_u.width, field.along_u.height);
    let window = Raster::from_fn(w, h, |x, y| hann(x, w) * hann(y, h));
    let mut fft = Fft2::new(w, h);
    let mut spectrum = |raster: &Raster| {
        let values: Vec<f64> = raster.values.iter().zip(&window.values).map(|(v, w)| v * w).collect();
        fft.spectrum(&values)
    };
    let asked = |place: usize| {
        let [wx, wy] = [angular_frequency(place / h, w).abs(), angular_frequency(place % h, h).abs()];
        // The window mixes neighbouring frequencies: where the noise of the turning vanishes it says nothing.
        let least = 3.0 * TAU / w.min(h) as f64;
        wx.max(wy) < HIGHEST_ASKED && wx.hypot(wy) > least
    };
    let places: Vec<usize> = (1..w * h).filter(|&place| asked(place)).collect();
    let (p, q) = (spectrum(&field.along_u), spectrum(&field.along_v));
    let power = places.iter().map(|&place| p[place].norm_sqr() + q[place].norm_sqr()).collect();
    let across = DERIVATIVES.map(|derivative| {
        let of_p = differences(&field.along_u, derivative).along_v;
        let of_q = differences(&field.along_v, derivative).along_u;
        let turning = Raster {
            width: w,
            height: h,
            values: of_p.values.iter().zip(&of_q.values).map(|(a, b)| a - b).collect(),
        };
        let spectrum = spectrum(&turning);
        places.iter().map(|&place| spectrum[place].norm_sqr() / derivative.square_at(place, w, h)).collect()
    });
    Evidence { power, across }.possible()
}

fn hann(i: usize, n: usize) -> f64 {
    0.5 - 0.5 * (TAU * (i as f64 + 0.5) / n as f64).cos()
}

/// Power of the slopes and what lies across each of [`DERIVATIVES`], at the same frequencies.
struct Evidence {
    power: Vec<f64>,
    across: [Vec<f64>; DERIVATIVES.len()],
}

impl Evidence {
    fn possible(&self) -> Vec<Derivative> {
        // The noise where there is any: that of a pattern that repeats falls on few frequencies and is the stronger there.
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
        let least = left[0].1;
        let possible = |turning: f64| turning - least <= RULED_OUT * noise || least > CLEARLY * turning;
        left.into_iter().filter(|&(_, turning)| possible(turning)).map(|(derivative, _)| derivative).collect()
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
