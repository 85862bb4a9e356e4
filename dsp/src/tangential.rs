//! Tangential channel: how a fingertip's skin is dragged sideways by friction.
//!
//! ```text
//! m u'' + b u' + k u = F_t        k = 1480 N^0.35 N/m        b = 1.78 N^0.35 N·s/m
//! F_t = N (μ + h') / (1 − μ h')
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | m | [`MASS_KG`], [`Tangential::new`] | skin that moves, 0.11–0.23 g |
//! | k, b, exponent | [`STIFFNESS_N_M`], [`DAMPING_N_S_M`], [`FORCE_EXPONENT`] | at 1 N, and how they grow |
//! | N | `normal_force_n` | presses the finger |
//! | μ, h' | arguments of [`friction_force_n`] | friction coefficient, slope of the relief along the motion |
//! | u | output of [`TangentialState::tick`] | m, along the motion |
//!
//! Source: Wiertlewski & Hayward 2012, who drove fingertips *tangentially* (k and b through a
//! secondary source, m through another): here their constants stand in the direction in which they
//! were measured. Seven people, 0.5 N: k 600–2000 N/m, b 0.75–2.38 N·s/m. The friction force is the
//! balance of a Coulomb contact on a slope.
//!
//! The step is exact for a force that runs on a parabola through its last three values, so nothing
//! waits for a later one: a force that is a polynomial of degree two is answered to rounding, a
//! sine of 500 Hz at 44.1 kHz within −80 dB. When N changes, position and velocity stay.

use crate::DesignError;

/// Skin that moves, kg: the middle of 0.11–0.23 g.
pub const MASS_KG: f64 = 1.7e-4;
/// Stiffness of a fingertip pressed with 1 N, N/m.
pub const STIFFNESS_N_M: f64 = 1480.0;
/// Damping of a fingertip pressed with 1 N, N·s/m.
pub const DAMPING_N_S_M: f64 = 1.78;
/// Stiffness and damping grow with this power of the normal force.
pub const FORCE_EXPONENT: f64 = 0.35;
/// Lighter touches are as soft as this one, N: below it nobody measured.
pub const LIGHTEST_N: f64 = 0.05;
/// Firmer touches are as stiff as this one, N.
pub const FIRMEST_N: f64 = 20.0;
/// Steepest 1 − μ h' that still counts: beyond, the contact would lock.
const LEAST_DENOMINATOR: f64 = 0.1;

/// Friction force of a finger pressed with `normal_force_n` on a slope dh/ds `slope` along its
/// motion, N.
///
/// Linear in the normal force; where 1 − μ h' falls below 0.1 the contact would lock, and the force
/// stays that of 0.1.
#[inline]
#[must_use]
pub fn friction_force_n(normal_force_n: f64, friction: f64, slope: f64) -> f64 {
    normal_force_n * (friction + slope) / (1.0 - friction * slope).max(LEAST_DENOMINATOR)
}

/// The skin of one finger at one rate and one normal force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tangential {
    mass_kg: f64,
    step_s: f64,
    stiffness_n_m: f64,
    damping_n_s_m: f64,
    /// (u, u') → (u, u') over a sample.
    step: [[f64; 2]; 2],
    /// Response to 1 N in this sample, the last and the one before.
    push: [[f64; 3]; 2],
}

/// Memory of one finger.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TangentialState {
    skin_m: f64,
    skin_m_s: f64,
    /// The last force and the one before.
    before_n: [f64; 2],
}

impl Tangential {
    /// A finger whose moving skin weighs `mass_kg`, pressed with `normal_force_n`.
    ///
    /// # Errors
    /// When the mass is outside 1e-6–0.1 kg, the rate outside 1 kHz–20 MHz, or the force is not
    /// finite or negative.
    pub fn new(mass_kg: f64, normal_force_n: f64, sample_rate_hz: f64) -> Result<Self, DesignError> {
        DesignError::check("mass_kg", mass_kg, "1e-6 to 0.1 kg", |m| (1e-6..=0.1).contains(&m))?;
        DesignError::check("sample_rate_hz", sample_rate_hz, "from 1 kHz to 20 MHz", |r| {
            (1e3..=2e7).contains(&r)
        })?;
        DesignError::check("normal_force_n", normal_force_n, "0 N or more", |n| n >= 0.0)?;
        let step_s = 1.0 / sample_rate_hz;
        let unpressed = Self {
            mass_kg,
            step_s,
            stiffness_n_m: 0.0,
            damping_n_s_m: 0.0,
            step: [[0.0; 2]; 2],
            push: [[0.0; 3]; 2],
        };
        Ok(unpressed.pressed_with(normal_force_n))
    }

    /// Finger pressed with another force; infallible, and a few dozen operations. What is no number
    /// counts as the lightest touch.
    #[must_use]
    #[expect(clippy::manual_clamp, reason = "what is no number becomes the lightest touch")]
    pub fn pressed_with(mut self, normal_force_n: f64) -> Self {
        let firmness = libm::pow(normal_force_n.max(LIGHTEST_N).min(FIRMEST_N), FORCE_EXPONENT);
        (self.stiffness_n_m, self.damping_n_s_m) = (STIFFNESS_N_M * firmness, DAMPING_N_S_M * firmness);
        self.step = free_step(self.mass_kg, self.stiffness_n_m, self.damping_n_s_m, self.step_s);
        let [constant, linear, square] = [0, 1, 2].map(|degree| self.forced(degree));
        // The parabola through f at −h, 0 and h of the step that begins at 0.
        for row in 0..2 {
            let (c, l, s) = (constant[row], 0.5 * linear[row], 0.5 * square[row]);
            self.push[row] = [l + s, c - 2.0 * s, s - l];
        }
        self
    }

    /// Stiffness as it is pressed, N/m.
    #[must_use]
    pub fn stiffness_n_m(&self) -> f64 {
        self.stiffness_n_m
    }

    /// Damping as it is pressed, N·s/m.
    #[must_use]
    pub fn damping_n_s_m(&self) -> f64 {
        self.damping_n_s_m
    }

    /// Position and velocity after one step from rest under the force (t / h)^degree: a particular
    /// polynomial and the free motion from what it lacks at the beginning.
    fn forced(&self, degree: usize) -> [f64; 2] {
        let (m, b, k, h) = (self.mass_kg, self.damping_n_s_m, self.stiffness_n_m, self.step_s);
        let mut force = [0.0; 3];
        force[degree] = libm::pow(h, -(degree as f64));
        let p2 = force[2] / k;
        let p1 = (force[1] - 2.0 * b * p2) / k;
        let p0 = (force[0] - b * p1 - 2.0 * m * p2) / k;
        let end = [p0 + h * (p1 + h * p2), p1 + 2.0 * h * p2];
        [0, 1].map(|row| end[row] - self.step[row][0] * p0 - self.step[row][1] * p1)
    }
}

impl TangentialState {
    /// At rest under a force that has been there for long, N.
    #[must_use]
    pub fn resting(design: &Tangential, force_n: f64) -> Self {
        Self { skin_m: force_n / design.stiffness_n_m, skin_m_s: 0.0, before_n: [force_n; 2] }
    }

    /// One sample of the friction force, N → where the skin is at that instant, m.
    #[inline]
    pub fn tick(&mut self, design: &Tangential, force_n: f64) -> f64 {
        let forces_n = [force_n, self.before_n[0], self.before_n[1]];
        let [u, v] = [self.skin_m, self.skin_m_s];
        let row = |row: usize| {
            let (step, push) = (&design.step[row], &design.push[row]);
            step[0] * u + step[1] * v + push[0] * forces_n[0] + push[1] * forces_n[1] + push[2] * forces_n[2]
        };
        (self.skin_m, self.skin_m_s) = (row(0), row(1));
        self.before_n = [force_n, self.before_n[0]];
        self.skin_m
    }

    /// Speed of the skin, m/s.
    #[must_use]
    pub fn velocity_m_s(&self) -> f64 {
        self.skin_m_s
    }
}

/// Free motion over h: e^(−σ h) times cosh and sinh, or cos and sin, of √|σ² − k/m| h.
fn free_step(mass_kg: f64, stiffness_n_m: f64, damping_n_s_m: f64, h: f64) -> [[f64; 2]; 2] {
    let (sigma, square) = (0.5 * damping_n_s_m / mass_kg, stiffness_n_m / mass_kg);
    let apart = sigma * sigma - square;
    let root = libm::sqrt(apart.abs());
    let angle = root * h;
    // Written with both exponents, so that neither overflows: a stiff finger at a low rate decays
    // within a sample.
    let (cosine, sine) = if angle < 1e-6 {
        let decay = libm::exp(-sigma * h);
        (decay, decay * h)
    } else if apart > 0.0 {
        let (slow, fast) = (libm::exp((root - sigma) * h), libm::exp(-(root + sigma) * h));
        (0.5 * (slow + fast), 0.5 * (slow - fast) / root)
    } else {
        let decay = libm::exp(-sigma * h);
        (decay * libm::cos(angle), decay * libm::sin(angle) / root)
    };
    [[cosine + sigma * sine, sine], [-square * sine, cosine - sigma * sine]]
}
