//! Hertz impacts: how long two bodies touch, how hard, and the pulse they leave in the impulse
//! ring.
//!
//! ```text
//! m x'' = −k x^1.5      k = 4/3 E* √R      1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂
//! τ = 2.8683 (m² / (R E*² v))^(1/5)        J = m v (1 + e)        F_peak = 1.8395 J / τ
//! F(t) = J/τ · p(t/τ)
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | E, ν | [`Elastic`] |
//! | E*, R, m, e | [`HertzContact`] |
//! | v | closing speed, m/s |
//! | τ, J | [`HertzPulse`] |
//! | p(u) | [`pulse_shape`], area 1 |
//!
//! Source: Hasti §III-D ("We use Hertz contact theory to determine the impact force profile"); the
//! constants are our own integration of the equation.
//!
//! Changed: a pulse of 10–100 µs is shorter than a sample at 44.1 kHz, and sampling it at
//! points loses up to 560 % of its impulse. We deposit it under a cubic B-spline
//! ([`HertzPulse::deposit`]): its area and its onset within the sample are exact, and what folds
//! back below 10 kHz stays under 1 % of the impulse for any contact time. The kernel's own response
//! and its [`KERNEL_LATENCY`] are undone mode by mode when the bank is designed
//! ([`crate::modal_bank::GroupOptions::impulse_kernel_compensation`]), so that a mode sounds in the
//! very sample of the contact. A restitution e below 1 scales the impulse and makes the pulse
//! rise faster and fall slower (`restitution`).

mod merge;
mod restitution;
mod ring;
mod shape;

pub use merge::OnsetMerge;
pub use ring::{
    FORCE_HISTORY, FORCE_TAPS, KERNEL_SAMPLES, SHORTEST_SAMPLES, SMALLEST_IMPULSE_N_S, deposit_force,
    spread_force, spread_force_alone, take,
};
pub(crate) use shape::CENTRED as CENTRED_SHAPE;
pub use shape::pulse_shape;

use crate::DesignError;

/// Samples between a contact's begin and the centre of its kernel in the ring.
pub const KERNEL_LATENCY: usize = 2;

/// τ (R E*² v / m²)^(1/5).
const CONTACT_TIME: f64 = 2.868_265_70;

/// Slower contacts are treated as this fast when their duration is asked for, m/s.
const SLOWEST_M_S: f64 = 1e-9;

/// Elastic constants of a material.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Elastic {
    /// Young's modulus, Pa.
    pub young_pa: f64,
    /// Poisson ratio, −1 to 0.5.
    pub poisson: f64,
}

impl Elastic {
    /// E/(1 − ν²), Pa.
    #[must_use]
    pub fn modulus_pa(&self) -> f64 {
        self.young_pa / (1.0 - self.poisson * self.poisson)
    }

    /// (1 − ν²)/E, 1/Pa.
    fn compliance_per_pa(&self) -> Result<f64, DesignError> {
        let young = DesignError::check("young_pa", self.young_pa, "above 0 Pa", |e| e > 0.0)?;
        let poisson =
            DesignError::check("poisson", self.poisson, "above -1, 0.5 or less", |n| n > -1.0 && n <= 0.5)?;
        Ok((1.0 - poisson * poisson) / young)
    }
}

/// A sphere (or two) about to touch: everything of a Hertz contact but the speed.
///
/// ```
/// use asperity_dsp::hertz::{Elastic, HertzContact};
///
/// let steel = Elastic { young_pa: 200e9, poisson: 0.29 };
/// let ball = HertzContact::new(&steel, &steel, 0.005, 0.004)?;
/// // 30 µs at 1 m/s, and shorter the faster it strikes.
/// assert!((ball.contact_time_s(1.0) - 30e-6).abs() < 10e-6 && ball.contact_time_s(4.0) < ball.contact_time_s(1.0));
/// # Ok::<(), asperity_dsp::DesignError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HertzContact {
    effective_modulus_pa: f64,
    radius_m: f64,
    mass_kg: f64,
    /// τ at 1 m/s.
    time_at_1_m_s: f64,
}

impl HertzContact {
    /// A sphere of material `a`, `radius_m` and `mass_kg` against a flat, heavy body of material
    /// `b`. For two spheres 1/R and 1/m are the sums of theirs. The contact is elastic (e = 1).
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn new(a: &Elastic, b: &Elastic, radius_m: f64, mass_kg: f64) -> Result<Self, DesignError> {
        let effective_modulus_pa = 1.0 / (a.compliance_per_pa()? + b.compliance_per_pa()?);
        let radius_m = DesignError::check("radius_m", radius_m, "above 0 m", |r| r > 0.0)?;
        let mass_kg = DesignError::check("mass_kg", mass_kg, "above 0 kg", |m| m > 0.0)?;
        let ratio = mass_kg * mass_kg / (radius_m * effective_modulus_pa * effective_modulus_pa);
        let time = CONTACT_TIME * libm::pow(ratio, 0.2);
        DesignError::check("contact_time_s", time, "above 0 s and finite", |t| t > 0.0)?;
        Ok(Self { effective_modulus_pa, radius_m, mass_kg, time_at_1_m_s: time })
    }

    /// E*, Pa.
    #[must_use]
    pub const fn effective_modulus_pa(&self) -> f64 {
        self.effective_modulus_pa
    }

    /// Effective radius, m.
    #[must_use]
    pub const fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// Effective mass, kg.
    #[must_use]
    pub const fn mass_kg(&self) -> f64 {
        self.mass_kg
    }

    /// τ at a closing speed, s, of the elastic impact; it falls with the fifth root of the speed.
    #[inline]
    #[must_use]
    pub fn contact_time_s(&self, speed_m_s: f64) -> f64 {
        self.time_at_1_m_s * inverse_fifth_root(speed_m_s)
    }

    /// Impulse 2 m v, N·s.
    #[inline]
    #[must_use]
    pub fn impulse_n_s(&self, speed_m_s: f64) -> f64 {
        2.0 * self.mass_kg * speed_m_s
    }

    /// The pulse of an impact at `speed_m_s`; a speed that is not above 0 and finite gives no
    /// impulse.
    #[inline]
    #[must_use]
    pub fn pulse(&self, speed_m_s: f64) -> HertzPulse {
        let speed = if speed_m_s > 0.0 && speed_m_s.is_finite() { speed_m_s } else { 0.0 };
        HertzPulse::elastic(self.impulse_n_s(speed), self.contact_time_s(speed))
    }
}

/// The pulse of one impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HertzPulse {
    /// Area under the force, N·s.
    pub impulse_n_s: f64,
    /// Contact time of the bodies if they lost nothing, s.
    pub contact_time_s: f64,
    /// Rebound over approach speed, 0–1; shapes the pulse, whose area is the impulse.
    pub restitution: f64,
}

/// v^(−1/5) to 1e-8 for speeds from [`SLOWEST_M_S`] on, in a third of the time of `pow`: a first
/// guess from the exponent bits, then Newton's rule y ← y (6 − v y⁵)/5.
#[inline]
fn inverse_fifth_root(speed: f64) -> f64 {
    let v = if speed > SLOWEST_M_S { speed.min(1e9) } else { SLOWEST_M_S };
    // Bits of a float are about its logarithm: bits(v^(−1/5)) ≈ 6/5 bits(1) − bits(v)/5,
    // less a little that spreads the error evenly: 3 % before the first step.
    let mut y = f64::from_bits(0x4CB8_A999_9999_9999 - v.to_bits() / 5);
    for _ in 0..3 {
        let y2 = y * y;
        y *= 1.2 - 0.2 * v * (y2 * y2 * y);
    }
    y
}

/// Modulus and angle of the ring's kernel at the complex frequency −`decay` + i `theta` (per
/// sample): (sinh w / w)⁴ with w half of it. For an undamped mode this is sinc⁴(f/rate), a real
/// number.
pub(crate) fn kernel_at(decay: f64, theta: f64) -> (f64, f64) {
    let (x, y) = (-0.5 * decay, 0.5 * theta);
    let (re, im) = (libm::sinh(x) * libm::cos(y), libm::cosh(x) * libm::sin(y));
    let modulus = libm::sqrt((re * re + im * im) / (x * x + y * y));
    let angle = libm::atan2(im * x - re * y, re * x + im * y);
    let square = modulus * modulus;
    (square * square, 4.0 * angle)
}
