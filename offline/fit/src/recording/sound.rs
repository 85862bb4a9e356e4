//! Sound: one channel of a file as it stands there, for uses without a strike.
//!
//! WAV of any width, FLAC and Ogg Vorbis, as [`load`](super::load) reads them, but of any length,
//! rate and content.

use super::RecordingError;
use super::sound_file::SoundFile;
use std::path::Path;

/// One channel, full scale ±1 (floating point files: as it stands).
#[derive(Debug, Clone, PartialEq)]
pub struct Sound {
    /// Its samples.
    pub samples: Vec<f64>,
    /// Rate that the file states, Hz.
    pub sample_rate_hz: f64,
    /// The file ends before its header says; what is there was read.
    pub truncated: bool,
}

impl Sound {
    /// A channel, counted from 0, of a file of at most `longest_s`.
    ///
    /// # Errors
    /// When the file cannot be read or decoded, lasts longer, or has no such channel.
    pub fn load(path: impl AsRef<Path>, channel: usize, longest_s: f64) -> Result<Self, RecordingError> {
        let path = path.as_ref();
        let refused = |refusal| RecordingError::of(refusal, path);
        let mut file = SoundFile::open(path).map_err(refused)?;
        let (channels, sample_rate_hz) = (file.format().channels, file.format().rate_hz);
        if channel >= channels {
            let name = path.display().to_string();
            return Err(RecordingError::NoSuchChannel { name, wanted: channel, last: channels - 1 });
        }
        let most = (longest_s * sample_rate_hz) as usize;
        let (mut samples, mut frame) = (Vec::new(), vec![0.0; channels]);
        while file.next(&mut frame).map_err(refused)? {
            if samples.len() >= most {
                return Err(RecordingError::TooLong { path: path.to_owned(), longest_s });
            }
            samples.push(frame[channel]);
        }
        Ok(Self { samples, sample_rate_hz, truncated: file.truncated() })
    }
}
