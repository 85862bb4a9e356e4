//! Tools that the program and the bindings share beside the engine: whole tasks of research,
//! offline.
//!
//! [`abx`] and [`compare`] ask a machine which of two surfaces a stroke was on; [`modes_file`]
//! turns a solved shape into a file that the engine opens; [`silence`] says what a render lost and
//! why an output of it is silent.

pub mod abx;
pub mod compare;
pub mod modes_file;
pub mod silence;
