//! Codecs: how the samples of a stroke's sound are stored.

use asperity::files::FileError;
use flacenc::bitsink::ByteSink;
use flacenc::component::BitRepr;
use flacenc::error::Verify;
use flacenc::source::MemSource;
use serde::Deserialize;

/// Samples a FLAC block.
const BLOCK: usize = 4096;
/// Highest rate that FLAC's encoder takes, Hz.
const MOST_FLAC_HZ: f64 = 96_000.0;

/// Codec of stored samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Codec {
    /// As they are rendered.
    #[default]
    F32,
    /// 16-bit FLAC, full scale ±1; what is beyond is cut off and counted.
    Flac16,
}

impl Codec {
    /// Its name in a specification.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::Flac16 => "flac16",
        }
    }

    pub(crate) fn check(self, rate_hz: f64) -> Result<(), FileError> {
        if self == Self::F32 || (rate_hz <= MOST_FLAC_HZ && rate_hz.fract() == 0.0) {
            return Ok(());
        }
        let right = format!("FLAC takes whole rates up to {MOST_FLAC_HZ} Hz; or write codec = \"f32\"");
        Err(FileError::new("output.audio.rate_hz", format!("{rate_hz} is refused"), right))
    }
}

/// A FLAC file of samples, and how many of them were beyond ±1.
///
/// # Errors
/// What the encoder says.
pub fn flac16(samples: &[f32], rate_hz: f64) -> Result<(Vec<u8>, u64), String> {
    let clipped = samples.iter().filter(|sample| sample.abs() > 1.0).count() as u64;
    let whole: Vec<i32> =
        samples.iter().map(|sample| (sample.clamp(-1.0, 1.0) * 32_767.0).round() as i32).collect();
    let config =
        flacenc::config::Encoder::default().into_verified().map_err(|(_, error)| error.to_string())?;
    let source = MemSource::from_samples(&whole, 1, 16, rate_hz as usize);
    let stream =
        flacenc::encode_with_fixed_block_size(&config, source, BLOCK).map_err(|error| error.to_string())?;
    let mut sink = ByteSink::new();
    stream.write(&mut sink).map_err(|error| error.to_string())?;
    Ok((sink.into_inner(), clipped))
}
