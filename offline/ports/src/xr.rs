//! OpenXR: parametric frames (`XR_EXT_haptic_parametric`), amplitude envelopes
//! (`XR_FB_haptic_amplitude_envelope`) and pieces of PCM (`XR_FB_haptic_pcm`).
//!
//! | extension | rule kept |
//! |---|---|
//! | parametric | at most [`MOST_POINTS`] points of either envelope a call, 1–1000 Hz, times in ns that do not fall and lie inside the frame, the first points at 0, the first frame at least as long as the runtime says, amplitudes and frequencies 0–1 |
//! | amplitude envelope | at most [`MOST_AMPLITUDES`] values 0–1, evenly over the duration |
//! | PCM | at most [`PCM_STORE`] samples wait in the runtime; what it has not consumed is sent again; every call appends |
//!
//! [`broken_rule`] is the list of refusals of the specification, written apart from the writer.

use crate::clip::{Clip, Line};
use crate::device::Device;
use crate::error::{PortError, within};

/// Most points of an envelope in one call.
pub const MOST_POINTS: usize = 500;
/// Most values of an amplitude envelope.
pub const MOST_AMPLITUDES: usize = 4000;
/// Samples that the runtime stores.
pub const PCM_STORE: usize = 4000;
/// Time that a frame's last values are held, s: the next frame has to come within it.
pub const HELD_S: f64 = 0.05;

/// A point: ns since the frame's beginning, 0 to 1.
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
    /// ns since the frame's beginning.
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
    /// Frequency 0, Hz.
    pub min_frequency_hz: f32,
    /// Frequency 1, Hz.
    pub max_frequency_hz: f32,
    /// Position among others.
    pub streaming: Streaming,
    /// ns.
    pub duration_ns: i64,
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
    Ok((0..count).map(span).collect())
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
    let duration_ns = ns(to_s - from_s).max(1);
    let points = |values: &[(f64, f64)]| -> Vec<Point> {
        let mut line = Line::new(values.iter().copied());
        let mut out = vec![Point { time_ns: 0, value: line.at(from_s) as f32 }];
        for (time_s, value) in values.iter().filter(|(t, _)| *t > from_s && *t < to_s) {
            out.push(Point { time_ns: ns(time_s - from_s).min(duration_ns), value: *value as f32 });
        }
        out.push(Point { time_ns: duration_ns, value: line.at(to_s) as f32 });
        out
    };
    let amplitude: Vec<_> = clip.amplitude.iter().map(|p| (p.time_s, p.amplitude)).collect();
    let frequency: Vec<_> = clip.frequency.iter().map(|p| (p.time_s, p.frequency)).collect();
    let last = matches!(streaming, Streaming::None | Streaming::Final);
    let inside = |t: f64| t >= from_s && (t < to_s || (last && t <= to_s));
    let transients = clip
        .amplitude
        .iter()
        .filter(|p| inside(p.time_s))
        .filter_map(|p| p.emphasis.map(|e| (p.time_s, e)))
        .map(|(t, e)| Transient {
            time_ns: ns(t - from_s),
            amplitude: e.amplitude as f32,
            frequency: e.frequency as f32,
        })
        .collect();
    Frame {
        amplitude: points(&amplitude),
        frequency: if frequency.is_empty() { Vec::new() } else { points(&frequency) },
        transients,
        min_frequency_hz: device.band_hz[0] as f32,
        max_frequency_hz: device.band_hz[1] as f32,
        streaming,
        duration_ns,
    }
}

/// The first rule of the specification that a frame breaks.
#[must_use]
pub fn broken_rule(frame: &Frame, first_frame_s: f64) -> Option<&'static str> {
    let in_order = |points: &[Point]| points.windows(2).all(|w| w[0].time_ns <= w[1].time_ns);
    let values = |points: &[Point]| points.iter().all(|p| (0.0..=1.0).contains(&p.value));
    let inside = |points: &[Point]| points.iter().all(|p| (0..=frame.duration_ns).contains(&p.time_ns));
    let starts = |points: &[Point]| points.first().is_none_or(|p| p.time_ns == 0);
    let begins = matches!(frame.streaming, Streaming::None | Streaming::First);
    let checks = [
        (frame.amplitude.is_empty() && frame.transients.is_empty(), "nothing to play"),
        (frame.amplitude.len() > MOST_POINTS, "too many amplitude points"),
        (frame.frequency.len() > MOST_POINTS, "too many frequency points"),
        (frame.transients.len() > MOST_POINTS, "too many transients"),
        (!in_order(&frame.amplitude) || !in_order(&frame.frequency), "times fall"),
        (!values(&frame.amplitude) || !values(&frame.frequency), "a value outside 0 to 1"),
        (!inside(&frame.amplitude) || !inside(&frame.frequency), "a point outside the frame"),
        (begins && (!starts(&frame.amplitude) || !starts(&frame.frequency)), "the first point is not at 0"),
        (frame.duration_ns <= 0, "no duration"),
        (begins && (frame.duration_ns as f64) < first_frame_s * 1e9 - 1.0, "the first frame is too short"),
        (!(1.0..=1000.0).contains(&frame.min_frequency_hz), "the lowest frequency is outside 1 to 1000 Hz"),
        (
            !(frame.min_frequency_hz..=1000.0).contains(&frame.max_frequency_hz),
            "the highest frequency is out of range",
        ),
        (
            frame.transients.iter().any(|t| !(0..=frame.duration_ns).contains(&t.time_ns)),
            "a transient outside the frame",
        ),
        (
            frame
                .transients
                .iter()
                .any(|t| !(0.0..=1.0).contains(&t.amplitude) || !(0.0..=1.0).contains(&t.frequency)),
            "a transient outside 0 to 1",
        ),
    ];
    checks.into_iter().find(|(broken, _)| *broken).map(|(_, rule)| rule)
}

/// A clip's levels alone: values evenly over its duration, as many as fit.
///
/// # Errors
/// When the clip breaks a rule.
pub fn amplitude_envelope(clip: &Clip, per_s: f64) -> Result<Vec<f32>, PortError> {
    let clip = clip.clone().checked()?;
    within("per_s", per_s, [1.0, 4000.0])?;
    let count = ((clip.duration_s() * per_s).ceil() as usize).clamp(1, MOST_AMPLITUDES);
    Ok(clip.sampled(count as f64 / clip.duration_s()).map(|(level, _)| level as f32).take(count).collect())
}

/// Feeds PCM to a runtime that consumes as much of every call as it has room for.
#[derive(Debug, Clone)]
pub struct PcmFeed<'a> {
    samples: &'a [f32],
    sent: usize,
    piece: usize,
}

impl<'a> PcmFeed<'a> {
    /// Pieces of `ahead_s` at the rate that the runtime says; the rate is 0 until a controller is
    /// held, and is asked for again.
    ///
    /// # Errors
    /// When the rate is not one yet.
    pub fn new(samples: &'a [f32], rate_hz: f64, ahead_s: f64) -> Result<Self, PortError> {
        within("rate", rate_hz, [1.0, 192_000.0])?;
        within("ahead_s", ahead_s, [1e-3, 2.0])?;
        let piece = ((rate_hz * ahead_s) as usize).clamp(1, PCM_STORE);
        Ok(Self { samples, sent: 0, piece })
    }

    /// Frame that the next call hands over; it appends to what waits.
    #[must_use]
    pub fn next_piece(&self) -> &'a [f32] {
        &self.samples[self.sent..(self.sent + self.piece).min(self.samples.len())]
    }

    /// Number of samples that the runtime has taken; the rest is sent again.
    pub fn consumed(&mut self, count: usize) {
        self.sent = (self.sent + count.min(self.piece)).min(self.samples.len());
    }

    /// Tests whether everything has been taken.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.sent == self.samples.len()
    }
}
