//! Squares in frames, and the six reliefs of the thesis (§8.3) seen from the light: patterns whose
//! outlines are nearly, but not quite, a pattern of their own on a finer lattice.

#![allow(dead_code, reason = "each user takes what it needs")]

use asperity_dsp::rng::Rng;
use asperity_evidence::reliefs::{Relief, square_distance};
pub use asperity_evidence::reliefs::{SHAPES, Shape};
use asperity_surface::raster::Raster;

/// Squares outlined by lines, on a square lattice.
#[derive(Debug, Clone, Copy)]
pub struct Framed {
    /// Width and height of the picture, texels.
    pub size: usize,
    /// Distance from square to square, texels.
    pub period: f64,
    /// Ground between two squares, share of the period.
    pub gap: f64,
    /// Width of the lines, texels.
    pub outline: f64,
    /// Whether the corners are round.
    pub rounded: bool,
    /// Standard deviation of white noise; the line stands 1 above its ground.
    pub noise: f64,
}

impl Framed {
    /// The picture; `seed` is the noise's.
    pub fn picture(&self, seed: u64) -> Raster {
        let mut rng = Rng::new(seed);
        let half = 0.5 * (1.0 - self.gap) * self.period;
        let radius = if self.rounded { 0.5 * half } else { 0.0 };
        Raster::from_fn(self.size, self.size, |x, y| {
            let inside = half - square_distance(self.off_centre(x), self.off_centre(y), half, radius);
            let noise = if self.noise > 0.0 { self.noise * rng.normal() } else { 0.0 };
            self.line(inside) + noise
        })
    }

    /// How much of a texel the line covers, `inside` texels from the square's border. Where the
    /// period is whole the line is too.
    fn line(&self, inside: f64) -> f64 {
        if self.period.fract() == 0.0 {
            // Borders that fall on the middle of a texel fall on the same side of it in every cell.
            let within = |edge: f64| inside > edge + 1e-6;
            return f64::from(u8::from(within(0.0) && !within(self.outline)));
        }
        (inside + 0.5).clamp(0.0, 1.0) - (inside - self.outline + 0.5).clamp(0.0, 1.0)
    }

    /// Distance from the middle of the texel's cell along one axis, texels.
    fn off_centre(&self, texel: usize) -> f64 {
        let along = (texel as f64 + 0.5) / self.period;
        (along - along.floor() - 0.5) * self.period
    }

    /// Its translations.
    pub fn truth(&self) -> [[f64; 2]; 2] {
        [[self.period, 0.0], [0.0, self.period]]
    }

    /// The audit's kind of grid: sizes, periods, gaps, widths, both corners, without noise and
    /// with.
    pub fn grid() -> Vec<Self> {
        let mut all = Vec::new();
        for size in [240, 256, 400] {
            for period in [20.0, 24.0, 30.0, 32.0, 40.0, 48.0] {
                for gap in [0.1, 0.2, 0.25, 0.4] {
                    for outline in [1.0, 2.0, 3.0] {
                        for rounded in [false, true] {
                            for noise in [0.0, 0.1] {
                                all.push(Self { size, period, gap, outline, rounded, noise });
                            }
                        }
                    }
                }
            }
        }
        all
    }

    /// One with everything drawn by lot, the period too; at least `repeats` of them a side.
    pub fn drawn(seed: u64, repeats: f64) -> Self {
        let mut rng = Rng::new(seed ^ 0x0f8a_3ed5);
        let size = [240, 256, 400][(3.0 * rng.uniform()) as usize];
        let longest = (size as f64 / repeats).min(48.0);
        Self {
            size,
            period: 20.0 + (longest - 20.0) * rng.uniform(),
            gap: 0.1 + 0.3 * rng.uniform(),
            outline: 1.0 + 2.0 * rng.uniform(),
            rounded: rng.uniform() < 0.5,
            noise: if rng.uniform() < 0.5 { 0.0 } else { 0.2 * rng.uniform() },
        }
    }
}

/// Heights, texels, of `across` shapes a side on a picture of `size`², and their translations.
pub fn thesis_relief(shape: Shape, across: f64, size: usize) -> (Raster, [[f64; 2]; 2]) {
    let relief = Relief { shape, across, size };
    (Raster::from_fn(size, size, |x, y| relief.height(x, y)), relief.translations())
}

/// How bright a relief is under light from the front: 1/√(1 + p² + q²), the printed condition of
/// the thesis.
pub fn frontally_lit(relief: &Raster) -> Raster {
    Raster::from_fn(relief.width, relief.height, |x, y| {
        let p = relief.at(x, y) - relief.at(x.saturating_sub(1), y);
        let q = relief.at(x, y) - relief.at(x, y.saturating_sub(1));
        1.0 / (1.0 + p * p + q * q).sqrt()
    })
}

/// All six reliefs at three sizes, as heights and under frontal light, without noise and with.
pub fn thesis_pictures() -> Vec<(String, Raster, [[f64; 2]; 2])> {
    let mut all = Vec::new();
    for size in [240, 256, 400] {
        for shape in SHAPES {
            for across in [6.0, 8.0] {
                let (relief, truth) = thesis_relief(shape, across, size);
                for (kind, picture) in [("heights", relief.clone()), ("lit", frontally_lit(&relief))] {
                    for noise in [0.0, 0.05] {
                        let (low, high) = picture.range();
                        let mut rng = Rng::new(size as u64 + across as u64);
                        let noisy = picture.map(|v| v + noise * (high - low) * rng.normal());
                        all.push((format!("{shape:?}{across} {size} {kind} noise {noise}"), noisy, truth));
                    }
                }
            }
        }
    }
    all
}
