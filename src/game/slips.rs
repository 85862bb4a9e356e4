//! Slips of a game that no single report shows: times that stand, forces in another unit, and a
//! blow at every step.
//!
//! Each is counted over reports that follow each other; what is found stands among the reasons of
//! [`Scene::why_silent`](crate::Scene::why_silent).

use crate::model::event::{ContactEvent, ContactId, ContactSample};
use crate::model::id::BodyId;
use std::collections::HashMap;

/// Fewer reports of a kind are no habit.
const LEAST_REPORTS: u64 = 20;
/// Greater force is no fingertip's, nor that of a light tool in the hand, N.
const HEAVY_N: f64 = 100.0;
/// Reports of a light probe of which one may press less, where the others press too hard.
const REPORTS_A_LIGHT_ONE: u64 = 10;
/// Blows in a row that are no drum roll, at every step of a game that has so many a second.
const BLOWS_IN_A_ROW: u64 = 30;
/// Longest step between them, s.
const LONGEST_STEP_S: f64 = 0.025;
/// Steps of one game differ by a smaller factor.
const ALIKE: f64 = 1.6;
/// Contacts, and bodies, kept at most beside those of the last [`KEPT_S`].
/// Less than half of the 1,792 that a table of 2,048 places holds: with more it would double once
/// its places have been used up by what is gone.
const MOST_KEPT: usize = 800;
/// Time for which a contact or body without a report is kept where there are many, s.
const KEPT_S: f64 = 1.0;

/// Reports that follow each other.
#[derive(Debug, Default)]
pub(crate) struct Slips {
    /// Time of the first report, s, and whether a later one had another.
    first_s: Option<f64>,
    goes_on: bool,
    /// Reports of something new at the time of the report before.
    at_once: u64,
    contacts: HashMap<ContactId, Touch>,
    pressed: Pressed,
    blows: HashMap<BodyId, Blows>,
    in_a_row: u64,
}

/// Newest report of a contact.
#[derive(Debug, Clone, Copy)]
struct Touch {
    time_s: f64,
    uv: [f64; 2],
    is_light: bool,
}

/// Forces of light probes.
#[derive(Debug, Default)]
struct Pressed {
    reports: u64,
    heavy: u64,
    sum_n: f64,
}

/// Newest blows on a body.
#[derive(Debug, Clone, Copy)]
struct Blows {
    time_s: f64,
    step_s: f64,
    /// Blows at that time, and at the time before.
    count: [u64; 2],
    in_a_row: u64,
}

impl Slips {
    /// Notes an event at game time; `is_light` says whether the probe of a contact that begins is
    /// a finger or a light tool.
    pub(crate) fn note(&mut self, time_s: f64, event: &ContactEvent, is_light: bool) {
        self.goes_on |= *self.first_s.get_or_insert(time_s) != time_s;
        // Bodies come and go by the thousand, and contacts end with them.
        if self.contacts.len() > MOST_KEPT {
            self.contacts.retain(|_, touch| (time_s - touch.time_s).abs() < KEPT_S);
        }
        if self.blows.len() > MOST_KEPT {
            self.blows.retain(|_, blows| (time_s - blows.time_s).abs() < KEPT_S);
        }
        match event {
            ContactEvent::Begin { contact, sample, .. } => {
                self.contacts.insert(*contact, Touch { time_s, uv: sample.uv, is_light });
                self.pressed.note(sample, is_light);
            }
            ContactEvent::Moved { contact, sample, .. } => {
                if let Some(touch) = self.contacts.get_mut(contact) {
                    self.at_once += u64::from(touch.time_s == time_s && touch.uv != sample.uv);
                    (touch.time_s, touch.uv) = (time_s, sample.uv);
                    self.pressed.note(sample, touch.is_light);
                }
            }
            ContactEvent::Motion { .. } => {}
            ContactEvent::End { contact } => {
                self.contacts.remove(contact);
            }
            ContactEvent::Impact(impact) => {
                let blows = self.blows.entry(impact.body);
                let blows = blows.and_modify(|blows| blows.note(time_s)).or_insert(Blows {
                    time_s,
                    step_s: 0.0,
                    count: [1, 0],
                    in_a_row: 0,
                });
                self.at_once += u64::from(blows.count[0] > 1);
                self.in_a_row = self.in_a_row.max(blows.in_a_row);
            }
        }
    }

    /// Reports of something new at the only time that came, and that time, s; none where time
    /// goes on.
    pub(crate) fn stands(&self) -> Option<(u64, f64)> {
        let at_s = self.first_s.filter(|_| !self.goes_on && self.at_once >= LEAST_REPORTS);
        at_s.map(|at_s| (self.at_once, at_s))
    }

    /// Reports in which a light probe presses too hard, and their mean, N; none where it is not
    /// nearly all of them.
    pub(crate) fn too_hard(&self) -> Option<(u64, f64)> {
        let Pressed { reports, heavy, sum_n } = self.pressed;
        let is_habit = heavy >= LEAST_REPORTS && (reports - heavy) * REPORTS_A_LIGHT_ONE <= reports;
        is_habit.then(|| (heavy, sum_n / heavy as f64))
    }

    /// Most blows in a row on one body, one at every step; none where that is no habit.
    pub(crate) fn at_every_step(&self) -> Option<u64> {
        (self.in_a_row >= BLOWS_IN_A_ROW).then_some(self.in_a_row)
    }
}

impl Pressed {
    fn note(&mut self, sample: &ContactSample, is_light: bool) {
        if is_light && sample.normal_force_n > 0.0 {
            self.reports += 1;
            if sample.normal_force_n > HEAVY_N {
                self.heavy += 1;
                self.sum_n += sample.normal_force_n;
            }
        }
    }
}

impl Blows {
    fn note(&mut self, time_s: f64) {
        if time_s == self.time_s {
            self.count[0] += 1;
            return;
        }
        let step_s = time_s - self.time_s;
        let is_even =
            |before_s: f64| before_s == 0.0 || libm::log(step_s / before_s).abs() < libm::log(ALIKE);
        let [now, before] = self.count;
        let goes_on = (0.0..LONGEST_STEP_S).contains(&step_s) && is_even(self.step_s);
        let goes_on = goes_on && (before == 0 || now == before);
        self.in_a_row = if goes_on { self.in_a_row.max(1) + 1 } else { 0 };
        (self.time_s, self.step_s, self.count) = (time_s, step_s, [1, now]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::event::Impact;

    #[test]
    fn bodies_that_are_struck_once_and_gone_take_no_memory() {
        let mut slips = Slips::default();
        for n in 0..100_000_u64 {
            let impact = Impact::on(BodyId::from_bits(n << 32));
            slips.note(n as f64 / 60.0, &ContactEvent::Impact(impact), false);
        }
        assert!(
            slips.blows.len() <= MOST_KEPT + 1 && slips.at_every_step().is_none(),
            "{}",
            slips.blows.len()
        );
    }
}
