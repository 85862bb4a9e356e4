//! The only way across between the two threads.

pub(crate) mod message;
pub(crate) mod ring;
pub(crate) mod stats;
