//! Strikes with a name, for games that predict and roll back: reported again, each still sounds
//! once, and one that did not happen after all is withdrawn while it waits.

use super::Scene;
use crate::link::stats::Counters;
use crate::link::tickets::AT_ONCE;
use crate::model::error::{Refusal, ReportError};
use crate::model::event::{ContactEvent, Impact};
use std::collections::{HashMap, VecDeque};

/// Strikes whose names are kept.
#[derive(Default)]
pub(super) struct Named {
    /// Ticket of each, and what was reported.
    known: HashMap<u64, (u32, f64, Impact)>,
    /// Names by age.
    order: VecDeque<(u64, u32)>,
    last: u32,
}

impl Scene {
    /// Reports a strike under a name that the game makes of what happened (tick and pair, for
    /// instance), at game time `time_s`, which may lie before what was reported already: a game
    /// that has rolled back reports its ticks again. It sounds once: reported again after it has
    /// sounded, nothing happens ([`Stats::repeated`](crate::Stats::repeated)); while it waits, the
    /// newer report counts. A name is kept for the next 1024 named strikes. A strike that is due in
    /// the past sounds at once.
    ///
    /// ```
    /// use asperity::{Body, Config, Engine, Impact, Material, Stock};
    ///
    /// let Engine { mut scene, .. } = Config::live(48_000.0).build()?;
    /// let bell = scene.add_body(Body::stock(Stock::Bowl, Material::BRASS, 0.1)?)?;
    /// let (tick, pair) = (120u64, 7u64);
    /// scene.report_named(2.0, tick << 32 | pair, Impact::on(bell))?;
    /// // Rolled back, and the pair did not meet: it had not sounded yet.
    /// assert!(scene.withdraw(tick << 32 | pair));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`report`](Self::report); a full queue also where 1024 named strikes wait.
    #[expect(clippy::result_large_err, reason = "as of `report`")]
    pub fn report_named(&mut self, time_s: f64, name: u64, impact: Impact) -> Result<(), ReportError> {
        if let Some((ticket, then_s, earlier)) = self.named.known.get(&name).copied() {
            let is_same = (then_s, earlier) == (time_s, impact);
            if is_same || !self.take_back(ticket) {
                Counters::add(&self.counters.repeated, 1);
                return Ok(());
            }
        }
        let ticket = self.named.last.wrapping_add(1).max(1);
        let event = ContactEvent::Impact(impact);
        if !self.counters.tickets.is_free(ticket) {
            Counters::add(&self.counters.dropped, 1);
            return Err(ReportError { event, reason: Refusal::QueueFull });
        }
        self.report_with(time_s, event, ticket)?;
        self.named.note(name, (ticket, time_s, impact));
        Ok(())
    }

    /// Takes a strike with a name back. True: it waited, and does not sound; false: it has sounded
    /// already, or is not known.
    pub fn withdraw(&mut self, name: u64) -> bool {
        let Some((ticket, ..)) = self.named.known.get(&name) else { return false };
        let waited = self.take_back(*ticket);
        if waited {
            self.named.known.remove(&name);
        }
        waited
    }

    fn take_back(&mut self, ticket: u32) -> bool {
        let waited = self.counters.tickets.withdraw(ticket);
        if waited && let Some(recording) = &mut self.recording {
            recording.withdraw(ticket);
        }
        waited
    }
}

impl Named {
    fn note(&mut self, name: u64, is: (u32, f64, Impact)) {
        self.last = is.0;
        self.known.insert(name, is);
        self.order.push_back((name, is.0));
        if self.order.len() > AT_ONCE
            && let Some((oldest, ticket)) = self.order.pop_front()
            && self.known.get(&oldest).is_some_and(|known| known.0 == ticket)
        {
            self.known.remove(&oldest);
        }
    }
}
