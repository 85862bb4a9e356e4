//! Micro-relief: spatial 1/f^α noise whose exponent follows the roughness map.
//!
//! ```text
//! h(p) = L(R) · Σᵢ r^(i − 4) · wᵢ(R) · Wᵢ · n(Qᵢ p / aᵢ + oᵢ)     α = 2.5 − 1.5 R,  r = 2^((1 − α)/2)
//! aᵢ = 16.384 mm / 2^i, i = 0 … 11                              PSD of h along a line ∝ f^(−α)
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | n | [`crate::gradient_noise_2d`] | one octave, cell length aᵢ |
//! | Qᵢ, oᵢ | three rotations 30° apart, seeded offsets | so that no direction follows the lattice |
//! | R | `roughness` | per sample: it changes gains, never positions |
//! | L(R) | `level` | makes the rms in the octave of wavelengths about 1 mm equal 1 for every R |
//! | wᵢ(R) | [`OctaveWeights`] | how rough the surface is, its outer scale, the tip that rides on it |
//! | Wᵢ | `footprint_weight`, `tail_boost` | below |
//!
//! Source: Hasti §III-C (1/f^α overlay, α = 2.5 − 1.5 R). **What we changed.** The paper filters a
//! temporal noise and divides by the speed. This noise is a function of the place: the same place
//! feels the same, out and back, and the temporal amplitude follows v^((α−1)/2) by itself (measured
//! level at 4 × speed: within 0.1 dB of 6.02 (α − 1)).
//!
//! *Footprint.* An octave whose cell is crossed in c samples fades out from c = 4 to c = 2, so
//! nothing aliases (≤ −40 dB), and octaves that have faded out are not computed. *Tail.* A
//! gradient-noise octave has a white tail below its peak. Where the octaves end, the tails of the
//! missing finer ones are missing too: at α = 1 the spectrum tilts by 0.11–0.26 dB per octave.
//! Boosting the finest living octave by a fitted 0.8–2.8 dB puts the tail back: computed level
//! within 0.06 dB of the law over 2.5 decades (fit: `tests/independent/noise_spectrum.py`). *Own
//! band of the source.* Octaves whose wavelength is above `longest_wavelength_m` fade out within
//! one octave, so that no scale is rough twice.
//!
//! Everything a sample needs is its own position, footprint and roughness, and every instruction
//! set performs the same operations in the same order: the bits depend neither on blocks nor on the
//! machine.
//!
//! *Speed.* The eight or sixteen samples side by side (sixteen where a register holds eight or
//! more, so that what is the same in all of them is spread over the lanes once for two registers)
//! are mostly in one cell of a slow octave. Its four gradients are hashed once and kept until a
//! sample leaves the cell, which one comparison of the samples' bounds shows. This changes no bit.

mod cells;
mod gains;
mod lanes;
mod rough;
#[cfg(test)]
mod tests;
mod weights;

use crate::gradient_noise_2d::PEAK_WAVELENGTH_CELLS;
use crate::rng::Rng;
use crate::simd::{Level, at_level};
use cells::{KnownCell, Offset};

pub use weights::{InterpolationError, OctaveWeights, Relief, growth};

/// Number of octaves.
pub const OCTAVES: usize = 12;
/// Cell length of the coarsest octave, m; its noise peaks at a wavelength of 31 mm.
pub const LONGEST_CELL_M: f64 = 16.384e-3;
/// Cell length of the finest octave, m; its noise peaks at a wavelength of 15 µm.
pub const SHORTEST_CELL_M: f64 = LONGEST_CELL_M / (1 << (OCTAVES - 1)) as f64;

/// Orientations of the lattices, radians: 7.5°, 37.5°, 67.5°, so that neither a straight nor a
/// diagonal stroke runs along one.
const ROTATIONS: usize = 3;
const ROTATION_RAD: [f64; ROTATIONS] =
    [0.130_899_693_899_574_7, 0.654_498_469_497_873_6, 1.178_097_245_096_172_4];

/// Places of a contact, sample by sample. Both slices are equally long.
#[derive(Debug, Clone, Copy)]
pub struct NoisePath<'a> {
    /// Position on the surface, metres, not wrapped. Beyond ±10⁷ m (and for a NaN) it is that edge.
    pub position_m: &'a [[f64; 2]],
    /// Distance travelled between two samples, metres.
    pub footprint_m: &'a [f64],
}

/// The cells of the slow octaves that a path was last in: a short block need not look for them
/// again.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseCells {
    /// Keys of the field that they are of.
    field: Option<(u32, u32)>,
    known: [KnownCell; OCTAVES],
}

impl Default for NoiseCells {
    fn default() -> Self {
        Self { field: None, known: [KnownCell::NONE; OCTAVES] }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Octave {
    cell_m: f32,
    offset: [Offset; 2],
    key: u32,
    /// Which of the orientations it has.
    rotation: u32,
    /// Its index.
    index: u32,
}

/// A field of micro-relief: the same seed is the same field for ever.
#[derive(Debug, Clone, PartialEq)]
pub struct FractalNoise {
    octaves: [Octave; OCTAVES],
    rotations: [[f64; 2]; ROTATIONS],
    level: Level,
}

impl FractalNoise {
    /// The field of a seed, on the widest instruction set at hand.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let mut octaves =
            [Octave { cell_m: 0.0, offset: [Offset::new(0); 2], key: 0, rotation: 0, index: 0 }; OCTAVES];
        for (i, octave) in octaves.iter_mut().enumerate() {
            let mut bits = || u64::from(rng.next_u32()) << 32 | u64::from(rng.next_u32());
            let cell_m = (LONGEST_CELL_M / (1u64 << i) as f64) as f32;
            let offset = [Offset::new(bits()), Offset::new(bits())];
            *octave = Octave {
                cell_m,
                offset,
                key: bits() as u32,
                rotation: (i % ROTATIONS) as u32,
                index: i as u32,
            };
        }
        Self { octaves, rotations: lanes::rotations(), level: Level::detect() }
    }

    /// Field on a chosen instruction set. All give equal bits.
    #[must_use]
    pub fn on(self, level: Level) -> Self {
        Self { level, ..self }
    }

    /// The instruction set in use.
    #[must_use]
    pub fn level(&self) -> Level {
        self.level
    }

    /// Exponent of the power spectrum for a perceptual roughness of 0–1 (Hasti §III-C). The octaves
    /// take its powers from the polynomials of `gains`, which `tests/independent/noise_spectrum.py`
    /// prints.
    #[must_use]
    pub fn alpha(roughness: f64) -> f64 {
        2.5 - 1.5 * roughness.clamp(0.0, 1.0)
    }

    /// Roughness of 0–1 whose exponent is the nearest.
    #[must_use]
    pub fn roughness(alpha: f64) -> f64 {
        ((2.5 - alpha) / 1.5).clamp(0.0, 1.0)
    }

    /// Adds the relief along a path to `height_m`. `roughness` (0–1, clamped) and `height_m` are as
    /// long as the path; `weights` say how strong each octave is at each roughness.
    pub fn add(
        &self,
        path: &NoisePath<'_>,
        roughness: &[f64],
        weights: &OctaveWeights,
        height_m: &mut [f64],
    ) {
        self.add_each(path, roughness, &[weights], &mut [height_m], &mut NoiseCells::default());
    }

    /// [`Self::add`] along one path for several sets of weights at once, each with heights of its
    /// own: the octaves are worked out once, the bits are the same. `cells` are those that the path
    /// before was in, best of the same contact; they save time and change no bit.
    pub fn add_each<const W: usize>(
        &self,
        path: &NoisePath<'_>,
        roughness: &[f64],
        sets: &[&OctaveWeights; W],
        heights_m: &mut [&mut [f64]; W],
        cells: &mut NoiseCells,
    ) {
        let field = (self.octaves[0].key, self.octaves[1].key);
        if cells.field != Some(field) {
            *cells = NoiseCells { field: Some(field), ..NoiseCells::default() };
        }
        let known = &mut cells.known;
        at_level!(self.level, s => lanes::add_on(s, self, path, roughness, sets, heights_m, known));
    }
}

/// 1 for octaves up to the longest wavelength, 0 from twice it on.
fn band_weight(cell_m: f64, longest_wavelength_m: f64) -> f32 {
    let excess = PEAK_WAVELENGTH_CELLS * cell_m / longest_wavelength_m - 1.0;
    (1.0 - excess).clamp(0.0, 1.0) as f32
}
