//! Ground between samples: relief that passes within a few samples is sampled between them too,
//! where the contact would miss it.
//!
//! ```text
//! e > 0.05 F/k: midway        e > 0.12 F/k: at the quarters too
//! ```
//! e: rms of the relief beside the cubics through its samples; F/k: how deep the pad is pressed in.
//! A pad pressed in deeper follows the cubic as well as it would follow the ground: 0.1 of F/k on a
//! stroke that leaves the ground at every crest is heard at −33 dB, 0.03 at −40, 0.01 at −50 dB.
//! Known midway a twenty-fifth of e is left, at the quarters a three-hundredth. A stroke of 0.05
//! m/s under 0.8 N pays on no roughness up to 0.8. A stroke of 0.1 m/s under 0.5 N on wood takes a
//! tenth more where it is looked at midway; without, the demo's third octaves move by 0.007 dB in
//! the median and 0.33 at most. Only for the integrator of events. Beginning anew costs
//! three samples of cubic, hence the hysteresis. Its price:
//! `dsp::micro_contact::QuarticCorrections`.

use crate::audio::seat::Seat;
use crate::audio::shared::Shared;
use crate::resource::overlay::{BetweenQuery, ShortWaves};
use crate::resource::probe::PreparedProbe;
use asperity_dsp::fractal_noise::OCTAVES;
use asperity_dsp::micro_contact::{
    Integrator, Probe, QuarticCorrection, QuarticCorrections, SubSampleProfile,
};
use asperity_dsp::trajectory::PathPoint;

/// Missed of F/k beyond which samples midway, and at the quarters, are wanted.
const MIDWAY: f64 = 0.05;
const QUARTERS: f64 = 0.12;
/// Hysteresis: share of a limit down to which they stay.
const KEPT: f64 = 0.8;
/// Largest error that may stay, of F/k.
const LEFT: f64 = 0.001;

/// Fineness of the samples of the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
enum Refinement {
    #[default]
    AtSamples,
    Midway,
    Quarters,
}

/// Ground of one contact between its samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct Between {
    closeness: Refinement,
    /// The coarsest octave that counts.
    octave: usize,
    /// Roughness under the last sample.
    pub(super) roughness: f64,
    quartic_correction: QuarticCorrections,
}

impl Default for Between {
    /// The first ground is as rough as any.
    fn default() -> Self {
        let (closeness, quartic_correction) = (Refinement::AtSamples, QuarticCorrections::default());
        Self { closeness, octave: OCTAVES, roughness: 1.0, quartic_correction }
    }
}

impl Between {
    /// Decides until the next step of the grid; `contact` is the probe as stiff as it is.
    pub(super) fn decide(
        &mut self,
        shared: &Shared,
        seat: &mut Seat,
        probe: &PreparedProbe,
        contact: &Probe,
        at: &PathPoint,
    ) {
        let (closeness, octave) = if probe.micro_contact.integrator() == Integrator::ExactEvent {
            self.needed(shared, seat, probe.tip_radius_m(), contact, at)
        } else {
            (Refinement::AtSamples, OCTAVES)
        };
        // One octave more than needed is not worth a beginning.
        let enough = closeness == self.closeness && (octave == self.octave || octave == self.octave + 1);
        if closeness == Refinement::AtSamples || !enough {
            (self.closeness, self.octave) = (closeness, octave);
            self.quartic_correction.forget();
        }
    }

    /// Samples the ground at samples only, until the next step of the grid.
    pub(super) fn leave(&mut self) {
        (self.closeness, self.octave) = (Refinement::AtSamples, OCTAVES);
        self.quartic_correction.forget();
    }

    fn needed(
        &self,
        shared: &Shared,
        seat: &mut Seat,
        tip_radius_m: f64,
        contact: &Probe,
        at: &PathPoint,
    ) -> (Refinement, usize) {
        let [u, v] = at.velocity_m_s;
        let footprint_m = (u * u + v * v).sqrt() / shared.sample_rate_hz;
        let footprints_m = [footprint_m, footprint_m * shared.noise_footprints()];
        let depth_m = at.normal_force_n / contact.contact_stiffness_n_m;
        let missed = seat.missed(self.roughness, footprints_m, LEFT * depth_m, tip_radius_m);
        for (closeness, limit) in [(Refinement::Quarters, QUARTERS), (Refinement::Midway, MIDWAY)] {
            let limit = if self.closeness >= closeness { KEPT * limit } else { limit };
            if missed.all_m > limit * depth_m {
                return (closeness, missed.octave);
            }
        }
        (Refinement::AtSamples, OCTAVES)
    }

    /// Samples wanted on the way from a place; none where those at the samples do.
    pub(super) fn on_the_way(&self, from_m: [f64; 2]) -> Option<BetweenQuery> {
        let quarters = self.closeness == Refinement::Quarters;
        (self.closeness != Refinement::AtSamples).then_some(BetweenQuery {
            octave: self.octave,
            quarters,
            from_m,
        })
    }

    /// The ground of `n` samples, by its short waves; `quartic_correction` is memory.
    pub(super) fn ground<'a>(
        &mut self,
        shared: &Shared,
        short: &ShortWaves,
        n: usize,
        quartic_correction: &'a mut [[QuarticCorrection; 2]],
    ) -> SubSampleProfile<'a> {
        let (level, quartic_correction) = (shared.noise.level(), &mut quartic_correction[..n]);
        let (at_m, [midway_m, first_m, second_m]) = (&short.at_m[..n], &short.between_m);
        if self.closeness != Refinement::AtSamples && !short.known {
            self.quartic_correction.forget();
            quartic_correction.fill([[0.0; 4]; 2]);
        }
        match self.closeness {
            Refinement::AtSamples => SubSampleProfile::AtSamples,
            Refinement::Midway => {
                let quartic_correction = &mut quartic_correction.as_flattened_mut()[..n];
                if short.known {
                    self.quartic_correction.midway(level, at_m, &midway_m[..n], quartic_correction);
                }
                SubSampleProfile::Midway(quartic_correction)
            }
            Refinement::Quarters => {
                let quarters = [&first_m[..n], &second_m[..n]];
                if short.known {
                    self.quartic_correction.quarters(
                        level,
                        at_m,
                        &midway_m[..n],
                        quarters,
                        quartic_correction,
                    );
                }
                SubSampleProfile::Quarters(quartic_correction)
            }
        }
    }
}
