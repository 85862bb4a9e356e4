//! Recording of a live game's reports as a contact log.

use crate::files::contact_log::{ContactLog, LogEdit, LogEvent, LogHand, LogLine, LogTouching, Names};
use crate::model::event::{ChannelId, ContactEvent};
use crate::model::id::{BodyId, ProbeId, SlotKey, SurfaceId};
use std::collections::{HashMap, VecDeque};
use std::io::{self, BufWriter, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// A recording in progress.
pub(crate) struct Recording {
    surfaces: HashMap<SurfaceId, String>,
    bodies: HashMap<BodyId, String>,
    probes: HashMap<ProbeId, String>,
    /// Lines that the audio half may not have come to yet, with the clock's epoch when they were
    /// reported: a [`reset`](Self::reset) drops them.
    waiting: VecDeque<Waiting>,
    kept: Kept,
}

/// A line that the audio half may not have come to.
struct Waiting {
    line: LogLine,
    /// The clock's epoch when it was reported.
    epoch: u64,
    /// Position of the audio then, s: what was late already waits for the next block all the same.
    told_s: f64,
    /// Ticket of a strike with a name; 0 = none.
    ticket: u32,
}

/// Destination of a recording.
enum Kept {
    Memory(Vec<LogLine>),
    /// A thread that writes, so that no tick of the game waits for a disk.
    Stream {
        lines: Sender<LogLine>,
        writer: JoinHandle<io::Result<u64>>,
    },
}

/// Time that lines may wait in the writer's buffer while the game reports nothing.
const FLUSHED_AFTER: Duration = Duration::from_millis(500);

/// Writes lines as they come, until the recording ends; returns how many there were.
fn write_all(lines: &Receiver<LogLine>, out: impl Write) -> io::Result<u64> {
    let (mut out, mut written) = (BufWriter::new(out), 0);
    loop {
        match lines.recv_timeout(FLUSHED_AFTER) {
            Ok(line) => {
                line.write(written == 0, &mut out)?;
                written += 1;
            }
            Err(RecvTimeoutError::Timeout) => out.flush()?,
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    out.flush()?;
    Ok(written)
}

impl Recording {
    /// Into memory.
    pub(crate) fn new(names: &Names) -> Self {
        Self::into(names, Kept::Memory(Vec::new()))
    }

    /// Into a file, or whatever else takes bytes.
    pub(crate) fn stream(names: &Names, out: impl Write + Send + 'static) -> io::Result<Self> {
        let (lines, written) = channel();
        let thread = std::thread::Builder::new().name("asperity recording".into());
        let writer = thread.spawn(move || write_all(&written, out))?;
        Ok(Self::into(names, Kept::Stream { lines, writer }))
    }

    fn into(names: &Names, kept: Kept) -> Self {
        Self {
            surfaces: names.surfaces.iter().map(|(name, id)| (*id, name.clone())).collect(),
            bodies: names.bodies.iter().map(|(name, id)| (*id, name.clone())).collect(),
            probes: names.probes.iter().map(|(name, id)| (*id, name.clone())).collect(),
            waiting: VecDeque::new(),
            kept,
        }
    }

    /// Keeps what lies before `time_s` for good, but for the impacts that the audio half has
    /// dropped: those of an epoch of the clock before `stale_before`.
    pub(crate) fn settle(&mut self, time_s: f64, stale_before: u64) {
        let come_to = |waits: &Waiting| waits.line.t.max(waits.told_s) < time_s;
        while self.waiting.front().is_some_and(come_to) {
            let Some(Waiting { line, epoch: then, .. }) = self.waiting.pop_front() else { return };
            if !(then < stale_before && (is_strike(&line) || matches!(line.event, LogEvent::Move { .. }))) {
                self.keep(line);
            }
        }
    }

    /// A strike with a name that waits never happens.
    pub(crate) fn withdraw(&mut self, ticket: u32) {
        self.waiting.retain(|waits| waits.ticket != ticket);
    }

    /// Impacts that wait never happen.
    pub(crate) fn drop_strikes(&mut self) {
        self.waiting.retain(|waits| !is_strike(&waits.line));
    }

    fn keep(&mut self, line: LogLine) {
        match &mut self.kept {
            Kept::Memory(lines) => lines.push(line),
            // A writer that has failed says so in the end.
            Kept::Stream { lines, .. } => drop(lines.send(line)),
        }
    }

    /// Drops what is reported for after `time_s`; edits that waited behind it happen now.
    pub(crate) fn reset(&mut self, time_s: f64) {
        self.waiting
            .retain(|Waiting { line, .. }| line.t <= time_s || matches!(line.event, LogEvent::Edit(_)));
        self.waiting.iter_mut().for_each(|waits| waits.line.t = waits.line.t.min(time_s));
    }

    /// Notes an edit that the engine makes at `time_s`.
    pub(crate) fn note_edit(&mut self, time_s: f64, edit: LogEdit) {
        let line = LogLine { t: time_s, event: LogEvent::Edit(edit) };
        self.waiting.push_back(Waiting { line, epoch: 0, told_s: 0.0, ticket: 0 });
    }

    /// Notes an event that the engine applies at `time_s`, stated in which of the clock's epochs
    /// and when, s of audio.
    pub(crate) fn note(
        &mut self,
        time_s: f64,
        (epoch, told_s): (u64, f64),
        event: &ContactEvent,
        ticket: u32,
    ) {
        let event = match *event {
            ContactEvent::Begin { contact, touching, sample } => LogEvent::Begin {
                contact: contact.0,
                touching: LogTouching {
                    surface: self.surface(touching.surface),
                    importance: unless_one(touching.importance),
                    hand: self.hand(touching.actuator, touching.probe, touching.holder, touching.gain),
                },
                sample,
            },
            ContactEvent::Moved { contact, sample, emphasis } => {
                LogEvent::Move { contact: contact.0, sample, emphasis }
            }
            ContactEvent::End { contact } => LogEvent::End { contact: contact.0 },
            ContactEvent::Motion { body, motion } => LogEvent::Motion { body: self.body(body), motion },
            ContactEvent::Impact(impact) => LogEvent::Impact {
                body: self.body(impact.body),
                other: impact.other.map(|other| self.body(other)),
                speed_m_s: impact.speed_m_s,
                mass_kg: impact.mass_kg,
                radius_m: impact.radius_m,
                striker: impact.striker.into(),
                restitution: impact.restitution,
                position: impact.position,
                at_m: impact.at_m,
                direction: impact.direction,
                hand: self.hand(impact.actuator, impact.probe, impact.holder, impact.gain),
            },
        };
        if self.waiting.back().is_some_and(|waits| waits.line.t > time_s) {
            // Game time was tied back: what lay further ahead comes now.
            self.waiting.iter_mut().for_each(|waits| waits.line.t = waits.line.t.min(told_s));
        }
        self.waiting.push_back(Waiting { line: LogLine { t: time_s, event }, epoch, told_s, ticket });
    }

    /// Ends the recording: what is in memory, or how many lines were written.
    pub(crate) fn end(mut self) -> (ContactLog, io::Result<u64>) {
        self.settle(f64::INFINITY, 0);
        match self.kept {
            Kept::Memory(lines) => (ContactLog { lines }, Ok(0)),
            Kept::Stream { lines, writer } => {
                drop(lines);
                let died = || Err(io::Error::other("the thread that writes has died"));
                (ContactLog::default(), writer.join().unwrap_or_else(|_| died()))
            }
        }
    }

    fn hand(
        &self,
        actuator: Option<ChannelId>,
        probe: Option<ProbeId>,
        holder: Option<BodyId>,
        gain: f64,
    ) -> LogHand {
        LogHand {
            actuator: actuator.map(|actuator| actuator.0),
            probe: probe.map(|probe| self.probe(probe)),
            holder: holder.map(|holder| self.body(holder)),
            gain: unless_one(gain),
        }
    }

    pub(crate) fn probe(&self, id: ProbeId) -> String {
        self.probes.get(&id).cloned().unwrap_or_else(|| numbered("probe", id.0))
    }

    pub(crate) fn surface(&self, id: SurfaceId) -> String {
        self.surfaces.get(&id).cloned().unwrap_or_else(|| numbered("surface", id.0))
    }

    pub(crate) fn body(&self, id: BodyId) -> String {
        self.bodies.get(&id).cloned().unwrap_or_else(|| numbered("body", id.0))
    }
}

fn is_strike(line: &LogLine) -> bool {
    matches!(line.event, LogEvent::Impact { .. })
}

/// A factor that a log need not hold when it is 1.
fn unless_one(factor: f64) -> Option<f64> {
    (factor != 1.0).then_some(factor)
}

/// Name of a thing without one: its place, and which of its occupants, from the second on.
fn numbered(kind: &str, SlotKey { index, generation }: SlotKey) -> String {
    if generation == 1 { format!("{kind} {index}") } else { format!("{kind} {index}.{generation}") }
}
