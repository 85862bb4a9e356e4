//! Notices of a world: each kind once a thing.

use crate::thing::Thing;
use crate::view::View;
use asperity_pairs::{Notice, ODD_GRAVITY_M_S2, ODD_SIZE_M};
use rapier3d::prelude::*;
use std::collections::{HashMap, HashSet};
use std::fmt;
use std::mem::Discriminant;

/// Something that is heard wrong, or not at all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Warning {
    /// The collider that it is about; none: the world.
    pub collider: Option<ColliderHandle>,
    /// Notice.
    pub notice: Notice,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.collider {
            Some(collider) => write!(f, "collider {:?}: {}", collider.into_raw_parts(), self.notice),
            None => self.notice.fmt(f),
        }
    }
}

#[derive(Debug, Default)]
pub(crate) struct Notices {
    known: HashSet<(Option<ColliderHandle>, Discriminant<Notice>)>,
    looked_at: HashSet<ColliderHandle>,
    new: Vec<Warning>,
}

impl Notices {
    pub(crate) fn note(&mut self, collider: Option<ColliderHandle>, notice: Notice) {
        if self.known.insert((collider, std::mem::discriminant(&notice))) {
            self.new.push(Warning { collider, notice });
        }
    }

    /// The world, and every thing that has come.
    pub(crate) fn look_at(&mut self, view: &View<'_>, things: &HashMap<ColliderHandle, Thing>) {
        let gravity_m_s2 = view.gravity.length();
        if gravity_m_s2 > ODD_GRAVITY_M_S2 {
            self.note(None, Notice::Gravity { m_s2: gravity_m_s2 });
        }
        for (handle, thing) in things {
            let Some(collider) = view.colliders.get(*handle) else { continue };
            if !self.looked_at.insert(*handle) {
                continue;
            }
            let Some(body) = view.body_of(*handle) else { continue };
            let size_m = collider.shape().compute_local_aabb().half_extents().max_element();
            if body.is_dynamic() && size_m > ODD_SIZE_M {
                self.note(Some(*handle), Notice::Size { m: size_m });
            }
            let is_hand = body.is_kinematic() && thing.actuator.is_some() && thing.nominal_n > 0.0;
            if is_hand && !collider.active_collision_types().contains(ActiveCollisionTypes::KINEMATIC_FIXED) {
                self.note(Some(*handle), Notice::Unlisted);
            }
        }
    }

    pub(crate) fn take(&mut self) -> Vec<Warning> {
        std::mem::take(&mut self.new)
    }
}
