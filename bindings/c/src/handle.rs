//! Handle table: what a C program holds is a number, never an address, so that every wrong one can
//! be told.
//!
//! ```text
//! handle = (generation xor copy) · 2¹³ + place · 2³ + kind        place < 1024, kind 1…6
//! ```
//!
//! A place's generation grows each time it is used again, so a handle that was freed never names
//! what came after it. `copy` follows from where the table lies: where a library is loaded from two
//! files, the handles of one are none of the other's. One word a place says who may use it; it is
//! taken by a single compare-and-swap, by the audio thread as well: nobody ever waits for it.

use crate::status::{ASP_BAD_HANDLE, ASP_BUSY, ASP_FULL, ASP_PANIC, Failure};
use std::cell::UnsafeCell;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::*};
use std::time::{Duration, Instant};

/// Most handles of a kind.
pub(crate) const PLACES: usize = 1024;
const KIND_BITS: u32 = 3;
const PLACE_BITS: u32 = 10;
const PHASE_BITS: u32 = 2;
/// Bits of a generation: as many as fit into a pointer of 32 bits.
const GENERATION_BITS: u32 = 19;
const GENERATIONS: u64 = 1 << GENERATION_BITS;
/// Time for which freeing waits for another thread to come out of its call.
const PATIENCE: Duration = Duration::from_secs(2);

/// Phase of a place: the lowest bits of its word; the others are its generation.
mod phase {
    pub(super) const FREE: u64 = 0;
    pub(super) const IDLE: u64 = 1;
    pub(super) const IN_USE: u64 = 2;
    pub(super) const POISONED: u64 = 3;
}

struct Slot<T> {
    word: AtomicU64,
    /// The generation that somebody waits to free, 0 = none: nobody else begins a call with it, or
    /// threads without pause would keep it for ever.
    closing: AtomicU64,
    value: UnsafeCell<Option<Box<T>>>,
}

/// Every handle of one kind.
pub(crate) struct Table<T> {
    kind: usize,
    name: &'static str,
    slots: [Slot<T>; PLACES],
    /// First place where a free one is looked for, so that places are used in turn.
    next: AtomicUsize,
}

// SAFETY: a value is touched only by whoever has swapped its word from IDLE, POISONED or FREE to
// IN_USE, and until he swaps it back.
unsafe impl<T: Send> Sync for Table<T> {}

/// The right to use what a handle names.
pub(crate) struct Held<'a, T> {
    slot: &'a Slot<T>,
    generation: u64,
}

impl<T: Send> Table<T> {
    pub(crate) const fn new(kind: usize, name: &'static str) -> Self {
        let slots = [const {
            Slot {
                word: AtomicU64::new(phase::FREE),
                closing: AtomicU64::new(0),
                value: UnsafeCell::new(None),
            }
        }; PLACES];
        Self { kind, name, slots, next: AtomicUsize::new(0) }
    }

    /// A number of this copy of the library: two lie at different pages.
    fn copy(&self) -> u64 {
        let page = std::ptr::from_ref(self).addr() as u64 >> 12;
        page.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (u64::BITS - GENERATION_BITS)
    }

    fn fail(&self, status: i32, what: &str, right: &str) -> Failure {
        Failure::new(status, format!("{}: {what}; {right}", self.name))
    }

    /// Gives a value a handle.
    pub(crate) fn insert(&self, value: T) -> Result<usize, Failure> {
        let first = self.next.fetch_add(1, Relaxed);
        for index in (0..PLACES).map(|offset| (first + offset) % PLACES) {
            let slot = &self.slots[index];
            let word = slot.word.load(Relaxed);
            if word & 3 != phase::FREE {
                continue;
            }
            let generation = ((word >> PHASE_BITS) + 1) % GENERATIONS;
            // 0 is no generation, so that a handle is never null.
            let generation = generation.max(1);
            let taken = generation << PHASE_BITS | phase::IN_USE;
            if slot.word.compare_exchange(word, taken, Acquire, Relaxed).is_err() {
                continue;
            }
            // SAFETY: the word is ours.
            unsafe { *slot.value.get() = Some(Box::new(value)) };
            slot.word.store(generation << PHASE_BITS | phase::IDLE, Release);
            let marked = (generation ^ self.copy()) as usize;
            return Ok(marked << (PLACE_BITS + KIND_BITS) | index << KIND_BITS | self.kind);
        }
        Err(self.fail(ASP_FULL, "all 1024 handles are taken", "free those that are no longer needed"))
    }

    /// The place and the generation of a handle, if it is one of this table's.
    fn place(&self, handle: usize) -> Option<(usize, u64)> {
        let index = handle >> KIND_BITS & (PLACES - 1);
        let generation = (handle >> (PLACE_BITS + KIND_BITS)) as u64 ^ self.copy();
        (handle & 7 == self.kind && (1..GENERATIONS).contains(&generation)).then_some((index, generation))
    }

    /// The place of a handle, a small number that another program part can hold; see `hold_at`.
    pub(crate) fn index(&self, handle: usize) -> Option<usize> {
        self.place(handle).map(|(index, _)| index)
    }

    /// Takes what a handle names, unless somebody else has it. It neither waits nor allocates; the
    /// reason is a phase, for `hold` to put into words.
    pub(crate) fn try_hold(&self, handle: usize) -> Result<Held<'_, T>, Option<u64>> {
        let (index, generation) = self.place(handle).ok_or(None)?;
        self.begin(index, generation)
    }

    /// Holds whatever is at a place now.
    pub(crate) fn hold_at(&self, index: usize) -> Option<Held<'_, T>> {
        let generation = self.slots.get(index)?.word.load(Relaxed) >> PHASE_BITS;
        self.begin(index, generation).ok()
    }

    /// Begins a call, unless it is being freed.
    fn begin(&self, index: usize, generation: u64) -> Result<Held<'_, T>, Option<u64>> {
        if generation != 0 && self.slots[index].closing.load(Relaxed) == generation {
            return Err(Some(phase::IN_USE));
        }
        self.swap(index, generation, phase::IDLE)
    }

    fn swap(&self, index: usize, generation: u64, from: u64) -> Result<Held<'_, T>, Option<u64>> {
        let slot = &self.slots[index];
        let (old, new) = (generation << PHASE_BITS | from, generation << PHASE_BITS | phase::IN_USE);
        match slot.word.compare_exchange(old, new, Acquire, Relaxed) {
            Ok(_) => Ok(Held { slot, generation }),
            Err(word) if word >> PHASE_BITS == generation && word & 3 != phase::FREE => Err(Some(word & 3)),
            Err(_) => Err(None),
        }
    }

    fn refusal(&self, why: Option<u64>) -> Failure {
        match why {
            Some(phase::POISONED) => self.fail(
                ASP_PANIC,
                "is silent since a fault in an earlier call",
                "free it, and build another one",
            ),
            Some(_) => self.fail(
                ASP_BUSY,
                "another thread is inside a call with it",
                "let one thread at a time use a handle",
            ),
            None => self.fail(
                ASP_BAD_HANDLE,
                "is no handle of this kind, or was freed",
                "give one that this library made and nobody freed",
            ),
        }
    }

    /// Takes what a handle names, or says why not.
    pub(crate) fn hold(&self, handle: usize) -> Result<Held<'_, T>, Failure> {
        self.try_hold(handle).map_err(|why| self.refusal(why))
    }

    /// Takes the value out for good. Waits, for a while, until no other thread is inside a call
    /// with it.
    pub(crate) fn remove(&self, handle: usize) -> Result<Box<T>, Failure> {
        let (index, generation) = self.place(handle).ok_or(None).map_err(|why| self.refusal(why))?;
        let slot = &self.slots[index];
        if slot.word.load(Relaxed) >> PHASE_BITS == generation {
            slot.closing.store(generation, Relaxed);
        }
        let removed = self.wait_and_take(index, generation);
        // Of a later generation it is somebody else's by now.
        let _ = slot.closing.compare_exchange(generation, 0, Relaxed, Relaxed);
        removed
    }

    fn wait_and_take(&self, index: usize, generation: u64) -> Result<Box<T>, Failure> {
        let began = Instant::now();
        loop {
            let idle = self.swap(index, generation, phase::IDLE);
            let held = idle.or_else(|_| self.swap(index, generation, phase::POISONED));
            match held {
                Ok(held) => {
                    // SAFETY: the word is ours.
                    let value = unsafe { (*held.slot.value.get()).take() };
                    held.slot.word.store(generation << PHASE_BITS | phase::FREE, Release);
                    std::mem::forget(held);
                    return value.ok_or(None).map_err(|why| self.refusal(why));
                }
                Err(Some(_)) if began.elapsed() < PATIENCE => std::thread::yield_now(),
                Err(why) => return Err(self.refusal(why)),
            }
        }
    }
}

impl<T> Deref for Held<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        // SAFETY: the word is ours until `drop`; a place that is not FREE holds a value.
        unsafe { (*self.slot.value.get()).as_deref().unwrap_unchecked() }
    }
}

impl<T> DerefMut for Held<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        // SAFETY: as above.
        unsafe { (*self.slot.value.get()).as_deref_mut().unwrap_unchecked() }
    }
}

impl<T> Drop for Held<'_, T> {
    fn drop(&mut self) {
        let next = if std::thread::panicking() { phase::POISONED } else { phase::IDLE };
        self.slot.word.store(self.generation << PHASE_BITS | next, Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entry::enter;

    #[test]
    fn a_freed_handle_never_names_what_came_after_it() {
        static TABLE: Table<u32> = Table::new(1, "number");
        let mut stale = Vec::new();
        for round in 0..5000u32 {
            let handle = TABLE.insert(round).unwrap();
            assert_ne!(handle, 0);
            assert_eq!(*TABLE.hold(handle).unwrap(), round);
            assert_eq!(*TABLE.remove(handle).unwrap(), round);
            stale.push(handle);
        }
        let handle = TABLE.insert(7).unwrap();
        for old in stale {
            assert_eq!(TABLE.hold(old).err().unwrap().status, ASP_BAD_HANDLE);
            assert_eq!(TABLE.remove(old).err().unwrap().status, ASP_BAD_HANDLE);
        }
        for wrong in [0, 1, usize::MAX, handle + 1, handle ^ 8] {
            assert_eq!(TABLE.hold(wrong).err().unwrap().status, ASP_BAD_HANDLE, "{wrong:#x}");
        }
    }

    #[test]
    fn a_handle_has_one_caller_and_is_poisoned_by_a_panic() {
        static TABLE: Table<u32> = Table::new(2, "number");
        let handle = TABLE.insert(1).unwrap();
        {
            let _held = TABLE.hold(handle).unwrap();
            assert_eq!(TABLE.hold(handle).err().unwrap().status, ASP_BUSY);
        }
        let status = enter(|| {
            let _held = TABLE.hold(handle)?;
            panic!("a fault");
        });
        assert_eq!(status, ASP_PANIC);
        assert_eq!(TABLE.hold(handle).err().unwrap().status, ASP_PANIC);
        assert!(TABLE.hold_at(TABLE.index(handle).unwrap()).is_none());
        assert_eq!(*TABLE.remove(handle).unwrap(), 1);
    }

    #[test]
    fn a_handle_is_freed_however_busy_others_are_with_it() {
        static TABLE: Table<u32> = Table::new(2, "number");
        let handle = TABLE.insert(1).unwrap();
        let users: Vec<_> = (0..3)
            .map(|_| {
                std::thread::spawn(move || {
                    while !matches!(TABLE.try_hold(handle), Err(None)) {
                        std::hint::spin_loop();
                    }
                })
            })
            .collect();
        std::thread::sleep(Duration::from_millis(5));
        assert_eq!(*TABLE.remove(handle).unwrap(), 1);
        users.into_iter().for_each(|user| user.join().unwrap());
    }

    #[test]
    fn a_handle_of_another_table_is_unknown_to_this_one() {
        static ONE: Table<u32> = Table::new(1, "number");
        static OTHER: Table<u32> = Table::new(1, "number");
        let (one, other) = (ONE.insert(1).unwrap(), OTHER.insert(2).unwrap());
        assert_eq!(OTHER.hold(one).err().unwrap().status, ASP_BAD_HANDLE);
        assert_eq!(ONE.remove(other).err().unwrap().status, ASP_BAD_HANDLE);
        assert_eq!((*ONE.hold(one).unwrap(), *OTHER.hold(other).unwrap()), (1, 2));
    }

    #[test]
    fn the_table_says_when_it_is_full() {
        static TABLE: Table<u8> = Table::new(3, "byte");
        let all: Vec<_> = (0..PLACES).map(|_| TABLE.insert(0).unwrap()).collect();
        assert_eq!(TABLE.insert(0).unwrap_err().status, ASP_FULL);
        TABLE.remove(all[500]).unwrap();
        assert!(TABLE.insert(0).is_ok());
    }
}
