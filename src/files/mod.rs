//! What is read from files and written to them; no other room names their formats.

pub mod actuator_profile;
pub mod contact_log;
pub mod wav;
