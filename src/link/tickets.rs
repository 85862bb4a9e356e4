//! Strikes with a name: each sounds, or is withdrawn, exactly once, whichever half is first.
//!
//! A strike has a ticket, a number that counts on from 1; its cell, one of [`AT_ONCE`] by turns,
//! holds the ticket and what has become of it. The game half arms it before it sends the strike;
//! when the strike's turn comes the audio half takes it, unless the game half has withdrawn it.

use std::sync::atomic::{AtomicU64, Ordering::AcqRel, Ordering::Acquire, Ordering::Release};

/// Strikes with a name that may wait at the same time.
pub(crate) const AT_ONCE: usize = 1024;

/// States of a ticket.
const WAITS: u64 = 1;
const SOUNDED: u64 = 2;
const WITHDRAWN: u64 = 3;

/// The cells.
#[derive(Debug)]
pub(crate) struct Tickets(Box<[AtomicU64]>);

impl Default for Tickets {
    fn default() -> Self {
        Self((0..AT_ONCE).map(|_| AtomicU64::new(0)).collect())
    }
}

impl Tickets {
    fn cell(&self, ticket: u32) -> (&AtomicU64, u64) {
        (&self.0[ticket as usize % AT_ONCE], u64::from(ticket) << 2)
    }

    /// Tests whether the place of a ticket is free: an older strike no longer waits there.
    pub(crate) fn is_free(&self, ticket: u32) -> bool {
        self.cell(ticket).0.load(Acquire) & 3 != WAITS
    }

    /// Game half: the strike of this ticket is about to be sent.
    pub(crate) fn arm(&self, ticket: u32) {
        let (cell, of) = self.cell(ticket);
        cell.store(of | WAITS, Release);
    }

    /// Game half: takes the strike back. True: it will not sound.
    pub(crate) fn withdraw(&self, ticket: u32) -> bool {
        self.settle(ticket, WITHDRAWN)
    }

    /// Audio half: the turn of a strike has come. True: it sounds; so does one without a ticket, 0.
    pub(crate) fn take(&self, ticket: u32) -> bool {
        ticket == 0 || self.settle(ticket, SOUNDED)
    }

    fn settle(&self, ticket: u32, to: u64) -> bool {
        let (cell, of) = self.cell(ticket);
        cell.compare_exchange(of | WAITS, of | to, AcqRel, Acquire).is_ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn each_strike_sounds_or_is_withdrawn_never_both_and_never_twice() {
        let tickets = Arc::new(Tickets::default());
        let audio = Arc::clone(&tickets);
        (1..=1000).for_each(|ticket| tickets.arm(ticket));
        let thread =
            std::thread::spawn(move || (1..=1000u32).map(|ticket| audio.take(ticket)).collect::<Vec<_>>());
        let withdrawn: Vec<bool> = (1..=1000u32).rev().map(|ticket| tickets.withdraw(ticket)).collect();
        let sounded = thread.join().unwrap();
        for (sounded, withdrawn) in sounded.iter().zip(withdrawn.iter().rev()) {
            assert!(sounded ^ withdrawn);
        }
        assert!(!(1..=1000).any(|ticket| tickets.take(ticket) || tickets.withdraw(ticket)));
        assert!(tickets.take(0));
    }

    #[test]
    fn a_place_is_free_again_once_its_strike_no_longer_waits() {
        let tickets = Tickets::default();
        tickets.arm(5);
        assert!(!tickets.is_free(5 + AT_ONCE as u32) && tickets.is_free(6));
        assert!(tickets.withdraw(5) && tickets.is_free(5 + AT_ONCE as u32));
    }
}
