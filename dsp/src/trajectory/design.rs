//! Design shared by all paths at one sample rate: mode, filter, wrapping.

use crate::DesignError;
use crate::butterworth::Butterworth;

/// Delay of [`PathMode::Hermite`] on top of the filter's: 1.25 periods of 60 Hz events, s. Covers a
/// jitter of ±20 %; when an event is later still, the path is extrapolated until it comes.
pub const HERMITE_DELAY_S: f64 = 1.25 / 60.0;

/// Modes of making positions between events.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum PathMode {
    /// Dead reckoning with the reported velocity, and with how it has been changing.
    #[default]
    Extrapolate,
    /// Each event's position is held until the next, as in the paper.
    Hold,
    /// Cubic interpolation between events, [`HERMITE_DELAY_S`] late.
    Hermite,
    /// The most likely band-limited motion given the last reports, no later than
    /// [`PathMode::Extrapolate`]: the module `band_limited`.
    BandLimited,
}

/// Constants of all paths at one sample rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrajectoryDesign {
    pub(super) mode: PathMode,
    pub(super) filter: Butterworth,
    pub(super) sample_period_s: f64,
    wrap_period_m: [f64; 2],
    pub(super) hermite_delay_samples: u64,
    /// Band output → derivative per second, exact for a straight line at any rate.
    pub(super) band_to_speed: f64,
}

impl TrajectoryDesign {
    /// Designs the path stage. `wrap_period_m` is the distance after which the surface repeats
    /// along u and v, ∞ where it does not: positions that differ by it are the same place.
    ///
    /// # Errors
    /// When the rate or the cutoff is impossible (see [`Butterworth::new`]) or a period is not
    /// above 0.
    pub fn new(
        mode: PathMode,
        cutoff_hz: f64,
        sample_rate_hz: f64,
        wrap_period_m: [f64; 2],
    ) -> Result<Self, DesignError> {
        let filter = Butterworth::new(cutoff_hz, sample_rate_hz)?;
        for value in wrap_period_m {
            if value.is_nan() || value <= 0.0 {
                let expected = "above 0 m, or infinite where the surface does not repeat";
                return Err(DesignError { field: "wrap_period_m", value, expected });
            }
        }
        Ok(Self {
            mode,
            filter,
            sample_period_s: 1.0 / sample_rate_hz,
            wrap_period_m,
            hermite_delay_samples: libm::round(HERMITE_DELAY_S * sample_rate_hz) as u64,
            band_to_speed: 2.0
                * sample_rate_hz
                * libm::tan(core::f64::consts::PI * cutoff_hz / sample_rate_hz),
        })
    }

    /// Which mode this is.
    #[must_use]
    pub fn mode(&self) -> PathMode {
        self.mode
    }

    /// Delay of slow movements behind the events, seconds.
    #[must_use]
    pub fn lag_s(&self) -> f64 {
        let extra = match self.mode {
            PathMode::Extrapolate | PathMode::Hold | PathMode::BandLimited => 0.0,
            PathMode::Hermite => self.hermite_delay_samples as f64 * self.sample_period_s,
        };
        self.filter.group_delay_s() + extra
    }

    /// Duration of a step of the input at the output's fastest, seconds: 1 over the impulse
    /// response's largest value, √2 ω e^(−π/4) sin(π/4).
    pub(super) fn step_time_s(&self) -> f64 {
        1.0 / (0.455_938 * self.filter.angular_cutoff_per_s())
    }

    /// The position equal to `position` on the surface that is nearest to `near`.
    pub(super) fn unwrap(&self, axis: usize, position: f64, near: f64) -> f64 {
        let period = self.wrap_period_m[axis];
        if period.is_finite() {
            position + period * libm::round((near - position) / period)
        } else {
            position
        }
    }
}
