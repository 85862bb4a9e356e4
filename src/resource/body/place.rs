//! Strike position of a body: impulses that reach it there.

use crate::resource::bank::{LONGEST_CONTACT_S, MODE_LEVELS};
use crate::resource::impulse_ring::ImpulseRing;
use asperity_dsp::modal_bank::{LaneGains, OnsetCorrection};
use asperity_surface::height_field::MAX_BLOCK;

/// One strike position.
pub(super) struct Place {
    /// Gain of each lane; empty for the only position of a body.
    pub(super) gains: Vec<LaneGains>,
    /// For each level of modes left out.
    pub(super) first_samples: [OnsetCorrection; MODE_LEVELS],
    pub(super) bus: ImpulseRing,
    /// Impulses of contacts during the present stretch.
    pub(super) contacts_n_s: [f64; MAX_BLOCK],
    pub(super) touched: bool,
    /// All of it, while the stretch is rendered.
    pub(super) input: [f32; MAX_BLOCK],
    /// Something of it is in that stretch.
    pub(super) reached: bool,
    /// Its strikes alone, where pickups ask for them.
    pub(super) struck: Option<Box<[f32; MAX_BLOCK]>>,
}

impl Place {
    pub(super) fn new(
        gains: Vec<LaneGains>,
        first_samples: [OnsetCorrection; MODE_LEVELS],
        sample_rate_hz: f64,
    ) -> Self {
        let bus = ImpulseRing::new(LONGEST_CONTACT_S, sample_rate_hz);
        let (contacts_n_s, input) = ([0.0; MAX_BLOCK], [0.0; MAX_BLOCK]);
        let (touched, reached, struck) = (false, false, None);
        Self { gains, first_samples, bus, contacts_n_s, touched, input, reached, struck }
    }

    pub(super) fn is_silent(&self, position: u64) -> bool {
        !self.touched && self.bus.is_empty(position)
    }

    /// Gathers the impulses of the next `n` samples.
    pub(super) fn gather(&mut self, position: u64, n: usize) {
        let input = &mut self.input[..n];
        let busy = !self.bus.is_empty(position);
        // The bus is empty beyond the last impact.
        if busy {
            self.bus.take(position, input);
        }
        if let Some(struck) = &mut self.struck {
            struck[..n].fill(0.0);
            if busy {
                struck[..n].copy_from_slice(input);
            }
        }
        let contacts = input.iter_mut().zip(&mut self.contacts_n_s);
        match (busy, self.touched) {
            (true, true) => contacts.for_each(|(x, contact)| *x += std::mem::take(contact) as f32),
            // As if it were added to 0.
            (false, true) => contacts.for_each(|(x, contact)| *x = 0.0 + std::mem::take(contact) as f32),
            (true, false) => {}
            (false, false) => input.fill(0.0),
        }
        self.reached = busy | std::mem::take(&mut self.touched);
    }
}
