//! Contacts side by side: four of them in the lanes of one vector, each with the bits it has alone.
//!
//! A contact's step waits for the one before, and most of the processor with it; four steps that do not know of each other
//! wait together. Lane k of every vector below belongs to contact k, and every lane goes through the operations of
//! [`ExactEvent::run`] in their order. A lane that meets an event in a sample walks through that sample alone ([`ExactEvent::walk`])
//! and comes back. Other schemes, and contacts without company, run one after the other.

use super::exact_event::ExactEvent;
use super::guard::{CleanBlock, GRID, MAX_PENETRATION_M, flush, rescue};
use super::{ContactSample, ContactState, MicroContact, Onset, Scheme};
use crate::simd::{Set, at_level};
use fearless_simd::prelude::*;
use fearless_simd::{f64x4, mask64x4};

/// How many contacts go side by side.
pub const LANES: usize = 4;

/// Rows of a short stretch.
const FEW: usize = 16;

/// A number of each contact.
type Lane = [f64; LANES];

/// One of several contacts, with as many inputs as rows; what [`MicroContact::run`] is given.
pub struct Beside<'a> {
    /// Its design.
    pub design: &'a MicroContact,
    /// Where it stands.
    pub state: &'a mut ContactState,
    /// Heights, m.
    pub height_m: &'a [f64],
    /// Normal forces, N.
    pub normal_force_n: &'a [f64],
    /// Rows.
    pub out: &'a mut [ContactSample],
}

/// Runs up to [`LANES`] contacts; each gets the rows and the state that [`MicroContact::run`] would give it, to the bit.
pub fn run_side_by_side(contacts: &mut [Beside<'_>]) {
    let Some(schemes) = company(contacts) else {
        for contact in contacts {
            let Beside { design, state, height_m, normal_force_n, out } = contact;
            design.run(state, height_m, normal_force_n, out);
        }
        return;
    };
    // What is not used would have to be cleared as well.
    if contacts[0].out.len() <= FEW {
        let [mut heights, mut forces] = [[[0.0; LANES]; FEW]; 2];
        run_through(contacts, &schemes, [&mut heights, &mut forces]);
    } else {
        let [mut heights, mut forces] = [[[0.0; LANES]; GRID]; 2];
        run_through(contacts, &schemes, [&mut heights, &mut forces]);
    }
}

/// Runs contacts from grid to grid, given room for the inputs of a grid cell or of all rows.
fn run_through(
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
        at_level!(level, s => Together::of(contacts, schemes).run(s, contacts, inputs, at..at + count));
        for contact in contacts.iter_mut() {
            contact.state.clock = contact.state.clock.wrapping_add(count as u32);
            if (contact.state.clock as usize).is_multiple_of(GRID) {
                flush(contact.state);
            }
        }
        at += count;
    }
}

/// The schemes of contacts that can go side by side: two or more, exact, equally long, on one level.
fn company<'a>(contacts: &[Beside<'a>]) -> Option<[&'a ExactEvent; LANES]> {
    let (first, others) = contacts.split_first()?;
    let scheme = |contact: &Beside<'a>| match &contact.design.scheme {
        Scheme::ExactEvent(scheme) => Some(scheme),
        Scheme::SemiImplicit(_) | Scheme::EnergyConserving(_) => None,
    };
    let n = first.out.len();
    let fits = |contact: &Beside<'_>| {
        contact.design.level == first.design.level
            && [contact.out.len(), contact.height_m.len(), contact.normal_force_n.len()] == [n; 3]
    };
    if others.is_empty() || contacts.len() > LANES || !contacts.iter().all(fits) {
        return None;
    }
    let mut schemes = [scheme(first)?; LANES];
    for (to, contact) in schemes.iter_mut().zip(contacts) {
        *to = scheme(contact)?;
    }
    Some(schemes)
}

/// Contacts, quantity by quantity. A lane without a contact rests in the air.
struct Together<'a> {
    schemes: &'a [&'a ExactEvent; LANES],
    y: [Lane; 4],
    heights_m: [Lane; 3],
    forces_n: [Lane; 2],
    /// The map of each lane's regime: by column, then by row.
    columns: [[Lane; 4]; 8],
    /// Lanes that are pressed, and those whose regime has no map of a whole sample, as bits.
    pressed: u64,
    walks: u64,
    mass_rate: [Lane; 2],
    leash_m: Lane,
}

impl<'a> Together<'a> {
    #[inline(always)]
    fn of(contacts: &[Beside<'_>], schemes: &'a [&'a ExactEvent; LANES]) -> Self {
        let none = [0.0; LANES];
        let mut together = Self {
            schemes,
            y: [none; 4],
            heights_m: [none; 3],
            forces_n: [none; 2],
            columns: [[none; 4]; 8],
            pressed: 0,
            walks: 0,
            mass_rate: [none; 2],
            leash_m: [f64::INFINITY; LANES],
        };
        for (lane, contact) in contacts.iter().enumerate() {
            let state = &contact.state;
            scatter(&mut together.y, lane, &state.y);
            scatter(&mut together.heights_m, lane, &state.heights_m);
            scatter(&mut together.forces_n, lane, &state.forces_n);
            scatter(&mut together.mass_rate, lane, &schemes[lane].mass_rate);
            together.leash_m[lane] = contact.design.leash_m;
            together.press(lane, state.y[0] < 0.0);
        }
        together
    }

    /// A lane's contact is pressed or free from here on.
    #[inline(always)]
    fn press(&mut self, lane: usize, pressed: bool) {
        let (scheme, bit) = (self.schemes[lane], 1 << lane);
        let regime = usize::from(pressed);
        self.pressed = self.pressed & !bit | if pressed { bit } else { 0 };
        self.walks = self.walks & !bit | if scheme.coarsest[regime] > 0 { bit } else { 0 };
        for (to, from) in self.columns.iter_mut().zip(&scheme.regimes[regime].maps[0].columns) {
            scatter(to, lane, from);
        }
    }

    /// Every contact's map at once.
    #[inline(always)]
    fn apply<S: Set>(&self, s: S, y: &[f64x4<S>; 4], c: &[f64x4<S>; 3], force_n: f64x4<S>) -> [f64x4<S>; 4] {
        let mut next = *y;
        for (row, next) in next.iter_mut().enumerate() {
            let column = |column: usize| f64x4::load_array_ref(s, &self.columns[column][row]);
            let inputs = column(4) * c[0];
            let inputs = times_plus(column(5), c[1], inputs);
            let inputs = times_plus(column(6), c[2], inputs);
            let inputs = times_plus(column(7), force_n, inputs);
            let positions = times_plus(column(0), y[0], inputs);
            let positions = times_plus(column(1), y[1], positions);
            let velocities = column(2) * y[2];
            let velocities = times_plus(column(3), y[3], velocities);
            *next = positions + velocities;
        }
        next
    }

    /// Runs clean inputs of a stretch of rows.
    #[inline(always)]
    fn run<S: Set>(
        mut self,
        s: S,
        contacts: &mut [Beside<'_>],
        [heights, forces]: [&[Lane]; 2],
        rows: core::ops::Range<usize>,
    ) {
        let splat = |x: f64| -> f64x4<S> { f64x4::splat(s, x) };
        let (zero, half, three_halves) = (splat(0.0), splat(0.5), splat(1.5));
        let deepest = splat(-MAX_PENETRATION_M);
        let leash_m = f64x4::load_array_ref(s, &self.leash_m);
        let mass_rate = load(s, &self.mass_rate);
        let [mut h0, mut h1, mut h2] = load(s, &self.heights_m);
        let [mut f1, mut f2] = load(s, &self.forces_n);
        let mut y = load(s, &self.y);
        let mut pressed = y[0].simd_lt(zero);
        for ((row, h3), f3) in rows.zip(heights).zip(forces) {
            let (h3, f3) = (f64x4::load_array_ref(s, h3), f64x4::load_array_ref(s, f3));
            let (before, inside, after) = (h1 - h0, h2 - h1, h3 - h2);
            let c = [
                half * (before + inside),
                (three_halves * inside - before) - half * after,
                half * (before + after) - inside,
            ];
            let force = half * (f1 + f2);
            let [_, _, pad_before, finger_before] = y;
            let mut next = self.apply(s, &y, &c, force);
            let (mut touched, mut onsets) = (pressed, None);
            let events = (next[0].simd_lt(zero).to_bitmask() ^ self.pressed) | self.walks;
            if events != 0 {
                let mut walked = next.map(f64x4::to_array);
                let known = (y.map(f64x4::to_array), c.map(f64x4::to_array), force.to_array());
                let (touching, met) = self.walk(contacts, events, &mut walked, &known);
                (next, onsets) = (load(s, &walked), Some(met));
                touched = mask64x4::from_bitmask(s, touching);
                pressed = mask64x4::from_bitmask(s, self.pressed);
            }
            let momentum = mass_rate[0] * (next[2] - pad_before) + mass_rate[1] * (next[3] - finger_before);
            let push = force + momentum;
            let push = touched.select(push.simd_gt(zero).select(push, zero), zero);
            y = next;
            let held = y[0].simd_le(leash_m) & y[0].simd_ge(deepest);
            if !held.all_true() {
                let mut lost = y.map(f64x4::to_array);
                self.rescue(contacts, !held.to_bitmask(), &mut lost, &f2.to_array());
                y = load(s, &lost);
                pressed = mask64x4::from_bitmask(s, self.pressed);
            }
            let pad = h2 + y[0];
            let [a, b, c, d] = s.transpose([h2, f2, pad, y[2]]);
            let firsts = [a.to_array(), b.to_array(), c.to_array(), d.to_array()];
            let (finger, push) = ((pad - y[1]).to_array(), push.to_array());
            for (lane, contact) in contacts.iter_mut().enumerate() {
                let [height_m, normal_force_n, pad_m, pad_velocity_m_s] = firsts[lane];
                contact.out[row] = ContactSample {
                    height_m,
                    normal_force_n,
                    pad_m,
                    pad_velocity_m_s,
                    finger_m: finger[lane],
                    contact_force_n: push[lane],
                    onset: None,
                };
            }
            if let Some(onsets) = onsets {
                for (contact, onset) in contacts.iter_mut().zip(onsets) {
                    contact.out[row].onset = onset;
                }
            }
            (h0, h1, h2) = (h1, h2, h3);
            (f1, f2) = (f2, f3);
        }
        let (y, heights_m) = (y.map(f64x4::to_array), [h0, h1, h2].map(f64x4::to_array));
        let forces_n = [f1, f2].map(f64x4::to_array);
        for (lane, contact) in contacts.iter_mut().enumerate() {
            let state = &mut contact.state;
            state.y = y.map(|y| y[lane]);
            state.heights_m = heights_m.map(|h| h[lane]);
            state.forces_n = forces_n.map(|f| f[lane]);
            state.gap_m = state.y[0];
        }
    }

    /// Takes those lanes through a sample with events; the lanes that touch in it, as bits, and what they meet.
    #[cold]
    #[inline(never)]
    fn walk(
        &mut self,
        contacts: &[Beside<'_>],
        events: u64,
        next: &mut [Lane; 4],
        (y, c, force): &([Lane; 4], [Lane; 3], Lane),
    ) -> (u64, [Option<Onset>; LANES]) {
        let (mut touching, mut onsets) = (self.pressed, [None; LANES]);
        for (lane, contact) in contacts.iter().enumerate() {
            let bit = 1 << lane;
            if events & bit == 0 {
                continue;
            }
            let level = contact.design.level;
            // None of them bends: what does goes alone.
            let [c1, c2, c3] = c.map(|c| c[lane]);
            let step =
                self.schemes[lane].walk(level, y.map(|y| y[lane]), ([c1, c2, c3, 0.0], 0), force[lane]);
            scatter(next, lane, &step.y);
            onsets[lane] = step.onset;
            touching = touching & !bit | if step.touched { bit } else { 0 };
            self.press_anew(lane, step.y[0] < 0.0);
        }
        (touching, onsets)
    }

    /// Brings back what has lost its surface.
    #[cold]
    #[inline(never)]
    fn rescue(&mut self, contacts: &mut [Beside<'_>], lost: u64, y: &mut [Lane; 4], force_n: &Lane) {
        for (lane, contact) in contacts.iter_mut().enumerate() {
            if lost & 1 << lane == 0 {
                continue;
            }
            let mut own = y.map(|y| y[lane]);
            if rescue(contact.design, &mut own, y[0][lane], force_n[lane]) {
                contact.state.resets = contact.state.resets.saturating_add(1);
            }
            scatter(y, lane, &own);
            self.press_anew(lane, own[0] < 0.0);
        }
    }

    /// [`Self::press`] where it changes.
    fn press_anew(&mut self, lane: usize, pressed: bool) {
        if (self.pressed & 1 << lane != 0) != pressed {
            self.press(lane, pressed);
        }
    }
}

/// a · b + c as the level rounds it.
#[inline(always)]
fn times_plus<S: Set>(a: f64x4<S>, b: f64x4<S>, c: f64x4<S>) -> f64x4<S> {
    if S::FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// One contact's numbers go to their lane.
#[inline(always)]
fn scatter<const N: usize>(to: &mut [Lane; N], lane: usize, from: &[f64; N]) {
    for (to, from) in to.iter_mut().zip(from) {
        to[lane] = *from;
    }
}

#[inline(always)]
fn load<S: Set, const N: usize>(s: S, from: &[Lane; N]) -> [f64x4<S>; N] {
    let mut to = [f64x4::splat(s, 0.0); N];
    for (to, from) in to.iter_mut().zip(from) {
        *to = f64x4::load_array_ref(s, from);
    }
    to
}
