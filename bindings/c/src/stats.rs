//! Statistics: what the engine did so far, and why it is silent or too loud.

use crate::entry::{array_mut, enter};
use crate::handles::{SCENES, asp_scene};
use crate::sized::{self, sized};
use crate::status::{ASP_BAD_ARGUMENT, Failure};
use crate::text;
use asperity::Scene;
use std::ffi::c_char;
use std::mem::offset_of;

/// Counts since the engine was built; `asp_stats_init` fills in the size.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_stats {
    /// Size of this struct, bytes.
    pub struct_size: u32,
    /// Share of the time budget that the last blocks took, as told by `asp_report_load`.
    pub load: f32,
    /// Samples rendered.
    pub position: u64,
    /// Events applied by the audio half.
    pub events: u64,
    /// Impacts among them.
    pub impacts: u64,
    /// Impacts whose contact would outlast 0.17 s and was shortened.
    pub shortened: u64,
    /// Micro-collisions that would outlast 0.04 s and were shortened.
    pub shortened_collisions: u64,
    /// Onsets of contact found by the micro-contact model.
    pub micro_collisions: u64,
    /// Blows of a probe that had left the ground, and flights from a crest that its leash ended.
    pub blows: u64,
    /// Events handed back because the queue was full.
    pub dropped: u64,
    /// Moves that a newer event made pointless before they were sent.
    pub superseded: u64,
    /// Events that named a contact nobody began, or whose voice was stolen.
    pub orphaned: u64,
    /// Contacts silenced because a more important one needed the voice.
    pub stolen: u64,
    /// Landings right after a lift-off at the same place, taken as one contact.
    pub debounced: u64,
    /// Contacts faded because nothing was heard of them.
    pub lapsed: u64,
    /// Contacts that were suddenly elsewhere.
    pub jumps: u64,
    /// Reports of no force.
    pub unpressed: u64,
    /// Events refused: bad numbers, unknown ids, time running backwards.
    pub refused: u64,
    /// Contacts reset on the audio half after their numbers went bad.
    pub quarantined: u64,
    /// Events that arrived after the sample they were stamped for.
    pub late: u64,
    /// Times the game clock was tied to the audio clock anew.
    pub clock_jumps: u64,
    /// Times the game was found to run at another pace.
    pub clock_paces: u64,
    /// Lead of the latest event's stamp over the audio, samples.
    pub ahead: u64,
    /// Pieces of work left out because blocks ran late.
    pub shed: u64,
    /// Contacts sounding now.
    pub contacts: u64,
    /// By how much the peak limiters have turned down at most, whole dB. (Since 0.1.1.)
    pub limiter_db: u64,
    /// Contacts that would have rubbed a body that another one rubs already, a count for each 64
    /// samples. (Since 0.1.1.)
    pub rubs_crowded_out: u64,
    /// Reports beyond what the models reach, which counted as the limit. (Since 0.1.3.)
    pub held: u64,
    /// Impacts dropped because audio stood still when they were reported. (Since 0.1.3.)
    pub stale: u64,
    /// Impacts dropped because they came within `least_time_s` of their body. (Since 0.1.3.)
    pub too_soon: u64,
    /// Bodies that were removed and faded before they had rung out. (Since 0.1.3.)
    pub given_way: u64,
}

sized!(asp_stats, [offset_of!(asp_stats, limiter_db), offset_of!(asp_stats, held)]);

impl asp_stats {
    fn of(stats: &asperity::Stats) -> Self {
        Self {
            load: stats.load,
            position: stats.position,
            events: stats.events,
            impacts: stats.impacts,
            shortened: stats.shortened,
            shortened_collisions: stats.shortened_collisions,
            micro_collisions: stats.micro_collisions,
            blows: stats.blows,
            dropped: stats.dropped,
            superseded: stats.superseded,
            orphaned: stats.orphaned,
            stolen: stats.stolen,
            debounced: stats.debounced,
            lapsed: stats.lapsed,
            jumps: stats.jumps,
            unpressed: stats.unpressed,
            refused: stats.refused,
            quarantined: stats.quarantined,
            late: stats.late,
            clock_jumps: stats.clock_jumps,
            clock_paces: stats.clock_paces,
            ahead: stats.ahead,
            shed: stats.shed,
            contacts: stats.contacts,
            limiter_db: stats.limiter_db,
            rubs_crowded_out: stats.rubs_crowded_out,
            held: stats.held,
            stale: stats.stale,
            too_soon: stats.too_soon,
            given_way: stats.given_way,
            ..sized::Sized32::initial()
        }
    }
}

/// Most characters of a text that is asked for.
const MAX_TEXT: usize = 1 << 20;

/// Fills statistics of `size` bytes, sizeof(asp_stats), with that size. A size that never was fills
/// nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_init_stats(stats: *mut asp_stats, size: u32) {
    sized::init_as(stats, size);
}

/// Fills the shorter statistics of programs that were compiled with 0.1.0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_stats_init(stats: *mut asp_stats) {
    sized::init_as(stats, <asp_stats as sized::Sized32>::SHIPPED[0]);
}

/// Statistics of the engine so far.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_get_stats(scene: *mut asp_scene, stats: *mut asp_stats) -> i32 {
    enter(|| sized::write(&asp_stats::of(&SCENES.hold(scene as usize)?.scene.stats()), stats, "stats"))
}

/// Peak level of each bus as a meter shows it, linear; buses beyond those of the scene are 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_bus_peaks(scene: *mut asp_scene, peaks: *mut f32, count: u32) -> i32 {
    enter(|| {
        let peaks = array_mut(peaks, count as usize, crate::config::ASP_MAX_BUSES as usize, "peaks")?;
        let levels = SCENES.hold(scene as usize)?.scene.stats().bus_levels;
        for (bus, peak) in peaks.iter_mut().enumerate() {
            *peak = levels.get(bus).copied().unwrap_or(0.0);
        }
        Ok(())
    })
}

/// Reasons against anything being heard or felt, a line a reason, the likeliest first; "" when
/// nothing does. `size` is the room in `reasons`, bytes; what does not fit is cut.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_why_silent(scene: *mut asp_scene, reasons: *mut c_char, size: u32) -> i32 {
    written(scene, reasons, size, |scene| scene.why_silent().iter().map(ToString::to_string).collect())
}

/// Bodies and surfaces that leave more than full scale holds, by how much, and what to turn: a line
/// a reason, the loudest first; "" when nothing does. It renders a reference strike where one is
/// not known yet. `size` is the room in `reasons`, bytes; what does not fit is cut. (Since 0.1.4.)
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_why_clipped(scene: *mut asp_scene, reasons: *mut c_char, size: u32) -> i32 {
    written(scene, reasons, size, |scene| scene.why_clipped().iter().map(ToString::to_string).collect())
}

/// Copies reasons, a line each.
fn written(
    scene: *mut asp_scene,
    reasons: *mut c_char,
    size: u32,
    why: impl FnOnce(&mut Scene) -> Vec<String>,
) -> i32 {
    enter(|| {
        if size == 0 {
            return Err(Failure::new(
                ASP_BAD_ARGUMENT,
                "size: 0 is refused; give some room, 1000 for instance",
            ));
        }
        let room = array_mut(reasons.cast::<u8>(), size as usize, MAX_TEXT, "reasons")?;
        room[0] = 0;
        text::copy(&why(&mut SCENES.hold(scene as usize)?.scene).join("\n"), room);
        Ok(())
    })
}

/// Frees what the audio half no longer needs; adding and replacing do it too. `freed` (may be NULL)
/// is how many things.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_collect(scene: *mut asp_scene, freed: *mut u32) -> i32 {
    enter(|| {
        let count = SCENES.hold(scene as usize)?.scene.collect();
        if !freed.is_null() {
            *crate::entry::out(freed, "freed")? = count as u32;
        }
        Ok(())
    })
}
