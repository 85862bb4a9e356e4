//! The modal bank against closed forms, against figures of scipy, and against its own reference.

mod culling;
mod inputs;
mod made;
mod states;
mod waves;
