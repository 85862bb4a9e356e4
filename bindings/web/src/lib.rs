//! asperity as WebAssembly: one engine an instance, called by plain exports, without a generator of
//! bindings.
//!
//! | file | what JavaScript does with it |
//! |---|---|
//! | [`exchange`] | hands over bytes (the inbox), takes answers (the outbox) |
//! | [`files`] | puts files and decoded pictures where scenes find them |
//! | [`session`] | opens a scene, changes it, closes it |
//! | [`events`] | reports what touches what |
//! | [`blocks`] | renders, and looks at the contacts while they are rendered |
//! | [`record`] | takes the contact log of what was reported |
//! | [`ports`] | two levels for motors that rumble, the picture of a surface that changes |
//!
//! Everything lies in the instance's linear memory, and nothing of it in a global or a table: a
//! copy of the memory is a copy of the engine. So a worker prepares an engine and the audio thread,
//! which may not wait, takes it over by copying bytes.
//!
//! A call that can fail answers 1 when it is done and 0 when it is not; then the outbox holds a
//! sentence that says what is wrong and what would be right. Exported functions are safe whatever
//! they are given.

// What is exported keeps its name.
#![allow(unsafe_code)]

pub mod blocks;
pub mod events;
pub mod exchange;
pub mod files;
mod open_ports;
pub mod ports;
pub mod record;
pub mod session;
