#![doc = include_str!("../README.md")]
//!
//! # The map of this crate
//!
//! | file | holds |
//! |---|---|
//! | `view` | the parts of a physics world, whoever owns them |
//! | `thing` | what a collider is to asperity |
//! | `solved` | a pair's contact as the solver left it |
//! | `notices` | what the game should know of its things |
//! | `side` | one of the two of a pair, for the rules of the crate `asperity-pairs` |
//! | `vector` | vectors of one and the other |

// One source for both versions of the physics engine.
#[cfg(feature = "bevy-rapier-0-36")]
extern crate rapier3d_of_bevy as rapier3d;

mod notices;
mod side;
mod solved;
mod thing;
mod vector;
mod view;

pub use asperity_pairs::{EDGE_RADIUS_M, FACES_M, Kind, NOMINAL_FORCE_N, Notice};
pub use notices::Warning;
pub use thing::{Mapping, Thing};
pub use view::View;

use asperity::{AddError, ContactEvent, ContactId, ProbeId, Scene};
use asperity_pairs::{Motion, Pair, Probes, Side, Step};
use notices::Notices;
use rapier3d::prelude::*;
use side::ColliderSide;
use std::collections::{BTreeMap, HashMap};

/// Ids of the adapter's contacts begin here, so that a game's own stay free below.
pub const FIRST_CONTACT: u64 = 1 << 32;

/// A pair that touches.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Touch {
    /// Its colliders, in rapier's order.
    pub colliders: [ColliderHandle; 2],
    /// Activity.
    pub kind: Kind,
    /// The contact that is reported; none while it rests, or where nothing can be scraped.
    pub contact: Option<ContactId>,
    /// Speed at which the place of contact moves over the surface, m/s.
    pub path_m_s: f32,
    /// Speed at which the two slide on each other there, m/s.
    pub slip_m_s: f32,
    /// Force between them, mean of the step, N.
    pub force_n: f32,
    /// True where it is silent because its mapping gives no texture coordinates there.
    pub is_unplaced: bool,
}

/// All pairs of a physics world, as contact events.
#[derive(Debug)]
pub struct Adapter {
    things: HashMap<ColliderHandle, Thing>,
    /// In order, so that the same world gives the same events.
    pairs: BTreeMap<[(u32, u32); 2], Listed>,
    before: HashMap<RigidBodyHandle, Motion>,
    notices: Notices,
    probes: Probes,
    next_contact: u64,
}

/// A pair that rapier lists.
#[derive(Debug)]
struct Listed {
    seen: bool,
    colliders: [ColliderHandle; 2],
    pair: Pair,
}

impl Adapter {
    /// An adapter whose things touch as new probes of the scene, with a tip or a face
    /// ([`FACES_M`]); to be made before the surfaces, which get ready for them.
    ///
    /// # Errors
    /// When the scene has no place for other probes.
    pub fn new(scene: &mut Scene) -> Result<Self, AddError> {
        let probes = Probes::add(scene)?;
        Ok(Self {
            things: HashMap::new(),
            pairs: BTreeMap::new(),
            before: HashMap::new(),
            notices: Notices::default(),
            probes,
            next_contact: FIRST_CONTACT,
        })
    }

    /// The probe of things that touch with a tip and are not told otherwise; its name in a
    /// recording is the game's choice.
    #[must_use]
    pub fn rigid_probe(&self) -> ProbeId {
        self.probes.tip
    }

    /// Each probe that the adapter has added, with a name that begins with `name`.
    pub fn named_probes(&self, name: &str) -> impl Iterator<Item = (String, ProbeId)> {
        self.probes.named(name)
    }

    /// Says what a collider is; colliders of which nothing is said are not heard. A new thing for a
    /// known collider counts from its next contact on.
    pub fn insert(&mut self, collider: ColliderHandle, thing: Thing) {
        self.things.insert(collider, thing);
    }

    /// Forgets a collider; its contacts end with the next step.
    pub fn remove(&mut self, collider: ColliderHandle) {
        self.things.remove(&collider);
    }

    /// To be called right before the physics step: keeps how everything moves, because after it a
    /// landing is a rebound.
    pub fn before_step(&mut self, view: &View<'_>) {
        self.before.clear();
        for (handle, body) in view.bodies.iter() {
            self.before.insert(handle, view::motion(body));
        }
        self.notices.look_at(view, &self.things);
    }

    /// Notices about things and the world since the last call, each once: to be logged.
    pub fn warnings(&mut self) -> Vec<Warning> {
        self.notices.take()
    }

    /// To be called right after the physics step: what happened in it, to be reported at its game
    /// time.
    pub fn after_step(&mut self, view: &View<'_>) -> Vec<ContactEvent> {
        let mut events = Vec::new();
        self.pairs.values_mut().for_each(|listed| listed.seen = false);
        for contact in view.narrow_phase.contact_pairs() {
            let colliders = [contact.collider1, contact.collider2];
            let [Some(first), Some(second)] = colliders.map(|collider| self.things.get(&collider)) else {
                continue;
            };
            let [Some(a), Some(b)] = colliders.map(|collider| view.colliders.get(collider)) else { continue };
            let before = [a, b].map(|collider| {
                collider.parent().and_then(|body| self.before.get(&body)).copied().unwrap_or_default()
            });
            let sides = [(colliders[0], a, first), (colliders[1], b, second)]
                .map(|(handle, collider, thing)| ColliderSide { view, handle, collider, thing });
            let step = Step {
                sides: [&sides[0] as &dyn Side, &sides[1]],
                solved: solved::solved(contact, view, before, [first.nominal_n, second.nominal_n]),
                probes: self.probes,
                step_s: view.step_s,
            };
            let key = colliders.map(ColliderHandle::into_raw_parts);
            let new = || Listed { seen: true, colliders, pair: Pair::default() };
            let listed = self.pairs.entry(key).or_insert_with(new);
            (listed.seen, listed.colliders) = (true, colliders);
            listed.pair.advance(&step, &mut self.next_contact, &mut events);
            if let Some(unplaced) = listed.pair.doing().and_then(|doing| doing.unplaced) {
                self.notices.note(Some(colliders[unplaced]), Notice::Unplaced);
            }
        }
        for listed in self.pairs.values_mut().filter(|listed| !listed.seen) {
            listed.pair.leave(&mut events);
        }
        self.pairs.retain(|_, listed| listed.seen);
        events
    }

    /// Every pair that touched in the last step.
    pub fn touches(&self) -> impl Iterator<Item = Touch> + '_ {
        self.pairs.values().filter_map(|listed| {
            let doing = listed.pair.doing()?;
            Some(Touch {
                colliders: listed.colliders,
                kind: doing.kind,
                contact: doing.contact,
                path_m_s: doing.path_m_s,
                slip_m_s: doing.slip_m_s,
                force_n: doing.force_n,
                is_unplaced: doing.unplaced.is_some(),
            })
        })
    }

    /// Ends every contact, for a level that is left: what is returned is to be reported.
    pub fn end_all(&mut self) -> Vec<ContactEvent> {
        let mut events = Vec::new();
        self.pairs.values_mut().for_each(|listed| listed.pair.leave(&mut events));
        self.pairs.clear();
        events
    }
}
