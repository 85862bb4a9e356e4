//! Held bodies: what presses on a body lowers or raises its pitches and lets it ring shorter.
//!
//! ```text
//! s² + 2 d_m s + ω_m² + s ζ(s) = 0        Newton's steps from s = −d_m + iω        ζ = Σ_c φ_cm² Z_c / (1 + s Z_c B_c)
//! B_c = Σ_k≠m φ_ck² / (s² + 2 d_k s + ω_k²)
//! 1/Z = s/k_m + 1/(m_s s + 1/(1/T + 1/Z_f))        T = k_s/s + b_s        Z_f = m_f s + k_h/s + b_h
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | s | [`Pole`] | complex frequency of mode m, 1/s; its imaginary part is that of the damped oscillation |
//! | φ_cm | [`Hold::phi_per_sqrt_kg`] | motion of the place that contact c presses, along the press, kg^−½ |
//! | B | | how the other modes yield at that place: near ones pull at each other through the finger |
//! | k_m, m_s, k_s, b_s, m_f | [`Probe`] | as in the contact model; k_m as stiff as it is pressed |
//! | k_h, b_h | [`crate::mobility`] | the hand that holds the finger |
//!
//! To the first order Δs = −½ φ² Z(s): the real part damps, the imaginary part detunes. With one
//! contact the equation is that of the whole coupled system; several contacts add up as if they did
//! not feel each other. Against exact eigenvalues of 28 random bodies under a fingertip
//! (`dsp/tests/held.rs`, p90 of the decays): first order 15 % at 0.1 kg and 3 % at 0.3 kg, with B
//! 0.02 % at 0.1 kg and less above.
//!
//! Passive always: a decay never falls, and a body that nobody touches has the poles it had, to the
//! bit.

use crate::micro_contact::Probe;
use crate::mobility::HAND_HZ;
use core::f64::consts::TAU;

/// Newton's steps: where the first is good at all the third changes nothing that could be heard.
const STEPS: usize = 3;
/// A step of Newton's goes no further than this share of the frequency: beyond, the mode is the
/// finger's rather than the body's.
const LONGEST_STEP: f64 = 0.25;

/// A complex number.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

/// Complex frequency of a mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pole {
    /// Decay rate of the amplitude, 1/s.
    pub decay_per_s: f64,
    /// Frequency of the damped oscillation, Hz.
    pub frequency_hz: f64,
}

/// One contact that presses on a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold<'a> {
    /// Pressing contact, as stiff as it is pressed.
    pub probe: &'a Probe,
    /// Every mode's motion at its place, along the press, kg^−½; modes beyond the list do not move
    /// there.
    pub phi_per_sqrt_kg: &'a [f64],
}

/// Frequency and decay of mode `mode` of a body while the contacts of `holds` press. The time is
/// proportional to modes times contacts.
///
/// A mode that there is not is nowhere: `None`. Where a number is not finite the mode stays as it
/// is.
#[must_use]
pub fn held(free: &[Pole], mode: usize, holds: &[Hold<'_>]) -> Option<Pole> {
    let own = *free.get(mode)?;
    let phi = |hold: &Hold<'_>| hold.phi_per_sqrt_kg.get(mode).copied().unwrap_or(0.0);
    if holds.iter().all(|hold| phi(hold) == 0.0) {
        return Some(own);
    }
    let start = own.start();
    let mut s = start;
    for _ in 0..STEPS {
        // The pull and its slope in s, the latter by a difference over a millionth.
        let near = s.times(Complex { re: 1.0 + 1e-6, im: 0.0 });
        let (mut zeta, mut there) = (Complex::default(), Complex::default());
        for hold in holds.iter().filter(|hold| phi(hold) != 0.0) {
            let others = yielding(free, mode, hold, s);
            zeta = zeta.plus(pull(hold.probe, phi(hold), others, s));
            there = there.plus(pull(hold.probe, phi(hold), others, near));
        }
        let slope = there.minus(zeta).over(near.minus(s));
        let value = own.equation(s).plus(s.times(zeta));
        let gradient = s.scaled(2.0).plus(Complex { re: 2.0 * own.decay_per_s, im: 0.0 });
        let gradient = gradient.plus(zeta).plus(s.times(slope));
        let step = value.over(gradient);
        let (size, most) = (libm::sqrt(step.norm_squared()), LONGEST_STEP * start.im);
        s = s.minus(if size > most { step.scaled(most / size) } else { step });
    }
    if !(s.re.is_finite() && s.im.is_finite()) {
        return Some(own);
    }
    let decay_per_s = (-s.re).max(own.decay_per_s);
    Some(Pole { decay_per_s, frequency_hz: (s.im / TAU).max(0.25 * own.frequency_hz) })
}

impl Pole {
    fn start(self) -> Complex {
        Complex { re: -self.decay_per_s, im: TAU * self.frequency_hz }
    }

    /// s² + 2 d s + ω², zero at the pole.
    fn equation(self, s: Complex) -> Complex {
        let square = Complex { re: self.start().norm_squared(), im: 0.0 };
        s.times(s).plus(s.scaled(2.0 * self.decay_per_s)).plus(square)
    }
}

/// B: how all other modes yield where the contact presses.
fn yielding(free: &[Pole], mode: usize, hold: &Hold<'_>, s: Complex) -> Complex {
    let others = free.iter().zip(hold.phi_per_sqrt_kg).enumerate().filter(|(k, _)| *k != mode);
    others.fold(Complex::default(), |sum, (_, (pole, phi))| {
        sum.plus(Complex { re: phi * phi, im: 0.0 }.over(pole.equation(s)))
    })
}

/// ζ of one contact.
fn pull(probe: &Probe, phi: f64, others: Complex, s: Complex) -> Complex {
    let z = driving_point_n_s_m(probe, s);
    let shared = Complex { re: 1.0, im: 0.0 }.plus(s.times(z).times(others));
    z.scaled(phi * phi).over(shared)
}

/// Driving-point impedance of a probe at its contact, N·s/m, at the complex frequency s, 1/s.
#[must_use]
pub fn driving_point_n_s_m(probe: &Probe, s: Complex) -> Complex {
    let Probe {
        pad_mass_kg,
        pad_stiffness_n_m,
        pad_damping_n_s_m,
        finger_mass_kg,
        contact_stiffness_n_m,
        ..
    } = *probe;
    let hand = TAU * HAND_HZ;
    let mass_kg = pad_mass_kg + finger_mass_kg;
    let spring = |stiffness: f64, damping: f64| {
        Complex { re: stiffness, im: 0.0 }.over(s).plus(Complex { re: damping, im: 0.0 })
    };
    let finger = s.scaled(finger_mass_kg).plus(spring(mass_kg * hand * hand, 2.0 * mass_kg * hand));
    let tie = spring(pad_stiffness_n_m, pad_damping_n_s_m);
    let skin = s.scaled(pad_mass_kg).plus(tie.times(finger).over(tie.plus(finger)));
    let contact = spring(contact_stiffness_n_m, 0.0);
    contact.times(skin).over(contact.plus(skin))
}

impl Complex {
    fn plus(self, b: Self) -> Self {
        Self { re: self.re + b.re, im: self.im + b.im }
    }

    fn minus(self, b: Self) -> Self {
        Self { re: self.re - b.re, im: self.im - b.im }
    }

    fn times(self, b: Self) -> Self {
        Self { re: self.re * b.re - self.im * b.im, im: self.re * b.im + self.im * b.re }
    }

    fn scaled(self, by: f64) -> Self {
        Self { re: self.re * by, im: self.im * by }
    }

    fn over(self, b: Self) -> Self {
        self.times(Self { re: b.re, im: -b.im }).scaled(1.0 / b.norm_squared())
    }

    fn norm_squared(self) -> f64 {
        self.re * self.re + self.im * self.im
    }
}
