//! Several contacts in the lanes of one vector, from row to row.
//!
//! Lane k of every vector below belongs to contact k, and every lane goes through the operations of [`ExactEvent::run`] in their order. A
//! lane that meets an event in a sample walks through that sample alone ([`ExactEvent::walk`]) and comes back.

use super::exact_event::{AT_SAMPLES, ExactEvent, MIDWAY, Profile, QUARTERS};
use super::guard::{GRID, MAX_PENETRATION_M, rescue};
use super::side_by_side::{Beside, LANES, Lane};
use super::{Bend, ContactSample, GroundBetween, Onset};
use crate::simd::Set;
use core::ops::Range;
use fearless_simd::prelude::*;
use fearless_simd::{f64x4, mask64x4};

/// What changes no bit of a cubic, whatever it is: x + (−0) is x, and so is x + (−0) · 0.
const NO_BEND: Bend = [-0.0, -0.0, -0.0, 0.0];
/// Of a lane without: two for every sample of a grid cell.
static NO_BENDS: [Bend; 2 * GRID] = [NO_BEND; 2 * GRID];

/// Of every lane: where it stands, its profile from the beginning of a sample and from its middle, and what presses.
type Known = ([Lane; 4], [[Lane; 4]; 2], Lane);

/// Contacts on one kind of ground, quantity by quantity. A lane without a contact rests in the air.
pub(super) struct Together<'a, const KIND: u8> {
    schemes: &'a [&'a ExactEvent; LANES],
    y: [Lane; 4],
    heights_m: [Lane; 3],
    forces_n: [Lane; 2],
    /// The map of each lane's regime, of a whole sample or of half of one: by column, then by row.
    columns: [[Lane; 4]; 9],
    /// The gap's row of the map of half as much, by column, where that is looked at.
    gap: [Lane; 9],
    /// Lanes whose samples are, as bits.
    bent: u64,
    /// Lanes that are pressed, and those whose regime has no map of a whole sample, as bits.
    pressed: u64,
    walks: u64,
    mass_rate: [Lane; 2],
    leash_m: Lane,
}

impl<'a, const KIND: u8> Together<'a, KIND> {
    #[inline(always)]
    pub(super) fn of(contacts: &[Beside<'_>], schemes: &'a [&'a ExactEvent; LANES]) -> Self {
        let none = [0.0; LANES];
        let mut together = Self {
            schemes,
            y: [none; 4],
            heights_m: [none; 3],
            forces_n: [none; 2],
            columns: [[none; 4]; 9],
            gap: [none; 9],
            bent: 0,
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
            together.bent |= if matches!(contact.ground, GroundBetween::Midway(_)) { 1 << lane } else { 0 };
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
        let level = if KIND == QUARTERS { 1 } else { 0 };
        self.walks = self.walks & !bit | if scheme.coarsest[regime] > level { bit } else { 0 };
        let maps = &scheme.regimes[regime].maps;
        for (to, from) in self.columns.iter_mut().zip(&maps[level].columns) {
            scatter(to, lane, from);
        }
        if KIND != AT_SAMPLES {
            for (to, from) in self.gap.iter_mut().zip(&maps[level + 1].columns) {
                to[lane] = from[0];
            }
        }
        if KIND == MIDWAY && self.bent & bit == 0 {
            // Times [`NO_BEND`]'s zero it is −0, which changes nothing it is added to.
            scatter(&mut self.columns[8], lane, &[-0.0; 4]);
        }
    }

    /// Every contact's map at once.
    #[inline(always)]
    fn apply<S: Set>(&self, s: S, y: &[f64x4<S>; 4], c: &[f64x4<S>; 4], force_n: f64x4<S>) -> [f64x4<S>; 4] {
        let mut next = *y;
        for (row, next) in next.iter_mut().enumerate() {
            *next = row_of::<S, KIND>(s, |column| &self.columns[column][row], y, c, force_n);
        }
        next
    }

    /// The bends of each lane, one a sample or two; those of a lane without are none.
    #[inline(always)]
    fn grounds<'b>(&self, contacts: &[Beside<'b>], rows: Range<usize>) -> [&'b [Bend]; LANES] {
        let mut grounds: [&[Bend]; LANES] = [&NO_BENDS; LANES];
        for (to, contact) in grounds.iter_mut().zip(contacts) {
            *to = match contact.ground {
                GroundBetween::AtSamples => continue,
                GroundBetween::Midway(bends) => &bends[rows.clone()],
                GroundBetween::Quarters(halves) => halves[rows.clone()].as_flattened(),
            };
        }
        grounds
    }

    /// Runs clean inputs of a stretch of rows.
    #[inline(always)]
    pub(super) fn run<S: Set>(
        mut self,
        s: S,
        contacts: &mut [Beside<'_>],
        [heights, forces]: [&[Lane]; 2],
        rows: Range<usize>,
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
        let grounds = self.grounds(contacts, rows.clone());
        for (n, ((row, h3), f3)) in rows.zip(heights).zip(forces).enumerate() {
            let (h3, f3) = (f64x4::load_array_ref(s, h3), f64x4::load_array_ref(s, f3));
            let (before, inside, after) = (h1 - h0, h2 - h1, h3 - h2);
            let cubic = [
                half * (before + inside),
                (three_halves * inside - before) - half * after,
                half * (before + after) - inside,
            ];
            let [g0, g1, g2, g3] = grounds;
            let of = |bends: &[Bend], k: usize| f64x4::load_array_ref(s, &bends[k]);
            let bend = |k: usize| s.transpose([of(g0, k), of(g1, k), of(g2, k), of(g3, k)]);
            let (c, later) = match KIND {
                MIDWAY => (bent_by(cubic, bend(n)), [zero; 4]),
                QUARTERS => {
                    let later = from_midway_of(s, cubic);
                    (bent_by(cubic, bend(2 * n)), bent_by(later, bend(2 * n + 1)))
                }
                _ => ([cubic[0], cubic[1], cubic[2], zero], [zero; 4]),
            };
            let force = half * (f1 + f2);
            let [_, _, pad_before, finger_before] = y;
            let mut next = self.apply(s, &y, &c, force);
            let turned = |gap_m: f64x4<S>| gap_m.simd_lt(zero).to_bitmask() ^ self.pressed;
            let gap_m = |y: &[f64x4<S>; 4], c: &[f64x4<S>; 4]| {
                row_of::<S, KIND>(s, |column| &self.gap[column], y, c, force)
            };
            let mut events = self.walks;
            if KIND == MIDWAY {
                events |= turned(gap_m(&y, &c)) & self.bent;
            }
            if KIND == QUARTERS {
                events |= turned(gap_m(&y, &c)) | turned(next[0]) | turned(gap_m(&next, &later));
                next = self.apply(s, &next, &later, force);
            }
            events |= turned(next[0]);
            let (mut touched, mut onsets) = (pressed, None);
            if events != 0 {
                let mut walked = next.map(f64x4::to_array);
                let profiles = [c, later].map(|c| c.map(f64x4::to_array));
                let known = (y.map(f64x4::to_array), profiles, force.to_array());
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
        (y, [c, later], force): &Known,
    ) -> (u64, [Option<Onset>; LANES]) {
        let (mut touching, mut onsets) = (self.pressed, [None; LANES]);
        for (lane, contact) in contacts.iter().enumerate() {
            let bit = 1 << lane;
            if events & bit == 0 {
                continue;
            }
            let level = contact.design.level;
            let own = |c: &[Lane; 4]| c.map(|c| c[lane]);
            let steps = KIND == QUARTERS;
            let least = if steps || self.bent & bit != 0 { usize::from(KIND) } else { 0 };
            let profile = Profile { c: own(c), later: steps.then(|| own(later)), least };
            let step = self.schemes[lane].walk(level, y.map(|y| y[lane]), &profile, force[lane]);
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

/// A row of every contact's map, in the order of [`Map::apply`](super::flow::Map::apply).
#[inline(always)]
fn row_of<'l, S: Set, const KIND: u8>(
    s: S,
    row: impl Fn(usize) -> &'l Lane,
    y: &[f64x4<S>; 4],
    c: &[f64x4<S>; 4],
    force_n: f64x4<S>,
) -> f64x4<S> {
    let column = |column: usize| f64x4::load_array_ref(s, row(column));
    let inputs = column(4) * c[0];
    let inputs = times_plus(column(5), c[1], inputs);
    let mut inputs = times_plus(column(6), c[2], inputs);
    if KIND != AT_SAMPLES {
        inputs = times_plus(column(8), c[3], inputs);
    }
    let inputs = times_plus(column(7), force_n, inputs);
    let positions = times_plus(column(0), y[0], inputs);
    let positions = times_plus(column(1), y[1], positions);
    let velocities = column(2) * y[2];
    let velocities = times_plus(column(3), y[3], velocities);
    positions + velocities
}

/// Cubics and what they bend beside.
#[inline(always)]
fn bent_by<S: Set>([c1, c2, c3]: [f64x4<S>; 3], [b1, b2, b3, b4]: [f64x4<S>; 4]) -> [f64x4<S>; 4] {
    [c1 + b1, c2 + b2, c3 + b3, b4]
}

/// [`from_midway`](super::exact_event::from_midway) of each.
#[inline(always)]
fn from_midway_of<S: Set>(s: S, [c1, c2, c3]: [f64x4<S>; 3]) -> [f64x4<S>; 3] {
    let splat = |x: f64| -> f64x4<S> { f64x4::splat(s, x) };
    [c1 + (c2 + splat(0.75) * c3), c2 + splat(1.5) * c3, c3]
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
