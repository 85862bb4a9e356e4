//! An exclusive cell: touched by its owner only, shared by reference all the same.
//!
//! An end of a ring must not be used from two threads at once. Behind a shared reference nobody can
//! reach it here at all, so a thing that holds one may live where only shareable things may (a
//! resource of an engine, a static). With an exclusive reference it is reached without a lock:
//! [`Mutex::get_mut`] takes none.

use std::sync::{Mutex, PoisonError};

/// A value that can be reached through an exclusive reference only.
#[derive(Debug, Default)]
pub struct Exclusive<T>(Mutex<T>);

impl<T> Exclusive<T> {
    /// Holds a value.
    pub fn new(value: T) -> Self {
        Self(Mutex::new(value))
    }

    /// The value. Nothing is locked and nobody waits.
    pub fn get_mut(&mut self) -> &mut T {
        // It is never locked, so it is never poisoned.
        self.0.get_mut().unwrap_or_else(PoisonError::into_inner)
    }
}
