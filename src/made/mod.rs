//! Making: from what a scene file or a recording says of bodies, surfaces and actuators to what the
//! engine takes.

pub(crate) mod edit;
mod made_with;
pub(crate) mod maker;
pub(crate) mod maps;
pub(crate) mod source;
