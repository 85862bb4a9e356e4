//! Mask: one surface where a map is white, another where it is black.

use super::Source;
use super::mixture::{add, mix};
use crate::height_field::{
    Beyond, HeightField, MAX_BLOCK, PathBlock, Reaction, Setup, SurfaceBlock, Touch, WavelengthBand,
};
use asperity_dsp::DesignError;
use std::any::Any;

/// One source where a mask is 1, another where it is 0.
pub struct Mask {
    mask: Source,
    inside: Source,
    outside: Source,
    weight: SurfaceBlock,
    other: SurfaceBlock,
}

impl Mask {
    /// The *height* of `mask` is the weight of `inside`, held within 0–1: a height map with 1 m
    /// relief serves as mask. It must be smooth on the scale of a footprint, or its edge is felt.
    #[must_use]
    pub fn new(mask: Source, inside: Source, outside: Source) -> Self {
        let (weight, other) = (SurfaceBlock::default(), SurfaceBlock::default());
        Self { mask, inside, outside, weight, other }
    }
}

impl Mask {
    /// Share of the inside at a place.
    fn weight_at(&mut self, position_m: [f64; 2]) -> f64 {
        let path = PathBlock {
            position_m: &[position_m],
            velocity_m_s: &[[0.0; 2]],
            footprint_m: &[0.0],
            normal_force_n: &[],
            first_sample: 0,
            contact: 0,
            slopes: false,
        };
        self.mask.sample(&path, &mut self.weight);
        self.weight.height_m[0].clamp(0.0, 1.0)
    }
}

impl HeightField for Mask {
    fn prepare_tip(&mut self, radius_m: f64) {
        [&mut self.inside, &mut self.outside].into_iter().for_each(|source| source.prepare_tip(radius_m));
    }

    fn ride(&mut self, radius_m: f64) {
        [&mut self.inside, &mut self.outside].into_iter().for_each(|source| source.ride(radius_m));
    }

    fn lie_at(&mut self, at_m: &[[f64; 3]]) {
        [&mut self.inside, &mut self.outside].into_iter().for_each(|source| source.lie_at(at_m));
    }

    fn carries_n(&mut self, position_m: [f64; 2], depth_m: f64) -> Option<f64> {
        let inside_n = self.inside.carries_n(position_m, depth_m);
        let outside_n = self.outside.carries_n(position_m, depth_m);
        let w = self.weight_at(position_m);
        match (inside_n, outside_n) {
            (Some(inside_n), Some(outside_n)) => Some(w * inside_n + (1.0 - w) * outside_n),
            _ => None,
        }
    }

    fn prepare(&mut self, setup: &Setup) -> Result<(), DesignError> {
        self.mask.prepare(setup)?;
        self.inside.prepare(setup)?;
        self.outside.prepare(setup)
    }

    fn band(&self) -> WavelengthBand {
        self.inside.band().union(self.outside.band())
    }

    fn is_read_beside(&self) -> bool {
        self.inside.is_read_beside() && self.outside.is_read_beside()
    }

    fn reach_m(&self) -> f64 {
        self.inside.reach_m().max(self.outside.reach_m())
    }

    fn add_local_power(&self, position_m: &[[f64; 2]], power_m2: &mut [f64]) {
        self.inside.add_local_power(position_m, power_m2);
        self.outside.add_local_power(position_m, power_m2);
    }

    fn hollow_m(&mut self, touch: &Touch, reach_m: f64) -> f64 {
        let w = self.weight_at(touch.position_m);
        w * self.inside.hollow_m(touch, reach_m) + (1.0 - w) * self.outside.hollow_m(touch, reach_m)
    }

    fn beyond(&self, tile_m: [f64; 2]) -> Beyond {
        let parts = [&self.mask, &self.inside, &self.outside].map(|s| s.beyond(tile_m));
        parts.into_iter().fold(Beyond::Same, Beyond::max)
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        self.mask.sample(path, &mut self.weight);
        self.inside.sample(path, &mut self.other);
        self.outside.sample(path, out);
        for i in 0..path.len().min(MAX_BLOCK) {
            let raw = self.weight.height_m[i];
            let w = raw.clamp(0.0, 1.0);
            let edge = if raw == w { self.weight.gradient[i] } else { [0.0; 2] };
            let step = self.other.height_m[i] - out.height_m[i];
            mix(out, &self.other, i, w);
            out.gradient[i][0] += edge[0] * step;
            out.gradient[i][1] += edge[1] * step;
        }
    }

    fn land(&mut self, touch: &Touch) {
        self.inside.land(touch);
        self.outside.land(touch);
    }

    fn react(&mut self, touch: &Touch) -> Reaction {
        let w = self.weight_at(touch.position_m);
        let inside = self.inside.react(touch);
        add(add(Reaction::default(), inside, w), self.outside.react(touch), 1.0 - w)
    }

    fn change(&mut self, change: &dyn Any, sample: u64) -> bool {
        let mask = self.mask.change(change, sample);
        let inside = self.inside.change(change, sample);
        self.outside.change(change, sample) | inside | mask
    }

    fn visit(&mut self, see: &mut dyn FnMut(&mut dyn Any)) {
        self.inside.visit(see);
        self.outside.visit(see);
    }
}
