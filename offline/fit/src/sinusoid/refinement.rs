//! Joint refinement of all modes: damped least squares on every parameter at once.
//!
//! In white noise the least-squares fit *is* the maximum-likelihood fit, and this is the step that
//! brings sub-band estimates (2–3 bounds) to the Cramér–Rao bound. The parameters of partial k are
//! (Re c, Im c, ω, δ); a column of the Jacobian is Re(g · n^p · zⁿ) with
//!
//! | parameter | g | p |
//! |---|---|---|
//! | Re c | 1 | 0 |
//! | Im c | j | 0 |
//! | ω | j c | 1 |
//! | δ | −c | 1 |
//!
//! so JᵀJ needs no samples: ⟨a, b⟩ = ½ Re( g_a g_b S_p(z_a z_b) + g_a ḡ_b S_p(z_a z̄_b) ), and Jᵀr
//! is [`correlate`]. Levenberg–Marquardt (Marquardt 1963) with column scaling; a step moves a mode
//! by at most half of its half-bandwidth.

use crate::sinusoid::amplitudes::fit_amplitudes;
use crate::sinusoid::geometric_sum::geometric_sums;
use crate::sinusoid::normal_equations::Scaled;
use crate::sinusoid::partial::Partial;
use crate::sinusoid::projection::{correlate, synthesise};
use nalgebra::{Complex, DMatrix, DVector};

type C = Complex<f64>;

/// Bounds of a mode of a real recording; everything outside is pulled back after every step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lowest ω, radians a sample.
    pub omega_low: f64,
    /// Highest ω.
    pub omega_high: f64,
    /// Smallest δ, nepers a sample.
    pub delta_low: f64,
    /// Largest δ.
    pub delta_high: f64,
    /// Largest |c| at the start of the segment: stops pairs of giants that cancel each other.
    pub amplitude_high: f64,
    /// Cost of a partial's own energy, as a part of it, beside the squared residual: 0 for the
    /// likeliest fit; a thousandth keeps pairs from growing against each other where nothing is an
    /// exponential.
    pub energy_cost: f64,
}

impl Bounds {
    /// Nothing is refused except growing modes.
    #[cfg(test)]
    pub fn wide() -> Self {
        Self {
            omega_low: 0.0,
            omega_high: std::f64::consts::PI,
            delta_low: 0.0,
            delta_high: f64::INFINITY,
            amplitude_high: f64::INFINITY,
            energy_cost: 0.0,
        }
    }

    /// Tests whether a partial is within all of them.
    #[must_use]
    pub fn allow(&self, partial: &Partial) -> bool {
        (self.omega_low..=self.omega_high).contains(&partial.omega)
            && (self.delta_low..=self.delta_high).contains(&partial.delta)
            && partial.c.norm() <= self.amplitude_high
    }

    pub(crate) fn apply(&self, partial: &mut Partial) {
        partial.omega = partial.omega.clamp(self.omega_low, self.omega_high);
        partial.delta = partial.delta.clamp(self.delta_low, self.delta_high);
        let size = partial.c.norm();
        if size > self.amplitude_high {
            partial.c *= self.amplitude_high / size;
        }
    }
}

/// JᵀJ of all partials over `count` samples, four rows a partial.
#[must_use]
pub fn gram_matrix(partials: &[Partial], count: usize) -> DMatrix<f64> {
    let size = 4 * partials.len();
    let mut gram = DMatrix::zeros(size, size);
    let poles: Vec<(C, C)> = partials.iter().map(|p| (p.pole(), p.power(count as f64))).collect();
    let gains: Vec<[C; 4]> = partials
        .iter()
        .map(|p| [C::new(1.0, 0.0), C::new(0.0, 1.0), C::new(-p.c.im, p.c.re), -p.c])
        .collect();
    for j in 0..partials.len() {
        for i in 0..=j {
            let (zi, zi_n) = poles[i];
            let (zj, zj_n) = poles[j];
            let sum = geometric_sums(zi * zj, zi_n * zj_n, count);
            let difference = geometric_sums(zi * zj.conj(), zi_n * zj_n.conj(), count);
            for (b, gb) in gains[j].iter().enumerate() {
                for (a, ga) in gains[i].iter().enumerate() {
                    let p = usize::from(a >= 2) + usize::from(b >= 2);
                    let value = 0.5 * (ga * gb * sum[p] + ga * gb.conj() * difference[p]).re;
                    gram[(4 * i + a, 4 * j + b)] = value;
                    gram[(4 * j + b, 4 * i + a)] = value;
                }
            }
        }
    }
    gram
}

/// Jᵀr, in the order of [`gram_matrix`].
#[must_use]
pub fn gradient(residual: &[f64], partials: &[Partial]) -> DVector<f64> {
    let mut out = DVector::zeros(4 * partials.len());
    for (k, ([p0, p1], partial)) in correlate(residual, partials).into_iter().zip(partials).enumerate() {
        out[4 * k] = p0.re;
        out[4 * k + 1] = -p0.im;
        let cp = partial.c * p1;
        out[4 * k + 2] = -cp.im;
        out[4 * k + 3] = -cp.re;
    }
    out
}

/// Result of a refinement.
#[derive(Debug, Clone)]
pub struct Refined {
    /// Sum of squares of the residual.
    pub cost: f64,
    /// Signal minus partials.
    pub residual: Vec<f64>,
}

/// Refines `partials` (amplitudes at `signal[0]`) by at most `steps` accepted steps.
pub fn refine(signal: &[f64], partials: &mut Vec<Partial>, bounds: &Bounds, steps: usize) -> Refined {
    let mut current = evaluate(signal, partials, bounds);
    let mut ridge = 1e-6;
    for _ in 0..steps {
        if partials.is_empty() {
            break;
        }
        let mut gram = gram_matrix(partials, signal.len());
        let mut gradient = gradient(&current.residual, partials);
        if bounds.energy_cost > 0.0 {
            charge(&mut gram, &mut gradient, partials, signal.len(), bounds.energy_cost);
        }
        let before = current.cost;
        for _ in 0..6 {
            let Some(system) = Scaled::new(&gram, ridge) else {
                ridge = (ridge * 30.0).max(1e-12);
                continue;
            };
            let mut candidate = stepped(partials, &system.solve(&gradient), bounds, signal.len());
            if bounds.energy_cost == 0.0 {
                fit_amplitudes(signal, &mut candidate);
                candidate.iter_mut().for_each(|partial| bounds.apply(partial));
            }
            let next = evaluate(signal, &candidate, bounds);
            if next.cost < current.cost {
                *partials = candidate;
                current = next;
                ridge = (ridge * 0.1).max(1e-13);
                break;
            }
            ridge *= 30.0;
        }
        // Less than a hundredth of one noise variance: a tenth of a bound, shared by all
        // parameters.
        if before - current.cost <= 1e-2 * current.cost / signal.len() as f64 {
            break;
        }
    }
    current
}

/// Adds the cost of the partials' own energy, E = ½|c|² Σ e^(−2δn), to the normal equations.
fn charge(
    gram: &mut DMatrix<f64>,
    gradient: &mut DVector<f64>,
    partials: &[Partial],
    count: usize,
    cost: f64,
) {
    for (k, partial) in partials.iter().enumerate() {
        let square = C::new((-2.0 * partial.delta).exp(), 0.0);
        let power = C::new((-2.0 * partial.delta * count as f64).exp(), 0.0);
        let [length, first, second] = geometric_sums(square, power, count).map(|s| cost * s.re);
        let size = partial.c.norm_sqr();
        for (i, part) in [partial.c.re, partial.c.im].into_iter().enumerate() {
            gram[(4 * k + i, 4 * k + i)] += 0.5 * length;
            gradient[4 * k + i] -= 0.5 * length * part;
        }
        gram[(4 * k + 3, 4 * k + 3)] += size * second;
        gradient[4 * k + 3] += 0.5 * size * first;
    }
}

fn evaluate(signal: &[f64], partials: &[Partial], bounds: &Bounds) -> Refined {
    let mut residual = synthesise(partials, signal.len());
    let mut cost = 0.0;
    for (r, s) in residual.iter_mut().zip(signal) {
        *r = s - *r;
        cost += *r * *r;
    }
    if bounds.energy_cost > 0.0 {
        cost += bounds.energy_cost * partials.iter().map(|p| p.energy(signal.len())).sum::<f64>();
    }
    Refined { cost: if cost.is_finite() { cost } else { f64::INFINITY }, residual }
}

/// The partials moved by `step`, each within its trust region and the bounds.
fn stepped(partials: &[Partial], step: &DVector<f64>, bounds: &Bounds, count: usize) -> Vec<Partial> {
    partials
        .iter()
        .enumerate()
        .map(|(k, partial)| {
            let reach = 0.5 * partial.delta.max(2.0 / count as f64);
            let mut moved = Partial {
                omega: partial.omega + step[4 * k + 2].clamp(-reach, reach),
                delta: partial.delta + step[4 * k + 3].clamp(-reach, reach),
                c: partial.c + C::new(step[4 * k], step[4 * k + 1]),
            };
            bounds.apply(&mut moved);
            moved
        })
        .collect()
}
