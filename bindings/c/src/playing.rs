//! What a player's handle names.

use asperity::live::null_sink::NullSink;

/// What a player's handle names.
pub(crate) enum Playing {
    /// A sound card; without the feature there is none.
    #[cfg(feature = "device")]
    Device(asperity::live::device::Player),
    /// Nobody.
    Silent { sink: NullSink, block_frames: usize, rate_hz: f64 },
}
