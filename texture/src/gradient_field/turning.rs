//! What turns in a field of slopes, which no surface has, and which derivative may have made it.
//!
//! Only with the derivative that made the slopes is D_y P = D_x Q. What is left across D, |D_y P − D_x Q|²/|D|², is then the noise of
//! the slopes, with any other derivative more. By how much more, in units of the noise, is the logarithm of the likelihood ratio
//! of the two: a derivative is ruled out when that is above [`RULED_OUT`] and what it leaves exceeds what the best one leaves clearly.
//! Corrugations, and waves as long along u as along v, leave nothing with any derivative: their slopes agree up to a
//! factor, and their map is the same to the last bit. Source of the test: ours.

use super::{DERIVATIVES, Derivative, Slopes, unpack};
use crate::fft2::Fft2;
use rustfft::num_complex::Complex64;

/// Power over that of the noise from which a frequency counts as signal.
const CLEAR_OF_NOISE: f64 = 8.0;
/// Logarithm of a likelihood ratio that rules a derivative out. Source: ours; over 19 kinds of surfaces the derivative that made
/// a map came to 3.3 at the most, on waves of two directions.
const RULED_OUT: f64 = 20.0;
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

    fn median_power(&self) -> f64 {
        let mut powers: Vec<f64> = (1..self.packed.len()).map(|place| self.power(place)).collect();
        let middle = powers.len() / 2;
        *powers.select_nth_unstable_by(middle, f64::total_cmp).1
    }
}

/// How far slopes are from being those of any surface, 0–1: the share of their power that lies across D,
/// Σ |D_y P − D_x Q|²/|D|² / Σ (|P|² + |Q|²), where the slopes stand out of their noise (eight times the median
/// power). A field that does not tile must come as its periodic component.
#[must_use]
pub fn curl(field: &Slopes, derivative: Derivative) -> f64 {
    let spectra = Spectra::of(field);
    let floor = CLEAR_OF_NOISE * spectra.median_power();
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

/// The derivatives that may have made these slopes, the likeliest first; never none. A field that does not tile must come as
/// its periodic component.
#[must_use]
pub fn possible_derivatives(field: &Slopes) -> Vec<Derivative> {
    let spectra = Spectra::of(field);
    let places = 1..spectra.packed.len();
    // The noise where there is any: that of a pattern that repeats falls on few frequencies and is the stronger there.
    let noise_with = |derivative| {
        let across = places.clone().filter_map(|place| spectra.across(place, derivative));
        let (sum, squares) = across.fold((0.0, 0.0), |(sum, squares), a| (sum + a, squares + a * a));
        (sum, if sum > 0.0 { squares / sum } else { 0.0 })
    };
    let noises = DERIVATIVES.map(noise_with);
    let noise = noises.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, noise)| noise);
    let floor = CLEAR_OF_NOISE * noise.max(spectra.median_power());
    let signal: Vec<usize> = places.filter(|&place| spectra.power(place) > floor).collect();
    let left =
        |derivative| -> f64 { signal.iter().filter_map(|&place| spectra.across(place, derivative)).sum() };
    let mut left = DERIVATIVES.map(|derivative| (derivative, left(derivative)));
    left.sort_by(|a, b| a.1.total_cmp(&b.1));
    let least = left[0].1;
    let possible = |turning: f64| turning - least <= RULED_OUT * noise || least > CLEARLY * turning;
    left.into_iter().filter(|&(_, turning)| possible(turning)).map(|(derivative, _)| derivative).collect()
}
