//! Stick–slip: a rubbing contact and the modes of the body it rubs, solved together in every
//! sample, without iteration.
//!
//! ```text
//! y_k ← the modes' displacement      v = Σ φ_k y_k'      F = the friction force on the body, along the motion
//! free step:  d*_k = R² d_k − m y_k      v* = Σ φ_k d*_k / h      g = Σ φ_k² β_k / h      β = h R sin θ / ω
//! F_st = (V − v*) / g
//! sticks if |F_st| ≤ μ_s N (it stuck) or the slip branch has no root (it slipped):   F = F_st
//! slips otherwise:   F = μ(u) N sgn F_st      μ(u) = μ_k + (μ_s − μ_k) / (1 + |u| / u_s)      u = V − v* − g F
//!     u² + (u_s − w + g N μ_k) u + (g N μ_s − w) u_s = 0      w = |V − v*|      the larger root
//! then  d_k = d*_k + φ_k β_k F      y_k ← y_k + d_k
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | R, θ, ω, m = 1 − 2R cos θ + R² | [`RubbedModes`] at one rate | as in the [modal bank](crate::modal_bank) |
//! | φ_k | [`RubbedBody::touch_at`] | motion of the rubbed place along the motion, kg^−½ |
//! | V | `sweep_m_s` | speed of what rubs |
//! | N | `normal_force_n` | |
//! | μ_s, μ_k, u_s | [`Friction`] | friction at rest and while sliding, and the speed that halves the difference |
//! | v | [`Rub::body_m_s`] | speed of the rubbed place |
//!
//! Source: the free step, its velocity and the closed form of the coupled step as in physical
//! models of bowed strings; the hyperbolic friction curve makes the slipping branch a quadratic.
//! The speed of the place is that over the *coming* sample, (y⁺ − y) / h: with the textbook's
//! central difference a contact that sticks would slip and stick in turn, and rub at the pitch of
//! the free mode.
//!
//! The sample in which it lets go is shared between both forces by where in it that was: without
//! that the period of a squeal of 132 samples is 0.22 % off, with it 0.004 %. Where the friction
//! falls smoothly from a standstill the period is right to the first order of the step: 0.3 % at
//! 192 kHz where it falls within a few millimetres a second.
//!
//! F (V − v) is never below 0, whatever is changed between two samples: friction takes energy and
//! gives none. [`RubbedBody`] is the equations as they stand, [`Coupled`] the same for a whole
//! [modal bank](crate::modal_bank).
//!
//! With a single mode and u_s → 0 the period is T = 2A/V + (2/ω)(π − atan(Aω/V)), A = N (μ_s −
//! μ_k)/k (`dsp/tests/stick_slip.rs`).

mod coupled;
mod plain;

pub use coupled::{Answer, CELL, Coupled, place_speed};
pub use plain::{RubbedBody, RubbedModes};

use crate::DesignError;
use crate::limits::{self, Range};
use crate::simd::Set;
use fearless_simd::f64x2;
use fearless_simd::prelude::*;

/// Properties of a rubbing pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Friction coefficient of a contact that sticks, at least `mu_kinetic`.
    pub mu_static: f64,
    /// Friction coefficient of one that slides fast.
    pub mu_kinetic: f64,
    /// Speed at which the difference of both has fallen to half, m/s.
    pub slip_speed_m_s: f64,
}

impl Friction {
    /// # Errors
    /// When a coefficient is outside [`limits::FRICTION`], the kinetic one is above the static one,
    /// or the speed is outside [`limits::SLIP_SPEED_M_S`].
    pub fn checked(self) -> Result<Self, DesignError> {
        limits::FRICTION.check("mu_static", self.mu_static)?;
        Range::new(0.0, self.mu_static, "0 to 10 and at most mu_static")
            .check("mu_kinetic", self.mu_kinetic)?;
        limits::SLIP_SPEED_M_S.check("slip_speed_m_s", self.slip_speed_m_s)?;
        Ok(self)
    }
}

/// State of what rubs: whether it sticks at present, and how far the rubbed place yields.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RubState {
    sticks: bool,
    /// The force of the last sample, N.
    last_n: f64,
    /// g, m/s a newton; 0 of a place that does not yield.
    mobility_m_s_n: f64,
}

/// One sample of a rubbing contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rub {
    /// Friction force on the body along the motion, N.
    pub force_n: f64,
    /// Speed of the rubbed place, m/s.
    pub body_m_s: f64,
    /// True where it sticks.
    pub sticks: bool,
}

/// Constants of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sweep {
    /// Speed of what rubs, m/s.
    pub sweep_m_s: f64,
    /// Force that presses it on, N; below 0 counts as 0.
    pub normal_force_n: f64,
    /// Impulse along the motion that reaches the place from elsewhere, N·s.
    pub other_n_s: f64,
}

/// A rubbing pair at a place that yields: what holds for many samples.
#[derive(Debug, Clone, Copy)]
struct Law {
    /// μ_s, μ_k, u_s and 2 u_s.
    mu_static: f64,
    mu_kinetic: f64,
    slow_m_s: f64,
    twice_slow_m_s: f64,
    /// 1/g; 0 of a place that does not yield.
    stiffness_n_s_m: f64,
    /// Effect of a pressing newton on [`Pressed`].
    held_m_s_n: f64,
    kinetic_m_s_n: f64,
    weaker_m_s: f64,
    dip_m2_s2_n: f64,
}

impl Law {
    /// The place yields so far to a newton, m/s.
    #[inline(always)]
    fn new(friction: &Friction, mobility_m_s_n: f64) -> Self {
        let Friction { mu_static, mu_kinetic, slip_speed_m_s } = *friction;
        let weaker_m_s = 2.0 * slip_speed_m_s * (mu_static - mu_kinetic);
        Self {
            mu_static,
            mu_kinetic,
            slow_m_s: slip_speed_m_s,
            twice_slow_m_s: 2.0 * slip_speed_m_s,
            stiffness_n_s_m: if mobility_m_s_n > 0.0 { 1.0 / mobility_m_s_n } else { 0.0 },
            held_m_s_n: mobility_m_s_n * mu_static,
            kinetic_m_s_n: mobility_m_s_n * mu_kinetic,
            weaker_m_s,
            dip_m2_s2_n: 2.0 * mobility_m_s_n * weaker_m_s,
        }
    }

    #[inline(always)]
    fn pressed(&self, normal_force_n: f64) -> Pressed {
        let pressed_n = normal_force_n.max(0.0);
        Pressed {
            pressed_n,
            kinetic_n: pressed_n * self.mu_kinetic,
            weaker_n_m_s: pressed_n * self.weaker_m_s,
            lean_m_s: self.slow_m_s - pressed_n * self.kinetic_m_s_n,
            dip_m2_s2: pressed_n * self.dip_m2_s2_n,
        }
    }

    /// The slipping branch, from t = w + u_s − g N μ_k: its root and twice u + u_s, if it has one.
    #[inline(always)]
    fn slips<T: Set>(&self, token: T, pressed: &Pressed, t: f64) -> Option<[f64; 2]> {
        // No number where there is none.
        let root = root(token, fused(token, t, t, -pressed.dip_m2_s2));
        (t + root > self.twice_slow_m_s).then_some([root, t + root])
    }
}

/// The law under a force: N μ_k, 2 u_s N (μ_s − μ_k), u_s − g N μ_k, and 4 u_s g N (μ_s − μ_k).
#[derive(Debug, Clone, Copy)]
struct Pressed {
    pressed_n: f64,
    kinetic_n: f64,
    weaker_n_m_s: f64,
    lean_m_s: f64,
    dip_m2_s2: f64,
}

impl Pressed {
    /// The force at a speed, of which it takes u + u_s twice.
    #[inline(always)]
    fn slides_n(&self, twice_m_s: f64) -> f64 {
        self.kinetic_n + self.weaker_n_m_s / twice_m_s
    }
}

/// The force of a sample.
#[derive(Debug, Clone, Copy)]
struct Solved {
    force_n: f64,
    /// Force of a contact that slipped before as well.
    slips: Option<Slips>,
}

/// A contact that slips: 1 or −1, t, and the root.
#[derive(Debug, Clone, Copy)]
struct Slips {
    way: f64,
    t: f64,
    root: f64,
}

impl RubState {
    /// Tests whether it sticks at present.
    #[must_use]
    pub fn sticks(&self) -> bool {
        self.sticks
    }

    /// The friction force of a sample in which the place would lag `behind_m_s` behind what rubs if
    /// nothing rubbed it.
    #[inline(always)]
    fn solve<T: Set>(&mut self, token: T, law: &Law, pressed: &Pressed, behind_m_s: f64) -> Solved {
        let w = behind_m_s.abs();
        let slips = if self.sticks && w <= pressed.pressed_n * law.held_m_s_n {
            None
        } else {
            law.slips(token, pressed, w + pressed.lean_m_s)
        };
        let Some([root, twice_m_s]) = slips else {
            self.sticks = true;
            self.last_n = behind_m_s * law.stiffness_n_s_m;
            return Solved { force_n: self.last_n, slips: None };
        };
        let (way, slides_n) = (1.0_f64.copysign(behind_m_s), pressed.slides_n(twice_m_s));
        if core::mem::take(&mut self.sticks) {
            let most_n = pressed.pressed_n * law.mu_static;
            let held = self.held_share(law, most_n, behind_m_s);
            self.last_n = way * (slides_n + held * (most_n - slides_n)).max(0.0);
            return Solved { force_n: self.last_n, slips: None };
        }
        self.last_n = way * slides_n;
        Solved { force_n: self.last_n, slips: Some(Slips { way, t: w + pressed.lean_m_s, root }) }
    }

    /// Share of a sample during which it still stuck, −½ to ½: while it sticks the force of sample
    /// n is the one needed at that instant and acts for half a sample before and after it. It grew
    /// along a straight line and let go at `most_n`; if that was before this sample's share began,
    /// the last force acted too long by so much.
    fn held_share(&self, law: &Law, most_n: f64, behind_m_s: f64) -> f64 {
        let needed_n = behind_m_s.abs() * law.stiffness_n_s_m;
        let last_n = 1.0_f64.copysign(behind_m_s) * self.last_n;
        let share = (most_n - last_n) / (needed_n - last_n);
        if (0.0..=1.0).contains(&share) && last_n >= 0.0 { share - 0.5 } else { 0.0 }
    }
}

/// The square root in the token's own instructions. `libm`'s is SSE's, which among those of AVX
/// costs a processor a hundred cycles and more wherever it minds the mixture.
#[inline(always)]
fn root<T: Set>(token: T, x: f64) -> f64 {
    f64x2::splat(token, x).sqrt()[0]
}

/// a · b + c; one rounding where the processor has it.
#[inline(always)]
fn fused<T: Set>(token: T, a: f64, b: f64, c: f64) -> f64 {
    if !T::FUSED {
        return a * b + c;
    }
    let [a, b, c] = [a, b, c].map(|x| f64x2::splat(token, x));
    a.mul_add(b, c)[0]
}
