//! The named cases on which choices err: six strokes of one fingertip, each a scene that renders.
//!
//! | case | ground | m/s | N | what is hard about it |
//! |---|---|---|---|---|
//! | `smooth` | three waves of 1–3 mm, 20 µm | 0.1 | 0.5 | nothing |
//! | `rough` | micro-relief, R = 0.9 | 0.1 | 0.5 | the profile moves between two samples |
//! | `bouncing` | waves of 1 mm, 50 µm | 0.3 | 0.15 | the pad leaves every crest and lands, less far than the leash |
//! | `steep` | teeth of 0.6 mm, 5 mm apart | 0.1 | 0.2 | the pad falls off every tooth, and heights bend within two texels |
//! | `fast` | micro-relief, R = 0.5 | 0.8 | 0.5 | wavelengths pass in a few samples |
//! | `light` | micro-relief, R = 0.5 | 0.1 | 0.05 | hardly pressed, the pad hops |
//!
//! Wavelengths, heights and phases of a ground are drawn from a seed, so that there are as many
//! profiles of a kind as wanted. What is stated of a case is the rms over [`SEEDS`] (of integrators
//! over those whose stroke loses its beginning); the scene that is written is that of the first.

mod files;
mod render;

pub use files::{SEEDS, STROKE_S, files, memory, move_along};
pub use render::{Chain, Signal, Take, take};

use asperity_dsp::rng::Rng;
use std::f64::consts::PI;

/// Extent along the stroke of the maps, m.
pub const LENGTH_M: f64 = 0.14;
/// Texels along the stroke.
const TEXELS: usize = 2048;

/// A kind of profile, and how it is stroked.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// As it is called in the report.
    pub name: &'static str,
    /// Surface that is touched.
    ground: Ground,
    /// Along u, m/s.
    pub speed_m_s: f64,
    /// N.
    pub force_n: f64,
}

#[derive(Debug, Clone, Copy)]
enum Ground {
    /// A map of waves: waves along the map from … to …, their number, and the amplitude of each, m.
    Waves { periods: (usize, usize), count: usize, amplitude_m: f64 },
    /// A map of teeth: about so many, m high, their fall as a share of their length.
    Teeth { about: usize, height_m: f64, fall: f64 },
    /// Micro-relief alone, of this roughness.
    Rough(f64),
}

/// Every case, in the order of the report.
pub const CASES: [Case; 6] = [
    Case {
        name: "smooth",
        ground: Ground::Waves { periods: (47, 140), count: 3, amplitude_m: 2e-5 },
        speed_m_s: 0.1,
        force_n: 0.5,
    },
    Case { name: "rough", ground: Ground::Rough(0.9), speed_m_s: 0.1, force_n: 0.5 },
    Case {
        name: "bouncing",
        ground: Ground::Waves { periods: (124, 156), count: 1, amplitude_m: 5e-5 },
        speed_m_s: 0.3,
        force_n: 0.15,
    },
    Case {
        name: "steep",
        ground: Ground::Teeth { about: 28, height_m: 6e-4, fall: 0.06 },
        speed_m_s: 0.1,
        force_n: 0.2,
    },
    Case { name: "fast", ground: Ground::Rough(0.5), speed_m_s: 0.8, force_n: 0.5 },
    Case { name: "light", ground: Ground::Rough(0.5), speed_m_s: 0.1, force_n: 0.05 },
];

/// Strokes of a real hand, reported 60 times a second: two gratings, and a rough plate.
pub const FROM_REPORTS: [Case; 3] = [
    Case {
        name: "grating of 2 mm",
        ground: Ground::Waves { periods: (70, 70), count: 1, amplitude_m: 2e-5 },
        speed_m_s: 0.1,
        force_n: 0.5,
    },
    Case {
        name: "grating of 7 mm",
        ground: Ground::Waves { periods: (20, 20), count: 1, amplitude_m: 1e-4 },
        speed_m_s: 0.1,
        force_n: 0.5,
    },
    Case { name: "rough plate", ground: Ground::Rough(0.5), speed_m_s: 0.1, force_n: 0.5 },
];

/// Heights over places.
type Height = Box<dyn Fn(f64) -> f64>;

impl Case {
    /// The ground as a map along the stroke, 0–1, the equation that the map is drawn from, and the
    /// height of 1 over 0, m.
    pub fn relief(&self, seed: u64) -> Option<(Vec<f64>, Height, f64)> {
        let (heights, _) = self.ground.map(seed)?;
        self.ground.height(seed).map(|(height, relief_m)| (heights, height, relief_m))
    }

    /// Roughness of its micro-relief, where that is all there is.
    pub fn roughness(&self) -> Option<f64> {
        self.ground.roughness()
    }

    /// Places along u at this rate, m, from the beginning of a render to the finger's going.
    pub fn places_m(&self, rate_hz: f64) -> Vec<f64> {
        let (begin_s, end_s) = STROKE_S;
        let at = |n: usize| 0.1 * LENGTH_M + self.speed_m_s * (n as f64 / rate_hz - begin_s);
        (0..(end_s * rate_hz) as usize).map(at).collect()
    }
}

impl Ground {
    /// Roughness of the overlay; none where a map is all there is.
    fn roughness(self) -> Option<f64> {
        match self {
            Self::Rough(roughness) => Some(roughness),
            Self::Waves { .. } | Self::Teeth { .. } => None,
        }
    }

    /// The heights of a map along the stroke, 0–1, and their height of 1 over 0, m.
    fn map(self, seed: u64) -> Option<(Vec<f64>, f64)> {
        let (height, relief_m) = self.height(seed)?;
        let places = (0..TEXELS).map(|texel| (texel as f64 + 0.5) / TEXELS as f64);
        Some((places.map(height).collect(), relief_m))
    }

    /// Height at a share of the map's length, 0–1, as the map is drawn from it, and the height of 1
    /// over 0, m.
    fn height(self, seed: u64) -> Option<(Height, f64)> {
        let mut rng = Rng::new(seed);
        match self {
            Self::Rough(_) => None,
            Self::Waves { periods: (fewest, most), count, amplitude_m } => {
                let waves: Vec<[f64; 2]> = (0..count)
                    .map(|_| {
                        let periods = fewest as f64 + ((most - fewest) as f64 * rng.uniform()).round();
                        [periods, rng.uniform()]
                    })
                    .collect();
                let height = move |x: f64| -> f64 {
                    waves.iter().map(|[periods, phase]| (2.0 * PI * (periods * x + phase)).sin()).sum()
                };
                let relief_m = 2.0 * amplitude_m * count as f64;
                Some((Box::new(move |x| 0.5 + 0.5 * height(x) / count as f64), relief_m))
            }
            Self::Teeth { about, height_m, fall } => {
                let teeth = about as f64 - 3.0 + (6.0 * rng.uniform()).round();
                let phase = rng.uniform();
                let height = move |x: f64| {
                    let along = (teeth * x + phase).fract();
                    if along < 1.0 - fall { along / (1.0 - fall) } else { (1.0 - along) / fall }
                };
                Some((Box::new(height), height_m))
            }
        }
    }
}
