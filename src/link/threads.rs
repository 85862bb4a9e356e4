//! Threads and atomics of the standard library, named in one place: `tests/models` compiles what is
//! shared between threads with those of a model checker instead.

pub(crate) use std::sync::{Arc, atomic};

/// Needs of threads that wait for one another.
pub(crate) mod waiting {
    pub(crate) use crossbeam_queue::ArrayQueue;
    pub(crate) use std::hint::spin_loop;
    pub(crate) use std::thread::{Builder, JoinHandle, park, yield_now};

    /// Number of looks of an idle thread before it sleeps: some 30–100 µs, longer than from the
    /// last job of a block to the first of the next where blocks are rendered one after the other.
    pub(crate) const LOOKS: u32 = 2048;
}
