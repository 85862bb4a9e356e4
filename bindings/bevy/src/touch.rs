//! The game's half of the engine as a resource, and which entity is which body, surface, probe and
//! contact.

use crate::component::{TouchProbe, TouchSurface};
use crate::event::{TouchError, TouchEvent};
use asperity::files::contact_log::{ContactLog, Names};
use asperity::{
    Body, BodyId, ChannelId, ContactEvent, ContactId, Impact, ProbeId, Scene, Stats, SurfaceId, Touching,
};
use bevy_ecs::prelude::*;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

/// The scene of an app.
#[derive(Resource)]
pub struct Touch {
    /// A scene is used by one thread at a time, which exclusive access proves without ever locking.
    scene: Mutex<Scene>,
    bodies: HashMap<Entity, BodyId>,
    surfaces: HashMap<Entity, SurfaceId>,
    probes: HashMap<Entity, ProbeId>,
    /// Names of everything that is or was there, for recordings.
    names: Names,
    contacts: HashMap<Entity, Contact>,
    next_contact: u64,
    errors: Vec<TouchError>,
}

#[derive(Clone, Copy)]
struct Contact {
    id: ContactId,
    surface: Entity,
}

impl Touch {
    pub(crate) fn new(scene: Scene, names: Names) -> Self {
        Self {
            scene: Mutex::new(scene),
            bodies: HashMap::new(),
            surfaces: HashMap::new(),
            probes: HashMap::new(),
            names,
            contacts: HashMap::new(),
            next_contact: 1,
            errors: Vec::new(),
        }
    }

    /// The engine's own scene, for all that has no component: gains, ports, changes of sources.
    pub fn scene(&mut self) -> &mut Scene {
        self.scene.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    /// Statistics of the engine so far.
    pub fn stats(&mut self) -> Stats {
        self.scene().stats()
    }

    /// The body of an entity, while it is in the scene.
    #[must_use]
    pub fn body(&self, entity: Entity) -> Option<BodyId> {
        self.bodies.get(&entity).copied()
    }

    /// The surface of an entity, while it is in the scene.
    #[must_use]
    pub fn surface(&self, entity: Entity) -> Option<SurfaceId> {
        self.surfaces.get(&entity).copied()
    }

    /// Names of bodies, surfaces and probes in a recording: `body 0`, `surface 0`, … in the order
    /// in which they were added.
    #[must_use]
    pub fn names(&self) -> &Names {
        &self.names
    }

    /// Records from now on what is reported and how the scene changes.
    pub fn start_recording(&mut self) {
        let names = self.names.clone();
        self.scene().start_recording(&names);
    }

    /// Ends the recording; rendered offline it gives the samples that were played, to the bit.
    pub fn stop_recording(&mut self) -> ContactLog {
        self.scene().stop_recording()
    }

    /// Notes what was refused, for the next [`TouchError`].
    pub(crate) fn refused(&mut self, entity: impl Into<Option<Entity>>, why: impl ToString) {
        self.errors.push(TouchError { entity: entity.into(), text: why.to_string() });
    }

    pub(crate) fn take_errors(&mut self) -> Vec<TouchError> {
        std::mem::take(&mut self.errors)
    }

    /// Puts an entity's body into the scene, or another one into its place.
    pub(crate) fn set_body(&mut self, entity: Entity, body: &Body) {
        if let Some(id) = self.body(entity) {
            if let Err(error) = self.scene().replace_body(id, body.clone()) {
                self.refused(entity, error);
            }
            return;
        }
        match self.scene().add_body(body.clone()) {
            Ok(id) => {
                self.bodies.insert(entity, id);
                self.names.bodies.insert(format!("body {}", self.names.bodies.len()), id);
            }
            Err(error) => self.refused(entity, error),
        }
    }

    pub(crate) fn remove_body(&mut self, entity: Entity) {
        if let Some(id) = self.bodies.remove(&entity)
            && let Err(error) = self.scene().remove_body(id)
        {
            self.refused(entity, error);
        }
    }

    /// Puts an entity's surface into the scene, or another one into its place.
    pub(crate) fn set_surface(&mut self, entity: Entity, surface: &TouchSurface) {
        let Some(mut is) = surface.take() else {
            return self
                .refused(entity, "surface: was moved into the scene before; must be a new TouchSurface");
        };
        let body = self.body(surface.body().unwrap_or(entity));
        if surface.body().is_some() && body.is_none() {
            self.refused(
                entity,
                "body: the entity named by on() has no TouchBody; add it before the surface",
            );
        }
        if let Some(body) = body {
            is = is.body(body);
        }
        if let Some(id) = self.surface(entity) {
            if let Err(error) = self.scene().replace_surface(id, is) {
                self.refused(entity, error);
            }
            return;
        }
        match self.scene().add_surface(is) {
            Ok(id) => {
                self.surfaces.insert(entity, id);
                self.names.surfaces.insert(format!("surface {}", self.names.surfaces.len()), id);
            }
            Err(error) => self.refused(entity, error),
        }
    }

    pub(crate) fn remove_surface(&mut self, entity: Entity) {
        // Contacts on it fade by themselves; their later moves mean nothing any more.
        self.contacts.retain(|_, contact| contact.surface != entity);
        if let Some(id) = self.surfaces.remove(&entity)
            && let Err(error) = self.scene().remove_surface(id)
        {
            self.refused(entity, error);
        }
    }

    /// Adds a probe once; probes stay as long as the scene.
    pub(crate) fn set_probe(&mut self, entity: Entity, touches: &TouchProbe) {
        self.probes.remove(&entity);
        let Some(probe) = touches.probe else { return };
        match self.scene().add_probe(probe) {
            Ok(id) => self.name_probe(entity, id),
            Err(error) => self.refused(entity, error),
        }
    }

    fn name_probe(&mut self, entity: Entity, id: ProbeId) {
        self.probes.insert(entity, id);
        self.names.probes.insert(format!("probe {}", self.names.probes.len()), id);
    }

    /// Name for what an adapter added by itself.
    #[cfg(any(feature = "avian", feature = "rapier"))]
    pub(crate) fn name_own_probe(&mut self, name: &str, id: ProbeId) {
        self.names.probes.insert(name.into(), id);
    }

    /// Reports an event of an adapter at game time `time_s`.
    pub fn report(&mut self, time_s: f64, event: ContactEvent) {
        if let Err(error) = self.scene().report(time_s, event) {
            self.refused(None, error);
        }
    }

    /// Ends what an entity touches.
    pub(crate) fn lift(&mut self, time_s: f64, toucher: Entity) {
        if let Some(contact) = self.contacts.remove(&toucher) {
            self.report_of(toucher, time_s, ContactEvent::end(contact.id));
        }
    }

    /// Reports a message, by entities.
    pub(crate) fn told(&mut self, time_s: f64, event: &TouchEvent, probe: Option<&TouchProbe>) {
        match *event {
            TouchEvent::Begin { toucher, surface, sample } => {
                let Some(id) = self.surface(surface) else {
                    return self.refused(
                        surface,
                        "surface: the entity has no TouchSurface; add it before it is touched",
                    );
                };
                self.lift(time_s, toucher);
                let contact = Contact { id: ContactId(self.next_contact), surface };
                self.next_contact += 1;
                let mut touching = Touching::on(id);
                touching.probe = self.probes.get(&toucher).copied();
                touching.actuator = probe.map_or(Some(ChannelId(0)), |probe| probe.actuator.map(ChannelId));
                if self.report_of(toucher, time_s, ContactEvent::begin_with(contact.id, touching, sample)) {
                    self.contacts.insert(toucher, contact);
                }
            }
            TouchEvent::Move { toucher, sample } => match self.contacts.get(&toucher) {
                Some(contact) => {
                    let event = ContactEvent::moved(contact.id, sample);
                    self.report_of(toucher, time_s, event);
                }
                None => self.refused(toucher, "toucher: touches nothing; must begin before it moves"),
            },
            TouchEvent::End { toucher } => self.lift(time_s, toucher),
            TouchEvent::Impact { body, impact } => match self.body(body) {
                Some(id) => {
                    self.report_of(body, time_s, ContactEvent::Impact(Impact { body: id, ..impact }));
                }
                None => self.refused(body, "body: the entity has no TouchBody; add it before it is struck"),
            },
        }
    }

    fn report_of(&mut self, entity: Entity, time_s: f64, event: ContactEvent) -> bool {
        let reported = self.scene().report(time_s, event).map_err(|error| error.to_string());
        if let Err(why) = &reported {
            self.refused(entity, why);
        }
        reported.is_ok()
    }
}
