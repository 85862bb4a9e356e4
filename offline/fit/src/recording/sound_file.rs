//! A sound file frame by frame, full scale ±1, whatever it is packed in.
//!
//! | begins with | read by |
//! |---|---|
//! | `RIFF`, `RIFX`, `RF64`, `BW64` | [`crate::recording::wav_file`]; what is packed inside (ADPCM) by `packed_file` |
//! | `fLaC`, `OggS`, `FORM`, `ftyp`, a frame of MPEG audio | [`crate::recording::packed_file`] |
//!
//! ID3 tags in front are passed over. Everything else is refused by name.

use crate::recording::packed_file::PackedFile;
use crate::recording::sound_format::{Format, Refusal};
use crate::recording::wav_file::WavFile;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// Most tags in front of a sound.
const MOST_TAGS: usize = 16;

/// A file that is read from its first frame on.
pub(crate) enum SoundFile {
    Wav(WavFile),
    Packed(Box<PackedFile>),
}

impl SoundFile {
    pub(crate) fn open(path: &Path) -> Result<Self, Refusal> {
        let mut file = File::open(path)?;
        let (offset, begins) = after_tags(&mut file)?;
        let packed = |file: File, kind: &'static str| {
            PackedFile::open(file, kind).map(|file| Self::Packed(Box::new(file)))
        };
        match begins {
            [b'R', b'I', b'F', b'F' | b'X', ..]
            | [b'R', b'F', b'6', b'4', ..]
            | [b'B', b'W', b'6', b'4', ..] => {
                file.seek(SeekFrom::Start(offset))?;
                match WavFile::open(file) {
                    Ok(file) => Ok(Self::Wav(file)),
                    Err(Refusal::Not(what)) if what.contains("ADPCM") => {
                        packed(File::open(path)?, "WAV").map_err(|_| Refusal::Not(what))
                    }
                    Err(error) => Err(error),
                }
            }
            _ => match packed_kind(&begins) {
                Some(kind) => {
                    file.seek(SeekFrom::Start(0))?;
                    packed(file, kind)
                }
                None => Err(Refusal::Not(name_of(&begins).to_owned())),
            },
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

    /// Tests whether the file has broken off before its header says.
    pub(crate) fn truncated(&self) -> bool {
        match self {
            Self::Wav(file) => file.truncated(),
            Self::Packed(file) => file.truncated(),
        }
    }
}

/// Beginning of the sound behind ID3v2 tags, and its first twelve bytes.
fn after_tags(file: &mut File) -> Result<(u64, [u8; 12]), Refusal> {
    let mut offset = 0;
    for _ in 0..MOST_TAGS {
        file.seek(SeekFrom::Start(offset))?;
        let mut read = Vec::new();
        file.by_ref().take(12).read_to_end(&mut read)?;
        read.resize(12, 0);
        let begins: [u8; 12] = std::array::from_fn(|i| read[i]);
        let [b'I', b'D', b'3', version, _, flags, sizes @ ..] = begins else { return Ok((offset, begins)) };
        // Seven bits a byte; version 2.4 may repeat the head at the end.
        let size = sizes[..4].iter().fold(0, |size, byte| size << 7 | u64::from(byte & 0x7f));
        let footer = if version >= 4 && flags & 0x10 != 0 { 10 } else { 0 };
        offset += 10 + size + footer;
    }
    Err(Refusal::Not("tags without a sound behind them".into()))
}

/// Kind of a file that `packed_file` reads.
fn packed_kind(begins: &[u8; 12]) -> Option<&'static str> {
    match begins {
        [b'f', b'L', b'a', b'C', ..] => Some("FLAC"),
        [b'O', b'g', b'g', b'S', ..] => Some("Ogg"),
        [b'F', b'O', b'R', b'M', _, _, _, _, b'A', b'I', b'F', b'F' | b'C'] => Some("AIFF"),
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => Some("M4A"),
        [0xff, 0xe2..=0xff, ..] => Some("MP3"),
        _ => None,
    }
}

/// Kind of a file that cannot be read, by its first twelve bytes.
fn name_of(begins: &[u8]) -> &'static str {
    match begins {
        [b'c', b'a', b'f', b'f', ..] => "CAF",
        [b'w', b'v', b'p', b'k', ..] => "WavPack",
        [b'r', b'i', b'f', b'f', ..] => "Wave64",
        [0x1a, 0x45, 0xdf, 0xa3, ..] => "Matroska or WebM",
        [b'F', b'O', b'R', b'M', ..] => "IFF, but no AIFF",
        [b'.', b's', b'n', b'd', ..] | [b'd', b'n', b's', b'.', ..] => "AU",
        [0x30, 0x26, 0xb2, 0x75, ..] => "WMA",
        [b'#', b'!', b'A', b'M', b'R', ..] => "AMR",
        [b'C', b'r', b'e', b'a', b't', b'i', b'v', b'e', ..] => "VOC",
        [b'N', b'I', b'S', b'T', ..] => "NIST Sphere",
        [b'M', b'T', b'h', b'd', ..] => "MIDI",
        [b'v', b'e', b'r', b's', b'i', b'o', b'n', b' ', ..] => "a pointer of Git LFS",
        [b'<', b'!' | b'h' | b'H', ..] => "a web page",
        _ if begins.iter().all(|byte| *byte == 0) => "empty or nothing but zeros",
        _ => "no header of a sound file",
    }
}
