//! Report: one call a physics step.

use crate::body::refused;
use crate::entry::{aligned, enter, out};
use crate::event::asp_event;
use crate::handles::{SCENES, asp_scene};
use crate::sized;
use crate::status::{ASP_BAD_ARGUMENT, ASP_FULL, ASP_REFUSED, ASP_UNKNOWN, Failure};
use asperity::Refusal;

/// Most events of one call.
pub const ASP_MAX_EVENTS: u32 = 65536;

pub(crate) fn refusal(at: u32, reason: &Refusal) -> Failure {
    let status = match reason {
        Refusal::QueueFull => ASP_FULL,
        Refusal::UnknownSurface
        | Refusal::UnknownBody
        | Refusal::UnknownProbe
        | Refusal::UnknownActuator { .. } => ASP_UNKNOWN,
        _ => ASP_REFUSED,
    };
    Failure::new(status, format!("event {at}: {reason}"))
}

/// Reports what happened at game time `time_s`: `count` events of `size` bytes each
/// (sizeof(asp_event)). All are tried; `taken` (may be NULL) is how many were accepted, and the
/// first refusal is the status. Never blocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_report(
    scene: *mut asp_scene,
    time_s: f64,
    events: *const asp_event,
    count: u32,
    size: u32,
    taken: *mut u32,
) -> i32 {
    enter(|| {
        let mut none = 0;
        let taken = if taken.is_null() { &mut none } else { out(taken, "taken")? };
        *taken = 0;
        if count > ASP_MAX_EVENTS {
            let right = format!("must be at most {ASP_MAX_EVENTS}");
            return Err(Failure::new(ASP_BAD_ARGUMENT, format!("count: {count} is refused; {right}")));
        }
        if count > 0 {
            aligned(events, "events")?;
        }
        if !<asp_event as sized::Sized32>::SHIPPED.contains(&size) {
            let right = format!("give sizeof(asp_event), {} in this library", size_of::<asp_event>());
            return Err(Failure::new(ASP_BAD_ARGUMENT, format!("size: {size} is refused; {right}")));
        }
        let mut half = SCENES.hold(scene as usize)?;
        let mut first = None;
        for at in 0..count {
            let event = events.wrapping_byte_add(at as usize * size as usize);
            let done = sized::read_within(event, size, "event").and_then(|event| event.engines());
            let done = done.and_then(|event| {
                half.scene.report(time_s, event).map_err(|error| refusal(at, &error.reason))
            });
            match done {
                Ok(()) => *taken += 1,
                Err(failure) => drop(first.get_or_insert(failure)),
            }
        }
        first.map_or(Ok(()), Err)
    })
}

/// Game time begins anew: the next report holds at the sample that is rendered next, whatever its
/// time. For a level that restarts, under the exact clock; a live one finds out by itself.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_reset(scene: *mut asp_scene) -> i32 {
    enter(|| SCENES.hold(scene as usize)?.scene.reset().map_err(|error| refused(&error)))
}

/// Sets the game seconds a second of audio, 0.01 to 100, from the last report on; for the exact
/// clock.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_set_time_scale(scene: *mut asp_scene, scale: f64) -> i32 {
    enter(|| SCENES.hold(scene as usize)?.scene.set_time_scale(scale, false).map_err(|error| refused(&error)))
}

/// Sets the game seconds a second of audio, 0.1 to 2, and lets all that is heard and felt bend with
/// it: at 0.5 a bell of 800 Hz rings at 400 Hz, twice as long. For both clocks; 1 ends it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_bend_time(scene: *mut asp_scene, scale: f64) -> i32 {
    enter(|| SCENES.hold(scene as usize)?.scene.set_time_scale(scale, true).map_err(|error| refused(&error)))
}

/// Reports a strike (an event of kind ASP_IMPACT, of `size` bytes) under a name, for games that
/// predict and roll back: reported again, also for a time that has gone by, it still sounds once,
/// and while it waits the newer report counts. Names are kept for the next 1024.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_report_named(
    scene: *mut asp_scene,
    time_s: f64,
    name: u64,
    event: *const asp_event,
    size: u32,
) -> i32 {
    enter(|| {
        let asperity::ContactEvent::Impact(impact) = sized::read_within(event, size, "event")?.engines()?
        else {
            return Err(Failure::new(ASP_BAD_ARGUMENT, "kind: is no strike; must be ASP_IMPACT"));
        };
        let mut half = SCENES.hold(scene as usize)?;
        half.scene.report_named(time_s, name, impact).map_err(|error| refusal(0, &error.reason))
    })
}

/// Takes a strike with a name back: `waited` is 1 where it waited and does not sound, 0 where it
/// has sounded already or is not known.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_withdraw(scene: *mut asp_scene, name: u64, waited: *mut u32) -> i32 {
    enter(|| {
        let waited = out(waited, "waited")?;
        *waited = u32::from(SCENES.hold(scene as usize)?.scene.withdraw(name));
        Ok(())
    })
}
