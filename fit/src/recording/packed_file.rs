//! FLAC, Ogg (Vorbis or FLAC inside), AIFF, MP3, M4A and WAV of ADPCM frame by frame, decoded by `symphonia`; the only place that
//! names it.
//!
//! FLAC, AIFF and ALAC give the integers that were packed, exactly; the others what their decoders make of them. Of chained Ogg
//! streams the first is read, as libsndfile reads them.

use crate::recording::sound_format::{Format, MOST_CHANNELS, Refusal};
use std::fs::File;
use symphonia::core::codecs::audio::{AudioDecoder, AudioDecoderOptions};
use symphonia::core::errors::Error;
use symphonia::core::formats::probe::Hint;
use symphonia::core::formats::{FormatOptions, FormatReader, TrackType};
use symphonia::core::io::{MediaSourceStream, MediaSourceStreamOptions};
use symphonia::core::meta::MetadataOptions;

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
    /// What the file is, for errors.
    kind: &'static str,
}

impl PackedFile {
    pub(crate) fn open(file: File, kind: &'static str) -> Result<Self, Refusal> {
        let stream = MediaSourceStream::new(Box::new(file), MediaSourceStreamOptions::default());
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
        error => Refusal::Not(format!("{kind} with a fault: {error}")),
    }
}
