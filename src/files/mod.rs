//! What is read from files and written to them; no other room names their formats.

pub mod actuator_profile;
pub mod contact_log;
mod file_error;
pub mod scene_file;
pub mod wav;

pub use file_error::FileError;
