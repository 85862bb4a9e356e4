//! A sound file frame by frame, full scale ±1, whatever it is packed in.
//!
//! | begins with | read by |
//! |---|---|
//! | `RIFF`, `RIFX`, `RF64`, `BW64` | [`crate::recording::wav_file`] |
//! | `fLaC`, `OggS` | [`crate::recording::packed_file`] |
//!
//! Everything else is refused by name.

use crate::recording::packed_file::PackedFile;
use crate::recording::sound_format::{Format, Refusal};
use crate::recording::wav_file::WavFile;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// A file that is read from its first frame on.
pub(crate) enum SoundFile {
    Wav(WavFile),
    Packed(Box<PackedFile>),
}

impl SoundFile {
    pub(crate) fn open(path: &Path) -> Result<Self, Refusal> {
        let mut file = std::fs::File::open(path)?;
        let mut begins = Vec::new();
        file.by_ref().take(12).read_to_end(&mut begins)?;
        file.seek(SeekFrom::Start(0))?;
        begins.resize(12, 0);
        match &begins[..4] {
            b"RIFF" | b"RIFX" | b"RF64" | b"BW64" => WavFile::open(file).map(Self::Wav),
            b"fLaC" | b"OggS" => PackedFile::open(file).map(|file| Self::Packed(Box::new(file))),
            _ => Err(Refusal::Not(name_of(&begins).to_owned())),
        }
    }

    pub(crate) fn format(&self) -> Format {
        match self {
            Self::Wav(file) => file.format(),
            Self::Packed(file) => file.format(),
        }
    }

    /// The next frame; `false` at the end.
    pub(crate) fn next(&mut self, frame: &mut [f64]) -> Result<bool, Refusal> {
        match self {
            Self::Wav(file) => file.next(frame),
            Self::Packed(file) => file.next(frame),
        }
    }

    /// Whether the file has broken off before its header says.
    pub(crate) fn truncated(&self) -> bool {
        match self {
            Self::Wav(file) => file.truncated(),
            Self::Packed(file) => file.truncated(),
        }
    }
}

/// What a file is that cannot be read, by its first twelve bytes.
fn name_of(begins: &[u8]) -> &'static str {
    match begins {
        [b'F', b'O', b'R', b'M', ..] => "AIFF",
        [b'I', b'D', b'3', ..] | [0xff, 0xe2..=0xff, ..] => "MP3",
        [b'c', b'a', b'f', b'f', ..] => "CAF",
        [b'w', b'v', b'p', b'k', ..] => "WavPack",
        [b'r', b'i', b'f', b'f', ..] => "Wave64",
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => "MP4",
        [0x1a, 0x45, 0xdf, 0xa3, ..] => "Matroska",
        _ if begins.iter().all(|byte| *byte == 0) => "empty or nothing but zeros",
        _ => "no header of a sound file",
    }
}
