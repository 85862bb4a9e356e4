//! Contacts side by side: four of them in the lanes of one vector, each with the bits it has alone.
//!
//! A contact's step waits for the one before, and most of the processor with it; four steps that do not know of each other
//! wait together. Lane k of every vector below belongs to contact k, and every lane goes through the operations of
//! [`ExactEvent::run`] in their order. A lane that meets an event in a sample walks through that sample alone ([`ExactEvent::walk`])
//! and comes back. Other schemes, and contacts without company, run one after the other.

use super::exact_event::{AT_SAMPLES, ExactEvent, MIDWAY, QUARTERS};
use super::guard::{CleanBlock, GRID, flush};
use super::together::Together;
use super::{ContactSample, ContactState, GroundBetween, MicroContact, Scheme};
use crate::simd::at_level;

/// How many contacts go side by side.
pub const LANES: usize = 4;

/// Rows of a short stretch.
const FEW: usize = 16;

/// A number of each contact.
pub(super) type Lane = [f64; LANES];

/// One of several contacts, with as many inputs as rows; what [`MicroContact::run_over`] is given.
pub struct Beside<'a> {
    /// Its design.
    pub design: &'a MicroContact,
    /// Where it stands.
    pub state: &'a mut ContactState,
    /// Heights, m.
    pub height_m: &'a [f64],
    /// Normal forces, N.
    pub normal_force_n: &'a [f64],
    /// What is known of the ground between samples.
    pub ground: GroundBetween<'a>,
    /// Rows.
    pub out: &'a mut [ContactSample],
}

/// Runs up to [`LANES`] contacts; each gets the rows and the state that [`MicroContact::run_over`] would give it, to the bit.
pub fn run_side_by_side(contacts: &mut [Beside<'_>]) {
    let Some((schemes, kind)) = company(contacts) else {
        for contact in contacts {
            let Beside { design, state, height_m, normal_force_n, ground, out } = contact;
            design.run_over(state, height_m, normal_force_n, *ground, out);
        }
        return;
    };
    match kind {
        AT_SAMPLES => run_on::<AT_SAMPLES>(contacts, &schemes),
        MIDWAY => run_on::<MIDWAY>(contacts, &schemes),
        _ => run_on::<QUARTERS>(contacts, &schemes),
    }
}

/// Runs them on one kind of ground.
fn run_on<const KIND: u8>(contacts: &mut [Beside<'_>], schemes: &[&ExactEvent; LANES]) {
    // What is not used would have to be cleared as well.
    if contacts[0].out.len() <= FEW {
        let [mut heights, mut forces] = [[[0.0; LANES]; FEW]; 2];
        run_through::<KIND>(contacts, schemes, [&mut heights, &mut forces]);
    } else {
        let [mut heights, mut forces] = [[[0.0; LANES]; GRID]; 2];
        run_through::<KIND>(contacts, schemes, [&mut heights, &mut forces]);
    }
}

/// Runs contacts from grid to grid, given room for the inputs of a grid cell or of all rows.
fn run_through<const KIND: u8>(
    contacts: &mut [Beside<'_>],
    schemes: &[&ExactEvent; LANES],
    [heights, forces]: [&mut [Lane]; 2],
) {
    let level = contacts[0].design.level.at_most_256_bits();
    let (mut at, wanted) = (0, contacts[0].out.len());
    while at < wanted {
        let to_grid = |contact: &Beside<'_>| GRID - contact.state.clock as usize % GRID;
        let count = contacts.iter().map(to_grid).fold(wanted - at, usize::min);
        for (lane, contact) in contacts.iter_mut().enumerate() {
            let rows = at..at + count;
            let inputs = (&contact.height_m[rows.clone()], &contact.normal_force_n[rows]);
            CleanBlock::fill_lane(contact.state, inputs, (&mut *heights, &mut *forces), lane);
        }
        let inputs = [&*heights, &*forces];
        at_level!(level, s => Together::<KIND>::of(contacts, schemes).run(s, contacts, inputs, at..at + count));
        for contact in contacts.iter_mut() {
            contact.state.clock = contact.state.clock.wrapping_add(count as u32);
            if (contact.state.clock as usize).is_multiple_of(GRID) {
                flush(contact.state);
            }
        }
        at += count;
    }
}

/// The schemes of contacts that can go side by side, and the kind of their ground: two or more, exact, equally long, on one level.
fn company<'a>(contacts: &[Beside<'a>]) -> Option<([&'a ExactEvent; LANES], u8)> {
    let (first, others) = contacts.split_first()?;
    let scheme = |contact: &Beside<'a>| match &contact.design.scheme {
        Scheme::ExactEvent(scheme) => Some(scheme),
        Scheme::SemiImplicit(_) | Scheme::EnergyConserving(_) => None,
    };
    let n = first.out.len();
    let fits = |contact: &Beside<'_>| {
        contact.design.level == first.design.level
            && [contact.out.len(), contact.height_m.len(), contact.normal_force_n.len()] == [n; 3]
            && contact.ground.is_sound(n)
    };
    if others.is_empty() || contacts.len() > LANES || !contacts.iter().all(fits) {
        return None;
    }
    let mut kind = kind_of(first.ground);
    for other in others {
        match (kind, kind_of(other.ground)) {
            (a, b) if a == b => {}
            (QUARTERS, _) | (_, QUARTERS) => return None,
            _ => kind = MIDWAY,
        }
    }
    let mut schemes = [scheme(first)?; LANES];
    for (to, contact) in schemes.iter_mut().zip(contacts) {
        *to = scheme(contact)?;
    }
    Some((schemes, kind))
}

fn kind_of(ground: GroundBetween<'_>) -> u8 {
    match ground {
        GroundBetween::AtSamples => AT_SAMPLES,
        GroundBetween::Midway(_) => MIDWAY,
        GroundBetween::Quarters(_) => QUARTERS,
    }
}
