//! A held body: contacts that press on it detune and damp its modes while they do.
//!
//! Which contacts press, where and how stiffly is looked at once a cell of the absolute sample
//! grid. When that changes the groups of the bank are designed anew, one a cell, so that no cell
//! has much to do; each mode goes on at its level and phase. A body that nobody presses any more
//! gets the coefficients back that it had, to the bit.

use crate::model::mode_shapes::ModeShapes;
use crate::model::rising::rising;
use crate::model::strike_field::StrikePlace;
use crate::resource::bank::{Bank, ContactKey};
use asperity_dsp::held::{Hold, Pole, held};
use asperity_dsp::micro_contact::Probe;
use asperity_dsp::modal_bank::{GroupOptions, LANES, ModeGroup, design_group};
use asperity_dsp::mode::Mode;
use std::ops::Range;

/// Contacts that may hold a body: a hand. More press without being heard.
const HOLDS: usize = 5;
/// Modes on either side, by frequency, that pull at a mode through a finger; those further away
/// hardly do.
const NEIGHBOURS: usize = 12;

/// Contacts that hold a body, and the modes that its bank gets by them.
pub(crate) struct Holding {
    /// The groups as they were designed, and their modes.
    free: Box<[ModeGroup]>,
    modes: Box<[Mode]>,
    /// Motion of a mode over its share in the field, kg^−½.
    scale: Box<[f64]>,
    /// By rising frequency: which mode it is, and its pole.
    order: Box<[usize]>,
    poles: Box<[Pole]>,
    /// The place of each mode in that order.
    rank: Box<[usize]>,
    holds: [Press; HOLDS],
    /// The next group to be designed, while there is one.
    due: Option<usize>,
    /// Something has changed since the first of them was.
    changed: bool,
    sample_rate_hz: f64,
}

/// The modes of a group at present: the first `count` of them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HeldModes {
    pub(crate) modes: [Mode; LANES],
    pub(crate) count: usize,
}

impl HeldModes {
    /// The first of these.
    pub(crate) fn of(modes: &[Mode]) -> Self {
        let silent = Mode { frequency_hz: 1.0, decay_per_s: 0.0, amplitude: 0.0, phase_rad: 0.0 };
        let count = modes.len().min(LANES);
        Self { modes: std::array::from_fn(|lane| modes.get(lane).copied().unwrap_or(silent)), count }
    }
}

/// One contact that presses.
struct Press {
    owner: Option<ContactKey>,
    /// It pressed during the present cell.
    here: bool,
    place: StrikePlace,
    probe: Probe,
    /// Motion at its place, by rising frequency, kg^−½.
    phi_per_sqrt_kg: Box<[f64]>,
}

impl Holding {
    pub(crate) fn new(
        shapes: &ModeShapes,
        modes: &[(usize, Mode)],
        groups: &[ModeGroup],
        sample_rate_hz: f64,
    ) -> Self {
        let order = rising(&modes.iter().map(|(_, mode)| mode.frequency_hz).collect::<Vec<_>>());
        let mut rank = vec![0; modes.len()].into_boxed_slice();
        order.iter().enumerate().for_each(|(at, mode)| rank[*mode] = at);
        let pole = |mode: &Mode| Pole { decay_per_s: mode.decay_per_s, frequency_hz: mode.frequency_hz };
        let scale = modes.iter().map(|(number, mode)| {
            let gain = shapes.gains[*number];
            if gain == 0.0 { 0.0 } else { mode.amplitude / gain }
        });
        Self {
            free: groups.into(),
            modes: modes.iter().map(|(_, mode)| *mode).collect(),
            scale: scale.collect(),
            poles: order.iter().map(|mode| pole(&modes[*mode].1)).collect(),
            rank,
            holds: std::array::from_fn(|_| Press {
                owner: None,
                here: false,
                place: StrikePlace::NOWHERE,
                probe: Probe::default(),
                phi_per_sqrt_kg: vec![0.0; modes.len()].into(),
            }),
            order: order.into(),
            due: None,
            changed: false,
            sample_rate_hz,
        }
    }

    /// A contact presses during the coming cell; `share` is each mode's share in the field there.
    pub(crate) fn press(
        &mut self,
        owner: ContactKey,
        place: &StrikePlace,
        probe: &Probe,
        share: impl Fn(usize) -> f32,
    ) {
        let known = self.holds.iter().position(|press| press.owner == Some(owner));
        let free = || self.holds.iter().position(|press| press.owner.is_none());
        let Some(index) = known.or_else(free) else { return };
        let press = &mut self.holds[index];
        press.here = true;
        if press.owner == Some(owner) && press.place == *place && press.probe == *probe {
            return;
        }
        (press.owner, press.place, press.probe) = (Some(owner), *place, *probe);
        for (phi, mode) in press.phi_per_sqrt_kg.iter_mut().zip(&self.order) {
            *phi = f64::from(share(*mode)) * self.scale[*mode];
        }
        self.changed = true;
    }

    /// At the end of a cell: who did not press has let go, and one group follows what has
    /// changed; which it is.
    pub(crate) fn go_on(&mut self, bank: &mut Bank) -> Option<usize> {
        for press in &mut self.holds {
            if !std::mem::take(&mut press.here) && press.owner.take().is_some() {
                self.changed = true;
            }
        }
        if self.due.is_none() && self.changed {
            (self.due, self.changed) = (Some(0), false);
        }
        let index = self.due?;
        if let Some(group) = self.group(index) {
            bank.retune(index, &group);
        }
        self.due = Some(index + 1).filter(|next| *next < self.free.len());
        Some(index)
    }

    /// Motion of each mode where its share in the field is 1, kg^−½.
    pub(crate) fn unit_motion(&self) -> &[f64] {
        &self.scale
    }

    /// A group as it is held; none where there is no such group.
    fn group(&self, index: usize) -> Option<ModeGroup> {
        let free = self.free.get(index)?;
        if self.is_free() {
            return Some(*free);
        }
        let HeldModes { modes, count } = self.modes_now(index)?;
        // Poles of a mode that was designed once can be designed again; otherwise it stays as it
        // was.
        design_group(&modes[..count], self.sample_rate_hz, &GroupOptions::IMPULSE_RING).ok()
    }

    /// The modes of a group as they are held; none where there is no such group.
    pub(crate) fn modes_now(&self, index: usize) -> Option<HeldModes> {
        let first = index * LANES;
        let mut now = HeldModes::of(self.modes.get(first..).filter(|modes| !modes.is_empty())?);
        if !self.is_free() {
            for lane in 0..now.count {
                let Pole { decay_per_s, frequency_hz } = self.held(self.rank[first + lane])?;
                now.modes[lane] = Mode { decay_per_s, frequency_hz, ..now.modes[lane] };
            }
        }
        Some(now)
    }

    /// Tests whether nobody presses.
    fn is_free(&self) -> bool {
        self.holds.iter().all(|press| press.owner.is_none())
    }

    /// Frequency and decay of the mode of that rank now.
    fn held(&self, rank: usize) -> Option<Pole> {
        let from = rank.saturating_sub(NEIGHBOURS);
        let near = from..(rank + NEIGHBOURS + 1).min(self.poles.len());
        let poles = &self.poles[near.clone()];
        let mut pressing = self.holds.iter().filter(|press| press.owner.is_some());
        let first = pressing.next()?;
        // Without a heap: as many as there are.
        let mut holds = [first.here(&near); HOLDS];
        let mut count = 1;
        for (to, press) in holds[1..].iter_mut().zip(pressing) {
            *to = press.here(&near);
            count += 1;
        }
        held(poles, rank - from, &holds[..count])
    }
}

impl Press {
    /// Effect on the modes of a range, by rising frequency.
    fn here(&self, near: &Range<usize>) -> Hold<'_> {
        Hold { probe: &self.probe, phi_per_sqrt_kg: &self.phi_per_sqrt_kg[near.clone()] }
    }
}
