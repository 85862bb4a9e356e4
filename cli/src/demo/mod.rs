//! `asperity demo`.
pub mod plates;
pub mod strokes;
