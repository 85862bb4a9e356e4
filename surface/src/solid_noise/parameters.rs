//! Parameters of a solid-noise surface, with their ranges.

use super::kind::NoiseKind;
use crate::height_field::WavelengthBand;
use asperity_dsp::{DesignError, limits};

/// Most octaves of a module.
pub const MAX_OCTAVES: usize = 16;

/// One noise function of the document (wood needs two).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseModule {
    /// Kind of noise.
    pub kind: NoiseKind,
    /// Magnitude M, at or above 0; 0 = no such module.
    pub magnitude: f64,
    /// Octaves N, 1 to [`MAX_OCTAVES`].
    pub octaves: usize,
    /// Frequency f of the first octave, cells per unit of length 1/T, above 0.
    pub frequency: f64,
    /// Lacunarity: frequency ratio of neighbouring octaves, at or above 1.
    pub lacunarity: f64,
    /// Persistence: amplitude ratio of neighbouring octaves, 0 to 1.
    pub persistence: f64,
}

impl NoiseModule {
    /// No noise.
    pub const SILENT: Self = Self {
        kind: NoiseKind::Gradient,
        magnitude: 0.0,
        octaves: 1,
        frequency: 1.0,
        lacunarity: 2.0,
        persistence: 0.5,
    };

    fn check(&self) -> Result<(), DesignError> {
        limits::solid::MAGNITUDE.check("magnitude", self.magnitude)?;
        limits::solid::OCTAVES.check("octaves", self.octaves as f64)?;
        limits::solid::FREQUENCY.check("frequency", self.frequency)?;
        limits::solid::LACUNARITY.check("lacunarity", self.lacunarity)?;
        limits::solid::PERSISTENCE.check("persistence", self.persistence)?;
        Ok(())
    }
}

/// Along which direction the texture force acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceDirection {
    /// Along the surface's u axis, as in the document.
    X,
    /// Out of the surface.
    Normal,
    /// Along the motion; none at rest.
    Tangent,
}

/// Everything about a solid-noise surface that may change while it is touched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolidNoiseParameters {
    /// The noise functions that are added up.
    pub modules: [NoiseModule; 2],
    /// Texture factor T, 1/m, above 0.
    pub texture_factor_per_m: f64,
    /// Height per unit of magnitude A, metres.
    pub amplitude_m: f64,
    /// Force per unit of magnitude L, N, 0 to 1.
    pub limit_n: f64,
    /// Largest texture force, N, at or above 0.
    pub cap_n: f64,
    /// Direction of the texture force.
    pub direction: ForceDirection,
    /// Multiplies the texture force by the normal force in newtons (as the document's
    /// references 5 and 6 ask; the document itself does not).
    pub proportional_to_contact: bool,
    /// Drag −b v of the medium, N·s/m, at or above 0.
    pub viscosity_n_s_m: f64,
    /// Coulomb friction coefficient, at or above 0.
    pub friction: f64,
    /// Speed of the block past the surface, m/s along u, along v and out of the surface; the last
    /// makes the texture boil in its place.
    pub flow_m_s: [f64; 3],
}

impl SolidNoiseParameters {
    /// Refuses what cannot be rendered.
    ///
    /// # Errors
    /// Names the first field that is not finite or out of its range.
    pub fn check(&self) -> Result<(), DesignError> {
        for module in &self.modules {
            module.check()?;
        }
        limits::solid::TEXTURE_FACTOR_PER_M.check("texture_factor_per_m", self.texture_factor_per_m)?;
        limits::solid::AMPLITUDE_M.check("amplitude_m", self.amplitude_m)?;
        limits::solid::LIMIT_N.check("limit_n", self.limit_n)?;
        limits::solid::CAP_N.check("cap_n", self.cap_n)?;
        limits::solid::VISCOSITY_N_S_M.check("viscosity_n_s_m", self.viscosity_n_s_m)?;
        limits::FRICTION.check("friction", self.friction)?;
        for speed in self.flow_m_s {
            limits::solid::FLOW_M_S.check("flow_m_s", speed)?;
        }
        Ok(())
    }

    /// Cells per metre and amplitude (in units of magnitude) of one octave.
    #[must_use]
    pub fn octave(&self, module: &NoiseModule, index: usize) -> (f64, f64) {
        let (mut frequency, mut amplitude) = (self.texture_factor_per_m * module.frequency, module.magnitude);
        for _ in 0..index {
            frequency *= module.lacunarity;
            amplitude *= module.persistence;
        }
        (frequency, amplitude)
    }

    /// Largest distance of its heights from zero, metres.
    pub(super) fn reach_m(&self) -> f64 {
        let octaves = |module: &NoiseModule| -> f64 {
            (0..module.octaves).map(|index| module.kind.reach() * self.octave(module, index).1.abs()).sum()
        };
        self.amplitude_m.abs() * self.modules.iter().map(octaves).sum::<f64>()
    }

    /// From two cells of the coarsest octave down to one cell of the finest.
    pub(super) fn band(&self) -> WavelengthBand {
        let mut band = WavelengthBand::EMPTY;
        for module in self.modules.iter().filter(|m| m.magnitude > 0.0) {
            let first = self.octave(module, 0).0;
            let last = self.octave(module, module.octaves - 1).0;
            band = band.union(WavelengthBand { shortest_m: 1.0 / last, longest_m: 2.0 / first });
        }
        band
    }
}
