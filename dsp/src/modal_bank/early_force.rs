//! The first samples of a force that lasts, which a bank behind an impulse ring leaves out: [`FirstSamples`] for a contact
//! instead of a strike.
//!
//! A force is known by its mean over each step, two samples before the ring hands it to the bank. With it what is missing is a
//! filter without latency:
//!
//! ```text
//! y(n) += ∫ F(n − u) E(u) du = Σⱼ mⱼ f(n − j)        mⱼ = ∫ E(u) qⱼ(u) du,   0 ≤ j ≤ 4
//! ```
//!
//! f(n) is the mean force over the step whose middle is n, as [`crate::hertz::spread_force`] takes it, and qⱼ the polynomial of
//! degree four whose mean over that step is 1 for f(n − j) and 0 for the other four: forces that are such polynomials over five
//! samples are exact.

use super::FirstSamples;
use super::first_samples::{GAUSS, REACH};

/// Samples of force that [`FirstSamples::of_force`] looks back.
pub const EARLY_HISTORY: usize = REACH;
/// Taps for a force: of its own sample and of those before.
pub type ForceTaps = [f64; EARLY_HISTORY + 1];
/// Edges of the steps.
const EDGES: usize = EARLY_HISTORY + 2;

impl FirstSamples {
    /// What each mean force × step, from the newest back, adds to the output; linear in the modes.
    #[must_use]
    pub fn of_force(&self) -> ForceTaps {
        let mut taps = [0.0; EARLY_HISTORY + 1];
        for first in 0..REACH {
            for (x, weight) in GAUSS {
                let u = first as f64 + 0.5 + 0.5 * x;
                let part = 0.5 * weight * self.missing_at(first, x);
                for (tap, q) in taps.iter_mut().zip(through_means(u)) {
                    *tap += part * q;
                }
            }
        }
        taps
    }
}

/// qⱼ(u): slopes of the polynomial through the integral at the steps' edges.
fn through_means(u: f64) -> ForceTaps {
    let edge = |k: usize| k as f64 - 0.5;
    let slope: [f64; EDGES] = core::array::from_fn(|k| {
        let others = || (0..EDGES).filter(move |l| *l != k);
        let part = |left_out: usize| -> f64 {
            let rest = others().filter(|l| *l != left_out);
            rest.map(|l| (u - edge(l)) / (edge(k) - edge(l))).product::<f64>() / (edge(k) - edge(left_out))
        };
        others().map(part).sum()
    });
    // The integral of qⱼ rises by 1 between edges j and j + 1.
    core::array::from_fn(|j| slope[j + 1..].iter().sum())
}

/// Adds to `out[n]` what is missing there, `impulses_n_s[n + EARLY_HISTORY]` being the mean force × step of its own sample.
pub fn add_early_force(taps: &ForceTaps, impulses_n_s: &[f64], out: &mut [f32]) {
    let [now, one, two, three, four] = taps;
    for (y, window) in out.iter_mut().zip(impulses_n_s.windows(EARLY_HISTORY + 1)) {
        if let [d, c, b, a, newest] = window {
            *y += (now * newest + one * a + two * b + three * c + four * d) as f32;
        }
    }
}
