//! What is done with modes afterwards: size, material, tables, several strikes.

pub mod merge;
pub mod scaling;
pub mod table;
