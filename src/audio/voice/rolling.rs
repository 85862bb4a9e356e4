//! Rolling: of what rolls and does not slide only the ride over the ground is felt and heard (`dsp::rolling`).
//!
//! Heights in, heights out, and before the body impulses in, impulses out. How much of the motion is slip, and what ground lies there, is worked out at the steps of the absolute sample grid; between two of
//! them the share goes along a straight line. A contact whose reports tell no slip slides, and its heights stay what they are to the bit.

use crate::model::event::ContactSample;
use crate::prepared::area::FINGERTIP_RADIUS_M;
use crate::prepared::surface::SurfaceSlot;
use asperity_dsp::fractal_noise::{FractalNoise, growth};
use asperity_dsp::rolling::{Rolling as Law, RollingFilter, RollingState};
use asperity_dsp::trajectory::PathPoint;
use asperity_texture::height_field::{MAX_BLOCK, SurfaceBlock};

/// Slower than this a contact neither rolls nor slides, m/s: it goes on as it did.
const RESTING_M_S: f64 = 1e-4;
/// The low-pass of what is sent is nowhere slower, Hz: below what is heard.
const SLOWEST_HZ: f64 = 20.0;
/// What of the way to another share is left after a step of the grid: 8 ms for most of it, half a report at 60 Hz.
const LAG: f64 = 0.8;

/// How one contact rolls.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rolling {
    /// Speed of slip and radius of what rolls, of the newest report; none while it slides.
    told: Option<(f64, Option<f64>)>,
    /// Share of rolling at the last step of the grid, and at the next.
    share: [f64; 2],
    /// Of the ground under its last sample.
    roughness: f64,
    /// Of the ride, and of what is sent.
    filters: [RollingFilter; 2],
    ride: RollingState,
    sent: [RollingState; 2],
}

/// What is rolled over and how.
#[derive(Clone, Copy)]
pub(super) struct RolledOver<'a> {
    pub(super) slot: &'a SurfaceSlot,
    /// Mean square of the relief that the source has there, m².
    pub(super) source_power_m2: f64,
    pub(super) tip_radius_m: f64,
    pub(super) at: &'a PathPoint,
    pub(super) sample_rate_hz: f64,
}

impl Rolling {
    /// A report says how it moves.
    pub(super) fn tell(&mut self, sample: &ContactSample) {
        self.told = sample.slip_m_s.map(|slip_m_s| (slip_m_s, sample.roll_radius_m));
    }

    /// Whether any of it rolls, now or until the next step of the grid.
    pub(super) fn rolls(&self) -> bool {
        self.told.is_some() || self.share != [0.0; 2]
    }

    /// It begins as the newest report says, where the profile begins.
    pub(super) fn begin(&mut self, over: RolledOver<'_>, surface: &SurfaceBlock) {
        (self.ride, self.roughness) = (RollingState::at(surface.height_m[0]), surface.roughness[0]);
        self.sent = [RollingState::default(); 2];
        self.turn(over);
        let share = self.wanted(over.at).unwrap_or(0.0);
        self.share = [share; 2];
    }

    /// Sets out for the share of the newest report: at the steps of the absolute sample grid.
    pub(super) fn turn(&mut self, over: RolledOver<'_>) {
        let from = self.share[1];
        let wanted = self.wanted(over.at).unwrap_or(from);
        let to = wanted + LAG * (from - wanted);
        // What slides again does so to the bit in the end.
        self.share = [from, if wanted == 0.0 && to < 1e-6 { 0.0 } else { to }];
        let [u, v] = over.at.velocity_m_s;
        let radius_m = self.told.and_then(|(_, radius_m)| radius_m);
        let micro_m = over.slot.surface.micro_relief_m * growth(self.roughness);
        let law = Law {
            radius_m: radius_m.unwrap_or(over.tip_radius_m.max(FINGERTIP_RADIUS_M)),
            normal_force_n: over.at.normal_force_n,
            modulus_pa: over.slot.stroking.ground.modulus_pa(),
            rms_at_1mm_m: libm::sqrt(micro_m * micro_m + over.source_power_m2),
            alpha: FractalNoise::alpha(self.roughness),
        };
        let [ride_m, patch_m] = law.wavelengths_m();
        let speed_m_s = libm::hypot(u, v);
        // What rests rides no further, but the force on a patch that rests is the force on its points.
        let patch_m_s = speed_m_s.max(SLOWEST_HZ * patch_m);
        self.filters = [(speed_m_s, ride_m), (patch_m_s, patch_m)].map(|(speed_m_s, wavelength_m)| {
            RollingFilter::new(speed_m_s, wavelength_m, over.sample_rate_hz)
        });
    }

    /// The share that the newest report asks for; none at rest.
    fn wanted(&self, at: &PathPoint) -> Option<f64> {
        let Some((slip_m_s, _)) = self.told else { return Some(0.0) };
        let [u, v] = at.velocity_m_s;
        let speed_m_s = libm::hypot(u, v);
        (speed_m_s > RESTING_M_S).then(|| (1.0 - slip_m_s / speed_m_s).max(0.0))
    }

    /// Heights of the ground become those of the ride, and friction acts on what slips; `slow_step` samples lie between two steps of the grid.
    pub(super) fn run(&mut self, position: u64, slow_step: u64, surface: &mut SurfaceBlock, n: usize) {
        let height_m = &mut surface.height_m[..n];
        self.roughness = surface.roughness[n.saturating_sub(1)];
        if !self.rolls() {
            self.ride = RollingState::at(height_m.last().copied().unwrap_or_default());
            return;
        }
        for (i, (height_m, friction)) in height_m.iter_mut().zip(&mut surface.friction).enumerate() {
            let share = share_at(self.share, position + i as u64, slow_step);
            let ride_m = self.ride.tick(&self.filters[0], *height_m);
            *height_m += share * (ride_m - *height_m);
            *friction *= 1.0 - share;
        }
    }

    /// What is sent to the body comes from a patch that asperities enter and leave.
    pub(super) fn soften(&mut self, position: u64, slow_step: u64, impulses_n_s: [&mut [f64]; 2]) {
        if !self.rolls() {
            self.sent = [RollingState::default(); 2];
            return;
        }
        for (state, impulses_n_s) in self.sent.iter_mut().zip(impulses_n_s) {
            for (impulse_n_s, sample) in impulses_n_s.iter_mut().zip(position..) {
                let share = share_at(self.share, sample, slow_step);
                let patch_n_s = state.tick(&self.filters[1], *impulse_n_s);
                *impulse_n_s += share * (patch_n_s - *impulse_n_s);
            }
        }
    }

    /// Speeds over the ground become those of the slip.
    pub(super) fn slow_down(&self, position: u64, slow_step: u64, sweep_m_s: &mut [f64]) {
        if self.rolls() {
            for (sweep_m_s, sample) in sweep_m_s.iter_mut().zip(position..) {
                *sweep_m_s *= 1.0 - share_at(self.share, sample, slow_step);
            }
        }
    }

    /// The same of heights that lie behind a contact that appears.
    pub(super) fn lead_in(&mut self, surface: &mut SurfaceBlock) {
        if self.rolls() {
            self.run(0, MAX_BLOCK as u64, surface, MAX_BLOCK);
        }
    }
}

/// The share at a sample between two steps of the grid.
fn share_at([from, to]: [f64; 2], sample: u64, slow_step: u64) -> f64 {
    from + (sample % slow_step + 1) as f64 / slow_step as f64 * (to - from)
}
