//! Player behind a handle.

use crate::status::{ASP_REFUSED, Failure};
use asperity::live::null_sink::NullSink;

/// Player behind a handle.
pub(crate) struct Player {
    playing: Playing,
    /// The process that has its thread.
    process: u32,
}

impl Player {
    pub(crate) fn new(playing: Playing) -> Self {
        Self { playing, process: std::process::id() }
    }

    pub(crate) fn playing(&self) -> &Playing {
        &self.playing
    }

    /// Takes out what is to be stopped; in a child of fork there is no thread that would end.
    pub(crate) fn into_playing(self) -> Result<Playing, Failure> {
        if self.process == std::process::id() {
            return Ok(self.playing);
        }
        std::mem::forget(self.playing);
        let what = "player: its thread has stayed with the parent process";
        Err(Failure::new(ASP_REFUSED, format!("{what}; stop it there, and play anew here")))
    }
}

/// Who plays.
pub(crate) enum Playing {
    /// A sound card; without the feature there is none.
    #[cfg(feature = "device")]
    Device(asperity::live::device::Player),
    /// No device: the paced null sink.
    Silent { sink: NullSink, block_frames: usize, rate_hz: f64 },
}
