//! Ports: formats that are written, by the end of a file's name.

use super::{Made, PortOptions, at_rate};
use crate::error::CliError;
use crate::output::Outputs;
use crate::wav;
use asperity_ports::{Clip, Device, ahap, android, haptic_file, hjif};
use std::path::{Path, PathBuf};

/// Keyframes a second of an `.hjif` where nothing else is said.
const HJIF_POINTS_PER_S: f64 = 4000.0;
/// More than this nobody needs of it, dB.
const HJIF_SNR_DB: f64 = 40.0;

/// A format that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Port {
    Haptic,
    Ahap,
    Hjif,
    Android,
    Pcm,
    Wav,
}

impl Port {
    /// By the end of a name.
    pub fn of(path: &Path) -> Result<Self, CliError> {
        let name = path.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
        let ends = [
            (".haptic", Self::Haptic),
            (".ahap", Self::Ahap),
            (".hjif", Self::Hjif),
            (".android.json", Self::Android),
            (".pcm.wav", Self::Pcm),
            (".wav", Self::Wav),
        ];
        ends.into_iter().find(|(end, _)| name.ends_with(end)).map(|(_, port)| port).ok_or_else(|| {
            let right = "must end in .haptic, .ahap, .hjif, .android.json, .pcm.wav or .wav";
            CliError::file(path, "is no format that is written", right)
        })
    }

    /// Tests whether it holds the waveform itself. Samples that are written as `.wav` are what is
    /// left of them.
    pub fn is_waveform(self) -> bool {
        matches!(self, Self::Hjif | Self::Pcm)
    }

    /// Writes an envelope.
    pub fn write_clip(
        self,
        clip: &Clip,
        path: &Path,
        device: &Device,
        options: &PortOptions,
        outputs: &mut Outputs,
    ) -> Result<(), CliError> {
        let played = |error: asperity_ports::PortError| CliError::from_error(error.within(path.display()));
        match self {
            Self::Haptic => outputs.write(path, haptic_file::write(clip).map_err(played)?.as_bytes()),
            Self::Android => outputs.write(path, android::write(clip, device).map_err(played)?.as_bytes()),
            Self::Ahap => {
                let files = ahap::write(clip, options.sound.as_deref()).map_err(played)?;
                outputs.write(path, files.main.as_bytes())?;
                files.transients.map_or(Ok(()), |text| outputs.write(&transients_of(path), text.as_bytes()))
            }
            Self::Wav | Self::Hjif | Self::Pcm => {
                let left = asperity_ports::oscillator::rendered(clip, device, hjif::RATE_HZ);
                self.write_left(&left, hjif::RATE_HZ, path, outputs)
            }
        }
    }

    /// Writes samples at 8 kHz as a waveform, and puts into `made` what is left of them.
    pub fn write_samples(
        self,
        made: &mut Made,
        rate_hz: f64,
        path: &Path,
        device: &Device,
        options: &PortOptions,
        outputs: &mut Outputs,
    ) -> Result<(), CliError> {
        let bounded: Vec<f64> = made.original.iter().map(|x| x.clamp(-1.0, 1.0)).collect();
        if self == Self::Hjif {
            let points = options.points.unwrap_or(HJIF_POINTS_PER_S);
            let written = hjif::write(&bounded, points, HJIF_SNR_DB, "vibration")
                .map_err(|error| CliError::from_error(error.within(path.display())))?;
            made.points = written.keyframes;
            made.left = written.samples;
            return outputs.write(path, written.text.as_bytes());
        }
        let samples: Vec<f64> =
            at_rate(&bounded, device.pcm_rate_hz).iter().map(|x| x.clamp(-1.0, 1.0)).collect();
        made.points = samples.len();
        made.left = asperity_ports::resample::resampled(&samples, device.pcm_rate_hz, rate_hz);
        self.write_left(&samples, device.pcm_rate_hz, path, outputs)
    }

    /// Writes samples as they are.
    pub fn write_left(
        self,
        samples: &[f64],
        rate_hz: f64,
        path: &Path,
        outputs: &mut Outputs,
    ) -> Result<(), CliError> {
        let narrow: Vec<f32> = samples.iter().map(|x| *x as f32).collect();
        wav::write(outputs, path, &[&narrow], rate_hz)
    }
}

/// `X.ahap` → `X.transients.ahap`.
pub fn transients_of(path: &Path) -> PathBuf {
    path.with_extension("transients.ahap")
}
