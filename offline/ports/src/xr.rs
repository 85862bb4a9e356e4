//! OpenXR: a clip as parametric frames (`XR_EXT_haptic_parametric`).
//!
//! Rules kept: times in ns since the stream began, which do not fall from frame to frame, strokes
//! later than the one before; at most [`MOST_POINTS`] of each a call, two amplitudes in the first
//! frame and one in any other; the first points at 0, the first frame at least as long as the
//! runtime says; no frequency or stroke behind the last amplitude; 1–1000 Hz, said by the first
//! frame alone; 0–1. Amplitude envelopes and pieces of PCM are sent by `asperity_openxr.h`, live.
//!
//! [`broken_rule`] is the list of refusals of the specification (OpenXR 1.1.60 and its conformance
//! tests), written apart from the writer.

use crate::clip::{Clip, Line};
use crate::device::Device;
use crate::error::{PortError, within};

/// Most points of an envelope in one call.
pub const MOST_POINTS: usize = 500;

/// A point: ns since the stream's beginning, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// ns.
    pub time_ns: i64,
    /// 0 to 1.
    pub value: f32,
}

/// A stroke of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transient {
    /// ns since the stream's beginning.
    pub time_ns: i64,
    /// 0 to 1.
    pub amplitude: f32,
    /// 0 to 1.
    pub frequency: f32,
}

/// Position of a frame: alone, or one that goes on in the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Streaming {
    /// All there is.
    None,
    /// The first of several.
    First,
    /// Neither the first nor the last.
    Intermediate,
    /// The last of several.
    Final,
}

/// Frame that one call hands over.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// The amplitude's envelope.
    pub amplitude: Vec<Point>,
    /// The frequency's; empty: the runtime's choice.
    pub frequency: Vec<Point>,
    /// Strokes.
    pub transients: Vec<Transient>,
    /// Frequency 0, Hz; 0 = as the stream's first frame says.
    pub min_frequency_hz: f32,
    /// Frequency 1, Hz; 0 likewise.
    pub max_frequency_hz: f32,
    /// Position among others.
    pub streaming: Streaming,
}

fn ns(time_s: f64) -> i64 {
    (time_s * 1e9).round() as i64
}

/// A clip as frames, the first at least `first_frame_s` long.
///
/// # Errors
/// When the clip breaks a rule, or a first frame of that length could hold more points than a call
/// may.
pub fn frames(clip: &Clip, device: &Device, first_frame_s: f64) -> Result<Vec<Frame>, PortError> {
    let clip = clip.clone().checked()?;
    within("first_frame_s", first_frame_s, [0.0, 10.0])?;
    let ends_s = clip.duration_s();
    let mut cuts = vec![0.0];
    while let Some(from_s) = cuts.last().copied().filter(|from_s| *from_s < ends_s) {
        let least_s = if from_s == 0.0 { first_frame_s } else { 0.0 };
        let to_s = end_of_frame(&clip, from_s, ends_s);
        if to_s < ends_s && to_s - from_s < least_s || to_s <= from_s {
            let what = format!("needs more than {MOST_POINTS} points in its first {least_s} s");
            return Err(PortError::new("clip", what, "reduce with fewer points a second"));
        }
        cuts.push(to_s);
    }
    let count = cuts.len() - 1;
    let span = |k: usize| {
        // A clip shorter than the runtime's first frame is held in silence until then.
        let to_s = if k + 1 == count && k == 0 { cuts[1].max(first_frame_s) } else { cuts[k + 1] };
        frame(&clip, device, cuts[k], to_s, streaming(k, count))
    };
    let mut frames: Vec<Frame> = (0..count).map(span).collect();
    part_strokes(&mut frames);
    Ok(frames)
}

/// Strokes of one moment come a nanosecond apart; what is behind the end is left out.
fn part_strokes(frames: &mut [Frame]) {
    let ends_ns = frames.last().and_then(Frame::ends_ns).unwrap_or_default();
    let mut before_ns = -1;
    for stroke in frames.iter_mut().flat_map(|frame| &mut frame.transients) {
        stroke.time_ns = stroke.time_ns.max(before_ns + 1);
        before_ns = stroke.time_ns;
    }
    frames.iter_mut().for_each(|frame| frame.transients.retain(|stroke| stroke.time_ns <= ends_ns));
}

impl Frame {
    /// Time of its last amplitude, ns.
    #[must_use]
    pub fn ends_ns(&self) -> Option<i64> {
        self.amplitude.last().map(|point| point.time_ns)
    }
}

fn streaming(index: usize, count: usize) -> Streaming {
    match (index, count) {
        (_, 1) => Streaming::None,
        (0, _) => Streaming::First,
        (k, n) if k + 1 == n => Streaming::Final,
        _ => Streaming::Intermediate,
    }
}

/// As far as the points of either envelope allow: two of each are the frame's own ends.
fn end_of_frame(clip: &Clip, from_s: f64, ends_s: f64) -> f64 {
    let limit = |times: &mut dyn Iterator<Item = f64>| times.filter(|t| *t > from_s).nth(MOST_POINTS - 3);
    let amplitude = limit(&mut clip.amplitude.iter().map(|p| p.time_s));
    let frequency = limit(&mut clip.frequency.iter().map(|p| p.time_s));
    let strokes = limit(&mut clip.amplitude.iter().filter(|p| p.emphasis.is_some()).map(|p| p.time_s));
    [amplitude, frequency, strokes].into_iter().flatten().fold(ends_s, f64::min)
}

fn frame(clip: &Clip, device: &Device, from_s: f64, to_s: f64, streaming: Streaming) -> Frame {
    let begins = matches!(streaming, Streaming::None | Streaming::First);
    let points = |values: &[(f64, f64)]| -> Vec<Point> {
        let mut line = Line::new(values.iter().copied());
        let mut out = Vec::new();
        if begins {
            out.push(Point { time_ns: 0, value: line.at(from_s) as f32 });
        }
        for (time_s, value) in values.iter().filter(|(t, _)| *t > from_s && *t < to_s) {
            out.push(Point { time_ns: ns(*time_s), value: *value as f32 });
        }
        out.push(Point { time_ns: ns(to_s), value: line.at(to_s) as f32 });
        out
    };
    let amplitude: Vec<_> = clip.amplitude.iter().map(|p| (p.time_s, p.amplitude)).collect();
    let frequency: Vec<_> = clip.frequency.iter().map(|p| (p.time_s, p.frequency)).collect();
    let last = matches!(streaming, Streaming::None | Streaming::Final);
    let inside = |t: f64| t >= from_s && (t < to_s || (last && t <= to_s));
    let strokes = clip.amplitude.iter().filter(|p| inside(p.time_s));
    let transients = strokes.filter_map(|p| p.emphasis.map(|e| (p.time_s, e))).map(|(t, e)| Transient {
        time_ns: ns(t),
        amplitude: e.amplitude as f32,
        frequency: e.frequency as f32,
    });
    let band_hz = if begins { device.band_hz } else { [0.0; 2] };
    Frame {
        amplitude: points(&amplitude),
        frequency: if frequency.is_empty() { Vec::new() } else { points(&frequency) },
        transients: transients.collect(),
        min_frequency_hz: band_hz[0] as f32,
        max_frequency_hz: band_hz[1] as f32,
        streaming,
    }
}

/// The first rule of the specification that a stream breaks, and the frame that does.
#[must_use]
pub fn broken_rule(frames: &[Frame], first_frame_s: f64) -> Option<(usize, &'static str)> {
    let mut ends = [0, 0, -1];
    (0..frames.len()).find_map(|index| {
        let runs = index > 0;
        broken_by(&frames[index], first_frame_s, runs, &mut ends).map(|rule| (index, rule))
    })
}

/// The first rule that a frame breaks; `ends` are the last times of amplitudes, frequencies and
/// strokes so far, ns.
fn broken_by(frame: &Frame, first_frame_s: f64, runs: bool, ends: &mut [i64; 3]) -> Option<&'static str> {
    let Frame { amplitude, frequency, transients, min_frequency_hz, max_frequency_hz, streaming } = frame;
    let in_order = |points: &[Point], from: i64| {
        points.first().is_none_or(|p| p.time_ns >= from)
            && points.windows(2).all(|w| w[0].time_ns <= w[1].time_ns)
    };
    let values = |points: &[Point]| points.iter().all(|p| (0.0..=1.0).contains(&p.value));
    let starts = |points: &[Point]| points.first().is_none_or(|p| p.time_ns == 0);
    let begins = matches!(streaming, Streaming::None | Streaming::First);
    let is_last = matches!(streaming, Streaming::None | Streaming::Final);
    let unsaid = (*min_frequency_hz, *max_frequency_hz) == (0.0, 0.0);
    let band = 1.0..=1000.0;
    let said = band.contains(min_frequency_hz)
        && band.contains(max_frequency_hz)
        && min_frequency_hz <= max_frequency_hz;
    let later = transients.first().is_none_or(|t| t.time_ns > ends[2])
        && transients.windows(2).all(|w| w[0].time_ns < w[1].time_ns);
    let stroke = |t: &Transient| (0.0..=1.0).contains(&t.amplitude) && (0.0..=1.0).contains(&t.frequency);
    let end = |points: &[Point], before: i64| points.last().map_or(before, |p| p.time_ns);
    let now =
        [end(amplitude, ends[0]), end(frequency, ends[1]), transients.last().map_or(ends[2], |t| t.time_ns)];
    let checks = [
        (runs == begins, "a first frame in a stream, or another without one"),
        (amplitude.len() < if begins { 2 } else { 1 }, "too few amplitude points"),
        (amplitude.len() > MOST_POINTS, "too many amplitude points"),
        (frequency.len() > MOST_POINTS, "too many frequency points"),
        (transients.len() > MOST_POINTS, "too many transients"),
        (!in_order(amplitude, ends[0]) || !in_order(frequency, ends[1]) || !later, "times fall"),
        (
            !values(amplitude) || !values(frequency) || !transients.iter().all(stroke),
            "a value outside 0 to 1",
        ),
        (begins && !(starts(amplitude) && starts(frequency)), "the first point is not at 0"),
        (
            *streaming == Streaming::First && (now[0] as f64) < first_frame_s * 1e9 - 1.0,
            "the first frame is too short",
        ),
        (is_last && (now[1] > now[0] || now[2] > now[0]), "something behind the last amplitude"),
        (!unsaid && !said, "frequencies outside 1 to 1000 Hz"),
        (!begins && !unsaid, "a later frame says its frequencies"),
    ];
    *ends = now;
    checks.into_iter().find(|(broken, _)| *broken).map(|(_, rule)| rule)
}
