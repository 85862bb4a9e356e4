//! Destination of the sound and the vibration.

/// The output, chosen when the plugin is added.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Output {
    /// Silent output for tests and servers. Paced by `Time<Real>` of the app, without a thread and
    /// without sleeping.
    Null {
        /// Keeps rendered samples in [`NullOutput`](crate::NullOutput); it grows by 4 bytes a
        /// channel and sample.
        keep: bool,
    },
    /// A sound card through cpal: haptic channels on channels of their own, or on a device of their
    /// own.
    #[cfg(feature = "device")]
    Device(asperity::live::device::DeviceOptions),
    /// A node of `bevy_seedling`'s graph: see [`seedling`](crate::seedling).
    #[cfg(feature = "seedling")]
    Seedling,
}

impl Default for Output {
    fn default() -> Self {
        Self::Null { keep: false }
    }
}
