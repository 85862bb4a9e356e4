//! Contacts of `bevy_rapier3d`, converted by the crate `asperity-rapier`: every pair of colliders
//! that have a [`TouchThing`](crate::TouchThing) strikes, scrapes or rolls.
//!
//! The physics plugin has to run in the fixed schedule
//! (`RapierPhysicsPlugin::<()>::default().in_fixed_schedule()`) with `TimestepMode::Fixed` of one
//! substep, because the solver keeps the impulses of the last substep only.

use crate::component::TouchThing;
use crate::plugin::TouchSystems;
use crate::touch::Touch;
use asperity::ChannelId;
use asperity_rapier::{Adapter, Mapping, Thing, View};
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_rapier3d::plugin::context::{RapierContextColliders, RapierContextSimulation, RapierRigidBodySet};
use bevy_rapier3d::plugin::{PhysicsSet, RapierConfiguration, TimestepMode};
use bevy_rapier3d::prelude::RapierColliderHandle;
use bevy_rapier3d::rapier::prelude::ColliderHandle;
use bevy_time::{Fixed, Time};
use std::collections::HashMap;

/// Name of the probe that things touch with, in recordings; with a face it goes on with its length.
pub const RIGID_PROBE: &str = "rapier's rigid things";

/// Listens to the physics; to be added after [`AsperityPlugin`](crate::AsperityPlugin).
#[derive(Debug, Clone, Copy, Default)]
pub struct RapierTouchPlugin;

#[derive(Resource)]
struct Listener {
    adapter: Adapter,
    known: HashMap<Entity, ColliderHandle>,
}

impl Plugin for RapierTouchPlugin {
    fn build(&self, app: &mut App) {
        let Some(mut touch) = app.world_mut().get_resource_mut::<Touch>() else {
            return log::error!(
                "asperity gets nothing from rapier: AsperityPlugin has to be added before, and to be built"
            );
        };
        match Adapter::new(touch.scene()) {
            Ok(adapter) => {
                let named = adapter.named_probes(RIGID_PROBE);
                named.for_each(|(name, id)| touch.name_own_probe(&name, id));
                app.insert_resource(Listener { adapter, known: HashMap::new() });
                app.add_systems(
                    FixedUpdate,
                    (
                        before.after(PhysicsSet::SyncBackend).before(PhysicsSet::StepSimulation),
                        after.after(PhysicsSet::StepSimulation).in_set(TouchSystems::Report),
                    ),
                );
            }
            Err(error) => log::error!("asperity gets nothing from rapier: {error}"),
        }
    }
}

type World<'a> = (
    &'a mut RapierContextSimulation,
    &'a RapierContextColliders,
    &'a RapierRigidBodySet,
    &'a RapierConfiguration,
);

fn view<'a>(
    (simulation, colliders, bodies, configuration): (
        &'a RapierContextSimulation,
        &'a RapierContextColliders,
        &'a RapierRigidBodySet,
        &'a RapierConfiguration,
    ),
    mode: &TimestepMode,
) -> View<'a> {
    let step_s = match mode {
        TimestepMode::Fixed { dt, .. } | TimestepMode::Interpolated { dt, .. } => *dt,
        TimestepMode::Variable { .. } => simulation.integration_parameters.dt,
    };
    View {
        bodies: &bodies.bodies,
        colliders: &colliders.colliders,
        narrow_phase: &simulation.narrow_phase,
        gravity: configuration.gravity,
        step_s,
    }
}

/// Right before the step: what the colliders are by now, and how everything moves.
fn before(
    mut listener: ResMut<Listener>,
    touch: Res<Touch>,
    things: Query<(Entity, &RapierColliderHandle, &TouchThing)>,
    mut worlds: Query<World<'_>>,
    mode: Res<TimestepMode>,
) {
    let Listener { adapter, known } = &mut *listener;
    known.retain(|entity, handle| {
        let stays = things.get(*entity).is_ok_and(|(_, now, _)| now.0 == *handle);
        if !stays {
            adapter.remove(*handle);
        }
        stays
    });
    for (entity, handle, thing) in &things {
        adapter.insert(handle.0, thing_of(entity, thing, &touch));
        known.insert(entity, handle.0);
    }
    if let Ok((mut simulation, colliders, bodies, configuration)) = worlds.single_mut() {
        // With recycling the contact point stands still while a finger moves.
        simulation.integration_parameters.contact_recycling = false;
        adapter.before_step(&view((&simulation, colliders, bodies, configuration), &mode));
    }
    for warning in adapter.warnings() {
        let of = known.iter().find(|(_, handle)| Some(**handle) == warning.collider);
        match of {
            Some((entity, _)) => log::warn!("asperity, {entity}: {}", warning.notice),
            None => log::warn!("asperity: {}", warning.notice),
        }
    }
}

fn thing_of(entity: Entity, thing: &TouchThing, touch: &Touch) -> Thing {
    let mut is = Thing::of(thing.material);
    if let Some(body) = touch.body(entity) {
        is = is.ringing(body);
    }
    // A plane without area has no texture coordinates: the thing is then struck only.
    if let (Some(surface), Some(mapping)) = (touch.surface(entity), thing.surface_mapping()) {
        is = is.with_surface(surface, Mapping::Shape(mapping));
    }
    is = is.running(thing.belt_m_s).pressing(thing.nominal_force_n);
    if let Some(actuator) = thing.actuator {
        is = is.felt_by(ChannelId(actuator));
    }
    thing.radius_m.map_or(is.clone(), |radius_m| is.radius_m(radius_m))
}

/// Right after it: what happened.
fn after(
    mut listener: ResMut<Listener>,
    mut touch: ResMut<Touch>,
    worlds: Query<World<'_>>,
    mode: Res<TimestepMode>,
    time: Res<Time<Fixed>>,
) {
    let Ok((simulation, colliders, bodies, configuration)) = worlds.single() else { return };
    for event in listener.adapter.after_step(&view((simulation, colliders, bodies, configuration), &mode)) {
        touch.report(time.elapsed_secs_f64(), event);
    }
}
