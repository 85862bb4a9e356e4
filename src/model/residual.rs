//! Residual burst of a recorded strike: the striker's click, the first rush of a thousand modes.
//!
//! A body may carry a *residual*, a short burst of samples that belongs to a strike of the model's
//! `impulse_n_s` as its modes do. Every impact plays it once from the sample in which the contact
//! begins,
//!
//! ```text
//! audio[n] += J / impulse_n_s · burst[n − n₀]
//! ```
//! linear as the modes are. Strokes do not: they send an impulse a sample, and the residual is what
//! *one* strike leaves. The burst is brought to the engine's rate when the body is added, on the
//! game thread; on the audio thread it is read and added: no heap, the same bits for any blocks.

use asperity_dsp::bessel::bessel_i0;
use serde::{Deserialize, Serialize};

/// Longest burst, s.
pub const LONGEST_S: f64 = 0.5;

/// Half width of the interpolation kernel, in zero crossings, and its Kaiser window's β: −90 dB.
const ZERO_CROSSINGS: f64 = 24.0;
const KAISER_BETA: f64 = 9.0;
/// Share of the narrower band that is kept.
const PASS_BAND: f64 = 0.96;

/// A short residual: what a strike of the model's impulse sounds like besides the modes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Residual {
    /// Rate of `samples`, Hz.
    pub sample_rate_hz: f64,
    /// Sample values from the begin of the contact on, on the scale of the modes' amplitudes.
    pub samples: Vec<f32>,
}

impl Residual {
    /// The field that is wrong, its value and what would be accepted.
    pub(crate) fn check(&self) -> Result<(), (&'static str, f64, &'static str)> {
        if !(1e3..=1e6).contains(&self.sample_rate_hz) {
            return Err(("residual.sample_rate_hz", self.sample_rate_hz, "1e3–1e6 Hz"));
        }
        if self.seconds() > LONGEST_S {
            return Err(("residual.samples", self.seconds(), "at most 0.5 s of samples"));
        }
        match self.samples.iter().find(|x| !(-1e9..=1e9).contains(*x)) {
            Some(bad) => Err(("residual.samples", f64::from(*bad), "finite, within ±1e9")),
            None => Ok(()),
        }
    }

    /// Length, s.
    pub(crate) fn seconds(&self) -> f64 {
        self.samples.len() as f64 / self.sample_rate_hz
    }

    /// Part of the burst below `highest_hz`, if it has more.
    pub(crate) fn below(&self, highest_hz: f64) -> Self {
        if self.sample_rate_hz <= 2.0 * highest_hz {
            return self.clone();
        }
        Self { sample_rate_hz: 2.0 * highest_hz, samples: self.at_rate(2.0 * highest_hz).into_vec() }
    }

    /// The burst at another rate, by a Kaiser-windowed sinc.
    #[must_use]
    pub(crate) fn at_rate(&self, rate_hz: f64) -> Box<[f32]> {
        if rate_hz == self.sample_rate_hz || self.samples.is_empty() {
            return self.samples.clone().into();
        }
        let step = self.sample_rate_hz / rate_hz;
        let cutoff = PASS_BAND * step.recip().min(1.0);
        let reach = ZERO_CROSSINGS / cutoff;
        let count = (self.samples.len() as f64 / step).ceil() as usize;
        let last = self.samples.len() as f64 - 1.0;
        let at = |n: usize| {
            let centre = n as f64 * step;
            let (from, to) = ((centre - reach).ceil().max(0.0), (centre + reach).floor().min(last));
            (from as usize..=to.max(0.0) as usize)
                .map(|k| f64::from(self.samples[k]) * kernel(k as f64 - centre, cutoff, reach))
                .sum::<f64>() as f32
        };
        (0..count).map(at).collect()
    }
}

/// Low-pass of `cutoff` (of the source's Nyquist frequency) within ± `reach` samples.
fn kernel(x: f64, cutoff: f64, reach: f64) -> f64 {
    let angle = std::f64::consts::PI * cutoff * x;
    let sinc = if angle.abs() < 1e-9 { 1.0 } else { libm::sin(angle) / angle };
    let edge = (1.0 - (x / reach).powi(2)).max(0.0).sqrt();
    cutoff * sinc * bessel_i0(KAISER_BETA * edge) / bessel_i0(KAISER_BETA)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn click() -> Residual {
        let at = |n: i32| (0.2 * f64::from(n)).sin() * (-0.01 * f64::from(n)).exp();
        Residual { sample_rate_hz: 44_100.0, samples: (0..900).map(|n| at(n) as f32).collect() }
    }

    #[test]
    fn another_rate_keeps_the_sound() {
        for rate_hz in [22_050.0, 48_000.0, 96_000.0] {
            let there = click().at_rate(rate_hz);
            let seconds = there.len() as f64 / rate_hz;
            assert!((seconds - 900.0 / 44_100.0).abs() < 1e-4);
            // Away from the begin, where the click's own step is band-limited too.
            for n in 200..there.len() - 200 {
                let t = n as f64 / rate_hz * 44_100.0;
                let exact = (0.2 * t).sin() * (-0.01 * t).exp();
                assert!((f64::from(there[n]) - exact).abs() < 2e-3, "{rate_hz}: {n} {} {exact}", there[n]);
            }
        }
        assert_eq!(&*click().at_rate(44_100.0), click().samples.as_slice());
    }
}
