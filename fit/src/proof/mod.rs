//! Warnings: what is to be said against partials.

pub mod suspicion;
pub mod warning;
