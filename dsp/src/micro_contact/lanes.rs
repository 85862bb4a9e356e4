//! Eight contacts of one design side by side, one vector lane each (semi-implicit Euler).
//!
//! The arithmetic is that of one contact, operation for operation: a lane gives the bits that
//! [`MicroContact::run`] gives. Rows keep what cannot be computed afterwards; contact forces and
//! onsets are worked out for the rows somebody asks about.

use super::guard::{self, GRID};
use super::quad::Quad;
use super::semi_implicit::SemiImplicit;
use super::{ContactSample, ContactState, MicroContact, Onset, dispatch};

/// Contacts run together.
pub const LANES: usize = 8;

/// One value a contact.
pub type Lanes = [f64; LANES];

/// One row of eight contacts; [`EulerLanes::sample`] turns a lane into a [`ContactSample`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(align(64))]
pub struct LaneRow {
    /// x_s, m.
    pub pad_m: Lanes,
    /// v_s, m/s.
    pub pad_velocity_m_s: Lanes,
    /// x_f, m.
    pub finger_m: Lanes,
    /// x_s − x_m at the row before, m.
    pub gap_before_m: Lanes,
    /// x_s − x_m at this row, m; negative in contact.
    pub gap_m: Lanes,
}

/// A design that can run eight contacts at once; see [`MicroContact::lanes`].
#[derive(Debug, Clone, Copy)]
pub struct EulerLanes<'a> {
    pub(super) design: &'a MicroContact,
    pub(super) scheme: &'a SemiImplicit,
}

/// Four contacts: what recurs from row to row. Plain fields, so that it lives in registers.
#[derive(Clone, Copy)]
struct Four<Q> {
    gap_ahead_m: Q,
    stretch_m: Q,
    pad_m_s: Q,
    finger_m_s: Q,
    gap_m: Q,
    height_m: Q,
    force_n: Q,
}

/// What one row of four contacts gives away.
struct FourRow<Q> {
    pad_m: Q,
    pad_velocity_m_s: Q,
    finger_m: Q,
}

impl EulerLanes<'_> {
    /// Runs the next `out.len()` rows (or as many as both inputs have) of eight contacts.
    pub fn run(
        &self,
        states: &mut [ContactState; LANES],
        height_m: &[Lanes],
        normal_force_n: &[Lanes],
        out: &mut [LaneRow],
    ) {
        dispatch::run_lanes(self, states, height_m, normal_force_n, out);
    }

    /// Contact force of one contact in a row, N; `lane` modulo [`LANES`].
    #[must_use]
    pub fn contact_force_n(&self, row: &LaneRow, lane: usize) -> f64 {
        (-row.gap_m[lane % LANES]).max(0.0) * self.scheme.contact_stiffness_n_m
    }

    /// The touch of one contact in a row; `lane` modulo [`LANES`].
    #[must_use]
    pub fn onset(&self, row: &LaneRow, lane: usize) -> Option<Onset> {
        let (before, now) = (row.gap_before_m[lane % LANES], row.gap_m[lane % LANES]);
        if before >= 0.0 && now < 0.0 { Some(self.scheme.first_onset(before, now)) } else { None }
    }

    /// One contact's row in full, given the inputs it was computed from; `lane` modulo [`LANES`].
    #[must_use]
    pub fn sample(&self, row: &LaneRow, lane: usize, height_m: f64, normal_force_n: f64) -> ContactSample {
        let i = lane % LANES;
        ContactSample {
            height_m,
            normal_force_n: normal_force_n.max(0.0),
            pad_m: row.pad_m[i],
            pad_velocity_m_s: row.pad_velocity_m_s[i],
            finger_m: row.finger_m[i],
            contact_force_n: self.contact_force_n(row, i),
            onset: self.onset(row, i),
        }
    }

    /// Cuts a run where any contact's clock meets its grid.
    #[inline(always)]
    pub(super) fn run_blocks<Q: Quad>(
        &self,
        states: &mut [ContactState; LANES],
        mut height_m: &[Lanes],
        mut force_n: &[Lanes],
        mut out: &mut [LaneRow],
    ) {
        loop {
            let left = states.iter().map(|s| GRID - s.clock as usize % GRID).min().unwrap_or(GRID);
            let count = left.min(height_m.len()).min(force_n.len()).min(out.len());
            if count == 0 {
                return;
            }
            let (heights, later_heights) = height_m.split_at(count);
            let (forces, later_forces) = force_n.split_at(count);
            let (rows, later_rows) = out.split_at_mut(count);
            self.run_rows::<Q>(states, heights, forces, rows);
            for state in states.iter_mut() {
                state.clock = state.clock.wrapping_add(count as u32);
                if (state.clock as usize).is_multiple_of(GRID) {
                    guard::flush(state);
                }
            }
            (height_m, force_n, out) = (later_heights, later_forces, later_rows);
        }
    }

    #[inline(always)]
    fn run_rows<Q: Quad>(
        &self,
        states: &mut [ContactState; LANES],
        height_m: &[Lanes],
        force_n: &[Lanes],
        out: &mut [LaneRow],
    ) {
        let (low, high) = (-guard::MAX_PENETRATION_M, self.design.leash_m);
        let (mut a, mut b) = gather::<Q>(states);
        for ((row, height_m), force_n) in out.iter_mut().zip(height_m).zip(force_n) {
            let (mut height, mut force) = (*height_m, *force_n);
            if !inputs_are_good::<Q>(height_m, force_n) {
                (height, force) = repaired(
                    states,
                    height_m,
                    force_n,
                    halves(a.height_m, b.height_m),
                    halves(a.force_n, b.force_n),
                );
            }
            let before = halves(a.gap_m, b.gap_m);
            let ra = self.step(&mut a, lower(&height), lower(&force));
            let rb = self.step(&mut b, upper(&height), upper(&force));
            *row = LaneRow {
                pad_m: halves(ra.pad_m, rb.pad_m),
                pad_velocity_m_s: halves(ra.pad_velocity_m_s, rb.pad_velocity_m_s),
                finger_m: halves(ra.finger_m, rb.finger_m),
                gap_before_m: before,
                gap_m: halves(a.gap_m, b.gap_m),
            };
            if !(a.gap_ahead_m.within(low, high) & b.gap_ahead_m.within(low, high)) {
                scatter(a, b, states);
                self.rescue(states);
                (a, b) = gather(states);
            }
        }
        scatter(a, b, states);
    }

    /// The sums of the single contact, in its order.
    #[inline(always)]
    fn step<Q: Quad>(&self, four: &mut Four<Q>, height_m: Q, force_n: Q) -> FourRow<Q> {
        let s = self.scheme;
        let tiny = Q::splat(guard::VANISHING);
        let height_m = height_m.add(tiny).sub(tiny);
        let force_n = force_n.positive().add(tiny).sub(tiny);
        let short = height_m.sub(four.height_m).sub(four.gap_ahead_m);
        let (gap_m, penetration) = (Q::splat(0.0).sub(short), short.positive());
        let (stretch, pad, finger) = (four.stretch_m, four.pad_m_s, four.finger_m_s);
        let next = |k: usize, gap: Q| {
            let springs = Q::splat(s.force[k]).times_plus(force_n, gap);
            let springs = Q::splat(s.stretch[k]).times_plus(stretch, springs);
            let dampers = Q::splat(s.pad_velocity[k]).mul(pad);
            let dampers = Q::splat(s.finger_velocity[k]).times_plus(finger, dampers);
            Q::splat(s.contact[k]).times_plus(penetration, springs.add(dampers))
        };
        four.gap_ahead_m = next(0, gap_m);
        four.stretch_m = next(1, Q::splat(0.0));
        four.pad_m_s = next(2, Q::splat(0.0));
        four.finger_m_s = next(3, Q::splat(0.0));
        (four.gap_m, four.height_m, four.force_n) = (gap_m, height_m, force_n);
        let pad_m = height_m.add(gap_m);
        let pad_velocity_m_s = Q::splat(0.5).mul(pad.add(four.pad_m_s));
        FourRow { pad_m, pad_velocity_m_s, finger_m: pad_m.sub(stretch) }
    }

    #[cold]
    #[inline(never)]
    fn rescue(&self, states: &mut [ContactState; LANES]) {
        for state in states {
            let carried = state.y[0];
            if carried <= self.design.leash_m && carried >= -guard::MAX_PENETRATION_M {
                continue;
            }
            if guard::rescue(self.design, &mut state.y, carried, state.forces_n[1]) {
                state.gap_m = state.y[0];
                state.resets = state.resets.saturating_add(1);
            }
        }
    }
}

#[inline(always)]
fn lower<Q: Quad>(lanes: &Lanes) -> Q {
    Q::load(&[lanes[0], lanes[1], lanes[2], lanes[3]])
}

#[inline(always)]
fn upper<Q: Quad>(lanes: &Lanes) -> Q {
    Q::load(&[lanes[4], lanes[5], lanes[6], lanes[7]])
}

#[inline(always)]
fn halves<Q: Quad>(lower: Q, upper: Q) -> Lanes {
    let ([a, b, c, d], [e, f, g, h]) = (lower.array(), upper.array());
    [a, b, c, d, e, f, g, h]
}

#[inline(always)]
fn inputs_are_good<Q: Quad>(height_m: &Lanes, force_n: &Lanes) -> bool {
    let height = |q: Q| q.within(-guard::MAX_HEIGHT_M, guard::MAX_HEIGHT_M);
    let force = |q: Q| q.within(-guard::MAX_FORCE_N, guard::MAX_FORCE_N);
    height(lower(height_m)) & height(upper(height_m)) & force(lower(force_n)) & force(upper(force_n))
}

/// Holds the last good input where a lane's is bad, and counts.
#[cold]
#[inline(never)]
fn repaired(
    states: &mut [ContactState; LANES],
    height_m: &Lanes,
    force_n: &Lanes,
    last_height_m: Lanes,
    last_force_n: Lanes,
) -> (Lanes, Lanes) {
    let (mut heights, mut forces) = (*height_m, *force_n);
    for (i, state) in states.iter_mut().enumerate() {
        let (good_height, good_force) = (guard::is_height(height_m[i]), guard::is_force(force_n[i]));
        if !good_height {
            heights[i] = last_height_m[i];
        }
        if !good_force {
            forces[i] = last_force_n[i];
        }
        if !(good_height && good_force) {
            state.resets = state.resets.saturating_add(1);
        }
    }
    (heights, forces)
}

#[inline(always)]
fn gather<Q: Quad>(states: &[ContactState; LANES]) -> (Four<Q>, Four<Q>) {
    let four = |from: usize| {
        let take = |value: fn(&ContactState) -> f64| {
            Q::load(&core::array::from_fn(|i| value(&states[(from + i) % LANES])))
        };
        Four {
            gap_ahead_m: take(|s| s.y[0]),
            stretch_m: take(|s| s.y[1]),
            pad_m_s: take(|s| s.y[2]),
            finger_m_s: take(|s| s.y[3]),
            gap_m: take(|s| s.gap_m),
            height_m: take(|s| s.heights_m[2]),
            force_n: take(|s| s.forces_n[1]),
        }
    };
    (four(0), four(4))
}

#[inline(always)]
fn scatter<Q: Quad>(a: Four<Q>, b: Four<Q>, states: &mut [ContactState; LANES]) {
    let (lower, upper) = states.split_at_mut(LANES / 2);
    for (four, states) in [(a, lower), (b, upper)] {
        let (gaps_ahead, stretches) = (four.gap_ahead_m.array(), four.stretch_m.array());
        let (pads, fingers) = (four.pad_m_s.array(), four.finger_m_s.array());
        let (gaps, heights, forces) = (four.gap_m.array(), four.height_m.array(), four.force_n.array());
        for (i, state) in states.iter_mut().enumerate() {
            let i = i % 4;
            state.y = [gaps_ahead[i], stretches[i], pads[i], fingers[i]];
            state.gap_m = gaps[i];
            // The Euler scheme looks at the last input only.
            state.heights_m = [heights[i]; 3];
            state.forces_n = [forces[i]; 2];
        }
    }
}
