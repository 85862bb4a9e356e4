//! Sources made of a scene file's words: heights that the engine samples.

use super::pixels;
use crate::files::FileError;
#[cfg(feature = "brownian")]
use crate::files::scene_file::BrownianForce as ForceEntry;
use crate::files::scene_file::{
    Brownian, Direction, Lattice as LatticeEntry, MakeSource, Sand, SolidNoise as SolidEntry, Source,
    Tool as ToolEntry,
};
#[cfg(feature = "brownian")]
use asperity_texture::brownian::BrownianDesign;
#[cfg(feature = "brownian")]
use asperity_texture::brownian::rendering::{BrownianForce, BrownianPath, BrownianSurface, Rendering};
use asperity_texture::combine::{Crossfade, CrossfadeTo, Mask, Scale, Sum};
use asperity_texture::height_field::{HeightField, MAX_BLOCK, PathBlock, SurfaceBlock};
use asperity_texture::height_map::Extent;
use asperity_texture::height_map::HeightMap;
use asperity_texture::lattice::Lattice;
use asperity_texture::raster::Raster;
use asperity_texture::sand::{Layer, SandDesign, SandLaw, SandSource, SandWorker, Tool};
use asperity_texture::solid_materials::SolidMaterial;
use asperity_texture::solid_noise::{ForceDirection, SolidNoise};
use asperity_texture::wrap::Wrap;
use std::cell::RefCell;

/// Points of a graph unless told otherwise.
#[cfg(feature = "brownian")]
const GRAPH_POINTS: usize = 1 << 14;

type Boxed = Box<dyn HeightField>;

/// What every source of a surface shares.
#[derive(Clone, Copy)]
pub(super) struct Ground<'a> {
    pub extent: Extent,
    pub wrap: Wrap,
    pub seed: u64,
    pub sample_rate_hz: f64,
    /// Where the workers of sand go that is simulated elsewhere; none = it is simulated within the source.
    pub workers: Option<&'a RefCell<Vec<SandWorker>>>,
    /// Makers of sources that the engine does not know.
    pub own: &'static [(&'static str, MakeSource)],
}

impl Ground<'_> {
    /// The source itself.
    pub fn source(self, source: &Source) -> Result<Boxed, FileError> {
        Ok(match source {
            Source::Flat => Box::new(
                HeightMap::flat(self.extent, crate::model::surface::DEFAULT_ROUGHNESS)
                    .map_err(FileError::told)?,
            ),
            Source::Map { image, relief_m, invert } => {
                let heights = upright(pixels(image)?.debanded(self.wrap), *invert);
                let extent = Extent { relief_m: *relief_m, ..self.extent };
                let map = HeightMap::new(&heights, extent, self.wrap);
                Box::new(map.map_err(|error| FileError::told(error).within(image.path.display()))?)
            }
            Source::Solid(solid) => Box::new(self.solid(solid)?),
            Source::Brownian(brownian) => self.brownian(brownian)?,
            Source::Lattice(entry) => Box::new(lattice(entry)?),
            Source::Sand(sand) => Box::new(self.sand(sand)?),
            Source::Own(own) => own.make(self.own, [self.extent.width_m, self.extent.height_m])?,
            Source::Sum(parts) => {
                Box::new(Sum::new(parts.iter().map(|part| self.source(part)).collect::<Result<_, _>>()?))
            }
            Source::Scale(source, factor) => {
                let scale = Scale::new(self.source(source)?, *factor, self.sample_rate_hz);
                Box::new(scale.map_err(|error| FileError::told(error).within("scale"))?)
            }
            Source::Mask { image, inside, outside } => {
                let weights = pixels(image)?.debanded(self.wrap);
                let mask = HeightMap::new(&weights, self.extent, self.wrap)
                    .map_err(|error| FileError::told(error).within(image.path.display()))?;
                Box::new(Mask::new(Box::new(mask), self.source(inside)?, self.source(outside)?))
            }
            Source::Crossfade { from, to, at_s } => {
                let (from, to) = (self.source(from)?, self.source(to)?);
                let mut fade = Crossfade::new(from, to, self.sample_rate_hz).map_err(FileError::told)?;
                let sample = (at_s * self.sample_rate_hz).round() as u64;
                fade.change(&CrossfadeTo(1.0), sample);
                Box::new(fade)
            }
        })
    }

    /// Whether heights belong to places.
    fn has_places(source: &Source) -> bool {
        match source {
            Source::Brownian(brownian) => !brownian.graph,
            Source::Sum(parts) => parts.iter().all(Self::has_places),
            Source::Scale(source, _) => Self::has_places(source),
            Source::Mask { inside: a, outside: b, .. } | Source::Crossfade { from: a, to: b, .. } => {
                Self::has_places(a) && Self::has_places(b)
            }
            _ => true,
        }
    }

    /// Heights of a source on a grid, as in [`super::relief`].
    pub fn relief(self, source: &Source, longest: usize) -> Option<Raster> {
        if !Self::has_places(source) {
            return None;
        }
        let mut source = self.source(source).ok()?;
        let step_m = self.extent.width_m.max(self.extent.height_m) / longest as f64;
        let [width, height] =
            [self.extent.width_m, self.extent.height_m].map(|e| ((e / step_m).round() as usize).max(1));
        let mut values = Vec::with_capacity(width * height);
        let mut out = SurfaceBlock::default();
        for y in 0..height {
            for first in (0..width).step_by(MAX_BLOCK) {
                let columns = first..(first + MAX_BLOCK).min(width);
                let place = |x: usize| [(x as f64 + 0.5) * step_m, (y as f64 + 0.5) * step_m];
                let position_m: Vec<[f64; 2]> = columns.map(place).collect();
                source.sample(
                    &PathBlock {
                        position_m: &position_m,
                        velocity_m_s: &[[0.0; 2]; MAX_BLOCK][..position_m.len()],
                        footprint_m: &[0.0; MAX_BLOCK][..position_m.len()],
                        normal_force_n: &[],
                        first_sample: 0,
                        contact: 0,
                        slopes: true,
                    },
                    &mut out,
                );
                values.extend_from_slice(&out.height_m[..position_m.len()]);
            }
        }
        Some(Raster { width, height, values })
    }

    fn solid(self, entry: &SolidEntry) -> Result<SolidNoise, FileError> {
        let material = SolidMaterial::from_name(&entry.preset).ok_or_else(|| {
            let known = SolidMaterial::SEVEN.map(SolidMaterial::name).join(", ");
            let what = format!("\"{}\" is unknown", entry.preset);
            FileError::new("solid", what, format!("must be one of: {known}"))
        })?;
        let mut parameters = material.parameters();
        let set = |to: &mut f64, written: Option<f64>| *to = written.unwrap_or(*to);
        let module = &mut parameters.modules[0];
        set(&mut module.magnitude, entry.magnitude);
        set(&mut module.frequency, entry.frequency);
        set(&mut module.lacunarity, entry.lacunarity);
        set(&mut module.persistence, entry.persistence);
        module.octaves = entry.octaves.map_or(module.octaves, |octaves| octaves as usize);
        set(&mut parameters.texture_factor_per_m, entry.texture_factor_per_m);
        set(&mut parameters.amplitude_m, entry.amplitude_m);
        set(&mut parameters.limit_n, entry.limit_n);
        set(&mut parameters.cap_n, entry.cap_n);
        set(&mut parameters.viscosity_n_s_m, entry.viscosity_n_s_m);
        parameters.proportional_to_contact = entry.proportional.unwrap_or(parameters.proportional_to_contact);
        if let Some(direction) = entry.direction {
            parameters.direction = match direction {
                Direction::X => ForceDirection::X,
                Direction::Normal => ForceDirection::Normal,
                Direction::Tangent => ForceDirection::Tangent,
            };
        }
        SolidNoise::new(parameters, entry.seed.unwrap_or(self.seed), self.sample_rate_hz)
            .map_err(|error| FileError::told(error).within("solid"))
    }

    #[cfg(not(feature = "brownian"))]
    fn brownian(self, _entry: &Brownian) -> Result<Boxed, FileError> {
        Err(FileError::new("brownian", "is not in this build", "build asperity with its feature brownian"))
    }

    #[cfg(feature = "brownian")]
    fn brownian(self, entry: &Brownian) -> Result<Boxed, FileError> {
        let told = |error| FileError::told(error).within("brownian");
        let mut design = BrownianDesign::new(entry.hurst, entry.rms_m, entry.seed.unwrap_or(self.seed));
        let rendering = entry.force.map(|force| match force {
            ForceEntry::Orthogonal => Rendering::Orthogonal,
            ForceEntry::Lateral => Rendering::Lateral,
        });
        if entry.graph {
            design.size = entry.cells.map_or(GRAPH_POINTS, |cells| cells as usize);
            let heights_m = design.path().map_err(told)?;
            let spacing_m = self.extent.width_m / design.size as f64;
            return Ok(Box::new(BrownianPath::new(&heights_m, spacing_m, rendering, 1).map_err(told)?));
        }
        design.size = entry.cells.map_or(design.size, |cells| cells as usize);
        let relief = design.surface().map_err(told)?;
        // The relief is isotropic and repeats in a square; a surface of another shape is cut from it.
        let side_m = self.extent.width_m.max(self.extent.height_m);
        let square = Extent { width_m: side_m, height_m: side_m, relief_m: 1.0 };
        let map = Box::new(HeightMap::new(&relief, square, Wrap::Repeat).map_err(FileError::told)?);
        let Some(rendering) = rendering else { return Ok(map) };
        let (low, high) = relief.range();
        let force = BrownianForce::surface(rendering, high - low).map_err(told)?;
        Ok(Box::new(BrownianSurface::new(map, force)))
    }

    fn sand(self, entry: &Sand) -> Result<SandSource, FileError> {
        let default = SandLaw::default();
        let mut law = SandLaw {
            stiffness_n: entry.stiffness_n,
            exponent_per_m: entry.exponent_per_m,
            drag_s_per_m: entry.drag_s_per_m,
            wetness: entry.wetness.unwrap_or(default.wetness),
            grain_m: entry.grain_m.unwrap_or(default.grain_m),
            ..default
        };
        for (slot, &(from_m, hardness)) in law.layers.iter_mut().zip(&entry.layers) {
            *slot = Some(Layer { from_m, hardness });
        }
        let design = SandDesign {
            width_m: self.extent.width_m,
            height_m: self.extent.height_m,
            cells: entry.cells as usize,
            depth_m: entry.depth_m,
            talus_deg: entry.talus_deg,
            law,
            tool: tool(&entry.tool)?,
            ..SandDesign::default()
        };
        let (tool_m, cell_m) = (2.0 * design.tool.reach_m(), design.width_m / entry.cells as f64);
        if cell_m > tool_m {
            let what = format!("{} is refused", entry.cells);
            let least = (design.width_m / tool_m).ceil();
            let right = format!(
                "must be at least {least}: a cell of {cell_m:.3} m is wider than the tool of {tool_m:.3} m, which would leave no groove"
            );
            return Err(FileError::new("sand: cells", what, right));
        }
        let source = match self.workers {
            None => SandSource::synchronous(&design, self.seed, self.sample_rate_hz),
            Some(workers) => {
                let sand = SandSource::threaded(&design, self.seed, self.sample_rate_hz);
                sand.map(|(source, worker)| {
                    workers.borrow_mut().push(worker);
                    source
                })
            }
        };
        source.map_err(|error| FileError::told(error).within("sand"))
    }
}

fn lattice(entry: &LatticeEntry) -> Result<Lattice, FileError> {
    let relief_m = entry.relief_m;
    let cell = upright(pixels(&entry.cell)?.debanded(Wrap::Repeat), entry.invert);
    Lattice::new(&cell.map(|height| height * relief_m), entry.t1_m, entry.t2_m)
        .map_err(|error| FileError::told(error).within("lattice"))
}

/// A picture of a tool's underside: white is no tool, the darkest point is the lowest.
fn tool(entry: &ToolEntry) -> Result<Tool, FileError> {
    match entry {
        ToolEntry::Sphere(radius_m) => Ok(Tool::Sphere { radius_m: *radius_m }),
        ToolEntry::Map { image, width_m, relief_m } => {
            let grey = pixels(image)?.raster;
            let lowest = grey.range().0;
            if lowest >= 1.0 {
                let right = "must show the tool darker than white, which is no tool";
                return Err(FileError::new(image.path.display().to_string(), "is white everywhere", right));
            }
            let texel_m = width_m / grey.width as f64;
            let map = grey.map(|grey| if grey >= 1.0 { f64::INFINITY } else { (grey - lowest) * relief_m });
            Ok(Tool::LowerMap { map, texel_m })
        }
    }
}

/// A depth map holds what a height map lacks.
fn upright(heights: Raster, invert: bool) -> Raster {
    if invert { heights.map(|height| 1.0 - height) } else { heights }
}
