//! The part a contact plays: what touches, who feels it, what is held.

use crate::model::event::{Emphasis, Touching};
use crate::model::id::{BodyId, ProbeId};

/// Role: what touches, who feels it and what is held, fixed while a contact lasts; how loud and
/// how important it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Binding {
    /// Haptic channel; none = heard only.
    pub(crate) actuator: Option<usize>,
    /// Place of the probe; none = the engine's own.
    pub(crate) probe: Option<usize>,
    /// Body that rings with it.
    pub(crate) holder: Option<BodyId>,
    pub(crate) gain: f64,
    pub(crate) importance: f64,
}

impl Binding {
    /// Another gain or importance.
    pub(crate) fn emphasise(&mut self, emphasis: Emphasis) {
        self.gain = emphasis.gain.unwrap_or(self.gain);
        self.importance = emphasis.importance.unwrap_or(self.importance);
    }
}

impl Default for Binding {
    fn default() -> Self {
        Self { actuator: None, probe: None, holder: None, gain: 1.0, importance: 1.0 }
    }
}

impl From<&Touching> for Binding {
    fn from(touching: &Touching) -> Self {
        Self {
            actuator: touching.actuator.map(|actuator| usize::from(actuator.0)),
            probe: touching.probe.map(ProbeId::index),
            holder: touching.holder,
            gain: touching.gain,
            importance: touching.importance,
        }
    }
}
