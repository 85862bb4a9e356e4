//! A table whose places are used again and again, under names that are not.

use crate::model::error::AddError;
use crate::model::id::SlotKey;

/// Table of surfaces, bodies or probes on the game half, by place.
pub(crate) struct Places<T> {
    slots: Vec<Slot<T>>,
    /// Name of what the table holds, for errors.
    kind: &'static str,
}

struct Slot<T> {
    /// Generation of the occupant, or of the next one. A place whose generations are used up stays
    /// empty.
    generation: u32,
    occupant: Option<T>,
}

impl<T> Places<T> {
    /// `capacity` empty places for `kind`.
    pub(crate) fn new(capacity: usize, kind: &'static str) -> Self {
        Self { slots: (0..capacity).map(|_| Slot { generation: 1, occupant: None }).collect(), kind }
    }

    /// The name under which the next occupant will be known.
    pub(crate) fn free(&self) -> Result<SlotKey, AddError> {
        let free = |slot: &Slot<T>| slot.occupant.is_none() && slot.generation < u32::MAX;
        let index = self
            .slots
            .iter()
            .position(free)
            .ok_or(AddError::Full { kind: self.kind, capacity: self.slots.len() })?;
        Ok(SlotKey { index: index as u32, generation: self.slots[index].generation })
    }

    /// Puts an occupant under a name that is [`free`](Self::free), or in the place of the one that
    /// bears it.
    pub(crate) fn set(&mut self, name: SlotKey, occupant: T) {
        if let Some(slot) = self.slot(name) {
            slot.occupant = Some(occupant);
        }
    }

    /// The occupant of that name.
    pub(crate) fn get(&self, name: SlotKey) -> Option<&T> {
        let slot = self.slots.get(name.index as usize).filter(|slot| slot.generation == name.generation)?;
        slot.occupant.as_ref()
    }

    /// The occupant of that name, to be changed.
    pub(crate) fn get_mut(&mut self, name: SlotKey) -> Option<&mut T> {
        self.slot(name)?.occupant.as_mut()
    }

    /// All occupants, with their names.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (SlotKey, &T)> {
        self.slots.iter().enumerate().filter_map(|(index, slot)| {
            let name = SlotKey { index: index as u32, generation: slot.generation };
            slot.occupant.as_ref().map(|occupant| (name, occupant))
        })
    }

    /// Empties a place; its name is never given again.
    pub(crate) fn remove(&mut self, name: SlotKey) {
        if let Some(slot) = self.slot(name).filter(|slot| slot.occupant.is_some()) {
            slot.occupant = None;
            slot.generation += 1;
        }
    }

    fn slot(&mut self, name: SlotKey) -> Option<&mut Slot<T>> {
        self.slots.get_mut(name.index as usize).filter(|slot| slot.generation == name.generation)
    }

    /// Lets a place have been used so often already.
    #[cfg(test)]
    pub(crate) fn wear_out(&mut self, index: usize, generation: u32) {
        self.slots[index].generation = generation;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_refused_for_ever_once_its_occupant_is_gone() {
        let mut places = Places::new(1, "bodies");
        let mut names = Vec::new();
        for round in 0..100 {
            let name = places.free().unwrap();
            places.set(name, round);
            assert_eq!(places.get(name), Some(&round));
            places.remove(name);
            names.push(name);
        }
        places.set(places.free().unwrap(), 100);
        assert!(names.iter().all(|&name| places.get(name).is_none()));
        for name in names {
            places.remove(name);
            places.set(name, 7);
        }
        assert_eq!(places.get(SlotKey { index: 0, generation: 101 }), Some(&100));
    }

    #[test]
    fn a_place_used_four_thousand_million_times_is_retired() {
        let mut places = Places::new(2, "bodies");
        places.wear_out(0, u32::MAX - 1);
        let last = places.free().unwrap();
        places.set(last, "last");
        places.remove(last);
        assert_eq!(places.free().unwrap(), SlotKey { index: 1, generation: 1 });
        places.set(places.free().unwrap(), "elsewhere");
        assert!(matches!(places.free(), Err(AddError::Full { kind: "bodies", capacity: 2 })));
        assert!(places.get(last).is_none());
    }
}
