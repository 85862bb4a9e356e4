//! Clock modes: how game seconds become samples.

/// Conversion of a stamp to a sample.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum ClockMode {
    /// Sample = t · rate: offline renders and replays. A game whose time runs ahead of the audio
    /// waits for the audio to get there, and one that pauses is late from then on: see
    /// [`Scene::reset`](crate::Scene::reset).
    #[default]
    Exact,
    /// Follow the device: for a game whose audio runs on a sound card. Pauses, restarts, slow
    /// motion, stamps off by any amount and ticks in bursts are followed and counted; see
    /// [`Config::live`](crate::Config::live).
    Live {
        /// Longest time that all stamps may lie ahead of the audio, s; more is latency nobody
        /// needs, and taken away.
        max_lead_s: f64,
    },
}

impl ClockMode {
    /// The live mode with its default window of 50 ms.
    pub const LIVE: Self = Self::Live { max_lead_s: 0.05 };
}
