//! Observers: the scene is what the components say, from the command that adds one to the command
//! that removes it.

use crate::component::{TouchBody, TouchProbe, TouchSurface};
use crate::touch::Touch;
use bevy_ecs::prelude::*;
use bevy_time::{Fixed, Time};

pub(crate) fn body_came(on: On<Insert, TouchBody>, bodies: Query<&TouchBody>, touch: Option<ResMut<Touch>>) {
    if let (Ok(body), Some(mut touch)) = (bodies.get(on.entity), touch) {
        touch.set_body(on.entity, &body.0);
    }
}

pub(crate) fn body_went(on: On<Remove, TouchBody>, touch: Option<ResMut<Touch>>) {
    if let Some(mut touch) = touch {
        touch.remove_body(on.entity);
    }
}

pub(crate) fn surface_came(
    on: On<Insert, TouchSurface>,
    surfaces: Query<(&TouchSurface, Option<&TouchBody>)>,
    touch: Option<ResMut<Touch>>,
) {
    let (Ok((surface, own)), Some(mut touch)) = (surfaces.get(on.entity), touch) else { return };
    // Of one bundle either may be told first.
    if let (Some(own), None, None) = (own, surface.body(), touch.body(on.entity)) {
        touch.set_body(on.entity, &own.0);
    }
    touch.set_surface(on.entity, surface);
}

pub(crate) fn surface_went(on: On<Remove, TouchSurface>, touch: Option<ResMut<Touch>>) {
    if let Some(mut touch) = touch {
        touch.remove_surface(on.entity);
    }
}

pub(crate) fn probe_came(
    on: On<Insert, TouchProbe>,
    probes: Query<&TouchProbe>,
    touch: Option<ResMut<Touch>>,
) {
    if let (Ok(probe), Some(mut touch)) = (probes.get(on.entity), touch) {
        touch.set_probe(on.entity, probe);
    }
}

/// A finger that is gone touches nothing.
pub(crate) fn toucher_went<C: Component>(
    on: On<Remove, C>,
    time: Res<Time<Fixed>>,
    touch: Option<ResMut<Touch>>,
) {
    if let Some(mut touch) = touch {
        touch.lift(time.elapsed_secs_f64(), on.entity);
    }
}
