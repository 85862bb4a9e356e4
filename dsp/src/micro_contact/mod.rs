//! The micro-contact: finger, pad and skin sliding over a height profile (Hasti §III-C, Fig. 6).
//!
//! ```text
//! m_f v_f' = k_s (x_s − x_f) + b_s (v_s − v_f) − F_n
//! m_s v_s' = −k_s (x_s − x_f) − b_s (v_s − v_f) + k_m max(0, x_m − x_s)
//! ```
//! Positions are positive out of the surface; x_f is the finger's less the pad's unloaded
//! thickness.
//!
//! | symbol | field | |
//! |---|---|---|
//! | m_s, k_s, b_s | [`Probe::pad_mass_kg`], [`Probe::pad_stiffness_n_m`], [`Probe::pad_damping_n_s_m`] | skin and pad |
//! | m_f | [`Probe::finger_mass_kg`] | the floating finger |
//! | k_m | [`Probe::contact_stiffness_n_m`] | one-sided spring, pushes only |
//! | x_m, F_n | `height_m`, `normal_force_n` of [`MicroContact::run`] | one value a sample |
//! | x_s, v_s, x_f | [`ContactSample::pad_m`], [`ContactSample::pad_velocity_m_s`], [`ContactSample::finger_m`] | |
//!
//! Changes to the paper, and their effect:
//! - three integrators ([`Integrator`]) instead of one, chosen by a rule ([`Choice`]) that never
//!   runs an unsafe one; the paper's own is one of them, with its damper centred in time;
//! - a leash: beyond [`Probe::leash_m`] of separation nothing moves further up (an unloaded finger
//!   drifts away in the paper's equations);
//! - collisions as timed events with their closing speed, and the mean contact force of each step,
//!   so that force × step is the impulse;
//! - hostile input is repaired and counted (table in the module `guard`).
//!
//! Measured at 44.1 kHz with the default probe (`tests/micro_contact_accuracy.rs`: RMS error over
//! the AC RMS of a 64 times oversampled reference that agrees with scipy's DOP853 to 1e-5;
//! geometric mean of 12 profiles / of 12 held-out ones; `tests/micro_contact_passivity.rs`:
//! undamped bouncing, 10 s):
//!
//! | integrator | pad position | spring force | energy gain | latency |
//! |---|---|---|---|---|
//! | semi-implicit Euler, damper centred | 9.6e-4 / 5.4e-4 | 6.0e-3 / 4.1e-3 | random | 0 |
//! | the same, damper explicit | 7.7e-3 / 8.7e-3 | 5.3e-2 / 6.4e-2 | random | 0 |
//! | exact events (default) | 2.3e-5 / 1.4e-5 | 1.5e-4 / 9.4e-5 | < 1e-6 to 5e6 N/m | 1 sample |
//! | energy-conserving | 1.1e-3 / 7.3e-4 | 7.2e-3 / 5.4e-3 | < 1e-10 to 9e7 N/m | 0 |
//!
//! A row of Euler holds the force at the row's time (the mean over the step centred on it); the
//! other two give the mean over the step that ends at the row.
mod choice;
mod energy_conserving;
mod exact_event;
mod flow;
mod guard;
mod probe;
mod quad;
mod quartic_correction;
mod semi_implicit;
mod state;
mod stiffening;
mod tip;

pub use choice::{
    Choice, EULER_MAX_PHASE, EXACT_MAX_PHASE, EXACT_MAX_STIFFNESS_N_M, Integrator, SUBSTEP_MAX_PHASE,
};
pub use probe::{
    CONTACT_STIFFNESS_N_M, FINGER_ASPERITIES, FINGER_MASS_KG, FORCE_EXPONENT, LEASH_M, PAD_DAMPING_N_S_M,
    PAD_MASS_KG, PAD_STIFFNESS_N_M, Probe, RIDGE_M,
};
pub use quartic_correction::{QuarticCorrection, QuarticCorrections, SubSampleProfile};
pub use state::{ContactSample, ContactState, Onset};
pub use stiffening::RUNGS_AN_OCTAVE;
pub use tip::HeardTip;

use crate::DesignError;
use crate::simd::{Level, at_level};
use energy_conserving::EnergyConserving;
use exact_event::ExactEvent;
use fearless_simd::SimdBase;
use fearless_simd::f64x4;
use guard::{CleanBlock, CleanGround, GRID};
use quad::{F64x2Pair, F64x4};
use semi_implicit::SemiImplicit;

/// A contact whose skin is nearer than this to its resting place is settled, m.
pub const SETTLED_M: f64 = 1e-12;
/// Velocities below this count as settled, m/s.
pub const SETTLED_M_S: f64 = 1e-10;
/// Fastest landing that is believed, m/s.
const MAX_CLOSING_M_S: f64 = 20.0;

/// The design of one probe at one rate; serves any number of contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MicroContact {
    probe: Probe,
    choice: Choice,
    step_s: f64,
    leash_m: f64,
    scheme: Scheme,
    level: Level,
}

#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(clippy::large_enum_variant)] // Few designs exist and none is moved at run time.
enum Scheme {
    SemiImplicit(SemiImplicit),
    ExactEvent(ExactEvent),
    EnergyConserving(EnergyConserving),
}

impl Scheme {
    fn new(probe: &Probe, choice: Choice, step_s: f64) -> Self {
        let euler =
            |explicit| Self::SemiImplicit(SemiImplicit::new(probe, explicit, step_s, choice.substeps));
        match choice.used {
            Integrator::SemiImplicitEuler => euler(false),
            Integrator::SemiImplicitEulerExplicitDamper => euler(true),
            Integrator::ExactEvent => Self::ExactEvent(ExactEvent::new(probe, step_s)),
            Integrator::EnergyConserving => Self::EnergyConserving(EnergyConserving::new(probe, step_s)),
        }
    }
}

impl MicroContact {
    /// Designs the contact; what runs may differ from `wanted` as [`Choice`] documents.
    ///
    /// ```
    /// use asperity_dsp::micro_contact::{ContactSample, Integrator, MicroContact, Probe};
    ///
    /// // A fingertip at rest on flat ground presses with what presses it.
    /// let contact = MicroContact::new(&Probe::default(), Integrator::ExactEvent, 44_100.0)?;
    /// let mut state = contact.at_rest(0.0, 0.5);
    /// let mut rows = [ContactSample::default(); 64];
    /// contact.run(&mut state, &[0.0; 64], &[0.5; 64], &mut rows);
    /// assert!((rows[63].contact_force_n - 0.5).abs() < 1e-6);
    /// # Ok::<(), asperity_dsp::DesignError>(())
    /// ```
    ///
    /// # Errors
    /// When a field of the probe is outside its range, or the rate outside 1 kHz to 20 MHz
    /// (oversampled references).
    pub fn new(probe: &Probe, wanted: Integrator, sample_rate_hz: f64) -> Result<Self, DesignError> {
        probe.check()?;
        let expected = "from 1 kHz to 20 MHz";
        DesignError::check("sample_rate_hz", sample_rate_hz, expected, |r| (1e3..=2e7).contains(&r))?;
        let step_s = 1.0 / sample_rate_hz;
        let choice = Choice::new(probe, wanted, step_s);
        let scheme = Scheme::new(probe, choice, step_s);
        Ok(Self { probe: *probe, choice, step_s, leash_m: probe.leash_m, scheme, level: Level::detect() })
    }

    /// Probe, designed as it was, on a contact of another stiffness, N/m. A pad that flies does not
    /// feel that stiffness, so half of the exact scheme is there already.
    ///
    /// # Errors
    /// When the stiffness is outside the range of [`Probe`].
    pub fn stiffened(&self, contact_stiffness_n_m: f64) -> Result<Self, DesignError> {
        let (probe, step_s) = (Probe { contact_stiffness_n_m, ..self.probe }, self.step_s);
        probe.check()?;
        let choice = Choice::new(&probe, self.choice.wanted, step_s);
        let scheme = match &self.scheme {
            Scheme::ExactEvent(own) if choice.used == Integrator::ExactEvent => {
                Scheme::ExactEvent(ExactEvent::beside(own.regimes[0], &probe, step_s))
            }
            _ => Scheme::new(&probe, choice, step_s),
        };
        Ok(Self { probe, choice, scheme, ..*self })
    }

    /// Contact on a chosen instruction set. Whether products and sums round apart, as on
    /// [`Level::PORTABLE`], or together, as on all others, shows in the last bits of a row.
    #[must_use]
    pub fn on(self, level: Level) -> Self {
        Self { level, ..self }
    }

    /// The instruction set in use.
    #[must_use]
    pub fn level(&self) -> Level {
        self.level
    }

    /// The probe it was designed for.
    #[must_use]
    pub fn probe(&self) -> &Probe {
        &self.probe
    }

    /// The integrator in use.
    #[must_use]
    pub fn integrator(&self) -> Integrator {
        self.choice.used
    }

    /// Integration steps a sample.
    #[must_use]
    pub fn substeps(&self) -> usize {
        self.choice.substeps
    }

    /// Decision and its reason; prints as a sentence.
    #[must_use]
    pub fn choice(&self) -> Choice {
        self.choice
    }

    /// Rows lag inputs by this much: 1 for the exact scheme, otherwise 0.
    #[must_use]
    pub fn latency_samples(&self) -> usize {
        usize::from(self.choice.used == Integrator::ExactEvent)
    }

    /// A finger that has been pressing on this height for ever: it starts without a transient.
    /// An impossible height or force counts as a reset and is taken as zero.
    #[must_use]
    pub fn at_rest(&self, height_m: f64, normal_force_n: f64) -> ContactState {
        let mut resets = 0;
        let height_m = guard::start_or_zero(height_m, guard::is_height(height_m), &mut resets);
        let force_n = guard::start_or_zero(normal_force_n, guard::is_force(normal_force_n), &mut resets);
        let force_n = force_n.max(0.0);
        let mut state = ContactState::new(self.resting(force_n), height_m, force_n);
        state.resets = resets;
        state
    }

    /// [`Self::at_rest`] on ground that rises at `velocity_m_s` and did so before: finger and pad
    /// rise with it. A velocity that is no number, or crosses all heights there are within a
    /// sample, is zero.
    #[must_use]
    pub fn riding(&self, height_m: f64, normal_force_n: f64, velocity_m_s: f64) -> ContactState {
        let mut state = self.at_rest(height_m, normal_force_n);
        let is_valid = guard::is_height(velocity_m_s * self.step_s);
        let speed = if is_valid { velocity_m_s } else { 0.0 };
        let drift = speed * self.step_s;
        if let Scheme::SemiImplicit(scheme) = &self.scheme {
            state.y[0] += drift / scheme.substeps as f64;
        }
        (state.y[2], state.y[3], state.rise_m_s) = (speed, speed, speed);
        let height_m = state.heights_m[2];
        state.heights_m = [height_m - 2.0 * drift, height_m - drift, height_m];
        state
    }

    /// [`Self::riding`] up to the middle one of three heights, over the ground about it: one a
    /// sample before, there, and one a sample later. The next input is the last of them, or with a
    /// latency the one after it.
    #[must_use]
    pub fn sliding_along_a_line(
        &self,
        heights_m: [f64; 3],
        normal_force_n: f64,
        velocity_m_s: f64,
    ) -> ContactState {
        let mut state = self.riding(heights_m[1], normal_force_n, velocity_m_s);
        if self.latency_samples() == 1 && heights_m.iter().all(|height_m| guard::is_height(*height_m)) {
            state.heights_m = heights_m;
        }
        state
    }

    /// An unloaded pad that meets this height at the closing speed (at most 20 m/s), one sample
    /// before the first input: its onset is reported in the first rows. Without a closing speed
    /// above zero the finger is [`Self::at_rest`].
    #[must_use]
    pub fn landing(&self, height_m: f64, normal_force_n: f64, closing_m_s: f64) -> ContactState {
        self.landing_later(height_m, normal_force_n, closing_m_s, 0.0)
    }

    /// [`Self::landing`] `later_samples` (0–16) later: 1 is at the first input.
    #[must_use]
    pub fn landing_later(
        &self,
        height_m: f64,
        normal_force_n: f64,
        closing_m_s: f64,
        later_samples: f64,
    ) -> ContactState {
        let mut state = self.at_rest(height_m, normal_force_n);
        if closing_m_s > 0.0 {
            let speed = closing_m_s.min(MAX_CLOSING_M_S);
            let drift = speed * self.step_s;
            // The exact state is one sample older, the Euler state one drift ahead.
            let gap_m = match &self.scheme {
                Scheme::ExactEvent(_) => drift,
                Scheme::SemiImplicit(scheme) => -drift / scheme.substeps as f64,
                Scheme::EnergyConserving(_) => 0.0,
            };
            let later_samples = later_samples.clamp(0.0, 16.0);
            // The pressing force speeds the finger up on its way down; the pad behind its damper
            // does not follow so soon.
            let gained = normal_force_n.clamp(0.0, guard::MAX_FORCE_N) * self.step_s * later_samples
                / self.probe.finger_mass_kg;
            state.y = [gap_m + later_samples * drift, 0.0, -speed, gained - speed];
            state.gap_m = 0.0;
        } else if closing_m_s.is_nan() {
            state.resets += 1;
        }
        state
    }

    /// Runs the next `out.len()` samples (or as many as both inputs have). Row n describes input
    /// n − [`Self::latency_samples`]; any split into calls gives the same rows.
    pub fn run(
        &self,
        state: &mut ContactState,
        height_m: &[f64],
        normal_force_n: &[f64],
        out: &mut [ContactSample],
    ) {
        self.run_over(state, height_m, normal_force_n, SubSampleProfile::AtSamples, out);
    }

    /// [`Self::run`] over ground that is known between its samples as well
    /// ([`QuarticCorrections`]). Only the exact scheme looks at it.
    pub fn run_over(
        &self,
        state: &mut ContactState,
        height_m: &[f64],
        normal_force_n: &[f64],
        ground: SubSampleProfile<'_>,
        out: &mut [ContactSample],
    ) {
        // Four numbers fill no wider vector.
        at_level!(self.level.at_most_256_bits(), s => {
            let (quad, halves): (f64x4<_>, _) = (SimdBase::splat(s, 0.0), F64x2Pair::zero(s));
            self.run_blocks(quad, halves, state, (height_m, normal_force_n, ground), out);
        });
    }

    /// Tests whether the contact, if this height and force stay, no longer moves by more than
    /// [`SETTLED_M`]: then its rows are those of [`Self::at_rest`], or of a finger hanging free
    /// without load, and it may sleep.
    #[must_use]
    pub fn is_settled(&self, state: &ContactState, height_m: f64, normal_force_n: f64) -> bool {
        let force_n = normal_force_n.max(0.0);
        let near = |a: f64, b: f64| (a - b).abs() <= SETTLED_M;
        let inputs_stay = state.heights_m.iter().all(|&h| near(h, height_m))
            && state.forces_n.iter().all(|&f| (f - force_n).abs() <= 1e-9);
        let still = state.y[2].abs() <= SETTLED_M_S && state.y[3].abs() <= SETTLED_M_S;
        let rest = self.resting(force_n);
        let hangs = force_n == 0.0 && state.y[0] >= 0.0;
        inputs_stay && still && near(state.y[1], rest[1]) && (hangs || near(state.y[0], rest[0]))
    }

    /// Energy in masses and springs, J, at the last row (the Euler schemes: half a step off).
    /// Without damper, surface motion and normal force it is conserved; the passivity tests hold it
    /// to that.
    #[must_use]
    pub fn energy_j(&self, state: &ContactState) -> f64 {
        let Probe { pad_mass_kg, pad_stiffness_n_m, finger_mass_kg, contact_stiffness_n_m, .. } = self.probe;
        let [gap, stretch, pad, finger] = state.y;
        let penetration = gap.min(0.0);
        0.5 * (pad_mass_kg * pad * pad
            + finger_mass_kg * finger * finger
            + pad_stiffness_n_m * stretch * stretch
            + contact_stiffness_n_m * penetration * penetration)
    }

    /// (d, p, v_s, v_f) of static equilibrium.
    fn resting(&self, force_n: f64) -> [f64; 4] {
        [-force_n / self.probe.contact_stiffness_n_m, force_n / self.probe.pad_stiffness_n_m, 0.0, 0.0]
    }

    /// Cuts a run at the grid of the contact's clock.
    #[inline(always)]
    fn run_blocks<Q: F64x4, E: F64x4>(
        &self,
        quad: Q,
        halves: E,
        state: &mut ContactState,
        (mut height_m, mut force_n, mut ground): (&[f64], &[f64], SubSampleProfile<'_>),
        mut out: &mut [ContactSample],
    ) {
        let mut block = CleanBlock::EMPTY;
        loop {
            let left = GRID - state.clock as usize % GRID;
            let count = left.min(height_m.len()).min(force_n.len()).min(out.len());
            if count == 0 {
                return;
            }
            let (heights, later_heights) = height_m.split_at(count);
            let (forces, later_forces) = force_n.split_at(count);
            let (known, later_ground) = ground.split_at(count);
            let (rows, later_rows) = out.split_at_mut(count);
            block.fill(state, heights, forces);
            match &self.scheme {
                Scheme::SemiImplicit(scheme) => scheme.run(halves, self, state, &block, rows),
                Scheme::ExactEvent(scheme) => {
                    let clean;
                    let known = if known.is_sound(count) {
                        known
                    } else {
                        clean = CleanGround::of(known);
                        clean.ground(known, count)
                    };
                    scheme.run(quad, self, state, (&block, known), rows);
                }
                Scheme::EnergyConserving(scheme) => scheme.run(quad, self, state, &block, rows),
            }
            state.clock = state.clock.wrapping_add(count as u32);
            if count == left {
                guard::end_of_grid(state, self.step_s);
            }
            (height_m, force_n, ground, out) = (later_heights, later_forces, later_ground, later_rows);
        }
    }
}
