//! WAV as it is found in the wild, frame by frame.
//!
//! ```text
//! RIFF size WAVE   { name size bytes [pad byte when size is odd] } …      of which `fmt ` comes before `data`
//! ```
//! Integers of 8 to 32 bits (8 without a sign; fewer valid bits than the container has are the
//! upper ones), floats of 32 and 64 bits, A-law and µ-law, also behind the extensible format's
//! identifier; big-endian as `RIFX`; more than 4 GB as `RF64` or `BW64`, whose `ds64` chunk holds
//! the sizes; the size of `data` may be missing (0 or all ones) as streaming recorders leave it.
//! Other chunks (`bext`, `LIST`, `iXML`, `JUNK`, cues) are passed over. Whatever is said of sizes,
//! no more is read than there is.

use crate::recording::sound_format::{Format, MOST_CHANNELS, Refusal};
use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom};

/// Format of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Sample {
    /// Integer of so many bytes; one byte has no sign.
    Integer(usize),
    Float32,
    Float64,
    ALaw,
    MuLaw,
}

/// Tags of the format chunk.
const PCM: u16 = 1;
const FLOAT: u16 = 3;
const A_LAW: u16 = 6;
const MU_LAW: u16 = 7;
const EXTENSIBLE: u16 = 0xfffe;
/// The identifiers of the extensible format are a tag and one of these: the common one, and that of
/// Ambisonics.
const IDENTIFIERS: [[u8; 14]; 2] = [
    [0, 0, 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71],
    [0, 0, 0x21, 0x07, 0xd3, 0x11, 0x86, 0x44, 0xc8, 0xc1, 0xca, 0, 0, 0],
];
/// A size that is not known yet, or stands in `ds64`.
const ELSEWHERE: u64 = 0xffff_ffff;
/// Sizes from here on, where less is there, are written by programs that write into a pipe: about
/// the most that 32 bits hold, with a sign or without.
const UNSAID: u64 = 0x7fff_0000;

/// A WAV file.
pub(crate) struct WavFile {
    reader: BufReader<File>,
    sample: Sample,
    big_endian: bool,
    format: Format,
    /// One frame as it is written.
    bytes: Vec<u8>,
    /// Frames that are there and not read yet.
    left: u64,
    truncated: bool,
}

impl WavFile {
    pub(crate) fn open(file: File) -> Result<Self, Refusal> {
        let length = file.metadata()?.len();
        let mut head = Head { reader: BufReader::with_capacity(1 << 16, file), big_endian: false };
        let name = head.name()?;
        head.big_endian = name == *b"RIFX";
        head.u32()?;
        if head.name()? != *b"WAVE" {
            return Err(Refusal::Not("RIFF, but no WAVE".into()));
        }
        let (mut layout, mut long_size) = (None, None);
        loop {
            let name = head.name().map_err(|_| Refusal::Not("WAV without a data chunk".into()))?;
            let size = u64::from(head.u32()?);
            let begins = head.reader.stream_position()?;
            match &name {
                b"ds64" => {
                    head.u64()?;
                    long_size = Some(head.u64()?);
                }
                b"fmt " => layout = Some(Layout::read(&mut head, size)?),
                b"data" => {
                    let layout: Layout =
                        layout.ok_or_else(|| Refusal::Not("WAV with data before its format".into()))?;
                    let said = match long_size {
                        Some(long) if size == ELSEWHERE => long,
                        _ => size,
                    };
                    return Ok(Self::with(head, layout, said, length.saturating_sub(begins)));
                }
                _ => {}
            }
            head.reader.seek(SeekFrom::Start(begins + size))?;
            // Chunks begin at even places; some programs leave the byte out that makes them.
            let next = head.reader.fill_buf()?.first();
            if size % 2 == 1 && !next.is_some_and(u8::is_ascii_alphabetic) {
                head.reader.seek_relative(1)?;
            }
        }
    }

    fn with(head: Head, layout: Layout, said: u64, there: u64) -> Self {
        let unsaid = said == 0 || said == u64::MAX || said > there && (UNSAID..=ELSEWHERE).contains(&said);
        let bytes = if unsaid { there } else { said.min(there) };
        let frame = layout.frame_bytes as u64;
        let frames = bytes / frame;
        Self {
            reader: head.reader,
            sample: layout.sample,
            big_endian: head.big_endian,
            format: Format {
                channels: layout.channels,
                rate_hz: layout.rate_hz,
                quantum: layout.quantum,
                frames,
            },
            bytes: vec![0; layout.frame_bytes],
            left: frames,
            truncated: !unsaid && (said > there || bytes % frame != 0),
        }
    }

    pub(crate) fn format(&self) -> Format {
        self.format
    }

    pub(crate) fn truncated(&self) -> bool {
        self.truncated
    }

    pub(crate) fn next(&mut self, frame: &mut [f64]) -> Result<bool, Refusal> {
        if self.left == 0 {
            return Ok(false);
        }
        match self.reader.read_exact(&mut self.bytes) {
            Ok(()) => {}
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
                self.truncated = true;
                self.left = 0;
                return Ok(false);
            }
            Err(error) => return Err(error.into()),
        }
        self.left -= 1;
        let width = self.bytes.len() / self.format.channels;
        for (x, bytes) in frame.iter_mut().zip(self.bytes.chunks_exact(width)) {
            *x = self.sample.value(bytes, self.big_endian);
        }
        Ok(true)
    }
}

/// Contents of the format chunk.
struct Layout {
    sample: Sample,
    channels: usize,
    frame_bytes: usize,
    rate_hz: f64,
    quantum: f64,
}

impl Layout {
    fn read(head: &mut Head, size: u64) -> Result<Self, Refusal> {
        let mut tag = head.u16()?;
        let channels = usize::from(head.u16()?);
        let rate_hz = f64::from(head.u32()?);
        head.u32()?;
        let frame_bytes = usize::from(head.u16()?);
        let mut bits = u32::from(head.u16()?);
        if tag == EXTENSIBLE && size >= 40 {
            head.u16()?;
            let valid = u32::from(head.u16()?);
            bits = if valid > 0 { valid } else { bits };
            head.u32()?;
            tag = head.u16()?;
            let mut identifier = [0; 14];
            head.reader.read_exact(&mut identifier)?;
            if !IDENTIFIERS.contains(&identifier) {
                return Err(Refusal::Not("WAV in a format of its maker's own".into()));
            }
        }
        if channels == 0 || channels > MOST_CHANNELS {
            return Err(Refusal::Not(format!("WAV of {channels} channels")));
        }
        // Some recorders leave the size of a frame at 0; it is then as large as its samples.
        let frame_bytes = if frame_bytes == 0 { channels * bits.div_ceil(8) as usize } else { frame_bytes };
        let width = frame_bytes / channels;
        if width == 0 || frame_bytes % channels != 0 {
            return Err(Refusal::Not(format!("WAV of {channels} channels in frames of {frame_bytes} bytes")));
        }
        let sample = match (tag, width) {
            (PCM, 1..=4) => Sample::Integer(width),
            (FLOAT, 4) => Sample::Float32,
            (FLOAT, 8) => Sample::Float64,
            (A_LAW, 1) => Sample::ALaw,
            (MU_LAW, 1) => Sample::MuLaw,
            _ => return Err(Refusal::Not(format!("WAV of {}, {bits} bits", name_of(tag)))),
        };
        let quantum = match sample {
            Sample::Integer(width) => 0.5_f64.powi(bits.clamp(2, 8 * width as u32) as i32 - 1),
            Sample::ALaw | Sample::MuLaw => 0.5_f64.powi(12),
            Sample::Float32 | Sample::Float64 => 0.0,
        };
        Ok(Self { sample, channels, frame_bytes, rate_hz, quantum })
    }
}

/// Meaning of a format tag.
fn name_of(tag: u16) -> String {
    match tag {
        PCM => "integers".into(),
        FLOAT => "floats".into(),
        0x02 => "Microsoft ADPCM".into(),
        0x11 => "IMA ADPCM".into(),
        0x31 => "GSM 6.10".into(),
        0x50 | 0x55 => "MPEG audio".into(),
        _ => format!("format {tag:#06x}"),
    }
}

impl Sample {
    /// Full scale ±1.
    fn value(self, bytes: &[u8], big_endian: bool) -> f64 {
        let mut word = [0; 8];
        // The last byte of the word is the most significant one.
        for (i, byte) in bytes.iter().enumerate() {
            word[8 - bytes.len() + if big_endian { bytes.len() - 1 - i } else { i }] = *byte;
        }
        let bits = u64::from_le_bytes(word);
        match self {
            Self::Integer(1) => (f64::from(bytes[0]) - 128.0) / 128.0,
            // At the top of 64 bits, whatever its width.
            Self::Integer(_) => (bits as i64) as f64 / 2.0_f64.powi(63),
            Self::Float32 => f64::from(f32::from_bits((bits >> 32) as u32)),
            Self::Float64 => f64::from_bits(bits),
            Self::ALaw => f64::from(a_law(bytes[0])) / 32_768.0,
            Self::MuLaw => f64::from(mu_law(bytes[0])) / 32_768.0,
        }
    }
}

/// ITU-T G.711, as 16-bit integers.
fn a_law(byte: u8) -> i32 {
    let byte = byte ^ 0x55;
    let (segment, steps) = (i32::from(byte >> 4 & 7), i32::from(byte & 15));
    let size = if segment == 0 { 16 * steps + 8 } else { (16 * steps + 264) << (segment - 1) };
    if byte & 0x80 != 0 { size } else { -size }
}

/// ITU-T G.711, as 16-bit integers.
fn mu_law(byte: u8) -> i32 {
    let byte = !byte;
    let (segment, steps) = (i32::from(byte >> 4 & 7), i32::from(byte & 15));
    let size = ((8 * steps + 132) << segment) - 132;
    if byte & 0x80 != 0 { -size } else { size }
}

/// The numbers between chunks.
struct Head {
    reader: BufReader<File>,
    big_endian: bool,
}

impl Head {
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Refusal> {
        let mut bytes = [0; N];
        self.reader.read_exact(&mut bytes).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => Refusal::Not("WAV that ends within its header".into()),
            _ => Refusal::Io(error),
        })?;
        Ok(bytes)
    }

    fn name(&mut self) -> Result<[u8; 4], Refusal> {
        self.bytes()
    }

    fn u16(&mut self) -> Result<u16, Refusal> {
        let bytes = self.bytes()?;
        Ok(if self.big_endian { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) })
    }

    fn u32(&mut self) -> Result<u32, Refusal> {
        let bytes = self.bytes()?;
        Ok(if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    fn u64(&mut self) -> Result<u64, Refusal> {
        let bytes = self.bytes()?;
        Ok(if self.big_endian { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) })
    }
}
