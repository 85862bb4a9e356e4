//! Band split: the long waves of one surface and the short waves of another.
//!
//! ```text
//! h = w₁ · coarse(h₁) + w₂ · (h₂ − coarse(h₂))
//! ```
//! coarse(h) is what a source gives to a footprint of half the wavelength.

use super::{Source, check_factor, shared};
use crate::fade::Fade;
use crate::height_field::{
    HeightField, MAX_BLOCK, Part, PathBlock, PowerKind, Properties, Setup, Shares, SurfaceBlock, Touch,
    TouchKind, WavelengthBand, prepare_parts, set_parts,
};
use asperity_dsp::DesignError;
use std::any::Any;

/// Changes the weights of a [`BandSplit`]: below and above its wavelength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandWeights(pub [f64; 2]);

/// The long wavelengths of one source and the short wavelengths of another.
pub struct BandSplit {
    /// Coarse, fine.
    sources: [Source; 2],
    wavelength_m: f64,
    weights: Fade<[f64; 2]>,
    low: SurfaceBlock,
    all: SurfaceBlock,
}

impl BandSplit {
    /// `coarse` above `wavelength_m` plus `fine` below it. What a source has above a wavelength is
    /// what it gives to a footprint of half that wavelength; the source's own anti-aliasing is the
    /// filter, about an octave wide.
    ///
    /// # Errors
    /// When the wavelength is not within 1e-6 to 1 m.
    pub fn new(coarse: Source, fine: Source, wavelength_m: f64) -> Result<Self, DesignError> {
        let range = |w: f64| (1e-6..=1.0).contains(&w);
        DesignError::check("wavelength_m", wavelength_m, "1e-6 to 1 m", range)?;
        let weights = Fade::new([1.0; 2]);
        let (low, all) = (SurfaceBlock::default(), SurfaceBlock::default());
        Ok(Self { sources: [coarse, fine], wavelength_m, weights, low, all })
    }

    fn weights_at(&self, sample: u64) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for (w, values) in self.weights.weights(sample).iter().zip(self.weights.values()) {
            if *w != 0.0 {
                sum = [sum[0] + w * values[0], sum[1] + w * values[1]];
            }
        }
        sum
    }
}

impl HeightField for BandSplit {
    fn properties(&self, tile_m: [f64; 2]) -> Properties {
        let [coarse, fine] = self.sources.each_ref().map(|source| source.properties(tile_m));
        let band = WavelengthBand {
            shortest_m: coarse.band.shortest_m.max(self.wavelength_m).min(fine.band.shortest_m),
            longest_m: coarse.band.longest_m.max(fine.band.longest_m.min(self.wavelength_m)),
        };
        let reach_m = coarse.reach_m + 2.0 * fine.reach_m;
        Properties { band, reach_m, ..coarse.union(fine) }
    }

    fn prepare(&mut self, setup: &Setup<'_>) -> Result<(), DesignError> {
        self.weights.prepare(setup.sample_rate_hz);
        prepare_parts(&mut self.sources, setup)
    }

    fn parts(&mut self) -> &mut [Part] {
        &mut self.sources
    }

    /// The coarse part alone carries a tip.
    fn shares(&mut self, touch: &Touch) -> Shares {
        let [low, high] = match touch.kind {
            TouchKind::Stands { .. } => [1.0, 0.0],
            TouchKind::Begins | TouchKind::Presses => self.weights_at(touch.sample),
        };
        shared([(*touch, low), (*touch, high)])
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let n = path.len().min(MAX_BLOCK);
        let mut blunt = [0.5 * self.wavelength_m; MAX_BLOCK];
        for (blunt, &footprint) in blunt.iter_mut().zip(path.footprint_m) {
            *blunt = blunt.max(footprint);
        }
        let blunt = PathBlock { footprint_m: &blunt[..n], full_power_m2: None, ..*path };
        let [coarse, fine] = &mut self.sources;
        coarse.sample(&blunt, out);
        fine.sample(&blunt, &mut self.low);
        fine.sample(path, &mut self.all);
        out.power.kind = PowerKind::Full;
        for i in 0..n {
            let [low, high] = self.weights_at(path.first_sample + i as u64);
            out.height_m[i] = low * out.height_m[i] + high * (self.all.height_m[i] - self.low.height_m[i]);
            for a in 0..2 {
                out.gradient[i][a] =
                    low * out.gradient[i][a] + high * (self.all.gradient[i][a] - self.low.gradient[i][a]);
            }
            out.answer.mix(i, low, &self.all.answer, high);
            out.answer.mix(i, 1.0, &self.low.answer, -high);
        }
    }

    fn set(&mut self, change: &dyn Any, sample: u64) -> bool {
        if let Some(BandWeights(weights)) = change.downcast_ref() {
            let accepted = weights.iter().all(|&w| check_factor(w).is_ok());
            if accepted {
                self.weights.set(*weights, sample);
            }
            return accepted;
        }
        set_parts(&mut self.sources, change, sample)
    }
}

crate::opaque::debug_by_name!(BandSplit);
