//! Footprint: what a ball feels that stands in soft ground, the mean of the relief under it.
//!
//! ```text
//! a  = √(2 r d − d²)                circle in which a ball of radius r stands d deep, d ≤ r
//! h̄  = ∫ h(x + a y) w(y) dy,        w = 2/π (1 − |y|²), |y| < 1
//! ```
//! A wave of length λ is felt by 8 J₂(κ)/κ² of its height, κ = 2π a/λ.
//!
//! Source: K. L. Johnson, "Contact mechanics" (1985) §4.3, recalled: the ground as a mattress of
//! springs (Winkler), whose circle is a and whose pressure falls to the rim as w does. The weights
//! are ours: of each place as much is felt as presses there, so that ground gives a deep ball its
//! mean level and a ball that only just touches the height of one place.
//!
//! The integral is a sum over 64 places, evenly about each of five rings. What is too fine for them
//! is blurred by the source before it is read. Radii and weights are the ones whose sum, over waves
//! of every length and direction and every share of two neighbouring octaves of a map's blur, is
//! nowhere farther from the law than 0.74 % of the wave's height: beyond κ = 8 they make up for
//! half of what the blur takes, which Gauss' nodes for w do not (74 places, 1.1 %).

use crate::height_field::{HeightField, MAX_BLOCK, PathBlock, SurfaceBlock};

/// Radius of each ring over a, its share of the weight, and its places.
const RINGS: [(f64, f64, u32); 5] = [
    (0.168_775, 0.139_661, 6),
    (0.377_201, 0.269_083, 11),
    (0.563_035, 0.252_192, 15),
    (0.752_481, 0.300_516, 17),
    (0.924_952, 0.038_548, 15),
];
/// Turn of each ring against the one within, radians.
const TURN_RAD: f64 = 0.37;
/// To what share of a the source is blurred: the rings do not see what is finer.
const BLUR: f64 = 0.145;

/// Radius of the circle in which a ball stands `depth_m` deep in the ground, m.
#[must_use]
pub fn footprint_radius_m(ball_radius_m: f64, depth_m: f64) -> f64 {
    let depth_m = depth_m.clamp(0.0, ball_radius_m);
    (depth_m * (2.0 * ball_radius_m - depth_m)).sqrt()
}

/// Samples a source as a ball feels it whose footprint is `radius_m` wide, one a sample: heights
/// and slopes are means, the rest is as it is in the middle. A source that is not
/// [stateless](crate::height_field::Properties::is_stateless) is felt in the middle.
pub fn sample_under(
    source: &mut (impl HeightField + ?Sized),
    path: &PathBlock<'_>,
    radius_m: &[f64],
    out: &mut SurfaceBlock,
) {
    source.sample(path, out);
    let n = path.len().min(radius_m.len()).min(MAX_BLOCK);
    let is_stateless = source.properties([f64::INFINITY; 2]).is_stateless;
    if !is_stateless || radius_m[..n].iter().all(|radius_m| *radius_m == 0.0) {
        return;
    }
    let (mut position_m, mut footprint_m) = ([[0.0; 2]; MAX_BLOCK], [0.0; MAX_BLOCK]);
    for (i, footprint_m) in footprint_m[..n].iter_mut().enumerate() {
        *footprint_m = path.footprint_m[i].max(BLUR * radius_m[i]);
    }
    out.height_m[..n].fill(0.0);
    out.gradient[..n].fill([0.0; 2]);
    let mut there = SurfaceBlock::default();
    for (ring, (distance, share, places)) in (0_u32..).zip(RINGS) {
        let weight = share / f64::from(places);
        let step_rad = core::f64::consts::TAU / f64::from(places);
        // An odd ring begins between two places.
        let first_rad = 0.5 * f64::from(ring % 2) * step_rad + TURN_RAD * f64::from(ring);
        let (mut sine, mut cosine) = libm::sincos(first_rad);
        let (step_sine, step_cosine) = libm::sincos(step_rad);
        for _ in 0..places {
            for (i, beside_m) in position_m[..n].iter_mut().enumerate() {
                let away_m = distance * radius_m[i];
                *beside_m = [path.position_m[i][0] + away_m * cosine, path.position_m[i][1] + away_m * sine];
            }
            let beside = PathBlock {
                position_m: &position_m[..n],
                velocity_m_s: &path.velocity_m_s[..n],
                footprint_m: &footprint_m[..n],
                normal_force_n: path.normal_force_n,
                bounds_m: None,
                full_power_m2: None,
                ..*path
            };
            source.sample(&beside, &mut there);
            for i in 0..n {
                out.height_m[i] += weight * there.height_m[i];
                out.gradient[i] = [0, 1].map(|a| out.gradient[i][a] + weight * there.gradient[i][a]);
            }
            (sine, cosine) =
                (sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::height_map::{Extent, HeightMap};
    use crate::raster::Raster;
    use crate::wrap::Wrap;

    const SIDE_M: f64 = 0.02;

    /// J₂ by its integral, (1/π) ∫ cos(2 θ − x sin θ) dθ from 0 to π.
    fn bessel_j2(x: f64) -> f64 {
        let steps = 2000;
        let at = |step: usize| {
            let angle = core::f64::consts::PI * (step as f64 + 0.5) / steps as f64;
            (2.0 * angle - x * angle.sin()).cos()
        };
        (0..steps).map(at).sum::<f64>() / steps as f64
    }

    fn felt(kappa: f64) -> f64 {
        8.0 * bessel_j2(kappa) / (kappa * kappa)
    }

    /// Waves on a map of 1024² texels, `u` of them along u and `v` along v.
    fn waves(u: usize, v: usize) -> HeightMap {
        let side = 1024;
        let turn = |i: usize, count: usize| count as f64 * (i as f64 + 0.5) / side as f64;
        let wave = |x: usize, y: usize| (core::f64::consts::TAU * (turn(x, u) + turn(y, v))).cos();
        let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
        HeightMap::new(&Raster::from_fn(side, side, wave), extent, Wrap::Repeat).unwrap()
    }

    /// Height of the waves under a ball, and the rms of the rest over theirs, by fitting the wave
    /// to 64 places.
    fn height_felt(map: &mut HeightMap, u: usize, v: usize, radius_m: f64, velocity: [f64; 2]) -> (f64, f64) {
        let places: Vec<[f64; 2]> =
            (0..64).map(|i| [0.0131 * f64::from(i) * SIDE_M, 0.0077 * f64::from(i) * SIDE_M]).collect();
        let path = PathBlock {
            position_m: &places,
            velocity_m_s: &[velocity; 64],
            footprint_m: &[1e-6; 64],
            normal_force_n: &[],
            first_sample: 0,
            contact: 0,
            slopes: true,
            ..PathBlock::default()
        };
        let mut out = SurfaceBlock::default();
        sample_under(map, &path, &[radius_m; 64], &mut out);
        let (mut both, mut own) = (0.0, 0.0);
        for (place, height_m) in places.iter().zip(&out.height_m) {
            let wave = (core::f64::consts::TAU * (u as f64 * place[0] + v as f64 * place[1]) / SIDE_M).cos();
            (both, own) = (both + wave * height_m, own + wave * wave);
        }
        let wave = |[u_m, v_m]: [f64; 2]| {
            (core::f64::consts::TAU * (u as f64 * u_m + v as f64 * v_m) / SIDE_M).cos()
        };
        let rest = |(place, height_m): (&[f64; 2], &f64)| (height_m - both / own * wave(*place)).powi(2);
        let rest: f64 = places.iter().zip(&out.height_m).map(rest).sum();
        (both / own, (rest / own).sqrt())
    }

    #[test]
    fn waves_of_every_length_are_felt_as_the_closed_form() {
        let (mut near, mut worst) = (0.0_f64, 0.0_f64);
        for (u, v) in [(4, 0), (10, 0), (0, 17), (12, 5), (20, 20), (7, 24), (40, 0), (64, 31)] {
            let mut map = waves(u, v);
            let per_m = core::f64::consts::TAU * (u as f64).hypot(v as f64) / SIDE_M;
            for radius_m in [2e-5, 1e-4, 2.3e-4, 3.7e-4, 6e-4, 1e-3, 1.7e-3] {
                for velocity in [[0.1, 0.0], [0.03, 0.08], [0.0, 0.0]] {
                    let (found, rest) = height_felt(&mut map, u, v, radius_m, velocity);
                    let kappa = per_m * radius_m;
                    let off = found - felt(kappa);
                    println!(
                        "kappa {kappa:6.2}: {found:8.4}, law {:8.4}, off {off:8.4}, rest {rest:8.4}",
                        felt(kappa)
                    );
                    let error = off.abs().max(rest);
                    worst = worst.max(error);
                    near = if kappa < 6.4 { near.max(error) } else { near };
                }
            }
        }
        println!("{near:.4} near, {worst:.4} at most");
        assert!(near < 0.009 && worst < 0.01, "{near}, {worst}");
    }

    #[test]
    fn a_barely_touching_ball_rides_one_place_and_leaves_a_slope_unchanged() {
        let mut map = waves(10, 0);
        let path = PathBlock {
            position_m: &[[1.1e-3, 5e-3]],
            velocity_m_s: &[[0.1, 0.0]],
            footprint_m: &[2e-6],
            normal_force_n: &[],
            first_sample: 0,
            contact: 0,
            slopes: true,
            ..PathBlock::default()
        };
        let (mut point, mut ball) = (SurfaceBlock::default(), SurfaceBlock::default());
        map.sample(&path, &mut point);
        sample_under(&mut map, &path, &[0.0], &mut ball);
        assert_eq!((point.height_m[0], point.gradient[0]), (ball.height_m[0], ball.gradient[0]));
        sample_under(&mut map, &path, &[4e-6], &mut ball);
        assert!((point.height_m[0] - ball.height_m[0]).abs() < 1e-4);
        assert!((point.gradient[0][0] / ball.gradient[0][0] - 1.0).abs() < 1e-3);
    }

    #[test]
    fn the_circle_is_the_balls_section_and_no_wider() {
        assert!((footprint_radius_m(5e-3, 1e-3) - 3e-3).abs() < 1e-15);
        assert_eq!((footprint_radius_m(5e-3, 0.0), footprint_radius_m(5e-3, 1.0)), (0.0, 5e-3));
    }
}
