//! Which modes the data prove: a Wald test with the covariance of *all* parameters.
//!
//! ```text
//! W_k = c_kᵀ (σ_k² [ (JᵀJ)⁻¹ ]_cc,k )⁻¹ c_k        kept when  W_k ≥ 2 ln(5 N / P_fa)
//! ```
//! The inverse is that of the whole 4K × 4K matrix: two modes that split one resonance between them
//! have enormous joint variances and fail, where a test of amplitudes alone would pass both (measured:
//! 46 split modes in 100 against none). Only local minima are removed at a time, so that one of the
//! two stays and is refitted.

use crate::noise_floor::NoiseFloor;
use crate::partial::Partial;
use crate::refinement::{Scaled, gram_matrix};
use nalgebra::{DMatrix, Matrix2, Vector2};

/// Chance of one false mode in a recording.
pub const FALSE_ALARM: f64 = 0.01;

/// Standard deviations of one partial's parameters, in units of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    /// Of ω, radians a sample.
    pub omega: f64,
    /// Of δ, nepers a sample.
    pub delta: f64,
    /// Of |c|.
    pub amplitude: f64,
    /// Of arg c, radians.
    pub phase: f64,
    /// Wald statistic: squared amplitude in standard deviations.
    pub wald: f64,
}

/// The uncertainty of every partial fitted to `count` samples over `noise`; infinite where the data
/// say nothing.
#[must_use]
pub fn uncertainties(partials: &[Partial], noise: &NoiseFloor, count: usize) -> Vec<Uncertainty> {
    if partials.is_empty() {
        return Vec::new();
    }
    let gram = gram_matrix(partials, count);
    let Some(system) = [1e-13, 1e-11, 1e-9, 1e-7].into_iter().find_map(|ridge| Scaled::new(&gram, ridge))
    else {
        let unknown = Uncertainty {
            omega: f64::INFINITY,
            delta: f64::INFINITY,
            amplitude: f64::INFINITY,
            phase: f64::INFINITY,
            wald: 0.0,
        };
        return vec![unknown; partials.len()];
    };
    let inverse = system.inverse();
    partials
        .iter()
        .enumerate()
        .map(|(k, partial)| uncertainty(partial, &inverse, k, noise.variance_at(partial.omega)))
        .collect()
}

fn uncertainty(partial: &Partial, inverse: &DMatrix<f64>, k: usize, variance: f64) -> Uncertainty {
    let at = 4 * k;
    let block = Matrix2::new(
        inverse[(at, at)],
        inverse[(at, at + 1)],
        inverse[(at + 1, at)],
        inverse[(at + 1, at + 1)],
    ) * variance;
    let c = Vector2::new(partial.c.re, partial.c.im);
    let size = c.norm().max(1e-300);
    let along = c / size;
    let across = Vector2::new(-along.y, along.x);
    Uncertainty {
        omega: (inverse[(at + 2, at + 2)] * variance).max(0.0).sqrt(),
        delta: (inverse[(at + 3, at + 3)] * variance).max(0.0).sqrt(),
        amplitude: along.dot(&(block * along)).max(0.0).sqrt(),
        phase: across.dot(&(block * across)).max(0.0).sqrt() / size,
        wald: block.try_inverse().map_or(0.0, |inverse| c.dot(&(inverse * c))),
    }
}

/// The least Wald statistic of a mode proven by `count` samples.
#[must_use]
pub fn threshold(count: usize) -> f64 {
    2.0 * (5.0 * count as f64 / FALSE_ALARM).ln()
}

/// Removes the unproven partials that are weakest among their neighbours; says how many.
pub fn prune(partials: &mut Vec<Partial>, noise: &NoiseFloor, count: usize) -> usize {
    let wald: Vec<f64> = uncertainties(partials, noise, count).iter().map(|u| u.wald).collect();
    let least = threshold(count);
    let reach = 4.0 * std::f64::consts::PI / count as f64;
    let doomed: Vec<bool> = (0..partials.len())
        .map(|k| {
            wald[k] < least
                && partials.iter().zip(&wald).enumerate().all(|(j, (other, &w))| {
                    let gap = (other.omega - partials[k].omega).abs();
                    j == k
                        || gap > reach + 2.0 * (other.delta + partials[k].delta)
                        || (w, j) > (wald[k], k)
                })
        })
        .collect();
    let before = partials.len();
    let mut doomed = doomed.into_iter();
    partials.retain(|_| !doomed.next().unwrap_or(false));
    before - partials.len()
}
