//! Surfaces made of surfaces: sum, scale, mask, crossfade, band split.
//!
//! | combination | height | who decides roughness, friction, compliance |
//! |---|---|---|
//! | [`Sum`] | Σ hᵢ | the first source; compliances add |
//! | [`Scale`] | g(t) · h | the source; a rigid one stays rigid |
//! | [`Mask`] | m(u, v) · h + (1 − m) · h₂ | mixed likewise |
//! | [`Crossfade`] | (1 − x(t)) · h₁ + x(t) · h₂ | mixed likewise |
//! | [`BandSplit`] | coarse(h₁) below, fine(h₂) above a wavelength, each with its own weight | the first source |
//!
//! Weights that depend on time move by [`crate::fade`], anchored to absolute samples, so that they
//! make no click and any split into blocks gives the same bits. Slopes follow the product rule in
//! space; the weights' change in time is not a slope. A contact's change messages and touches reach
//! every part; forces add up by the same weights as heights.

mod band_split;
mod mask;
mod mixture;

pub use band_split::{BandSplit, BandWeights};
pub use mask::Mask;
pub(crate) use mixture::add;

use crate::fade::Fade;
use crate::height_field::{
    Beyond, HeightField, MAX_BLOCK, PathBlock, Reaction, Setup, SurfaceBlock, Touch, WavelengthBand,
};
use asperity_dsp::{DesignError, limits};
use mixture::mix;
use std::any::Any;

/// A surface of any kind.
pub type Source = Box<dyn HeightField>;

/// All reliefs on top of each other.
pub struct Sum {
    sources: Vec<Source>,
    part: SurfaceBlock,
}

impl Sum {
    /// The sum of the sources; the first one is the ground whose roughness and friction are felt.
    #[must_use]
    pub fn new(sources: Vec<Source>) -> Self {
        Self { sources, part: SurfaceBlock::default() }
    }
}

impl HeightField for Sum {
    fn prepare_tip(&mut self, radius_m: f64) {
        self.sources.iter_mut().for_each(|source| source.prepare_tip(radius_m));
    }

    fn ride(&mut self, radius_m: f64) {
        self.sources.iter_mut().for_each(|source| source.ride(radius_m));
    }

    fn lie_at(&mut self, at_m: &[[f64; 3]]) {
        self.sources.iter_mut().for_each(|source| source.lie_at(at_m));
    }

    fn carries_n(&mut self, position_m: [f64; 2], depth_m: f64) -> Option<f64> {
        self.sources.iter_mut().find_map(|source| source.carries_n(position_m, depth_m))
    }

    fn prepare(&mut self, setup: &Setup) -> Result<(), DesignError> {
        self.sources.iter_mut().try_for_each(|source| source.prepare(setup))
    }

    fn band(&self) -> WavelengthBand {
        self.sources.iter().fold(WavelengthBand::EMPTY, |band, s| band.union(s.band()))
    }

    fn is_read_beside(&self) -> bool {
        self.sources.iter().all(|s| s.is_read_beside())
    }

    fn reach_m(&self) -> f64 {
        self.sources.iter().map(|s| s.reach_m()).sum()
    }

    fn add_local_power(&self, position_m: &[[f64; 2]], power_m2: &mut [f64]) {
        self.sources.iter().for_each(|s| s.add_local_power(position_m, power_m2));
    }

    fn hollow_m(&mut self, touch: &Touch, reach_m: f64) -> f64 {
        self.sources.iter_mut().map(|s| s.hollow_m(touch, reach_m)).sum()
    }

    fn beyond(&self, tile_m: [f64; 2]) -> Beyond {
        self.sources.iter().fold(Beyond::Same, |beyond, s| beyond.max(s.beyond(tile_m)))
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let n = path.len().min(MAX_BLOCK);
        let Some((first, rest)) = self.sources.split_first_mut() else {
            out.clear(n);
            return;
        };
        first.sample(path, out);
        for source in rest {
            source.sample(path, &mut self.part);
            for i in 0..n {
                out.height_m[i] += self.part.height_m[i];
                out.gradient[i][0] += self.part.gradient[i][0];
                out.gradient[i][1] += self.part.gradient[i][1];
                out.compliance_m_n[i] += self.part.compliance_m_n[i];
                out.answer.mix(i, 1.0, &self.part.answer, 1.0);
            }
        }
    }

    fn land(&mut self, touch: &Touch) {
        self.sources.iter_mut().for_each(|s| s.land(touch));
    }

    fn react(&mut self, touch: &Touch) -> Reaction {
        self.sources.iter_mut().fold(Reaction::default(), |sum, s| add(sum, s.react(touch), 1.0))
    }

    fn change(&mut self, change: &dyn Any, sample: u64) -> bool {
        self.sources.iter_mut().fold(false, |done, s| s.change(change, sample) | done)
    }

    fn visit(&mut self, see: &mut dyn FnMut(&mut dyn Any)) {
        self.sources.iter_mut().for_each(|source| source.visit(see));
    }
}

/// Changes the factor of a [`Scale`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaleTo(pub f64);

/// A source whose relief is multiplied by a factor that may change.
pub struct Scale {
    source: Source,
    factor: Fade<f64>,
}

impl Scale {
    /// The source times `factor`.
    ///
    /// # Errors
    /// When the factor is not within ±1e3.
    pub fn new(source: Source, factor: f64) -> Result<Self, DesignError> {
        Ok(Self { source, factor: Fade::new(check_factor(factor)?) })
    }
}

fn check_factor(factor: f64) -> Result<f64, DesignError> {
    limits::combined::FACTOR.check("factor", factor)
}

impl HeightField for Scale {
    fn prepare_tip(&mut self, radius_m: f64) {
        self.source.prepare_tip(radius_m);
    }

    fn ride(&mut self, radius_m: f64) {
        self.source.ride(radius_m);
    }

    fn lie_at(&mut self, at_m: &[[f64; 3]]) {
        self.source.lie_at(at_m);
    }

    fn carries_n(&mut self, position_m: [f64; 2], depth_m: f64) -> Option<f64> {
        self.source.carries_n(position_m, depth_m)
    }

    fn prepare(&mut self, setup: &Setup) -> Result<(), DesignError> {
        self.factor.prepare(setup.sample_rate_hz);
        self.source.prepare(setup)
    }

    fn band(&self) -> WavelengthBand {
        self.source.band()
    }

    fn is_read_beside(&self) -> bool {
        self.source.is_read_beside()
    }

    fn reach_m(&self) -> f64 {
        self.factor.target().abs() * self.source.reach_m()
    }

    fn add_local_power(&self, position_m: &[[f64; 2]], power_m2: &mut [f64]) {
        let mut own = [0.0; MAX_BLOCK];
        self.source.add_local_power(position_m, &mut own[..position_m.len().min(MAX_BLOCK)]);
        let factor = self.factor.target();
        power_m2.iter_mut().zip(&own).for_each(|(power, own)| *power += factor * factor * own);
    }

    fn hollow_m(&mut self, touch: &Touch, reach_m: f64) -> f64 {
        self.factor.at(touch.sample) * self.source.hollow_m(touch, reach_m)
    }

    fn beyond(&self, tile_m: [f64; 2]) -> Beyond {
        self.source.beyond(tile_m)
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        self.source.sample(path, out);
        for i in 0..path.len().min(MAX_BLOCK) {
            let factor = self.factor.at(path.first_sample + i as u64);
            out.height_m[i] *= factor;
            out.gradient[i] = out.gradient[i].map(|g| g * factor);
            out.answer.scale(i, factor);
        }
    }

    fn land(&mut self, touch: &Touch) {
        self.source.land(touch);
    }

    fn react(&mut self, touch: &Touch) -> Reaction {
        add(Reaction::default(), self.source.react(touch), self.factor.at(touch.sample))
    }

    fn change(&mut self, change: &dyn Any, sample: u64) -> bool {
        match change.downcast_ref() {
            Some(ScaleTo(factor)) => check_factor(*factor).map(|f| self.factor.set(f, sample)).is_ok(),
            None => self.source.change(change, sample),
        }
    }

    fn visit(&mut self, see: &mut dyn FnMut(&mut dyn Any)) {
        self.source.visit(see);
    }
}

/// Moves a [`Crossfade`]: 0 = all of the first source, 1 = all of the second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossfadeTo(pub f64);

/// From one source to another at run time.
pub struct Crossfade {
    sources: [Source; 2],
    position: Fade<f64>,
    /// When it moves to the second source by itself, s.
    at_s: Option<f64>,
    other: SurfaceBlock,
}

impl Crossfade {
    /// All of `first`; [`CrossfadeTo`] moves towards `second`.
    #[must_use]
    pub fn new(first: Source, second: Source) -> Self {
        let (position, other) = (Fade::new(0.0), SurfaceBlock::default());
        Self { sources: [first, second], position, at_s: None, other }
    }

    /// Moves to all of the second source by itself, once the engine has rendered so many seconds.
    #[must_use]
    pub fn at_s(self, at_s: f64) -> Self {
        Self { at_s: Some(at_s), ..self }
    }
}

impl HeightField for Crossfade {
    fn prepare_tip(&mut self, radius_m: f64) {
        self.sources.iter_mut().for_each(|source| source.prepare_tip(radius_m));
    }

    fn ride(&mut self, radius_m: f64) {
        self.sources.iter_mut().for_each(|source| source.ride(radius_m));
    }

    fn lie_at(&mut self, at_m: &[[f64; 3]]) {
        self.sources.iter_mut().for_each(|source| source.lie_at(at_m));
    }

    fn carries_n(&mut self, position_m: [f64; 2], depth_m: f64) -> Option<f64> {
        self.sources.iter_mut().find_map(|source| source.carries_n(position_m, depth_m))
    }

    fn prepare(&mut self, setup: &Setup) -> Result<(), DesignError> {
        self.position.prepare(setup.sample_rate_hz);
        if let Some(at_s) = self.at_s {
            self.position = Fade::new(0.0);
            self.position.prepare(setup.sample_rate_hz);
            self.position.set(1.0, (at_s * setup.sample_rate_hz).round() as u64);
        }
        self.sources.iter_mut().try_for_each(|source| source.prepare(setup))
    }

    fn band(&self) -> WavelengthBand {
        self.sources[0].band().union(self.sources[1].band())
    }

    fn is_read_beside(&self) -> bool {
        self.sources.iter().all(|s| s.is_read_beside())
    }

    fn reach_m(&self) -> f64 {
        self.sources[0].reach_m().max(self.sources[1].reach_m())
    }

    fn add_local_power(&self, position_m: &[[f64; 2]], power_m2: &mut [f64]) {
        self.sources.iter().for_each(|s| s.add_local_power(position_m, power_m2));
    }

    fn hollow_m(&mut self, touch: &Touch, reach_m: f64) -> f64 {
        let w = self.position.at(touch.sample);
        let [first, second] = &mut self.sources;
        (1.0 - w) * first.hollow_m(touch, reach_m) + w * second.hollow_m(touch, reach_m)
    }

    fn beyond(&self, tile_m: [f64; 2]) -> Beyond {
        self.sources[0].beyond(tile_m).max(self.sources[1].beyond(tile_m))
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let [first, second] = &mut self.sources;
        // Both are always read: a source that remembers its contacts must not miss any path.
        first.sample(path, out);
        second.sample(path, &mut self.other);
        for i in 0..path.len().min(MAX_BLOCK) {
            let w = self.position.at(path.first_sample + i as u64);
            mix(out, &self.other, i, w);
        }
    }

    fn land(&mut self, touch: &Touch) {
        self.sources.iter_mut().for_each(|s| s.land(touch));
    }

    fn react(&mut self, touch: &Touch) -> Reaction {
        let w = self.position.at(touch.sample);
        let [first, second] = &mut self.sources;
        add(add(Reaction::default(), first.react(touch), 1.0 - w), second.react(touch), w)
    }

    fn change(&mut self, change: &dyn Any, sample: u64) -> bool {
        if let Some(CrossfadeTo(position)) = change.downcast_ref() {
            let accepted = (0.0..=1.0).contains(position);
            if accepted {
                self.at_s = None;
                self.position.set(*position, sample);
            }
            return accepted;
        }
        self.sources.iter_mut().fold(false, |done, s| s.change(change, sample) | done)
    }

    fn visit(&mut self, see: &mut dyn FnMut(&mut dyn Any)) {
        self.sources.iter_mut().for_each(|source| source.visit(see));
    }
}
