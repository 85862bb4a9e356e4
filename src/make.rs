//! Makers: from entries of a scene file or a recording to the bodies, surfaces and actuators that
//! the engine takes.

pub(crate) mod edit;
mod loader;
pub(crate) mod maker;
pub(crate) mod maps;
pub(crate) mod source;
