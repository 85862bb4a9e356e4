//! A touchable surface: a source of heights, its size, its roughness and the body that it rings.

#[cfg(feature = "image")]
mod from_files;

use crate::model::bad_value::{BadValue, within};
use crate::model::excitation::{Excitation, Exciter};
use crate::model::frame::SurfaceFrame;
use crate::model::id::BodyId;
use crate::model::material::Material;
use asperity_dsp::fractal_noise::OCTAVES;
use asperity_dsp::limits;
use asperity_dsp::stick_slip::Friction;
use asperity_surface::footprint::{self, footprint_radius_m};
use asperity_surface::height_field::{
    Extension, HeightField, MAX_BLOCK, PathBlock, Properties, SurfaceBlock, Touch, TouchKind,
};
use asperity_surface::height_map::{Extent, FRICTION, HeightMap, MapError};
use asperity_surface::picture::ImageError;
use asperity_surface::tiled::Tiled;
use asperity_surface::tip_law::TipLaw;
use asperity_surface::wrap::Wrap;
use std::any::Any;

/// Source of a surface's perceptual roughness R (0–1).
#[derive(Debug, Clone)]
pub enum Roughness {
    /// The source says, or [`DEFAULT_ROUGHNESS`] where it does not.
    FromSource,
    /// One R everywhere.
    Constant(f64),
    /// A map of its own: its heights are R.
    Map(Box<HeightMap>),
}

/// R of a surface that has no roughness map: the middle of the scale.
pub const DEFAULT_ROUGHNESS: f64 = 0.5;
/// Rms height of the micro-noise in the octave around 1 mm wavelength where R is 1, m. **Measured
/// here**: at R = 0.5 that is 9 µm, and from 8 µm on the micro-collisions of a fingertip carry the
/// sound of rough strokes; a tool of 30 g is then shaken by 1–2 m/s² at 120 mm/s and R = 0.5, as
/// published recordings of real materials are (`docs/lab/feel.md`).
pub const DEFAULT_MICRO_RELIEF_M: f64 = 22e-6;
/// Wavelength beyond which the micro-noise is flat, m: the roll-off that every finished surface
/// has. **Chosen** within the millimetres to centimetres of machined and polished ones.
pub const DEFAULT_OUTER_SCALE_M: f64 = 0.01;
/// Radius of the asperity that stands for the finger in a micro-collision, m. The true skin would
/// give contact times of 1–8 ms and dull sounds, so the exciter is a hard bead of the pad's mass
/// instead.
pub const EXCITER_RADIUS_M: f64 = 1e-3;
/// Material of that bead.
pub const EXCITER_MATERIAL: Material = Material::NAIL;

/// Friction of a surface that rubs its body and says nothing else: rosin on a bow's hair, to the
/// order of what is published of it (static 0.8, falling to 0.3 within some centimetres a second).
/// **Assumed.**
pub const DEFAULT_STICK_SLIP: Friction = Friction { mu_static: 0.8, mu_kinetic: 0.3, slip_speed_m_s: 0.05 };

/// A surface, ready to be added to a scene.
pub struct Surface {
    pub(crate) source: Box<dyn HeightField>,
    pub(crate) width_m: f64,
    pub(crate) height_m: f64,
    pub(crate) wraps: bool,
    pub(crate) body: Option<BodyId>,
    pub(crate) roughness: Roughness,
    pub(crate) micro_relief_m: f64,
    pub(crate) outer_scale_m: f64,
    pub(crate) micro_relief_octaves_db: [f64; OCTAVES],
    pub(crate) long_waves: bool,
    pub(crate) friction: Option<f64>,
    pub(crate) compliance_m_n: f64,
    pub(crate) excitation: Excitation,
    pub(crate) stick_slip: Option<Friction>,
    pub(crate) strike_position: usize,
    pub(crate) frame: Option<SurfaceFrame>,
    /// Origin, as its maker wrote it down, so that a recording can say it again.
    pub(crate) described: Option<Box<dyn Any + Send + Sync>>,
}

impl std::fmt::Debug for Surface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Surface")
            .field("width_m", &self.width_m)
            .field("height_m", &self.height_m)
            .field("body", &self.body)
            .field("micro_relief_m", &self.micro_relief_m)
            .finish_non_exhaustive()
    }
}

/// Why a surface cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// A map cannot be used.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A size, relief or coefficient no surface has.
    #[error(transparent)]
    BadValue(#[from] BadValue),
    /// The map cannot be sampled at this size.
    #[error(transparent)]
    Map(#[from] MapError),
}

impl Surface {
    /// A surface whose heights any source gives; uv 1 spans `width_m` × `height_m`.
    ///
    /// # Errors
    /// When a size is not between 1 µm and 1 km.
    pub fn new(source: impl HeightField + 'static, width_m: f64, height_m: f64) -> Result<Self, BadValue> {
        Self::from_source(Box::new(source), width_m, height_m)
    }

    /// Surface of a source that is boxed already.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn from_source(source: Box<dyn HeightField>, width_m: f64, height_m: f64) -> Result<Self, BadValue> {
        within("width_m", width_m, limits::SIDE_M)?;
        within("height_m", height_m, limits::SIDE_M)?;
        Ok(Self {
            source,
            width_m,
            height_m,
            wraps: true,
            body: None,
            roughness: Roughness::FromSource,
            micro_relief_m: DEFAULT_MICRO_RELIEF_M,
            outer_scale_m: DEFAULT_OUTER_SCALE_M,
            micro_relief_octaves_db: [0.0; OCTAVES],
            long_waves: false,
            friction: None,
            compliance_m_n: 0.0,
            excitation: Excitation::default(),
            stick_slip: None,
            strike_position: 0,
            frame: None,
            described: None,
        })
    }

    /// A plane: uv 1 spans `width_m` × `height_m`, and what is felt of it is its finish
    /// ([`material`](Self::material)).
    ///
    /// ```
    /// use asperity::{Material, Surface};
    ///
    /// let desk = Surface::flat(1.2, 0.6)?.material(Material::WOOD);
    /// # Ok::<(), asperity::SurfaceError>(())
    /// ```
    ///
    /// # Errors
    /// When a size is not between 1 µm and 1 km.
    pub fn flat(width_m: f64, height_m: f64) -> Result<Self, SurfaceError> {
        let extent = Extent { width_m, height_m, relief_m: 0.0 };
        Ok(Self::from_map(HeightMap::flat(extent, DEFAULT_ROUGHNESS)?)?)
    }

    /// A surface from a map that is in memory already, with the map's size and edges.
    ///
    /// # Errors
    /// When a size is not between 1 µm and 1 km.
    pub fn from_map(map: HeightMap) -> Result<Self, BadValue> {
        let (extent, wraps) = (map.extent(), map.wrap() != Wrap::Clamp);
        Ok(Self::new(map, extent.width_m, extent.height_m)?.wraps(wraps))
    }

    /// With the ordinary finish of a material: its roughness everywhere, its micro-relief and its
    /// friction. What is said after this counts instead:
    /// `.material(material).roughness(Roughness::FromSource)` keeps a map's own roughness.
    #[must_use]
    pub fn material(mut self, material: Material) -> Self {
        self.roughness = Roughness::Constant(material.roughness);
        self.micro_relief_m = material.micro_relief_m;
        self.friction = Some(material.mu_kinetic);
        self
    }

    /// Rings this body when it is touched.
    #[must_use]
    pub fn body(mut self, body: BodyId) -> Self {
        self.body = Some(body);
        self
    }

    /// Which of the body's strike positions contacts on this surface excite; 0 by
    /// default. A position the body does not have counts as its last.
    #[must_use]
    pub fn at_strike_position(mut self, position: usize) -> Self {
        self.strike_position = position;
        self
    }

    /// Sets where it lies in its body.
    #[must_use]
    pub fn frame(mut self, frame: SurfaceFrame) -> Self {
        self.frame = Some(frame);
        self
    }

    /// Sets where R comes from.
    #[must_use]
    pub fn roughness(mut self, roughness: Roughness) -> Self {
        self.roughness = roughness;
        self
    }

    /// Rms height of the 1/f^α overlay in the octave around 1 mm wavelength where R is 1, m; 0 =
    /// none. Elsewhere it is 10^(0.75 (R − 1)) times that.
    #[must_use]
    pub fn micro_relief_m(mut self, rms_m: f64) -> Self {
        self.micro_relief_m = rms_m;
        self
    }

    /// Wavelength beyond which the overlay is flat, m.
    #[must_use]
    pub fn outer_scale_m(mut self, wavelength_m: f64) -> Self {
        self.outer_scale_m = wavelength_m;
        self
    }

    /// Gains of the overlay's twelve octaves over its law, coarsest first, dB: octave i lies about
    /// the wavelength 31.5 mm / 2^i.
    #[must_use]
    pub fn micro_relief_octaves_db(mut self, gains_db: [f64; OCTAVES]) -> Self {
        self.micro_relief_octaves_db = gains_db;
        self
    }

    /// Sets whether long waves lie under a map that has none of its own, as under real ground, for
    /// tools; off by default, because a finger's displacement grows by them
    /// (`docs/lab/feel.md`). Without micro-relief there are none.
    #[must_use]
    pub fn long_waves(mut self, long_waves: bool) -> Self {
        self.long_waves = long_waves;
        self
    }

    /// Coulomb friction coefficient of the 3-D force output, whatever the source says.
    #[must_use]
    pub fn friction(mut self, coefficient: f64) -> Self {
        self.friction = Some(coefficient);
        self
    }

    /// Sets how far it gives way under each newton, m/N, whatever its source says; 0 leaves that to
    /// the source. A cloth on foam: 1e-3.
    ///
    /// ```text
    /// d = C F        a tip that stands d below the untouched surface is carried with d / C
    /// ```
    /// A probe with a round tip feels the mean of a map under it ([`asperity_surface::footprint`]).
    #[must_use]
    pub fn compliance_m_n(mut self, compliance_m_n: f64) -> Self {
        self.compliance_m_n = compliance_m_n;
        self
    }

    /// Its source as a ball feels it that stands in it, as deep as its compliance says.
    pub(crate) fn sample_under(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let mut radius_m = [0.0; MAX_BLOCK];
        for (i, radius_m) in radius_m.iter_mut().enumerate().take(path.len()) {
            *radius_m = footprint_radius_m(path.tip_radius_m, self.compliance_m_n * path.pressed_n(i));
        }
        footprint::sample_under(&mut *self.source, path, &radius_m, out);
    }

    /// The law of its compliance.
    pub(crate) fn spring(&self) -> TipLaw {
        let friction = self.friction.unwrap_or(FRICTION);
        TipLaw::Spring { compliance_m_n: self.compliance_m_n, friction }
    }

    /// The force at which it carries a tip, N; none where it is hard. See [`TouchKind::Stands`].
    pub(crate) fn support_force_n(&mut self, position_m: [f64; 2], depth_m: f64) -> Option<f64> {
        if self.compliance_m_n > 0.0 {
            return Some(depth_m.max(0.0) / self.compliance_m_n);
        }
        let kind = TouchKind::Stands { depth_m };
        self.source.touch(&Touch { kind, position_m, ..Touch::default() }).support_force_n
    }

    /// Sets what sliding sends to the body.
    #[must_use]
    pub fn excitation(mut self, excitation: Excitation) -> Self {
        self.excitation = excitation;
        self
    }

    /// Contacts rub its body, which sticks and slips under them: a bow, a wet finger on glass,
    /// chalk. Beside whatever else [excites](Self::excitation) it; one contact of a body at a time.
    ///
    /// The body's motion under the contact has to be known: it has [shapes](crate::ModeShapes) and
    /// the surface a [frame](Self::frame), or it has a [mass](crate::Body::mass_kg).
    ///
    /// ```
    /// use asperity::{Body, Config, Engine, Friction, Material, Stock, Surface};
    ///
    /// let Engine { mut scene, .. } = Config::default().build()?;
    /// let glass = scene.add_body(Body::stock(Stock::Bowl, Material::GLASS, 0.08)?)?;
    /// let wet = Friction { mu_static: 0.9, mu_kinetic: 0.4, slip_speed_m_s: 0.05 };
    /// scene.add_surface(Surface::flat(0.25, 0.01)?.body(glass).stick_slip(wet))?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn stick_slip(mut self, friction: Friction) -> Self {
        self.stick_slip = Some(friction);
        self.excitation = self.excitation.with(Exciter::Friction);
        self
    }

    /// Friction that rubs its body; none where friction does not sound.
    pub(crate) fn rubs(&self) -> Option<Friction> {
        self.stick_slip.filter(|_| self.excitation.has(Exciter::Friction))
    }

    /// Sets whether texture coordinates wrap at 0 and 1 (a repeating surface, the default): then a
    /// jump by a whole tile is no movement, and the same coordinates are the same place, lap after
    /// lap; a source that never repeats is cut into tiles without a seam. A source with an edge (a
    /// clamped map, sand) never wraps, a mirrored one at every second tile. A surface that does not
    /// wrap takes uv as they are.
    #[must_use]
    pub fn wraps(mut self, wraps: bool) -> Self {
        self.wraps = wraps;
        self
    }

    pub(crate) fn checked(mut self) -> Result<Self, BadValue> {
        within("micro_relief_m", self.micro_relief_m, limits::MICRO_RELIEF_M)?;
        within("outer_scale_m", self.outer_scale_m, limits::OUTER_SCALE_M)?;
        for gain_db in self.micro_relief_octaves_db {
            within("micro_relief_octaves_db", gain_db, limits::OCTAVE_DB)?;
        }
        let reach_m = self.properties().reach_m;
        within("relief_m", reach_m, limits::REACH_M)?;
        within("friction", self.friction.unwrap_or(0.0), limits::FRICTION)?;
        within("compliance_m_n", self.compliance_m_n, limits::COMPLIANCE_M_N)?;
        if self.excitation.has(Exciter::Friction) {
            let friction = *self.stick_slip.get_or_insert(DEFAULT_STICK_SLIP);
            within("mu_static", friction.mu_static, limits::FRICTION)?;
            let at_most = limits::Range::new(0.0, friction.mu_static, "0 to 10 and at most mu_static");
            within("mu_kinetic", friction.mu_kinetic, at_most)?;
            within("slip_speed_m_s", friction.slip_speed_m_s, limits::SLIP_SPEED_M_S)?;
        }
        if let Roughness::Constant(r) = self.roughness {
            within("roughness", r, limits::ROUGHNESS)?;
        }
        Ok(self)
    }

    /// Properties of its source on a tile of its size.
    pub(crate) fn properties(&self) -> Properties {
        self.source.properties([self.width_m, self.height_m])
    }

    /// Distance that the path stage may unwrap by, m.
    pub(crate) fn wrap_period_m(&self) -> [f64; 2] {
        let tile_m = [self.width_m, self.height_m];
        match self.properties().extension {
            Extension::Same | Extension::Fresh if self.wraps => tile_m,
            Extension::Mirrored if self.wraps => tile_m.map(|side_m| 2.0 * side_m),
            _ => [f64::INFINITY; 2],
        }
    }

    /// Surface with a source that repeats, if its coordinates wrap.
    pub(crate) fn tiled(mut self) -> Self {
        let tile_m = [self.width_m, self.height_m];
        if self.wraps && self.properties().extension == Extension::Fresh {
            self.source = Box::new(Tiled::new(self.source, tile_m));
        }
        self
    }
}
