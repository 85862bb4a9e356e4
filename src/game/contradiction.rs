//! Contradictions: one motion that a game's reports state twice, and differently.
//!
//! [`Motions`] compares what is reported on each surface; what it finds stands among the reasons of
//! [`Scene::why_silent`](crate::Scene::why_silent).

mod motions;

use crate::model::id::SurfaceId;
pub(crate) use motions::{Motions, Sheet};
use std::fmt;

/// Disagreement between two things that the reports of one surface say of the same motion.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Contradiction {
    /// Place and velocity move at different speeds.
    Speed {
        /// Surface of the reports.
        surface: SurfaceId,
        /// Speed at which uv moves, m/s.
        uv_m_s: f64,
        /// Speed that `velocity_m_s` says, m/s.
        velocity_m_s: f64,
        /// Likeliest cause of the factor between them.
        likely: Likely,
    },
    /// The velocity points against the motion of uv, along the axes that are true.
    Turned {
        /// Surface of the reports.
        surface: SurfaceId,
        /// Along u and along v.
        axes: [bool; 2],
    },
    /// The velocity along v is that of u, and the other way round.
    Swapped {
        /// Surface of the reports.
        surface: SurfaceId,
    },
    /// Contacts begin again while they touch.
    BeginsAgain {
        /// Surface of the reports.
        surface: SurfaceId,
        /// Number of such begins.
        count: u32,
    },
    /// One contact is at two places in turn.
    TwoPlaces {
        /// Surface of the reports.
        surface: SurfaceId,
        /// Number of leaps.
        count: u32,
    },
    /// The point of a contact hops, as among the corners of what slides, and no velocity says how
    /// fast it slides.
    Hops {
        /// Surface of the reports.
        surface: SurfaceId,
        /// Number of hops.
        count: u32,
    },
}

/// Likeliest cause of a factor between two speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Likely {
    /// uv in metres, or the velocity in uv a second: the same factor.
    UvInMetres,
    /// uv in centimetres.
    UvInCentimetres,
    /// uv in millimetres.
    UvInMillimetres,
    /// uv in texels.
    UvInTexels,
    /// The velocity in mm/s.
    VelocityInMillimetres,
    /// The velocity in cm/s.
    VelocityInCentimetres,
    /// Times in milliseconds.
    TimesInMilliseconds,
    /// uv spans another width and height than the surface's, m; none along an axis that was not
    /// used.
    AnotherSize([Option<f64>; 2]),
}

impl Contradiction {
    /// The surface whose reports contradict themselves.
    #[must_use]
    pub fn surface(&self) -> SurfaceId {
        match self {
            Self::Speed { surface, .. }
            | Self::Turned { surface, .. }
            | Self::Swapped { surface }
            | Self::BeginsAgain { surface, .. }
            | Self::TwoPlaces { surface, .. }
            | Self::Hops { surface, .. } => *surface,
        }
    }
}

impl fmt::Display for Contradiction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Speed { uv_m_s, velocity_m_s, likely, .. } => write!(
                f,
                "uv moves at {uv_m_s:.3} m/s where velocity_m_s says {velocity_m_s:.3} m/s: {likely}; uv 1 is the \
                 surface's width_m and height_m, velocity_m_s is in m/s, t in seconds"
            ),
            Self::Turned { axes: [u, v], .. } => {
                let along = match (u, v) {
                    (true, false) => "u of velocity_m_s points",
                    (false, true) => "v of velocity_m_s points",
                    _ => "velocity_m_s points",
                };
                write!(
                    f,
                    "{along} against the way uv moves; turn its sign (v grows downwards in the picture)"
                )
            }
            Self::Swapped { .. } => f.write_str(
                "velocity_m_s has the speed of u where that of v belongs; write [along u, along v]",
            ),
            Self::BeginsAgain { count, .. } => write!(
                f,
                "{count} begins of a contact that touches already; report a \"move\" where it goes on, and an \"end\" before \
                 it begins again"
            ),
            Self::TwoPlaces { count, .. } => write!(
                f,
                "one contact leaps between two places, {count} times; give each finger a contact number of its own"
            ),
            Self::Hops { count, .. } => write!(
                f,
                "the point of a contact hops, {count} times, as among the corners of a box, and each hop sounds as a fast stroke; report \
                 velocity_m_s with it, the velocity of what slides, or a place that does not hop"
            ),
        }
    }
}

impl fmt::Display for Likely {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::UvInMetres => "is uv in metres, or velocity_m_s in uv a second?",
            Self::UvInCentimetres => "is uv in centimetres?",
            Self::UvInMillimetres => "is uv in millimetres?",
            Self::UvInTexels => "is uv in texels?",
            Self::VelocityInMillimetres => "is velocity_m_s in mm/s?",
            Self::VelocityInCentimetres => "is velocity_m_s in cm/s?",
            Self::TimesInMilliseconds => "are times in milliseconds?",
            Self::AnotherSize([width_m, height_m]) => {
                let edges = [("wide", width_m), ("high", height_m)];
                let edges: Vec<String> =
                    edges.iter().filter_map(|(word, m)| m.map(|m| format!("{m:.3} m {word}"))).collect();
                return write!(f, "is uv 1 of a plane that is {}?", edges.join(" and "));
            }
        };
        f.write_str(text)
    }
}
