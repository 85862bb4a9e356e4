//! Origin of the levels of bodies and surfaces that are added to an engine made in code.

use serde::{Deserialize, Serialize};

/// Policy by which bodies and surfaces get their levels when they are added.
///
/// With [`Shared`](Self::Shared) and [`Each`](Self::Each) the scene renders reference motions over
/// what is added, on the calling thread, before it goes out: a stroke of 0.1 m/s at 1 N in four
/// directions with every probe of the scene, and fifty strikes a second. They land on the reference
/// levels of scene files (−26 dBFS rms felt, −32 dBFS rms heard, strikes within full scale; see
/// [`load::levels`](crate::load::levels)). Equal content is measured once a scene, and the same
/// additions in the same order give the same levels. What the game sets counts on top:
/// [`AudioBus::gain`](crate::AudioBus::gain), [`Body::gain`](crate::Body::gain) and
/// [`Touching::gain`](crate::Touching::gain) as factors,
/// [`Body::strike_gain`](crate::Body::strike_gain) in the found one's place.
///
/// Motions of rigid things range over five decades of force, which no one gain fits. So a blow that
/// would peak at x times full scale peaks at x / √(1 + x²), and what slides unfelt grows no further
/// than a stroke of reference level may; a limiter of [`Config::live`](crate::Config::live) holds
/// what several of them add up to.
///
/// Sand is not rendered over, because it would keep the print, and friction that sticks and slips
/// has the level of its body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LevelPolicy {
    /// Everything is as loud as its numbers say: modes, gains, `full_scale`.
    #[default]
    AsGiven,
    /// The first thing sets a level that all share, so that things keep their differences; one that
    /// would be louder than the reference lands on it. What sounds already is left as it is.
    Shared,
    /// Each body and each surface lands on the reference.
    Each,
}

impl LevelPolicy {
    /// Factor that brings a thing of level `found` (0 for a silent one) to `reference`; `shared` is
    /// what the first one has got.
    pub(crate) fn factor(self, reference: f64, found: f64, shared: &mut Option<f64>) -> f64 {
        if !(found.is_finite() && found > f64::MIN_POSITIVE) {
            return shared.filter(|_| self == Self::Shared).unwrap_or(1.0);
        }
        let own = reference / found;
        match self {
            Self::AsGiven => 1.0,
            Self::Each => own,
            Self::Shared => own.min(*shared.get_or_insert(own)),
        }
    }
}
