//! A body: what rings, what it is made of, and where its sound leaves.

use crate::model::bus::BusId;
use crate::model::material::Material;
use crate::model::modal_model::ModalModel;
use crate::model::pickup::Pickup;

/// Buses that a body may sound on beside its own.
pub(crate) const MAX_SENDS: usize = 4;

/// Buses that a body sounds on beside its own, and how loud, linear.
pub(crate) type Sends = [Option<(usize, f64)>; MAX_SENDS];

/// A body, ready to be added to a scene.
///
/// ```
/// use asperity::{AudioBus, Body, BusId, Config, Engine, Material, ModalModel, Mode};
///
/// let config = Config { audio: vec![AudioBus::default(); 2], ..Config::default() };
/// let Engine { mut scene, .. } = config.build()?;
/// let mode = Mode { frequency_hz: 812.0, decay_per_s: 12.0, amplitude: 0.3, phase_rad: 0.0 };
/// let body = Body::new(ModalModel::new(vec![mode], 0.01)?).material(Material::CERAMIC).bus(BusId(1));
/// scene.add_body(body)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    pub(crate) model: ModalModel,
    pub(crate) material: Material,
    pub(crate) bus: usize,
    pub(crate) gain: f64,
    /// None: by the level policy, 1 where there is none.
    pub(crate) strike_gain: Option<f64>,
    pub(crate) mass_kg: Option<f64>,
    pub(crate) least_time_s: f64,
    pub(crate) sends: Sends,
    pub(crate) variation: f64,
    pub(crate) pickups: Vec<Pickup>,
}

impl Body {
    /// Material of a body, or of a surface without one, by default.
    pub const DEFAULT_MATERIAL: Material = Material::PLA;

    /// A body of PLA on bus 0.
    #[must_use]
    pub fn new(model: ModalModel) -> Self {
        Self {
            model,
            material: Self::DEFAULT_MATERIAL,
            bus: 0,
            gain: 1.0,
            strike_gain: None,
            mass_kg: None,
            least_time_s: 0.0,
            sends: Sends::default(),
            variation: 0.0,
            pickups: Vec::new(),
        }
    }

    /// Sets the material, which decides how long impacts on it last.
    #[must_use]
    pub fn material(mut self, material: Material) -> Self {
        self.material = material;
        self
    }

    /// The bus on which its sound leaves; the first by default.
    #[must_use]
    pub fn bus(mut self, bus: BusId) -> Self {
        self.bus = bus.0;
        self
    }
}

impl Body {
    /// Its mass: what has no [shapes](crate::ModeShapes) can be rubbed
    /// ([`Surface::stick_slip`](crate::Surface::stick_slip)) if this is known. Each of its modes
    /// then moves as a string's of this mass where it swings most, and elsewhere as much less as
    /// the strike position says.
    #[must_use]
    pub fn mass_kg(mut self, mass_kg: f64) -> Self {
        self.mass_kg = Some(mass_kg);
        self
    }

    /// Listens to it at a place of its own as well; any number of times. A recording of the scene
    /// does not hold it.
    #[must_use]
    pub fn pickup(mut self, pickup: Pickup) -> Self {
        self.pickups.push(pickup);
        self
    }

    /// Louder or softer than its modes say, linear, 0–1000; changed while it sounds by
    /// [`Scene::set_body_gain`](crate::Scene::set_body_gain).
    #[must_use]
    pub fn gain(mut self, gain: f64) -> Self {
        self.gain = gain;
        self
    }

    /// Least time between equal sounds, 0–60 s: an impact that comes sooner after the last one that
    /// sounded, and is no stronger, is dropped and counted
    /// ([`Stats::too_soon`](crate::Stats::too_soon)). 0, which is usual, drops none.
    #[must_use]
    pub fn least_time_s(mut self, least_time_s: f64) -> Self {
        self.least_time_s = least_time_s;
        self
    }

    /// Spread of equal impacts, 0–1, so that a repeated blow is not the same sound again: 0 for
    /// none; at 1 they differ as real ones do. A body of recorded takes ([`ModalModel::takes`],
    /// `asperity fit --family`) goes from the one asked for towards another of them, never twice
    /// the same; a body with shapes is struck about the place asked for, within some hundredths of
    /// its size; any other has takes of its own, whose modes differ as they do some hundredths of
    /// its size away, and blows that are a tenth harder or softer. Seeded by
    /// [`Config::seed`](crate::Config::seed) and the count of impacts on the body.
    #[must_use]
    pub fn variation(mut self, variation: f64) -> Self {
        self.variation = variation;
        self
    }

    /// Gain of impacts beside strokes, linear, 0–1000: 1 is what mechanics says, and a strike is
    /// then far above a stroke. A scene file that leaves it out has the [level
    /// policy](crate::load::levels) find it, and so has a scene with [levels that are
    /// found](crate::LevelPolicy).
    #[must_use]
    pub fn strike_gain(mut self, gain: f64) -> Self {
        self.strike_gain = Some(gain);
        self
    }
}

impl From<ModalModel> for Body {
    fn from(model: ModalModel) -> Self {
        Self::new(model)
    }
}
