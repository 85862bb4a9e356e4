//! `asperity render`.
pub mod picture;
