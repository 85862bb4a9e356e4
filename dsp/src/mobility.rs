//! Mobility of a probe: how its pad moves when what it holds is struck.
//!
//! ```text
//! m_s v_s' = F − k_s (x_s − x_f) − b_s (v_s − v_f)
//! m_f v_f' =     k_s (x_s − x_f) + b_s (v_s − v_f) − k_h x_f − b_h v_f
//! k_h = (m_s + m_f) ω_h²      b_h = 2 (m_s + m_f) ω_h      ω_h = 2π · 5 Hz
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | m_s, k_s, b_s, m_f | [`Probe`] | as in the contact model |
//! | F | input of [`MobilityState::tick`] | N, positive out of the surface, the mean over the sample |
//! | x_s, v_s | its output | pad |
//! | k_h, b_h | [`HAND_HZ`] | the hand that brings the finger back, critically damped |
//!
//! Source: the masses, spring and damper of Hasti §III-C without their surface. The hand is ours
//! and **assumed**: without one a blow would send the finger away for ever; it is slower than
//! anything a vibration actuator plays.
//!
//! The step is the exact solution for a force that is constant over it (a matrix exponential at
//! design time), so the pad's velocity after a blow is exact whatever its length, and a sine of
//! frequency f errs by the hold alone: −0.02 dB at 1 kHz of 44.1.

use crate::DesignError;
use crate::micro_contact::Probe;
use core::f64::consts::TAU;

/// Rate at which a hand brings a finger back, Hz. **Assumed**: voluntary movement ends near it.
pub const HAND_HZ: f64 = 5.0;

/// Pad position and velocity, finger position and velocity.
type State = [f64; 4];

/// The design of one probe at one rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mobility {
    probe: Probe,
    /// State → state over a sample.
    step: [State; 4],
    /// Response to 1 N over the sample.
    push: State,
}

/// Memory of one probe that is struck.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MobilityState(State);

impl Mobility {
    /// For a probe whose contacts run at `sample_rate_hz`.
    ///
    /// # Errors
    /// When a field of the probe or the rate is outside its range.
    pub fn new(probe: &Probe, sample_rate_hz: f64) -> Result<Self, DesignError> {
        probe.check()?;
        DesignError::check("sample_rate_hz", sample_rate_hz, "from 1 kHz to 20 MHz", |r| {
            (1e3..=2e7).contains(&r)
        })?;
        let whole = exponential(&augmented(probe), 1.0 / sample_rate_hz);
        let step = core::array::from_fn(|row| core::array::from_fn(|column| whole[row][column]));
        let push = core::array::from_fn(|row| whole[row][4]);
        Ok(Self { probe: *probe, step, push })
    }

    /// Pad displacement over force at a frequency, m/N, real and imaginary part: the closed form
    /// that the time step samples.
    #[must_use]
    pub fn compliance_m_n(&self, frequency_hz: f64) -> [f64; 2] {
        let Probe { pad_mass_kg, pad_stiffness_n_m, pad_damping_n_s_m, finger_mass_kg, .. } = self.probe;
        let (w, hand) = (TAU * frequency_hz, Hand::of(&self.probe));
        let tie = [pad_stiffness_n_m, w * pad_damping_n_s_m];
        let finger = [tie[0] + hand.stiffness_n_m - finger_mass_kg * w * w, tie[1] + w * hand.damping_n_s_m];
        let pad = [tie[0] - pad_mass_kg * w * w, tie[1]];
        // (pad · finger − tie²) x_s = finger F
        let determinant = subtract(multiply(pad, finger), multiply(tie, tie));
        divide(finger, determinant)
    }
}

impl MobilityState {
    /// One sample of the force on the pad, N → pad position, m, and velocity, m/s, at its end.
    #[inline]
    pub fn tick(&mut self, design: &Mobility, force_n: f64) -> [f64; 2] {
        let before = self.0;
        for (row, now) in self.0.iter_mut().enumerate() {
            let step = &design.step[row];
            *now = step[0] * before[0]
                + step[1] * before[1]
                + step[2] * before[2]
                + step[3] * before[3]
                + design.push[row] * force_n;
        }
        [self.0[0], self.0[1]]
    }

    /// Tests whether pad and finger are as good as at rest: less than 1e-12 m and 1e-10 m/s from
    /// it.
    #[must_use]
    pub fn is_still(&self) -> bool {
        let [pad_m, pad_m_s, finger_m, finger_m_s] = self.0;
        pad_m.abs().max(finger_m.abs()) < 1e-12 && pad_m_s.abs().max(finger_m_s.abs()) < 1e-10
    }
}

/// Spring that ties the finger to its place.
struct Hand {
    stiffness_n_m: f64,
    damping_n_s_m: f64,
}

impl Hand {
    fn of(probe: &Probe) -> Self {
        let (mass_kg, w) = (probe.pad_mass_kg + probe.finger_mass_kg, TAU * HAND_HZ);
        Self { stiffness_n_m: mass_kg * w * w, damping_n_s_m: 2.0 * mass_kg * w }
    }
}

/// The equations as x' = A x + B F, with F as a fifth state that stays.
fn augmented(probe: &Probe) -> [[f64; 5]; 5] {
    let Probe { pad_mass_kg, pad_stiffness_n_m, pad_damping_n_s_m, finger_mass_kg, .. } = *probe;
    let (hand, k, b) = (Hand::of(probe), pad_stiffness_n_m, pad_damping_n_s_m);
    let mut all = [[0.0; 5]; 5];
    all[0][1] = 1.0;
    all[2][3] = 1.0;
    all[1] = [-k, -b, k, b, 1.0].map(|x| x / pad_mass_kg);
    all[3] = [k, b, -k - hand.stiffness_n_m, -b - hand.damping_n_s_m, 0.0].map(|x| x / finger_mass_kg);
    all
}

/// e^(A h) by scaling, twelve terms of the series, and squaring.
fn exponential(a: &[[f64; 5]; 5], h: f64) -> [[f64; 5]; 5] {
    let norm = a.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max) * h;
    let halvings = libm::ceil(libm::log2(norm.max(1e-3) * 4.0)).max(0.0) as i32;
    let scale = h / libm::exp2(f64::from(halvings));
    let identity: [[f64; 5]; 5] =
        core::array::from_fn(|row| core::array::from_fn(|column| f64::from(u8::from(row == column))));
    let mut sum = identity;
    for term in (1..=12).rev() {
        // Horner: 1 + A h/1 (1 + A h/2 (1 + …))
        let mut next = product(a, &sum);
        for (row, ones) in next.iter_mut().zip(&identity) {
            for (x, one) in row.iter_mut().zip(ones) {
                *x = one + *x * scale / f64::from(term);
            }
        }
        sum = next;
    }
    for _ in 0..halvings {
        sum = product(&sum, &sum);
    }
    sum
}

fn product(a: &[[f64; 5]; 5], b: &[[f64; 5]; 5]) -> [[f64; 5]; 5] {
    core::array::from_fn(|row| core::array::from_fn(|column| (0..5).map(|k| a[row][k] * b[k][column]).sum()))
}

fn multiply([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a * c - b * d, a * d + b * c]
}

fn subtract(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn divide(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let square = b[0] * b[0] + b[1] * b[1];
    multiply(a, [b[0], -b[1]]).map(|x| x / square)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 44_100.0;

    #[test]
    fn a_blow_gives_the_pad_its_impulse_and_the_hand_returns_it() {
        let design = Mobility::new(&Probe::default(), RATE_HZ).unwrap();
        let mut state = MobilityState::default();
        // 1e-6 N·s within one sample: v = J / m_s, less what spring and damper take in that time.
        let [_, speed_m_s] = state.tick(&design, 1e-6 * RATE_HZ);
        let probe = Probe::default();
        let free_m_s = 1e-6 / probe.pad_mass_kg;
        assert!(speed_m_s < free_m_s && speed_m_s > 0.8 * free_m_s, "{speed_m_s} of {free_m_s}");
        let mut samples = 0;
        while !state.is_still() {
            state.tick(&design, 0.0);
            samples += 1;
            assert!(samples < 2 * 44_100, "still moves after 2 s");
        }
    }

    #[test]
    fn a_sine_moves_the_pad_as_the_closed_form_says() {
        for probe in [Probe::default(), Probe { pad_mass_kg: 0.04, finger_mass_kg: 0.3, ..Probe::default() }]
        {
            let design = Mobility::new(&probe, RATE_HZ).unwrap();
            for frequency_hz in [20.0, 63.0, 250.0, 1000.0] {
                let mut state = MobilityState::default();
                let (mut re, mut im, mut count) = (0.0, 0.0, 0.0);
                // Whole periods after the transient; the force of a sample is held, so the middle
                // of the hold counts.
                for n in 0..(5.0 * RATE_HZ) as usize {
                    let angle = TAU * frequency_hz * (n as f64 + 0.5) / RATE_HZ;
                    let [pad_m, _] = state.tick(&design, libm::cos(angle));
                    if n as f64 >= 4.0 * RATE_HZ {
                        let end = TAU * frequency_hz * (n as f64 + 1.0) / RATE_HZ;
                        re += 2.0 * pad_m * libm::cos(end);
                        im -= 2.0 * pad_m * libm::sin(end);
                        count += 1.0;
                    }
                }
                let [exact_re, exact_im] = design.compliance_m_n(frequency_hz);
                let error = libm::hypot(re / count - exact_re, im / count - exact_im);
                let exact = libm::hypot(exact_re, exact_im);
                assert!(error < 0.002 * exact, "{frequency_hz} Hz: {} of {exact}", error / exact);
            }
        }
    }

    #[test]
    fn an_impossible_probe_is_refused_with_its_field() {
        let refused = Mobility::new(&Probe { pad_mass_kg: 0.0, ..Probe::default() }, RATE_HZ).unwrap_err();
        assert_eq!(refused.field, "pad_mass_kg");
        assert!(Mobility::new(&Probe::default(), 10.0).is_err());
    }
}
