//! Record: what was reported, as a contact log, each event at the time at which the engine applies
//! it.

use crate::exchange::{answer, done};
use crate::session;

/// Records from now on.
#[unsafe(no_mangle)]
pub extern "C" fn asp_record_start() -> u32 {
    done(session::with(|session| {
        session.scene.start_recording(&session.names);
        Ok(())
    }))
}

/// Ends the recording. Outbox: the log, JSON Lines.
#[unsafe(no_mangle)]
pub extern "C" fn asp_record_stop() -> u32 {
    done(session::with(|session| {
        let mut lines = Vec::new();
        session.scene.stop_recording().write(&mut lines).map_err(|error| error.to_string())?;
        answer(lines);
        Ok(())
    }))
}
