//! The only ways across between the two threads.

pub(crate) mod message;
pub(crate) mod outlet;
pub(crate) mod overwriting;
pub(crate) mod ring;
pub(crate) mod stats;
pub(crate) mod tap;
pub(crate) mod threads;
pub(crate) mod tickets;
