//! Contact logs: what a game reported, read into the structs that `asp_report` takes.

use crate::entry::{aligned, array_mut, enter, out};
use crate::event::asp_event;
use crate::handles::{SCENES, asp_scene};
use crate::sized::{self, Sized32};
use crate::status::{ASP_BAD_ARGUMENT, ASP_FILE, ASP_UNKNOWN, Failure};
use crate::text;
use asperity::files::contact_log::{ContactLog, LogError, LogEvent};
use std::ffi::c_char;

/// Reads the text of a contact log (JSON Lines; docs/formats/log.md) into `events` and `times_s`,
/// both of `capacity`, with the ids that the scene's names stand for. `count` is how many events
/// the log holds: call once with a capacity of 0 to learn it. `size` is sizeof(asp_event). A log
/// that holds edits of a scene, or motions of bodies, is refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_read_log(
    scene: *mut asp_scene,
    text: *const c_char,
    events: *mut asp_event,
    times_s: *mut f64,
    capacity: u32,
    size: u32,
    count: *mut u32,
) -> i32 {
    enter(|| {
        let (text, count) = (text::needed(text, "text")?, out(count, "count")?);
        *count = 0;
        if !asp_event::SHIPPED.contains(&size) {
            let right = format!("give sizeof(asp_event), {} in this library", size_of::<asp_event>());
            return Err(Failure::new(ASP_BAD_ARGUMENT, format!("size: {size} is refused; {right}")));
        }
        let log = ContactLog::parse(text, "log").map_err(|error| Failure::new(ASP_FILE, error))?;
        let room = log.lines.len().min(capacity as usize);
        if room > 0 {
            aligned(events, "events")?;
        }
        let times_s = array_mut(times_s, room, usize::MAX, "times_s")?;
        let half = SCENES.hold(scene as usize)?;
        let unknown = |error: LogError| Failure::new(ASP_UNKNOWN, error.in_text(text, "log"));
        log.check_names(&half.names).map_err(unknown)?;
        for (index, line) in log.lines.iter().enumerate() {
            if matches!(line.event, LogEvent::Edit(_) | LogEvent::Motion { .. }) {
                let right = "replay it with `asperity render`";
                let what = format!(
                    "log: line {} edits the scene or moves a body, which no event can say",
                    index + 1
                );
                return Err(Failure::new(ASP_FILE, format!("{what}; {right}")));
            }
            let event = line.event.resolve(&half.names).map_err(|error| Failure::new(ASP_UNKNOWN, error))?;
            if index < room {
                // An older program's events are shorter.
                let place = events.wrapping_byte_add(index * size as usize);
                sized::put(&asp_event::of(&event), place, size);
                times_s[index] = line.t;
            }
        }
        *count = log.lines.len() as u32;
        Ok(())
    })
}
