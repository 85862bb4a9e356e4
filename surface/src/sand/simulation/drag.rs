//! Dragging: the way of one contact's tool through a frame, in as many parts as the sand slides in
//! it.

use super::{PASSES_A_FRAME, Pose, SandSimulation, level_around};
use crate::sand::erosion::Erosion;
use crate::sand::grid::{SandGrid, UNITS_PER_M};
use crate::sand::tool::Press;

/// Steps of a tool in a frame, at most.
const STEPS_A_FRAME: usize = 64;

/// Way of a tool in a frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    to: Pose,
    from_m: [f64; 2],
    /// It stands in the sand for the first time.
    landed: bool,
    depth_m: f64,
    steps: usize,
    /// Sand that was displaced on it so far, units of the grid.
    units: i64,
}

impl Way {
    fn span_m(&self) -> [f64; 2] {
        [0, 1].map(|a| self.to.position_m[a] - self.from_m[a])
    }

    fn length_m(&self) -> f64 {
        let [u, v] = self.span_m();
        libm::hypot(u, v)
    }
}

impl SandSimulation {
    /// Takes what a contact was given; one that was lifted leaves its print.
    pub(super) fn set_out(&mut self, contact: usize) {
        let track = &mut self.tracks[contact];
        let newest = track.newest.take();
        if newest.is_none_or(|to| to.landed) && track.pose.take().is_some() {
            wake_print(&mut self.erosion, &self.grid, &self.presses[contact]);
            track.displaced_m2 = 0.0;
        }
        let Some(to) = newest else { return };
        let depth_m = self.law.depth_m(to.normal_force_n);
        // Of the tool, not of what it cuts: in its own groove it cuts next to nothing.
        track.radius_m = self.tool.print_radius_m(depth_m);
        let (landed, from_m) = (track.pose.is_none(), track.pose.map_or(to.position_m, |p| p.position_m));
        let mut way = Way { to, from_m, landed, depth_m, steps: 1, units: 0 };
        way.steps = ((way.length_m() / self.grid.cell_m()).ceil() as usize).clamp(1, STEPS_A_FRAME);
        track.way = Some(way);
    }

    /// Moves one contact's tool along the part of its way that a pass of the sliding takes.
    pub(super) fn drag(&mut self, contact: usize, pass: usize) {
        let track = &mut self.tracks[contact];
        let Some(way) = &mut track.way else { return };
        let (span, length_m) = (way.span_m(), way.length_m());
        let direction = if length_m > 0.0 { span.map(|w| w / length_m) } else { [0.0; 2] };
        let steps = way.steps;
        let part = |pass: usize| (pass * steps).div_ceil(PASSES_A_FRAME);
        for step in part(pass) + 1..=part(pass + 1) {
            let t = step as f64 / steps as f64;
            let at = [0, 1].map(|a| way.from_m[a] + t * span[a]);
            let level = level_around(&self.grid, at, track.radius_m);
            // The level follows within a radius, so that single grains of the heap do not shake it.
            let follow = if way.landed && step == 1 {
                1.0
            } else {
                1.0 - libm::exp(-length_m / steps as f64 / track.radius_m.max(self.grid.cell_m()))
            };
            track.level_m += follow * (level - track.level_m);
            let met = self.law.met(at, track.level_m - self.depth_m);
            let depth_m = match &met {
                Some(_) => self.law.depth_over_m(met.as_ref(), way.to.normal_force_n),
                None => way.depth_m,
            };
            let tip_m = track.level_m - depth_m;
            let displaced = self.presses[contact].apply(&mut self.grid, &self.tool, at, tip_m, direction);
            if displaced.units > 0 {
                self.erosion.activate(displaced.columns, displaced.rows);
                self.changed.mark(displaced.columns, displaced.rows);
                way.units += displaced.units;
            }
            track.pose = Some(Pose { position_m: at, ..way.to });
            if length_m > 0.0 {
                wake_print(&mut self.erosion, &self.grid, &self.presses[contact]);
            }
        }
    }

    /// The end of the frame's way: what it displaced, how deep it stood.
    pub(super) fn arrive(&mut self, contact: usize) {
        let track = &mut self.tracks[contact];
        let Some(way) = track.way.take() else { return };
        let length_m = way.length_m();
        if length_m > 0.0 {
            let volume = way.units as f64 / UNITS_PER_M * self.grid.cell_m() * self.grid.cell_m();
            let now = volume / length_m;
            track.displaced_m2 += if way.landed { now } else { 0.5 * (now - track.displaced_m2) };
        }
        track.pose = Some(way.to);
        let lowest = self.presses[contact].cut_cells().map(|at| self.grid.heights[at]).min();
        self.print_m = lowest
            .map_or(self.print_m, |lowest| self.print_m.max(self.depth_m - f64::from(lowest) / UNITS_PER_M));
    }
}

/// Lets the sand around a print slide when the tool has left it.
pub(super) fn wake_print(erosion: &mut Erosion, grid: &SandGrid, press: &Press) {
    for at in press.cut_cells() {
        let (x, y) = (at % grid.stride() - 1, at / grid.stride() - 1);
        erosion.activate([x, x], [y, y]);
    }
}
