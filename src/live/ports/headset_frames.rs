//! Headset frames port: points as frames of `XR_EXT_haptic_parametric` (OpenXR 1.1.60), which the
//! runtime of a headset's controller plays as they come.
//!
//! A stream begins with the first point that is felt. Its first frame lasts as long as the runtime
//! wants, silent until that point, with which it ends; everything lags by that, and a blow that is
//! shorter stays as short. It ends after 0.1 s of silence.
//! Points that cannot be played are counted. `asperity_openxr.h` does this for C.

use super::Feed;
use super::points::{Point, PointSettings, Points, PointsPort};
use crate::link::outlet::{Opened, PortKind, PortSetup};
use crate::model::bad_value::within;
use crate::model::error::AddError;
use asperity_dsp::limits::Range;

/// Amplitude below which nothing is felt.
const FLOOR: f32 = 1.0 / 256.0;
/// Span for which a runtime holds the last values of a stream, and half of it as a margin, ns.
const DRY_NS: f64 = 25e6;
/// Silence after which a stream ends, ns.
const SILENT_NS: i64 = 100_000_000;
/// Age beyond which a point begins no stream, s: one that began with it would lag for good.
const STALE_S: f64 = 0.05;
/// Lead over the clock beyond which a point is dropped, s: the engine's clock is the faster one.
const LEAD_S: f64 = 0.1;
/// Points of one frame at most; a call takes 500.
const AT_ONCE: usize = 128;

const FULL_SCALE: Range = Range::new(1e-9, 1e9, "1e-9 to 1e9");
const FIRST_FRAME_S: Range = Range::new(0.0, 1.0, "0 to 1 s");

/// A port of frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeadsetFrames {
    /// Which signal.
    pub from: Feed,
    /// Number of points a second, range of the device, and tone.
    pub settings: PointSettings,
    /// Sample value that counts as amplitude 1.
    pub full_scale: f64,
    /// Least length of a stream's first frame, s, 0 to 1, as the runtime says
    /// (`minimumFirstFrameDuration`).
    pub first_frame_s: f64,
    /// Span that a late reader still finds, s; 1 ms to 60 s.
    pub holds_s: f64,
}

/// Position of a frame in its stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameStage {
    /// `XR_HAPTIC_PARAMETRIC_STREAM_FRAME_TYPE_FIRST_FRAME_EXT`.
    First,
    /// Goes on.
    Intermediate,
    /// Ends the stream.
    Last,
}

/// A point of both envelopes of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FramePoint {
    /// ns since the stream began.
    pub time_ns: i64,
    /// 0 to 1.
    pub amplitude: f32,
    /// 0 to 1 of the range.
    pub frequency: f32,
}

/// Frame for one call of `xrApplyHapticFeedback`.
#[derive(Debug, Clone, PartialEq)]
pub struct HeadsetFrame {
    /// Position in its stream.
    pub stage: FrameStage,
    /// Points in their order; three at least in a first frame.
    pub points: Vec<FramePoint>,
    /// Range of frequencies, Hz; said by the first frame alone.
    pub band_hz: Option<[f64; 2]>,
}

/// Number of points by what became of them; together they are all that there were.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FrameCounts {
    /// In frames that were given.
    pub framed: u64,
    /// Silence that needs no call.
    pub silent: u64,
    /// Too old, ahead of the clock, or overwritten before they were read.
    pub dropped: u64,
}

/// Reads frames.
#[derive(Debug)]
pub struct HeadsetFramesPort {
    points: PointsPort,
    settings: PointSettings,
    full_scale: f64,
    first_ns: i64,
    /// Frequency of the point before.
    before: f32,
    stream: Option<Stream>,
    counts: FrameCounts,
}

#[derive(Debug, Clone, Copy)]
struct Stream {
    first_tick: u64,
    began_s: f64,
    last_ns: i64,
    felt_ns: i64,
}

impl PortKind for HeadsetFrames {
    type Port = HeadsetFramesPort;

    fn open(self, setup: &PortSetup<'_>) -> Result<Opened<HeadsetFramesPort>, AddError> {
        let Self { from, settings, full_scale, first_frame_s, holds_s } = self;
        within("full_scale", full_scale, FULL_SCALE)?;
        within("first_frame_s", first_frame_s, FIRST_FRAME_S)?;
        let Opened { outlet, port: points } = Points { from, settings, holds_s }.open(setup)?;
        let first_ns = (first_frame_s.max(1.0 / settings.rate_hz) * 1e9).ceil() as i64;
        let (before, stream, counts) = (0.0, None, FrameCounts::default());
        let port = HeadsetFramesPort { points, settings, full_scale, first_ns, before, stream, counts };
        Ok(Opened { outlet, port })
    }
}

impl HeadsetFramesPort {
    /// The next frame at `now_s` of any clock that only rises; none where nothing more is to be
    /// played by now.
    pub fn read(&mut self, now_s: f64) -> Option<HeadsetFrame> {
        loop {
            let points: Vec<Point> = std::iter::from_fn(|| self.points.read()).take(AT_ONCE).collect();
            if points.is_empty() {
                return None;
            }
            if let Some(frame) = self.frame(&points, now_s) {
                return Some(frame);
            }
        }
    }

    /// The runtime has refused a frame, lost its focus or begun another session: the next frame is
    /// the first of a stream.
    pub fn restart(&mut self) {
        self.stream = None;
    }

    /// Counts so far.
    #[must_use]
    pub fn counts(&self) -> FrameCounts {
        FrameCounts { dropped: self.counts.dropped + self.points.lost(), ..self.counts }
    }

    fn frame(&mut self, points: &[Point], now_s: f64) -> Option<HeadsetFrame> {
        // A stream that the runtime has run dry of is over.
        self.stream = self.stream.filter(|s| (now_s - s.began_s) * 1e9 <= s.last_ns as f64 + DRY_NS);
        let newest = (self.settings.rate_hz * STALE_S) as usize + 1;
        let stale = if self.stream.is_none() { points.len().saturating_sub(newest) } else { 0 };
        let (mut stage, mut filled) = (FrameStage::Intermediate, Vec::new());
        for (index, point) in points.iter().enumerate() {
            let amplitude = (point.amplitude / self.full_scale).clamp(0.0, 1.0) as f32;
            let [low_hz, high_hz] = self.settings.band_hz;
            let frequency = ((point.frequency_hz - low_hz) / (high_hz - low_hz)).clamp(0.0, 1.0) as f32;
            let before = std::mem::replace(&mut self.before, frequency);
            let is_felt = amplitude >= FLOOR;
            let at = |time_ns| FramePoint { time_ns, amplitude, frequency };
            let Some(stream) = &mut self.stream else {
                if !is_felt {
                    self.counts.silent += 1;
                } else if index < stale {
                    self.counts.dropped += 1;
                } else {
                    stage = FrameStage::First;
                    let (first_tick, last_ns) = (point.tick, self.first_ns);
                    self.stream = Some(Stream { first_tick, began_s: now_s, last_ns, felt_ns: 0 });
                    let silent = |time_ns| FramePoint { time_ns, amplitude: 0.0, frequency: before };
                    let rise_ns = self.first_ns - (1e9 / self.settings.rate_hz) as i64;
                    filled.extend([silent(0), silent(rise_ns), at(self.first_ns)]);
                    self.counts.framed += 1;
                }
                continue;
            };
            let since_s = (point.tick - stream.first_tick) as f64 / self.settings.rate_hz;
            let time_ns = self.first_ns + (since_s * 1e9) as i64;
            if is_felt {
                stream.felt_ns = time_ns;
            }
            if since_s - (now_s - stream.began_s) > LEAD_S {
                self.counts.dropped += 1;
                continue;
            }
            stream.last_ns = time_ns;
            filled.push(at(time_ns));
            self.counts.framed += 1;
        }
        let stream = self.stream?;
        let last = filled.last_mut()?;
        if stage == FrameStage::Intermediate && last.time_ns - stream.felt_ns > SILENT_NS {
            last.amplitude = 0.0;
            (stage, self.stream) = (FrameStage::Last, None);
        }
        let band_hz = (stage == FrameStage::First).then_some(self.settings.band_hz);
        Some(HeadsetFrame { stage, points: filled, band_hz })
    }
}
