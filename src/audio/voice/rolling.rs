//! Rolling: of what rolls and does not slide only the ride over the ground is felt and heard
//! (`dsp::rolling`).
//!
//! Heights in, heights out, and before the body impulses in, impulses out. The share of rolling goes
//! along a straight line between two steps of the absolute grid. A contact whose reports tell no
//! slip slides, and its heights stay what they are to the bit.

use crate::model::event::ContactSample;
use crate::prepared::area::FINGERTIP_RADIUS_M;
use crate::prepared::stiffness::stiffness_n_m;
use crate::prepared::surface::SurfaceSlot;
use asperity_dsp::fractal_noise::{FractalNoise, growth};
use asperity_dsp::micro_contact::Probe;
use asperity_dsp::rolling::{Rolling as Law, RollingFilter, RollingForce, RollingForceState, RollingState};
use asperity_dsp::trajectory::PathPoint;
use asperity_texture::height_field::{MAX_BLOCK, SurfaceBlock};

/// Slower than this a contact neither rolls nor slides, m/s: it goes on as it did.
const RESTING_M_S: f64 = 1e-4;
/// Acceleration with which the free weight of what rolls presses, m/s².
const GRAVITY_M_S2: f64 = 9.81;
/// Rest of the way to another share after a step of the grid: 8 ms for most of it, half a report at
/// 60 Hz.
const LAG: f64 = 0.8;

/// Rolling of one contact.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rolling {
    /// Speed of slip and radius of what rolls, of the newest report; none while it slides.
    told: Option<(f64, Option<f64>)>,
    /// Share of rolling at the last step of the grid, and at the next.
    share: [f64; 2],
    /// Roughness of the ground under its last sample.
    roughness: f64,
    filter: RollingFilter,
    force: RollingForce,
    ride: RollingState,
    sent: RollingForceState,
}

/// Ground that is rolled over, and the radius.
#[derive(Clone, Copy)]
pub(super) struct RolledOver<'a> {
    pub(super) slot: &'a SurfaceSlot,
    /// Mean square of the relief that the source has there, m².
    pub(super) source_power_m2: f64,
    pub(super) probe: &'a Probe,
    pub(super) at: &'a PathPoint,
    pub(super) sample_rate_hz: f64,
}

impl Rolling {
    /// Takes from a report how it moves.
    pub(super) fn tell(&mut self, sample: &ContactSample) {
        self.told = sample.slip_m_s.map(|slip_m_s| (slip_m_s, sample.roll_radius_m));
    }

    /// Tests whether any of it rolls, now or until the next step of the grid.
    pub(super) fn rolls(&self) -> bool {
        self.told.is_some() || self.share != [0.0; 2]
    }

    /// Begins as the newest report says, where the profile begins.
    pub(super) fn begin(&mut self, over: RolledOver<'_>, surface: &SurfaceBlock) {
        (self.ride, self.roughness) = (RollingState::at(surface.height_m[0]), surface.roughness[0]);
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
        // What slides again does so to the bit in the end.
        self.share = [from, if wanted == 0.0 && to < 1e-6 { 0.0 } else { to }];
        let [u, v] = over.at.velocity_m_s;
        let radius_m = self.told.and_then(|(_, radius_m)| radius_m);
        let micro_m = over.slot.surface.micro_relief_m * growth(self.roughness);
        let law = Law {
            radius_m: radius_m.unwrap_or(over.probe.tip_radius_m.max(FINGERTIP_RADIUS_M)),
            normal_force_n: over.at.normal_force_n,
            modulus_pa: over.slot.stroking.ground.modulus_pa(),
            rms_at_1mm_m: libm::sqrt(micro_m * micro_m + over.source_power_m2),
            alpha: FractalNoise::alpha(self.roughness),
        };
        let [ride_m, patch_m] = law.wavelengths_m();
        let speed_m_s = libm::hypot(u, v);
        self.filter = RollingFilter::new(speed_m_s, ride_m, over.sample_rate_hz);
        let rolling_kg = rolling_kg(over.probe, law.normal_force_n);
        let stiffness_n_m = stiffness_n_m(over.probe, &over.slot.stroking.ground, law.normal_force_n);
        let resonance_hz = libm::sqrt(stiffness_n_m / rolling_kg) / std::f64::consts::TAU;
        let mass = (rolling_kg / over.probe.pad_mass_kg, resonance_hz);
        self.force = RollingForce::new((speed_m_s, patch_m), mass, over.sample_rate_hz);
    }

    /// The share that the newest report asks for; none at rest.
    fn wanted(&self, at: &PathPoint) -> Option<f64> {
        let Some((slip_m_s, _)) = self.told else { return Some(0.0) };
        let [u, v] = at.velocity_m_s;
        let speed_m_s = libm::hypot(u, v);
        (speed_m_s > RESTING_M_S).then(|| (1.0 - slip_m_s / speed_m_s).max(0.0))
    }

    /// Heights of the ground become those of the ride, and friction, where it is known, acts on
    /// what slips; `slow_step` samples lie between two steps of the grid.
    pub(super) fn run(
        &mut self,
        (position, slow_step): (u64, u64),
        surface: &mut SurfaceBlock,
        n: usize,
        rubbed: bool,
    ) {
        let height_m = &mut surface.height_m[..n];
        self.roughness = surface.roughness[n.saturating_sub(1)];
        if !self.rolls() {
            self.ride = RollingState::at(height_m.last().copied().unwrap_or_default());
            return;
        }
        for (i, (height_m, friction)) in height_m.iter_mut().zip(&mut surface.friction).enumerate() {
            let share = share_at(self.share, position + i as u64, slow_step);
            let ride_m = self.ride.tick(&self.filter, *height_m);
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
        for (impulse_n_s, sample) in impulses_n_s.iter_mut().zip(position..) {
            let share = share_at(self.share, sample, slow_step);
            let patch_n_s = self.sent.tick(&self.force, *impulse_n_s);
            *impulse_n_s += share * (patch_n_s - *impulse_n_s);
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

    /// Softens `n` heights that lie behind a contact that appears; its share stands still
    /// meanwhile.
    pub(super) fn lead_in(&mut self, surface: &mut SurfaceBlock, n: usize) {
        if self.rolls() {
            self.run((0, MAX_BLOCK as u64), surface, n, true);
        }
    }
}

/// Mass of a rolling body that follows the ground, kg: as much as presses with its weight, as far
/// as the probe has it. A finger gives way.
fn rolling_kg(probe: &Probe, force_n: f64) -> f64 {
    let most_kg = if probe.ridge_m > 0.0 { 0.0 } else { probe.finger_mass_kg };
    probe.pad_mass_kg + (force_n / GRAVITY_M_S2 - probe.pad_mass_kg).clamp(0.0, most_kg)
}

/// The share at a sample between two steps of the grid.
fn share_at([from, to]: [f64; 2], sample: u64, slow_step: u64) -> f64 {
    from + (sample % slow_step + 1) as f64 / slow_step as f64 * (to - from)
}
