//! Mask: one surface where a map is white, another where it is black.

use super::Source;
use super::mixture::mix;
use super::shared;
use crate::height_field::{HeightField, MAX_BLOCK, Part, PathBlock, Properties, Shares, SurfaceBlock, Touch};

/// One source where a mask is 1, another where it is 0.
pub struct Mask {
    /// Inside, outside, and the mask.
    sources: [Source; 3],
    weight: SurfaceBlock,
    other: SurfaceBlock,
}

impl Mask {
    /// The *height* of `mask` is the weight of `inside`, held within 0–1: a height map with 1 m
    /// relief serves as mask. It must be smooth on the scale of a footprint, or its edge is felt.
    #[must_use]
    pub fn new(mask: Source, inside: Source, outside: Source) -> Self {
        let (weight, other) = (SurfaceBlock::default(), SurfaceBlock::default());
        Self { sources: [inside, outside, mask], weight, other }
    }
}

impl Mask {
    /// Share of the inside at a place.
    fn weight_at(&mut self, position_m: [f64; 2]) -> f64 {
        let path = PathBlock {
            position_m: &[position_m],
            velocity_m_s: &[[0.0; 2]],
            footprint_m: &[0.0],
            ..PathBlock::default()
        };
        self.sources[2].sample(&path, &mut self.weight);
        self.weight.height_m[0].clamp(0.0, 1.0)
    }
}

impl HeightField for Mask {
    fn properties(&self, tile_m: [f64; 2]) -> Properties {
        let [inside, outside, mask] = self.sources.each_ref().map(|source| source.properties(tile_m));
        let met = inside.union(outside);
        Properties { extension: met.extension.max(mask.extension), ..met }
    }

    fn parts(&mut self) -> &mut [Part] {
        &mut self.sources
    }

    /// The mask itself is neither felt nor heard.
    fn shares(&mut self, touch: &Touch) -> Shares {
        let w = self.weight_at(touch.position_m);
        shared([(*touch, w), (*touch, 1.0 - w), (*touch, 0.0)])
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let [inside, outside, mask] = &mut self.sources;
        // The mask is a drawing of where, which no tip rides on.
        let drawn = PathBlock { full_power_m2: None, tip_radius_m: 0.0, at_m: &[], ..*path };
        mask.sample(&drawn, &mut self.weight);
        inside.sample(path, &mut self.other);
        outside.sample(path, out);
        let n = path.len().min(MAX_BLOCK);
        out.power.add(&self.other.power, n);
        for i in 0..n {
            let raw = self.weight.height_m[i];
            let w = raw.clamp(0.0, 1.0);
            let edge = if raw == w { self.weight.gradient[i] } else { [0.0; 2] };
            let step = self.other.height_m[i] - out.height_m[i];
            mix(out, &self.other, i, w);
            out.gradient[i][0] += edge[0] * step;
            out.gradient[i][1] += edge[1] * step;
        }
    }
}

crate::opaque::debug_by_name!(Mask);
