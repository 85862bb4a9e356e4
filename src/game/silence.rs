//! Why nothing is heard or felt: what the game half sees of it, in words.
//!
//! Nothing that is refused, lost or left out stops a game, so a mistake of its own shows as
//! silence. [`Scene::why_silent`](crate::Scene::why_silent) answers with what speaks against sound,
//! the likeliest reason first. It reads counters only and can be asked at any time, of a scene that
//! sounds as well.

use crate::game::contradiction::Contradiction;
use crate::game::slips::Slips;
use crate::link::stats::Stats;
use crate::model::config::Config;
use crate::model::error::Refusal;
use crate::model::event::{ContactEvent, ContactSample};
use crate::model::stamp::Stamp;
use crate::resource::bank::LONGEST_CONTACT_S;

/// Events this far ahead of what is rendered wait longer than any clock's window, s.
const FAR_AHEAD_S: f64 = 0.25;

/// A limiter that turns down by more is reported, dB.
const LIMITED_DB: u64 = 12;

/// A reason why less is heard or felt than was reported. Its text says what would be right.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SilenceReason {
    /// The audio half has rendered nothing yet.
    #[error("nothing was rendered; call Renderer::render from the audio callback")]
    NothingRendered,
    /// No event was accepted, and none refused.
    #[error("no event was reported; report a \"begin\" and moves, or an \"impact\"")]
    NothingReported,
    /// Events were handed back for what they say.
    #[error("{count} of {of} events were refused, the last because of {last}")]
    Refused {
        /// Number.
        count: u64,
        /// Number of reported ones.
        of: u64,
        /// Why the last one was.
        last: Refusal,
    },
    /// Events found no room in the queue.
    #[error(
        "{count} events were dropped because the queue was full; report less often, render more often, \
         or raise Config::queue_capacity"
    )]
    Dropped {
        /// Number.
        count: u64,
    },
    /// The game's clock runs ahead of the audio's.
    #[error(
        "the newest event is stamped {ahead_s:.1} s ahead of what is rendered, and waits; stamp events with the \
         time that has been rendered, or let the clock follow the device (Config::clock = ClockMode::LIVE)"
    )]
    AheadOfAudio {
        /// By how much, s.
        ahead_s: f64,
    },
    /// Events spoke of contacts that do not exist.
    #[error(
        "{count} events named a contact that had not begun, whose surface is gone, or whose voice was stolen; \
         report its \"begin\" first, under the same number"
    )]
    Orphaned {
        /// Number.
        count: u64,
    },
    /// Contacts faded because their moves stayed away.
    #[error(
        "{count} contacts faded because nothing was reported of them for {timeout_s} s; report a move of every \
         contact more often than that, with times in seconds, or raise Config::contact_timeout_s"
    )]
    Lapsed {
        /// Number of times.
        count: u64,
        /// [`Config::contact_timeout_s`].
        timeout_s: f64,
    },
    /// Contacts gave their voices to others.
    #[error(
        "{count} contacts were silenced because more than {limit} sounded at once; report an \"end\" for those that \
         are over, or raise Config::max_contacts"
    )]
    Stolen {
        /// Number of times.
        count: u64,
        /// [`Config::max_contacts`].
        limit: usize,
    },
    /// Numbers went bad on the audio half.
    #[error(
        "{count} samples or changes were quarantined: heights more than 20 m from zero, forces beyond 1e4 N, or a change of \
         another kind of surface; check relief_m, normal_force_n, and what change_surface was given"
    )]
    Quarantined {
        /// Number.
        count: u64,
    },
    /// Reports beyond what the models reach counted as their limits.
    #[error(
        "{count} events reported a force above 1e4 N, a speed above 100 m/s or a mass above 1e4 kg, which counted as that; a game whose \
         unit is the centimetre has to report metres"
    )]
    Held {
        /// Number.
        count: u64,
    },
    /// Impacts came too late to be played.
    #[error(
        "{count} impacts were dropped because audio stood still when they were reported, or because a reset, a pause or a fade of \
         everything came before their turn; let the audio callback call Renderer::render without a break"
    )]
    Stale {
        /// Number.
        count: u64,
    },
    /// Contacts lasted longer than the engine plays.
    #[error(
        "{count} impacts or micro-collisions would outlast the longest contact that is played ({longest_s:.2} s, a \
         micro-collision 0.04 s) and were shortened; let what strikes or what is struck be stiffer, or lighter"
    )]
    Shortened {
        /// Number.
        count: u64,
        /// Longest contact of an impact, s.
        longest_s: f64,
    },
    /// A probe leapt and came down hard, or was thrown off a crest; rendered as it is.
    #[error(
        "{count} times a probe that had left the ground came down with more than 30 times what pressed it, or was thrown so far that it \
         presses more than was reported; a probe that is softer or lighter, more normal_force_n, less relief or less speed keeps it on the ground"
    )]
    Leapt {
        /// Number of times.
        count: u64,
    },
    /// Work was left out because blocks were late.
    #[error(
        "{count} pieces of sound were left out because blocks ran late; render larger blocks or fewer contacts, \
         build with optimisation, or set Config::shed_load = false"
    )]
    Shed {
        /// Number, as [`Stats::shed`] counts.
        count: u64,
    },
    /// A limiter holds down what is far too loud, and what plays beside it.
    #[error(
        "a limiter has turned down by {by_db} dB, and with what is too loud whatever else plays there: lower the gain of its bus, \
         strike_gain of what is struck, or raise full_scale of its actuator"
    )]
    TurnedDown {
        /// By how much at most, dB.
        by_db: u64,
    },
    /// The reports of a surface contradict themselves: something sounds, and not what was meant.
    #[error("{0}")]
    Contradicts(Contradiction),
    /// Moves or impacts come at one and the same time.
    #[error(
        "{count} reports came at one time, {time_s} s, as if nothing had moved in it; report each with the game's time in \
         seconds, which goes on from step to step"
    )]
    TimeStands {
        /// Number of reports after the first.
        count: u64,
        /// The time, s.
        time_s: f64,
    },
    /// A finger or a light tool presses as nothing light does.
    #[error(
        "{count} reports press a finger or a light tool with {force_n:.0} N in the mean; normal_force_n is in newtons: is it in mN, or \
         in grams? what is heavy needs a probe such as \"rigid\" or \"sole\""
    )]
    PressedTooHard {
        /// Number of reports.
        count: u64,
        /// Mean force of them, N.
        force_n: f64,
    },
    /// Impacts come at every step of the game.
    #[error(
        "{count} impacts in a row struck one body, one at every step; report an \"impact\" once, where a thing lands, and \"begin\", moves \
         and \"end\" while it touches"
    )]
    StruckEveryStep {
        /// Number of steps.
        count: u64,
    },
    /// The audio gain is zero.
    #[error("the audio gain is 0; raise gain under [audio], AudioBus::gain")]
    AudioGainZero,
    /// Contacts slide on surfaces that ring nothing.
    #[error(
        "no contact touched a surface that rings a body; give the surface body = \"…\", Surface::body(body), and the \
         body modes"
    )]
    NothingRings,
    /// No contact presses.
    #[error(
        "no contact was pressed onto its surface; report a normal_force_n above 0, or a depth_m on what gives way"
    )]
    NeverPressed,
    /// No contact moves.
    #[error(
        "no contact moved; a finger that rests is neither heard nor felt: let uv change from move to move"
    )]
    NeverMoved,
}

/// Reports that the game half keeps in order to answer.
#[derive(Debug, Default)]
pub(crate) struct Reported {
    accepted: u64,
    last_refusal: Option<Refusal>,
    newest: Stamp,
    contacts: u64,
    impacts: u64,
    /// Contacts and impacts on something that has modes.
    ringing: u64,
    pressed: bool,
    landed: bool,
    first_uv: Option<[f64; 2]>,
    moved: bool,
    slips: Slips,
}

impl Reported {
    /// An event of game time `time_s` was sent; `rings` if what it touches has modes, `is_light` if
    /// it begins with a finger or a light tool.
    pub(crate) fn accept(
        &mut self,
        event: &ContactEvent,
        (time_s, stamp): (f64, Stamp),
        rings: bool,
        is_light: bool,
    ) {
        self.accepted += 1;
        self.slips.note(time_s, event, is_light);
        self.newest = self.newest.max(stamp);
        self.ringing += u64::from(rings);
        match event {
            ContactEvent::Begin { sample, .. } => {
                self.contacts += 1;
                self.landed |= sample.closing_m_s > 0.0;
                self.touch(sample);
            }
            ContactEvent::Moved { sample, .. } => self.touch(sample),
            ContactEvent::Impact(_) => self.impacts += 1,
            ContactEvent::End { .. } | ContactEvent::Motion { .. } => {}
        }
    }

    fn touch(&mut self, sample: &ContactSample) {
        // A depth, or a place that gives one, is answered by what gives way.
        self.pressed |= sample.normal_force_n > 0.0
            || sample.depth_m.map_or(sample.normal_force_n.is_nan(), |depth_m| depth_m > 0.0);
        let first_uv = *self.first_uv.get_or_insert(sample.uv);
        self.moved |= sample.uv != first_uv;
    }

    /// An event was handed back.
    pub(crate) fn refuse(&mut self, reason: Refusal) {
        if reason != Refusal::QueueFull {
            self.last_refusal = Some(reason);
        }
    }

    /// Reasons against sound, the likeliest first.
    pub(crate) fn why_silent(&self, stats: &Stats, config: &Config) -> Vec<SilenceReason> {
        let mut because = self.lost(stats, config);
        if self.accepted == 0 && because.is_empty() {
            because.push(SilenceReason::NothingReported);
        }
        if stats.position == 0 {
            because.insert(0, SilenceReason::NothingRendered);
        }
        let mut say = |holds: bool, reason| {
            if holds {
                because.push(reason);
            }
        };
        say(stats.limiter_db > LIMITED_DB, SilenceReason::TurnedDown { by_db: stats.limiter_db });
        say(config.audio.iter().all(|bus| bus.gain == 0.0), SilenceReason::AudioGainZero);
        say(self.contacts + self.impacts > 0 && self.ringing == 0, SilenceReason::NothingRings);
        say(self.contacts > 0 && !self.pressed, SilenceReason::NeverPressed);
        let strokes_only = self.contacts > 0 && self.impacts == 0;
        say(strokes_only && !self.moved && !self.landed, SilenceReason::NeverMoved);
        let Self { slips, .. } = self;
        because.extend(slips.stands().map(|(count, time_s)| SilenceReason::TimeStands { count, time_s }));
        let too_hard = slips.too_hard();
        because.extend(too_hard.map(|(count, force_n)| SilenceReason::PressedTooHard { count, force_n }));
        because.extend(slips.at_every_step().map(|count| SilenceReason::StruckEveryStep { count }));
        because
    }

    /// Reports that did not arrive.
    fn lost(&self, stats: &Stats, config: &Config) -> Vec<SilenceReason> {
        let mut because = Vec::new();
        if let Some(last) = self.last_refusal {
            let of = self.accepted + stats.refused + stats.dropped;
            because.push(SilenceReason::Refused { count: stats.refused, of, last });
        }
        let ahead_s =
            self.newest.samples() / config.inner_rate_hz() - stats.position as f64 / config.sample_rate_hz;
        if ahead_s > FAR_AHEAD_S {
            because.push(SilenceReason::AheadOfAudio { ahead_s });
        }
        let counted = [
            SilenceReason::Dropped { count: stats.dropped },
            SilenceReason::Stale { count: stats.stale },
            SilenceReason::Orphaned { count: stats.orphaned },
            SilenceReason::Lapsed { count: stats.lapsed, timeout_s: config.contact_timeout_s },
            SilenceReason::Stolen { count: stats.stolen, limit: config.max_contacts },
            SilenceReason::Quarantined { count: stats.quarantined },
            SilenceReason::Held { count: stats.held },
            SilenceReason::Shortened {
                count: stats.shortened + stats.shortened_collisions,
                longest_s: LONGEST_CONTACT_S,
            },
            SilenceReason::Leapt { count: stats.blows },
            SilenceReason::Shed { count: stats.shed },
        ];
        because.extend(counted.into_iter().filter(|reason| reason.count() > 0));
        because
    }
}

impl SilenceReason {
    /// Number of times that it happened, 1 for a contradiction; 0 for what is a state.
    #[must_use]
    pub fn count(&self) -> u64 {
        match self {
            Self::Refused { count, .. }
            | Self::Dropped { count }
            | Self::Stale { count }
            | Self::Orphaned { count }
            | Self::Lapsed { count, .. }
            | Self::Leapt { count }
            | Self::Stolen { count, .. }
            | Self::Quarantined { count }
            | Self::Held { count }
            | Self::TimeStands { count, .. }
            | Self::PressedTooHard { count, .. }
            | Self::StruckEveryStep { count }
            | Self::Shortened { count, .. }
            | Self::Shed { count } => *count,
            Self::Contradicts(_) => 1,
            _ => 0,
        }
    }
}
