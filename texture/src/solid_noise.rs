//! Solid noise: a surface cut out of a block of three-dimensional noise.
//!
//! ```text
//! n_p(x) = Σ_modules M · Σ_{i=0}^{N−1} per^i · n_i(x · f · lac^i)
//! height:  h = A · n_p(T · x)                                            metres
//! force:   F_tex = L · n_p(T · x), no more than the cap;    F = F_contact + F_friction + F_tex − b v
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | M, N, f, lac, per | the fields of [`NoiseModule`] |
//! | T | [`SolidNoiseParameters::texture_factor_per_m`]: the document's unit of length is 1/T |
//! | A | [`SolidNoiseParameters::amplitude_m`], metres per unit of magnitude (ours: the document has forces only) |
//! | L, cap | [`SolidNoiseParameters::limit_n`], newton per unit of magnitude, and [`SolidNoiseParameters::cap_n`] |
//! | b | [`SolidNoiseParameters::viscosity_n_s_m`], the "viscous cube" around the pebbles |
//! | x | [`SolidCut`]: where the surface cuts the block |
//!
//! Source: the solid-noise paper, equations 3 and 4 and Table 1. What we read differently: the printed
//! sum has one octave more than the table counts (N octaves are N terms), and the printed argument
//! p · (1/lac)^i is a period, so the frequency is f · lac^i. What we changed: octaves fade out where
//! the contact's footprint no longer resolves them; the block is cut at a slant, because a cut along
//! the lattice meets a zero of the noise at every cell border, which sounds as a tone; parameters
//! change by a fade ([`crate::fade`]).

mod cut;
mod parameters;

pub use cut::SolidCut;
pub use parameters::{ForceDirection, MAX_OCTAVES, NoiseModule, SolidNoiseParameters};

use crate::fade::Fade;
use crate::height_field::{
    Beyond, HeightField, MAX_BLOCK, PathBlock, Reaction, Setup, SurfaceBlock, Touch, WavelengthBand,
};
use asperity_dsp::DesignError;
use asperity_dsp::gradient_noise_3d::{GradientNoise3d, Noise3Batch};
use std::any::Any;

/// Footprint over cell size up to which an octave is whole: 0.66 cycles per cell, below which 90 % of
/// its energy lies, then stay under 0.26 of the sample rate.
const FOOTPRINT_WHOLE: f64 = 0.4;
/// Footprint over cell size from which an octave is silent: 0.66 cycles per cell reach the Nyquist
/// frequency.
const FOOTPRINT_SILENT: f64 = 0.75;
/// Period of the force output that [`HeightField::react`] serves, seconds; the document's 1 kHz.
const FORCE_PERIOD_S: f64 = 1e-3;

/// Coordinates of a block of points in the noise, and the noise there.
struct Scratch {
    cells: [[f64; MAX_BLOCK]; 3],
    value: [f32; MAX_BLOCK],
    slope: [[f32; MAX_BLOCK]; 3],
}

/// A solid-noise surface.
#[derive(Debug, Clone)]
pub struct SolidNoise {
    parameters: Fade<SolidNoiseParameters>,
    lattices: [[GradientNoise3d; MAX_OCTAVES]; 2],
    cut: SolidCut,
}

impl SolidNoise {
    /// A surface cut at a slant.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn new(parameters: SolidNoiseParameters, seed: u64) -> Result<Self, DesignError> {
        parameters.check()?;
        let lattice = |module: u64, octave: usize| {
            GradientNoise3d::new(seed.wrapping_add(module << 32).wrapping_add(octave as u64))
        };
        Ok(Self {
            parameters: Fade::new(parameters),
            lattices: [core::array::from_fn(|i| lattice(0, i)), core::array::from_fn(|i| lattice(1, i))],
            cut: SolidCut::SLANTED,
        })
    }

    /// The same block of noise, cut elsewhere.
    #[must_use]
    pub fn with_cut(self, cut: SolidCut) -> Self {
        Self { cut, ..self }
    }

    /// The parameters asked for last.
    #[must_use]
    pub fn parameters(&self) -> SolidNoiseParameters {
        self.parameters.target()
    }

    /// Begins to change all parameters at an absolute sample.
    ///
    /// # Errors
    /// When a parameter is out of its range; nothing changes then.
    pub fn set(&mut self, parameters: SolidNoiseParameters, sample: u64) -> Result<(), DesignError> {
        parameters.check()?;
        self.parameters.set(parameters, sample);
        Ok(())
    }

    /// n_p(T x) at a point of the block, without gradient or footprint, in units of magnitude: the
    /// definition, for oracles and tools.
    #[must_use]
    pub fn definition(&self, parameters: &SolidNoiseParameters, point_m: [f64; 3]) -> f64 {
        let mut sum = 0.0;
        for (module, lattices) in parameters.modules.iter().zip(&self.lattices) {
            for (index, lattice) in lattices.iter().enumerate().take(module.octaves) {
                let (per_m, amplitude) = parameters.octave(module, index);
                sum += amplitude * f64::from(lattice.at(point_m.map(|x| x * per_m)).value);
            }
        }
        sum
    }

    /// Force of the texture and the medium on a tool at `position_m`: along u, v and out of the
    /// surface, newtons. `footprint_m` is the distance between two readings.
    #[must_use]
    pub fn force_n(
        &self,
        position_m: [f64; 2],
        velocity_m_s: [f64; 2],
        normal_force_n: f64,
        footprint_m: f64,
        sample: u64,
    ) -> [f64; 3] {
        let mut force = [0.0; 3];
        for (weight, parameters) in self.parameters.weights(sample).iter().zip(self.parameters.values()) {
            if *weight != 0.0 {
                let one = self.force_of(parameters, position_m, velocity_m_s, normal_force_n, footprint_m);
                for (sum, one) in force.iter_mut().zip(one) {
                    *sum += weight * one;
                }
            }
        }
        force
    }

    fn force_of(
        &self,
        parameters: &SolidNoiseParameters,
        position_m: [f64; 2],
        velocity_m_s: [f64; 2],
        normal_force_n: f64,
        footprint_m: f64,
    ) -> [f64; 3] {
        let point = self.cut.at(position_m);
        let mut texture = 0.0;
        for (module, lattices) in parameters.modules.iter().zip(&self.lattices) {
            for (index, lattice) in lattices.iter().enumerate().take(module.octaves) {
                let (per_m, amplitude) = parameters.octave(module, index);
                let whole = resolved(footprint_m * per_m);
                if amplitude * whole != 0.0 {
                    texture += amplitude * whole * f64::from(lattice.at(point.map(|x| x * per_m)).value);
                }
            }
        }
        let proportion = if parameters.proportional_to_contact { normal_force_n.max(0.0) } else { 1.0 };
        let cap = parameters.cap_n;
        let texture = (parameters.limit_n * texture * proportion).clamp(-cap, cap);
        let speed = velocity_m_s[0].hypot(velocity_m_s[1]);
        let direction = match parameters.direction {
            ForceDirection::X => [1.0, 0.0, 0.0],
            ForceDirection::Normal => [0.0, 0.0, 1.0],
            ForceDirection::Tangent if speed > 0.0 => [velocity_m_s[0] / speed, velocity_m_s[1] / speed, 0.0],
            ForceDirection::Tangent => [0.0; 3],
        };
        let drag = parameters.viscosity_n_s_m;
        [
            texture * direction[0] - drag * velocity_m_s[0],
            texture * direction[1] - drag * velocity_m_s[1],
            texture * direction[2],
        ]
    }

    /// Adds one parameter set's heights and slopes, each sample weighted.
    fn add(
        &self,
        parameters: &SolidNoiseParameters,
        path: &PathBlock<'_>,
        weight: &[f64; MAX_BLOCK],
        scratch: &mut Scratch,
        out: &mut SurfaceBlock,
    ) {
        let n = path.len().min(MAX_BLOCK);
        for (module, lattices) in parameters.modules.iter().zip(&self.lattices) {
            if module.magnitude == 0.0 {
                continue;
            }
            for (index, lattice) in lattices.iter().enumerate().take(module.octaves) {
                let (per_m, amplitude) = parameters.octave(module, index);
                if path.footprint_m.iter().all(|&p| resolved(p * per_m) == 0.0) {
                    continue;
                }
                self.octave(lattice, per_m, path, n, scratch);
                let [du, dv] = [self.cut.u_axis, self.cut.v_axis];
                for i in 0..n {
                    let height = weight[i]
                        * parameters.amplitude_m
                        * amplitude
                        * resolved(path.footprint_m[i] * per_m);
                    if height != 0.0 {
                        let slope = scratch.slope.each_ref().map(|s| f64::from(s[i]));
                        let along = |axis: [f64; 3]| {
                            per_m * (slope[0] * axis[0] + slope[1] * axis[1] + slope[2] * axis[2])
                        };
                        out.height_m[i] += height * f64::from(scratch.value[i]);
                        out.gradient[i][0] += height * along(du);
                        out.gradient[i][1] += height * along(dv);
                    }
                }
            }
        }
    }

    /// Evaluates one lattice along the path.
    fn octave(
        &self,
        lattice: &GradientNoise3d,
        per_m: f64,
        path: &PathBlock<'_>,
        n: usize,
        scratch: &mut Scratch,
    ) {
        let [x, y, z] = &mut scratch.cells;
        for (i, &position) in path.position_m.iter().enumerate().take(n) {
            [x[i], y[i], z[i]] = self.cut.at(position).map(|p| p * per_m);
        }
        let [dx, dy, dz] = &mut scratch.slope;
        let mut batch = Noise3Batch {
            value: &mut scratch.value[..n],
            dx: &mut dx[..n],
            dy: &mut dy[..n],
            dz: &mut dz[..n],
        };
        lattice.batch(&x[..n], &y[..n], &z[..n], &mut batch);
    }
}

/// How much of an octave is left at a footprint given in its cells.
#[inline]
fn resolved(footprint_cells: f64) -> f64 {
    let t = (FOOTPRINT_SILENT - footprint_cells) / (FOOTPRINT_SILENT - FOOTPRINT_WHOLE);
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

impl HeightField for SolidNoise {
    fn prepare(&mut self, setup: &Setup) -> Result<(), DesignError> {
        self.parameters.prepare(setup.sample_rate_hz);
        Ok(())
    }

    fn band(&self) -> WavelengthBand {
        self.parameters.target().band()
    }

    fn reach_m(&self) -> f64 {
        self.parameters.target().reach_m()
    }

    fn beyond(&self, _tile_m: [f64; 2]) -> Beyond {
        Beyond::Fresh
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let n = path.len().min(MAX_BLOCK);
        out.clear(n);
        let mut scratch =
            Scratch { cells: [[0.0; MAX_BLOCK]; 3], value: [0.0; MAX_BLOCK], slope: [[0.0; MAX_BLOCK]; 3] };
        let weights: [[f64; 3]; MAX_BLOCK] = core::array::from_fn(|i| {
            if i < n { self.parameters.weights(path.first_sample + i as u64) } else { [0.0; 3] }
        });
        for (which, parameters) in self.parameters.values().iter().enumerate() {
            let weight: [f64; MAX_BLOCK] = core::array::from_fn(|i| weights[i][which]);
            if weight.iter().any(|&w| w != 0.0) {
                self.add(parameters, path, &weight, &mut scratch, out);
                for (friction, w) in out.friction.iter_mut().zip(&weight) {
                    *friction += w * parameters.friction;
                }
            }
        }
    }

    fn react(&mut self, touch: &Touch) -> Reaction {
        let footprint_m = touch.velocity_m_s[0].hypot(touch.velocity_m_s[1]) * FORCE_PERIOD_S;
        let force_n = self.force_n(
            touch.position_m,
            touch.velocity_m_s,
            touch.normal_force_n,
            footprint_m,
            touch.sample,
        );
        Reaction { force_n, ..Reaction::default() }
    }

    /// Takes [`SolidNoiseParameters`].
    fn change(&mut self, change: &dyn Any, sample: u64) -> bool {
        let parameters = change.downcast_ref::<SolidNoiseParameters>();
        parameters.is_some_and(|parameters| self.set(*parameters, sample).is_ok())
    }
}
