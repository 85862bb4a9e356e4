//! One channel of a recording, in `f64`, with what its file says about its own faults.
//!
//! WAV of 8–32 bit integers or 32-bit float, any number of channels, 1 kHz – 1 MHz. Long files are read
//! in two passes, so that only the minute around the first strike is ever in memory.

use std::path::{Path, PathBuf};

/// Most seconds kept of a file.
pub const LONGEST_KEPT_S: f64 = 60.0;
/// What is kept before the first loud place of a longer file.
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
pub enum RecordingError {
    /// The file cannot be opened or read.
    #[error("{path}: {source}; a WAV file that can be read is needed", path = path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The bytes are no WAV file.
    #[error("{path}: not a WAV file ({what}); 8–32 bit PCM or 32-bit float WAV would be read", path = path.display())]
    NotWav {
        /// The file.
        path: PathBuf,
        /// What the reader stumbled over.
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
    /// Too few samples to analyse.
    #[error("{name}: {samples} samples are too few; {FEWEST_SAMPLES} or more are needed")]
    TooShort {
        /// The file.
        name: String,
        /// How many there are.
        samples: usize,
    },
    /// Nothing but a constant.
    #[error("{name}: silent (every sample is the same); a recording of one strike is needed")]
    Silent {
        /// The file.
        name: String,
    },
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

/// Reads one channel of a WAV file.
///
/// # Errors
/// When the file cannot be read, is not WAV, or holds nothing that can be analysed.
pub fn load(path: impl AsRef<Path>, choice: ChannelChoice) -> Result<Recording, RecordingError> {
    let path = path.as_ref();
    let name = path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into());
    let mut file = Frames::open(path)?;
    let channels = file.channels;
    let rate = file.rate_hz;
    if let ChannelChoice::Index(wanted) = choice
        && wanted >= channels
    {
        return Err(RecordingError::NoSuchChannel { name, wanted, last: channels - 1 });
    }
    if !(1e3..=1e6).contains(&rate) {
        return Err(RecordingError::Rate { name, rate_hz: rate });
    }
    let longest = (LONGEST_KEPT_S * rate) as usize;
    let first = if file.frames_stated > longest {
        let loud = first_loud_frame(&mut file, rate)?;
        file = Frames::open(path)?;
        loud.saturating_sub((KEPT_BEFORE_S * rate) as usize)
    } else {
        0
    };
    let mut kept: Vec<Vec<f32>> = vec![Vec::new(); channels];
    let mut frame = vec![0.0; channels];
    let mut index = 0;
    while file.next(&mut frame)? {
        if index >= first {
            kept.iter_mut().zip(&frame).for_each(|(channel, &x)| channel.push(x as f32));
            if kept[0].len() >= longest {
                break;
            }
        }
        index += 1;
    }
    let file_s = if kept[0].len() >= longest { file.frames_stated } else { index } as f64 / rate;
    let recording = Recording {
        samples: chosen(&kept, choice),
        sample_rate_hz: rate,
        starts_at_s: first as f64 / rate,
        quantum: file.quantum,
        truncated: file.truncated,
        file_s,
        name,
    };
    recording.checked()
}

fn chosen(channels: &[Vec<f32>], choice: ChannelChoice) -> Vec<f64> {
    let one = |k: usize| channels[k].iter().map(|&x| f64::from(x)).collect::<Vec<f64>>();
    match choice {
        ChannelChoice::Index(k) => one(k),
        ChannelChoice::Mix => (0..channels[0].len())
            .map(|i| channels.iter().map(|c| f64::from(c[i])).sum::<f64>() / channels.len() as f64)
            .collect(),
        ChannelChoice::Loudest => {
            let energy = |channel: &[f32]| {
                let mean = channel.iter().map(|&x| f64::from(x)).sum::<f64>() / channel.len().max(1) as f64;
                channel.iter().map(|&x| (f64::from(x) - mean).powi(2)).sum::<f64>()
            };
            let loudest = (0..channels.len())
                .map(|k| (k, energy(&channels[k])))
                .fold((0, -1.0), |most, next| if next.1 > most.1 { next } else { most });
            one(loudest.0)
        }
    }
}

/// Frame of the first place whose peak reaches a tenth of the file's.
fn first_loud_frame(file: &mut Frames, rate: f64) -> Result<usize, RecordingError> {
    let block = (0.01 * rate).ceil() as usize;
    let mut frame = vec![0.0; file.channels];
    let (mut peaks, mut index) = (Vec::<f64>::new(), 0);
    while file.next(&mut frame)? {
        if index % block == 0 {
            peaks.push(0.0);
        }
        let peak = frame.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
        if let Some(last) = peaks.last_mut() {
            *last = last.max(peak);
        }
        index += 1;
    }
    let most = peaks.iter().copied().fold(0.0, f64::max);
    Ok(peaks.iter().position(|&p| p >= LOUD * most).unwrap_or(0) * block)
}

/// A WAV file frame by frame, full scale ±1; the only place that names the WAV reader.
struct Frames {
    path: PathBuf,
    reader: hound::WavReader<std::io::BufReader<std::fs::File>>,
    float: bool,
    scale: f64,
    channels: usize,
    rate_hz: f64,
    quantum: f64,
    frames_stated: usize,
    truncated: bool,
}

impl Frames {
    fn open(path: &Path) -> Result<Self, RecordingError> {
        let not_wav = |what: String| RecordingError::NotWav { path: path.to_owned(), what };
        let file = std::fs::File::open(path)
            .map_err(|source| RecordingError::Io { path: path.to_owned(), source })?;
        let reader = hound::WavReader::new(std::io::BufReader::new(file))
            .map_err(|error| not_wav(error.to_string()))?;
        let spec = reader.spec();
        if spec.channels == 0 {
            return Err(not_wav("no channels".into()));
        }
        let float = spec.sample_format == hound::SampleFormat::Float;
        let scale = if float { 1.0 } else { 0.5_f64.powi(i32::from(spec.bits_per_sample) - 1) };
        Ok(Self {
            path: path.to_owned(),
            float,
            scale,
            channels: usize::from(spec.channels),
            rate_hz: f64::from(spec.sample_rate),
            quantum: if float { 0.0 } else { scale },
            frames_stated: reader.duration() as usize,
            truncated: false,
            reader,
        })
    }

    /// The next frame; `false` at the end. A file that breaks off is truncated, not refused.
    fn next(&mut self, frame: &mut [f64]) -> Result<bool, RecordingError> {
        for (i, x) in frame.iter_mut().enumerate() {
            let sample = if self.float {
                self.reader.samples::<f32>().next().map(|s| s.map(f64::from))
            } else {
                self.reader.samples::<i32>().next().map(|s| s.map(f64::from))
            };
            match sample {
                None => {
                    self.truncated |= i > 0;
                    return Ok(false);
                }
                Some(Ok(value)) => *x = value * self.scale,
                Some(Err(hound::Error::IoError(_))) => {
                    self.truncated = true;
                    return Ok(false);
                }
                Some(Err(error)) => {
                    return Err(RecordingError::NotWav { path: self.path.clone(), what: error.to_string() });
                }
            }
        }
        Ok(true)
    }
}
