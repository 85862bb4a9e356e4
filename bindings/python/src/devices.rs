//! Live ports of haptic channels: frames for a headset, levels for a pad.

use crate::error::refused;
use crate::live::LiveScene;
use asperity::ChannelId;
use asperity::live::ports::{Feed, FrameCounts, FrameStage, HeadsetFrames, HeadsetFramesPort};
use asperity::live::ports::{Levels, LevelsPort, PointSettings, Tone};
use pyo3::prelude::*;

/// Stage, times in ns, amplitudes, frequencies, and the range that a first frame says.
type Frame = (&'static str, Vec<i64>, Vec<f32>, Vec<f32>, Option<[f64; 2]>);

/// Frames for the controller of a headset.
#[pyclass(module = "asperity._native")]
pub struct LiveFrames(HeadsetFramesPort);

#[pymethods]
impl LiveFrames {
    #[new]
    fn new(
        scene: &LiveScene,
        channel: u16,
        rate_hz: f64,
        band_hz: [f64; 2],
        full_scale: f64,
        first_frame_s: f64,
        holds_s: f64,
    ) -> PyResult<Self> {
        let from = Feed::Haptic(ChannelId(channel));
        let settings = PointSettings { rate_hz, band_hz, tone: Tone::Drawn };
        let kind = HeadsetFrames { from, settings, full_scale, first_frame_s, holds_s };
        scene.with(|scene| scene.open_port(kind).map(Self).map_err(refused))
    }

    fn read(&mut self, now_s: f64) -> Option<Frame> {
        let frame = self.0.read(now_s)?;
        let stage = match frame.stage {
            FrameStage::First => "first",
            FrameStage::Intermediate => "intermediate",
            FrameStage::Last => "last",
        };
        let points = || frame.points.iter();
        let amplitudes = points().map(|point| point.amplitude).collect();
        let frequencies = points().map(|point| point.frequency).collect();
        Some((stage, points().map(|point| point.time_ns).collect(), amplitudes, frequencies, frame.band_hz))
    }

    fn restart(&mut self) {
        self.0.restart();
    }

    fn counts(&self) -> (u64, u64, u64) {
        let FrameCounts { framed, silent, dropped } = self.0.counts();
        (framed, silent, dropped)
    }
}

/// Levels of a pad's two motors.
#[pyclass(module = "asperity._native")]
pub struct LiveLevels(LevelsPort);

#[pymethods]
impl LiveLevels {
    #[new]
    fn new(scene: &LiveScene, channel: u16, rate_hz: f64, holds_s: f64) -> PyResult<Self> {
        let kind = Levels { from: Feed::Haptic(ChannelId(channel)), rate_hz, holds_s };
        scene.with(|scene| scene.open_port(kind).map(Self).map_err(refused))
    }

    fn read(&mut self) -> Option<[f64; 2]> {
        self.0.read()
    }

    fn newest(&mut self) -> [f64; 2] {
        self.0.newest()
    }

    fn lost(&self) -> u64 {
        self.0.lost()
    }
}
