//! Contact sample: where and how a contact touches at one instant.
//!
//! ```text
//! place   uv, or at_m: a place in the body, whose surface's frame gives uv; without a frame it is where a block of stuff is cut
//! press   normal_force_n, or depth_m: how deep the tip stands below the untouched surface; at_m gives it where neither is written
//! ```
//!
//! A device's loop has the place of its tip and wants the force: it reports a depth. Only
//! what gives way can answer; on a hard surface a depth says nothing about the force, and is
//! refused.

use crate::model::bad_value::{BadValue, held, within};
use crate::model::error::Refusal;
use crate::model::frame::SurfaceFrame;
use asperity_dsp::limits;

/// Place and manner of a contact at one instant.
///
/// ```
/// use asperity::ContactSample;
///
/// let sample = ContactSample::new([0.3, 0.5], 0.6).sliding([0.1, 0.0]);
/// assert_eq!(sample.closing_m_s, 0.0);
/// // A tip that stands 3 mm deep in sand.
/// let tip = ContactSample::at_depth([0.3, 0.5], 0.003).sliding([0.1, 0.0]);
/// assert_eq!(tip.depth_m, Some(0.003));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub struct ContactSample {
    /// Texture coordinates of the contact point; 1 spans the surface's width and height. They may
    /// wrap or run on beyond 0–1. [`at_m`](Self::at_m) counts instead on a surface with a frame;
    /// NaN if only that was reported.
    pub uv: [f64; 2],
    /// Tangential velocity along the surface's u and v axes, m/s; estimated from `uv` when missing.
    pub velocity_m_s: Option<[f64; 2]>,
    /// Force pressing the finger onto the surface, N. Physics engines report small negative values
    /// around lift-off; they count as 0. [`depth_m`](Self::depth_m) counts instead; NaN if the
    /// place gives the depth.
    pub normal_force_n: f64,
    /// Approach speed at landing, m/s; used by [`ContactEvent::begin`](crate::ContactEvent::begin)
    /// only.
    pub closing_m_s: f64,
    /// Place in the frame of the body that the surface belongs to, m.
    pub at_m: Option<[f64; 3]>,
    /// Depth of the tip below the untouched surface, m; below 0 it is above it. For surfaces that
    /// give way.
    pub depth_m: Option<f64>,
    /// Speed at which what touches slides on the ground where they touch, m/s: missing = as fast as
    /// it moves, a stroke; 0 = it rolls. Between them it does a bit of both
    /// ([`asperity_dsp::rolling`]).
    pub slip_m_s: Option<f64>,
    /// Radius of what rolls, m; missing = its probe's tip, and at least that of a fingertip, 8 mm.
    /// Without a slip it says nothing.
    pub roll_radius_m: Option<f64>,
}

/// Sample as it is written.
#[derive(serde::Serialize, serde::Deserialize)]
struct Written {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    uv: Option<[f64; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    velocity_m_s: Option<[f64; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    normal_force_n: Option<f64>,
    #[serde(default, skip_serializing_if = "is_zero")]
    closing_m_s: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    at_m: Option<[f64; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    depth_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    slip_m_s: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    roll_radius_m: Option<f64>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands out references")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl TryFrom<Written> for ContactSample {
    type Error = &'static str;

    fn try_from(written: Written) -> Result<Self, &'static str> {
        let Written { uv, velocity_m_s, normal_force_n, closing_m_s, at_m, depth_m, slip_m_s, roll_radius_m } =
            written;
        let normal_force_n = match (normal_force_n, depth_m) {
            (Some(force_n), _) => force_n,
            (None, Some(_)) => 0.0,
            (None, None) if at_m.is_some() => f64::NAN,
            (None, None) => return Err("missing field `normal_force_n`; or depth_m, on what gives way"),
        };
        if uv.is_none() && at_m.is_none() {
            return Err("missing field `uv`; or at_m, on a surface with a frame");
        }
        let uv = uv.unwrap_or([f64::NAN; 2]);
        Ok(Self { uv, velocity_m_s, normal_force_n, closing_m_s, at_m, depth_m, slip_m_s, roll_radius_m })
    }
}

impl From<ContactSample> for Written {
    fn from(sample: ContactSample) -> Self {
        let ContactSample {
            uv,
            velocity_m_s,
            normal_force_n,
            closing_m_s,
            at_m,
            depth_m,
            slip_m_s,
            roll_radius_m,
        } = sample;
        let told_by_place = |value: f64| at_m.is_some() && value.is_nan();
        Self {
            uv: Some(uv).filter(|uv| !uv.iter().any(|x| told_by_place(*x))),
            velocity_m_s,
            normal_force_n: Some(normal_force_n).filter(|n| depth_m.is_none() && !told_by_place(*n)),
            closing_m_s,
            at_m,
            depth_m,
            slip_m_s,
            roll_radius_m,
        }
    }
}

/// Data of a surface for placing a contact on it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placement {
    pub(crate) frame: Option<SurfaceFrame>,
    pub(crate) size_m: [f64; 2],
    /// True where it gives way.
    pub(crate) is_soft: bool,
}

impl ContactSample {
    /// At texture coordinates `uv`, pressed with `normal_force_n`; its velocity is estimated from
    /// where it goes.
    #[must_use]
    pub fn new(uv: [f64; 2], normal_force_n: f64) -> Self {
        Self { uv, normal_force_n, ..Self::default() }
    }

    /// At texture coordinates `uv`, its tip `depth_m` below the untouched surface.
    #[must_use]
    pub fn at_depth(uv: [f64; 2], depth_m: f64) -> Self {
        Self { uv, depth_m: Some(depth_m), ..Self::default() }
    }

    /// With its tip at a place of the body, m: the surface's frame gives where that is on the
    /// surface and how deep below it.
    #[must_use]
    pub fn tip_at(at_m: [f64; 3]) -> Self {
        Self { uv: [f64::NAN; 2], normal_force_n: f64::NAN, at_m: Some(at_m), ..Self::default() }
    }

    /// At this place of the body, m.
    #[must_use]
    pub fn placed(mut self, at_m: [f64; 3]) -> Self {
        self.at_m = Some(at_m);
        self
    }

    /// Sliding with this velocity along u and v, m/s.
    #[must_use]
    pub fn sliding(mut self, velocity_m_s: [f64; 2]) -> Self {
        self.velocity_m_s = Some(velocity_m_s);
        self
    }

    /// Rolling, a body of this radius, m: nothing of its motion is slip.
    ///
    /// ```
    /// let marble = asperity::ContactSample::new([0.2, 0.5], 0.05).sliding([0.4, 0.0]).rolling(0.008);
    /// assert_eq!(marble.slip_m_s, Some(0.0));
    /// ```
    #[must_use]
    pub fn rolling(mut self, radius_m: f64) -> Self {
        (self.slip_m_s, self.roll_radius_m) = (Some(0.0), Some(radius_m));
        self
    }

    /// Sliding with this speed where it touches, m/s, whatever else of its motion is: a wheel that
    /// spins or locks.
    #[must_use]
    pub fn slipping(mut self, slip_m_s: f64) -> Self {
        self.slip_m_s = Some(slip_m_s);
        self
    }

    /// Landing with this speed, m/s.
    #[must_use]
    pub fn landing(mut self, closing_m_s: f64) -> Self {
        self.closing_m_s = closing_m_s;
        self
    }

    /// Sample with a negative force set to 0, and force and speeds that no model reaches held at
    /// their limits: 1e4 N and 100 m/s, of a velocity in its own direction.
    ///
    /// # Errors
    /// When a number is not finite, or a place beyond the limits of this module.
    pub fn checked(self) -> Result<Self, BadValue> {
        self.held().map(|(sample, _)| sample)
    }

    /// Held sample, and true where something was held at its limit.
    pub(crate) fn held(mut self) -> Result<(Self, bool), BadValue> {
        let mut at_limit = false;
        for x in self.at_m.into_iter().flatten() {
            within("at_m", x, limits::PLACE_M)?;
        }
        for uv in self.uv {
            within("uv", uv, limits::UV)?;
        }
        if let Some(v) = &mut self.velocity_m_s {
            let fastest = v.iter().fold(0.0f64, |most, v| most.max(v.abs()));
            for component in &mut *v {
                held("velocity_m_s", *component, limits::VELOCITY_M_S, &mut at_limit)?;
                let slowed = *component * (limits::MAX_SPEED_M_S / fastest).min(1.0);
                *component = slowed.clamp(-limits::MAX_SPEED_M_S, limits::MAX_SPEED_M_S);
            }
        }
        let pressed_n = held("normal_force_n", self.normal_force_n, limits::NORMAL_FORCE_N, &mut at_limit)?;
        self.normal_force_n = pressed_n.max(0.0);
        within("depth_m", self.depth_m.unwrap_or(0.0), limits::TIP_DEPTH_M)?;
        self.closing_m_s = held("closing_m_s", self.closing_m_s, limits::SPEED_M_S, &mut at_limit)?;
        for (field, value, range) in [
            ("slip_m_s", &mut self.slip_m_s, limits::SPEED_M_S),
            ("roll_radius_m", &mut self.roll_radius_m, limits::impact::RADIUS_M),
        ] {
            if let Some(value) = value {
                *value = held(field, *value, range, &mut at_limit)?;
            }
        }
        Ok((self, at_limit))
    }

    /// On its surface: a place in a frame becomes texture coordinates and, where nothing else
    /// presses, a depth. On a surface without a frame the place stays what it is, and texture
    /// coordinates are needed beside it.
    pub(crate) fn on(mut self, place: &Placement) -> Result<Self, Refusal> {
        if let (Some(at_m), Some(frame)) = (self.at_m, place.frame) {
            for x in at_m {
                within("at_m", x, limits::PLACE_M)?;
            }
            self.uv = frame.uv(at_m, place.size_m);
            if self.normal_force_n.is_nan() && self.depth_m.is_none() {
                (self.depth_m, self.normal_force_n) = (Some(frame.depth_m(at_m)), 0.0);
            }
            self.at_m = None;
        }
        if self.depth_m.is_some() && !place.is_soft {
            return Err(Refusal::Hard);
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> ContactSample {
        ContactSample {
            uv: [0.1, 0.2],
            velocity_m_s: Some([0.1, 0.0]),
            normal_force_n: 0.5,
            ..ContactSample::default()
        }
    }

    #[test]
    fn an_ordinary_sample_is_accepted_unchanged() {
        assert_eq!(sample().checked(), Ok(sample()));
    }

    #[test]
    fn a_negative_force_counts_as_none() {
        let lifting = ContactSample { normal_force_n: -0.01, ..sample() };
        assert_eq!(lifting.checked().unwrap().normal_force_n, 0.0);
    }

    #[test]
    fn a_sample_is_read_as_it_was_written() {
        for sample in [
            sample(),
            ContactSample::at_depth([0.1, 0.2], 0.003),
            ContactSample::tip_at([0.1, 0.2, -0.003]),
            sample().placed([1.0, 2.0, 3.0]),
            sample().rolling(0.008).slipping(0.02),
        ] {
            let text = serde_json::to_string(&sample).unwrap();
            let again: ContactSample = serde_json::from_str(&text).unwrap();
            assert_eq!(serde_json::to_string(&again).unwrap(), text);
            assert!(!text.contains("null"));
        }
        for (wrong, word) in [(r#"{"uv":[0,0]}"#, "normal_force_n"), (r#"{"normal_force_n":1}"#, "uv")] {
            let error = serde_json::from_str::<ContactSample>(wrong).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
    }

    #[test]
    fn numbers_that_no_contact_has_are_refused_by_name() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let cases = [
                ("uv", ContactSample { uv: [0.0, bad], ..sample() }),
                ("velocity_m_s", ContactSample { velocity_m_s: Some([bad, 0.0]), ..sample() }),
                ("normal_force_n", ContactSample { normal_force_n: bad, ..sample() }),
                ("depth_m", ContactSample::at_depth([0.1; 2], bad)),
                ("at_m", sample().placed([0.0, bad, 0.0])),
                ("slip_m_s", sample().slipping(bad)),
                ("roll_radius_m", sample().rolling(bad)),
                ("closing_m_s", ContactSample { closing_m_s: bad, ..sample() }),
            ];
            for (field, case) in cases {
                assert_eq!(case.checked().unwrap_err().field, field);
            }
        }
        for (field, case) in [
            ("uv", ContactSample { uv: [0.0, 1e300], ..sample() }),
            ("depth_m", ContactSample::at_depth([0.1; 2], 1e300)),
            ("at_m", sample().placed([0.0, 1e300, 0.0])),
            ("closing_m_s", sample().landing(-1.0)),
            ("slip_m_s", sample().slipping(-1.0)),
        ] {
            assert_eq!(case.checked().unwrap_err().field, field);
        }
    }

    #[test]
    fn tonnes_and_supersonic_speeds_are_held_in_their_direction() {
        let lorry = ContactSample { normal_force_n: 2e5, ..sample() }.sliding([-150.0, 300.0]).slipping(1e6);
        let (held, at_limit) = lorry.held().unwrap();
        assert!(at_limit);
        assert_eq!((held.normal_force_n, held.slip_m_s), (1e4, Some(100.0)));
        let [u, v] = held.velocity_m_s.unwrap();
        assert!((u + 50.0).abs() < 1e-9 && (v - 100.0).abs() < 1e-9, "{u} {v}");
        assert_eq!(sample().held(), Ok((sample(), false)));
        assert_eq!(ContactSample { normal_force_n: -1e6, ..sample() }.checked().unwrap().normal_force_n, 0.0);
        let [u, v] = sample().sliding([1e300, -1e300]).checked().unwrap().velocity_m_s.unwrap();
        assert!((u - 100.0).abs() < 1e-9 && u <= 100.0 && v == -u, "{u} {v}");
    }
}
