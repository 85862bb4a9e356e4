//! WAV files: 32-bit float, as many channels as there are signals.

use std::path::Path;

/// Writes equally long channels as a 32-bit float WAV file.
///
/// # Errors
/// When the file cannot be written.
pub fn write_wav(path: &Path, channels: &[&[f32]], sample_rate_hz: f64) -> Result<(), hound::Error> {
    let spec = hound::WavSpec {
        channels: channels.len() as u16,
        sample_rate: sample_rate_hz.round() as u32,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(path, spec)?;
    let frames = channels.first().map_or(0, |channel| channel.len());
    for frame in 0..frames {
        for channel in channels {
            writer.write_sample(channel[frame])?;
        }
    }
    writer.finalize()
}
