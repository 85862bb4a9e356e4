//! File formats that the engine reads and writes; no other room names them.

pub mod actuator_profile;
pub mod contact_log;
mod file_error;
pub mod scene_file;
pub mod wav;

pub use file_error::FileError;
