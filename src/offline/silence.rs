//! Losses and silence of a render, in the words of scene files and logs: what was refused or lost,
//! and for each bus and channel that holds nothing its own reason.

mod too_loud;

use crate::files::contact_log::{ContactLog, LogEvent, LogHand, LogLine};
use crate::files::scene_file::SceneFile;
use crate::load::levels::Levels;
use crate::offline::Render;
use crate::{Excitation, SilenceReason, SurfaceId};
use std::collections::{BTreeMap, BTreeSet};

/// Audio peaks below this are silence: −120 dB of full scale.
const SILENT: f32 = 1e-6;
/// Silent peaks above this are called faint: something sounds, as a ball does that rolls slowly.
const FAINT: f32 = 1e-9;
/// Haptic peaks below this are silence, m or m/s²: a hundredth of what a fingertip just feels.
const UNFELT: f64 = 1e-9;

/// A render, and what it was made of.
#[derive(Debug, Clone, Copy)]
pub struct Rendered<'a> {
    /// The scene.
    pub file: &'a SceneFile,
    /// Its log.
    pub log: &'a ContactLog,
    /// Their render.
    pub render: &'a Render,
    /// Levels in use.
    pub levels: &'a Levels,
    /// Names of the surfaces.
    pub surfaces: &'a [(String, SurfaceId)],
}

impl Rendered<'_> {
    /// Events that were refused or lost, outputs that are too loud or silent: one line each, with
    /// the key or field that mends it.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        [self.losses(), self.too_loud(), self.silences()].concat()
    }

    /// Events that were refused, lost or contradict themselves: one line each, with what mends it.
    fn losses(&self) -> Vec<String> {
        let backwards =
            |line: &&LogLine| matches!(line.event, LogEvent::Impact { speed_m_s, .. } if speed_m_s <= 0.0);
        let mut still = self.log.lines.iter().filter(backwards).peekable();
        let first_s = still.peek().map(|line| line.t);
        let still = still.count() as u64;
        // A speed below 0 counts as 0, which is reported by itself.
        let own =
            |reason: &&SilenceReason| matches!(reason, SilenceReason::Held { count } if *count <= still);
        let lost = self.render.why_silent.iter().filter(|reason| reason.count() > 0 && !own(reason));
        let mut sentences: Vec<String> = lost.map(|reason| singular(self.in_words(reason))).collect();
        sentences.extend(first_s.map(|t| {
            singular(format!(
                "{still} impacts were silent for their speed_m_s of 0 or below, the first at t = {t} s; write the speed of \
                 approach before the blow, not after it"
            ))
        }));
        sentences
    }

    /// Buses and channels that hold nothing: one line each, with its own reason.
    fn silences(&self) -> Vec<String> {
        let (audio, haptic) = (self.silent_buses(), self.silent_channels());
        let mut sentences = Vec::new();
        match audio.as_slice() {
            all if all.len() == self.render.audio.len() => {
                let peak = self.render.audio.iter().map(|bus| peak(bus)).fold(0.0, f32::max);
                let why: Vec<String> = if all.len() == 1 {
                    vec![self.unheard(0)]
                } else {
                    self.each(all, |bus| self.unheard(bus))
                };
                let is = if peak > FAINT { "faint" } else { "silence" };
                sentences.push(format!("the audio is {is} (peak {peak:.1e}): {}", why.join("; ")));
            }
            some => sentences.extend(some.iter().map(|bus| {
                let name = self.file.audio.get(*bus).and_then(|bus| bus.name.clone()).unwrap_or_default();
                format!("audio bus \"{name}\" is silence: {}", self.unheard(*bus))
            })),
        }
        match haptic.as_slice() {
            all if all.len() == self.render.haptic.len() => {
                let why = self.each(all, |channel| self.unfelt(channel));
                sentences.push(format!("every haptic channel is silence: {}", why.join("; ")));
            }
            some => sentences
                .extend(some.iter().map(|channel| {
                    format!("haptic channel {channel} is silence: {}", self.unfelt(*channel))
                })),
        }
        sentences
    }

    /// The reasons of several outputs, each once.
    fn each(&self, outputs: &[usize], why: impl Fn(usize) -> String) -> Vec<String> {
        let mut sentences: Vec<String> = outputs.iter().map(|output| why(*output)).collect();
        sentences.dedup();
        sentences
    }

    fn silent_buses(&self) -> Vec<usize> {
        let buses = self.render.audio.iter().enumerate();
        buses.filter(|(_, bus)| peak(bus) < SILENT).map(|(index, _)| index).collect()
    }

    fn silent_channels(&self) -> Vec<usize> {
        let channels = self.render.haptic.iter().zip(&self.levels.full_scale).enumerate();
        let silent = channels.filter(|(_, (samples, scale))| f64::from(peak(samples)) * **scale < UNFELT);
        silent.map(|(index, _)| index).collect()
    }

    /// Reason for the silence of a bus.
    fn unheard(&self, bus: usize) -> String {
        let Self { file, log, .. } = self;
        let entry = file.audio.get(bus);
        let name = entry.and_then(|entry| entry.name.as_deref());
        let plays = |body: &str| {
            let body = file.bodies.iter().find(|entry| entry.name == body);
            body.is_some_and(|body| {
                body.bus.is_none() && bus == 0 || body.bus.is_some() && body.bus.as_deref() == name
            })
        };
        if entry.is_some_and(|entry| entry.gain == Some(0.0)) {
            return "gain under [audio] is 0; raise it".to_owned();
        }
        if file.audio.len() > 1 && !file.bodies.iter().any(|body| plays(&body.name)) {
            return format!(
                "no body plays on it; write bus = \"{}\" in a [[body]]",
                name.unwrap_or_default()
            );
        }
        let touched = self.touched();
        if file.audio.len() > 1 && !touched.iter().any(|body| plays(body)) {
            return "no contact or impact of the log touches a body that plays on it".to_owned();
        }
        let mut hands = log.lines.iter().filter_map(|line| hand(&line.event)).peekable();
        if hands.peek().is_some() && hands.all(|hand| hand.gain == Some(0.0)) {
            return "\"gain\" is 0 in every begin and impact of the log; raise it".to_owned();
        }
        let strikes = log.lines.iter().any(|line| matches!(line.event, LogEvent::Impact { .. }));
        let surfaces = self.stroked();
        let rings = |name: &&str| self.surface(name).is_some_and(|surface| surface.body.is_some());
        if let Some(name) = surfaces.iter().find(|name| rings(name))
            && !strikes
            && surfaces
                .iter()
                .filter_map(|name| self.surface(name))
                .all(|surface| surface.excitation == Excitation::NONE)
        {
            return format!(
                "sliding on \"{name}\" sends nothing to its body; write excitation = \"both\" in its [[surface]]"
            );
        }
        self.because(&[], "nothing was loud enough; raise gain under [audio], or press or strike harder")
    }

    /// Reason for the silence of a channel.
    fn unfelt(&self, channel: usize) -> String {
        let lines = self.log.lines.iter();
        let hands: Vec<&LogHand> = lines.filter_map(|line| hand(&line.event)).collect();
        // An impact with a holder is felt by the first channel, if no other is named.
        let felt_by = |hand: &LogHand| hand.actuator.map(usize::from).or(hand.holder.as_ref().map(|_| 0));
        let mine: Vec<&&LogHand> = hands.iter().filter(|hand| felt_by(hand) == Some(channel)).collect();
        if mine.is_empty() && !hands.is_empty() {
            let begins = self.log.lines.iter().any(|line| matches!(line.event, LogEvent::Begin { .. }));
            let mends = format!("write \"actuator\":{channel} in the");
            return if begins {
                format!("nothing in the log names it; {mends} \"begin\" of the contact that it feels")
            } else {
                format!(
                    "no contact begins in the log, and no impact names it; {mends} \"impact\" that it feels, or \
                     write a \"begin\" and moves"
                )
            };
        }
        if !mine.is_empty() && mine.iter().all(|hand| hand.gain == Some(0.0)) {
            return "\"gain\" is 0 in every begin and impact that it feels; raise it".to_owned();
        }
        let heard_only = [SilenceReason::AudioGainZero, SilenceReason::NothingRings];
        let otherwise = "nothing moved the skin by a nanometre; press harder (normal_force_n), move faster, or give the surface relief \
                         (relief_m, micro_relief_m)";
        self.because(&heard_only, otherwise)
    }

    fn because(&self, but: &[SilenceReason], otherwise: &str) -> String {
        let counts = |reason: &&SilenceReason| {
            use SilenceReason::{Contradicts, PressedTooHard, StruckEveryStep, TurnedDown};
            !but.contains(reason)
                && !matches!(
                    reason,
                    Contradicts(_) | TurnedDown { .. } | PressedTooHard { .. } | StruckEveryStep { .. }
                )
        };
        let because = || self.render.why_silent.iter().filter(counts);
        // What was lost is reported by itself.
        let is_state = |reason: &&SilenceReason| {
            reason.count() == 0 || matches!(reason, SilenceReason::TimeStands { .. })
        };
        let states = because().filter(is_state);
        let words: Vec<String> = states.map(|reason| self.in_words(reason)).collect();
        match words.as_slice() {
            [] if because().next().is_some() => "of what was refused or lost".to_owned(),
            [] => otherwise.to_owned(),
            words => words.join("; "),
        }
    }

    fn surface(&self, name: &str) -> Option<&crate::files::scene_file::SurfaceEntry> {
        self.file.surfaces.iter().find(|surface| surface.name == name)
    }

    /// Surfaces that contacts of the log begin on.
    fn stroked(&self) -> BTreeSet<&str> {
        let begun = self.log.lines.iter().filter_map(|line| match &line.event {
            LogEvent::Begin { touching, .. } => Some(touching.surface.as_str()),
            _ => None,
        });
        begun.collect()
    }

    /// Bodies that the log touches: below surfaces, struck, striking or in a hand.
    fn touched(&self) -> BTreeSet<&str> {
        let mut bodies: BTreeSet<&str> =
            self.stroked().iter().filter_map(|name| self.surface(name)?.body.as_deref()).collect();
        for line in &self.log.lines {
            bodies.extend(hand(&line.event).and_then(|hand| hand.holder.as_deref()));
            if let LogEvent::Impact { body, other, .. } = &line.event {
                bodies.insert(body);
                bodies.extend(other.as_deref());
            }
        }
        bodies
    }

    /// A reason in the words of scene files and logs.
    fn in_words(&self, reason: &SilenceReason) -> String {
        let Self { log, render, .. } = self;
        match reason {
            SilenceReason::Refused { count, of, .. } => match render.first_refused {
                Some((time_s, refused)) => {
                    format!("{count} of {of} events were refused, the first at t = {time_s} s: {refused}")
                }
                None => reason.to_string(),
            },
            SilenceReason::Orphaned { count } => match first_stray(log) {
                Some((time_s, contact)) => format!(
                    "{count} events speak of a contact that is not there, the first of contact {contact} at t = {time_s} s; write \
                     its \"begin\" before, with the same number"
                ),
                None => format!("{count} events speak of contacts that were refused or silenced"),
            },
            SilenceReason::Lapsed { count, timeout_s } => {
                let first = first_gap(log, *timeout_s).map_or_else(String::new, |(time_s, contact)| {
                    format!(", the first contact {contact} after t = {time_s} s")
                });
                format!(
                    "{count} contacts faded because no line spoke of them for {timeout_s} s{first}; write a move at least so \
                     often, and an \"end\" where a contact ends; t is in seconds"
                )
            }
            SilenceReason::Stolen { count, limit } => format!(
                "{count} contacts were silenced because more than {limit} sounded at once; write an \"end\" for those that are over"
            ),
            SilenceReason::Quarantined { count } => format!(
                "{count} samples were quarantined: a height more than 20 m from zero, a force beyond 1e4 N, or a probe that was lost; check \
                 relief_m, scale, normal_force_n and [probe]"
            ),
            SilenceReason::NothingReported => {
                "the log holds no event; write a \"begin\" and moves, or an \"impact\"".to_owned()
            }
            SilenceReason::AudioGainZero => "gain under [audio] is 0; raise it".to_owned(),
            SilenceReason::NothingRings => {
                let touched = self.touched();
                let mut bodies = self.file.bodies.iter().filter(|body| touched.contains(&*body.name));
                if let Some(body) = bodies.find(|body| body.stock.is_some()) {
                    return format!(
                        "body \"{}\" rings outside 16 Hz to 20 kHz only; change its size_m or its material \
                         (density_kg_m3 is some 1000 times g/cm³)",
                        body.name
                    );
                }
                "nothing touched has modes; write body = \"NAME\" in [[surface]] and modes = \"FILE\" in [[body]]"
                    .to_owned()
            }
            SilenceReason::Contradicts(contradiction) => {
                let name =
                    self.surfaces.iter().find(|(_, id)| *id == contradiction.surface()).map(|(name, _)| name);
                let several = self.file.surfaces.len() > 1;
                let on =
                    name.filter(|_| several).map_or_else(String::new, |name| format!("surface \"{name}\": "));
                format!("{on}{contradiction}")
            }
            other => other.to_string(),
        }
    }
}

/// A line that counts something, as it is said of one.
fn singular(sentences: String) -> String {
    let one = sentences.strip_prefix("1 ").and_then(|rest| rest.split_once(' '));
    let Some((noun, rest)) = one else { return sentences };
    let rest = [
        ("collisions ", "collision "),
        ("changes ", "change "),
        (" were ", " was "),
        (" their ", " its "),
        (" them ", " it "),
        (" speak ", " speaks "),
    ]
    .iter()
    .fold(format!(" {rest}"), |rest, (many, one)| rest.replacen(many, one, 1));
    format!("1 {}{rest}", noun.strip_suffix('s').unwrap_or(noun))
}

/// Hand of an event: the channel that feels it, and its gain.
fn hand(event: &LogEvent) -> Option<&LogHand> {
    match event {
        LogEvent::Begin { touching, .. } => Some(&touching.hand),
        LogEvent::Impact { hand, .. } => Some(hand),
        LogEvent::Move { .. } | LogEvent::End { .. } | LogEvent::Motion { .. } | LogEvent::Edit(_) => None,
    }
}

fn peak(samples: &[f32]) -> f32 {
    samples.iter().fold(0.0, |peak, sample| sample.abs().max(peak))
}

/// The first move or end of a contact that no begin has begun: its time, s, and the contact.
fn first_stray(log: &ContactLog) -> Option<(f64, u64)> {
    let mut touching = BTreeSet::new();
    for line in &log.lines {
        match line.event {
            LogEvent::Begin { contact, .. } => {
                touching.insert(contact);
            }
            LogEvent::Move { contact, .. } if !touching.contains(&contact) => return Some((line.t, contact)),
            LogEvent::End { contact } if !touching.remove(&contact) => return Some((line.t, contact)),
            _ => {}
        }
    }
    None
}

/// The first contact of which nothing is heard for so long: the time of its last line, s, and the
/// contact.
fn first_gap(log: &ContactLog, timeout_s: f64) -> Option<(f64, u64)> {
    let mut heard: BTreeMap<u64, f64> = BTreeMap::new();
    let mut gaps = Vec::new();
    for line in &log.lines {
        let (contact, ends) = match line.event {
            LogEvent::Begin { contact, .. } | LogEvent::Move { contact, .. } => (contact, false),
            LogEvent::End { contact } => (contact, true),
            LogEvent::Impact { .. } | LogEvent::Motion { .. } | LogEvent::Edit(_) => continue,
        };
        let before_s = if ends { heard.remove(&contact) } else { heard.insert(contact, line.t) };
        gaps.extend(
            before_s.filter(|before_s| line.t - before_s > timeout_s).map(|before_s| (before_s, contact)),
        );
    }
    gaps.extend(heard.into_iter().map(|(contact, before_s)| (before_s, contact)));
    gaps.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))
}
