//! Members of a world's engine, which nodes put in and take out: bodies, and surfaces on them.

use super::{AsperityWorld, BODIES};
use crate::body::AsperityBody;
use crate::surface::AsperitySurface;
use asperity::load::{Overrides, ReadSurface};
use asperity::surface::sand::SandWorker;
use asperity::{BodyId, BusId, SurfaceId};
use godot::prelude::*;
use std::path::Path;

impl AsperityWorld {
    /// Bodies of the tree that were here before the engine was.
    pub(super) fn take_in_bodies(&mut self) {
        if !self.base().is_inside_tree() {
            return;
        }
        let me = self.base().instance_id();
        for node in self.base().get_tree().get_nodes_in_group(BODIES).iter_shared() {
            if let Ok(mut body) = node.try_cast::<AsperityBody>()
                && body.is_node_ready()
                && body.bind().waits_for(me)
            {
                body.bind_mut().join_in(self, me);
            }
        }
    }

    /// Puts a body into the scene; 0 where it is refused.
    pub(crate) fn join_body(&mut self, body: &AsperityBody, name: &str) -> i64 {
        let told = body.told(name);
        let Some((table, files, bus, gain)) = self.said("AsperityBody", told) else { return 0 };
        let id = self.tried("AsperityBody", |running| {
            let overrides = Overrides { files: &files, live: true, ..Overrides::default() };
            let read = running.scene.read_body(&table, Path::new(""), &overrides);
            let body = read.map_err(|error| error.to_string())?.bus(BusId(bus)).gain(gain);
            let id = running.scene.add_body(body).map_err(|error| error.to_string())?;
            running.names.bodies.insert(name.into(), id);
            Ok(id.to_bits() as i64)
        });
        id.unwrap_or(0)
    }

    /// Puts a surface into the scene; 0 where it is refused.
    pub(crate) fn join_surface(&mut self, surface: &Gd<AsperitySurface>, body: i64, name: &str) -> i64 {
        let told = surface.bind().told(name);
        let Some((table, files)) = self.said("AsperitySurface", told) else { return 0 };
        let id = self.tried("AsperitySurface", |running| {
            let overrides = Overrides { files: &files, live: true, ..Overrides::default() };
            let on = Some(body).filter(|id| *id != 0).map(|id| BodyId::from_bits(id as u64));
            let read = running.scene.read_surface(&table, Path::new(""), on, &running.names, &overrides);
            let ReadSurface { surface, workers, .. } = read.map_err(|error| error.to_string())?;
            let id = running.scene.add_surface(surface).map_err(|error| error.to_string())?;
            running.sand.extend(workers.into_iter().map(SandWorker::spawn));
            if !name.is_empty() {
                running.names.surfaces.insert(name.into(), id);
            }
            Ok(id.to_bits() as i64)
        });
        id.unwrap_or(0)
    }

    /// Takes a body and its surface away. Nothing is said of what is gone already.
    pub(crate) fn leave(&mut self, body: i64, surface: i64) {
        let Some(running) = &mut self.running else { return };
        let (body, surface) = (BodyId::from_bits(body as u64), SurfaceId::from_bits(surface as u64));
        // The world was built anew since, or never knew them: nothing is left to be taken away.
        let _ = running.scene.remove_surface(surface);
        let _ = running.scene.remove_body(body);
        running.names.surfaces.retain(|_, known| *known != surface);
        running.names.bodies.retain(|_, known| *known != body);
    }
}
