//! PCM port: the samples of a haptic channel, an audio bus or a pickup, exactly as they leave the
//! engine.

use super::Feed;
use crate::link::outlet::{Opened, Outlet, PortKind, PortSetup};
use crate::link::overwriting::{Reader, Writer, ring};
use crate::model::bad_value::within;
use crate::model::error::AddError;
use crate::model::event::ChannelId;
use asperity_dsp::limits;

/// A port of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pcm {
    /// Which signal.
    pub from: Feed,
    /// Span that a late reader still finds, s; 1 ms to 60 s.
    pub holds_s: f64,
}

/// Reads samples.
#[derive(Debug)]
pub struct PcmPort {
    words: Reader,
    sample_rate_hz: f64,
    read: u64,
    /// Words on their way out of the ring.
    chunk: [u32; 256],
}

struct PcmOutlet {
    words: Writer,
    from: Feed,
}

impl PortKind for Pcm {
    type Port = PcmPort;

    fn open(self, setup: &PortSetup<'_>) -> Result<Opened<PcmPort>, AddError> {
        within("holds_s", self.holds_s, limits::output::PORT_HOLDS_S)?;
        self.from.check(setup)?;
        let (writer, reader) = ring((self.holds_s * setup.sample_rate_hz).ceil() as usize, 1);
        let port = PcmPort { words: reader, sample_rate_hz: setup.sample_rate_hz, read: 0, chunk: [0; 256] };
        Ok(Opened { outlet: Some(Box::new(PcmOutlet { words: writer, from: self.from })), port })
    }
}

impl Outlet for PcmOutlet {
    fn haptic(&mut self, channel: usize, _first: u64, samples: &[f32]) {
        if self.from == Feed::Haptic(ChannelId(channel as u16)) {
            self.words.write(samples.iter().map(|x| x.to_bits()));
        }
    }

    fn bus(&mut self, bus: usize, _first: u64, samples: &[f32]) {
        if self.from == Feed::Bus(bus) {
            self.words.write(samples.iter().map(|x| x.to_bits()));
        }
    }

    fn pickup(&mut self, channel: usize, _first: u64, samples: &[f32]) {
        if self.from == Feed::Pickup(channel) {
            self.words.write(samples.iter().map(|x| x.to_bits()));
        }
    }

    fn is_closed(&self) -> bool {
        self.words.is_closed()
    }
}

impl PcmPort {
    /// Copies the oldest samples that are left into `out`; returns how many. What lies behind them
    /// in `out` stays as it was.
    pub fn read(&mut self, out: &mut [f32]) -> usize {
        let mut count = 0;
        while count < out.len() {
            let most = (out.len() - count).min(self.chunk.len());
            let got = self.words.read(&mut self.chunk[..most]);
            if got == 0 {
                break;
            }
            for (x, bits) in out[count..].iter_mut().zip(&self.chunk[..got]) {
                *x = f32::from_bits(*bits);
            }
            count += got;
        }
        self.read += count as u64;
        count
    }

    /// Rate of the samples, Hz.
    #[must_use]
    pub fn sample_rate_hz(&self) -> f64 {
        self.sample_rate_hz
    }

    /// Samples that wait to be read.
    #[must_use]
    pub fn waiting(&self) -> u64 {
        self.words.waiting()
    }

    /// Samples that were overwritten before they were read.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.words.lost()
    }

    /// Number of samples since the port was opened that lie before the next one to be read: those
    /// read and those lost. The first one is the first of the block that was rendered next after
    /// the opening.
    #[must_use]
    pub fn position(&self) -> u64 {
        self.read + self.words.lost()
    }
}
