//! A bounded queue in the place of `crossbeam-queue`'s, whose own atomics a model checker does not
//! see.
//!
//! Its content is handed over under a lock; whether it is empty is read from a relaxed counter,
//! which promises less than the real one does. A helper that is not woken because of that is one
//! that the pool's own fences do not hold.

use loom::sync::Mutex;
use loom::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::collections::VecDeque;

pub(crate) struct ArrayQueue<T> {
    items: Mutex<VecDeque<T>>,
    len: AtomicUsize,
    capacity: usize,
}

impl<T> ArrayQueue<T> {
    pub(crate) fn new(capacity: usize) -> Self {
        Self { items: Mutex::new(VecDeque::new()), len: AtomicUsize::new(0), capacity }
    }

    pub(crate) fn capacity(&self) -> usize {
        self.capacity
    }

    pub(crate) fn push(&self, item: T) -> Result<(), T> {
        let mut items = self.items.lock().unwrap();
        if items.len() == self.capacity {
            return Err(item);
        }
        items.push_back(item);
        self.len.fetch_add(1, Relaxed);
        Ok(())
    }

    pub(crate) fn pop(&self) -> Option<T> {
        // Without the lock where there is nothing: looking orders nothing, as the real queue's does
        // not.
        if self.is_empty() {
            return None;
        }
        let mut items = self.items.lock().unwrap();
        let item = items.pop_front()?;
        self.len.fetch_sub(1, Relaxed);
        Some(item)
    }

    pub(crate) fn len(&self) -> usize {
        self.len.load(Relaxed)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
