//! Real-time outputs: sound cards, a paced silent device, and which signal goes to which
//! channel.

pub mod channel_map;
#[cfg(feature = "device")]
pub mod device;
pub mod drift;
pub mod null_sink;
pub mod ports;
