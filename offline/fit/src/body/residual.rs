//! Residual of a fit, the part that no mode explains: the attack's click, the room, the noise.
//!
//! Summarised so that a body can carry a short residual excitation: the level of the attack in
//! octave bands, one value every 5 ms over the first tenth of a second.

use asperity_fft::PowerSpectra;

/// Step of the envelope, s, and how many there are.
pub const STEP_S: f64 = 0.005;
const STEPS: usize = 20;
/// Lowest band's upper edge, Hz; the others double it.
const FIRST_EDGE_HZ: f64 = 250.0;

/// One band's envelope.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct BandEnvelope {
    /// Lower edge, Hz.
    pub low_hz: f64,
    /// Upper edge, Hz.
    pub high_hz: f64,
    /// Rms in steps of [`STEP_S`] from the onset.
    pub rms: Vec<f64>,
}

/// A short residual excitation: what a body plays at an impact besides its modes.
#[derive(Debug, Clone, PartialEq)]
pub struct Burst {
    /// Sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Samples from the onset on, faded out over their second half.
    pub samples: Vec<f64>,
}

impl Burst {
    /// The first `length_s` of `samples`.
    #[must_use]
    pub fn new(samples: &[f64], length_s: f64, sample_rate_hz: f64) -> Self {
        let count = ((length_s * sample_rate_hz) as usize).min(samples.len());
        let half = 0.5 * count as f64;
        let fade = |n: usize| {
            let x = ((n as f64 - half) / half.max(1.0)).max(0.0);
            0.5 + 0.5 * (std::f64::consts::PI * x).cos()
        };
        let samples = samples[..count].iter().enumerate().map(|(n, x)| x * fade(n)).collect();
        Self { sample_rate_hz, samples }
    }
}

/// The residual of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Residual {
    /// Recording minus modes, as long as the recording; before the onset the recording itself.
    pub samples: Vec<f64>,
    /// Its rms over the analysed part relative to the recording's, dB.
    pub level_db: f64,
    /// Rms of the first 5 ms relative to the recording's own there, dB: how much of the attack is
    /// no mode.
    pub attack_db: f64,
    /// Octave-band envelopes of the attack.
    pub bands: Vec<BandEnvelope>,
}

impl Residual {
    /// Summarises `samples`, the residual of `recording`, both analysed over `onset..end`.
    #[must_use]
    pub fn new(samples: Vec<f64>, recording: &[f64], onset: usize, end: usize, rate_hz: f64) -> Self {
        let attack = (onset + (STEP_S * rate_hz) as usize).min(end);
        let level = |to: usize| ratio_db(&samples[onset..to], &recording[onset..to]);
        let (level_db, attack_db) = (level(end), level(attack));
        let bands = band_envelopes(&samples[onset..end], rate_hz);
        Self { level_db, attack_db, bands, samples }
    }
}

/// Energy of `a` relative to `b`, dB; −300 when there is none.
#[must_use]
pub fn ratio_db(a: &[f64], b: &[f64]) -> f64 {
    let energy = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    (10.0 * (energy(a).max(1e-300) / energy(b).max(1e-300)).log10()).clamp(-300.0, 300.0)
}

fn band_envelopes(samples: &[f64], rate_hz: f64) -> Vec<BandEnvelope> {
    let step = ((STEP_S * rate_hz) as usize).max(8);
    let spectra = PowerSpectra::new(vec![1.0; step], step);
    let mut edges = vec![0.0];
    let mut edge = FIRST_EDGE_HZ;
    while edge < 0.5 * rate_hz {
        edges.push(edge);
        edge *= 2.0;
    }
    edges.push(0.5 * rate_hz);
    let mut bands: Vec<BandEnvelope> = edges
        .windows(2)
        .map(|pair| BandEnvelope { low_hz: pair[0], high_hz: pair[1], rms: Vec::new() })
        .collect();
    for frame in samples.chunks_exact(step).take(STEPS) {
        let powers = spectra.of(frame.iter().copied());
        let bin_hz = rate_hz / step as f64;
        for band in &mut bands {
            let power: f64 = (0..=step / 2)
                .filter(|&k| (band.low_hz..band.high_hz).contains(&(k as f64 * bin_hz)))
                .map(|k| if k == 0 || 2 * k == step { 1.0 } else { 2.0 } * powers[k])
                .sum();
            band.rms.push(power.sqrt() / step as f64);
        }
    }
    bands
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sinusoid_fills_its_own_band_only() {
        let samples: Vec<f64> = (0..4410)
            .map(|n| (2.0 * std::f64::consts::PI * 1400.0 * f64::from(n) / 44_100.0).sin())
            .collect();
        let residual = Residual::new(samples.clone(), &samples, 0, samples.len(), 44_100.0);
        assert!(residual.level_db.abs() < 1e-9);
        for band in &residual.bands {
            let expected = if (band.low_hz..band.high_hz).contains(&1400.0) { 0.707 } else { 0.0 };
            assert!((band.rms[3] - expected).abs() < 0.01, "{band:?}");
        }
    }
}
