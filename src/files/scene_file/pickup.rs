//! `[[pickup]]`: what is read of a body's vibration, where and by which sensor.

use super::BodyEntry;
use super::fields::{self, Fields};
use crate::files::FileError;
use crate::model::bad_value::BadValue;
use crate::model::pickup::{Pickup, PickupQuantity};
use crate::parameters::pickup as of;

/// A channel of pickups.
#[derive(Debug, Clone, PartialEq)]
pub struct PickupEntry {
    /// Name.
    pub name: String,
    /// Name of the body that it is on, which holds its place.
    pub body: String,
    /// Name or file of its sensor; none = SI units.
    pub sensor: Option<String>,
}

/// Reads the pickups of a scene, in the order of their channels, onto their bodies.
pub(super) fn read_all(top: &mut Fields, bodies: &mut [BodyEntry]) -> Result<Vec<PickupEntry>, FileError> {
    let mut entries: Vec<PickupEntry> = Vec::new();
    for mut fields in top.tables("pickup")? {
        let name = fields.needed_text("name")?;
        if entries.iter().any(|entry| entry.name == name) {
            return Err(fields.refuse("name", "is used twice", "give each a name of its own"));
        }
        let place = format!("{} \"{name}\"", fields.inner("").trim_end_matches(": "));
        fields.rename(place);
        let body = fields.needed_text("body")?;
        let on = bodies.iter_mut().find(|entry| entry.name == body);
        let pickup = Pickup {
            channel: entries.len(),
            at_m: fields.vector(&of::AT_M)?,
            direction: fields.vector(&of::DIRECTION)?,
            factor: fields.number(&of::FACTOR)?,
            quantity: fields.word("quantity", &PickupQuantity::ALL)?.unwrap_or_default(),
        };
        if let Err(BadValue { field, value, expected }) = pickup.check() {
            return Err(fields.refuse(field, format!("{value} is refused"), format!("must be {expected}")));
        }
        let sensor = fields.text("sensor")?;
        if sensor.is_some() && pickup.quantity != PickupQuantity::Acceleration {
            let right = "leave out quantity, or the sensor, which reads acceleration";
            return Err(fields.refuse("sensor", "stands beside another quantity", right));
        }
        let Some(on) = on else {
            let unknown = fields.refuse("body", format!("\"{body}\" is unknown"), "");
            let known: Vec<String> = bodies.iter().map(|body| format!("\"{}\"", body.name)).collect();
            let right = format!("bodies of this scene: {}", fields::any_of(&known));
            return Err(FileError::new(unknown.at(), format!("\"{body}\" is unknown"), right));
        };
        fields.finish()?;
        on.pickups.push(pickup);
        entries.push(PickupEntry { name, body, sensor });
    }
    Ok(entries)
}
