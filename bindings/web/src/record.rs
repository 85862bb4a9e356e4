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
        answer(session.scene.stop_recording().to_jsonl().into_bytes());
        Ok(())
    }))
}
