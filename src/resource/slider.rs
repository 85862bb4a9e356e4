//! Slider: the input of one contact into the modal bank of a body, with gains that follow where it
//! is.
//!
//! Gains glide to those of the place reported last, a step every cell of the absolute sample grid,
//! and inside a cell along a straight line, which is the same impulses twice: fading out with the
//! gains that were, fading in with those that come. So the bank gets no step, whatever the blocks.

use crate::model::strike_field::StrikePlace;
use crate::resource::bank::ContactKey;
use asperity_dsp::modal_bank::{Input, LANES, LaneGains};
use asperity_surface::height_field::MAX_BLOCK;

/// Time in which gains follow a contact, s: less than the time between two reports of an ordinary
/// game.
const GLIDE_S: f64 = 0.008;
/// A gain nearer than this to where it goes is there.
const ARRIVED: f32 = 1e-6;

/// Largest change of a gain within a cell.
pub(crate) fn glide(sample_rate_hz: f64) -> f32 {
    (1.0 - libm::exp(-(MAX_BLOCK as f64) / (GLIDE_S * sample_rate_hz))) as f32
}

/// A contact.
pub(crate) struct Slider {
    pub(crate) owner: Option<ContactKey>,
    place: StrikePlace,
    /// At the beginning of the cell, at its end, and where they go.
    gains: [Box<[LaneGains]>; 3],
    arrived: bool,
    pub(crate) touched: bool,
    /// Last touch.
    pub(crate) touched_at: u64,
    contacts_n_s: [f64; MAX_BLOCK],
    inputs: [[f32; MAX_BLOCK]; 2],
}

impl Slider {
    /// Unused slider, for so many groups of modes.
    pub(crate) fn new(groups: usize) -> Self {
        let gains = || vec![LaneGains([0.0; LANES]); groups].into_boxed_slice();
        Self {
            owner: None,
            place: StrikePlace::NOWHERE,
            gains: [gains(), gains(), gains()],
            arrived: true,
            touched: false,
            touched_at: 0,
            contacts_n_s: [0.0; MAX_BLOCK],
            inputs: [[0.0; MAX_BLOCK]; 2],
        }
    }

    /// This contact is at this place; `fill` writes the gains there.
    pub(crate) fn be_at(
        &mut self,
        owner: ContactKey,
        place: &StrikePlace,
        fill: impl FnOnce(&mut [LaneGains]),
    ) {
        let known = self.owner == Some(owner);
        if known && self.place == *place {
            return;
        }
        self.place = *place;
        fill(&mut self.gains[2]);
        self.arrived = !known;
        if !known {
            self.owner = Some(owner);
            let [from, to, wanted] = &mut self.gains;
            from.copy_from_slice(wanted);
            to.copy_from_slice(wanted);
        }
    }

    /// The gains that the present cell ends with.
    pub(crate) fn gains(&self) -> &[LaneGains] {
        &self.gains[1]
    }

    /// Adds what it sends during the present stretch.
    pub(crate) fn add(&mut self, impulse_n_s: &[f64]) {
        self.touched = true;
        for (sum, x) in self.contacts_n_s.iter_mut().zip(impulse_n_s) {
            *sum += x;
        }
    }

    /// Drops what is on its way.
    pub(crate) fn silence(&mut self) {
        self.contacts_n_s.fill(0.0);
        self.touched = false;
    }

    /// Takes the impulses of the next `n` samples, which begin at sample `first` of the cell.
    pub(crate) fn gather(&mut self, first: usize, n: usize) {
        let [out, into] = &mut self.inputs;
        for i in 0..n {
            let x = std::mem::take(&mut self.contacts_n_s[i]) as f32;
            let part = (first + i + 1) as f32 / MAX_BLOCK as f32;
            (out[i], into[i]) = if self.arrived { (0.0, x) } else { (x * (1.0 - part), x * part) };
        }
    }

    /// Hands over the inputs that were gathered.
    pub(crate) fn inputs<'a>(&'a self, n: usize, add: &mut impl FnMut(Input<'a>)) {
        if !self.arrived {
            add(Input { impulses: &self.inputs[0][..n], gains: &self.gains[0] });
        }
        add(Input { impulses: &self.inputs[1][..n], gains: &self.gains[1] });
    }

    /// Tests whether nothing is on its way.
    pub(crate) fn is_silent(&self) -> bool {
        !self.touched
    }

    /// The stretch up to `position` has been rendered; at the end of a cell gains go on.
    pub(crate) fn end_stretch(&mut self, position: u64, glide: f32) {
        if std::mem::take(&mut self.touched) {
            self.touched_at = position;
        }
        if position.is_multiple_of(MAX_BLOCK as u64) && !self.arrived {
            self.go_on(glide);
        }
    }

    /// The gains of the next cell.
    fn go_on(&mut self, glide: f32) {
        let [from, to, wanted] = &mut self.gains;
        from.copy_from_slice(to);
        let mut farthest = 0.0_f32;
        for (to, wanted) in to.iter_mut().zip(wanted.iter()) {
            for (to, wanted) in to.0.iter_mut().zip(&wanted.0) {
                let way = wanted - *to;
                farthest = farthest.max(way.abs());
                *to += glide * way;
            }
        }
        if farthest < ARRIVED {
            to.copy_from_slice(wanted);
            from.copy_from_slice(wanted);
            self.arrived = true;
        }
    }
}
