//! Sound format: the container and codec a file declares, and the reason why bytes are no sound.

/// Most channels of a file.
pub(crate) const MOST_CHANNELS: usize = 64;

/// Format of a file's sound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Format {
    pub(crate) channels: usize,
    pub(crate) rate_hz: f64,
    /// Size of a quantisation step; 0 where samples are no integers.
    pub(crate) quantum: f64,
    /// Frames that are said to be there; as many as can be where nothing is said.
    pub(crate) frames: u64,
}

/// Why bytes are no sound.
pub(crate) enum Refusal {
    /// Codec that cannot be decoded.
    Not(String),
    /// Message of the system.
    Io(std::io::Error),
}

impl From<std::io::Error> for Refusal {
    fn from(error: std::io::Error) -> Self {
        Self::Io(error)
    }
}
