//! Click: the short sound of a stiff body that a blow pushes as a whole (Qu & James 2019;
//! `dsp::radiation`).
//!
//! ```text
//! p(t) = p̂ cos(π t / τ), 0 ≤ t < τ        p̂ = click_pa(V, J / m, τ)
//! ```
//! J and τ are impulse and contact time of the blow, V and m volume and mass of the body. The sound
//! follows the jerk, and the force is taken as half a sine.

use asperity_dsp::hertz::HertzPulse;
use asperity_dsp::radiation::click_pa;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Below this a click is left out, in the unit of the modes: −94 dB of what is just heard in
/// silence where that is the pascal.
const SILENT: f64 = 4e-10;

/// A body that clicks: the field `click` of a modes file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Click {
    /// Volume of the body, m³.
    pub volume_m3: f64,
    /// Its mass, kg.
    pub mass_kg: f64,
    /// The unit of the modes over the pascal at 1 m.
    pub gain: f64,
}

impl Click {
    /// # Errors
    /// The field that no body can have, and what would be right.
    pub(crate) fn check(&self) -> Result<(), (&'static str, f64, &'static str)> {
        let within = |field, value: f64, most: f64, expected| {
            if value > 0.0 && value <= most { Ok(()) } else { Err((field, value, expected)) }
        };
        within("click.volume_m3", self.volume_m3, 1e6, "above 0, to 1e6 m³")?;
        within("click.mass_kg", self.mass_kg, 1e9, "above 0, to 1e9 kg")?;
        within("click.gain", self.gain, 1e12, "above 0, to 1e12")
    }

    /// Adds a blow's click to a ring of samples, a power of two of them.
    pub(crate) fn deposit(
        &self,
        pulse: &HertzPulse,
        ring: &mut [f32],
        sample: u64,
        offset: f64,
        sample_rate_hz: f64,
    ) {
        for part in pulse.elastic_parts() {
            let peak = self.peak(&part);
            let (mask, length) = (ring.len() - 1, part.contact_time_s * sample_rate_hz);
            // The mean over a sample, so that nothing is left when it is over, however short it is.
            let risen = |t: f64| length / PI * libm::sin(PI * (t / length).clamp(0.0, 1.0));
            for i in 0..Self::samples(&part, sample_rate_hz).min(ring.len() as u64) {
                let t = i as f64 - offset;
                ring[sample.wrapping_add(i) as usize & mask] += (peak * (risen(t + 1.0) - risen(t))) as f32;
            }
        }
    }

    /// Number of samples that a blow's click may touch; 0 where it is too faint.
    pub(crate) fn samples_of(&self, pulse: &HertzPulse, sample_rate_hz: f64) -> u64 {
        if self.peak(pulse).abs() < SILENT { 0 } else { Self::samples(pulse, sample_rate_hz) }
    }

    fn samples(pulse: &HertzPulse, sample_rate_hz: f64) -> u64 {
        (pulse.length_s() * sample_rate_hz).ceil() as u64 + 2
    }

    fn peak(&self, pulse: &HertzPulse) -> f64 {
        self.gain * click_pa(self.volume_m3, pulse.impulse_n_s / self.mass_kg, pulse.contact_time_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIE: Click = Click { volume_m3: 4.1e-6, mass_kg: 0.005, gain: 1.0 };

    #[test]
    fn a_die_clicks_as_its_closed_form_at_every_rate() {
        for rate_hz in [44_100.0, 96_000.0, 192_000.0] {
            for offset in [0.0, 0.3, 0.9] {
                let pulse = HertzPulse::elastic(0.004, 400e-6);
                let mut ring = [0.0_f32; 256];
                DIE.deposit(&pulse, &mut ring, 250, offset, rate_hz);
                let sum: f64 = ring.iter().map(|y| f64::from(*y)).sum();
                let peak = ring.iter().fold(0.0_f32, |peak, y| peak.max(y.abs()));
                let exact = click_pa(DIE.volume_m3, 0.004 / DIE.mass_kg, 400e-6);
                assert!(sum.abs() < 1e-5 * f64::from(peak), "{sum}");
                assert!((f64::from(peak) / exact - 1.0).abs() < 0.03, "{peak} of {exact} at {rate_hz} Hz");
            }
        }
    }

    #[test]
    fn a_soft_blow_is_left_out_and_impossible_bodies_are_refused() {
        let soft = HertzPulse::elastic(1e-9, 0.1);
        assert_eq!(DIE.samples_of(&soft, 44_100.0), 0);
        assert!(DIE.check().is_ok());
        assert_eq!(Click { mass_kg: f64::NAN, ..DIE }.check().unwrap_err().0, "click.mass_kg");
        assert_eq!(Click { volume_m3: 0.0, ..DIE }.check().unwrap_err().0, "click.volume_m3");
    }
}
