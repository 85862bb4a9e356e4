//! Names of a log, and the ids of a running scene that they stand for.

use super::{ContactLog, LogError, LogEvent, LogHand, LogLine, LogTouching, Striker};
use crate::model::event::{ChannelId, ContactEvent, ContactId, Impact, Touching};
use crate::model::id::{BodyId, ProbeId, SurfaceId};
use crate::model::material::Material;
use std::collections::HashMap;

/// Which id of a running scene a name stands for.
#[derive(Debug, Clone, Default)]
pub struct Names {
    /// Surfaces by name.
    pub surfaces: HashMap<String, SurfaceId>,
    /// Bodies by name.
    pub bodies: HashMap<String, BodyId>,
    /// Probes by name.
    pub probes: HashMap<String, ProbeId>,
}

impl ContactLog {
    /// Checks every name in the log against those of a scene, unless the log itself edits the
    /// scene.
    ///
    /// # Errors
    /// [`LogError::Event`], the first whose names are not all in `names`.
    pub fn check_names(&self, names: &Names) -> Result<(), LogError> {
        let edits = |line: &LogLine| matches!(line.event, LogEvent::Edit(_));
        if self.lines.iter().any(edits) {
            return Ok(());
        }
        let unknown =
            |(index, line): (usize, &LogLine)| Some(line.in_log(index, line.event.resolve(names).err()?));
        self.lines.iter().enumerate().find_map(unknown).map_or(Ok(()), Err)
    }
}

impl LogEvent {
    /// The event for a scene whose ids `names` gives.
    ///
    /// # Errors
    /// When the event names a surface, body or striker that is not there.
    pub fn resolve(&self, names: &Names) -> Result<ContactEvent, LogError> {
        Ok(match self {
            Self::Begin { contact, touching, sample } => ContactEvent::Begin {
                contact: ContactId(*contact),
                touching: touching.resolve(names)?,
                sample: *sample,
            },
            Self::Move { contact, sample, emphasis } => {
                ContactEvent::moved_with(ContactId(*contact), *sample, *emphasis)
            }
            Self::End { contact } => ContactEvent::end(ContactId(*contact)),
            Self::Impact {
                body,
                other,
                speed_m_s,
                mass_kg,
                radius_m,
                striker,
                restitution,
                position,
                at_m,
                direction,
                hand,
            } => ContactEvent::Impact(Impact {
                body: find("body", body, &names.bodies)?,
                other: other.as_ref().map(|name| find("body", name, &names.bodies)).transpose()?,
                speed_m_s: *speed_m_s,
                mass_kg: *mass_kg,
                radius_m: *radius_m,
                striker: striker.material()?,
                restitution: *restitution,
                position: *position,
                at_m: *at_m,
                direction: *direction,
                actuator: hand.actuator.map(ChannelId),
                holder: hand.holder(names)?,
                probe: hand.probe(names)?,
                gain: hand.gain.unwrap_or(1.0),
            }),
            Self::Motion { body, motion } => {
                ContactEvent::Motion { body: find("body", body, &names.bodies)?, motion: *motion }
            }
            Self::Edit(_) => return Err(LogError::Edit),
        })
    }
}

impl LogTouching {
    fn resolve(&self, names: &Names) -> Result<Touching, LogError> {
        let hand = &self.hand;
        let mut touching = Touching::on(find("surface", &self.surface, &names.surfaces)?);
        touching.actuator = hand.actuator.map(ChannelId);
        (touching.probe, touching.holder) = (hand.probe(names)?, hand.holder(names)?);
        Ok(touching.gain(hand.gain.unwrap_or(1.0)).importance(self.importance.unwrap_or(1.0)))
    }
}

impl LogHand {
    fn probe(&self, names: &Names) -> Result<Option<ProbeId>, LogError> {
        self.probe.as_ref().map(|name| find("probe", name, &names.probes)).transpose()
    }

    fn holder(&self, names: &Names) -> Result<Option<BodyId>, LogError> {
        self.holder.as_ref().map(|name| find("holder", name, &names.bodies)).transpose()
    }
}

impl From<Material> for Striker {
    fn from(material: Material) -> Self {
        material.name().map_or(Self::Constants(material), |name| Self::Preset(name.into()))
    }
}

impl Striker {
    fn material(&self) -> Result<Material, LogError> {
        match self {
            Self::Constants(material) => Ok(*material),
            Self::Preset(name) => Material::by_name(name).ok_or_else(|| LogError::UnknownName {
                kind: "striker",
                name: name.clone(),
                known: Material::names(),
            }),
        }
    }
}

fn find<Id: Copy>(kind: &'static str, name: &str, ids: &HashMap<String, Id>) -> Result<Id, LogError> {
    ids.get(name).copied().ok_or_else(|| {
        let mut known: Vec<_> = ids.keys().map(String::as_str).collect();
        known.sort_unstable();
        LogError::UnknownName { kind, name: name.into(), known: known.join(", ") }
    })
}
