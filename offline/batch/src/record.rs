//! Record: all that is kept of a stroke, enough to render it again.

use crate::codec::{Codec, flac16};
use crate::force::ForceTable;
use crate::spec::Output;
use crate::stroke::{Stroke, Take};
use asperity::files::FileError;
use asperity_ports::resample::resampled;

/// Audio, as it is stored.
#[derive(Debug, Clone, PartialEq)]
pub enum Sound {
    /// Samples.
    F32(Vec<f32>),
    /// A FLAC file.
    Flac(Vec<u8>),
}

/// The samples of a stroke, as a data set keeps them.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Audio.
    pub audio: Sound,
    /// The first quantity that is felt, at its own rate.
    pub haptic: Vec<f32>,
    /// The further ones, each at its own.
    pub further: Vec<Vec<f32>>,
    /// The force and the path, where they are kept.
    pub force: Option<ForceTable>,
    /// Samples of the sound beyond ±1 that a codec of whole numbers has cut off.
    pub clipped: u64,
}

/// One row of a data set.
#[derive(Debug, Clone)]
pub struct Record {
    /// Draws.
    pub stroke: Stroke,
    /// Result.
    pub samples: Samples,
}

impl Samples {
    /// A take as an output keeps it; `id` names the stroke in messages.
    ///
    /// # Errors
    /// When the codec refuses the samples.
    pub fn of(id: &str, take: Take, output: &Output) -> Result<Self, FileError> {
        let audio = &take.render.audio[0];
        let (audio, clipped) = match output.audio.codec {
            Codec::F32 => (Sound::F32(audio.clone()), 0),
            Codec::Flac16 => {
                let (bytes, clipped) = flac16(audio, output.audio.rate_hz).map_err(|error| {
                    FileError::new(
                        id,
                        format!("cannot be written as FLAC ({error})"),
                        "write codec = \"f32\"",
                    )
                })?;
                (Sound::Flac(bytes), clipped)
            }
        };
        let felt = std::iter::once(&take.render.haptic[0]).chain(&take.further);
        let mut felt = felt
            .zip(&output.haptic)
            .map(|(samples, haptic)| at_rate(samples, output.audio.rate_hz, haptic.rate_hz));
        let haptic = felt.next().unwrap_or_default();
        let further = felt.collect();
        Ok(Self { audio, haptic, further, force: take.force, clipped })
    }

    /// Tests whether two hold equal bits.
    #[must_use]
    pub fn same_bits(&self, other: &Self) -> bool {
        let same = |a: &[f32], b: &[f32]| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
        };
        let sounds = match (&self.audio, &other.audio) {
            (Sound::F32(a), Sound::F32(b)) => same(a, b),
            (a, b) => a == b,
        };
        let further = self.further.iter().zip(&other.further).all(|(a, b)| same(a, b));
        let bits = |force: &Option<ForceTable>| {
            let columns = force.iter().flatten();
            columns.map(|column| column.iter().map(|x| x.to_bits()).collect()).collect::<Vec<Vec<u64>>>()
        };
        sounds
            && same(&self.haptic, &other.haptic)
            && self.further.len() == other.further.len()
            && further
            && bits(&self.force) == bits(&other.force)
    }
}

/// A vibration at another rate, not a sample late.
fn at_rate(samples: &[f32], from_hz: f64, to_hz: f64) -> Vec<f32> {
    if from_hz == to_hz {
        return samples.to_vec();
    }
    let samples: Vec<f64> = samples.iter().map(|sample| f64::from(*sample)).collect();
    resampled(&samples, from_hz, to_hz).into_iter().map(|sample| sample as f32).collect()
}
