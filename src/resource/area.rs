//! Area of contact: how many asperities sound.
//!
//! ```text
//! sound ∝ √A        A ∝ (F / κ)^(2/3)        κ = 1/r − H,  H = 2 hollow / reach²
//! ```
//! A is the area of Hertz' contact of a sphere of the tip's radius r on ground of the mean
//! curvature H (above 0 in a hollow), √A because asperities strike each by itself. So a fingertip
//! on waves as wide as itself is heard once a wave, even where the waves are so smooth that its
//! mass follows them without a sound: on a crest it touches with less of its skin than on a plane,
//! in a hollow with more.

use crate::resource::stiffness::within;

/// Radius of a fingertip's pulp, m: of what has no tip of its own. Hertz fits of fingers take 5 to
/// 10 mm; **chosen** among them.
pub(crate) const FINGERTIP_RADIUS_M: f64 = 8e-3;
/// Distance from its middle at which a tip feels how the ground bends, over its radius: about the
/// radius of its area of contact. **Chosen.**
const REACH: f64 = 0.25;
/// κ r in the closest hollow, where the law of a small area ends, and on the sharpest crest.
const CLOSENESS: (f64, f64) = (0.25, 16.0);

/// Loudness of a contact over that at 1 N on a plane.
pub(crate) fn loudness(force_n: f64) -> f64 {
    libm::cbrt(within(force_n))
}

/// Loudness where the ground bends over that on a plane; `local_concavity_m` says how much higher
/// the ground lies at a reach.
pub(crate) fn nestling(tip_radius_m: f64, local_concavity_m: impl FnOnce(f64) -> f64) -> f64 {
    let radius_m = if tip_radius_m > 0.0 { tip_radius_m } else { FINGERTIP_RADIUS_M };
    let reach_m = REACH * radius_m;
    let mean_curvature_per_m = 2.0 * local_concavity_m(reach_m) / (reach_m * reach_m);
    libm::cbrt((1.0 - radius_m * mean_curvature_per_m).clamp(CLOSENESS.0, CLOSENESS.1)).recip()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ground of a constant mean curvature.
    fn bent(curvature_per_m: f64) -> impl FnOnce(f64) -> f64 {
        move |reach_m| 0.5 * curvature_per_m * reach_m * reach_m
    }

    #[test]
    fn a_plane_changes_nothing_and_a_ball_on_a_ball_curves_less() {
        assert_eq!(nestling(2e-3, bent(0.0)), 1.0);
        // A crest as sharp as the tip: κ = 2/r, so the area is 2^(−2/3) and the sound 2^(−1/3).
        assert!((nestling(2e-3, bent(-500.0)) - 0.5f64.cbrt()).abs() < 1e-12);
        // A hollow of twice its radius: κ = 1/(2r).
        assert!((nestling(2e-3, bent(250.0)) - 2f64.cbrt()).abs() < 1e-12);
        assert!((loudness(8.0) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn the_deeper_the_hollow_the_louder_within_bounds() {
        let at = |per_m: f64| nestling(0.0, bent(per_m));
        let steps: Vec<f64> = (-200..200).map(|step| at(50.0 * f64::from(step))).collect();
        assert!(steps.windows(2).all(|pair| pair[1] >= pair[0]));
        assert!((steps[0] - 16f64.cbrt().recip()).abs() < 1e-12 && (steps[399] - 4f64.cbrt()).abs() < 1e-12);
    }
}
