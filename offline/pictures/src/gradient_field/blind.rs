//! Waves that a map has and its derivative could not have seen.
//!
//! Slopes taken by a derivative carry |D|² S + N of a surface's power S. Where the derivative is
//! nearly blind they hold little but noise, unless the surface is stronger there than at any longer
//! wave. Slopes that hold more were not made by it: normals that were made otherwise and resized,
//! mostly, and dividing them by the blind derivative would raise short waves above all others.
//! ```text
//! blind: |D|² < ⅒ ω² in the upper half of the spectrum      ruled out: Σ (|P|² + |Q|²) ≫ Σ (|D|² S + 2 N)
//! ```
//! with S from the waves the derivative sees, never rising with frequency.

use super::Derivative;
use super::bands::Bands;
use super::wiener::never_rising;
use std::f64::consts::FRAC_PI_2;

/// |D|²/ω² below which a derivative is nearly blind.
const NEARLY_BLIND: f64 = 0.1;
/// Power over what the derivative can leave of a surface, and noise, from which it did not make the
/// slopes. Source: ours. Surfaces of other people's maps with slopes taken by Sobel leave 0.2–2.4,
/// with slopes taken otherwise and halved 6–60.
const TOO_MUCH: f64 = 4.0;

/// Tests whether slopes of this power hold waves which the derivative would not have left in them.
/// `noise` is that of one slope.
pub(super) fn made_blind(
    derivative: Derivative,
    power: &[f64],
    [along_u, along_v]: [&[f64]; 2],
    step: f64,
    noise: f64,
) -> bool {
    if derivative == Derivative::Exact {
        return false;
    }
    let bands = Bands::new(along_u, along_v, step);
    let seen = |place: usize| {
        let [wx, wy] = [along_u[place / along_v.len()], along_v[place % along_v.len()]];
        let square: f64 = derivative.symbol([wx, wy]).iter().map(|d| d * d).sum();
        let omega = wx.hypot(wy);
        (square, omega > FRAC_PI_2 && square < NEARLY_BLIND * omega * omega)
    };
    let mut sums = vec![[0.0; 2]; bands.count()];
    for (place, power) in power.iter().enumerate().skip(1) {
        let (square, blind) = seen(place);
        if !blind {
            let [over, under] = &mut sums[bands.of(place)];
            *over += power - 2.0 * noise;
            *under += square;
        }
    }
    let surface: Vec<f64> = sums.chunks(bands.rings).flat_map(never_rising).collect();
    let (mut found, mut left) = (0.0, 0.0);
    for (place, power) in power.iter().enumerate().skip(1) {
        let (square, blind) = seen(place);
        if blind {
            found += power;
            left += square * surface[bands.of(place)] + 2.0 * noise;
        }
    }
    found > TOO_MUCH * left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fft2::angular_frequency;
    use std::f64::consts::TAU;

    /// Power of slopes taken by `derivative` from a surface whose power falls with the square of
    /// frequency, as that of steep edges.
    fn slopes_of(derivative: Derivative, n: usize, noise: f64) -> (Vec<f64>, Vec<f64>) {
        let frequencies: Vec<f64> = (0..n).map(|k| angular_frequency(k, n)).collect();
        let power = |place: usize| {
            let w = [frequencies[place / n], frequencies[place % n]];
            let square: f64 = derivative.symbol(w).iter().map(|d| d * d).sum();
            square * (w[0].hypot(w[1]) + 0.01).powi(-2) + 2.0 * noise
        };
        ((0..n * n).map(power).collect(), frequencies)
    }

    #[test]
    fn only_slopes_taken_otherwise_hold_what_a_derivative_is_blind_to() {
        let n = 64;
        let blind = |made: Derivative, asked: Derivative, noise: f64| {
            let (power, frequencies) = slopes_of(made, n, noise);
            made_blind(asked, &power, [&frequencies, &frequencies], TAU / n as f64, noise)
        };
        for noise in [0.0, 1e-3] {
            for derivative in super::super::DERIVATIVES {
                assert!(!blind(derivative, derivative, noise), "{derivative:?} {noise}");
            }
        }
        assert!(blind(Derivative::Exact, Derivative::Sobel, 1e-5));
        // Noise that hides those waves hides who made them.
        assert!(!blind(Derivative::Exact, Derivative::Sobel, 10.0));
    }
}
