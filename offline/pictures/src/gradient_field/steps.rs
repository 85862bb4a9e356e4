//! Steps from texel to texel of a surface whose true slopes are known at the texels: their
//! integrals between them.
//!
//! The polynomial through the slopes nearest to a step is integrated: six inside, four next to a
//! border, and from one side at it. Over waves of ω radians a texel, such a step is smaller than
//! the surface's by [`seen_inside`], 3 % at 4 texels and nearly all at 2.

use asperity_surface::raster::Raster;

const SIX: [f64; 3] = [802.0 / 1440.0, -93.0 / 1440.0, 11.0 / 1440.0];
const FOUR: [f64; 2] = [13.0 / 24.0, -1.0 / 24.0];
/// From the border inwards.
const AT_BORDER: [&[f64]; 3] = [
    &[0.5, 0.5],
    &[5.0 / 12.0, 8.0 / 12.0, -1.0 / 12.0],
    &[9.0 / 24.0, 19.0 / 24.0, -5.0 / 24.0, 1.0 / 24.0],
];

/// The step between texels `i` and `i` + 1 of `n`.
fn step(slope: impl Fn(usize) -> f64, i: usize, n: usize) -> f64 {
    let pairs = |weights: &[f64]| -> f64 {
        weights.iter().enumerate().map(|(k, weight)| weight * (slope(i - k) + slope(i + 1 + k))).sum()
    };
    let border = AT_BORDER[n.min(4) - 2];
    match (i, n - 2 - i) {
        (0, _) => border.iter().enumerate().map(|(k, weight)| weight * slope(k)).sum(),
        (_, 0) => border.iter().enumerate().map(|(k, weight)| weight * slope(n - 1 - k)).sum(),
        (1, _) | (_, 1) => pairs(&FOUR),
        _ => pairs(&SIX),
    }
}

/// Steps along u of a surface with these slopes along u.
pub(super) fn along_u(slopes: &Raster) -> Raster {
    let n = slopes.width;
    Raster::from_fn(n.saturating_sub(1), slopes.height, |x, y| {
        let row = slopes.row(y);
        step(|i| row[i], x, n)
    })
}

/// Steps along v of a surface with these slopes along v.
pub(super) fn along_v(slopes: &Raster) -> Raster {
    let n = slopes.height;
    Raster::from_fn(slopes.width, n.saturating_sub(1), |x, y| step(|i| slopes.at(x, i), y, n))
}

/// Share of a wave's steps that its slopes give inside, 0–1.
pub(super) fn seen_inside(omega: f64) -> f64 {
    if omega < 1e-6 {
        return 1.0;
    }
    let sum: f64 =
        SIX.iter().enumerate().map(|(k, weight)| 2.0 * weight * ((k as f64 + 0.5) * omega).cos()).sum();
    sum / ((0.5 * omega).sin() / (0.5 * omega))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_a_cubic_are_exact_and_of_a_wave_as_stated() {
        let cubic = |x: f64| 0.3 * x - 0.2 * x * x + 0.05 * x * x * x;
        let slope = |x: f64| 0.3 - 0.4 * x + 0.15 * x * x;
        for n in [3, 4, 5, 9] {
            let steps = along_u(&Raster::from_fn(n, 1, |x, _| slope(x as f64)));
            for (x, found) in steps.values.iter().enumerate() {
                let true_step = cubic(x as f64 + 1.0) - cubic(x as f64);
                assert!((found - true_step).abs() < 1e-12, "{n} {x}: {found} {true_step}");
            }
        }
        for omega in [0.5, 1.5, 2.5] {
            let steps = along_v(&Raster::from_fn(1, 12, |_, y| omega * (omega * y as f64).cos()));
            let true_step = (6.0 * omega).sin() - (5.0 * omega).sin();
            assert!((steps.values[5] - seen_inside(omega) * true_step).abs() < 1e-12, "{omega}");
        }
    }
}
