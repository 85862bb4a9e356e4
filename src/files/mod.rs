//! File formats that the engine reads and writes; no other room names them.

pub mod actuator_profile;
mod config_file;
pub mod contact_log;
mod file_error;
pub mod modes_file;
mod nearest;
mod other_file;
pub mod scene_file;
pub mod sensor_profile;
pub(crate) mod shapes_file;
mod shapes_glb;
pub(crate) mod shapes_sidecar;
pub(crate) mod storage;
mod toml_error;
pub mod wav;

pub use file_error::FileError;
pub use nearest::nearest;
pub use storage::{Disk, Files, Memory};
