//! Warnings about a recording or its modes, each with what can be done about it.

use std::fmt;

/// Something about the recording, or about its modes.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// Samples stuck at full scale.
    Clipped {
        /// Number.
        samples: usize,
    },
    /// The file breaks off.
    Truncated,
    /// More than one strike.
    SecondStrike {
        /// Which one is analysed, from 1.
        taken: usize,
        /// Its onset, s of the file.
        taken_s: f64,
        /// The onsets of the others.
        others_s: Vec<f64>,
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
    /// There is more than the allowed number of modes, and nearly as many are taken.
    ModesCapped {
        /// The limit.
        limit: usize,
    },
    /// Modes that do not decay within the sound; they ring twenty times as long as it.
    Undamped {
        /// Number.
        count: usize,
        /// Frequency of the strongest.
        frequency_hz: f64,
    },
    /// Modes that ring so long that the sound does not show their decay; they ring three times as
    /// long as it.
    UnknownDecay {
        /// Number.
        count: usize,
        /// Frequency of the strongest, Hz.
        frequency_hz: f64,
    },
    /// Faint tones that do not decay, left out of the modes.
    Steady {
        /// Number.
        count: usize,
        /// Frequency of the strongest.
        frequency_hz: f64,
    },
    /// Mains hum, left out of the modes.
    Hum {
        /// Number of tones.
        count: usize,
        /// Frequency of the strongest.
        frequency_hz: f64,
    },
    /// Faint modes below the lowest partial of the body, left out.
    Rumble {
        /// Number.
        count: usize,
        /// Frequency of the lowest partial.
        lowest_hz: f64,
    },
    /// Strong modes whose decay no exponential describes.
    NotExponential {
        /// Number.
        count: usize,
        /// Frequency of the one of which most remains.
        frequency_hz: f64,
        /// Remainder of it, relative to it, dB.
        left_db: f64,
    },
    /// Struck at once, the modes would be louder than the recording ever is; their amplitudes were
    /// fitted anew.
    LouderThanRecorded {
        /// By how much their peak was over the recording's, dB.
        over_db: f64,
    },
    /// Modes explain little of the recording.
    PoorFit {
        /// Struck body against recording in the modes' band, dB.
        snr_db: f64,
    },
    /// The recording has a strong constant part, removed.
    Offset {
        /// Mean, full scale 1.
        mean: f64,
    },
    /// Pairs of modes that all but cancel each other.
    Cancelling {
        /// Number of pairs.
        count: usize,
        /// Frequency of the strongest.
        frequency_hz: f64,
    },
}

impl Warning {
    /// A short name, the same for every warning of a kind; every text begins with it.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Clipped { .. } => "clipping",
            Self::Truncated => "truncated",
            Self::SecondStrike { .. } => "second strike",
            Self::TooShort { .. } => "too short",
            Self::PartOfFile { .. } => "long file",
            Self::NoModes => "no modes",
            Self::ModesCapped { .. } => "mode limit",
            Self::Undamped { .. } => "undamped",
            Self::UnknownDecay { .. } => "decay unknown",
            Self::Steady { .. } => "steady tone",
            Self::Hum { .. } => "hum",
            Self::Rumble { .. } => "rumble",
            Self::NotExponential { .. } => "not exponential",
            Self::LouderThanRecorded { .. } => "loud strike",
            Self::PoorFit { .. } => "poor fit",
            Self::Offset { .. } => "constant offset",
            Self::Cancelling { .. } => "cancelling",
        }
    }

    /// Number of samples, strikes, modes or pairs it is about; 1 where it is about the recording.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Clipped { samples } => *samples,
            Self::SecondStrike { others_s, .. } => others_s.len(),
            Self::Undamped { count, .. }
            | Self::UnknownDecay { count, .. }
            | Self::Steady { count, .. }
            | Self::Hum { count, .. }
            | Self::Rumble { count, .. }
            | Self::NotExponential { count, .. }
            | Self::Cancelling { count, .. } => *count,
            _ => 1,
        }
    }
}

/// `1 mode`, `3 modes`.
fn counted(count: usize, one: &str) -> String {
    format!("{count} {one}{}", if count == 1 { "" } else { "s" })
}

/// `0.102`, `0.102 and 0.750`, `0.102, 0.750 and 1.2`.
fn seconds(times_s: &[f64]) -> String {
    let words: Vec<String> = times_s.iter().map(|s| format!("{s:.3}")).collect();
    match words.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, first)) => format!("{} and {last}", first.join(", ")),
        None => String::new(),
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.kind())?;
        match self {
            Self::Clipped { samples } => {
                write!(f, "{} stuck at full scale; record it less loudly", counted(*samples, "sample"))
            }
            Self::Truncated => {
                write!(f, "the file ends before its header says; copy it again if it is not all there")
            }
            Self::SecondStrike { taken, taken_s, others_s } => write!(
                f,
                "strike {taken} of {}, at {taken_s:.3} s, is analysed until the next; {} at {} s; \
                 --strike N takes another",
                others_s.len() + 1,
                if others_s.len() == 1 { "the other is" } else { "the others are" },
                seconds(others_s)
            ),
            Self::TooShort { length_s } => write!(
                f,
                "{:.1} ms of sound; the standard deviations say what it is worth; let it ring out",
                1e3 * length_s
            ),
            Self::PartOfFile { from_s, to_s } => write!(
                f,
                "only {from_s:.1} s to {to_s:.1} s is analysed; cut the file if the strike is elsewhere"
            ),
            Self::NoModes => {
                write!(f, "nothing stands above the noise; record nearer, or something that rings")
            }
            Self::ModesCapped { limit } => write!(
                f,
                "more than {limit} modes are there; those heard best are kept; --max-modes takes more"
            ),
            Self::Undamped { count, frequency_hz } => write!(
                f,
                "{} not decay within the sound, the strongest at {frequency_hz:.1} Hz; set to ring \
                 twenty times as long as it; record until it is silent",
                does(*count, "mode")
            ),
            Self::UnknownDecay { count, frequency_hz } => write!(
                f,
                "{} longer than the sound shows, the strongest at {frequency_hz:.1} Hz; set to ring three times as long \
                 as it; record until it is silent",
                if *count == 1 { "1 mode rings".to_owned() } else { format!("{count} modes ring") }
            ),
            Self::Steady { count, frequency_hz } => write!(
                f,
                "{} not decay, the strongest at {frequency_hz:.1} Hz, left out; switch off what hums \
                 there, or, if the object itself rings so long, record until it is silent",
                does(*count, "faint tone")
            ),
            Self::Hum { count, frequency_hz } => write!(
                f,
                "{} of the mains left out, the strongest at {frequency_hz:.1} Hz; look for the loop",
                counted(*count, "tone")
            ),
            Self::Rumble { count, lowest_hz } => write!(
                f,
                "{} below the lowest partial ({lowest_hz:.1} Hz) left out; a quieter room or a softer support keeps \
                 them out of the recording",
                counted(*count, "faint mode")
            ),
            Self::NotExponential { count, frequency_hz, left_db } => write!(
                f,
                "the decay of {} that ring loudest is no exponential, least at {frequency_hz:.1} Hz ({left_db:.0} dB of \
                 that mode remain); hold the object more freely, or record in a drier room",
                if *count == 1 { "1 of the modes".to_owned() } else { format!("{count} of the modes") }
            ),
            Self::LouderThanRecorded { over_db } => write!(
                f,
                "struck at once, the modes would peak {over_db:.1} dB over the recording; amplitudes were fitted anew; \
                 a harder striker, or one strike alone, makes them right"
            ),
            Self::PoorFit { snr_db } => write!(
                f,
                "modes explain their band of the recording to {snr_db:.1} dB only; --burst-ms keeps the attack they miss"
            ),
            Self::Offset { mean } => {
                write!(f, "a mean of {mean:.3} was removed; the input has a DC fault")
            }
            Self::Cancelling { count, frequency_hz } => write!(
                f,
                "{} all but cancel, the strongest near {frequency_hz:.1} Hz; take each together",
                counted(*count, "pair")
            ),
        }
    }
}

/// `1 mode does`, `3 modes do`.
fn does(count: usize, one: &str) -> String {
    format!("{} {}", counted(count, one), if count == 1 { "does" } else { "do" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_begins_with_its_kind_and_speaks_of_one_or_many() {
        let one = Warning::Undamped { count: 1, frequency_hz: 440.0 };
        let many = Warning::Undamped { count: 3, frequency_hz: 440.0 };
        assert!(one.to_string().starts_with("undamped: 1 mode does not decay"), "{one}");
        assert!(many.to_string().starts_with("undamped: 3 modes do not decay"), "{many}");
        let strikes = Warning::SecondStrike { taken: 2, taken_s: 0.5, others_s: vec![0.1, 1.25] };
        let said = "second strike: strike 2 of 3, at 0.500 s, is analysed until the next; \
                    the others are at 0.100 and 1.250 s; --strike N takes another";
        assert_eq!(strikes.to_string(), said);
        assert_eq!((strikes.kind(), strikes.count()), ("second strike", 2));
    }
}
