//! Warnings of a render: what was refused, lost or clipped, and why a file is silence.

use super::Report;
use asperity::SilentBecause;
use asperity::files::contact_log::{ContactLog, LogEvent};
use asperity::files::scene_file::SceneFile;
use asperity::offline::Render;
use std::collections::BTreeMap;

/// Audio peaks below this are silence: −120 dB of full scale.
const SILENT: f32 = 1e-6;
/// Haptic peaks below this are silence, m or m/s²: a hundredth of what a fingertip just feels.
const UNFELT: f64 = 1e-9;

/// One line each, with the key or field that mends it.
pub fn warnings(file: &SceneFile, log: &ContactLog, render: &Render, report: &Report) -> Vec<String> {
    let lost = render.why_silent.iter().filter(|reason| reason.count() > 0);
    let mut told: Vec<String> = lost.map(|reason| in_words(reason, log, render)).collect();
    told.extend(clipped(report));
    // Who asked for a limiter knows that it works.
    let asked = file.audio.iter().any(|bus| bus.limit == Some(true))
        || file.actuators.iter().any(|actuator| actuator.limit_peaks == Some(true));
    told.extend(turned_down(report).filter(|_| !asked));
    told.extend(silence(file, log, render, report));
    told
}

fn clipped(report: &Report) -> Vec<String> {
    let mut told = Vec::new();
    if report.audio_peak > 1.0 {
        let peak = report.audio_peak;
        told.push(format!(
            "the audio exceeds full scale (peak {peak:.2}): lower gain under [audio], or write limit = true there"
        ));
    }
    for (channel, peak) in report.haptic_peak.iter().enumerate().filter(|(_, peak)| **peak > 1.0) {
        told.push(format!(
            "haptic channel {channel} peaks at {peak:.2} of full scale: raise full_scale of its [[actuator]], or write \
             limit = true there"
        ));
    }
    told
}

/// A limiter that works as hard as that is heard and felt.
const HARD_DB: f64 = 6.0;

fn turned_down(report: &Report) -> Option<String> {
    let by_db = report.limiter_db;
    (by_db > HARD_DB).then(|| {
        format!(
            "a limiter turned down by up to {by_db:.1} dB: lower gain under [audio], strike_gain of the [[body]], or raise full_scale of the [[actuator]] (in use: \
             gain {}, full_scale {:?})",
            report.gain, report.full_scale
        )
    })
}

fn silence(file: &SceneFile, log: &ContactLog, render: &Render, report: &Report) -> Vec<String> {
    let mut told = Vec::new();
    let because = |but: &[SilentBecause], otherwise: &str| {
        let reasons = render.why_silent.iter().filter(|reason| !but.contains(reason));
        let words: Vec<String> = reasons.map(|reason| in_words(reason, log, render)).collect();
        if words.is_empty() { otherwise.to_owned() } else { words.join("; ") }
    };
    if report.audio_peak < SILENT {
        let otherwise = "nothing was loud enough; raise gain under [audio], or press or strike harder";
        told.push(format!(
            "the audio is silence (peak {:.1e}): {}",
            report.audio_peak,
            because(&[], otherwise)
        ));
    }
    let mut channels = report.haptic_peak.iter().zip(&file.actuators);
    if channels.all(|(peak, actuator)| f64::from(*peak) * actuator.full_scale.unwrap_or(1.0) < UNFELT) {
        let begins = log.lines.iter().any(|line| matches!(line.event, LogEvent::Begin { .. }));
        let sounds_only = [SilentBecause::AudioGainZero, SilentBecause::NothingRings];
        let why = if begins {
            because(&sounds_only, "nothing was strong enough; lower full_scale of the [[actuator]]")
        } else {
            "no contact begins in the log, and impacts are heard, not felt; write a \"begin\" and moves"
                .to_owned()
        };
        told.push(format!("every haptic channel is silence: {why}"));
    }
    told
}

/// A reason in the words of scene files and logs.
fn in_words(reason: &SilentBecause, log: &ContactLog, render: &Render) -> String {
    match reason {
        SilentBecause::Refused { count, of, .. } => match render.first_refused {
            Some((time_s, refused)) => {
                format!("{count} of {of} events were refused, the first at t = {time_s} s: {refused}")
            }
            None => reason.to_string(),
        },
        SilentBecause::Orphaned { count } => match first_stray(log) {
            Some((time_s, contact)) => format!(
                "{count} events speak of a contact that is not there, the first of contact {contact} at t = {time_s} s; write \
                 its \"begin\" before, with the same number"
            ),
            None => format!("{count} events speak of contacts that were refused or silenced"),
        },
        SilentBecause::Lapsed { count, timeout_s } => {
            let first = first_gap(log, *timeout_s).map_or_else(String::new, |(time_s, contact)| {
                format!(", the first contact {contact} after t = {time_s} s")
            });
            format!(
                "{count} contacts faded because no line spoke of them for {timeout_s} s{first}; write a move at least so \
                 often, and an \"end\" where a contact ends"
            )
        }
        SilentBecause::Stolen { count, limit } => format!(
            "{count} contacts were silenced because more than {limit} sounded at once; write an \"end\" for those that are over"
        ),
        SilentBecause::Quarantined { count } => format!(
            "{count} samples were quarantined: a height more than 20 m from zero, a force beyond 1e4 N, or a probe that was lost; check \
             relief_m, scale, normal_force_n and [probe]"
        ),
        SilentBecause::NothingReported => {
            "the log holds no event; write a \"begin\" and moves, or an \"impact\"".to_owned()
        }
        SilentBecause::AudioGainZero => "gain under [audio] is 0; raise it".to_owned(),
        SilentBecause::NothingRings => {
            "nothing touched has modes; write body = \"NAME\" in [[surface]] and modes = \"FILE\" in [[body]]"
                .to_owned()
        }
        other => other.to_string(),
    }
}

/// The first move or end of a contact that no begin has begun: its time, s, and the contact.
fn first_stray(log: &ContactLog) -> Option<(f64, u64)> {
    let mut touching = std::collections::BTreeSet::new();
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

/// The first contact of which nothing is heard for so long: the time of its last line, s, and the contact.
fn first_gap(log: &ContactLog, timeout_s: f64) -> Option<(f64, u64)> {
    let mut heard: BTreeMap<u64, f64> = BTreeMap::new();
    let mut gaps = Vec::new();
    for line in &log.lines {
        let (contact, ends) = match line.event {
            LogEvent::Begin { contact, .. } | LogEvent::Move { contact, .. } => (contact, false),
            LogEvent::End { contact } => (contact, true),
            LogEvent::Impact { .. } | LogEvent::Edit(_) => continue,
        };
        let before_s = if ends { heard.remove(&contact) } else { heard.insert(contact, line.t) };
        gaps.extend(
            before_s.filter(|before_s| line.t - before_s > timeout_s).map(|before_s| (before_s, contact)),
        );
    }
    gaps.extend(heard.into_iter().map(|(contact, before_s)| (before_s, contact)));
    gaps.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))
}
