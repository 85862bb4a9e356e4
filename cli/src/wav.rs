//! WAV files: 32-bit float as the engine renders, or whole numbers for programs that take only
//! those.

use crate::error::CliError;
use crate::output::Outputs;
use std::path::Path;

/// Sample format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bits {
    /// 16-bit whole numbers.
    Sixteen,
    /// 24-bit whole numbers.
    TwentyFour,
    /// 32-bit float, as it is rendered.
    Float,
}

impl Bits {
    /// The format of that many bits, for the command line.
    ///
    /// # Errors
    /// When it is another number.
    pub fn parse(text: &str) -> Result<Self, String> {
        match text {
            "16" => Ok(Self::Sixteen),
            "24" => Ok(Self::TwentyFour),
            "32" => Ok(Self::Float),
            _ => Err("must be 16, 24 or 32".to_owned()),
        }
    }

    fn format(self) -> (u16, hound::SampleFormat) {
        match self {
            Self::Sixteen => (16, hound::SampleFormat::Int),
            Self::TwentyFour => (24, hound::SampleFormat::Int),
            Self::Float => (32, hound::SampleFormat::Float),
        }
    }
}

/// Writes one file of `channels`, all equally long, at `sample_rate_hz`, in 32-bit float.
///
/// # Errors
/// When the rate or the number of channels does not fit a WAV file, or the file cannot be written.
pub fn write(
    outputs: &mut Outputs,
    path: &Path,
    channels: &[&[f32]],
    sample_rate_hz: f64,
) -> Result<(), CliError> {
    write_bits(outputs, path, channels, sample_rate_hz, Bits::Float).map(drop)
}

/// [`write()`] in another sample format. Returns how many samples whole numbers have cut off at
/// full scale.
///
/// # Errors
/// As [`write()`].
pub fn write_bits(
    outputs: &mut Outputs,
    path: &Path,
    channels: &[&[f32]],
    sample_rate_hz: f64,
    bits: Bits,
) -> Result<u64, CliError> {
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
    let (bits_per_sample, sample_format) = bits.format();
    let spec = hound::WavSpec { channels: count, sample_rate: rate, bits_per_sample, sample_format };
    let failed = |error: hound::Error| match error {
        hound::Error::IoError(error) => CliError::write(path, &error),
        other => CliError::file(path, format!("cannot be written ({other})"), "use a shorter render"),
    };
    let mut writer = hound::WavWriter::new(outputs.create(path)?, spec).map_err(failed)?;
    let frames = channels.iter().map(|channel| channel.len()).min().unwrap_or(0);
    let (mut clipped, whole) = (0, (1i64 << (bits_per_sample - 1)) as f64);
    for frame in 0..frames {
        for channel in channels {
            let sample = channel[frame];
            let written = match bits {
                Bits::Float => writer.write_sample(sample),
                Bits::Sixteen | Bits::TwentyFour => {
                    let steps = (f64::from(sample) * whole).round();
                    let held = steps.clamp(-whole, whole - 1.0);
                    clipped += u64::from(held != steps);
                    writer.write_sample(held as i32)
                }
            };
            written.map_err(failed)?;
        }
    }
    writer.finalize().map_err(failed)?;
    Ok(clipped)
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
    fn whole_numbers_are_the_nearest_and_what_is_beyond_is_counted() {
        let folder = tempfile::tempdir().unwrap();
        for (bits, width, steps) in [(Bits::Sixteen, 16, 32_768.0), (Bits::TwentyFour, 24, 8_388_608.0)] {
            let path = folder.path().join(format!("{width}.wav"));
            let mut outputs = Outputs::new();
            let samples = [0.1_f32, -0.7, 1.5, -1.0, -1.5];
            assert_eq!(write_bits(&mut outputs, &path, &[&samples], 44_100.0, bits).unwrap(), 2);
            outputs.commit().unwrap();
            let mut reader = hound::WavReader::open(&path).unwrap();
            assert_eq!(reader.spec().bits_per_sample, width);
            let back: Vec<f64> = reader.samples::<i32>().map(|x| f64::from(x.unwrap()) / steps).collect();
            assert!(
                (back[0] - 0.1).abs() <= 0.5 / steps + 1e-8 && (back[1] + 0.7).abs() <= 0.5 / steps + 1e-7
            );
            assert_eq!(back[2..], [1.0 - 1.0 / steps, -1.0, -1.0]);
        }
        assert!(Bits::parse("20").is_err());
    }

    #[test]
    fn a_rate_with_a_fraction_is_refused() {
        let mut outputs = Outputs::new();
        assert!(write(&mut outputs, Path::new("x.wav"), &[&[0.0]], 44_100.5).is_err());
    }
}
