//! Levels port: how hard two motors turn, a heavy one for what is slow and a light one for what is
//! fast.

use super::Feed;
use super::points::{Point, PointSettings, Points, PointsPort, Tone};
use crate::link::outlet::{Opened, PortKind, PortSetup};
use crate::model::error::AddError;

/// Range of the tone that a pad never plays, Hz.
const ANY_HZ: [f64; 2] = [20.0, 250.0];

/// A port of two levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels {
    /// Which signal.
    pub from: Feed,
    /// Number a second; pads take 20 to 60.
    pub rate_hz: f64,
    /// Span that a late reader still finds, s; 1 ms to 60 s.
    pub holds_s: f64,
}

/// Reads levels.
#[derive(Debug)]
pub struct LevelsPort {
    points: PointsPort,
    newest: [f64; 2],
}

impl PortKind for Levels {
    type Port = LevelsPort;

    fn open(self, setup: &PortSetup<'_>) -> Result<Opened<LevelsPort>, AddError> {
        let settings = PointSettings { rate_hz: self.rate_hz, band_hz: ANY_HZ, tone: Tone::Strongest };
        let points = Points { from: self.from, settings, holds_s: self.holds_s };
        let Opened { outlet, port } = points.open(setup)?;
        Ok(Opened { outlet, port: LevelsPort { points: port, newest: [0.0; 2] } })
    }
}

impl LevelsPort {
    /// The oldest levels that are left, heavy and light, as peaks of sines in the unit of the
    /// samples.
    pub fn read(&mut self) -> Option<[f64; 2]> {
        let Point { low, high, .. } = self.points.read()?;
        self.newest = [low, high];
        Some(self.newest)
    }

    /// The newest levels; what lies before is passed over, and is not counted as lost. The last
    /// ones again when nothing is new.
    pub fn newest(&mut self) -> [f64; 2] {
        while self.read().is_some() {}
        self.newest
    }

    /// Levels that were overwritten before they were read.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.points.lost()
    }
}
