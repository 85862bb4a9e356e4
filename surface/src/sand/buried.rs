//! Buried objects: stones and shells in the sand, which a tool meets on its way down.
//!
//! ```text
//! top(x, y) = t + x²/2(ρ_u + r) + y²/2(ρ_v + r)      ρ = half² / 2 height
//! F_r(d)    = F_sand(d) for d ≤ top;   F_sand(top) + k_s β g (e^{k_c d} − e^{k_c top}) below it
//! F_uv      = (F_r − F_sand(top)) ∇top               its flank pushes the tool aside
//! ```
//!
//! | symbol | field | |
//! |---|---|---|
//! | t | [`Buried::top_m`] | depth of its highest point below the untouched sand |
//! | half, height | [`Buried::half_m`], [`Buried::height_m`] | it falls by its height at its half width: a stone is high, a shell flat |
//! | g | [`Buried::hardness`] | over the top sand's, as a layer's is |
//! | r | `tip_radius_m` of the law | a sphere meets a stone before its own middle is over it |
//!
//! Source: the sand paper names shells and stones as future work (§6); ours. An object is a
//! paraboloid, because a sphere that rolls over one is a paraboloid again, and because its flank
//! goes on downwards without an edge that a deep tool would fall off. It does not move, and does
//! not break. Grains in the air, which the paper names beside it, are left out.

use asperity_dsp::DesignError;
use asperity_dsp::limits::sand as limits;

/// Most buried objects of one bed.
pub const MAX_BURIED: usize = 8;

/// A stone or a shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Buried {
    /// Place of its highest point along u and v, metres.
    pub at_m: [f64; 2],
    /// Depth of that below the untouched sand, metres, at or above 0.
    pub top_m: f64,
    /// Half its width along u and v, metres, above 0.
    pub half_m: [f64; 2],
    /// Drop at half its width, metres, above 0.
    pub height_m: f64,
    /// Its hardness against the top sand's, above 0.
    pub hardness: f64,
}

/// Obstacle that a tool meets below a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Met {
    /// Depth at which it is met, metres.
    pub top_m: f64,
    /// Slope of that depth along u and v.
    pub slope: [f64; 2],
    /// Hardness below.
    pub hardness: f64,
}

impl Buried {
    /// Refuses what is no object.
    ///
    /// # Errors
    /// Names the first field out of its range.
    pub fn check(&self) -> Result<(), DesignError> {
        for at_m in self.at_m {
            limits::BURIED_AT_M.check("buried.at_m", at_m)?;
        }
        for half_m in self.half_m {
            limits::BURIED_HALF_M.check("buried.half_m", half_m)?;
        }
        limits::BURIED_TOP_M.check("buried.top_m", self.top_m)?;
        limits::BURIED_HEIGHT_M.check("buried.height_m", self.height_m)?;
        limits::HARDNESS.check("buried.hardness", self.hardness)?;
        Ok(())
    }

    /// Obstacle that a tool with an underside of `tip_radius_m` meets of it below a place where the
    /// sand lies `above_m` over the untouched bed.
    #[must_use]
    pub fn met(&self, position_m: [f64; 2], above_m: f64, tip_radius_m: f64) -> Met {
        let slope = [0, 1].map(|a| {
            let bend_m = self.half_m[a] * self.half_m[a] / (2.0 * self.height_m) + tip_radius_m;
            (position_m[a] - self.at_m[a]) / bend_m
        });
        let falls_m: f64 = (0..2).map(|a| 0.5 * slope[a] * (position_m[a] - self.at_m[a])).sum();
        // Where it lies bare, sand and stone are level.
        Met { top_m: (self.top_m + above_m + falls_m).max(0.0), slope, hardness: self.hardness }
    }
}

/// Obstacle that a tool meets first.
#[must_use]
pub fn first_met(
    buried: &[Option<Buried>],
    position_m: [f64; 2],
    above_m: f64,
    tip_radius_m: f64,
) -> Option<Met> {
    let met = buried.iter().flatten().map(|object| object.met(position_m, above_m, tip_radius_m));
    met.min_by(|a, b| a.top_m.total_cmp(&b.top_m))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STONE: Buried =
        Buried { at_m: [0.05, 0.03], top_m: 0.002, half_m: [0.008, 0.004], height_m: 0.004, hardness: 30.0 };

    #[test]
    fn a_stone_under_a_point_ends_at_half_its_width() {
        let top_m = |u_m: f64, v_m: f64| STONE.met([u_m, v_m], 0.0, 0.0).top_m;
        assert!((top_m(0.05, 0.03) - 0.002).abs() < 1e-15);
        assert!((top_m(0.058, 0.03) - 0.006).abs() < 1e-15 && (top_m(0.05, 0.026) - 0.006).abs() < 1e-15);
    }

    #[test]
    fn a_ball_meets_it_where_it_touches_it_first() {
        // Near its top a stone of these axes is a sphere of 8 mm; a ball of 5 mm on it rides on one
        // of 13 mm.
        let stone = Buried { half_m: [0.008; 2], ..STONE };
        let met = stone.met([0.052, 0.03], 0.0, 0.005);
        let exact_m = 0.002 + 0.013 - (0.013f64.powi(2) - 0.002f64.powi(2)).sqrt();
        assert!((met.top_m / exact_m - 1.0).abs() < 1e-3, "{met:?} {exact_m}");
        let step_m = 1e-6;
        let next_m = stone.met([0.052 + step_m, 0.03], 0.0, 0.005).top_m;
        assert!(((next_m - met.top_m) / step_m - met.slope[0]).abs() < 1e-3);
    }

    #[test]
    fn the_highest_of_several_is_met_and_sand_heaped_over_it_counts() {
        let shell = Buried { at_m: [0.05, 0.05], top_m: 0.001, height_m: 0.001, hardness: 8.0, ..STONE };
        let buried = [Some(STONE), None, Some(shell)];
        assert_eq!(first_met(&buried, [0.05, 0.03], 0.0, 0.0).map(|met| met.hardness), Some(30.0));
        let over_shell = first_met(&buried, [0.05, 0.05], 0.0005, 0.0).unwrap();
        assert!((over_shell.top_m - 0.0015).abs() < 1e-15 && over_shell.hardness == 8.0);
        assert_eq!(first_met(&buried, [0.05, 0.05], -0.01, 0.0).unwrap().top_m, 0.0);
        assert_eq!(first_met(&[None; 8], [0.0; 2], 0.0, 0.0), None);
    }
}
