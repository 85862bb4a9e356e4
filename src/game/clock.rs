//! Game seconds → absolute sample index.
//!
//! Offline, a stamp `t` is the point t · rate between two samples. Live, the game clock and the
//! audio clock are two clocks: the first event is tied to the sample that is rendered next, and
//! later stamps keep their distance to it, because jitter of arrival must not become jitter of
//! motion (using arrival times raises the velocity ripple from 3.4 % to 12 %). Within a device
//! block the audio position stands still while game time goes on, so the mapping follows the
//! *smallest* lead: a stamp that comes up to 2 ms after its sample moves the mapping at once, one
//! that comes later keeps its stamp (the path reckons on from it) and moves the mapping a little,
//! and early stamps let it creep back. What else games do with their time is in the table of the
//! module `live`.

mod live;

use crate::model::clock_mode::ClockMode;
use crate::model::stamp::Stamp;
use live::{BREAK_S, Followed, Live};
use std::collections::VecDeque;

/// An impact that was reported longer ago while audio stood still is not played, s.
const STALE_S: f64 = 0.1;
/// Strikes that are known to wait: two are several.
const MOST_WAITING: usize = 64;
/// Distance from what was played last to what is reported when game time is tied back: as though
/// twenty strikes a second went on, s.
const AFTER_TIE_S: f64 = 0.05;
/// A game time mapped to the audio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stamped {
    pub(crate) stamp: Stamp,
    /// The game's clock was tied to the audio's anew.
    pub(crate) jumped: bool,
    /// The game was found to run at another pace.
    pub(crate) repaced: bool,
}

/// The mapping's memory.
#[derive(Debug, Clone)]
pub(crate) struct Clock {
    sample_rate_hz: f64,
    mapping: Mapping,
    last: Stamp,
    epoch: u64,
    stale_before: u64,
    stands: Stands,
    /// Stamps of strikes that wait, or that the audio has just come to.
    waiting: VecDeque<Stamp>,
    /// Game time of the newest report, s, and where the audio was.
    newest: (f64, f64),
    /// Game time of the newest strike, s, and the sample that it sounds at.
    struck: Option<(f64, f64)>,
}

/// Place of the audio, and since when.
#[derive(Debug, Clone, Copy)]
struct Stands {
    position: u64,
    /// Game time of the first report there; infinite before it.
    since_s: f64,
    /// It has stood there for longer than any block.
    long: bool,
}

#[derive(Debug, Clone)]
enum Mapping {
    /// Sample of game time 0, none = the next stamp holds at the next sample; game seconds a second
    /// of audio.
    Exact(Option<f64>, f64),
    Live(Live),
}

impl Clock {
    pub(crate) fn new(mode: ClockMode, sample_rate_hz: f64) -> Self {
        let mapping = match mode {
            ClockMode::Exact => Mapping::Exact(Some(0.0), 1.0),
            ClockMode::Live { max_lead_s } => Mapping::Live(Live::new(max_lead_s, sample_rate_hz)),
        };
        Self {
            sample_rate_hz,
            mapping,
            last: Stamp::default(),
            epoch: 0,
            stale_before: 0,
            stands: Stands::UNKNOWN,
            waiting: VecDeque::with_capacity(MOST_WAITING),
            newest: (0.0, 0.0),
            struck: None,
        }
    }

    /// Clock at another rate; a live one ties itself anew.
    pub(crate) fn at_rate(&mut self, sample_rate_hz: f64) {
        let ratio = sample_rate_hz / self.sample_rate_hz;
        match &mut self.mapping {
            Mapping::Exact(zero, _) => *zero = zero.map(|zero| zero * ratio),
            Mapping::Live(live) => live.at_rate(sample_rate_hz),
        }
        let there = |stamp: Stamp| Stamp::at(stamp.samples() * ratio);
        self.waiting.iter_mut().for_each(|stamp| *stamp = there(*stamp));
        self.struck = None;
        (self.sample_rate_hz, self.last) = (sample_rate_hz, there(self.last));
    }

    /// The newest stamp.
    pub(crate) fn last(&self) -> Stamp {
        self.last
    }

    /// It counts on whenever game time is tied back: what was stamped in an earlier epoch is due.
    pub(crate) fn epoch(&self) -> u64 {
        self.epoch
    }

    /// Strikes of an epoch before this have come too late.
    pub(crate) fn stale_before(&self) -> u64 {
        self.stale_before
    }

    /// Notes that what was stamped before has come too late.
    pub(crate) fn let_go(&mut self) {
        self.epoch += 1;
        self.stale_before = self.epoch;
        self.waiting.clear();
        self.struck = None;
    }

    /// Notes that a strike is sent.
    pub(crate) fn note_strike(&mut self, stamp: Stamp) {
        if self.is_live() && self.waiting.back() != Some(&stamp) && self.waiting.len() < MOST_WAITING {
            self.waiting.push_back(stamp);
        }
        let (time_s, position) = self.newest;
        self.struck = Some((time_s, stamp.samples().max(position)));
    }

    /// Tests whether game time may run backwards.
    pub(crate) fn is_live(&self) -> bool {
        matches!(self.mapping, Mapping::Live(_))
    }

    /// Game seconds a second of audio: 1 unless a live game runs in slow motion or fast.
    pub(crate) fn pace(&self) -> f64 {
        match &self.mapping {
            Mapping::Exact(_, pace) => *pace,
            Mapping::Live(live) => live.pace(),
        }
    }

    /// From game time `since_s` on, the game runs at another pace; a live clock finds out by
    /// itself.
    pub(crate) fn set_pace(&mut self, pace: f64, since_s: f64) {
        if let Mapping::Exact(zero, old) = &mut self.mapping {
            // The moment at which the pace changes stays where it is.
            let samples = since_s * self.sample_rate_hz;
            *zero = zero.map(|zero| zero + samples / *old - samples / pace);
            *old = pace;
        }
    }

    /// Sample of a game time as things stand; nothing follows from asking.
    pub(crate) fn sample_at(&self, time_s: f64) -> f64 {
        match &self.mapping {
            Mapping::Exact(zero, pace) => time_s / pace * self.sample_rate_hz + zero.unwrap_or(0.0),
            Mapping::Live(live) => live.sample_at(time_s).unwrap_or_else(|| self.last.samples()),
        }
    }

    /// Game time of the newest report, s.
    pub(crate) fn newest_s(&self) -> f64 {
        self.newest.0
    }

    /// Stamp of a game time before the newest, from a game that has gone back: the mapping stays
    /// what it is.
    pub(crate) fn stamp_back(&mut self, time_s: f64) -> Stamped {
        self.last = Stamp::at(self.sample_at(time_s)).max(self.last);
        Stamped { stamp: self.last, jumped: false, repaced: false }
    }

    /// From now on: the next stamp holds at the next sample, `position`.
    pub(crate) fn reset(&mut self, position: u64) {
        match &mut self.mapping {
            Mapping::Exact(zero, _) => *zero = None,
            Mapping::Live(live) => live.untie(),
        }
        (self.last, self.stands) = (Stamp::whole(position), Stands::UNKNOWN);
    }

    /// Notes that game time is tied back, and whether strikes that wait have come too late: one
    /// sounds at once, of several only a bang would be heard.
    fn tie_back(&mut self, stale: bool) {
        if stale {
            self.let_go();
        } else {
            self.epoch += 1;
        }
    }

    /// Sample that a strike due at `sample` is moved to, so that a game that catches up after a
    /// hitch does not throw two strikes onto one; none where they are apart.
    fn kept_apart(&self, time_s: f64, sample: f64, position: f64) -> Option<f64> {
        let (before_s, sounds) = self.struck?;
        let apart_s = ((time_s - before_s) / self.pace()).min(AFTER_TIE_S);
        let apart = apart_s * self.sample_rate_hz;
        (sample.max(position) - sounds < 0.5 * apart).then_some(sounds + apart)
    }

    /// Sample of a game time, never before an earlier one; `position` is the next sample that the
    /// audio half will render, and strikes keep their distance from each other.
    pub(crate) fn stamp(&mut self, time_s: f64, position: u64, strikes: bool) -> Stamped {
        self.newest = (time_s, position as f64);
        let target = time_s / self.pace() * self.sample_rate_hz;
        let mut followed = match &mut self.mapping {
            Mapping::Exact(zero, _) => {
                let zero = *zero.get_or_insert(position as f64 - target);
                Followed { sample: target + zero, jumped: false, repaced: false }
            }
            Mapping::Live(live) => {
                let stands = self.stands.look(time_s, position);
                let untied = live.is_untied();
                let followed = live.follow(time_s, position as f64);
                let apart = AFTER_TIE_S * self.sample_rate_hz;
                self.waiting.retain(|stamp| stamp.samples() + apart >= position as f64);
                let back = (followed.jumped || untied) && Stamp::at(followed.sample) < self.last;
                if stands || back && !self.waiting.is_empty() {
                    let sample = position as f64 + apart;
                    live.tie(time_s, sample, stands);
                    self.tie_back(stands || self.waiting.len() > 1);
                    Followed { sample, jumped: true, ..followed }
                } else {
                    if back {
                        self.tie_back(false);
                        self.last = Stamp::at(followed.sample);
                    }
                    followed
                }
            }
        };
        if strikes
            && let Some(sample) = self.kept_apart(time_s, followed.sample, position as f64)
            && let Mapping::Live(live) = &mut self.mapping
        {
            live.tie(time_s, sample, false);
            (followed.sample, followed.jumped) = (sample, true);
        }
        let Followed { sample, jumped, repaced } = followed;
        if jumped {
            // Stamps already sent may lie ahead of the audio; events must stay in order.
            self.last = self.last.min(Stamp::at(sample));
        }
        self.last = Stamp::at(sample).max(self.last);
        Stamped { stamp: self.last, jumped, repaced }
    }
}

impl Stands {
    const UNKNOWN: Self = Self { position: 0, since_s: f64::INFINITY, long: false };

    /// Notes where the audio stands at a report, and returns whether game time is to be tied anew:
    /// once it has stood for longer than any block, then again and again.
    fn look(&mut self, time_s: f64, position: u64) -> bool {
        let goes_on = position != self.position;
        let limit_s = if self.long { STALE_S } else { BREAK_S };
        let anew = !goes_on && time_s - self.since_s > limit_s;
        if goes_on || anew || time_s < self.since_s {
            *self = Self { position, since_s: time_s, long: anew || self.long && !goes_on };
        }
        anew
    }
}

#[cfg(test)]
mod tests;
