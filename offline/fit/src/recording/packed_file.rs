//! FLAC, Ogg (Vorbis or FLAC inside), AIFF, MP3, M4A and WAV of ADPCM frame by frame, decoded by
//! `symphonia`; the only place that names it.
//!
//! FLAC, AIFF and ALAC give the integers that were packed, exactly; the others what their decoders
//! make of them. Of chained Ogg streams the first is read, as libsndfile reads them.

use crate::recording::sound_format::{Format, MOST_CHANNELS, Refusal};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use symphonia::core::codecs::audio::{AudioDecoder, AudioDecoderOptions};
use symphonia::core::errors::Error;
use symphonia::core::formats::probe::Hint;
use symphonia::core::formats::{FormatOptions, FormatReader, TrackType};
use symphonia::core::io::{MediaSource, MediaSourceStream, MediaSourceStreamOptions};
use symphonia::core::meta::MetadataOptions;

/// Bytes at the end in which a tag of ID3v2 is looked for.
const TAG_REACH: u64 = 1 << 18;

/// A file up to its last tag: behind the last frame of FLAC nothing may lie, or that frame is lost.
struct Untagged {
    file: File,
    at: u64,
    bytes: u64,
}

impl Untagged {
    fn new(mut file: File) -> std::io::Result<Self> {
        let at = file.stream_position()?;
        let length = file.metadata()?.len();
        let begins = length.saturating_sub(TAG_REACH).max(at);
        file.seek(SeekFrom::Start(begins))?;
        let mut tail = Vec::new();
        file.by_ref().take(length - begins).read_to_end(&mut tail)?;
        file.seek(SeekFrom::Start(at))?;
        let old = tail.len().checked_sub(128).filter(|&place| tail[place..].starts_with(b"TAG"));
        tail.truncate(old.unwrap_or(tail.len()));
        // ID3v2 counts what lies behind its ten bytes, seven bits a byte. A tag that is a chunk of
        // AIFF belongs to the file.
        let is_chunk = |place: usize| place >= 8 && tail[place - 8..].starts_with(b"ID3 ");
        let fits = |place: &usize| match tail[*place..] {
            _ if is_chunk(*place) => false,
            [b'I', b'D', b'3', 2..=4, _, _, a, b, c, d, ..] => {
                let size = [a, b, c, d].iter().fold(0, |size, byte| size << 7 | usize::from(byte & 0x7f));
                place + 10 + size == tail.len()
            }
            _ => false,
        };
        let bytes = (1..tail.len()).find(fits).unwrap_or(tail.len());
        Ok(Self { file, at, bytes: begins + bytes as u64 })
    }
}

impl Read for Untagged {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let left = usize::try_from(self.bytes.saturating_sub(self.at)).unwrap_or(usize::MAX);
        let most = into.len().min(left);
        let read = self.file.read(&mut into[..most])?;
        self.at += read as u64;
        Ok(read)
    }
}

impl Seek for Untagged {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        let to = match to {
            SeekFrom::End(by) => SeekFrom::Start(self.bytes.saturating_add_signed(by)),
            to => to,
        };
        self.at = self.file.seek(to)?;
        Ok(self.at)
    }
}

impl MediaSource for Untagged {
    fn is_seekable(&self) -> bool {
        true
    }

    fn byte_len(&self) -> Option<u64> {
        Some(self.bytes)
    }
}

/// A packed file.
pub(crate) struct PackedFile {
    reader: Box<dyn FormatReader>,
    decoder: Box<dyn AudioDecoder>,
    track: u32,
    format: Format,
    /// Samples of the present packet, frame by frame, and how many of them have been read.
    samples: Vec<f64>,
    read: usize,
    frames_read: u64,
    truncated: bool,
    ended: bool,
    /// Kind of the file, for errors.
    kind: &'static str,
}

impl PackedFile {
    pub(crate) fn open(file: File, kind: &'static str) -> Result<Self, Refusal> {
        let stream =
            MediaSourceStream::new(Box::new(Untagged::new(file)?), MediaSourceStreamOptions::default());
        let (format, meta) = (FormatOptions::default(), MetadataOptions::default());
        let reader = symphonia::default::get_probe()
            .probe(&Hint::new(), stream, format, meta)
            .map_err(|e| refusal(e, kind))?;
        let unknown = || Refusal::Not(format!("{kind} without a sound that can be decoded; Opus cannot"));
        let track = reader.default_track(TrackType::Audio).ok_or_else(unknown)?;
        let parameters =
            track.codec_params.as_ref().and_then(|parameters| parameters.audio()).ok_or_else(unknown)?;
        let decoder = symphonia::default::get_codecs()
            .make_audio_decoder(parameters, &AudioDecoderOptions::default())
            .map_err(|_| unknown())?;
        let channels = parameters.channels.as_ref().map_or(0, |channels| channels.count());
        if channels == 0 || channels > MOST_CHANNELS {
            return Err(Refusal::Not(format!("{kind} of {channels} channels")));
        }
        let bits = parameters.bits_per_sample.unwrap_or(0);
        let format = Format {
            channels,
            rate_hz: f64::from(parameters.sample_rate.unwrap_or(0)),
            quantum: if bits == 0 { 0.0 } else { 0.5_f64.powi(bits as i32 - 1) },
            frames: track.num_frames.unwrap_or(u64::MAX),
        };
        let track = track.id;
        let samples = Vec::new();
        Ok(Self {
            reader,
            decoder,
            track,
            format,
            samples,
            read: 0,
            frames_read: 0,
            truncated: false,
            ended: false,
            kind,
        })
    }

    pub(crate) fn format(&self) -> Format {
        self.format
    }

    pub(crate) fn truncated(&self) -> bool {
        self.truncated
    }

    pub(crate) fn next(&mut self, frame: &mut [f64]) -> Result<bool, Refusal> {
        let channels = self.format.channels;
        // Behind the last frame tags may lie, which are no packets.
        if self.frames_read >= self.format.frames {
            return Ok(false);
        }
        while self.read + channels > self.samples.len() {
            if self.ended || !self.packet()? {
                let said = self.format.frames;
                self.truncated |= said != u64::MAX && self.frames_read < said;
                return Ok(false);
            }
        }
        frame.copy_from_slice(&self.samples[self.read..self.read + channels]);
        self.read += channels;
        self.frames_read += 1;
        Ok(true)
    }

    /// Decodes the next packet; `false` at the end, wherever the file has it.
    fn packet(&mut self) -> Result<bool, Refusal> {
        let broken_off = |error: &Error| matches!(error, Error::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof);
        let decoded = match self.reader.next_packet() {
            Ok(None) => {
                self.ended = true;
                return Ok(false);
            }
            Ok(Some(packet)) if packet.track_id != self.track => return Ok(true),
            // Another stream is chained on.
            Err(Error::ResetRequired) => {
                self.ended = true;
                return Ok(false);
            }
            Ok(Some(packet)) => self.decoder.decode(&packet),
            Err(error) => Err(error),
        };
        match decoded {
            Ok(buffer) => {
                if buffer.spec().channels().count() != self.format.channels {
                    return Err(Refusal::Not(format!("{} whose number of channels changes", self.kind)));
                }
                buffer.copy_to_vec_interleaved(&mut self.samples);
                self.read = 0;
                Ok(true)
            }
            Err(error) if broken_off(&error) => {
                (self.ended, self.truncated) = (true, true);
                Ok(false)
            }
            Err(error) => Err(refusal(error, self.kind)),
        }
    }
}

fn refusal(error: Error, kind: &str) -> Refusal {
    match error {
        Error::IoError(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => Refusal::Io(error),
        // A packing of AIFF-C (GSM, IMA, DWVW) or of another file that has no decoder here.
        Error::Unsupported(what) => Refusal::Not(format!("{kind} packed in a way that is not read: {what}")),
        error => Refusal::Not(format!("{kind} with a fault: {error}")),
    }
}
