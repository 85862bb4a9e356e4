//! Band split: the long waves of one surface and the short waves of another.
//!
//! ```text
//! h = w₁ · coarse(h₁) + w₂ · (h₂ − coarse(h₂))
//! ```
//! coarse(h) is what a source gives to a footprint of half the wavelength.

use super::{Source, add, check_factor};
use crate::fade::Fade;
use crate::height_field::{
    Beyond, HeightField, MAX_BLOCK, PathBlock, Reaction, Setup, SurfaceBlock, Touch, WavelengthBand,
};
use asperity_dsp::DesignError;
use std::any::Any;

/// Changes the weights of a [`BandSplit`]: below and above its wavelength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandWeights(pub [f64; 2]);

/// The long wavelengths of one source and the short wavelengths of another.
pub struct BandSplit {
    coarse: Source,
    fine: Source,
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
        Ok(Self { coarse, fine, wavelength_m, weights, low, all })
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
    fn prepare_tip(&mut self, radius_m: f64) {
        [&mut self.coarse, &mut self.fine].into_iter().for_each(|source| source.prepare_tip(radius_m));
    }

    fn ride(&mut self, radius_m: f64) {
        [&mut self.coarse, &mut self.fine].into_iter().for_each(|source| source.ride(radius_m));
    }

    fn lie_at(&mut self, at_m: &[[f64; 3]]) {
        [&mut self.coarse, &mut self.fine].into_iter().for_each(|source| source.lie_at(at_m));
    }

    fn carries_n(&mut self, position_m: [f64; 2], depth_m: f64) -> Option<f64> {
        self.coarse.carries_n(position_m, depth_m)
    }

    fn prepare(&mut self, setup: &Setup) -> Result<(), DesignError> {
        self.weights.prepare(setup.sample_rate_hz);
        self.coarse.prepare(setup)?;
        self.fine.prepare(setup)
    }

    fn band(&self) -> WavelengthBand {
        let (coarse, fine) = (self.coarse.band(), self.fine.band());
        WavelengthBand {
            shortest_m: coarse.shortest_m.max(self.wavelength_m).min(fine.shortest_m),
            longest_m: coarse.longest_m.max(fine.longest_m.min(self.wavelength_m)),
        }
    }

    fn reach_m(&self) -> f64 {
        self.coarse.reach_m() + 2.0 * self.fine.reach_m()
    }

    fn hollow_m(&mut self, touch: &Touch, reach_m: f64) -> f64 {
        let [low, _] = self.weights_at(touch.sample);
        low * self.coarse.hollow_m(touch, reach_m)
    }

    fn beyond(&self, tile_m: [f64; 2]) -> Beyond {
        self.coarse.beyond(tile_m).max(self.fine.beyond(tile_m))
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let n = path.len().min(MAX_BLOCK);
        let mut blunt = [0.5 * self.wavelength_m; MAX_BLOCK];
        for (blunt, &footprint) in blunt.iter_mut().zip(path.footprint_m) {
            *blunt = blunt.max(footprint);
        }
        let blunt = PathBlock { footprint_m: &blunt[..n], ..*path };
        self.coarse.sample(&blunt, out);
        self.fine.sample(&blunt, &mut self.low);
        self.fine.sample(path, &mut self.all);
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

    fn land(&mut self, touch: &Touch) {
        self.coarse.land(touch);
        self.fine.land(touch);
    }

    fn react(&mut self, touch: &Touch) -> Reaction {
        let [low, high] = self.weights_at(touch.sample);
        add(add(Reaction::default(), self.coarse.react(touch), low), self.fine.react(touch), high)
    }

    fn change(&mut self, change: &dyn Any, sample: u64) -> bool {
        if let Some(BandWeights(weights)) = change.downcast_ref() {
            let accepted = weights.iter().all(|&w| check_factor(w).is_ok());
            if accepted {
                self.weights.set(*weights, sample);
            }
            return accepted;
        }
        let coarse = self.coarse.change(change, sample);
        self.fine.change(change, sample) | coarse
    }

    fn visit(&mut self, see: &mut dyn FnMut(&mut dyn Any)) {
        self.coarse.visit(see);
        self.fine.visit(see);
    }
}
