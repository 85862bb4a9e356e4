//! Early samples: what the bank leaves out of the first samples of strikes and contacts
//! ([`asperity_dsp::modal_bank::FirstSamples`]), for the places of a body.
//!
//! A contact sends its force twice: spread for the bank, and as it is for what the bank leaves out. The forces of all contacts at a place
//! are added up sample by sample, and the last of them are remembered by the place, so that no split into blocks changes a sample.

use crate::model::modal_model::MAX_POSITIONS;
use crate::prepared::bank::{MODE_LEVELS, SheddingLevels};
use asperity_dsp::DesignError;
use asperity_dsp::modal_bank::{
    EARLY_HISTORY, FirstSamples, ForceTaps, LANES, MissingSamples, add_early_force,
};
use asperity_dsp::mode::Mode;
use asperity_texture::height_field::MAX_BLOCK;

/// What a contact sends to a body during a stretch.
#[derive(Clone, Copy)]
pub(crate) struct Sent<'a> {
    /// What reaches the bank, N·s.
    pub(crate) impulse_n_s: &'a [f64],
    /// Mean force × step, not spread and two samples earlier, N·s.
    pub(crate) force_n_s: &'a [f64],
}

/// Forces at one place.
pub(crate) struct EarlyForce {
    /// The last of the stretches before, then those of the present one.
    force_n_s: [f64; EARLY_HISTORY + MAX_BLOCK],
    /// Whether any of them may not be zero.
    busy: bool,
}

impl EarlyForce {
    pub(crate) const REST: Self = Self { force_n_s: [0.0; EARLY_HISTORY + MAX_BLOCK], busy: false };

    /// Adds what a contact sends during the present stretch.
    pub(crate) fn add(&mut self, force_n_s: &[f64], sign: f64) {
        self.busy = true;
        for (sum, x) in self.force_n_s[EARLY_HISTORY..].iter_mut().zip(force_n_s) {
            *sum += sign * x;
        }
    }

    /// Whether nothing is on its way.
    pub(crate) fn is_silent(&self) -> bool {
        !self.busy
    }

    /// Forgets everything.
    pub(crate) fn silence(&mut self) {
        *self = Self::REST;
    }

    /// Adds what is missing to the output of the present stretch.
    pub(crate) fn render(&self, taps: &ForceTaps, out: &mut [f32]) {
        if self.busy {
            add_early_force(taps, &self.force_n_s[..EARLY_HISTORY + out.len()], out);
        }
    }

    /// The stretch of `n` samples is over.
    pub(crate) fn end_stretch(&mut self, n: usize) {
        if self.busy {
            self.force_n_s.copy_within(n..n + EARLY_HISTORY, 0);
            self.force_n_s[EARLY_HISTORY..EARLY_HISTORY + n].fill(0.0);
            self.busy = self.force_n_s[..EARLY_HISTORY].iter().any(|x| *x != 0.0);
        }
    }
}

/// What the bank leaves out of the forces of one stretch, until it is added to what the body sounds like.
pub(crate) struct EarlySamples {
    samples: [f32; MAX_BLOCK],
    open: bool,
}

impl EarlySamples {
    pub(crate) const NONE: Self = Self { samples: [0.0; MAX_BLOCK], open: false };

    /// The `n` samples of the present stretch, to be added to.
    pub(crate) fn open(&mut self, n: usize) -> &mut [f32] {
        if !std::mem::replace(&mut self.open, true) {
            self.samples[..n].fill(0.0);
        }
        &mut self.samples[..n]
    }

    /// Adds them, once.
    pub(crate) fn add_to(&mut self, out: &mut [f32]) {
        if std::mem::take(&mut self.open) {
            out.iter_mut().zip(&self.samples).for_each(|(y, x)| *y += x);
        }
    }
}

/// What a bank of these modes leaves out of the first samples of a strike, for each place and each level of modes left out.
pub(crate) fn first_samples(
    modes: &[(Mode, [f32; MAX_POSITIONS])],
    places: usize,
    levels: &SheddingLevels,
    sample_rate_hz: f64,
) -> Result<Vec<[FirstSamples; MODE_LEVELS]>, DesignError> {
    let mut sums = vec![MissingSamples::NOTHING; places];
    let mut all = vec![[FirstSamples::NOTHING; MODE_LEVELS]; places];
    for (group, modes) in modes.chunks(LANES).enumerate() {
        for (mode, shares) in modes {
            let missing = MissingSamples::of(mode, sample_rate_hz)?;
            for (sum, share) in sums.iter_mut().zip(shares) {
                sum.add(&missing, f64::from(*share));
            }
        }
        for level in (0..MODE_LEVELS).filter(|level| levels[*level] == group + 1) {
            for (place, sum) in all.iter_mut().zip(&sums) {
                place[level] = sum.first_samples();
            }
        }
    }
    Ok(all)
}
