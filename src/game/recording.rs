//! What a live game reported, kept as a contact log.

use crate::files::contact_log::{ContactLog, LogEvent, LogLine, Names, Striker};
use crate::model::event::{BodyId, ContactEvent, SurfaceId};
use std::collections::HashMap;

/// A recording in progress.
pub(crate) struct Recording {
    surfaces: HashMap<SurfaceId, String>,
    bodies: HashMap<BodyId, String>,
    lines: Vec<LogLine>,
}

impl Recording {
    pub(crate) fn new(names: &Names) -> Self {
        Self {
            surfaces: names.surfaces.iter().map(|(name, id)| (*id, name.clone())).collect(),
            bodies: names.bodies.iter().map(|(name, id)| (*id, name.clone())).collect(),
            lines: Vec::new(),
        }
    }

    /// Notes an event that the engine applies at `time_s`.
    pub(crate) fn note(&mut self, time_s: f64, event: &ContactEvent) {
        let event = match *event {
            ContactEvent::Begin { contact, surface, actuator, sample } => LogEvent::Begin {
                contact: contact.0,
                surface: self.surface(surface),
                actuator: actuator.0,
                sample: sample.into(),
            },
            ContactEvent::Moved { contact, sample } => {
                LogEvent::Move { contact: contact.0, sample: sample.into() }
            }
            ContactEvent::End { contact } => LogEvent::End { contact: contact.0 },
            ContactEvent::Impact(impact) => LogEvent::Impact {
                body: self.body(impact.body),
                other: impact.other.map(|other| self.body(other)),
                speed_m_s: impact.speed_m_s,
                mass_kg: impact.mass_kg,
                radius_m: impact.radius_m,
                striker: Striker::Constants(impact.striker),
                restitution: impact.restitution,
                position: impact.position,
            },
        };
        self.lines.push(LogLine { t: time_s, event });
    }

    pub(crate) fn into_log(self) -> ContactLog {
        ContactLog { lines: self.lines }
    }

    fn surface(&self, id: SurfaceId) -> String {
        self.surfaces.get(&id).cloned().unwrap_or_else(|| format!("surface {}", id.0))
    }

    fn body(&self, id: BodyId) -> String {
        self.bodies.get(&id).cloned().unwrap_or_else(|| format!("body {}", id.0))
    }
}
