//! Pickups of a scene: where they lie on their bodies, and what those do as a whole.

use super::Scene;
use crate::link::message::Message;
use crate::model::bad_value::within;
use crate::model::body::Body;
use crate::model::error::{AddError, PickupProblem, Refusal};
use crate::model::event::ContactEvent;
use crate::model::id::BodyId;
use crate::model::pickup::{Pickup, RigidMotion};
use crate::model::strike_field::StrikeField;
use crate::resource::pickup::PlacedPickup;
use std::sync::atomic::Ordering::Relaxed;

/// Farthest place of a pickup from the surface, over the body's size.
const OFF_SURFACE: f64 = 0.01;
/// Longest way from one report of a motion to the next that is taken for steady, s.
const STEADY_S: f64 = 0.1;

impl Scene {
    /// Puts another pickup on a body; what the body rings meanwhile rings out unread.
    ///
    /// # Errors
    /// When the body is not in this scene, or as [`add_body`](Self::add_body).
    pub fn add_pickup(&mut self, body: BodyId, pickup: Pickup) -> Result<(), AddError> {
        self.known_body(body)?;
        let given = self.given.get(&body).cloned().ok_or(AddError::Unknown("body"))?;
        self.replace_body(body, given.pickup(pickup))
    }

    /// Sets for the accelerometers of a body how it moves as a whole: they read it from there on,
    /// in a straight line over the time since the report before.
    pub(super) fn report_motion(
        &mut self,
        time_s: f64,
        body: BodyId,
        motion: RigidMotion,
    ) -> Result<(), Refusal> {
        let motion = motion.checked()?;
        self.known_body(body).map_err(|_| Refusal::UnknownBody)?;
        self.checked_time(time_s)?;
        let position = self.counters.position.load(Relaxed);
        self.settle_recording(position);
        let stamp = self.clock.stamp(time_s, position, false).stamp;
        let before = self.moved.insert(body, (time_s, motion.angular_velocity_rad_s));
        let steady = before.map(|(then_s, omega)| (time_s - then_s, omega));
        let steady = steady.filter(|(since_s, _)| *since_s > 0.0 && *since_s <= STEADY_S);
        let alpha = steady.map_or([0.0; 3], |(since_s, omega)| {
            std::array::from_fn(|i| (motion.angular_velocity_rad_s[i] - omega[i]) / since_s)
        });
        let over_s = steady.map_or(0.0, |(since_s, _)| since_s);
        let over = (over_s * self.config.inner_rate_hz()) as u32;
        let message =
            Message::Motion { stamp, epoch: self.clock.epoch(), slot: body.index(), motion, alpha, over };
        self.to_audio.send(message).map_err(|_| Refusal::QueueFull)?;
        if let Some(recording) = &mut self.recording {
            let rate_hz = self.config.inner_rate_hz();
            let reported = (self.clock.epoch(), position as f64 / rate_hz);
            recording.note(stamp.samples() / rate_hz, reported, &ContactEvent::Motion { body, motion }, 0);
        }
        Ok(())
    }

    /// The pickups of a body, each at its place.
    pub(super) fn placed_pickups(
        &self,
        body: &Body,
        field: Option<&StrikeField>,
    ) -> Result<Vec<PlacedPickup>, AddError> {
        let channels = self.config.pickups.len();
        let placed = |pickup: &Pickup| {
            let problem = match placed(pickup, body, field, channels) {
                Ok(placed) => return Ok(placed),
                Err(problem) => problem,
            };
            Err(AddError::Pickup { number: pickup.channel + 1, problem })
        };
        body.pickups.iter().map(placed).collect()
    }
}

fn placed(
    pickup: &Pickup,
    body: &Body,
    field: Option<&StrikeField>,
    channels: usize,
) -> Result<PlacedPickup, PickupProblem> {
    pickup.check()?;
    if pickup.channel >= channels {
        return Err(PickupProblem::Channel(pickup.channel, channels));
    }
    let Some(field) = field else {
        return match (pickup.factor, body.mass_kg) {
            (None, _) => Err(PickupProblem::NoShapes),
            (_, None) => Err(PickupProblem::NoMass),
            _ => Ok(PlacedPickup { pickup: *pickup, place: None }),
        };
    };
    if pickup.factor.is_some() {
        return Err(PickupProblem::FactorBesideShapes);
    }
    let at_m = pickup.at_m.ok_or(PickupProblem::NoPlace)?;
    let mut place = field.place(at_m, pickup.direction).ok_or(PickupProblem::NoShapes)?;
    if pickup.direction.is_none() {
        place.direction = place.direction.map(|x| -x);
    }
    let (point_m, most_m) = (field.point_m(&place), OFF_SURFACE * field.size_m());
    let off_m = (0..3).map(|i| (point_m[i] - at_m[i]).powi(2)).sum::<f64>().sqrt();
    within("at_m", off_m, asperity_dsp::limits::PLACE_M)?;
    if off_m > most_m {
        return Err(PickupProblem::OffSurface(rounded(off_m), rounded(most_m), point_m.map(rounded)));
    }
    Ok(PlacedPickup { pickup: *pickup, place: Some(place) })
}

/// To a micrometre, for messages.
fn rounded(x: f64) -> f64 {
    (x * 1e6).round() / 1e6
}
