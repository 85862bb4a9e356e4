//! Model of a vibrotactile actuator: a moving mass on a spring, driven by a force.
//!
//! ```text
//! felt displacement / drive = D₀/Q · ω₀² / (s² + ω₀/Q s + ω₀²)
//! ```
//! run exactly for a drive that is held over each step, as one complex number: z ← e^(λ step) z + b
//! · drive, displacement = Im z, λ = −ω₀/2Q + i ω_d. Without drive |z| can only shrink, and
//! |displacement| ≤ |z| at every moment: the excursion limiter rests on these two facts.

use super::Quantity;
use crate::DesignError;
use core::f64::consts::PI;

/// An actuator as its data sheet or a measurement describes it. "Felt" means at the skin: the
/// motion of the mass times its share of the total mass.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct DeviceProfile {
    /// f₀, Hz.
    pub resonance_hz: f64,
    /// Q, above 0.5.
    pub quality: f64,
    /// Felt displacement at f₀ for a sine of drive 1, m (amplitude).
    pub felt_at_resonance_m: f64,
    /// Felt displacement when the mass reaches its stop, m.
    pub excursion_m: f64,
    /// Lowest and highest frequency the device is meant for, Hz.
    pub band_hz: [f64; 2],
    /// Drive that may be held for ever, RMS, 0–1.
    pub rated_drive: f64,
    /// Thermal time constant of the coil, s.
    pub thermal_time_s: f64,
}

impl DeviceProfile {
    /// Linear resonant actuator. 170 Hz from the VG1040003D's class (secondary source); Q from a
    /// rise time of 20 ms; 1.4 g peak on a 100 g block, coil time and rating assumed.
    pub const LRA_170: Self = Self {
        resonance_hz: 170.0,
        quality: 8.0,
        felt_at_resonance_m: 1.2e-5,
        excursion_m: 1.3e-5,
        band_hz: [60.0, 400.0],
        rated_drive: SINE_RMS,
        thermal_time_s: 5.0,
    };
    /// Voice coil of a console controller: f₀ 65 Hz, 20–250 Hz and a rise of about 20 ms are the
    /// published haptic profile's; the rest is assumed.
    pub const CONSOLE_VOICE_COIL: Self = Self {
        resonance_hz: 65.0,
        quality: 2.5,
        felt_at_resonance_m: 1.0e-4,
        excursion_m: 1.5e-4,
        band_hz: [20.0, 250.0],
        rated_drive: SINE_RMS,
        thermal_time_s: 10.0,
    };
    /// Recoil transducer of the Haptuator Mk II class: 90–1000 Hz (secondary source); the rest is
    /// assumed.
    pub const HAPTUATOR: Self = Self {
        resonance_hz: 65.0,
        quality: 1.5,
        felt_at_resonance_m: 6.0e-5,
        excursion_m: 1.2e-4,
        band_hz: [90.0, 1000.0],
        rated_drive: 0.5,
        thermal_time_s: 20.0,
    };
    /// Head-mounted-display controller, 55–200 Hz (published haptic profile); the rest is assumed.
    pub const VR_CONTROLLER: Self = Self {
        resonance_hz: 160.0,
        quality: 4.0,
        felt_at_resonance_m: 2.0e-5,
        excursion_m: 3.0e-5,
        band_hz: [55.0, 200.0],
        rated_drive: SINE_RMS,
        thermal_time_s: 5.0,
    };

    /// Checks every field.
    ///
    /// # Errors
    /// Names the first field that is out of range.
    pub fn check(&self, sample_rate_hz: f64) -> Result<(), DesignError> {
        let rate = DesignError::check("sample_rate_hz", sample_rate_hz, "above 0 Hz", |r| r > 0.0)?;
        let positive = |x: f64| x > 0.0;
        let top = 0.45 * rate;
        let in_rate = |f: f64| f > 0.0 && f < top;
        DesignError::check("resonance_hz", self.resonance_hz, "above 0 Hz, below 0.45 of the rate", in_rate)?;
        DesignError::check("quality", self.quality, "above 0.5", |q| q > 0.5 && q < 1e4)?;
        DesignError::check("felt_at_resonance_m", self.felt_at_resonance_m, "above 0 m", positive)?;
        DesignError::check("excursion_m", self.excursion_m, "above 0 m", positive)?;
        DesignError::check("band_hz", self.band_hz[0], "above 0 Hz, below 0.45 of the rate", in_rate)?;
        DesignError::check("band_hz", self.band_hz[1], "above the lower edge", |f| f > self.band_hz[0])?;
        DesignError::check("rated_drive", self.rated_drive, "above 0, 1 or less", |d| d > 0.0 && d <= 1.0)?;
        DesignError::check("thermal_time_s", self.thermal_time_s, "above 0 s", positive)?;
        Ok(())
    }
}

/// RMS of a sine of amplitude 1.
const SINE_RMS: f64 = core::f64::consts::FRAC_1_SQRT_2;

/// Coefficients of the model at one rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeviceModel {
    pole: [f64; 2],
    drive: [f64; 2],
    quantity_scale: f64,
    quantity: Quantity,
}

/// Memory of the model: the complex displacement, m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DeviceState {
    pub(super) z: [f64; 2],
    velocity: f64,
}

impl DeviceModel {
    /// The model of `profile`; its output is the felt `quantity`.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn new(
        profile: &DeviceProfile,
        quantity: Quantity,
        sample_rate_hz: f64,
    ) -> Result<Self, DesignError> {
        profile.check(sample_rate_hz)?;
        let step = 1.0 / sample_rate_hz;
        let w0 = 2.0 * PI * profile.resonance_hz;
        let sigma = 0.5 * w0 / profile.quality;
        let wd = libm::sqrt(w0 * w0 - sigma * sigma);
        let radius = libm::exp(-sigma * step);
        let pole = [radius * libm::cos(wd * step), radius * libm::sin(wd * step)];
        // b = D₀/Q ω₀²/ω_d (e^(λ step) − 1) / λ
        let gain = profile.felt_at_resonance_m / profile.quality * w0 * w0 / wd;
        let (re, im) = (pole[0] - 1.0, pole[1]);
        let scale = gain / (w0 * w0);
        let drive = [scale * (im * wd - re * sigma), -scale * (im * sigma + re * wd)];
        Ok(Self { pole, drive, quantity_scale: sample_rate_hz, quantity })
    }

    /// z after one step with `drive`.
    #[inline]
    pub(super) fn next(&self, z: [f64; 2], drive: f64) -> [f64; 2] {
        let [a, b] = self.pole;
        [a * z[0] - b * z[1] + self.drive[0] * drive, a * z[1] + b * z[0] + self.drive[1] * drive]
    }

    /// The drive's own part of a step.
    pub(super) fn drive(&self) -> [f64; 2] {
        self.drive
    }
}

impl DeviceState {
    /// One sample of drive (1 = full scale) → the felt quantity at the end of the step, m or m/s².
    pub fn tick(&mut self, model: &DeviceModel, drive: f64) -> f64 {
        let before = self.z[1];
        self.z = model.next(self.z, drive);
        let velocity = (self.z[1] - before) * model.quantity_scale;
        let acceleration = (velocity - self.velocity) * model.quantity_scale;
        self.velocity = velocity;
        match model.quantity {
            Quantity::Displacement | Quantity::Tangential => self.z[1],
            Quantity::Acceleration | Quantity::Force => acceleration,
        }
    }

    /// |z|, which no felt displacement exceeds from now on unless driven, m.
    #[must_use]
    pub fn amplitude_m(&self) -> f64 {
        libm::sqrt(self.z[0] * self.z[0] + self.z[1] * self.z[1])
    }
}
