//! Sources made of a scene file's words: heights that the engine samples.

use super::loader::Loader;
use super::maps::{MapOf, Values};
use crate::files::scene_file::{Brownian, Lattice as LatticeEntry, Sand, Source, ToolPicture};
use crate::files::storage::Pixels;
use crate::files::{FileError, storage};
use crate::model::frame::SurfaceFrame;
#[cfg(feature = "brownian")]
use asperity_surface::brownian::BrownianDesign;
#[cfg(feature = "brownian")]
use asperity_surface::brownian::rendering::{BrownianForce, BrownianPath, BrownianSurface};
use asperity_surface::combine::{Crossfade, Mask, Scale, Sum};
use asperity_surface::grating::Grating;
use asperity_surface::height_field::{HeightField, MAX_BLOCK, PathBlock, SurfaceBlock};
use asperity_surface::height_map::{Extent, HeightMap};
use asperity_surface::lattice::Lattice;
use asperity_surface::raster::Raster;
use asperity_surface::sand::{SandDesign, SandSource, Tool};
use asperity_surface::solid_noise::{SolidCut, SolidNoise, SolidNoiseParameters};
use asperity_surface::wrap::Wrap;

/// Points of a graph by default.
#[cfg(feature = "brownian")]
const GRAPH_POINTS: usize = 1 << 14;

type Boxed = Box<dyn HeightField>;

/// Settings that every source of a surface shares.
#[derive(Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub maker: Loader<'a>,
    pub extent: Extent,
    pub wrap: Wrap,
    pub frame: Option<SurfaceFrame>,
}

impl Ground<'_> {
    /// The source itself.
    pub fn source(self, source: &Source) -> Result<Boxed, FileError> {
        Ok(match source {
            Source::Flat => Box::new(
                HeightMap::flat(self.extent, crate::model::surface::DEFAULT_ROUGHNESS)
                    .map_err(FileError::from_error)?,
            ),
            Source::Map { image, relief_m, invert } => {
                let extent = Extent { relief_m: *relief_m, ..self.extent };
                Box::new(self.map(image, *invert, extent)?)
            }
            Source::Solid { parameters, seed } => Box::new(self.solid(parameters, *seed)?),
            Source::Grating(parameters) => Box::new(
                Grating::new(*parameters).map_err(|error| FileError::from_error(error).within("solid"))?,
            ),
            Source::Brownian(brownian) => self.brownian(brownian)?,
            Source::Lattice(entry) => Box::new(self.lattice(entry)?),
            Source::Sand(sand) => Box::new(self.sand(sand)?),
            Source::Own(own) => own.make(self.maker.own, [self.extent.width_m, self.extent.height_m])?,
            Source::Sum(parts) => {
                Box::new(Sum::new(parts.iter().map(|part| self.source(part)).collect::<Result<_, _>>()?))
            }
            Source::Scale(source, factor) => {
                let scale = Scale::new(self.source(source)?, *factor);
                Box::new(scale.map_err(|error| FileError::from_error(error).within("scale"))?)
            }
            Source::Mask { image, inside, outside } => {
                let mask = self.map(image, false, self.extent)?;
                Box::new(Mask::new(Box::new(mask), self.source(inside)?, self.source(outside)?))
            }
            Source::Crossfade { from, to, at_s } => {
                Box::new(Crossfade::new(self.source(from)?, self.source(to)?).at_s(*at_s))
            }
        })
    }

    /// Heights as a picture shows them.
    fn map(self, image: &Pixels, invert: bool, extent: Extent) -> Result<HeightMap, FileError> {
        let (image, wrap) = (image.clone(), self.wrap);
        let of = MapOf { image, values: Values::Debanded, invert, extent, wrap };
        self.maker.maps.get(of, self.maker.files)
    }

    /// True where heights belong to places.
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

    /// Heights of a source on a grid, as in [`crate::load::relief`].
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
                        ..PathBlock::default()
                    },
                    &mut out,
                );
                values.extend_from_slice(&out.height_m[..position_m.len()]);
            }
        }
        Some(Raster { width, height, values })
    }

    fn solid(self, parameters: &SolidNoiseParameters, seed: Option<u64>) -> Result<SolidNoise, FileError> {
        let noise = SolidNoise::new(*parameters, seed.unwrap_or(self.maker.seed))
            .map_err(|error| FileError::from_error(error).within("solid"))?;
        Ok(match self.frame {
            Some(frame) => {
                let [u_axis, v_axis] = frame.axes();
                noise.with_cut(SolidCut::of_body(frame.origin_m(), u_axis, v_axis))
            }
            None => noise,
        })
    }

    #[cfg(not(feature = "brownian"))]
    fn brownian(self, _entry: &Brownian) -> Result<Boxed, FileError> {
        Err(FileError::new("brownian", "is not in this build", "build asperity with its feature brownian"))
    }

    #[cfg(feature = "brownian")]
    fn brownian(self, entry: &Brownian) -> Result<Boxed, FileError> {
        let placed = |error| FileError::from_error(error).within("brownian");
        let mut design = BrownianDesign::new(entry.hurst, entry.rms_m, entry.seed.unwrap_or(self.maker.seed));
        let rendering = entry.force;
        if entry.graph {
            design.size = entry.cells.map_or(GRAPH_POINTS, |cells| cells as usize);
            let heights_m = design.path().map_err(placed)?;
            let spacing_m = self.extent.width_m / design.size as f64;
            return Ok(Box::new(BrownianPath::new(&heights_m, spacing_m, rendering).map_err(placed)?));
        }
        design.size = entry.cells.map_or(design.size, |cells| cells as usize);
        let relief = design.surface().map_err(placed)?;
        // The relief is isotropic and repeats in a square; a surface of another shape is cut from
        // it.
        let side_m = self.extent.width_m.max(self.extent.height_m);
        let square = Extent { width_m: side_m, height_m: side_m, relief_m: 1.0 };
        let map = Box::new(HeightMap::new(&relief, square, Wrap::Repeat).map_err(FileError::from_error)?);
        let Some(rendering) = rendering else { return Ok(map) };
        let (low, high) = relief.range();
        let force = BrownianForce::surface(rendering, high - low).map_err(placed)?;
        Ok(Box::new(BrownianSurface::new(map, force)))
    }

    fn sand(self, entry: &Sand) -> Result<SandSource, FileError> {
        let mut design = SandDesign {
            width_m: self.extent.width_m,
            height_m: self.extent.height_m,
            ..entry.design.clone()
        };
        if let Some(picture) = &entry.tool {
            design.tool = self.tool(picture)?;
        }
        let (tool_m, cell_m) = (2.0 * design.tool.reach_m(), design.width_m / design.cells as f64);
        if cell_m > tool_m {
            let what = format!("{} is refused", design.cells);
            let least = (design.width_m / tool_m).ceil();
            let right = format!(
                "must be at least {least}: a cell of {cell_m:.3} m is wider than the tool of {tool_m:.3} m, which would leave no groove"
            );
            return Err(FileError::new("sand: cells", what, right));
        }
        let placed = |error| FileError::from_error(error).within("sand");
        let Some(workers) = self.maker.workers else {
            return SandSource::synchronous(&design, self.maker.seed).map_err(placed);
        };
        let (source, worker) = SandSource::threaded(&design, self.maker.seed).map_err(placed)?;
        workers.borrow_mut().push(worker);
        Ok(source)
    }

    fn lattice(self, entry: &LatticeEntry) -> Result<Lattice, FileError> {
        let relief_m = entry.relief_m;
        let cell = self.maker.maps.read(&entry.cell, "channel", self.maker.files)?.debanded(Wrap::Repeat);
        let cell = upright(cell, entry.invert);
        Lattice::new(&cell.map(|height| height * relief_m), entry.t1_m, entry.t2_m)
            .map_err(|error| FileError::from_error(error).within("lattice"))
    }

    /// A picture of a tool's underside: white is no tool, the darkest point is the lowest.
    fn tool(self, ToolPicture { image, width_m, relief_m }: &ToolPicture) -> Result<Tool, FileError> {
        let grey = storage::channel(self.maker.files, image)?.raster;
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

/// A depth map holds what a height map lacks.
fn upright(heights: Raster, invert: bool) -> Raster {
    if invert { heights.map(|height| 1.0 - height) } else { heights }
}
