//! The C interface: every function of `asperity.h`, a handful of flat structs, six kinds of
//! handles.
//!
//! | rule | how it is kept |
//! |---|---|
//! | a handle that is stale, foreign, in use elsewhere or poisoned is told so | `handle`: handles are numbers in a table, never addresses |
//! | structs may grow | `sized`: each begins with its own size, and `asp_…_init` writes it |
//! | errors are a status and a sentence, the engine's own | `status` |
//! | a panic never leaves, and its handle is silent from then on | `entry` |
//! | nothing fallible, no memory, no lock on the audio thread | `render`, `port` |
//!
//! Pointers must be null or point to what their type says, for as long as the call lasts (strings
//! end with a zero byte, arrays have the count that is given beside them). Everything else may be
//! wrong, and is answered.

// This is the one crate that hands out raw pointers; the promise that makes every call sound is the
// one above.
#![allow(unsafe_code)]
#![allow(clippy::missing_safety_doc, reason = "the promise is the same for every function, and stands above")]
#![allow(non_camel_case_types, reason = "C names")]

pub mod body;
pub mod clip;
pub mod config;
mod entry;
pub mod event;
pub mod files;
mod handle;
pub mod handles;
mod image;
pub mod levels;
pub mod load;
pub mod log;
pub mod material;
pub mod pairs;
pub mod pickup;
pub mod player;
mod playing;
pub mod port;
pub mod probe;
pub mod record;
pub mod render;
pub mod report;
mod sized;
pub mod stats;
pub mod status;
pub mod surface;
mod text;
pub mod tip;
pub mod unity;
pub mod version;
