//! A haptic channel: what it plays, how loud, and for which device.

pub use asperity_dsp::actuator::{DeviceProfile, Quantity};

/// Upper end of an acceleration channel's band, Hz: above it neither skin feels (Bolanowski and
/// others 1988) nor voice coils follow, and a rough plate would spend 26 dB of head room there.
pub const ACCELERATION_BAND_HZ: f64 = 1000.0;

/// Exponent of growth of a finger's displacement with what presses where the level policy sets the
/// channel: ∝ F^⅓.
///
/// The pad of a finger that is pressed harder follows the same ground, so its displacement stays as
/// it is; what is felt grows (Lederman 1974: roughness of gratings grows with the force of the
/// finger). The virtual finger touches with more skin, A ∝ F^⅔ (Hertz), and vibration is felt by
/// the sum over the skin it reaches: above 40 Hz thresholds fall by 3 dB as the area doubles
/// (Verrillo 1963; less at the fingertip: Gescheider and others 2005). An actuator always reaches
/// the same skin, so its amplitude has to make up for √A.
pub const FELT_FORCE_EXPONENT: f64 = 1.0 / 3.0;

/// One haptic channel.
///
/// ```
/// use asperity::{ActuatorPreset, ActuatorSettings, Config};
///
/// // A voice coil in a controller: its response inverted, its excursion kept within limits.
/// let device = ActuatorPreset::by_name("vr-controller").unwrap().profile;
/// let channel = ActuatorSettings { equalise: Some(device), limit: Some(device), ..ActuatorSettings::default() };
/// let config = Config { actuators: vec![channel; 2], ..Config::default() };
/// assert!(config.build().is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ActuatorSettings {
    /// Quantity of the channel: the pad's displacement (the paper), its acceleration, how friction
    /// drags the skin sideways, or the normal contact force.
    pub output: Quantity,
    /// m (or m/s², or N) at sample value 1.0; 1.0 gives SI units.
    pub full_scale: f64,
    /// n of a finger's displacement ∝ (F / 1 N)ⁿ, 0 to 1; 0 is the pad's own motion (the paper), ⅓
    /// [`FELT_FORCE_EXPONENT`].
    pub felt_force_exponent: f64,
    /// Cutoff of the high-pass that turns pad positions into movement about the mean surface, Hz;
    /// 0 = off.
    pub highpass_hz: f64,
    /// Cutoff of the low-pass (fourth order, −6 dB there) that keeps to what skin feels and
    /// actuators take, Hz; 0 = off; none = 1000 Hz for acceleration, off for displacement.
    pub lowpass_hz: Option<f64>,
    /// Time from silence to full level after the start, s.
    pub soft_start_s: f64,
    /// Device whose frequency response is inverted.
    pub equalise: Option<DeviceProfile>,
    /// Device whose excursion and heat are kept within limits.
    pub limit: Option<DeviceProfile>,
    /// Keeps the channel within ±1 by a peak limiter, whatever the device.
    pub limit_peaks: bool,
}

impl Default for ActuatorSettings {
    fn default() -> Self {
        Self {
            output: Quantity::Displacement,
            full_scale: 1e-4,
            felt_force_exponent: 0.0,
            highpass_hz: 10.0,
            lowpass_hz: None,
            soft_start_s: 0.0,
            equalise: None,
            limit: None,
            limit_peaks: false,
        }
    }
}
