//! Kind of a noise function: what an octave is made of.
//!
//! ```text
//! gradient n      ridged (1 − |n|)²      billow 2 |n| − 1      turbulence |n|      Voronoi |x − nearest point|
//! ```
//! n is gradient noise, x the place in cells, with one point a cell at a random place in it.
//! Source: the noise paper names libnoise's modules as its next step; turbulence as Perlin (1985),
//! the sum of |noise| over octaves, Voronoi as Worley (1996), its first distance. Left out of
//! libnoise's ridged noise: the weight by which an octave fades where the one before it is low.
//! An octave that is not resolved leaves its mean, so that heights do not depend on speed.

use asperity_dsp::gradient_noise_3d::{GradientNoise3d, Noise3};
use asperity_dsp::rng::hash_u32;

/// Kind of a noise function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseKind {
    /// Gradient noise itself.
    Gradient,
    /// Sharp crests.
    Ridged,
    /// Round heaps between sharp valleys.
    Billow,
    /// Billow from its valleys up.
    Turbulence,
    /// Cells: cones around scattered points.
    Voronoi,
}

/// Odd multipliers of the three cell numbers.
pub(super) const PRIMES: [u32; 3] = [0x9E37_79B1, 0x85EB_CA77, 0xC2B2_AE3D];

impl NoiseKind {
    /// Value and slope (per cell) of one octave at a place in cells.
    #[must_use]
    pub fn at(self, lattice: &GradientNoise3d, cells: [f64; 3]) -> Noise3 {
        match self {
            Self::Gradient => lattice.at(cells),
            Self::Voronoi => nearest(lattice.seed(), cells),
            _ => {
                let noise = lattice.at(cells);
                let (value, slope) = self.curve(noise.value);
                Noise3 { value, gradient: noise.gradient.map(|part| slope * part) }
            }
        }
    }

    /// The value made of gradient noise, and its derivative by it.
    #[inline]
    pub(super) fn curve(self, noise: f32) -> (f32, f32) {
        let (size, sign) = (noise.abs(), 1f32.copysign(noise));
        match self {
            Self::Gradient | Self::Voronoi => (noise, 1.0),
            Self::Ridged => ((1.0 - size) * (1.0 - size), 2.0 * sign * (size - 1.0)),
            Self::Billow => (2.0 * size - 1.0, 2.0 * sign),
            Self::Turbulence => (size, sign),
        }
    }

    /// Mean value.
    pub(super) fn mean(self) -> f64 {
        match self {
            Self::Gradient => 0.0,
            Self::Ridged => 0.64,
            Self::Billow => -0.566,
            Self::Turbulence => 0.217,
            Self::Voronoi => 0.53,
        }
    }

    /// Largest distance of a value from zero.
    pub(super) fn reach(self) -> f64 {
        if self == Self::Voronoi { 3f64.sqrt() } else { 1.0 }
    }
}

/// Distance to the nearest point, in cells: that of the own cell is no further than √3.
fn nearest(seed: u32, cells: [f64; 3]) -> Noise3 {
    const NEAR_FIRST: [i32; 5] = [0, -1, 1, -2, 2];
    let whole = cells.map(f64::floor);
    let part: [f32; 3] = core::array::from_fn(|axis| (cells[axis] - whole[axis]) as f32);
    // Squared distance along an axis to a cell so many steps away.
    let gap = |axis: usize, step: i32| {
        let (low, t) = (step as f32, part[axis]);
        let away = (low - t).max(t - low - 1.0).max(0.0);
        away * away
    };
    let (mut best, mut towards) = (f32::INFINITY, [0f32; 3]);
    for z in NEAR_FIRST {
        for y in NEAR_FIRST {
            let beside = gap(2, z) + gap(1, y);
            if beside >= best {
                continue;
            }
            for x in NEAR_FIRST {
                if beside + gap(0, x) >= best {
                    continue;
                }
                let steps = [x, y, z];
                let at = core::array::from_fn(|axis| (whole[axis] as i64 as i32).wrapping_add(steps[axis]));
                let point = point(seed, at);
                let from: [f32; 3] =
                    core::array::from_fn(|axis| part[axis] - (steps[axis] as f32 + point[axis]));
                let distance2 = from[0] * from[0] + from[1] * from[1] + from[2] * from[2];
                if distance2 < best {
                    (best, towards) = (distance2, from);
                }
            }
        }
    }
    let value = best.sqrt();
    Noise3 { value, gradient: towards.map(|part| if value > 0.0 { part / value } else { 0.0 }) }
}

/// The point of a cell, 0–1 along each axis.
fn point(seed: u32, cell: [i32; 3]) -> [f32; 3] {
    let mix = |axis: usize| (cell[axis] as u32).wrapping_mul(PRIMES[axis]);
    let first = hash_u32(mix(0) ^ mix(1) ^ mix(2) ^ seed);
    let second = hash_u32(first);
    [first, second, hash_u32(second)].map(|bits| (bits >> 8) as f32 / (1 << 24) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    const KINDS: [NoiseKind; 5] = [
        NoiseKind::Gradient,
        NoiseKind::Ridged,
        NoiseKind::Billow,
        NoiseKind::Turbulence,
        NoiseKind::Voronoi,
    ];

    #[test]
    fn slopes_are_those_of_the_values() {
        let lattice = GradientNoise3d::new(3);
        let mut rng = Rng::new(9);
        for kind in KINDS {
            let (mut sum, mut rough) = (0.0, 0);
            for _ in 0..40_000 {
                let place = [0; 3].map(|_| 40.0 * rng.uniform() - 20.0);
                let noise = kind.at(&lattice, place);
                sum += f64::from(noise.value);
                let step = 1e-3;
                for axis in 0..3 {
                    let moved = |by: f64| {
                        let mut to = place;
                        to[axis] += by;
                        f64::from(kind.at(&lattice, to).value)
                    };
                    let slope = (moved(step) - moved(-step)) / (2.0 * step);
                    rough += usize::from((slope - f64::from(noise.gradient[axis])).abs() > 0.01);
                }
            }
            let mean = sum / 40_000.0;
            assert!((mean - kind.mean()).abs() < 0.01, "{kind:?}: {mean}");
            // Where a crease lies between the two places the difference is no slope.
            assert!(rough < 1_200, "{kind:?}: {rough}");
        }
    }

    #[test]
    fn the_nearest_point_is_that_of_a_wide_search() {
        let lattice = GradientNoise3d::new(5);
        let mut rng = Rng::new(2);
        for _ in 0..3_000 {
            let place = [0; 3].map(|_| 200.0 * rng.uniform() - 100.0);
            let cell = place.map(|x: f64| x.floor() as i32);
            let mut least = f64::INFINITY;
            for n in 0..343 {
                let at: [i32; 3] =
                    core::array::from_fn(|axis| cell[axis] + n / 7_i32.pow(axis as u32) % 7 - 3);
                let point = point(lattice.seed(), at);
                let away = (0..3).map(|a| (place[a] - f64::from(at[a]) - f64::from(point[a])).powi(2));
                least = least.min(away.sum::<f64>().sqrt());
            }
            let found = f64::from(NoiseKind::Voronoi.at(&lattice, place).value);
            assert!((found - least).abs() < 1e-5, "{place:?}: {found} {least}");
        }
    }
}
