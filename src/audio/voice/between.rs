//! Between samples: relief that passes within a few of them is looked at midway as well, where the contact would miss it.
//!
//! ```text
//! e > 0.03 F/k        e: rms of the relief beside the cubics through its samples;  F/k: how deep the pad is pressed in
//! ```
//! A pad pressed in deeper than that follows the cubic as well as it would follow the ground: 0.1 of F/k on a stroke that leaves the ground
//! at every crest is heard at −33 dB, 0.03 at −40, 0.01 at −50 dB. A stroke of 0.1 m/s under 0.8 N on a roughness of 0.5 does not pay. Decided where a contact
//! begins and at the steps of the absolute sample grid, so that it depends on no split into blocks; only for the scheme that knows events.

use super::profile::{FromThere, Midway};
use super::shared::Shared;
use crate::audio::seat::Seat;
use crate::prepared::probe::PreparedProbe;
use asperity_dsp::fractal_noise::{OCTAVES, unseen_between};
use asperity_dsp::micro_contact::{Bend, Bends, Integrator, Probe};
use asperity_dsp::trajectory::PathPoint;

/// Of F/k.
const MISSED: f64 = 0.03;

/// What one contact knows of the ground between its samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct Between {
    /// The coarsest octave that is looked at midway; [`OCTAVES`] for none.
    octave: usize,
    /// Of the ground under its last sample.
    roughness: f64,
    bends: Bends,
}

/// What a contact is at a step of the grid.
pub(super) struct Pressed<'a> {
    pub(super) shared: &'a Shared,
    pub(super) at: &'a PathPoint,
    pub(super) probe: &'a PreparedProbe,
    /// As stiff as it is.
    pub(super) contact: &'a Probe,
    /// Its profile is what the surface says.
    pub(super) plain: bool,
}

impl Default for Between {
    /// Nobody's; the first ground is as rough as any.
    fn default() -> Self {
        Self { octave: OCTAVES, roughness: 1.0, bends: Bends::default() }
    }
}

impl Between {
    /// Which octaves are looked at until the next step of the grid.
    pub(super) fn decide(&mut self, by: &Pressed<'_>, seat: &mut Seat) {
        let Pressed { shared, at, probe, contact, plain } = by;
        let octave = if *plain && probe.micro_contact.integrator() == Integrator::ExactEvent {
            let [u, v] = at.velocity_m_s;
            let footprint_m = (u * u + v * v).sqrt() / shared.sample_rate_hz;
            let footprints_m = [footprint_m, footprint_m * shared.noise_footprints()];
            let missed_m = seat.missed_m(self.roughness, footprints_m, probe.tip_radius_m());
            let counts = missed_m * contact.contact_stiffness_n_m > MISSED * at.normal_force_n;
            if counts { unseen_between(footprint_m) } else { OCTAVES }
        } else {
            OCTAVES
        };
        if octave != self.octave {
            self.octave = octave;
            self.bends.forget();
        }
    }

    /// Whether any are.
    pub(super) fn looks(&self) -> bool {
        self.octave < OCTAVES
    }

    /// What has to be looked at midway on the way from a place; none where nothing has.
    pub(super) fn on_the_way(&self, from_m: [f64; 2]) -> Option<FromThere> {
        self.looks().then_some(FromThere { octave: self.octave, from_m })
    }

    /// Takes what was seen midway; what the profile does beside the cubics through its samples.
    pub(super) fn bend(&mut self, seen: &Midway, bends: &mut [Bend]) {
        if !seen.seen {
            self.bends.forget();
            return bends.fill([0.0; 4]);
        }
        for ((bend, at_m), midway_m) in bends.iter_mut().zip(&seen.at_m).zip(&seen.midway_m) {
            *bend = self.bends.next(*at_m, *midway_m);
        }
    }

    /// How rough its last sample was.
    pub(super) fn remember(&mut self, roughness: f64) {
        self.roughness = roughness;
    }
}
