//! Force port: the 3-D force on the finger for force-feedback devices, as [rows](super::ForceRows)
//! at the ticks of the device's own rate.
//!
//! x and y lie along the surface's u and v, z points out of it. Contacts of one hand on surfaces
//! that lie differently are summed in each surface's own frame. `asperity render --force` writes
//! the same rows. A row leaves 4 ticks after its own, so it is what a tool feels of textures and
//! blows; a loop that holds a device against a wall runs [`Scene::tip_law`](crate::Scene::tip_law)
//! on its own thread.

use super::force_rows::{ForceRow, ForceRows, Of};
use crate::link::outlet::{Opened, Outlet, PortKind, PortSetup};
use crate::link::overwriting::{Reader, Writer, ring};
use crate::link::tap::ContactBlock;
use crate::model::bad_value::within;
use crate::model::error::AddError;
use crate::model::event::{ChannelId, ContactId};
use asperity_dsp::limits;

/// A port of forces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Force {
    /// Rows a second and contact, Hz; up to the sample rate.
    pub rate_hz: f64,
    /// Span that a late reader still finds, s; 1 ms to 60 s.
    pub holds_s: f64,
}

/// Words of a row in the ring: tick, kind, name, three forces, and one that is free.
const ROW_WORDS: usize = 16;

/// Reads forces.
#[derive(Debug)]
pub struct ForcePort {
    words: Reader,
    rate_hz: f64,
}

struct ForceOutlet {
    words: Writer,
    rows: ForceRows,
}

impl PortKind for Force {
    type Port = ForcePort;

    fn open(self, setup: &PortSetup<'_>) -> Result<Opened<ForcePort>, AddError> {
        within("holds_s", self.holds_s, limits::output::PORT_HOLDS_S)?;
        within("rate_hz", self.rate_hz, limits::output::FORCE_RATE_HZ)?;
        let most = limits::Range::new(1.0, setup.sample_rate_hz, "at most the sample rate");
        within("rate_hz", self.rate_hz, most)?;
        // A row a tick for some contacts and their hand; with more contacts it holds less long.
        let (writer, reader) = ring((8.0 * self.holds_s * self.rate_hz).ceil() as usize, ROW_WORDS);
        let rows = ForceRows::new(self.rate_hz, setup.sample_rate_hz, setup.voices);
        let port = ForcePort { words: reader, rate_hz: self.rate_hz };
        Ok(Opened { outlet: Some(Box::new(ForceOutlet { words: writer, rows })), port })
    }
}

impl Outlet for ForceOutlet {
    fn watches_contacts(&self) -> bool {
        true
    }

    fn contact(&mut self, block: &ContactBlock<'_>) {
        self.rows.add(block);
    }

    fn shown(&mut self, before: u64) {
        let words = &mut self.words;
        self.rows.close(before, |row| words.write(packed(&row).into_iter()));
    }

    fn is_closed(&self) -> bool {
        self.words.is_closed()
    }
}

fn packed(row: &ForceRow) -> [u32; ROW_WORDS] {
    let (kind, name) = match row.of {
        Of::Contact(ContactId(name)) => (0, name),
        Of::Hand(ChannelId(channel)) => (1, u64::from(channel)),
    };
    let [x, y, z] = row.force_n.map(f64::to_bits);
    let mut words = [0; ROW_WORDS];
    for (pair, value) in words.chunks_exact_mut(2).zip([row.tick, kind, name, x, y, z]) {
        pair.copy_from_slice(&[value as u32, (value >> 32) as u32]);
    }
    words
}

fn unpacked(words: &[u32; ROW_WORDS]) -> ForceRow {
    let value = |index: usize| u64::from(words[2 * index]) | u64::from(words[2 * index + 1]) << 32;
    let of = match value(1) {
        0 => Of::Contact(ContactId(value(2))),
        _ => Of::Hand(ChannelId(value(2) as u16)),
    };
    ForceRow { tick: value(0), of, force_n: [3, 4, 5].map(|index| f64::from_bits(value(index))) }
}

impl ForcePort {
    /// The oldest row that is left.
    pub fn read(&mut self) -> Option<ForceRow> {
        let mut words = [0; ROW_WORDS];
        (self.words.read(&mut words) == ROW_WORDS).then(|| unpacked(&words))
    }

    /// The newest force of a hand, N, and its tick; what lies before is passed over, and is not
    /// counted as lost. For a device loop that wants the present and nothing else.
    pub fn newest(&mut self, hand: ChannelId) -> Option<(u64, [f64; 3])> {
        let rows = std::iter::from_fn(|| self.read());
        rows.filter(|row| row.of == Of::Hand(hand)).last().map(|row| (row.tick, row.force_n))
    }

    /// Rows a second, Hz.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Rows that were overwritten before they were read.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.words.lost() / ROW_WORDS as u64
    }
}
