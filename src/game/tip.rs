//! Tracked tip: a pose becomes a contact with a force.
//!
//! A hand that is tracked goes through what it touches. A *proxy* stays on the surface in its place
//! (Hasti §III-B; the god-object of Zilles & Salisbury 1995), coupled to the tracked tip p by a
//! spring k and a damper:
//!
//! ```text
//! along the surface   m s″ = k (p − s) − 2 √(k m) s′    critically damped: s never swings past p
//! into the surface    F = min(k · depth of p, max_force_n)    the proxy stays on it
//! ```
//!
//! s follows p in closed form, p running along a straight line within a step: a step of 0.3 s is as
//! exact as thirty of 10 ms. Place and velocity of the contact are those of s; s lags a steady
//! motion by 2 √(m/k), 45 ms by default. The force has no lag: a spring that lags does work on a
//! hand that is tracked with noise, this one does none. A contact begins where p comes through a
//! surface from outside, and goes on, however deep p is, until p comes out again or leaves the
//! surface at its edge.
//!
//! | seen | done |
//! |---|---|
//! | p jumps: faster than [`JUMP_M_S`]; in a step beyond [`HITCH_S`], than 1 m/s | s jumps with it and keeps its velocity; what lies between is met |
//! | p comes out by less than [`CLEAR_M`] | the contact goes on without a force |
//! | a surface is left beside another that faces alike | an end, and a begin there in the next step |
//! | a step of 0 s, or a position that is no number | refused |

use crate::model::bad_value::{BadValue, within};
use crate::model::event::{ChannelId, ContactEvent, ContactId, ContactSample};
use crate::model::frame::SurfaceFrame;
use crate::model::id::SurfaceId;
use asperity_dsp::limits::{self, Range};
use glam::DVec3;

/// Speed above which a tracked tip has jumped, m/s: a hand that strokes moves at 2 m/s at most.
pub const JUMP_M_S: f64 = 2.5;
/// Step beyond which the game has stood still, s.
pub const HITCH_S: f64 = 0.04;
/// Speed above which a tip has jumped in such a step, m/s.
const JUMP_IN_HITCH_M_S: f64 = 1.0;
/// Height above a surface from which a contact ends, m: more than a tracker's noise.
pub const CLEAR_M: f64 = 0.5e-3;
/// Least cosine between two surfaces over whose common edge a contact goes on.
const ALIKE: f64 = 0.5;

const STIFFNESS_N_M: Range = Range::new(1.0, 1e5, "1 to 1e5 N/m");
const MASS_KG: Range = Range::new(1e-3, 10.0, "1e-3 to 10 kg");
const MAX_FORCE_N: Range = Range::new(1e-3, 1e3, "1e-3 to 1000 N");
const STEP_S: Range = Range::new(1e-5, 10.0, "1e-5 to 10 s");

/// Coupling between a tracked tip and its proxy.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TipCoupling {
    /// k, N/m; 1 to 1e5. 200 by default: 1 cm of depth presses with 2 N (**assumed**).
    pub stiffness_n_m: f64,
    /// m, kg; 1e-3 to 10. With 200 N/m the default of 0.1 kg lets a hand that is tracked with
    /// 0.2 mm of noise at 60 Hz report less than 6 mm/s while it is still.
    pub mass_kg: f64,
    /// Most force, N; 1e-3 to 1000. 5 by default (**assumed**: what a fingertip bears for long).
    pub max_force_n: f64,
}

impl Default for TipCoupling {
    fn default() -> Self {
        Self { stiffness_n_m: 200.0, mass_kg: 0.1, max_force_n: 5.0 }
    }
}

/// A rectangle that a tip may touch, in the axes of the tracked positions: u and v from 0 to 1, out
/// of the body along u × v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipSurface {
    /// Its plane.
    pub frame: SurfaceFrame,
    /// Width and height, m.
    pub size_m: [f64; 2],
}

/// Result of a step of a tracked tip.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TipStep {
    /// The tip touches nothing.
    #[default]
    Free,
    /// A contact begins on the surface of that index.
    Begin(usize, ContactSample),
    /// It goes on.
    Move(usize, ContactSample),
    /// It has ended on the surface of that index.
    End(usize),
}

impl TipStep {
    /// Event for [`Scene::report`](crate::Scene::report), felt by an actuator; none where nothing
    /// is touched. `ids` are the surfaces in the order in which the tip was given them.
    #[must_use]
    pub fn event(self, ids: &[SurfaceId], contact: ContactId, actuator: ChannelId) -> Option<ContactEvent> {
        match self {
            Self::Free => None,
            Self::Begin(index, sample) => {
                Some(ContactEvent::begin(contact, *ids.get(index)?, actuator, sample))
            }
            Self::Move(_, sample) => Some(ContactEvent::moved(contact, sample)),
            Self::End(_) => Some(ContactEvent::end(contact)),
        }
    }
}

/// One tracked tip over some surfaces; a hand has one for each finger.
///
/// ```
/// use asperity::{Config, Engine, Surface, SurfaceFrame, Tip, TipCoupling, TipStep};
///
/// let Engine { mut scene, .. } = Config::default().build()?;
/// let frame = SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])?;
/// let table = scene.add_surface(Surface::flat(0.4, 0.3)?.frame(frame))?;
/// let mut tip = Tip::new(scene.tip_surfaces(&[table])?, TipCoupling::default())?;
/// let mut force_n = 0.0;
/// for step in 0..180 {
///     // Tracked at 90 Hz: down from 2 cm above the table to 5 mm below its top.
///     let height_m = (0.02 - 0.0005 * f64::from(step)).max(-0.005);
///     if let TipStep::Move(_, sample) = tip.step(1.0 / 90.0, [0.2, 0.15, height_m])? {
///         force_n = sample.normal_force_n;
///     }
/// }
/// assert!((force_n - 1.0).abs() < 0.01, "200 N/m × 5 mm: {force_n} N");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Tip {
    surfaces: Vec<TipSurface>,
    coupling: TipCoupling,
    /// √(k/m), 1/s.
    rate_per_s: f64,
    /// p of the last step, and its speed on the way there; 0 in a jump.
    tracked_m: Option<DVec3>,
    tracked_m_s: DVec3,
    /// s and s′.
    proxy_m: DVec3,
    velocity_m_s: DVec3,
    /// Index of the surface that is touched.
    touched: Option<usize>,
    /// Surface on which the contact goes on after an end.
    next: Option<usize>,
}

impl Tip {
    /// A tip over these surfaces.
    ///
    /// # Errors
    /// When a number of the coupling is out of its range.
    pub fn new(surfaces: Vec<TipSurface>, coupling: TipCoupling) -> Result<Self, BadValue> {
        within("stiffness_n_m", coupling.stiffness_n_m, STIFFNESS_N_M)?;
        within("mass_kg", coupling.mass_kg, MASS_KG)?;
        within("max_force_n", coupling.max_force_n, MAX_FORCE_N)?;
        Ok(Self {
            surfaces,
            coupling,
            rate_per_s: (coupling.stiffness_n_m / coupling.mass_kg).sqrt(),
            tracked_m: None,
            tracked_m_s: DVec3::ZERO,
            proxy_m: DVec3::ZERO,
            velocity_m_s: DVec3::ZERO,
            touched: None,
            next: None,
        })
    }

    /// Surfaces it was made with; [`TipStep`] names them by index.
    #[must_use]
    pub fn surfaces(&self) -> &[TipSurface] {
        &self.surfaces
    }

    /// The tip is at `position_m`, `dt_s` (1e-5 to 10 s) after the last step.
    ///
    /// # Errors
    /// When the step or the position is no number or out of range; nothing changes then.
    pub fn step(&mut self, dt_s: f64, position_m: [f64; 3]) -> Result<TipStep, BadValue> {
        within("dt", dt_s, STEP_S)?;
        for x in position_m {
            within("position_m", x, limits::PLACE_M)?;
        }
        let [before_m, now_m] = self.follow(dt_s, DVec3::from(position_m));
        Ok(match (self.touched, self.next.take()) {
            (Some(index), _) if self.holds(index, now_m) => {
                TipStep::Move(index, self.sample(index, now_m, 0.0))
            }
            (Some(index), _) => {
                self.touched = None;
                self.next = self.beside(index, now_m).or_else(|| self.landed_on(before_m, now_m));
                TipStep::End(index)
            }
            (None, Some(index)) if self.holds(index, now_m) => self.begin(index, now_m),
            (None, _) => {
                self.landed_on(before_m, now_m).map_or(TipStep::Free, |index| self.begin(index, now_m))
            }
        })
    }

    /// The hand is elsewhere, because the game has moved it: ends what it touches. The next step
    /// starts anew.
    pub fn lift(&mut self) -> TipStep {
        (self.tracked_m, self.next) = (None, None);
        self.touched.take().map_or(TipStep::Free, TipStep::End)
    }

    /// s after a step in which p runs straight to `tracked_m`; where p was, and is.
    ///
    /// With e = s − p + 2v/ω, v the speed of p: e″ + 2ω e′ + ω² e = 0, so e = (a + b t) e^(−ωt).
    fn follow(&mut self, dt_s: f64, tracked_m: DVec3) -> [DVec3; 2] {
        let Some(last_m) = self.tracked_m.replace(tracked_m) else {
            (self.proxy_m, self.velocity_m_s) = (tracked_m, DVec3::ZERO);
            return [tracked_m; 2];
        };
        let (moved_m, rate) = (tracked_m - last_m, self.rate_per_s);
        let jump_m_s = if dt_s > HITCH_S { JUMP_IN_HITCH_M_S } else { JUMP_M_S };
        let (speed, from_m) = if moved_m.length() > jump_m_s * dt_s {
            self.proxy_m += moved_m;
            (DVec3::ZERO, tracked_m)
        } else {
            (moved_m / dt_s, last_m)
        };
        let lag_m = 2.0 / rate * speed;
        self.tracked_m_s = speed;
        let a = self.proxy_m - from_m + lag_m;
        let b = self.velocity_m_s - speed + rate * a;
        let decayed = libm::exp(-rate * dt_s);
        let rest = (a + b * dt_s) * decayed;
        self.proxy_m = tracked_m - lag_m + rest;
        self.velocity_m_s = speed + b * decayed - rate * rest;
        [last_m, tracked_m]
    }

    /// The surface on which a contact goes on that has left another at its edge.
    fn beside(&self, left: usize, at_m: DVec3) -> Option<usize> {
        let depth_m = self.depth_m(left, at_m);
        let inward = |index: usize| DVec3::from(self.surfaces[index].frame.inward());
        let goes_on = |&index: &usize| {
            let faces_alike = inward(index).dot(inward(left)) >= ALIKE;
            let beside_m = self.depth_m(index, at_m);
            index != left
                && faces_alike
                && beside_m <= 2.0 * depth_m
                && beside_m > 0.0
                && self.holds(index, at_m)
        };
        (0..self.surfaces.len()).find(goes_on)
    }

    fn begin(&mut self, index: usize, at_m: DVec3) -> TipStep {
        self.touched = Some(index);
        let closing_m_s = self.tracked_m_s.dot(DVec3::from(self.surfaces[index].frame.inward()));
        TipStep::Begin(index, self.sample(index, at_m, closing_m_s.max(0.0)))
    }

    /// The surface through which p has come from outside, the first on its way.
    fn landed_on(&self, before_m: DVec3, now_m: DVec3) -> Option<usize> {
        let crossed = |index: usize| {
            let (above_m, below_m) = (-self.depth_m(index, before_m), self.depth_m(index, now_m));
            if above_m < 0.0 || below_m <= 0.0 {
                return None;
            }
            let share = above_m / (above_m + below_m);
            let inside = self.is_inside(index, before_m.lerp(now_m, share)) && self.is_inside(index, now_m);
            inside.then_some((share, index))
        };
        let nearest = (0..self.surfaces.len()).filter_map(crossed).min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, index)| index)
    }

    fn depth_m(&self, index: usize, at_m: DVec3) -> f64 {
        self.surfaces[index].frame.depth_m(at_m.to_array())
    }

    /// Tests whether a place lies over or under the rectangle.
    fn is_inside(&self, index: usize, at_m: DVec3) -> bool {
        let TipSurface { frame, size_m, .. } = &self.surfaces[index];
        frame.uv(at_m.to_array(), *size_m).iter().all(|x| (0.0..=1.0).contains(x))
    }

    /// Tests whether a contact goes on where p is.
    fn holds(&self, index: usize, at_m: DVec3) -> bool {
        self.depth_m(index, at_m) > -CLEAR_M && self.is_inside(index, at_m)
    }

    fn sample(&self, index: usize, at_m: DVec3, closing_m_s: f64) -> ContactSample {
        let TipSurface { frame, size_m, .. } = &self.surfaces[index];
        let force_n = self.coupling.stiffness_n_m * self.depth_m(index, at_m);
        let uv = frame.uv(self.proxy_m.to_array(), *size_m);
        let sample = ContactSample::new(uv, force_n.clamp(0.0, self.coupling.max_force_n));
        let sample = sample.sliding(frame.along(self.velocity_m_s.to_array()));
        ContactSample { closing_m_s, ..sample }
    }
}

#[cfg(test)]
mod tests;
