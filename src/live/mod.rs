//! Real-time outputs: sound cards, a paced device that nobody hears, and which signal goes to which
//! channel.

pub mod channel_map;
#[cfg(feature = "device")]
pub mod device;
pub mod drift;
pub mod null_sink;
pub mod ports;
