//! Solid noise: a surface cut out of a block of three-dimensional noise.
//!
//! ```text
//! n_p(x) = Σ_modules M · Σ_{i=0}^{N−1} per^i · n_i(x · f · lac^i)                 n: [`NoiseKind`]
//! height:  h = A · n_p(T · x)                                            metres
//! force:   F_tex = L · n_p(T · x), no more than the cap, in penetration;  F = F_contact + F_friction + F_tex − b v     [`force`]
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | M, N, f, lac, per | the fields of [`NoiseModule`] |
//! | T | [`SolidNoiseParameters::texture_factor_per_m`]: the document's unit of length is 1/T |
//! | A | [`SolidNoiseParameters::amplitude_m`], metres per unit of magnitude (ours: the document has forces only) |
//! | L, cap | [`SolidNoiseParameters::limit_n`], newton per unit of magnitude, and [`SolidNoiseParameters::cap_n`] |
//! | b | [`SolidNoiseParameters::viscosity_n_s_m`], the "viscous cube" around the pebbles |
//! | x | [`SolidCut`]: where the surface cuts the block, or the place in the body that a contact reports; less the way that the block has
//! [flowed](SolidNoiseParameters::flow_m_s), as the document's water and wind do |
//!
//! Source: the solid-noise paper, equations 3 and 4 and Table 1. What we read differently: the
//! printed sum has one octave more than the table counts (N octaves are N terms), and the printed
//! argument p · (1/lac)^i is a period, so the frequency is f · lac^i. What we changed: octaves fade
//! out where the contact's footprint no longer resolves them; the block is cut at a slant, because
//! a cut along the lattice meets a zero of the noise at every cell border, which sounds as a tone;
//! parameters change by a fade ([`crate::fade`]).

mod cut;
mod force;
mod kind;
mod parameters;

pub use cut::SolidCut;
pub use kind::NoiseKind;
pub use parameters::{ForceDirection, MAX_OCTAVES, NoiseModule, SolidNoiseParameters};

use crate::fade::Fade;
use crate::height_field::{
    Extension, HeightField, MAX_BLOCK, PathBlock, Properties, Reaction, Setup, SurfaceBlock, Touch,
};
use asperity_dsp::DesignError;
use asperity_dsp::gradient_noise_3d::{GradientNoise3d, Noise3Batch};
use std::any::Any;

/// Footprint over cell size up to which an octave is whole: 0.66 cycles per cell, below which 90 %
/// of its energy lies, then stay under 0.26 of the sample rate.
const FOOTPRINT_WHOLE: f64 = 0.4;
/// Footprint over cell size from which an octave is silent: 0.66 cycles per cell reach the Nyquist
/// frequency.
const FOOTPRINT_SILENT: f64 = 0.75;

/// Coordinates of a block of points in the noise, and the noise there.
struct Scratch {
    point_m: [[f64; 3]; MAX_BLOCK],
    /// n_p, in units of magnitude.
    texture: [f64; MAX_BLOCK],
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
    /// Length of a sample, s.
    step_s: f64,
}

impl SolidNoise {
    /// A surface cut at a slant.
    ///
    /// ```
    /// use asperity_surface::{solid_materials::SolidMaterial, solid_noise::SolidNoise};
    ///
    /// let granite = SolidMaterial::from_name("granite").ok_or("is one of the seven")?.parameters();
    /// let (block, same) = (SolidNoise::new(granite, 7)?, SolidNoise::new(granite, 7)?);
    /// let here_m = [0.01, 0.02, 0.0];
    /// assert_eq!(block.definition(&granite, here_m), same.definition(&granite, here_m));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
            step_s: 1.0 / Setup::default().sample_rate_hz,
        })
    }

    /// Block of the same noise, cut elsewhere.
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
    pub fn set_parameters(
        &mut self,
        parameters: SolidNoiseParameters,
        sample: u64,
    ) -> Result<(), DesignError> {
        parameters.check()?;
        self.parameters.set(parameters, sample);
        Ok(())
    }

    /// The lattice of an octave of a module (0 or 1).
    #[must_use]
    pub fn lattice(&self, module: usize, octave: usize) -> &GradientNoise3d {
        &self.lattices[module.min(1)][octave.min(MAX_OCTAVES - 1)]
    }

    /// n_p(T x) at a point of the block, without gradient or footprint, in units of magnitude: the
    /// definition, for oracles and tools.
    #[must_use]
    pub fn definition(&self, parameters: &SolidNoiseParameters, point_m: [f64; 3]) -> f64 {
        let mut sum = 0.0;
        for (module, lattices) in parameters.modules.iter().zip(&self.lattices) {
            for (index, lattice) in lattices.iter().enumerate().take(module.octaves) {
                let (per_m, amplitude) = parameters.octave(module, index);
                sum += amplitude * f64::from(module.kind.at(lattice, point_m.map(|x| x * per_m)).value);
            }
        }
        sum
    }

    /// Distance that the block has flowed past the surface, metres in the block.
    fn flown_m(&self, parameters: &SolidNoiseParameters, sample: u64) -> [f64; 3] {
        let [u, v, out] = parameters.flow_m_s.map(|speed| speed * (sample as f64 * self.step_s));
        let (u_axis, v_axis, normal) = (self.cut.u_axis, self.cut.v_axis, self.cut.normal());
        core::array::from_fn(|a| u * u_axis[a] + v * v_axis[a] + out * normal[a])
    }

    /// Adds one parameter set's heights, slopes and forces, each sample weighted.
    fn add(
        &self,
        parameters: &SolidNoiseParameters,
        path: &PathBlock<'_>,
        weight: &[f64; MAX_BLOCK],
        scratch: &mut Scratch,
        out: &mut SurfaceBlock,
    ) {
        self.place(parameters, path, &mut scratch.point_m);
        scratch.texture = [0.0; MAX_BLOCK];
        for (module, lattices) in parameters.modules.iter().zip(&self.lattices) {
            if module.magnitude == 0.0 {
                continue;
            }
            for (index, lattice) in lattices.iter().enumerate().take(module.octaves) {
                let (per_m, amplitude) = parameters.octave(module, index);
                if path.footprint_m.iter().any(|&p| resolved(p * per_m) != 0.0) {
                    self.octave(module.kind, lattice, per_m, path.len(), scratch);
                }
                let mean = module.kind.mean();
                if mean != 0.0 || path.footprint_m.iter().any(|&p| resolved(p * per_m) != 0.0) {
                    self.add_octave(parameters, path, [per_m, amplitude, mean], weight, scratch, out);
                }
            }
        }
        if path.slopes {
            Self::answer(parameters, path, weight, &scratch.texture, out);
        }
    }

    /// Points of the block along a path.
    fn place(
        &self,
        parameters: &SolidNoiseParameters,
        path: &PathBlock<'_>,
        point_m: &mut [[f64; 3]; MAX_BLOCK],
    ) {
        let flows = parameters.flow_m_s != [0.0; 3];
        for (i, point_m) in point_m.iter_mut().enumerate().take(path.len()) {
            *point_m = match path.at_m.get(i) {
                Some(at_m) => SolidCut::in_body(*at_m),
                None => self.cut.at(path.position_m[i]),
            };
            if flows {
                let flown_m = self.flown_m(parameters, path.first_sample + i as u64);
                *point_m = core::array::from_fn(|a| point_m[a] - flown_m[a]);
            }
        }
    }

    /// Adds what one octave gives.
    fn add_octave(
        &self,
        parameters: &SolidNoiseParameters,
        path: &PathBlock<'_>,
        [per_m, amplitude, mean]: [f64; 3],
        weight: &[f64; MAX_BLOCK],
        scratch: &mut Scratch,
        out: &mut SurfaceBlock,
    ) {
        let [du, dv] = [self.cut.u_axis, self.cut.v_axis];
        for i in 0..path.len().min(MAX_BLOCK) {
            let share = amplitude * resolved(path.footprint_m[i] * per_m);
            let left = (amplitude - share) * mean;
            scratch.texture[i] += share * f64::from(scratch.value[i]) + left;
            out.height_m[i] += weight[i] * parameters.amplitude_m * left;
            let height = weight[i] * parameters.amplitude_m * share;
            if height != 0.0 {
                out.height_m[i] += height * f64::from(scratch.value[i]);
                let slope = scratch.slope.each_ref().map(|s| f64::from(s[i]));
                let along =
                    |axis: [f64; 3]| per_m * (slope[0] * axis[0] + slope[1] * axis[1] + slope[2] * axis[2]);
                out.gradient[i][0] += height * along(du);
                out.gradient[i][1] += height * along(dv);
            }
        }
    }

    /// Evaluates one lattice at the points.
    fn octave(
        &self,
        kind: NoiseKind,
        lattice: &GradientNoise3d,
        per_m: f64,
        n: usize,
        scratch: &mut Scratch,
    ) {
        let n = n.min(MAX_BLOCK);
        if kind == NoiseKind::Voronoi {
            for i in 0..n {
                let noise = kind.at(lattice, scratch.point_m[i].map(|p| p * per_m));
                scratch.value[i] = noise.value;
                scratch.slope.iter_mut().zip(noise.gradient).for_each(|(slope, part)| slope[i] = part);
            }
            return;
        }
        let [x, y, z] = &mut scratch.cells;
        for (i, point_m) in scratch.point_m.iter().enumerate().take(n) {
            [x[i], y[i], z[i]] = point_m.map(|p| p * per_m);
        }
        let [dx, dy, dz] = &mut scratch.slope;
        let mut batch = Noise3Batch {
            value: &mut scratch.value[..n],
            dx: &mut dx[..n],
            dy: &mut dy[..n],
            dz: &mut dz[..n],
        };
        lattice.batch(&x[..n], &y[..n], &z[..n], &mut batch);
        if kind != NoiseKind::Gradient {
            for i in 0..n {
                let (value, slope) = kind.curve(scratch.value[i]);
                scratch.value[i] = value;
                scratch.slope.iter_mut().for_each(|part| part[i] *= slope);
            }
        }
    }
}

/// Share of an octave that is left at a footprint given in its cells.
#[inline]
fn resolved(footprint_cells: f64) -> f64 {
    let t = (FOOTPRINT_SILENT - footprint_cells) / (FOOTPRINT_SILENT - FOOTPRINT_WHOLE);
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

impl HeightField for SolidNoise {
    fn prepare(&mut self, setup: &Setup<'_>) -> Result<(), DesignError> {
        self.parameters.prepare(setup.sample_rate_hz);
        self.step_s = 1.0 / setup.sample_rate_hz;
        Ok(())
    }

    fn properties(&self, _tile_m: [f64; 2]) -> Properties {
        let target = self.parameters.target();
        Properties { reach_m: target.reach_m(), extension: Extension::Fresh, ..Properties::of(target.band()) }
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let n = path.len().min(MAX_BLOCK);
        out.clear(n);
        let mut scratch = Scratch {
            point_m: [[0.0; 3]; MAX_BLOCK],
            texture: [0.0; MAX_BLOCK],
            cells: [[0.0; MAX_BLOCK]; 3],
            value: [0.0; MAX_BLOCK],
            slope: [[0.0; MAX_BLOCK]; 3],
        };
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
        if path.slopes {
            out.clear_gradient_force(n);
        }
    }

    /// Movement that a resting finger feels of what flows.
    fn touch(&mut self, _touch: &Touch) -> Reaction {
        Reaction {
            wakes_contact: self.parameters.values().iter().any(|p| p.flow_m_s != [0.0; 3]),
            ..Reaction::default()
        }
    }

    /// Takes [`SolidNoiseParameters`].
    fn set(&mut self, change: &dyn Any, sample: u64) -> bool {
        let parameters = change.downcast_ref::<SolidNoiseParameters>();
        parameters.is_some_and(|parameters| self.set_parameters(*parameters, sample).is_ok())
    }
}
