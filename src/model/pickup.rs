//! Pickup: what an accelerometer or a contact microphone on a body reads at its place.
//!
//! ```text
//! q̈ₘ + 2 dₘ q̇ₘ + ω₀ₘ² qₘ = Σ forces φₘ · F        reading = Σₘ (φₘ(p) · n̂) qₘ, q̇ₘ or q̈ₘ
//! ```
//! in SI units whatever the levels of what is heard. What the body does as a whole is what the game
//! reports of it ([`RigidMotion`]); an accelerometer reads it as
//!
//! ```text
//! n̂ · (a − g + α × r + ω × (ω × r))        r = p − centre
//! ```

use crate::model::bad_value::{BadValue, within};
use asperity_dsp::limits;
use asperity_dsp::vector::cross;
use serde::{Deserialize, Serialize};

/// Reading of a pickup.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PickupQuantity {
    /// m/s², with what the body does as a whole.
    #[default]
    Acceleration,
    /// m/s, of the vibration.
    Velocity,
    /// m, of the vibration.
    Displacement,
}

impl PickupQuantity {
    /// Every quantity, with the word that files use.
    pub const ALL: [(&'static str, Self); 3] = [
        ("acceleration", Self::Acceleration),
        ("velocity", Self::Velocity),
        ("displacement", Self::Displacement),
    ];

    /// Time derivatives of the displacement.
    pub(crate) fn derivative(self) -> u8 {
        match self {
            Self::Displacement => 0,
            Self::Velocity => 1,
            Self::Acceleration => 2,
        }
    }
}

/// A pickup on a body.
///
/// ```
/// use asperity::{Body, Config, ContactEvent, Engine, Impact, Material, Pickup, Stock};
///
/// let config = Config { pickups: vec![None], ..Config::default() };
/// let Engine { mut scene, mut renderer, .. } = config.build()?;
/// let bar = Body::stock(Stock::Bar, Material::STEEL, 0.3)?.pickup(Pickup::at_share(0.8));
/// let bar = scene.add_body(bar)?;
/// scene.report(0.0, ContactEvent::Impact(Impact::on(bar)))?;
/// let mut read_m_s2 = [0.0; 512];
/// renderer.render_with_pickups(&mut [], &mut [], &mut [&mut read_m_s2]);
/// assert!(read_m_s2.iter().any(|x| x.abs() > 1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Pickup {
    /// Index of the channel in [`Config::pickups`](crate::Config::pickups); those of one channel
    /// add up.
    pub channel: usize,
    /// Place on a body that has shapes, m in its frame; on another the arm of its rigid motion.
    pub at_m: Option<[f64; 3]>,
    /// Along what it reads; none = the outward normal.
    pub direction: Option<[f64; 3]>,
    /// On a body without shapes, how much it moves with every mode: 1 as where that swings most, −1
    /// to 1.
    pub factor: Option<f64>,
    /// Reading.
    pub quantity: PickupQuantity,
}

impl Pickup {
    /// At a place of a body that has shapes, m in its frame.
    #[must_use]
    pub fn at(at_m: [f64; 3]) -> Self {
        Self { at_m: Some(at_m), factor: None, ..Self::at_share(1.0) }
    }

    /// On a body of known mass without shapes, moving so much with every mode.
    #[must_use]
    pub fn at_share(factor: f64) -> Self {
        let quantity = PickupQuantity::default();
        Self { channel: 0, at_m: None, direction: None, factor: Some(factor), quantity }
    }

    /// Reading along a direction of the body's frame; its length does not count.
    #[must_use]
    pub fn along(self, direction: [f64; 3]) -> Self {
        Self { direction: Some(direction), ..self }
    }

    /// Reading another quantity.
    #[must_use]
    pub fn reading(self, quantity: PickupQuantity) -> Self {
        Self { quantity, ..self }
    }

    /// Read on another channel than the first.
    #[must_use]
    pub fn on_channel(self, channel: usize) -> Self {
        Self { channel, ..self }
    }

    pub(crate) fn check(&self) -> Result<(), BadValue> {
        within("factor", self.factor.unwrap_or(0.0), limits::PICKUP_FACTOR)?;
        for x in self.at_m.iter().flatten() {
            within("at_m", *x, limits::PLACE_M)?;
        }
        if let Some(direction) = self.direction {
            within("direction", direction.iter().map(|x| x * x).sum::<f64>().sqrt(), limits::AXIS)?;
        }
        Ok(())
    }
}

/// Motion of a body as a whole at an instant, in its own axes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct RigidMotion {
    /// Acceleration of its centre, m/s².
    pub acceleration_m_s2: [f64; 3],
    /// Gravity, m/s².
    pub gravity_m_s2: [f64; 3],
    /// rad/s.
    pub angular_velocity_rad_s: [f64; 3],
    /// Centre that the acceleration belongs to, m.
    pub centre_m: [f64; 3],
}

impl RigidMotion {
    pub(crate) fn checked(self) -> Result<Self, BadValue> {
        for (field, vector, range) in [
            ("acceleration_m_s2", self.acceleration_m_s2, limits::RIGID_ACCELERATION_M_S2),
            ("gravity_m_s2", self.gravity_m_s2, limits::RIGID_ACCELERATION_M_S2),
            ("angular_velocity_rad_s", self.angular_velocity_rad_s, limits::RIGID_TURN_RAD_S),
            ("centre_m", self.centre_m, limits::PLACE_M),
        ] {
            for x in vector {
                within(field, x, range)?;
            }
        }
        Ok(self)
    }

    /// Reading of an accelerometer at a place of the body while it turns faster by α, rad/s².
    pub(crate) fn read(&self, at_m: [f64; 3], direction: [f64; 3], alpha: [f64; 3]) -> f64 {
        let omega = self.angular_velocity_rad_s;
        let arm: [f64; 3] = std::array::from_fn(|i| at_m[i] - self.centre_m[i]);
        let (inward, across) = (cross(omega, cross(omega, arm)), cross(alpha, arm));
        let felt = |i: usize| self.acceleration_m_s2[i] - self.gravity_m_s2[i] + inward[i] + across[i];
        (0..3).map(|i| direction[i] * felt(i)).sum()
    }
}
