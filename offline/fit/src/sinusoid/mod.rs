//! The damped sinusoid: its sums in closed form, and joint least squares of many.
//!
//! | file | what |
//! |---|---|
//! | [`partial`] | Re(c zⁿ): one, in units of samples |
//! | [`geometric_sum`] | Σ nᵏ zⁿ in closed form |
//! | [`projection`] | passes over samples: sums of partials, their products with a signal |
//! | [`normal_equations`] | scaled least squares |
//! | [`amplitudes`] | poles → amplitudes |
//! | [`refinement`] | partials → maximum-likelihood partials |

pub(crate) mod amplitudes;
pub(crate) mod geometric_sum;
pub(crate) mod normal_equations;
pub(crate) mod partial;
pub(crate) mod projection;
pub(crate) mod refinement;
