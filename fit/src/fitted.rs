//! What a fit returns: modes with their standard deviations, and what can be said about the rest.

use crate::contact::rise;
use crate::partial::Partial;
use crate::pruning::Uncertainty;
use crate::residual::{Burst, Residual};
use asperity_dsp::mode::Mode;
use std::f64::consts::PI;
use std::fmt;

/// Slowest decay a mode may have, 1/s: T60 = 60 s.
pub const LEAST_DECAY_PER_S: f64 = 0.115;

/// One mode of the struck body as the recording shows it:
/// `amplitude · e^(−decay_per_s t) · sin(2π frequency_hz t + phase_rad)`, t from the onset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedMode {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Decay rate, 1/s.
    pub decay_per_s: f64,
    /// Amplitude at the onset, full scale 1.
    pub amplitude: f64,
    /// Phase at the onset, −π to π.
    pub phase_rad: f64,
    /// Standard deviation of `frequency_hz`.
    pub frequency_std_hz: f64,
    /// Standard deviation of `decay_per_s`.
    pub decay_std_per_s: f64,
    /// Standard deviation of `amplitude`.
    pub amplitude_std: f64,
    /// Standard deviation of `phase_rad`.
    pub phase_std_rad: f64,
    /// Energy in the analysed part: ∫ y² dt, s.
    pub energy: f64,
}

impl FittedMode {
    /// The engine's mode.
    #[must_use]
    pub fn mode(&self) -> Mode {
        Mode {
            frequency_hz: self.frequency_hz,
            decay_per_s: self.decay_per_s,
            amplitude: self.amplitude,
            phase_rad: self.phase_rad,
        }
    }

    /// From a partial whose amplitude stands `offset` samples after the onset.
    pub(crate) fn new(
        partial: &Partial,
        uncertainty: &Uncertainty,
        offset: usize,
        count: usize,
        rate_hz: f64,
    ) -> Self {
        let at_onset = partial.moved(-(offset as f64));
        let growth = at_onset.c.norm() / partial.c.norm().max(1e-300);
        Self {
            frequency_hz: partial.omega * rate_hz / (2.0 * PI),
            decay_per_s: (partial.delta * rate_hz).max(LEAST_DECAY_PER_S),
            amplitude: at_onset.c.norm(),
            // Re(c z^n) is a cosine.
            phase_rad: wrapped(at_onset.c.arg() + 0.5 * PI),
            frequency_std_hz: uncertainty.omega * rate_hz / (2.0 * PI),
            decay_std_per_s: uncertainty.delta * rate_hz,
            amplitude_std: uncertainty.amplitude * growth,
            phase_std_rad: uncertainty.phase,
            energy: partial.energy(count) / rate_hz,
        }
    }
}

fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(2.0 * PI) - PI
}

/// Something about the recording, or about its modes, that the user should know.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// Samples stuck at full scale.
    Clipped {
        /// How many.
        samples: usize,
    },
    /// The file breaks off.
    Truncated,
    /// Another strike; the analysis ends before it.
    SecondStrike {
        /// Its onset, s of the file.
        at_s: f64,
    },
    /// Too little sound for accurate modes.
    TooShort {
        /// Length analysed, s.
        length_s: f64,
    },
    /// Only a part of a long file was read.
    PartOfFile {
        /// From, s of the file.
        from_s: f64,
        /// To, s of the file.
        to_s: f64,
    },
    /// No mode stands above the noise.
    NoModes,
    /// There is more than the allowed number of modes.
    ModesCapped {
        /// The limit.
        limit: usize,
    },
    /// A mode that does not decay within the recording; its decay is the least one allowed.
    Undamped {
        /// Its frequency.
        frequency_hz: f64,
    },
    /// A mains hum, left out of the modes.
    Hum {
        /// Its frequency.
        frequency_hz: f64,
    },
    /// A strong mode whose decay no exponential describes.
    NotExponential {
        /// Its frequency.
        frequency_hz: f64,
        /// What is left of it, relative to it, dB.
        left_db: f64,
    },
    /// Modes explain little of the recording.
    PoorFit {
        /// Resynthesis against recording, dB.
        snr_db: f64,
    },
    /// The recording has a strong constant part, removed.
    Offset {
        /// Mean, full scale 1.
        mean: f64,
    },
    /// Two modes all but cancel each other.
    Cancelling {
        /// Frequency of the stronger.
        frequency_hz: f64,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Clipped { samples } => {
                write!(f, "clipping: {samples} samples are stuck at full scale; record it less loudly")
            }
            Self::Truncated => write!(f, "truncated: the file ends before its header says"),
            Self::SecondStrike { at_s } => {
                write!(f, "second strike: another strike at {at_s:.3} s; only the first is analysed")
            }
            Self::TooShort { length_s } => write!(
                f,
                "too short: {:.1} ms of sound; the standard deviations say what it is worth",
                1e3 * length_s
            ),
            Self::PartOfFile { from_s, to_s } => {
                write!(f, "long file: only {from_s:.1} s to {to_s:.1} s is analysed")
            }
            Self::NoModes => write!(f, "no modes: nothing stands above the noise"),
            Self::ModesCapped { limit } => {
                write!(f, "mode limit: more than {limit} modes are there; the strongest are kept")
            }
            Self::Undamped { frequency_hz } => {
                write!(f, "undamped: {frequency_hz:.1} Hz does not decay within the recording")
            }
            Self::Hum { frequency_hz } => write!(f, "hum: {frequency_hz:.1} Hz is left out as mains hum"),
            Self::NotExponential { frequency_hz, left_db } => write!(
                f,
                "not exponential: the decay at {frequency_hz:.1} Hz is no exponential ({left_db:.0} dB of it remain)"
            ),
            Self::PoorFit { snr_db } => {
                write!(f, "poor fit: modes explain the recording to {snr_db:.1} dB only")
            }
            Self::Offset { mean } => write!(f, "constant offset: a mean of {mean:.3} was removed"),
            Self::Cancelling { frequency_hz } => {
                write!(f, "cancelling: modes near {frequency_hz:.1} Hz all but cancel; take them together")
            }
        }
    }
}

/// A fitted recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The modes, most energy first.
    pub modes: Vec<FittedMode>,
    /// What the recording is called.
    pub source: String,
    /// Sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Where the strike begins, s of the file.
    pub onset_s: f64,
    /// First sample of the strike in the recording.
    pub onset_sample: usize,
    /// From the onset to where the modes were fitted: what comes before is contact, s.
    pub start_offset_s: f64,
    /// End of the analysed part, s of the file.
    pub end_s: f64,
    /// Noise power, dB re full scale.
    pub noise_floor_db: f64,
    /// Recording over residual from `onset_s` + `start_offset_s` to `end_s`, dB.
    pub resynthesis_snr_db: f64,
    /// The same from the onset on, the contact included.
    pub snr_from_onset_db: f64,
    /// What the modes leave.
    pub residual: Residual,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

impl Fit {
    /// The modes alone, from the onset, `count` samples; they rise while the striker pushes.
    #[must_use]
    pub fn resynthesise(&self, count: usize) -> Vec<f64> {
        let partials: Vec<Partial> =
            self.modes.iter().map(|mode| partial_of(&mode.mode(), self.sample_rate_hz)).collect();
        let mut samples = crate::projection::synthesise(&partials, count);
        rise(&mut samples, (self.start_offset_s * self.sample_rate_hz).round() as usize);
        samples
    }

    /// The first `length_s` of the residual after the onset, faded out: what a body plays at an impact.
    #[must_use]
    pub fn burst(&self, length_s: f64) -> Burst {
        Burst::new(&self.residual.samples[self.onset_sample..], length_s, self.sample_rate_hz)
    }

    /// The modes in the place of the strike, as long as the recording.
    #[must_use]
    pub fn resynthesis(&self) -> Vec<f64> {
        let mut samples = vec![0.0; self.onset_sample];
        samples.extend(self.resynthesise(self.residual.samples.len() - self.onset_sample));
        samples
    }
}

/// A mode at a sample rate.
#[must_use]
pub fn partial_of(mode: &Mode, rate_hz: f64) -> Partial {
    Partial {
        omega: 2.0 * PI * mode.frequency_hz / rate_hz,
        delta: mode.decay_per_s / rate_hz,
        c: nalgebra::Complex::from_polar(mode.amplitude, mode.phase_rad - 0.5 * PI),
    }
}
