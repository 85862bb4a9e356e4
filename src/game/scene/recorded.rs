//! Recordings: what is reported and edited, kept in memory or streamed to a file.

use super::Scene;
use crate::files::contact_log::{ContactLog, LogEdit, LogSurface, Names};
use crate::game::recording::Recording;
use crate::model::surface::Surface;
use std::io::{self, Write};
use std::sync::atomic::Ordering::Relaxed;

impl Scene {
    /// Records from now on, in memory, what is reported and how the scene is edited (bodies,
    /// surfaces, probes, buses, gains), each with the time at which the engine applies it, so that
    /// [`offline::render`](crate::offline::render) gives the same samples. Ids that `names` does
    /// not name are recorded by number. Recording allocates on the game thread as it grows.
    pub fn start_recording(&mut self, names: &Names) {
        self.recording = Some(Recording::new(names));
    }

    /// Recording written to a file (or whatever else takes bytes) while the game runs, by a thread
    /// of its own.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub fn stream_recording(&mut self, names: &Names, out: impl Write + Send + 'static) -> io::Result<()> {
        self.recording = Some(Recording::stream(names, out)?);
        Ok(())
    }

    /// Ends the recording and hands it over; empty if there was none, or if it was streamed.
    pub fn stop_recording(&mut self) -> ContactLog {
        self.recording.take().map(|recording| recording.end().0).unwrap_or_default()
    }

    /// Ends a streamed recording, waits until it is written, and returns how many lines there are.
    ///
    /// # Errors
    /// When it could not be written.
    pub fn finish_recording(&mut self) -> io::Result<u64> {
        self.recording.take().map_or(Ok(0), |recording| recording.end().1)
    }

    /// Notes an edit, where a recording runs.
    pub(super) fn note(&mut self, edit: impl FnOnce(&Recording) -> LogEdit) {
        let (rate_hz, position) = (self.config.inner_rate_hz(), self.counters.position.load(Relaxed));
        self.settle_recording(position);
        let Some(recording) = &mut self.recording else { return };
        // It is made behind everything that was reported before.
        let edit = edit(recording);
        recording.note_edit(self.clock.last().samples().max(position as f64) / rate_hz, edit);
    }

    /// Keeps what the audio half has come to, at `position`, since the last report.
    pub(super) fn settle_recording(&mut self, position: u64) {
        if let Some(recording) = &mut self.recording {
            recording.settle(position as f64 / self.config.inner_rate_hz(), self.clock.stale_before());
        }
    }

    /// Strikes that wait for their time are dropped, there and here.
    pub(super) fn drop_strikes(&mut self) {
        self.settle_recording(self.counters.position.load(Relaxed));
        if let Some(recording) = &mut self.recording {
            recording.drop_strikes();
        }
        self.clock.let_go();
        self.show_epochs();
    }

    /// Shows the audio half what comes too late.
    pub(super) fn show_epochs(&self) {
        self.counters.epoch.store(self.clock.epoch(), Relaxed);
        self.counters.stale_before.store(self.clock.stale_before(), Relaxed);
    }

    /// Description of a surface for a recording.
    pub(super) fn described(&self, surface: &Surface) -> LogSurface {
        let described = surface.described.as_ref().filter(|_| self.recording.is_some());
        described.and_then(|described| described.downcast_ref::<LogSurface>()).cloned().unwrap_or_default()
    }

    /// Drops here, as there, what the audio half has not come to when game time begins anew.
    pub(super) fn forget_what_waits(&mut self) {
        let time_s = self.counters.position.load(Relaxed) as f64 / self.config.inner_rate_hz();
        if let Some(recording) = &mut self.recording {
            recording.reset(time_s);
        }
    }
}
