//! One channel of a recording, in `f64`, with what its file says about its own faults.
//!
//! WAV, AIFF, FLAC, Ogg, MP3 or M4A (`sound_file`), up to 64 channels, 1 kHz – 1 MHz. Long files
//! are read in two passes, so that only the minute around the first strike is ever in memory.
//!
//! | file | from → to |
//! |---|---|
//! | `sound_file`, `wav_file`, `packed_file` | WAV; AIFF, FLAC, Ogg, MP3, M4A → frames |
//! | `sound_format` | what a header says, and why a file is refused |
//! | `whitened` | channel → what its past does not predict |
//! | [`Sound`] | a channel of a file as it stands there |
//! | [`onset`] | channel → strikes, and the best of them |

pub mod onset;
mod packed_file;
mod sound;
mod sound_file;
mod sound_format;
mod wav_file;
mod whitened;

pub use sound::Sound;

use crate::recording::sound_file::SoundFile;
use crate::recording::sound_format::Refusal;
use std::path::{Path, PathBuf};

/// Most seconds kept of a file.
pub const LONGEST_KEPT_S: f64 = 60.0;
/// Span that is kept before the first loud place of a longer file.
const KEPT_BEFORE_S: f64 = 2.0;
/// A place is loud from this part of the peak.
const LOUD: f64 = 0.1;
/// Fewest samples an analysis can say anything about.
pub const FEWEST_SAMPLES: usize = 64;

/// Which channel of a file is analysed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ChannelChoice {
    /// The one with the most energy: a mix can cancel modes that two microphones hear in antiphase.
    #[default]
    Loudest,
    /// The mean of all channels.
    Mix,
    /// One by its index, from 0.
    Index(usize),
}

/// Why a file is no recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The file cannot be opened or read.
    #[error("{path}: {source}; a sound file that can be read is needed", path = path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Message of the system.
        source: std::io::Error,
    },
    /// The bytes are no sound, or packed in a way that is not read.
    #[error("{path}: cannot be decoded ({what}); WAV, AIFF, FLAC, Ogg Vorbis, MP3 or M4A would be read", path = path.display())]
    NotSound {
        /// The file.
        path: PathBuf,
        /// Kind of file, or what the reader stumbled over.
        what: String,
    },
    /// A channel that is not there.
    #[error("{name}: channel {wanted} is not there; the file has channels 0 to {last}")]
    NoSuchChannel {
        /// The file.
        name: String,
        /// The index asked for.
        wanted: usize,
        /// The last one there is.
        last: usize,
    },
    /// A sample rate outside 1 kHz – 1 MHz.
    #[error("{name}: a sample rate of {rate_hz} Hz cannot be used; 1000 to 1000000 Hz would do")]
    Rate {
        /// The file.
        name: String,
        /// The rate it states.
        rate_hz: f64,
    },
    /// A sample that is not a number.
    #[error("{name}: sample {index} is not a finite number; a recording has finite samples only")]
    NotFinite {
        /// The file.
        name: String,
        /// Index of the first bad sample (frame).
        index: usize,
    },
    /// More than is read.
    #[error("{path}: lasts longer than {longest_s} s; must last at most that", path = path.display())]
    TooLong {
        /// The file.
        path: PathBuf,
        /// The most that is read, s.
        longest_s: f64,
    },
    /// Too few samples to analyse.
    #[error("{name}: {samples} samples are too few; {FEWEST_SAMPLES} or more are needed")]
    TooShort {
        /// The file.
        name: String,
        /// Number that there is.
        samples: usize,
    },
    /// Nothing but a constant.
    #[error("{name}: silent (every sample is the same); a recording of one strike is needed")]
    Silent {
        /// The file.
        name: String,
    },
}

impl RecordingError {
    /// Reason for refusing a file.
    fn of(refusal: Refusal, path: &Path) -> Self {
        let path = path.to_owned();
        match refusal {
            Refusal::Not(what) => Self::NotSound { path, what },
            Refusal::Io(source) => Self::Io { path, source },
        }
    }
}

/// One channel of sound, ±1 full scale, with its mean still in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// File name, or what the caller calls it; for messages and the modes file.
    pub name: String,
    /// Samples, full scale ±1.
    pub samples: Vec<f64>,
    /// Sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Seconds of the file before `samples[0]`.
    pub starts_at_s: f64,
    /// Size of a quantisation step; 0 for float.
    pub quantum: f64,
    /// The file ends before its header says, or in the middle of a frame.
    pub truncated: bool,
    /// Length of the file as read, seconds; longer than `samples` when only a part was kept.
    pub file_s: f64,
}

impl Recording {
    /// Samples from elsewhere.
    ///
    /// # Errors
    /// Bad rate, too few samples, a sample that is not finite, or silence.
    pub fn from_samples(name: &str, samples: Vec<f64>, sample_rate_hz: f64) -> Result<Self, RecordingError> {
        let file_s = samples.len() as f64 / sample_rate_hz;
        let recording = Self {
            name: name.to_owned(),
            samples,
            sample_rate_hz,
            starts_at_s: 0.0,
            quantum: 0.0,
            truncated: false,
            file_s,
        };
        recording.checked()
    }

    fn checked(self) -> Result<Self, RecordingError> {
        let name = self.name.clone();
        if !(1e3..=1e6).contains(&self.sample_rate_hz) {
            return Err(RecordingError::Rate { name, rate_hz: self.sample_rate_hz });
        }
        if let Some(index) = self.samples.iter().position(|x| !x.is_finite() || x.abs() > 1e100) {
            return Err(RecordingError::NotFinite { name, index });
        }
        if self.samples.len() < FEWEST_SAMPLES {
            return Err(RecordingError::TooShort { name, samples: self.samples.len() });
        }
        let first = self.samples[0];
        let peak = self.samples.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
        if self.samples.iter().all(|x| (x - first).abs() <= 1e-12 * peak) || peak < 1e-100 {
            return Err(RecordingError::Silent { name });
        }
        Ok(self)
    }

    /// Runs of samples stuck at the extreme values: `(first, one past the last)`.
    #[must_use]
    pub fn clipped_runs(&self) -> Vec<(usize, usize)> {
        let high = self.samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let low = self.samples.iter().copied().fold(f64::INFINITY, f64::min);
        let tolerance = 0.51 * self.quantum + 1e-7 * (high - low);
        let mut runs = Vec::new();
        let mut start = None;
        for (i, &x) in self.samples.iter().chain(std::iter::once(&f64::NAN)).enumerate() {
            let at_extreme = (x - high).abs() <= tolerance || (x - low).abs() <= tolerance;
            match (at_extreme, start) {
                (true, None) => start = Some(i),
                (false, Some(first)) => {
                    if i - first >= 4 {
                        runs.push((first, i));
                    }
                    start = None;
                }
                _ => {}
            }
        }
        // One flat top can be a slow sinusoid's; clipping repeats or lasts.
        let total: usize = runs.iter().map(|(a, b)| b - a).sum();
        if runs.len() >= 2 || total >= 12 { runs } else { Vec::new() }
    }
}

/// Reads one channel of a sound file.
///
/// # Errors
/// When the file cannot be read, cannot be decoded, or holds nothing that can be analysed.
pub fn load(path: impl AsRef<Path>, choice: ChannelChoice) -> Result<Recording, RecordingError> {
    let path = path.as_ref();
    let name = path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into());
    let open = || SoundFile::open(path).map_err(|refusal| RecordingError::of(refusal, path));
    let mut file = open()?;
    let format = file.format();
    let (channels, rate) = (format.channels, format.rate_hz);
    if let ChannelChoice::Index(wanted) = choice
        && wanted >= channels
    {
        return Err(RecordingError::NoSuchChannel { name, wanted, last: channels - 1 });
    }
    if !(1e3..=1e6).contains(&rate) {
        return Err(RecordingError::Rate { name, rate_hz: rate });
    }
    let longest = (LONGEST_KEPT_S * rate) as usize;
    let mut frame = vec![0.0; channels];
    let (mut first, mut frames) = (0, format.frames as usize);
    if format.frames > longest as u64 {
        let loud = first_loud_frame(&mut file, &mut frame, rate)
            .map_err(|refusal| RecordingError::of(refusal, path))?;
        first = loud.at.saturating_sub((KEPT_BEFORE_S * rate) as usize);
        frames = loud.frames;
        file = open()?;
    }
    let mut kept: Vec<Vec<f64>> = vec![Vec::new(); channels];
    let mut index = 0;
    while file.next(&mut frame).map_err(|refusal| RecordingError::of(refusal, path))? {
        if index >= first {
            kept.iter_mut().zip(&frame).for_each(|(channel, &x)| channel.push(x));
            if kept[0].len() >= longest {
                break;
            }
        }
        index += 1;
    }
    let file_s = if kept[0].len() >= longest { frames } else { index } as f64 / rate;
    let recording = Recording {
        samples: chosen(&kept, choice),
        sample_rate_hz: rate,
        starts_at_s: first as f64 / rate,
        quantum: format.quantum,
        truncated: file.truncated(),
        file_s,
        name,
    };
    recording.checked()
}

fn chosen(channels: &[Vec<f64>], choice: ChannelChoice) -> Vec<f64> {
    match choice {
        ChannelChoice::Index(k) => channels[k].clone(),
        ChannelChoice::Mix => (0..channels[0].len())
            .map(|i| channels.iter().map(|c| c[i]).sum::<f64>() / channels.len() as f64)
            .collect(),
        ChannelChoice::Loudest => {
            let energy = |channel: &[f64]| {
                let mean = channel.iter().sum::<f64>() / channel.len().max(1) as f64;
                channel.iter().map(|x| (x - mean).powi(2)).sum::<f64>()
            };
            let loudest = (0..channels.len())
                .map(|k| (k, energy(&channels[k])))
                .fold((0, -1.0), |most, next| if next.1 > most.1 { next } else { most });
            channels[loudest.0].clone()
        }
    }
}

/// The first place whose peak reaches a tenth of the file's, and how many frames the file has.
struct Loud {
    at: usize,
    frames: usize,
}

fn first_loud_frame(file: &mut SoundFile, frame: &mut [f64], rate: f64) -> Result<Loud, Refusal> {
    let block = (0.01 * rate).ceil() as usize;
    let (mut peaks, mut frames) = (Vec::<f64>::new(), 0);
    while file.next(frame)? {
        if frames % block == 0 {
            peaks.push(0.0);
        }
        let peak = frame.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
        if let Some(last) = peaks.last_mut() {
            *last = last.max(peak);
        }
        frames += 1;
    }
    let most = peaks.iter().copied().fold(0.0, f64::max);
    Ok(Loud { at: peaks.iter().position(|&p| p >= LOUD * most).unwrap_or(0) * block, frames })
}
