//! Blows that are felt: the Hertz pulse of an impact through the mobility of what holds the
//! striker.
//!
//! ```text
//! F(t) = J/τ · p(t/τ)  →  mobility (`dsp::mobility`)  →  pad motion  →  the channel's high-pass  →  the channel's sum
//! ```
//! A channel that plays force has F(t) itself.
//! Everything is linear, so all blows that one probe sends to one channel share a state, and
//! nothing is computed while nothing moves.

use super::shared::Shared;
use crate::link::message::Felt;
use crate::model::stamp::Stamp;
use crate::resource::bank::LONGEST_CONTACT_S;
use asperity_dsp::actuator::{ContactOutput, ContactOutputState, Quantity};
use asperity_dsp::hertz::HertzPulse;
use asperity_dsp::mobility::MobilityState;
use asperity_surface::height_field::MAX_BLOCK;

/// Pairs of probe and channel that feel blows at the same time; a further one takes the place of
/// the one struck first.
const AT_ONCE: usize = 16;

/// A sample of a blow: how the pad moves, and the force.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Blow {
    pad_m: f64,
    pad_velocity_m_s: f64,
    force_n: f64,
}

impl Blow {
    /// The quantity that a channel plays of it.
    pub(crate) fn felt(&self, design: &ContactOutput, state: &mut ContactOutputState) -> f64 {
        let played = if design.quantity() == Quantity::Force { self.force_n } else { self.pad_m };
        state.tick(design, played, self.pad_velocity_m_s)
    }
}

/// Blows felt at present, in memory made at the start.
pub(crate) struct Blows {
    pairs: [Pair; AT_ONCE],
    /// Number of them that feel anything: mostly none, and looking at each would cost a short block
    /// as much as a stage does.
    busy: usize,
}

/// The blows that one probe sends to one channel.
struct Pair {
    felt: Option<Felt>,
    struck: u64,
    state: MobilityState,
    output: Option<ContactOutputState>,
    /// Impulses of the coming samples, N·s.
    ring: Vec<f64>,
    busy_until: u64,
}

impl Blows {
    pub(crate) fn new(sample_rate_hz: f64) -> Self {
        let samples = ((LONGEST_CONTACT_S * sample_rate_hz) as usize + 16).next_power_of_two();
        Self { pairs: std::array::from_fn(|_| Pair::new(samples)), busy: 0 }
    }

    /// A blow whose contact begins at `stamp`.
    pub(crate) fn strike(
        &mut self,
        felt: Felt,
        output: &ContactOutput,
        pulse: &HertzPulse,
        stamp: Stamp,
        position: u64,
        sample_rate_hz: f64,
    ) {
        let index = self.pairs.iter().position(|pair| pair.felt == Some(felt)).or_else(|| {
            let oldest =
                self.pairs.iter().enumerate().min_by_key(|(_, pair)| (pair.felt.is_some(), pair.struck));
            oldest.map(|(index, _)| index)
        });
        let Some(pair) = index.map(|index| &mut self.pairs[index]) else { return };
        if pair.felt != Some(felt) {
            self.busy += usize::from(pair.felt.is_none());
            pair.begin(felt, output);
        }
        pair.struck = position;
        pulse.deposit(&mut pair.ring, stamp.sample(), stamp.fraction(), sample_rate_hz);
        pair.busy_until = pair.busy_until.max(pulse.end_sample(stamp.sample(), sample_rate_hz));
    }

    /// Hands the pad motion of each pair to its channel.
    pub(crate) fn render(
        &mut self,
        shared: &Shared,
        position: u64,
        n: usize,
        mut add: impl FnMut(usize, &mut ContactOutputState, &[Blow]),
    ) {
        if self.busy == 0 {
            return;
        }
        for pair in &mut self.pairs {
            let Some(Felt { channel, probe }) = pair.felt else { continue };
            let design = &shared.probe(probe).mobility;
            // A ring holds a pulse under a kernel that reaches two samples to either side; read
            // that much ahead, it is undelayed.
            let ahead = position + 1 + shared.row_latency as u64;
            let mask = pair.ring.len() - 1;
            let mut moves = [Blow::default(); MAX_BLOCK];
            for (i, moved) in moves[..n].iter_mut().enumerate() {
                let cell = &mut pair.ring[(ahead as usize).wrapping_add(i) & mask];
                let force_n = std::mem::take(cell) * shared.sample_rate_hz;
                let [pad_m, pad_velocity_m_s] = pair.state.tick(design, force_n);
                *moved = Blow { pad_m, pad_velocity_m_s, force_n };
            }
            if let Some(output) = &mut pair.output {
                add(channel, output, &moves[..n]);
            }
            let end = position + n as u64;
            // On the absolute grid, so that it ends in the same sample however time is cut.
            if end.is_multiple_of(MAX_BLOCK as u64) && pair.busy_until <= end && pair.state.is_still() {
                pair.felt = None;
                self.busy -= 1;
            }
        }
    }
}

impl Pair {
    fn new(samples: usize) -> Self {
        Self {
            felt: None,
            struck: 0,
            state: MobilityState::default(),
            output: None,
            ring: vec![0.0; samples],
            busy_until: 0,
        }
    }

    fn begin(&mut self, felt: Felt, output: &ContactOutput) {
        if self.felt.is_some() {
            self.ring.fill(0.0);
        }
        self.felt = Some(felt);
        self.state = MobilityState::default();
        self.output = Some(ContactOutputState::begin(output, 0.0, 0.0));
        self.busy_until = 0;
    }
}
