//! Messages: contacts in, by entities; refusals out, in the engine's words.

use asperity::{ContactSample, Impact};
use bevy_ecs::prelude::*;

/// Touch since the last fixed step. Written in any schedule; reported at the end of the next fixed
/// step, with its time.
#[derive(Message, Debug, Clone, Copy)]
pub enum TouchEvent {
    /// An entity lands on a surface. What touches, and who feels it, says its
    /// [`TouchProbe`](crate::TouchProbe).
    Begin {
        /// Finger.
        toucher: Entity,
        /// Touched entity, with a [`TouchSurface`](crate::TouchSurface).
        surface: Entity,
        /// Place and force.
        sample: ContactSample,
    },
    /// It goes on, somewhere else or with another force.
    Move {
        /// Finger.
        toucher: Entity,
        /// Place and force.
        sample: ContactSample,
    },
    /// It lifts off.
    End {
        /// Finger.
        toucher: Entity,
    },
    /// Something strikes an entity with a [`TouchBody`](crate::TouchBody).
    Impact {
        /// Body that rings.
        body: Entity,
        /// Speed (m/s), mass (kg), radius (m) and material of what strikes; its `body` does not
        /// count.
        impact: Impact,
    },
}

/// Refusal by the engine, and its reason. It is logged as a warning too; nothing here panics.
#[derive(Message, Debug, Clone, PartialEq)]
pub struct TouchError {
    /// Entity that it is about.
    pub entity: Option<Entity>,
    /// The engine's own sentence: which field, what is wrong, what would be right.
    pub text: String,
}
