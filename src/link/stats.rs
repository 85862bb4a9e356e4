//! Statistics of both halves, readable from the game thread at any moment.

use crate::link::tickets::Tickets;
use crate::model::bus::BusLevels;
use std::ops::AddAssign;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

macro_rules! counters {
    ($($(#[doc = $doc:literal])+ $name:ident),+ $(,)?) => {
        /// Counts since the engine was built.
        #[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
        pub struct Stats {
            $($(#[doc = $doc])+ pub $name: u64,)+
            /// Share of the time budget that the last blocks took, by the device; 0
            /// offline.
            pub load: f32,
            /// Peak level of each audio bus.
            pub bus_levels: BusLevels,
        }

        /// The cells behind [`Stats`]; each has one writer, nobody waits.
        #[derive(Debug, Default)]
        pub(crate) struct Counters {
            $(pub(crate) $name: AtomicU64,)+
            load_bits: AtomicU32,
            /// Peak level of each audio bus.
            pub(crate) bus_peak_bits: Box<[AtomicU32]>,
            /// By how much the peak limiters of buses, and of haptic channels, have turned down at
            /// most, whole dB.
            pub(crate) limiters_db: [AtomicU64; 2],
            /// Resets that the game half has asked for.
            pub(crate) resets_asked: AtomicU64,
            /// The game clock's epoch: what was stamped in an earlier one is due at once.
            pub(crate) epoch: AtomicU64,
            /// Strikes of an epoch before this have come too late.
            pub(crate) stale_before: AtomicU64,
            /// Strikes that have a name.
            pub(crate) tickets: Tickets,
        }

        impl Counters {
            /// All at zero, for so many audio buses.
            pub(crate) fn new(buses: usize) -> Self {
                Self { bus_peak_bits: (0..buses).map(|_| AtomicU32::new(0)).collect(), ..Self::default() }
            }

            pub(crate) fn snapshot(&self) -> Stats {
                let mut bus_levels = BusLevels { buses: self.bus_peak_bits.len(), ..BusLevels::default() };
                for (peak, cell) in bus_levels.peaks.iter_mut().zip(&self.bus_peak_bits) {
                    *peak = f32::from_bits(cell.load(Relaxed));
                }
                Stats {
                    bus_levels,
                    $($name: self.$name.load(Relaxed),)+
                    load: f32::from_bits(self.load_bits.load(Relaxed)),
                }
            }
        }
    };
}

counters! {
    /// Samples rendered so far.
    position,
    /// Events applied by the audio half.
    events,
    /// Impacts among them.
    impacts,
    /// Impacts so soft or heavy that their contact would outlast 0.17 s; it lasts 0.17 s.
    shortened,
    /// Micro-collisions on something so soft that they would outlast 0.04 s; they last 0.04 s.
    shortened_collisions,
    /// Onsets of contact found by the micro-contact model.
    micro_collisions,
    /// Blows of a probe that had left the ground: contact forces beyond thirty times what pressed,
    /// or flights off a crest that its leash has ended.
    blows,
    /// Contacts that would have rubbed a body that another one rubs already, a count for each 64
    /// samples: one at a time sticks and slips.
    rubs_crowded_out,
    /// Events handed back because the queue was full.
    dropped,
    /// Moves that a newer event of the same contact made pointless before they were sent.
    superseded,
    /// Events that named a contact nobody began, or whose voice was stolen.
    orphaned,
    /// Contacts silenced because a more important one needed the voice.
    stolen,
    /// Landings right after a lift-off of the same contact at the same place, taken as one contact.
    debounced,
    /// Contacts faded because nothing was heard of them for the time-out.
    lapsed,
    /// Contacts that were suddenly elsewhere, or further away after a silence than a path makes up
    /// within a second: faded where they were, risen where they are.
    jumps,
    /// Reports of no force: the first in a row holds the force before it, more fade the contact
    /// until it presses again.
    unpressed,
    /// Events refused on the game side: bad numbers, unknown names, time running backwards.
    refused,
    /// Reports with a force, speed, mass or radius beyond what the models reach, which counted as
    /// the limit.
    held,
    /// Contacts reset on the audio half after their numbers went bad.
    quarantined,
    /// Events that arrived after the sample they were stamped for.
    late,
    /// Impacts dropped because audio stood still when they were reported, and more than 0.1 s had
    /// gone by when it went on, or game time was tied to it anew before the turn of several; or
    /// because a reset, a pause or a fade of everything came before their turn.
    stale,
    /// Impacts dropped because they came sooner after one that was as strong than the least time of
    /// their body ([`Body::least_time_s`](crate::Body::least_time_s)).
    too_soon,
    /// Clips that were not played because 32 played already.
    clips_dropped,
    /// Strikes with a name that were reported again after they had sounded, or as they wait: each
    /// sounds once.
    repeated,
    /// Strikes with a name that were withdrawn, or replaced by a newer report, before their time.
    withdrawn,
    /// Bodies that were removed or replaced and faded before they had rung out, because more than
    /// 64 of them rang.
    given_way,
    /// Times the game clock was tied to the audio clock anew: pauses, restarts, stamps that were
    /// off.
    clock_jumps,
    /// Times the game was found to run at another pace: slow motion, fast motion, back to its own.
    clock_paces,
    /// Lead of the latest event's stamp over the audio, samples. Live, more than some blocks' worth
    /// says why it is silent: game and audio are not tied ([`Config::live`](crate::Config::live)).
    ahead,
    /// By how much the peak limiters have turned down at most, whole dB.
    limiter_db,
    /// Pieces of work left out because blocks ran late: a group of modes for 64 samples, or a
    /// contact.
    shed,
    /// Contacts sounding now.
    contacts,
}

/// Counts of a contact in a stretch.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Counts {
    pub(crate) collisions: u64,
    /// Collisions that would have lasted longer.
    pub(crate) shortened: u64,
    /// States that were no longer finite and begun anew.
    pub(crate) resets: u64,
    /// Contact forces beyond thirty times what pressed, and flights that a leash has ended.
    pub(crate) blows: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, more: Self) {
        self.collisions += more.collisions;
        self.shortened += more.shortened;
        self.resets += more.resets;
        self.blows += more.blows;
    }
}

impl Counters {
    /// Adds what contacts have counted.
    pub(crate) fn count(&self, Counts { collisions, shortened, resets, blows }: Counts) {
        Self::add(&self.micro_collisions, collisions);
        Self::add(&self.shortened_collisions, shortened);
        Self::add(&self.quarantined, resets);
        Self::add(&self.blows, blows);
    }

    pub(crate) fn add(cell: &AtomicU64, count: u64) {
        // Each cell has a single writer, so a plain read-modify-write loses nothing; it is atomic
        // so that readers never see half a number.
        cell.store(cell.load(Relaxed).wrapping_add(count), Relaxed);
    }

    pub(crate) fn set_load(&self, load: f32) {
        self.load_bits.store(load.to_bits(), Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_contacts_count_adds_up_each_in_its_own_place() {
        let mut counts = Counts { collisions: 1, shortened: 2, resets: 3, blows: 4 };
        counts += Counts { collisions: 10, shortened: 20, resets: 30, blows: 40 };
        let counters = Counters::new(2);
        counters.count(counts);
        counters.count(counts);
        Counters::add(&counters.events, 7);
        counters.set_load(0.25);
        counters.bus_peak_bits[1].store(0.5f32.to_bits(), Relaxed);
        let counted = counters.snapshot();
        let contacts = [
            counted.micro_collisions,
            counted.shortened_collisions,
            counted.quarantined,
            counted.blows,
            counted.events,
        ];
        assert_eq!((contacts, counted.load), ([22, 44, 66, 88, 7], 0.25));
        assert_eq!((counted.bus_levels.buses, &counted.bus_levels.peaks[..2]), (2, &[0.0, 0.5][..]));
    }
}
