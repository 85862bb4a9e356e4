//! Files of the engine as they are.

#[path = "../../../../src/link/ring.rs"]
#[allow(dead_code, reason = "compiled for what the tests use")]
pub(crate) mod ring;
#[path = "../../../../src/link/threads.rs"]
pub(crate) mod threads;
