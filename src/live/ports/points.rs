//! Points port: an amplitude and a frequency some hundred times a second, for hardware that plays
//! no waveform.
//!
//! The points are those of the kernel [`vibration_points`](asperity_dsp::vibration_points): what a
//! file made of the same samples by the causal reduction holds, to the bit. The samples are taken
//! for displacement, so a channel that gives acceleration sounds too high.

use super::Feed;
use crate::link::outlet::{Opened, Outlet, PortKind, PortSetup};
use crate::link::overwriting::{Reader, Writer, ring};
use crate::model::bad_value::within;
use crate::model::error::AddError;
use crate::model::event::ChannelId;
use asperity_dsp::limits;
pub use asperity_dsp::vibration_points::{Point, PointSettings, Tone};
use asperity_dsp::vibration_points::{PointDesign, PointState};

/// A port of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Points {
    /// Which signal.
    pub from: Feed,
    /// Number a second, range of frequencies, and tone.
    pub settings: PointSettings,
    /// Span that a late reader still finds, s; 1 ms to 60 s.
    pub holds_s: f64,
}

/// Reads points.
#[derive(Debug)]
pub struct PointsPort {
    words: Reader,
    rate_hz: f64,
}

struct PointsOutlet {
    words: Writer,
    from: Feed,
    design: PointDesign,
    state: PointState,
}

/// Words of a point in the ring: tick, amplitude, frequency, low, high, and three that are free.
const POINT_WORDS: usize = 16;

impl PortKind for Points {
    type Port = PointsPort;

    fn open(self, setup: &PortSetup<'_>) -> Result<Opened<PointsPort>, AddError> {
        within("holds_s", self.holds_s, limits::output::PORT_HOLDS_S)?;
        self.from.check(setup)?;
        let design = PointDesign::new(self.settings, setup.sample_rate_hz)?;
        let rate_hz = design.rate_hz();
        let (writer, reader) = ring((self.holds_s * rate_hz).ceil() as usize, POINT_WORDS);
        let outlet = PointsOutlet { words: writer, from: self.from, design, state: PointState::default() };
        Ok(Opened { outlet: Some(Box::new(outlet)), port: PointsPort { words: reader, rate_hz } })
    }
}

impl PointsOutlet {
    fn take(&mut self, samples: &[f32]) {
        for sample in samples {
            if let Some(point) = self.state.tick(&self.design, f64::from(*sample)) {
                self.words.write(packed(&point).into_iter());
            }
        }
    }
}

impl Outlet for PointsOutlet {
    fn haptic(&mut self, channel: usize, _first: u64, samples: &[f32]) {
        if self.from == Feed::Haptic(ChannelId(channel as u16)) {
            self.take(samples);
        }
    }

    fn bus(&mut self, bus: usize, _first: u64, samples: &[f32]) {
        if self.from == Feed::Bus(bus) {
            self.take(samples);
        }
    }

    fn is_closed(&self) -> bool {
        self.words.is_closed()
    }
}

fn packed(point: &Point) -> [u32; POINT_WORDS] {
    let values = [point.amplitude, point.frequency_hz, point.low, point.high].map(f64::to_bits);
    let mut words = [0; POINT_WORDS];
    for (pair, value) in words.chunks_exact_mut(2).zip([point.tick].into_iter().chain(values)) {
        pair.copy_from_slice(&[value as u32, (value >> 32) as u32]);
    }
    words
}

fn unpacked(words: &[u32; POINT_WORDS]) -> Point {
    let value = |index: usize| u64::from(words[2 * index]) | u64::from(words[2 * index + 1]) << 32;
    let [amplitude, frequency_hz, low, high] = [1, 2, 3, 4].map(|index| f64::from_bits(value(index)));
    Point { tick: value(0), amplitude, frequency_hz, low, high }
}

impl PointsPort {
    /// The oldest point that is left. Ticks count from the opening of the port.
    pub fn read(&mut self) -> Option<Point> {
        let mut words = [0; POINT_WORDS];
        (self.words.read(&mut words) == POINT_WORDS).then(|| unpacked(&words))
    }

    /// Points a second, Hz.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Points that were overwritten before they were read.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.words.lost() / POINT_WORDS as u64
    }
}
