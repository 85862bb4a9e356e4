//! The tests of meshes and their modes, in one program.

mod block;
mod bodies;
mod common;
mod hostile;
mod msh;
mod reports;
mod unwrap;
