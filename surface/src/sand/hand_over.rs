//! Hand-over: the rings between the audio half's end of the sand and the simulation's, and what a
//! contact reads meanwhile.
//!
//! Both directions are lock-free rings of a fixed size whose ends never wait: a full ring drops the
//! pose (the next one says more), a missing patch leaves the old one in use. Patches are boxes made
//! beforehand that travel in a circle, so that neither side allocates.

use super::law::SandLaw;
use super::patch::Patch;
use super::simulation::{FRAMES_PER_S, Pose, SandSimulation};
use super::worker::{Far, NewEnds};
use crate::exclusive::Exclusive;
use crate::height_field::MAX_BLOCK;

/// Patches in circulation for every contact, besides the one it landed on: one that fades out, one
/// that fades in, one that waits, one under way.
pub(super) const PATCHES_A_CONTACT: usize = 4;

/// Place where the simulation runs.
pub(super) enum Link {
    Here(Box<SandSimulation>),
    Elsewhere {
        near: Near,
        /// Place where the worker finds the other ends of new rings.
        line: NewEnds,
    },
}

/// The audio half's ends of the rings.
pub(super) struct Near {
    pub(super) poses: Exclusive<rtrb::Producer<Pose>>,
    pub(super) laws: Exclusive<rtrb::Producer<SandLaw>>,
    pub(super) patches: Exclusive<rtrb::Consumer<Box<Patch>>>,
    pub(super) back: Exclusive<rtrb::Producer<Box<Patch>>>,
}

/// Patches in circulation for so many contacts.
pub(super) fn circulating(contacts: usize) -> usize {
    contacts * PATCHES_A_CONTACT + 2
}

/// New rings for so many contacts: the worker's ends and the audio half's.
pub(super) fn rings(contacts: usize) -> (Far, Near) {
    let count = circulating(contacts);
    let (poses, poses_out) = rtrb::RingBuffer::new(contacts * 64);
    let (laws, laws_out) = rtrb::RingBuffer::new(4);
    let (patches_in, patches_out) = rtrb::RingBuffer::new(count);
    let (back, back_out) = rtrb::RingBuffer::new(count);
    let far = Far {
        touched: vec![false; contacts],
        poses: poses_out,
        laws: laws_out,
        patches: patches_in,
        back: back_out,
        spare: patches(count),
    };
    let near = Near {
        poses: Exclusive::new(poses),
        laws: Exclusive::new(laws),
        patches: Exclusive::new(patches_out),
        back: Exclusive::new(back),
    };
    (far, near)
}

/// Data that one contact reads.
pub(super) struct Slot {
    /// The sand that it landed on.
    pub(super) ground: Box<Patch>,
    pub(super) old: Option<Box<Patch>>,
    pub(super) new: Option<Box<Patch>>,
    pub(super) waiting: Option<Box<Patch>>,
    pub(super) fade_start: u64,
    /// Sample of the next touch, if the contact stays down; `None` before the first.
    pub(super) next_touch: Option<u64>,
    /// The simulation has not been informed yet that the contact has landed.
    pub(super) landed: bool,
}

impl Slot {
    pub(super) fn new() -> Self {
        Self {
            ground: Box::new(Patch::flat()),
            old: None,
            new: None,
            waiting: None,
            fade_start: 0,
            next_touch: None,
            landed: false,
        }
    }
}

impl Slot {
    /// Begins to fade to the waiting patch once the last fade is over. Whether a fade is under way,
    /// and how much sand the contact displaces, m³ a metre of its way.
    pub(super) fn turn_over(
        &mut self,
        sample: u64,
        fade_samples: u64,
        spare: &mut Vec<Box<Patch>>,
    ) -> (bool, f64) {
        if !self.fades(sample, fade_samples)
            && let Some(waiting) = self.waiting.take()
        {
            match &mut self.new {
                Some(new) if new.shows(&waiting) => {
                    new.displaced_m2 = waiting.displaced_m2;
                    spare.push(waiting);
                }
                _ => {
                    let old = self.old.take();
                    self.old = self.new.take();
                    self.new = Some(waiting);
                    self.fade_start = sample;
                    spare.extend(old);
                }
            }
        }
        (self.fades(sample, fade_samples), self.new.as_ref().map_or(0.0, |new| new.displaced_m2))
    }

    fn fades(&self, sample: u64, fade_samples: u64) -> bool {
        self.new.is_some() && sample < self.fade_start.saturating_add(fade_samples)
    }
}

/// A patch that came back to the audio half goes to the simulation, or waits until there is room.
pub(super) fn give_back(
    patch: Option<Box<Patch>>,
    back: &mut rtrb::Producer<Box<Patch>>,
    spare: &mut Vec<Box<Patch>>,
) {
    if let Some(patch) = patch
        && let Err(rtrb::PushError::Full(patch)) = back.push(patch)
        && spare.len() < spare.capacity()
    {
        spare.push(patch);
    }
}

/// Samples a frame of the simulation: whole blocks, two at least.
pub(super) fn frame_samples(sample_rate_hz: f64) -> u64 {
    (sample_rate_hz / FRAMES_PER_S / MAX_BLOCK as f64).round().max(2.0) as u64 * MAX_BLOCK as u64
}

/// The fade ends a block before the next frame.
pub(super) fn fade_samples(frame_samples: u64) -> u64 {
    frame_samples - MAX_BLOCK as u64
}

pub(super) fn patches(count: usize) -> Vec<Box<Patch>> {
    let mut patches = Vec::with_capacity(count + PATCHES_A_CONTACT);
    patches.extend((0..count).map(|_| Box::new(Patch::flat())));
    patches
}
