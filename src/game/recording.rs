//! Recording of a live game's reports as a contact log.

use crate::files::contact_log::{ContactLog, LogEvent, LogHand, LogLine, LogTouching, Names};
use crate::model::event::{Actuator, ContactEvent};
use crate::model::id::{BodyId, Place, ProbeId, SurfaceId};
use std::collections::HashMap;

/// A recording in progress.
pub(crate) struct Recording {
    surfaces: HashMap<SurfaceId, String>,
    bodies: HashMap<BodyId, String>,
    probes: HashMap<ProbeId, String>,
    lines: Vec<LogLine>,
}

impl Recording {
    pub(crate) fn new(names: &Names) -> Self {
        Self {
            surfaces: names.surfaces.iter().map(|(name, id)| (*id, name.clone())).collect(),
            bodies: names.bodies.iter().map(|(name, id)| (*id, name.clone())).collect(),
            probes: names.probes.iter().map(|(name, id)| (*id, name.clone())).collect(),
            lines: Vec::new(),
        }
    }

    /// Notes an event that the engine applies at `time_s`.
    pub(crate) fn note(&mut self, time_s: f64, event: &ContactEvent) {
        let event = match *event {
            ContactEvent::Begin { contact, touching, sample } => LogEvent::Begin {
                contact: contact.0,
                touching: LogTouching {
                    surface: self.surface(touching.surface),
                    importance: unless_one(touching.importance),
                    hand: self.hand(touching.actuator, touching.probe, touching.holder, touching.gain),
                },
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
                striker: impact.striker.into(),
                restitution: impact.restitution,
                position: impact.position,
                hand: self.hand(impact.actuator, impact.probe, impact.holder, impact.gain),
            },
        };
        self.lines.push(LogLine { t: time_s, event });
    }

    pub(crate) fn into_log(self) -> ContactLog {
        ContactLog { lines: self.lines }
    }

    fn hand(
        &self,
        actuator: Option<Actuator>,
        probe: Option<ProbeId>,
        holder: Option<BodyId>,
        gain: f64,
    ) -> LogHand {
        LogHand {
            actuator: actuator.map(|actuator| actuator.0),
            probe: probe.map(|probe| self.probe(probe)),
            holder: holder.map(|holder| self.body(holder)),
            gain: unless_one(gain),
        }
    }

    fn probe(&self, id: ProbeId) -> String {
        self.probes.get(&id).cloned().unwrap_or_else(|| numbered("probe", id.0))
    }

    fn surface(&self, id: SurfaceId) -> String {
        self.surfaces.get(&id).cloned().unwrap_or_else(|| numbered("surface", id.0))
    }

    fn body(&self, id: BodyId) -> String {
        self.bodies.get(&id).cloned().unwrap_or_else(|| numbered("body", id.0))
    }
}

/// A factor that a log need not hold when it is 1.
fn unless_one(factor: f64) -> Option<f64> {
    (factor != 1.0).then_some(factor)
}

/// What a thing without a name is called: its place, and which of its occupants, from the second on.
fn numbered(kind: &str, Place { index, generation }: Place) -> String {
    if generation == 1 { format!("{kind} {index}") } else { format!("{kind} {index}.{generation}") }
}
