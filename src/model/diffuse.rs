//! Diffuse part of a body: bands of noise between and above its modes, or in their place.
//!
//! A band answers a strike of the model's `impulse_n_s` with noise around `centre_hz` under an
//! envelope of one or two exponentials ([`asperity_dsp::diffuse`]); it scales as a mode does with
//! the impulse, the size and the material, and strokes excite it.

use asperity_dsp::damping::Damping;
pub use asperity_dsp::diffuse::DiffusePart;
use serde::{Deserialize, Serialize};

/// Most bands a body may have.
pub const MAX_BANDS: usize = 64;

/// A table of bands.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Diffuse {
    /// Origin of its numbers; free text.
    #[serde(default)]
    pub source: String,
    /// The bands, in any order.
    pub bands: Vec<DiffuseBand>,
}

/// A band of noise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DiffuseBand {
    /// Centre, Hz.
    pub centre_hz: f64,
    /// Equivalent rectangular width, Hz.
    pub width_hz: f64,
    /// One or two exponentials of its envelope, whose amplitudes add. `energy` is ∫ y² dt of the
    /// part alone after a strike of the model's `impulse_n_s`.
    pub parts: Vec<DiffusePart>,
}

impl DiffuseBand {
    /// Amplitude of its envelope at the strike.
    pub(crate) fn amplitude(&self) -> f64 {
        self.parts.iter().map(|part| (4.0 * part.decay_per_s * part.energy).sqrt()).sum()
    }
}

impl Diffuse {
    /// The field that is wrong, its value and what would be accepted.
    pub(crate) fn check(&self) -> Result<(), (String, f64, &'static str)> {
        if self.bands.len() > MAX_BANDS {
            return Err(("diffuse.bands".into(), self.bands.len() as f64, "at most 64 bands"));
        }
        for (i, band) in self.bands.iter().enumerate() {
            let within = |field: &str, value: f64, (low, high): (f64, f64), expected| {
                if value >= low && value <= high {
                    Ok(())
                } else {
                    Err((format!("diffuse.bands[{i}].{field}"), value, expected))
                }
            };
            within("centre_hz", band.centre_hz, (1.0, 1e6), "1–1e6 Hz")?;
            within("width_hz", band.width_hz, (1.0, 1e6), "1–1e6 Hz")?;
            within("parts", band.parts.len() as f64, (1.0, 2.0), "one or two parts")?;
            for part in &band.parts {
                within("energy", part.energy, (0.0, 1e18), "0–1e18")?;
                within("decay_per_s", part.decay_per_s, (0.1, 1e5), "0.1–1e5 1/s")?;
            }
        }
        Ok(())
    }

    /// Every band `gain` times as strong.
    pub(crate) fn scale(&mut self, gain: f64) {
        let parts = self.bands.iter_mut().flat_map(|band| &mut band.parts);
        parts.for_each(|part| part.energy *= gain * gain);
    }

    /// Body `size` times as large: every band lower by `size`, at the same amplitude, and its
    /// decays as much longer or shorter as those of modes there.
    pub(crate) fn resize(&mut self, size: f64, damping: Damping) {
        for band in &mut self.bands {
            let own_per_s = damping.decay_per_s(band.centre_hz);
            band.centre_hz /= size;
            band.width_hz /= size;
            if own_per_s > 0.0 {
                let ratio = damping.decay_per_s(band.centre_hz) / own_per_s;
                for part in &mut band.parts {
                    part.decay_per_s *= ratio;
                    part.energy /= ratio;
                }
            }
        }
    }
}
