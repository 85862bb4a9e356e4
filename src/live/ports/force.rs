//! Force port: the 3-D force on the finger for force-feedback devices, as means over a tick of the device's own rate.
//!
//! ```text
//! row(tick, contact) = mean over the tick's samples of (contact + friction + texture + what the surface does by itself)
//! row(tick, hand)    = Σ over the contacts that the hand's actuator feels
//! ```
//!
//! x and y lie along the surface's u and v, z points out of it. Contacts of one hand on surfaces that lie differently are summed in each
//! surface's own frame. `asperity render --force` writes the same rows.

use crate::link::outlet::{Opened, Outlet, PortKind, PortSetup};
use crate::link::overwriting::{Reader, Writer, ring};
use crate::link::tap::ContactBlock;
use crate::model::bad_value::within;
use crate::model::error::AddError;
use crate::model::event::{Actuator, ContactId};
use asperity_dsp::limits;

/// A port of forces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Force {
    /// Rows a second and contact, Hz; up to the sample rate.
    pub rate_hz: f64,
    /// How much a late reader still finds, s; 1 ms to 60 s.
    pub holds_s: f64,
}

/// Whose force a row tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Of {
    /// One contact's.
    Contact(ContactId),
    /// The sum of all contacts that this channel's hand feels.
    Hand(Actuator),
}

/// A force during one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceRow {
    /// The tick: its beginning is `tick / rate_hz` seconds after sample 0.
    pub tick: u64,
    /// Whose force.
    pub of: Of,
    /// Along u, v and out of the surface, N.
    pub force_n: [f64; 3],
}

/// Means of the force over ticks, contact by contact.
#[derive(Debug, Clone)]
pub struct ForceMeans {
    rate_hz: f64,
    sample_rate_hz: f64,
    open: Vec<OpenRow>,
}

#[derive(Debug, Clone, Copy)]
struct OpenRow {
    tick: u64,
    contact: ContactId,
    actuator: Option<Actuator>,
    count: f64,
    sum_n: [f64; 3],
}

impl ForceMeans {
    /// For `rate_hz` rows a second. Allocates room for `contacts` at once; more make it allocate later.
    #[must_use]
    pub fn new(rate_hz: f64, sample_rate_hz: f64, contacts: usize) -> Self {
        // A stretch of samples may touch several ticks.
        let ticks = (64.0 * rate_hz / sample_rate_hz).ceil() as usize + 2;
        Self { rate_hz, sample_rate_hz, open: Vec::with_capacity(contacts * ticks) }
    }

    /// The tick that a sample lies in.
    fn tick(&self, sample: u64) -> u64 {
        (sample as f64 * self.rate_hz / self.sample_rate_hz + 1e-9) as u64
    }

    /// Adds what a contact does during a stretch.
    pub fn add(&mut self, block: &ContactBlock<'_>) {
        for (sample, force_n) in (block.first_sample..).zip(block.force_n) {
            let (tick, contact) = (self.tick(sample), block.contact);
            match self.open.iter_mut().find(|row| (row.tick, row.contact) == (tick, contact)) {
                Some(row) => {
                    row.count += 1.0;
                    row.sum_n = std::array::from_fn(|axis| row.sum_n[axis] + force_n[axis]);
                }
                None => {
                    let actuator = block.actuator;
                    self.open.push(OpenRow { tick, contact, actuator, count: 1.0, sum_n: *force_n });
                }
            }
        }
    }

    /// Hands out the rows of every tick that ends before a sample: the contacts of a tick in order, then the hands.
    pub fn close(&mut self, before: u64, mut row: impl FnMut(ForceRow)) {
        let before = self.tick(before);
        if !self.open.iter().any(|open| open.tick < before) {
            return;
        }
        self.open.sort_unstable_by_key(|open| (open.tick, open.contact));
        let done = self.open.partition_point(|open| open.tick < before);
        for tick in self.open[..done].chunk_by(|a, b| a.tick == b.tick) {
            tick.iter().for_each(|open| row(open.row(Of::Contact(open.contact))));
            for (index, open) in tick.iter().enumerate() {
                let Some(hand) = open.actuator else { continue };
                let felt_by_hand = |open: &&OpenRow| open.actuator == Some(hand);
                if tick[..index].iter().any(|open| felt_by_hand(&open)) {
                    continue;
                }
                let forces_n = tick[index..].iter().filter(felt_by_hand).map(OpenRow::mean_n);
                let force_n = forces_n.fold([0.0; 3], |a, b| std::array::from_fn(|axis| a[axis] + b[axis]));
                row(ForceRow { tick: open.tick, of: Of::Hand(hand), force_n });
            }
        }
        self.open.drain(..done);
    }
}

impl OpenRow {
    fn mean_n(&self) -> [f64; 3] {
        self.sum_n.map(|sum_n| sum_n / self.count)
    }

    fn row(&self, of: Of) -> ForceRow {
        ForceRow { tick: self.tick, of, force_n: self.mean_n() }
    }
}

/// Words of a row in the ring: tick, kind, name, three forces, and one that is free.
const ROW_WORDS: usize = 16;

/// Reads forces.
pub struct ForcePort {
    words: Reader,
    rate_hz: f64,
}

struct ForceOutlet {
    words: Writer,
    means: ForceMeans,
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
        let means = ForceMeans::new(self.rate_hz, setup.sample_rate_hz, setup.voices);
        let port = ForcePort { words: reader, rate_hz: self.rate_hz };
        Ok(Opened { outlet: Some(Box::new(ForceOutlet { words: writer, means })), port })
    }
}

impl Outlet for ForceOutlet {
    fn watches_contacts(&self) -> bool {
        true
    }

    fn contact(&mut self, block: &ContactBlock<'_>) {
        self.means.add(block);
    }

    fn shown(&mut self, before: u64) {
        let words = &mut self.words;
        self.means.close(before, |row| words.write(packed(&row).into_iter()));
    }

    fn is_closed(&self) -> bool {
        self.words.is_closed()
    }
}

fn packed(row: &ForceRow) -> [u32; ROW_WORDS] {
    let (kind, name) = match row.of {
        Of::Contact(ContactId(name)) => (0, name),
        Of::Hand(Actuator(channel)) => (1, u64::from(channel)),
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
        _ => Of::Hand(Actuator(value(2) as u16)),
    };
    ForceRow { tick: value(0), of, force_n: [3, 4, 5].map(|index| f64::from_bits(value(index))) }
}

impl ForcePort {
    /// The oldest row that is left.
    pub fn read(&mut self) -> Option<ForceRow> {
        let mut words = [0; ROW_WORDS];
        (self.words.read(&mut words) == ROW_WORDS).then(|| unpacked(&words))
    }

    /// The newest force of a hand, N, and its tick; what lies before is passed over, and is not counted as lost. For a device loop that
    /// wants the present and nothing else.
    pub fn newest(&mut self, hand: Actuator) -> Option<(u64, [f64; 3])> {
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
