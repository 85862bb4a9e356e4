//! Rolling: of what rolls and does not slide only the ride over the ground is felt and heard
//! (`dsp::rolling`).
//!
//! Heights in, heights out, and before the body impulses in, impulses out. The share of rolling
//! goes along a straight line between two steps of the absolute grid. A contact whose reports state
//! no slip slides, and its heights stay what they are to the bit.

use crate::model::event::ContactSample;
use crate::resource::rolled_over::RolledOver;
use asperity_dsp::rolling::{RollingFilter, RollingForce, RollingForceState, RollingState};
use asperity_dsp::trajectory::PathPoint;
use asperity_surface::height_field::{MAX_BLOCK, SurfaceBlock};

/// Slower than this a contact neither rolls nor slides, m/s: it goes on as it did.
const RESTING_M_S: f64 = 1e-4;
/// Rest of the way to another share after a step of the grid: 8 ms for most of it.
const LAG: f64 = 0.8;

/// Rolling of one contact.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rolling {
    /// Speed of slip and radius of what rolls, of the newest report; none while it slides.
    reported: Option<(f64, Option<f64>)>,
    /// Share of rolling at the last step of the grid, and at the next.
    share: [f64; 2],
    /// Roughness of the ground under its last sample.
    roughness: f64,
    filter: RollingFilter,
    force: RollingForce,
    /// Ride of what is felt, and of a tip of its own.
    ride: [RollingState; 2],
    sent: RollingForceState,
}

impl Rolling {
    /// Takes from a report how it moves.
    pub(super) fn report(&mut self, sample: &ContactSample) {
        self.reported = sample.slip_m_s.map(|slip_m_s| (slip_m_s, sample.roll_radius_m));
    }

    /// Tests whether any of it rolls, now or until the next step of the grid.
    pub(super) fn rolls(&self) -> bool {
        self.reported.is_some() || self.share != [0.0; 2]
    }

    /// Begins as the newest report says, where the profile begins.
    pub(super) fn begin(&mut self, over: RolledOver<'_>, surface: &SurfaceBlock) {
        (self.ride, self.roughness) = ([RollingState::at(surface.height_m[0]); 2], surface.roughness[0]);
        self.sent = Default::default();
        self.turn(over);
        let share = self.wanted(over.at).unwrap_or(0.0);
        self.share = [share; 2];
    }

    /// Sets out for the share of the newest report: at the steps of the absolute grid.
    pub(super) fn turn(&mut self, over: RolledOver<'_>) {
        let from = self.share[1];
        let wanted = self.wanted(over.at).unwrap_or(from);
        let to = wanted + LAG * (from - wanted);
        // A ball that slides again does so to the bit in the end.
        self.share = [from, if wanted == 0.0 && to < 1e-6 { 0.0 } else { to }];
        let radius_m = self.reported.and_then(|(_, radius_m)| radius_m);
        (self.filter, self.force) = over.filters(radius_m, self.roughness);
    }

    /// The share that the newest report asks for; none at rest.
    fn wanted(&self, at: &PathPoint) -> Option<f64> {
        let Some((slip_m_s, _)) = self.reported else { return Some(0.0) };
        let [u, v] = at.velocity_m_s;
        let speed_m_s = libm::hypot(u, v);
        (speed_m_s > RESTING_M_S).then(|| (1.0 - slip_m_s / speed_m_s).max(0.0))
    }

    /// Heights of the ground, and those that a tool's tip rides, become those of the ride, and
    /// friction, where it is known, acts on what slips; `slow_step` samples lie between two steps
    /// of the grid.
    pub(super) fn run(
        &mut self,
        (position, slow_step): (u64, u64),
        (surface, mut tip_height_m): (&mut SurfaceBlock, Option<&mut [f64; MAX_BLOCK]>),
        n: usize,
        rubbed: bool,
    ) {
        let height_m = &mut surface.height_m[..n];
        self.roughness = surface.roughness[n.saturating_sub(1)];
        if !self.rolls() {
            self.ride = [RollingState::at(height_m.last().copied().unwrap_or_default()); 2];
            return;
        }
        let tip_height_m = tip_height_m.iter_mut().flat_map(|height_m| &mut height_m[..n]);
        for (height_m, share) in tip_height_m.zip(shares(self.share, position, slow_step)) {
            let ride_m = self.ride[1].tick(&self.filter, *height_m);
            *height_m += share * (ride_m - *height_m);
        }
        let ridden = height_m.iter_mut().zip(&mut surface.friction);
        for ((height_m, friction), share) in ridden.zip(shares(self.share, position, slow_step)) {
            let ride_m = self.ride[0].tick(&self.filter, *height_m);
            *height_m += share * (ride_m - *height_m);
            if rubbed {
                *friction *= 1.0 - share;
            }
        }
    }

    /// Softens what is sent to the body: it comes from a patch that asperities enter and leave.
    pub(super) fn soften(&mut self, position: u64, slow_step: u64, impulses_n_s: &mut [f64]) {
        if !self.rolls() {
            self.sent = Default::default();
            return;
        }
        for (impulse_n_s, share) in impulses_n_s.iter_mut().zip(shares(self.share, position, slow_step)) {
            let patch_n_s = self.sent.tick(&self.force, *impulse_n_s);
            *impulse_n_s += share * (patch_n_s - *impulse_n_s);
        }
    }

    /// Speeds over the ground become those of the slip.
    pub(super) fn slow_down(&self, position: u64, slow_step: u64, sweep_m_s: &mut [f64]) {
        if self.rolls() {
            let shares = shares(self.share, position, slow_step);
            sweep_m_s.iter_mut().zip(shares).for_each(|(sweep_m_s, share)| *sweep_m_s *= 1.0 - share);
        }
    }

    /// Softens `n` heights that lie behind a contact that appears.
    pub(super) fn preroll(&mut self, surface: &mut SurfaceBlock, n: usize) {
        if self.rolls() {
            self.run((0, MAX_BLOCK as u64), (surface, None), n, true);
        }
    }
}

/// Shares at the samples from a position on; a stretch lies between two steps of the grid.
fn shares([from, to]: [f64; 2], position: u64, slow_step: u64) -> impl Iterator<Item = f64> {
    // One division of integers: they are slower than all else here.
    let first = (position % slow_step) as u32 + 1;
    (first..).map(move |i| from + f64::from(i) / slow_step as f64 * (to - from))
}
