//! The gains of the filters; see the equations of [`super`].

use super::Kind;
use std::f64::consts::{FRAC_PI_2, PI};

/// Which part of Ψ depends on r alone; `lows` is how often the low-pass has been applied before the
/// band.
pub(super) fn radial(kind: Kind, lows: usize, r: f64) -> f64 {
    match kind {
        Kind::HighResidual => high(r),
        Kind::LowResidual => low_chain(r, lows),
        Kind::Oriented { band, .. } => low_chain(r, band) * high(r * (1_u64 << (band + 1)) as f64),
    }
}

/// a |cos(θ − πμ/K)|^{K−1} as a function of the direction (cos θ, sin θ).
pub(super) fn angular(orientation: usize, orientations: usize) -> impl Fn([f64; 2]) -> f64 {
    let (sin, cos) = (PI * orientation as f64 / orientations as f64).sin_cos();
    let norm = angular_norm(orientations);
    move |[x, y]| norm * (x * cos + y * sin).abs().powi(orientations as i32 - 1)
}

/// H(r).
fn high(r: f64) -> f64 {
    if r >= PI {
        1.0
    } else if r <= FRAC_PI_2 {
        0.0
    } else {
        (FRAC_PI_2 * (r / PI).log2()).cos()
    }
}

/// L(r) L(2r) … L(2^last r).
fn low_chain(r: f64, last: usize) -> f64 {
    // Below half of the band edge every earlier factor is one, above it the last but one is zero
    // unless r lies in its octave: only these two can differ from 0 and 1.
    let low = |r: f64| {
        if r >= PI {
            0.0
        } else if r <= FRAC_PI_2 {
            1.0
        } else {
            // √(1 − cos²) without cancellation.
            (FRAC_PI_2 * (r / PI).log2()).sin().abs()
        }
    };
    (0..=last).map(|i| low(r * (1_u64 << i) as f64)).product()
}

/// 2^{K−1} (K−1)! / √(K (2K−2)!): the squared orientations sum to one.
pub(super) fn angular_norm(orientations: usize) -> f64 {
    let factorial = |n: usize| (1..=n).map(|i| i as f64).product::<f64>();
    let k = orientations;
    2.0_f64.powi(k as i32 - 1) * factorial(k - 1) / (k as f64 * factorial(2 * k - 2)).sqrt()
}
