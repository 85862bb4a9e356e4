//! Engine presets: how much work the engine spends on being exact, as data in one place.
//!
//! | preset | contact | inner samples a sample | modes |
//! |---|---|---|---|
//! | `fast` | energy-conserving | 1 | those that a published masking model hides are left out |
//! | `default` | exact between events | 1 | all within 120 dB of the loudest |
//! | `accurate` | exact between events | 8 | all |
//!
//! The cost of each, and its distance from the whole chain in f64 at 16 times the rate, are printed
//! by `asperity report`. `fast` takes 0.85 of the instructions of `default` on a contact that is
//! pressed firmly, 0.65 of the time on the report's cases, where `default` looks at the ground
//! between samples, and less where tables of modes are dense. Its levels are right (third octaves
//! of the demo's scenes: 0.1 dB off in the median, 3.3 at most), its waveforms are not where a
//! pad hops: for phones and crowds. Relief, path, map, bank and exciters are half of either; a
//! second, coarser kind of those is not worth owning.

use crate::model::config::Config;
use asperity_dsp::micro_contact::Integrator;
use asperity_dsp::modal_bank::Culling;

/// Accuracy of an engine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Preset {
    /// Many contacts at the lowest cost: right levels, other waveforms.
    Fast,
    /// Settings of [`Config::default`].
    #[default]
    Default,
    /// For renders that nobody waits for, and to see what the others leave out.
    Accurate,
}

/// Settings of a preset.
struct Settled {
    name: &'static str,
    integrator: Integrator,
    oversampling: usize,
    culling: Option<Culling>,
}

impl Preset {
    /// From the fastest to the most exact.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Default, Self::Accurate];

    const fn settled(self) -> Settled {
        match self {
            Self::Fast => Settled {
                name: "fast",
                integrator: Integrator::EnergyConserving,
                oversampling: 1,
                culling: Some(Culling { level_db: 80.0, masking: true, loudest_db_spl: 80.0 }),
            },
            Self::Default => Settled {
                name: "default",
                integrator: Integrator::ExactEvent,
                oversampling: 1,
                culling: Some(Culling::NEGLIGIBLE),
            },
            Self::Accurate => Settled {
                name: "accurate",
                integrator: Integrator::ExactEvent,
                oversampling: 8,
                culling: None,
            },
        }
    }

    /// As it is written on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.settled().name
    }

    /// The preset of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name() == name)
    }
}

impl Config {
    /// Engine as exact as a preset says: integrator, inner samples and modes; nothing else changes.
    ///
    /// ```
    /// use asperity::{Config, Preset};
    ///
    /// let config = Config { seed: 7, ..Config::default() };
    /// assert_eq!(config.clone().preset(Preset::Default), config);
    /// assert!(config.preset(Preset::Accurate).inner_rate_hz() > 352e3);
    /// ```
    #[must_use]
    pub fn preset(self, preset: Preset) -> Self {
        let Settled { integrator, oversampling, culling, .. } = preset.settled();
        Self { integrator, oversampling, culling, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_preset_changes_nothing_and_every_preset_builds() {
        for preset in Preset::ALL {
            assert_eq!(Preset::from_name(preset.name()), Some(preset));
            assert!(Config::default().preset(preset).build().is_ok());
        }
        assert_eq!(Config::default().preset(Preset::Default), Config::default());
        assert_eq!(Preset::from_name("best"), None);
    }
}
