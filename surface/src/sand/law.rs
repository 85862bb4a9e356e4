//! The force law of sand, and of its grains.
//!
//! ```text
//! F_r(d) = k_s β (e^{k_c d} − 1)   for d > 0, else 0, upwards    d(F) its inverse
//! F_f    = −k_f v |F_r|                                           along the surface
//! |F_r + F_f| ≤ cap                                               what a device gives
//! β      = A(3 mm) / A₀(3 mm)      A: area of the tool's print, A₀: that of the document's sphere of 5 mm
//! over a buried object: `buried`
//! layers: F_r(d) = ∫₀^d k_s k_c g(z) e^{k_c z} dz,  g = hardness of the layer at depth z
//! ```
//!
//! | symbol | field | the document | here |
//! |---|---|---|---|
//! | k_s | [`SandLaw::stiffness_n`] | 1000 | 1000 N |
//! | k_c | [`SandLaw::exponent_per_m`] | ½ per unit | 1 m⁻¹ |
//! | k_f | [`SandLaw::drag_s_per_m`] | 10 | 20 s/m |
//! | β | [`SandLaw::bearing`] | – | the tool's |
//! | cap | [`SandLaw::cap_n`] | 12 and 20 N | 20 N |
//!
//! Source: the sand paper §4.1, equations 1 and 3, on a square of 2 units with a sphere of 0.01.
//! Its unit is taken as 0.5 m (ours), so that the sphere is a fingertip of 5 mm; 0.006 and 0.01
//! units then give the 3.005 N and 5.013 N of its constants. What we read differently: as printed,
//! equation 1 is −k_s e^{k_c d} − 1, a jump of 1001 N at the surface; and the friction is
//! horizontal (the text says vertical). What we added, all ours and simple: wetness w multiplies
//! k_s by 1 + 2w and raises the talus angle by 20° · w (damp sand holds a steeper slope); layers
//! multiply the hardness below their depth; grains: a share of the displaced grains hits another
//! one at the tool's speed. β is our answer to the authors' first open point, repulse by the area
//! in the sand: they drop the area, because their tool is always the same sphere; here a wider tool
//! is carried by more sand. It is measured at the depth of their 3 N, so that their sphere keeps
//! their constants and d(F) stays a closed form. There is no Coulomb friction beside F_f, and
//! grains finer than a cell do not push a tool sideways: it rides on many of them at once.

use super::buried::{Buried, MAX_BURIED, Met, first_met};
use crate::force_output::capped;
use asperity_dsp::DesignError;
use asperity_dsp::limits::{Range, sand as limits};

/// k_s, N.
pub const STIFFNESS_N: f64 = 1000.0;
/// k_c, 1/m.
pub const EXPONENT_PER_M: f64 = 1.0;
/// k_f, s/m.
pub const DRAG_S_PER_M: f64 = 20.0;
/// Diameter of a grain, metres (assumed; medium sand).
pub const GRAIN_M: f64 = 3e-4;
/// Density of a grain, kg/m³ (quartz).
pub const GRAIN_DENSITY_KG_M3: f64 = 2650.0;
/// Share of displaced grains that strike another one (assumed).
pub const STRIKING_SHARE: f64 = 0.02;
/// Largest force, N: of the document's two devices, the stronger.
pub const CAP_N: f64 = 20.0;
/// Depth at which the areas of prints are compared, metres: the document's 3.005 N.
pub const BEARING_DEPTH_M: f64 = 0.003;
/// The document's tool, metres.
pub const REFERENCE_RADIUS_M: f64 = 0.005;
/// No sand carries more, N: a depth or an exponent beyond all sand keeps a direction, which
/// infinity does not.
const MOST_N: f64 = 1e9;
/// Nothing is buried farther away, m; beyond, and at places that are no numbers, there is sand
/// alone.
const FARTHEST_M: f64 = 1e6;
/// Nothing drags faster, m/s.
const FASTEST_M_S: f64 = 1e6;
/// Most layers.
pub const MAX_LAYERS: usize = 4;

/// Sand below a depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Depth at which it begins, metres, above 0 and above the previous one.
    pub from_m: f64,
    /// Hardness against the top layer's, above 0.
    pub hardness: f64,
}

/// The force law of one kind of sand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SandLaw {
    /// k_s, N, above 0.
    pub stiffness_n: f64,
    /// k_c, 1/m, above 0.
    pub exponent_per_m: f64,
    /// k_f, s/m, at or above 0.
    pub drag_s_per_m: f64,
    /// 0 = dry, 1 = wet.
    pub wetness: f64,
    /// Layers below the top, unused ones `None`.
    pub layers: [Option<Layer>; MAX_LAYERS],
    /// Diameter of a grain, metres.
    pub grain_m: f64,
    /// Largest force, N, above 0.
    pub cap_n: f64,
    /// β: how much more the tool is carried than a sphere of 5 mm. A bed of sand sets it by its
    /// [tool](super::Tool::bearing).
    pub bearing: f64,
    /// Radius of the tool's underside, metres, 0 for a point; a bed of sand sets it by its
    /// [tool](super::Tool::tip_radius_m).
    pub tip_radius_m: f64,
    /// Stones and shells in it, unused ones `None`.
    pub buried: [Option<Buried>; MAX_BURIED],
}

impl Default for SandLaw {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl SandLaw {
    /// Dry sand without layers.
    pub const DEFAULT: Self = Self {
        stiffness_n: STIFFNESS_N,
        exponent_per_m: EXPONENT_PER_M,
        drag_s_per_m: DRAG_S_PER_M,
        wetness: 0.0,
        layers: [None; MAX_LAYERS],
        grain_m: GRAIN_M,
        cap_n: CAP_N,
        bearing: 1.0,
        tip_radius_m: REFERENCE_RADIUS_M,
        buried: [None; MAX_BURIED],
    };

    /// Refuses what has no force.
    ///
    /// # Errors
    /// Names the first field out of its range.
    pub fn check(&self) -> Result<(), DesignError> {
        limits::STIFFNESS_N.check("stiffness_n", self.stiffness_n)?;
        limits::EXPONENT_PER_M.check("exponent_per_m", self.exponent_per_m)?;
        limits::DRAG_S_PER_M.check("drag_s_per_m", self.drag_s_per_m)?;
        limits::WETNESS.check("wetness", self.wetness)?;
        limits::GRAIN_M.check("grain_m", self.grain_m)?;
        limits::CAP_N.check("cap_n", self.cap_n)?;
        limits::BEARING.check("bearing", self.bearing)?;
        let mut above = 0.0;
        for layer in self.layers.iter().flatten() {
            let deeper = Range { low: above, ..limits::LAYER_FROM_M };
            above = deeper.check("layers.from_m", layer.from_m)?;
            limits::HARDNESS.check("layers.hardness", layer.hardness)?;
        }
        self.buried.iter().flatten().try_for_each(Buried::check)
    }

    /// Stiffness with wetness, under the tool.
    fn wet_stiffness_n(&self) -> f64 {
        self.stiffness_n * (1.0 + 2.0 * self.wetness) * self.bearing
    }

    /// Talus angle with wetness, degrees, at most 75.
    #[must_use]
    pub fn talus_deg(&self, dry_deg: f64) -> f64 {
        (dry_deg + 20.0 * self.wetness).min(75.0).max(dry_deg)
    }

    /// Repulse force at a depth, N; 0 above the surface.
    #[must_use]
    pub fn force_n(&self, depth_m: f64) -> f64 {
        // What is no number stands nowhere.
        if depth_m.is_nan() || depth_m <= 0.0 {
            return 0.0;
        }
        let (mut force, mut top, mut hardness) = (0.0, 0.0, 1.0);
        for layer in self.layers.iter().flatten() {
            if layer.from_m >= depth_m {
                break;
            }
            force += self.part_n(top, layer.from_m, hardness);
            (top, hardness) = (layer.from_m, layer.hardness);
        }
        (force + self.part_n(top, depth_m, hardness)).min(MOST_N)
    }

    /// Force that one layer adds between two depths.
    fn part_n(&self, top_m: f64, bottom_m: f64, hardness: f64) -> f64 {
        let k = self.exponent_per_m;
        hardness * self.wet_stiffness_n() * libm::exp(k * top_m) * libm::expm1(k * (bottom_m - top_m))
    }

    /// Depth at which the sand carries a force, metres; 0 for none.
    #[must_use]
    pub fn depth_m(&self, force_n: f64) -> f64 {
        if force_n <= 0.0 {
            return 0.0;
        }
        let (mut left, mut top, mut hardness) = (force_n, 0.0, 1.0);
        for layer in self.layers.iter().flatten() {
            let part = self.part_n(top, layer.from_m, hardness);
            if part >= left {
                break;
            }
            left -= part;
            (top, hardness) = (layer.from_m, layer.hardness);
        }
        let k = self.exponent_per_m;
        top + libm::log1p(left / (hardness * self.wet_stiffness_n() * libm::exp(k * top))) / k
    }

    /// Law under another tool, by its [bearing](super::Tool::bearing) and the [radius of its
    /// underside](super::Tool::tip_radius_m).
    #[must_use]
    pub fn under(self, bearing: f64, tip_radius_m: f64) -> Self {
        Self { bearing, tip_radius_m, ..self }
    }

    /// Obstacle that the tool meets below a place where the sand lies `above_m` over the untouched
    /// bed.
    #[must_use]
    pub fn met(&self, position_m: [f64; 2], above_m: f64) -> Option<Met> {
        first_met(&self.buried, position_m, above_m, self.tip_radius_m)
    }

    /// [`force_n`](Self::force_n) over what is met.
    #[must_use]
    pub fn force_over_n(&self, met: Option<&Met>, depth_m: f64) -> f64 {
        match met.filter(|met| depth_m > met.top_m) {
            Some(met) => {
                (self.force_n(met.top_m) + self.part_n(met.top_m, depth_m, met.hardness)).min(MOST_N)
            }
            None => self.force_n(depth_m),
        }
    }

    /// [`depth_m`](Self::depth_m) over what is met.
    #[must_use]
    pub fn depth_over_m(&self, met: Option<&Met>, force_n: f64) -> f64 {
        let Some(met) = met else { return self.depth_m(force_n) };
        let carried_by_it_n = force_n - self.force_n(met.top_m);
        if carried_by_it_n <= 0.0 {
            return self.depth_m(force_n);
        }
        let k = self.exponent_per_m;
        let stiff_n = met.hardness * self.wet_stiffness_n() * libm::exp(k * met.top_m);
        met.top_m + libm::log1p(carried_by_it_n / stiff_n) / k
    }

    /// Push aside on a tool that is carried with `force_n` by what is met, along u and v, for each
    /// newton.
    #[must_use]
    pub fn push_per_n(&self, met: Option<&Met>, force_n: f64) -> [f64; 2] {
        let Some(met) = met.filter(|_| force_n > 0.0) else { return [0.0; 2] };
        let share = (1.0 - self.force_n(met.top_m) / force_n).max(0.0);
        met.slope.map(|slope| share * slope)
    }

    /// [`answer_n`](Self::answer_n) at a place of the untouched bed: over its stones and shells
    /// too.
    #[must_use]
    pub fn answer_at_n(&self, position_m: [f64; 2], depth_m: f64, velocity_m_s: [f64; 2]) -> [f64; 3] {
        if !position_m.iter().all(|x| x.abs() <= FARTHEST_M) {
            return self.answer_n(depth_m, velocity_m_s);
        }
        let met = self.met(position_m, 0.0);
        let repulse_n = self.force_over_n(met.as_ref(), depth_m);
        let (drag, push) = (self.drag_n(velocity_m_s, repulse_n), self.push_per_n(met.as_ref(), repulse_n));
        let [u, v] = [0, 1].map(|a| drag[a] + repulse_n * push[a]);
        capped([u, v, repulse_n], self.cap_n)
    }

    /// The force on a tool that stands `depth_m` deep and moves, N along u, v and out of the sand:
    /// what the document's loop returns to the device.
    #[must_use]
    pub fn answer_n(&self, depth_m: f64, velocity_m_s: [f64; 2]) -> [f64; 3] {
        let repulse_n = self.force_n(depth_m);
        let [u, v] = self.drag_n(velocity_m_s, repulse_n);
        capped([u, v, repulse_n], self.cap_n)
    }

    /// Drag on a tool that the sand carries with `force_n`, N.
    #[must_use]
    pub fn drag_n(&self, velocity_m_s: [f64; 2], force_n: f64) -> [f64; 2] {
        let drag_n = |v: f64| -self.drag_s_per_m * v * force_n.abs();
        // What is no number is no movement; the fastest is far beyond what a cap leaves.
        velocity_m_s.map(|v| if v.is_nan() { 0.0 } else { drag_n(v.clamp(-FASTEST_M_S, FASTEST_M_S)) })
    }

    /// Impacts among grains: their rate (1/s) and mean momentum (N·s), when a tool displaces
    /// `displaced_m2` m³ of sand a metre of its way.
    #[must_use]
    pub fn grains(&self, displaced_m2: f64, speed_m_s: f64) -> (f64, f64) {
        let volume_m3 = core::f64::consts::PI / 6.0 * self.grain_m.powi(3);
        let rate = STRIKING_SHARE * displaced_m2 * speed_m_s / volume_m3;
        (rate, GRAIN_DENSITY_KG_M3 * volume_m3 * speed_m_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documents_constants_give_3_005_and_5_013_n() {
        let law = SandLaw { exponent_per_m: 0.5, ..SandLaw::default() };
        assert!((law.force_n(0.006) - 3.005).abs() < 5e-4);
        assert!((law.force_n(0.01) - 5.013).abs() < 5e-4);
        // In metres, one unit being 0.5 m.
        assert!((SandLaw::default().force_n(0.003) - 3.005).abs() < 5e-4);
        assert!((SandLaw::default().force_n(0.005) - 5.013).abs() < 5e-4);
    }

    #[test]
    fn force_is_continuous_at_layers_and_depth_inverts_it() {
        let mut law = SandLaw { exponent_per_m: 30.0, wetness: 0.3, ..SandLaw::default() };
        law.layers[0] = Some(Layer { from_m: 0.002, hardness: 4.0 });
        law.layers[1] = Some(Layer { from_m: 0.005, hardness: 0.5 });
        law.check().unwrap();
        assert_eq!((law.force_n(0.0), law.force_n(-1.0), law.depth_m(0.0)), (0.0, 0.0, 0.0));
        assert!(law.force_n(1e-12) < 1e-6);
        for edge in [0.002, 0.005] {
            assert!((law.force_n(edge + 1e-12) - law.force_n(edge - 1e-12)).abs() < 1e-6);
        }
        let mut last = 0.0;
        for n in 1..200 {
            let depth = 1e-4 * f64::from(n);
            let force = law.force_n(depth);
            assert!(force > last && (law.depth_m(force) - depth).abs() < 1e-12);
            last = force;
        }
        // Twice as steep just inside a layer of twice the hardness.
        let slope = |d: f64| (law.force_n(d + 1e-7) - law.force_n(d - 1e-7)) / 2e-7;
        assert!((slope(0.002 + 1e-6) / slope(0.002 - 1e-6) - 4.0).abs() < 0.01);
    }

    #[test]
    fn over_a_stone_force_is_continuous_and_its_flank_pushes_outwards() {
        let stone =
            Buried { at_m: [0.05; 2], top_m: 0.002, half_m: [0.008; 2], height_m: 0.004, hardness: 30.0 };
        let law = SandLaw {
            buried: [Some(stone); 8],
            stiffness_n: 100.0,
            exponent_per_m: 20.0,
            ..SandLaw::default()
        };
        law.check().unwrap();
        let at = [0.053, 0.049];
        let met = law.met(at, 0.0);
        let top_m = met.unwrap().top_m;
        let force_n = |depth_m: f64| law.force_over_n(met.as_ref(), depth_m);
        assert!((force_n(top_m + 1e-12) - force_n(top_m - 1e-12)).abs() < 1e-5);
        let slope = |d: f64| (force_n(d + 1e-7) - force_n(d - 1e-7)) / 2e-7;
        assert!((slope(top_m + 1e-6) / slope(top_m - 1e-6) / 30.0 - 1.0).abs() < 1e-2);
        for step in 1..100 {
            let depth_m = 1e-4 * f64::from(step);
            assert!((law.depth_over_m(met.as_ref(), force_n(depth_m)) - depth_m).abs() < 1e-12);
        }
        let [u, v, z] = law.answer_at_n(at, top_m + 5e-5, [0.0; 2]);
        let carried_by_it_n = z - law.force_n(top_m);
        assert!(u > 0.0 && v < 0.0 && carried_by_it_n > 1.0);
        assert!((u / carried_by_it_n - met.unwrap().slope[0]).abs() < 1e-12);
        // Beside it, and above it, there is sand.
        assert_eq!(law.answer_at_n([0.2, 0.2], 0.003, [0.1, 0.0]), law.answer_n(0.003, [0.1, 0.0]));
        assert_eq!(law.answer_at_n(at, 0.5 * top_m, [0.1, 0.0]), law.answer_n(0.5 * top_m, [0.1, 0.0]));
        let refused = SandLaw { buried: [Some(Buried { hardness: 0.0, ..stone }); 8], ..law }.check();
        assert_eq!(refused.unwrap_err().field, "buried.hardness");
    }

    #[test]
    fn drag_opposes_motion_and_grows_with_both_speed_and_force() {
        assert_eq!(SandLaw::default().drag_n([0.1, -0.05], 0.5), [-1.0, 0.5]);
    }

    #[test]
    fn wet_sand_is_stiffer_and_steeper() {
        let wet = SandLaw { wetness: 1.0, ..SandLaw::default() };
        assert!((wet.force_n(0.003) / SandLaw::default().force_n(0.003) - 3.0).abs() < 1e-12);
        assert_eq!((wet.talus_deg(30.0), SandLaw::default().talus_deg(30.0)), (50.0, 30.0));
    }

    #[test]
    fn grains_carry_the_momentum_of_the_displaced_share() {
        let (rate, impulse) = SandLaw::default().grains(1e-6, 0.1);
        assert!((rate * impulse - STRIKING_SHARE * 1e-6 * 0.1 * GRAIN_DENSITY_KG_M3 * 0.1).abs() < 1e-15);
    }
}
