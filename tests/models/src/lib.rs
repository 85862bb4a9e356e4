//! The ring that other threads read and the pool that renders in parallel, under every schedule of
//! a model checker; with `cfg(thread_sanitizer)` on the machine's own threads, under that.
#![cfg(test)]

#[cfg(thread_sanitizer)]
mod on_threads;

#[cfg(thread_sanitizer)]
extern crate self as asperity_surface;
#[cfg(thread_sanitizer)]
#[path = "../../../surface/src/exclusive.rs"]
pub mod exclusive;

#[cfg(thread_sanitizer)]
#[path = "on_threads/link.rs"]
mod link;

#[cfg(not(thread_sanitizer))]
mod link {
    /// The checker's atomics and threads, under the names of the engine's own `link/threads.rs`.
    pub(crate) mod threads {
        pub(crate) use loom::sync::{Arc, atomic};

        /// A thread that waits.
        pub(crate) mod waiting {
            pub(crate) use crate::queue::ArrayQueue;
            pub(crate) use loom::hint::spin_loop;
            pub(crate) use loom::thread::{Builder, JoinHandle, park, yield_now};

            /// A helper sleeps at once: the checker tries every moment for it.
            pub(crate) const LOOKS: u32 = 0;
        }
    }
}

#[path = "../../../src/link/overwriting.rs"]
#[allow(dead_code, reason = "compiled for what the models use")]
mod overwriting;
#[path = "../../../src/audio/pool.rs"]
#[allow(dead_code, reason = "as above")]
mod pool;
#[cfg(not(thread_sanitizer))]
mod pool_model;
#[cfg(not(thread_sanitizer))]
mod queue;
#[cfg(not(thread_sanitizer))]
mod ring_model;

/// Most schedules of a model: a pool of threads has more than anybody waits for.
#[cfg(not(thread_sanitizer))]
const MOST: usize = 20_000;

/// Tries every schedule with at most so many preemptions, or the first [`MOST`] of them; returns
/// how many there were.
#[cfg(not(thread_sanitizer))]
fn schedules(preemptions: usize, model: impl Fn() + Sync + Send + 'static) -> usize {
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
    let count = std::sync::Arc::new(AtomicUsize::new(0));
    let counted = count.clone();
    let mut checker = loom::model::Builder::new();
    checker.preemption_bound = Some(preemptions);
    checker.max_permutations = Some(MOST);
    checker.max_branches = 5_000;
    checker.check(move || {
        counted.fetch_add(1, Relaxed);
        model();
    });
    count.load(Relaxed)
}
