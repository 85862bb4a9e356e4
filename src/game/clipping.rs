//! Why something is too loud: which body or surface, by how much, and what to turn.
//!
//! [`Scene::why_clipped`](crate::Scene::why_clipped) is the brother of
//! [`why_silent`](crate::Scene::why_silent). The hardest blow on each body and the strongest stroke
//! on each surface are kept as they are reported; what the blows peak at follows from a reference
//! strike that is rendered when the question is asked.

use crate::model::event::{ContactEvent, ContactId, ContactSample};
use crate::model::id::{BodyId, SurfaceId};
use std::collections::HashMap;

/// Less than this over full scale is not reported, dB.
pub(crate) const TOLD_DB: f64 = 0.5;

/// A reason why more leaves than full scale holds. Its text says what to turn, and by how much.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClipReason {
    /// Impacts on a body are too hard for its level.
    #[error(
        "impacts on body {body} peak {by_db:.0} dB over full scale; let its strike_gain be {strike_gain:.2e} \
         (Body::strike_gain), or lower its gain (Body::gain) or that of its bus (AudioBus::gain) by as much"
    )]
    Blows {
        /// The body.
        body: BodyId,
        /// By how much, dB.
        by_db: f64,
        /// The gain of impacts with which its hardest one peaks at full scale.
        strike_gain: f64,
    },
    /// Strokes on a surface are the strongest of what was reported, and no blow explains it.
    #[error(
        "strokes on surface {surface}, at up to {force_n:.2} N and {speed_m_s:.2} m/s, are {by_db:.0} dB over full scale; \
         lower relief_m or micro_relief_m of the surface, the gain of its body (Body::gain) or bus (AudioBus::gain) by \
         as much, or raise full_scale of the actuator that feels it"
    )]
    Strokes {
        /// The surface.
        surface: SurfaceId,
        /// By how much, dB.
        by_db: f64,
        /// Greatest force of them, N.
        force_n: f64,
        /// Greatest speed of them, m/s.
        speed_m_s: f64,
    },
    /// More is felt than a haptic channel plays.
    #[error(
        "what is felt is {by_db:.0} dB over full scale of a haptic channel; raise full_scale of the actuator, or lower \
         gain of the impacts and contacts that are felt (Impact::gain, Touching::gain)"
    )]
    Felt {
        /// By how much, dB.
        by_db: f64,
    },
    /// Several things add up.
    #[error(
        "what sounds at once adds up to {by_db:.0} dB over full scale; lower gain of the bus (AudioBus::gain), or raise \
         full_scale of the actuator"
    )]
    Sum {
        /// By how much, dB.
        by_db: f64,
    },
}

impl ClipReason {
    /// By how much it is over full scale, dB.
    #[must_use]
    pub fn by_db(&self) -> f64 {
        match self {
            Self::Blows { by_db, .. }
            | Self::Strokes { by_db, .. }
            | Self::Felt { by_db }
            | Self::Sum { by_db } => *by_db,
        }
    }
}

impl ClipReason {
    /// Peak of a blow that outlasts the reference strike, which is lower: at most what has left.
    pub(crate) fn hold(&mut self, most_db: f64) {
        if let Self::Blows { by_db, strike_gain, .. } = self
            && *by_db > most_db
        {
            *strike_gain *= libm::pow(10.0, (*by_db - most_db) / 20.0);
            *by_db = most_db;
        }
    }
}

/// The strongest of what was reported.
#[derive(Debug, Default)]
pub(crate) struct Strongest {
    /// Impulse of the hardest blow on each body, N·s.
    pub(crate) blows_n_s: HashMap<BodyId, f64>,
    /// Greatest force and speed on each surface, N and m/s.
    pub(crate) strokes: HashMap<SurfaceId, [f64; 2]>,
}

impl Strongest {
    /// Keeps an event that was sent; `touched` is the surface of a contact.
    pub(crate) fn note(&mut self, event: &ContactEvent, touched: impl Fn(ContactId) -> Option<SurfaceId>) {
        match event {
            ContactEvent::Impact(impact) => {
                let bodies = [Some(impact.body), impact.other, impact.holder];
                for body in bodies.into_iter().flatten() {
                    let most = self.blows_n_s.entry(body).or_default();
                    *most = most.max(impact.impulse_n_s());
                }
            }
            ContactEvent::Begin { contact, sample, .. } | ContactEvent::Moved { contact, sample, .. } => {
                if let Some(surface) = touched(*contact) {
                    let most = self.strokes.entry(surface).or_default();
                    *most = [most[0].max(sample.normal_force_n), most[1].max(speed_m_s(sample))];
                }
            }
            ContactEvent::End { .. } | ContactEvent::Motion { .. } => {}
        }
    }

    /// The surface of the strongest strokes.
    pub(crate) fn stroked(&self) -> Option<(SurfaceId, [f64; 2])> {
        let strokes = self.strokes.iter().map(|(surface, most)| (*surface, *most));
        strokes.max_by(|(a, [f, v]), (b, [g, w])| (f * v).total_cmp(&(g * w)).then(a.cmp(b)))
    }
}

fn speed_m_s(sample: &ContactSample) -> f64 {
    sample.velocity_m_s.map_or(0.0, |[u, v]| libm::hypot(u, v))
}
