//! Ground that is rolled over (`dsp::rolling`): which of its waves the ride and the patch leave.

use crate::resource::area::FINGERTIP_RADIUS_M;
use crate::resource::stiffness::stiffness_n_m;
use crate::resource::surface::SurfaceSlot;
use asperity_dsp::fractal_noise::{FractalNoise, growth};
use asperity_dsp::micro_contact::Probe;
use asperity_dsp::rolling::{Rolling, RollingFilter, RollingForce};
use asperity_dsp::trajectory::PathPoint;

/// Acceleration with which the free weight of what rolls presses, m/s².
const GRAVITY_M_S2: f64 = 9.81;

/// The ground under a contact that rolls.
#[derive(Clone, Copy)]
pub(crate) struct RolledOver<'a> {
    pub(crate) slot: &'a SurfaceSlot,
    /// Mean square of the relief that the source has there, m².
    pub(crate) source_power_m2: f64,
    pub(crate) probe: &'a Probe,
    pub(crate) at: &'a PathPoint,
    pub(crate) sample_rate_hz: f64,
}

impl RolledOver<'_> {
    /// Filters of the heights and of what is sent to the body; the probe's own radius for none.
    pub(crate) fn filters(&self, radius_m: Option<f64>, roughness: f64) -> (RollingFilter, RollingForce) {
        let Self { slot, source_power_m2, probe, at, sample_rate_hz } = *self;
        let ground = &slot.stroking.ground;
        let micro_m = slot.surface.micro_relief_m * growth(roughness);
        let law = Rolling {
            radius_m: radius_m.unwrap_or(probe.tip_radius_m.max(FINGERTIP_RADIUS_M)),
            normal_force_n: at.normal_force_n,
            modulus_pa: ground.modulus_pa(),
            rms_at_1mm_m: libm::sqrt(micro_m * micro_m + source_power_m2),
            alpha: FractalNoise::alpha(roughness),
        };
        let [ride_m, patch_m] = law.wavelengths_m();
        let [u, v] = at.velocity_m_s;
        let speed_m_s = libm::hypot(u, v);
        let rolling_kg = rolling_kg(probe, law.normal_force_n);
        let stiffness_n_m = stiffness_n_m(probe, ground, law.normal_force_n);
        let resonance_hz = libm::sqrt(stiffness_n_m / rolling_kg) / std::f64::consts::TAU;
        let mass = (rolling_kg / probe.pad_mass_kg, resonance_hz);
        let filter = RollingFilter::new(speed_m_s, ride_m, sample_rate_hz);
        (filter, RollingForce::new((speed_m_s, patch_m), mass, sample_rate_hz))
    }
}

/// Mass of a rolling body that follows the ground, kg: as much as presses with its weight, as far
/// as the probe has it. A finger gives way.
fn rolling_kg(probe: &Probe, force_n: f64) -> f64 {
    let most_kg = if probe.ridge_m > 0.0 { 0.0 } else { probe.finger_mass_kg };
    probe.pad_mass_kg + (force_n / GRAVITY_M_S2 - probe.pad_mass_kg).clamp(0.0, most_kg)
}
