//! Eight contacts of one design side by side, one vector lane each (semi-implicit Euler).
//!
//! The arithmetic is that of one contact, operation for operation: a lane gives the bits that
//! [`MicroContact::run`] gives. Rows keep the gaps instead of ready-made onsets, so that only a row
//! somebody asks about pays for a division.

use super::guard::{self, GRID};
use super::semi_implicit::SemiImplicit;
use super::{ContactSample, ContactState, MicroContact, Onset, dispatch};

/// Contacts run together.
pub const LANES: usize = 8;

/// One value a contact.
pub type Lanes = [f64; LANES];

/// One row of eight contacts; fields as in [`ContactSample`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(align(64))]
pub struct LaneRow {
    /// x_m used, m.
    pub height_m: Lanes,
    /// F_n used, N.
    pub normal_force_n: Lanes,
    /// x_s, m.
    pub pad_m: Lanes,
    /// v_s, m/s.
    pub pad_velocity_m_s: Lanes,
    /// x_f, m.
    pub finger_m: Lanes,
    /// Contact force, N.
    pub contact_force_n: Lanes,
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

/// The recurrent part, one array a component.
struct Bundle {
    y: [Lanes; 4],
    gap_m: Lanes,
    height_m: Lanes,
    force_n: Lanes,
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

    /// The touch of one contact in a row; `lane` modulo [`LANES`].
    #[must_use]
    pub fn onset(&self, row: &LaneRow, lane: usize) -> Option<Onset> {
        let (before, now) = (row.gap_before_m[lane % LANES], row.gap_m[lane % LANES]);
        if before >= 0.0 && now < 0.0 { Some(self.scheme.first_onset(before, now)) } else { None }
    }

    /// One contact's row in full; `lane` modulo [`LANES`].
    #[must_use]
    pub fn sample(&self, row: &LaneRow, lane: usize) -> ContactSample {
        let i = lane % LANES;
        ContactSample {
            height_m: row.height_m[i],
            normal_force_n: row.normal_force_n[i],
            pad_m: row.pad_m[i],
            pad_velocity_m_s: row.pad_velocity_m_s[i],
            finger_m: row.finger_m[i],
            contact_force_n: row.contact_force_n[i],
            onset: self.onset(row, i),
        }
    }

    /// Cuts a run where any contact's clock meets its grid.
    #[inline(always)]
    pub(super) fn run_blocks(
        &self,
        states: &mut [ContactState; LANES],
        mut height_m: &[Lanes],
        mut force_n: &[Lanes],
        mut out: &mut [LaneRow],
    ) {
        let mut bundle = Bundle::gather(states);
        loop {
            let left = states.iter().map(|s| GRID - s.clock as usize % GRID).min().unwrap_or(GRID);
            let count = left.min(height_m.len()).min(force_n.len()).min(out.len());
            if count == 0 {
                break;
            }
            let (heights, later_heights) = height_m.split_at(count);
            let (forces, later_forces) = force_n.split_at(count);
            let (rows, later_rows) = out.split_at_mut(count);
            for ((row, height_m), force_n) in rows.iter_mut().zip(heights).zip(forces) {
                self.step(&mut bundle, states, height_m, force_n, row);
            }
            for (lane, state) in states.iter_mut().enumerate() {
                state.clock = state.clock.wrapping_add(count as u32);
                if (state.clock as usize).is_multiple_of(GRID) {
                    bundle.flush(lane);
                }
            }
            (height_m, force_n, out) = (later_heights, later_forces, later_rows);
        }
        bundle.scatter(states);
    }

    #[inline(always)]
    fn step(
        &self,
        bundle: &mut Bundle,
        states: &mut [ContactState; LANES],
        height_m: &Lanes,
        force_n: &Lanes,
        row: &mut LaneRow,
    ) {
        let (mut height, mut force) = (*height_m, *force_n);
        let mut good = true;
        for i in 0..LANES {
            good &= guard::is_height(height[i]) & guard::is_force(force[i]);
            (height[i], force[i]) = guard::tidy(height[i], force[i]);
        }
        if !good {
            repair(bundle, states, height_m, force_n, &mut height, &mut force);
        }
        let s = self.scheme;
        let y = &mut bundle.y;
        let mut held = true;
        for i in 0..LANES {
            let d = y[0][i] - (height[i] - bundle.height_m[i]);
            let (stretch, pad, finger) = (y[1][i], y[2][i], y[3][i]);
            let penetration = if d < 0.0 { -d } else { 0.0 };
            let next = |k: usize, gap: f64| {
                let springs = s.stretch[k] * stretch + s.force[k] * force[i];
                let dampers = s.pad_velocity[k] * pad + s.finger_velocity[k] * finger;
                ((springs + dampers) + gap) + s.contact[k] * penetration
            };
            (y[0][i], y[1][i], y[2][i], y[3][i]) = (next(0, d), next(1, 0.0), next(2, 0.0), next(3, 0.0));
            let pad_m = height[i] + d;
            row.pad_m[i] = pad_m;
            row.finger_m[i] = pad_m - stretch;
            row.pad_velocity_m_s[i] = 0.5 * (pad + y[2][i]);
            row.contact_force_n[i] = penetration * s.contact_stiffness_n_m;
            row.gap_before_m[i] = bundle.gap_m[i];
            row.gap_m[i] = d;
            bundle.gap_m[i] = d;
            held &= (y[0][i] <= self.design.leash_m) & (y[0][i] >= -self.design.max_penetration_m);
        }
        row.height_m = height;
        row.normal_force_n = force;
        bundle.height_m = height;
        bundle.force_n = force;
        if !held {
            self.rescue(bundle, states);
        }
    }

    #[cold]
    #[inline(never)]
    fn rescue(&self, bundle: &mut Bundle, states: &mut [ContactState; LANES]) {
        for (lane, state) in states.iter_mut().enumerate() {
            let mut y = [0, 1, 2, 3].map(|k| bundle.y[k][lane]);
            let carried = y[0];
            if carried <= self.design.leash_m && carried >= -self.design.max_penetration_m {
                continue;
            }
            if guard::rescue(self.design, &mut y, carried, bundle.force_n[lane]) {
                bundle.gap_m[lane] = y[0];
                state.resets = state.resets.saturating_add(1);
            }
            for (component, y) in bundle.y.iter_mut().zip(y) {
                component[lane] = y;
            }
        }
    }
}

#[cold]
#[inline(never)]
fn repair(
    bundle: &Bundle,
    states: &mut [ContactState; LANES],
    raw_height_m: &Lanes,
    raw_force_n: &Lanes,
    height_m: &mut Lanes,
    force_n: &mut Lanes,
) {
    for (i, state) in states.iter_mut().enumerate() {
        let (good_height, good_force) = (guard::is_height(raw_height_m[i]), guard::is_force(raw_force_n[i]));
        if !good_height {
            height_m[i] = bundle.height_m[i];
        }
        if !good_force {
            force_n[i] = bundle.force_n[i];
        }
        if !(good_height && good_force) {
            state.resets = state.resets.saturating_add(1);
        }
    }
}

impl Bundle {
    #[inline(always)]
    fn gather(states: &[ContactState; LANES]) -> Self {
        let mut b = Self { y: [[0.0; 8]; 4], gap_m: [0.0; 8], height_m: [0.0; 8], force_n: [0.0; 8] };
        for (i, state) in states.iter().enumerate() {
            for (component, &y) in b.y.iter_mut().zip(&state.y) {
                component[i] = y;
            }
            b.gap_m[i] = state.gap_m;
            b.height_m[i] = state.heights_m[2];
            b.force_n[i] = state.forces_n[1];
        }
        b
    }

    #[inline(always)]
    fn scatter(&self, states: &mut [ContactState; LANES]) {
        for (i, state) in states.iter_mut().enumerate() {
            for (y, component) in state.y.iter_mut().zip(&self.y) {
                *y = component[i];
            }
            state.gap_m = self.gap_m[i];
            // The Euler scheme looks at the last input only.
            state.heights_m = [self.height_m[i]; 3];
            state.forces_n = [self.force_n[i]; 2];
        }
    }

    #[inline(always)]
    fn flush(&mut self, lane: usize) {
        for component in &mut self.y {
            component[lane] = guard::flushed(component[lane]);
        }
    }
}
