//! A displacement map under a finger: cubic B-spline over the texels, mip level by footprint.
//!
//! ```text
//! h(p) = relief_m · map(p)     level ℓ = max(0, log₂(2 · footprint / texel)),  neighbouring levels blended
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | map | [`Raster`], 0–1 or metres | texel centres at (i + ½)/N of the extent, top left corner at (0, 0) |
//! | ℓ | pyramid of `spline`s | each level half the size, filtered; texels are measured along the stroke |
//! | R | roughness map of its own size, or a number | sampled likewise, kept within 0–1 |
//!
//! Source: Hasti §III-C (displacement and roughness maps). What we changed: the paper does not say
//! how the map is interpolated; bilinear leaves a velocity SNR of 17 dB on a sine of 12.8 texels a
//! period, the prefiltered cubic B-spline 63 dB. Wrap modes apply to the prefilter and the pyramid
//! as well, so that a seamless map has no seam.

mod extent;
mod sampling;

pub use extent::{Extent, MapError};

use crate::dilated::dilated;
use crate::height_field::{
    Extension, HeightField, MAX_BLOCK, PathBlock, Power, PowerKind, Properties, Setup, SurfaceBlock,
    WavelengthBand, bounds,
};
use crate::local_relief::LocalRelief;
use crate::raster::Raster;
use crate::resample::halve;
use crate::spline::{Spline, Working};
use crate::wrap::Wrap;
use asperity_dsp::DesignError;
use extent::check;
use std::sync::Arc;

/// Coulomb friction coefficient of a map by default: a dry finger on smooth hard
/// material. Assumed; measured values range from 0.2 to above 1.
pub const FRICTION: f64 = 0.5;

/// A surface made of maps.
///
/// ```
/// use asperity_surface::height_map::{Extent, HeightMap};
/// use asperity_surface::raster::Raster;
/// use asperity_surface::wrap::Wrap;
///
/// // Waves of 5 mm, 0.1 mm high, on 4 cm.
/// let wave = Raster::from_fn(128, 4, |x, _| 0.5 + 0.5 * (std::f64::consts::TAU * x as f64 / 16.0).sin());
/// let extent = Extent { width_m: 0.04, height_m: 0.04, relief_m: 1e-4 };
/// let map = HeightMap::new(&wave, extent, Wrap::Repeat)?.with_roughness(0.3)?;
/// # Ok::<(), asperity_surface::height_map::MapError>(())
/// ```
#[derive(Debug, Clone)]
pub struct HeightMap {
    heights: Pyramid,
    roughness: Roughness,
    extent: Extent,
    wrap: Wrap,
    band: WavelengthBand,
    /// Largest height, either way.
    reach_m: f64,
    /// Region with relief; none = nowhere.
    local: Option<Arc<LocalRelief>>,
    friction: f64,
    /// Maps that tips of some radii ride on, and the one that rides now.
    tips: Vec<(f64, Pyramid)>,
    tip: Option<usize>,
}

#[derive(Debug, Clone)]
enum Roughness {
    Constant(f64),
    Map(Pyramid),
}

/// A map at full size, half size, quarter size, …; empty for a map of one value. Copies share it.
#[derive(Debug, Clone)]
struct Pyramid {
    levels: Arc<[Spline]>,
    constant: f64,
}

impl HeightMap {
    /// A surface from a raster of heights: `extent.relief_m` times its values. Roughness is ½ until
    /// [`Self::with_roughness`] or [`Self::with_roughness_map`] says otherwise.
    ///
    /// # Errors
    /// When the raster is empty or not finite, or the extent impossible.
    pub fn new(heights: &Raster, extent: Extent, wrap: Wrap) -> Result<Self, MapError> {
        extent.check()?;
        check(heights)?;
        let height_m = |v: f64| v * extent.relief_m;
        let (low, high) = heights.range();
        let (low_m, high_m) = (height_m(low), height_m(high));
        let reach_m = high_m.abs().max(low_m.abs());
        let size_m = [extent.width_m, extent.height_m];
        let local = (low_m != high_m).then(|| Arc::new(LocalRelief::new(heights, height_m, size_m, wrap)));
        let heights = Pyramid::new(heights, height_m, extent, wrap);
        let band = match heights.levels.first() {
            None => WavelengthBand::EMPTY,
            Some(finest) => {
                let [u, v] = finest.texels_per_metre();
                WavelengthBand { shortest_m: 2.0 / u.max(v), longest_m: extent.width_m.max(extent.height_m) }
            }
        };
        let roughness = Roughness::Constant(0.5);
        Ok(Self {
            heights,
            roughness,
            extent,
            wrap,
            band,
            reach_m,
            local,
            friction: FRICTION,
            tips: Vec::new(),
            tip: None,
        })
    }

    /// A plane: every relief comes from the micro-noise.
    ///
    /// # Errors
    /// When the extent is impossible or the roughness outside 0–1.
    pub fn flat(extent: Extent, roughness: f64) -> Result<Self, MapError> {
        Self::new(&Raster::constant(1, 1, 0.0), extent, Wrap::Repeat)?.with_roughness(roughness)
    }

    /// Sets one roughness everywhere, 0–1.
    ///
    /// # Errors
    /// When it is outside 0–1.
    pub fn with_roughness(mut self, roughness: f64) -> Result<Self, MapError> {
        if !(0.0..=1.0).contains(&roughness) {
            return Err(MapError::Roughness(roughness));
        }
        self.roughness = Roughness::Constant(roughness);
        Ok(self)
    }

    /// Sets a roughness map (values 0–1, clamped) of any size over the same extent. A
    /// gloss map is `raster.map(|gloss| 1.0 − gloss)`.
    ///
    /// # Errors
    /// When the raster is empty or not finite.
    pub fn with_roughness_map(mut self, roughness: &Raster) -> Result<Self, MapError> {
        check(roughness)?;
        let within = |r: f64| r.clamp(0.0, 1.0);
        self.roughness = Roughness::Map(Pyramid::new(roughness, within, self.extent, self.wrap));
        Ok(self)
    }

    /// The patch the map covers.
    #[must_use]
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Continuation of the map beyond its edges.
    #[must_use]
    pub fn wrap(&self) -> Wrap {
        self.wrap
    }

    /// Map that the tip rides on which rides now.
    fn dilated(&self) -> &Pyramid {
        self.tip.and_then(|tip| self.tips.get(tip)).map_or(&self.heights, |(_, map)| map)
    }

    /// After how many metres along u and v the surface is the same again; what a path unwraps by.
    #[must_use]
    pub fn wrap_period_m(&self) -> [f64; 2] {
        [self.wrap.period_m(self.extent.width_m), self.wrap.period_m(self.extent.height_m)]
    }
}

impl Pyramid {
    /// `value` of a raster's numbers; no copy of a large map is made on the way.
    fn new(raster: &Raster, value: impl Fn(f64) -> f64 + Copy, extent: Extent, wrap: Wrap) -> Self {
        let constant = value(raster.values[0]);
        let mut levels = Vec::new();
        if raster.values.iter().all(|&v| value(v) == constant) {
            return Self { levels: levels.into(), constant };
        }
        let size = [extent.width_m, extent.height_m];
        let mut smaller = halve(raster, value, wrap);
        levels.push(Spline::new(raster, value, size, wrap));
        while levels.len() < 32 && (smaller.width > 1 || smaller.height > 1) {
            levels.push(Spline::new(&smaller, |v| v, size, wrap));
            smaller = halve(&smaller, |v| v, wrap);
        }
        Self { levels: levels.into(), constant }
    }

    /// The map along a path, blurred to the footprints, and its slopes if `SLOPES`; no footprint is
    /// longer than `widest_m`.
    fn sample_block<const SLOPES: bool>(
        &self,
        path: &PathBlock<'_>,
        (widest_m, bounds_m): (f64, Option<&[[f64; 2]; 2]>),
        working: &mut Working,
    ) {
        let Working { places, samples, .. } = working;
        let Some(finest) = self.levels.first() else { return samples.fill::<SLOPES>(self.constant) };
        if is_sharp(widest_m, finest.texels_per_metre()) {
            return finest.sample_block::<SLOPES>(path.position_m, bounds_m, places, samples);
        }
        self.sample_blurred::<SLOPES>(finest, path, working);
    }

    /// Fills where some footprint is wider than a texel.
    #[inline(never)]
    fn sample_blurred<const SLOPES: bool>(
        &self,
        finest: &Spline,
        path: &PathBlock<'_>,
        working: &mut Working,
    ) {
        let mut blur = [(0, 0.0); MAX_BLOCK];
        for (n, blur) in blur[..path.len()].iter_mut().enumerate() {
            *blur = self.blur(finest, path.velocity_m_s[n], path.footprint_m[n]);
            if path.bare {
                // One level says how the ground bends.
                blur.1 = 0.0;
            }
        }
        let mut start = 0;
        while start < path.len() {
            let level = blur[start].0;
            let same = blur[start..path.len()].iter().take_while(|blur| blur.0 == level).count();
            let run = start..start + same;
            let (position_m, blur) = (&path.position_m[run.clone()], &blur[run]);
            self.blend_block::<SLOPES>(level, position_m, blur, start, working);
            start += same;
        }
        working.places.forget();
    }

    /// The level that a footprint asks for, and how much of the next one is blended in.
    #[inline]
    fn blur(&self, finest: &Spline, velocity_m_s: [f64; 2], footprint_m: f64) -> (usize, f64) {
        let texels_per_metre = finest.texels_per_metre();
        if is_sharp(footprint_m, texels_per_metre) {
            return (0, 0.0);
        }
        let last = self.levels.len() - 1;
        let samples = 2.0 * footprint_m * along(velocity_m_s, texels_per_metre);
        // In this order what is no number is sharp.
        let samples = samples.max(1.0).min((1u64 << last) as f64);
        let level = (samples as u64).ilog2() as usize;
        (level, if level == last { 0.0 } else { samples / (1u64 << level) as f64 - 1.0 })
    }

    /// A run of samples between one level and the next, from place `start` of `out` on.
    fn blend_block<const SLOPES: bool>(
        &self,
        level: usize,
        position_m: &[[f64; 2]],
        blur: &[(usize, f64)],
        start: usize,
        Working { places, samples: out, levels: [finer, coarser] }: &mut Working,
    ) {
        places.forget();
        self.levels[level].sample_block::<SLOPES>(position_m, None, places, finer);
        let blends = blur.iter().any(|(_, blend)| *blend != 0.0);
        if let Some(next) = self.levels.get(level + 1).filter(|_| blends) {
            places.forget();
            next.sample_block::<SLOPES>(position_m, None, places, coarser);
        } else {
            coarser.fill::<SLOPES>(0.0);
        }
        for (n, (_, blend)) in blur.iter().enumerate() {
            let mix = |a: f64, b: f64| a + blend * (b - a);
            out.value[start + n] = mix(finer.value[n], coarser.value[n]);
            if SLOPES {
                out.slope_u[start + n] = mix(finer.slope_u[n], coarser.slope_u[n]);
                out.slope_v[start + n] = mix(finer.slope_v[n], coarser.slope_v[n]);
            }
        }
    }
}

/// Tests whether the finest level needs no blur in any direction.
#[inline]
fn is_sharp(footprint_m: f64, texels_per_metre: [f64; 2]) -> bool {
    2.0 * footprint_m * texels_per_metre[0].max(texels_per_metre[1]) <= 1.0
}

/// Texels per metre along the direction of movement.
#[inline]
fn along([x, y]: [f64; 2], [u, v]: [f64; 2]) -> f64 {
    let speed_squared = x * x + y * y;
    if speed_squared > 0.0 {
        (((x * u) * (x * u) + (y * v) * (y * v)) / speed_squared).sqrt()
    } else {
        u.max(v)
    }
}

impl HeightField for HeightMap {
    fn properties(&self, tile_m: [f64; 2]) -> Properties {
        Properties {
            reach_m: self.reach_m,
            extension: self.extension(tile_m),
            is_rigid: true,
            is_stateless: !self.heights.levels.is_empty(),
            ..Properties::of(self.band)
        }
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        self.tip = self.tips.iter().position(|(known_m, _)| *known_m == path.tip_radius_m);
        self.sample_in(path, path.bounds_m.as_ref(), out);
        if !path.heights_only {
            self.tell_the_rest(path.len(), out);
        }
        if let Some(full_m2) = path.full_power_m2 {
            self.write_power(path, full_m2, &mut out.power);
        }
    }

    fn prepare(&mut self, setup: &Setup<'_>) -> Result<(), DesignError> {
        setup.tip_radii_m.iter().for_each(|radius_m| self.prepare_tip(*radius_m));
        Ok(())
    }
}

impl HeightMap {
    /// Makes the map that a sphere of this radius rides on.
    fn prepare_tip(&mut self, radius_m: f64) {
        let known = self.tips.iter().any(|(known_m, _)| *known_m == radius_m);
        let Some(finest) = self.heights.levels.first().filter(|_| radius_m > 0.0 && !known) else { return };
        let texels_per_metre = finest.texels_per_metre();
        let map = dilated(finest.texels(), texels_per_metre.map(f64::recip), self.wrap, radius_m);
        self.tips.push((radius_m, Pyramid::new(&map, |m| m, self.extent, self.wrap)));
    }

    fn write_power(&self, path: &PathBlock<'_>, full_m2: f64, power: &mut Power) {
        power.kind = match &self.local {
            None => PowerKind::None,
            Some(local) => {
                let bounds_m = path.bounds_m.unwrap_or_else(|| bounds(path.position_m));
                local.along(path.position_m, bounds_m, full_m2, &mut power.each_m2[..path.len()])
            }
        };
    }

    fn extension(&self, tile_m: [f64; 2]) -> Extension {
        let everywhere_alike = self.heights.levels.is_empty()
            && !matches!(&self.roughness, Roughness::Map(map) if !map.levels.is_empty());
        let tiles = [tile_m[0] / self.extent.width_m, tile_m[1] / self.extent.height_m];
        let fits = tiles.iter().all(|tiles| *tiles > 0.5 && (tiles - tiles.round()).abs() < 1e-9);
        match self.wrap {
            _ if everywhere_alike => Extension::Same,
            Wrap::Clamp => Extension::Edge,
            Wrap::Repeat if fits => Extension::Same,
            Wrap::Mirror if fits => Extension::Mirrored,
            Wrap::Repeat | Wrap::Mirror => Extension::Fresh,
        }
    }
}
