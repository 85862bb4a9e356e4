//! Map of a surface with lines: they run along v, and the relief lies beneath.
//!
//! Mirrored at its edges the map goes on without a seam: it is cut at tops of the strongest line.

use crate::octaves::OUTER_SCALE_M;
use crate::surface::StrokeSurface;
use asperity_dsp::fractal_noise::{FractalNoise, NoisePath, OctaveWeights, Relief};
use std::f64::consts::PI;

/// Texels of a side, and of the shortest line.
pub const TEXELS: usize = 1024;
const TEXELS_A_PERIOD: f64 = 14.0;
/// Seed of the relief.
const SEED: u64 = 61;

/// A square map.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    /// Side, m.
    pub side_m: f64,
    /// Heights, m: rows of [`TEXELS`].
    pub height_m: Vec<f64>,
}

impl Pattern {
    /// Lines and relief of a surface; none where it has no line.
    #[must_use]
    pub fn of(found: &StrokeSurface) -> Option<Self> {
        let strongest_m = found.lines.first()?.period_m;
        let shortest_m = found.lines.iter().map(|line| line.period_m).fold(f64::INFINITY, f64::min);
        let periods = (shortest_m / TEXELS_A_PERIOD * TEXELS as f64 / strongest_m).round().max(2.0);
        let side_m = periods * strongest_m;
        let texel_m = side_m / TEXELS as f64;
        // The map is ridden by the tip itself, so the relief goes in as no tip has ridden it.
        let weights = OctaveWeights::new(&Relief {
            rms_at_1mm_m: found.relief.micro_relief_m,
            outer_scale_m: OUTER_SCALE_M,
            tip_radius_m: 0.0,
            longest_wavelength_m: f64::INFINITY,
        })
        .with_gains_db(&found.relief.octaves_db);
        let field = FractalNoise::new(SEED);
        let mut height_m = vec![0.0; TEXELS * TEXELS];
        let (footprint_m, roughness) = (vec![texel_m; TEXELS], vec![found.relief.roughness; TEXELS]);
        for (row, height_m) in height_m.chunks_mut(TEXELS).enumerate() {
            let at = |i: usize| texel_m * (i as f64 + 0.5);
            let position_m: Vec<[f64; 2]> = (0..TEXELS).map(|i| [at(i), at(row)]).collect();
            let path = NoisePath { position_m: &position_m, footprint_m: &footprint_m };
            field.add(&path, &roughness, &weights, height_m);
            for line in &found.lines {
                for (height_m, [x, _]) in height_m.iter_mut().zip(&position_m) {
                    *height_m += line.amplitude_m * (2.0 * PI * x / line.period_m).cos();
                }
            }
        }
        Some(Self { side_m, height_m })
    }
}
