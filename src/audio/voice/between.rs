//! Between samples: relief that passes within a few of them is looked at there as well, where the
//! contact would miss it.
//!
//! ```text
//! e > 0.02 F/k: midway        e > 0.12 F/k: at the quarters too
//! ```
//! e: rms of the relief beside the cubics through its samples; F/k: how deep the pad is pressed in.
//! A pad pressed in deeper follows the cubic as well as it would follow the ground: 0.1 of F/k on a
//! stroke that leaves the ground at every crest is heard at −33 dB, 0.03 at −40, 0.01 at −50 dB.
//! Known midway a twenty-fifth of e is left, which lightly pressed pads that hop make up to −20 dB
//! of; known at the quarters, a three-hundredth. Only octaves are looked at without which more than
//! 0.001 F/k would be missed. A stroke of 0.05 m/s under 0.8 N pays on no roughness up to 0.8.
//! Decided where a contact begins and at the steps of the absolute sample grid, so that it depends
//! on no split into blocks; only for the scheme that knows events. What is looked at is kept for a
//! while about a limit: to begin anew costs three samples of cubic.

use super::profile::{FromThere, Seen};
use super::shared::Shared;
use crate::audio::seat::Seat;
use crate::prepared::probe::PreparedProbe;
use asperity_dsp::fractal_noise::OCTAVES;
use asperity_dsp::micro_contact::{Bend, Bends, GroundBetween, Integrator, Probe};
use asperity_dsp::trajectory::PathPoint;

/// Missed of F/k from which on it is looked midway, and at the quarters.
const MIDWAY: f64 = 0.02;
const QUARTERS: f64 = 0.12;
/// So far below a limit what is looked at is kept.
const KEPT: f64 = 0.8;
/// Largest error that may stay, of F/k.
const LEFT: f64 = 0.001;

/// Fineness of the look at the ground between two samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(super) enum Closeness {
    #[default]
    AtSamples,
    Midway,
    Quarters,
}

impl Closeness {
    /// The ground under so many samples, of which this is known.
    pub(super) fn ground(self, n: usize, bends: &[[Bend; 2]]) -> GroundBetween<'_> {
        match self {
            Self::AtSamples => GroundBetween::AtSamples,
            Self::Midway => GroundBetween::Midway(&bends.as_flattened()[..n]),
            Self::Quarters => GroundBetween::Quarters(&bends[..n]),
        }
    }
}

/// Ground of one contact between its samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct Between {
    looks: Closeness,
    /// The coarsest octave that is looked at.
    octave: usize,
    /// Roughness of the ground under its last sample.
    roughness: f64,
    bends: Bends,
}

/// State of a contact at a step of the grid.
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
    /// State of an unused voice; the first ground is as rough as any.
    fn default() -> Self {
        Self { looks: Closeness::AtSamples, octave: OCTAVES, roughness: 1.0, bends: Bends::default() }
    }
}

impl Between {
    /// Look until the next step of the grid.
    pub(super) fn decide(&mut self, by: &Pressed<'_>, seat: &mut Seat) {
        let (looks, octave) = self.needed(by, seat);
        // One octave more than needed is not worth a beginning.
        let enough = looks == self.looks && (octave == self.octave || octave == self.octave + 1);
        if looks == Closeness::AtSamples || !enough {
            (self.looks, self.octave) = (looks, octave);
            self.bends.forget();
        }
    }

    fn needed(&self, by: &Pressed<'_>, seat: &mut Seat) -> (Closeness, usize) {
        let Pressed { shared, at, probe, contact, plain } = by;
        if !plain || probe.micro_contact.integrator() != Integrator::ExactEvent {
            return (Closeness::AtSamples, OCTAVES);
        }
        let [u, v] = at.velocity_m_s;
        let footprint_m = (u * u + v * v).sqrt() / shared.sample_rate_hz;
        let footprints_m = [footprint_m, footprint_m * shared.noise_footprints()];
        let depth_m = at.normal_force_n / contact.contact_stiffness_n_m;
        let missed = seat.missed(self.roughness, footprints_m, LEFT * depth_m, probe.tip_radius_m());
        let counts = |closeness: Closeness, limit: f64| {
            let limit = if self.looks >= closeness { KEPT * limit } else { limit };
            missed.all_m > limit * depth_m
        };
        if counts(Closeness::Quarters, QUARTERS) {
            (Closeness::Quarters, missed.octave)
        } else if counts(Closeness::Midway, MIDWAY) {
            (Closeness::Midway, missed.octave)
        } else {
            (Closeness::AtSamples, OCTAVES)
        }
    }

    /// Look on the way from a place; none where nothing has to be looked at.
    pub(super) fn on_the_way(&self, from_m: [f64; 2]) -> Option<FromThere> {
        let quarters = match self.looks {
            Closeness::AtSamples => return None,
            Closeness::Midway => false,
            Closeness::Quarters => true,
        };
        Some(FromThere { octave: self.octave, quarters, from_m })
    }

    /// Takes what was seen in so many samples; what the profile does beside the cubics through them
    /// ([`Closeness::ground`]).
    pub(super) fn bend(
        &mut self,
        shared: &Shared,
        seen: &Seen,
        n: usize,
        bends: &mut [[Bend; 2]],
    ) -> Closeness {
        let (level, bends) = (shared.noise.level(), &mut bends[..n]);
        let (at_m, [midway_m, first_m, second_m]) = (&seen.at_m[..n], &seen.between_m);
        if self.looks == Closeness::AtSamples {
            return self.looks;
        }
        if !seen.seen {
            self.bends.forget();
            bends.fill([[0.0; 4]; 2]);
        } else if self.looks == Closeness::Midway {
            self.bends.midway(level, at_m, &midway_m[..n], &mut bends.as_flattened_mut()[..n]);
        } else {
            let quarters = [&first_m[..n], &second_m[..n]];
            self.bends.quarters(level, at_m, &midway_m[..n], quarters, bends);
        }
        self.looks
    }

    /// Stores the roughness of its last sample.
    pub(super) fn remember(&mut self, roughness: f64) {
        self.roughness = roughness;
    }
}
