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

    /// Stamp of a game time before the newest, told by a game that has gone back: the mapping stays
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

    /// Notes where the audio stands at a report, and tells whether game time is to be tied anew:
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
mod tests {
    use super::*;

    #[test]
    fn offline_a_stamp_is_its_own_sample() {
        let mut clock = Clock::new(ClockMode::Exact, 44_100.0);
        for (t, sample, fraction) in [(0.0, 0, 0.0), (0.0167, 736, 120.0 / 256.0), (1.0, 44_100, 0.0)] {
            let stamp = clock.stamp(t, 0, false).stamp;
            assert_eq!((stamp.sample(), stamp.fraction()), (sample, fraction));
        }
    }

    #[test]
    fn a_stamp_written_as_a_time_is_read_back_as_the_same_stamp() {
        let mut rng = asperity_dsp::rng::Rng::new(5);
        for rate in [22_050.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0] {
            for _ in 0..10_000 {
                let stamp = Stamp::at(1e9 * rng.uniform());
                assert_eq!(
                    Clock::new(ClockMode::Exact, rate).stamp(stamp.samples() / rate, 0, false).stamp,
                    stamp
                );
            }
        }
    }

    #[test]
    fn live_the_first_event_holds_at_the_next_sample() {
        let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
        assert_eq!(
            clock.stamp(1234.5, 960, false),
            Stamped { stamp: Stamp::at(960.0), jumped: false, repaced: false }
        );
    }

    #[test]
    fn live_stamps_keep_their_distance_although_they_arrive_in_bursts() {
        let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
        let first = clock.stamp(10.0, 0, false).stamp.sample();
        // Two physics steps reported together, half a step late.
        let second = clock.stamp(10.0 + 1.0 / 60.0, 1200, false).stamp.sample();
        let third = clock.stamp(10.0 + 2.0 / 60.0, 1200, false).stamp.sample();
        assert!((second - first).abs_diff(800) <= 1);
        assert!((third - second).abs_diff(800) <= 21);
    }

    #[test]
    fn live_a_clock_that_drifts_by_200_ppm_is_followed() {
        let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
        let mut worst = 0.0f64;
        for step in 0..20_000u64 {
            let game_s = step as f64 / 60.0;
            let position = (game_s * 48_000.0 * 1.0002) as u64;
            let lead = clock.stamp(game_s, position, false).stamp.samples() - position as f64;
            worst = worst.max(lead.abs());
        }
        assert!(worst < 48.0, "{worst} samples");
    }

    /// Stamps of 60 game ticks a game second at a pace, reported at 60 frames a second in blocks of
    /// 256 samples.
    fn leads_at_pace(pace: f64, frames: u64) -> (Clock, Vec<f64>, usize) {
        let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
        let mut jumps = 0;
        let leads = (0..frames)
            .map(|frame| {
                let position = frame * 800 / 256 * 256;
                let stamped = clock.stamp(7.0 + pace * frame as f64 / 60.0, position, false);
                jumps += usize::from(stamped.jumped);
                stamped.stamp.samples() - position as f64
            })
            .collect();
        (clock, leads, jumps)
    }

    #[test]
    fn live_slow_motion_and_fast_motion_are_followed_within_two_seconds() {
        for pace in [0.25, 0.5, 1.0, 2.0, 3.0] {
            let (clock, leads, jumps) = leads_at_pace(pace, 600);
            assert!((clock.pace() / pace - 1.0).abs() < 0.06, "{pace}: {}", clock.pace());
            let late = leads[150..].iter().fold(0.0f64, |worst, lead| worst.max(lead.abs()));
            assert!(late < 0.06 * 48_000.0, "{pace}: {late} samples off");
            assert!(jumps <= 12, "{pace}: {jumps} jumps");
        }
    }

    #[test]
    fn live_eight_ticks_at_once_keep_their_distance_and_tie_nothing_anew() {
        let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
        let mut last = 0.0;
        for tick in 0..800u64 {
            let position = (tick / 8 * 8 * 800) / 256 * 256;
            let stamped = clock.stamp(tick as f64 / 60.0, position, false);
            let now = stamped.stamp.samples();
            assert!(!stamped.jumped && !stamped.repaced, "tick {tick}");
            assert!(tick == 0 || (now - last - 800.0).abs() < 260.0, "tick {tick}: {}", now - last);
            last = now;
        }
    }

    #[test]
    fn after_a_reset_the_next_stamp_holds_at_the_next_sample_and_the_rest_exactly() {
        let mut clock = Clock::new(ClockMode::Exact, 48_000.0);
        clock.stamp(100.0, 0, false);
        clock.reset(9_600);
        assert_eq!(clock.stamp(0.0, 9_600, false).stamp, Stamp::whole(9_600));
        assert_eq!(clock.stamp(0.5, 9_728, false).stamp, Stamp::whole(33_600));
    }

    #[test]
    fn live_strikes_that_come_late_and_at_once_keep_their_distance() {
        let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
        for tick in 0..60u64 {
            clock.stamp(tick as f64 / 60.0, tick * 800, false);
        }
        // Three ticks late, and all at once.
        let at = |clock: &mut Clock, tick: u64| {
            let stamp = clock.stamp(tick as f64 / 60.0, 50_400, true).stamp;
            clock.note_strike(stamp);
            stamp.samples().max(50_400.0)
        };
        let sounds = [60, 62, 63].map(|tick| at(&mut clock, tick));
        assert!(sounds[0] == 50_400.0 && (sounds[1] - sounds[0] - 1600.0).abs() < 1.0, "{sounds:?}");
        assert!((sounds[2] - sounds[1] - 800.0).abs() < 1.0, "{sounds:?}");
    }

    #[test]
    fn live_a_game_that_stalls_or_skips_is_tied_anew_and_stays_in_order() {
        let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
        clock.stamp(0.0, 0, false);
        let tied = |sample| Stamped { stamp: Stamp::at(sample), jumped: true, repaced: false };
        assert_eq!(clock.stamp(0.01, 96_000, false), tied(96_000.0));
        assert_eq!(clock.stamp(500.0, 96_064, false), tied(96_064.0));
        assert_eq!(clock.stamp(0.0, 96_128, false), tied(96_128.0));
    }
}
