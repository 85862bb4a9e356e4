//! Part of the program's `export` that other verbs write through.

#[path = "../../../cli/src/export/binary.rs"]
pub mod binary;
