//! 32-bit float WAV files.

use crate::error::CliError;
use crate::output::Outputs;
use std::path::Path;

/// Writes one file of `channels`, all equally long, at `sample_rate_hz`.
///
/// # Errors
/// When the rate or the number of channels does not fit a WAV file, or the file cannot be written.
pub fn write(
    outputs: &mut Outputs,
    path: &Path,
    channels: &[&[f32]],
    sample_rate_hz: f64,
) -> Result<(), CliError> {
    let rate = whole_rate(sample_rate_hz).ok_or_else(|| {
        CliError::file(
            path,
            format!("{sample_rate_hz} Hz does not fit a WAV file"),
            "use a whole number of hertz",
        )
    })?;
    let count = u16::try_from(channels.len()).ok().filter(|&count| count > 0).ok_or_else(|| {
        CliError::file(path, format!("{} channels do not fit a WAV file", channels.len()), "use 1 to 65535")
    })?;
    let spec = hound::WavSpec {
        channels: count,
        sample_rate: rate,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let failed = |error: hound::Error| match error {
        hound::Error::IoError(error) => CliError::write(path, &error),
        other => CliError::file(path, format!("cannot be written ({other})"), "use a shorter render"),
    };
    let mut writer = hound::WavWriter::new(outputs.create(path)?, spec).map_err(failed)?;
    let frames = channels.iter().map(|channel| channel.len()).min().unwrap_or(0);
    for frame in 0..frames {
        for channel in channels {
            writer.write_sample(channel[frame]).map_err(failed)?;
        }
    }
    writer.finalize().map_err(failed)
}

/// The rate as the whole number a WAV file holds.
fn whole_rate(sample_rate_hz: f64) -> Option<u32> {
    let rounded = sample_rate_hz.round();
    let whole = (rounded - sample_rate_hz).abs() < 1e-6 && (1.0..=f64::from(u32::MAX)).contains(&rounded);
    whole.then_some(rounded as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_come_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.wav");
        let left = [0.1_f32, -3.5, f32::MIN_POSITIVE];
        let right = [1.0_f32, 2.0, 3.0];
        let mut outputs = Outputs::new();
        write(&mut outputs, &path, &[&left, &right], 48_000.0).unwrap();
        outputs.commit().unwrap();
        let mut reader = hound::WavReader::open(&path).unwrap();
        assert_eq!((reader.spec().channels, reader.spec().sample_rate), (2, 48_000));
        let back: Vec<f32> = reader.samples::<f32>().map(Result::unwrap).collect();
        assert_eq!(back, [0.1, 1.0, -3.5, 2.0, f32::MIN_POSITIVE, 3.0]);
    }

    #[test]
    fn a_rate_with_a_fraction_is_refused() {
        let mut outputs = Outputs::new();
        assert!(write(&mut outputs, Path::new("x.wav"), &[&[0.0]], 44_100.5).is_err());
    }
}
