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

use crate::fade::Fade;
use crate::height_field::{
    HeightField, MAX_BLOCK, Part, PathBlock, PowerKind, Properties, Setup, Shares, SurfaceBlock, Touch,
    TouchKind, WavelengthBand, prepare_parts, set_parts,
};
use asperity_dsp::{DesignError, limits};
use mixture::mix;
use std::any::Any;

/// A surface of any kind.
pub type Source = Part;

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
    fn properties(&self, tile_m: [f64; 2]) -> Properties {
        let each = self.sources.iter().map(|source| source.properties(tile_m));
        let reach_m = each.clone().map(|properties| properties.reach_m).sum();
        let nothing = Properties { is_stateless: true, ..Properties::of(WavelengthBand::EMPTY) };
        Properties { reach_m, ..each.fold(nothing, Properties::union) }
    }

    fn parts(&mut self) -> &mut [Part] {
        &mut self.sources
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
            out.power.add(&self.part.power, n);
        }
    }
}

/// Changes the factor of a [`Scale`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaleTo(pub f64);

/// A source whose relief is multiplied by a factor that may change.
pub struct Scale {
    source: [Source; 1],
    factor: Fade<f64>,
}

impl Scale {
    /// The source times `factor`.
    ///
    /// # Errors
    /// When the factor is not within ±1e3.
    pub fn new(source: Source, factor: f64) -> Result<Self, DesignError> {
        Ok(Self { source: [source], factor: Fade::new(check_factor(factor)?) })
    }
}

fn check_factor(factor: f64) -> Result<f64, DesignError> {
    limits::combined::FACTOR.check("factor", factor)
}

impl HeightField for Scale {
    fn properties(&self, tile_m: [f64; 2]) -> Properties {
        let own = self.source[0].properties(tile_m);
        Properties { reach_m: self.factor.target().abs() * own.reach_m, is_rigid: false, ..own }
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let n = path.len().min(MAX_BLOCK);
        let square = self.factor.target() * self.factor.target();
        let full_power_m2 = path.full_power_m2.map(|full_m2| full_m2 / square);
        self.source[0].sample(&PathBlock { full_power_m2, ..*path }, out);
        for i in 0..n {
            let factor = self.factor.at(path.first_sample + i as u64);
            out.height_m[i] *= factor;
            out.gradient[i] = out.gradient[i].map(|g| g * factor);
            out.answer.scale(i, factor);
        }
        if square == 0.0 {
            out.power.kind = PowerKind::None;
        }
        out.power.each_m2[..n].iter_mut().for_each(|power_m2| *power_m2 *= square);
    }

    fn prepare(&mut self, setup: &Setup<'_>) -> Result<(), DesignError> {
        self.factor.prepare(setup.sample_rate_hz);
        prepare_parts(&mut self.source, setup)
    }

    fn set(&mut self, change: &dyn Any, sample: u64) -> bool {
        match change.downcast_ref() {
            Some(ScaleTo(factor)) => check_factor(*factor).map(|f| self.factor.set(f, sample)).is_ok(),
            None => set_parts(&mut self.source, change, sample),
        }
    }

    fn parts(&mut self) -> &mut [Part] {
        &mut self.source
    }

    /// Force that carries a tip, which does not depend on the factor.
    fn shares(&mut self, touch: &Touch) -> Shares {
        let stands = matches!(touch.kind, TouchKind::Stands { .. });
        shared([(*touch, if stands { 1.0 } else { self.factor.at(touch.sample) })])
    }
}

/// The shares of the first parts of a combination.
pub(crate) fn shared<const N: usize>(each: [(Touch, f64); N]) -> Shares {
    std::array::from_fn(|part| each.get(part).map(|(touch, weight)| (part, *touch, *weight)))
}

/// Moves a [`Crossfade`]: 0 = all of the first source, 1 = all of the second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossfadeTo(pub f64);

/// From one source to another at run time.
pub struct Crossfade {
    sources: [Source; 2],
    position: Fade<f64>,
    /// Time at which it moves to the second source by itself, s.
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
    fn properties(&self, tile_m: [f64; 2]) -> Properties {
        self.sources[0].properties(tile_m).union(self.sources[1].properties(tile_m))
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let [first, second] = &mut self.sources;
        // Both are always read: a source that remembers its contacts must not miss any path.
        first.sample(path, out);
        second.sample(path, &mut self.other);
        let n = path.len().min(MAX_BLOCK);
        for i in 0..n {
            let w = self.position.at(path.first_sample + i as u64);
            mix(out, &self.other, i, w);
        }
        out.power.add(&self.other.power, n);
    }

    fn prepare(&mut self, setup: &Setup<'_>) -> Result<(), DesignError> {
        self.position.prepare(setup.sample_rate_hz);
        if let Some(at_s) = self.at_s {
            self.position = Fade::new(0.0);
            self.position.prepare(setup.sample_rate_hz);
            self.position.set(1.0, (at_s * setup.sample_rate_hz).round() as u64);
        }
        prepare_parts(&mut self.sources, setup)
    }

    fn set(&mut self, change: &dyn Any, sample: u64) -> bool {
        if let Some(CrossfadeTo(position)) = change.downcast_ref() {
            let accepted = (0.0..=1.0).contains(position);
            if accepted {
                self.at_s = None;
                self.position.set(*position, sample);
            }
            return accepted;
        }
        set_parts(&mut self.sources, change, sample)
    }

    fn parts(&mut self) -> &mut [Part] {
        &mut self.sources
    }

    fn shares(&mut self, touch: &Touch) -> Shares {
        let w = self.position.at(touch.sample);
        shared([(*touch, 1.0 - w), (*touch, w)])
    }
}

crate::opaque::debug_by_name!(Sum, Scale, Crossfade);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid_materials::SolidMaterial;
    use crate::solid_noise::SolidNoise;

    #[test]
    fn a_source_scaled_by_a_factor_reaches_as_many_times_as_far() {
        let reach_m = |factor| {
            let source = SolidNoise::new(SolidMaterial::Sand.parameters(), 11).unwrap();
            Scale::new(Box::new(source), factor).unwrap().properties([1.0; 2]).reach_m
        };
        assert!(reach_m(1.0) > 0.0);
        assert_eq!(reach_m(-3.0), 3.0 * reach_m(1.0));
    }
}
