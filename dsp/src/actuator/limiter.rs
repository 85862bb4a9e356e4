//! Limiters without latency: for a device's excursion, heat and drive, and for the audio bus.

use super::Quantity;
use super::device::{DeviceModel, DeviceProfile};
use crate::DesignError;

/// Time constant with which a limiter lets go, s (chosen: longer than a period of the lowest
/// vibration).
pub const RELEASE_TIME_S: f64 = 0.08;

/// Squared amplitudes below this are rest.
const REST: f64 = 1e-60;

/// Keeps a device inside its limits, sample by sample and without look-ahead.
///
/// A smooth gain follows the envelope the *unlimited* drive would have caused (|z| of the device
/// model, and the mean square of the drive); what it leaves over is cut by the largest factor 0–1
/// for which the modelled |z|, the mean square and the drive stay inside: such a factor always
/// exists, because without drive all three can only fall. So the bounds are never exceeded, by
/// construction. |z| counts speed as excursion to come: far above resonance the limit is reached
/// earlier, by f/f₀.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Protection {
    model: DeviceModel,
    excursion_m: f64,
    rated_square: f64,
    heating: f64,
    release: f64,
}

/// Memory of a [`Protection`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProtectionState {
    z: [f64; 2],
    unlimited: [f64; 2],
    heat: f64,
    unlimited_heat: f64,
    gain: f64,
}

impl Default for ProtectionState {
    fn default() -> Self {
        Self { z: [0.0; 2], unlimited: [0.0; 2], heat: 0.0, unlimited_heat: 0.0, gain: 1.0 }
    }
}

impl Protection {
    /// Protection for `profile`.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn new(profile: &DeviceProfile, sample_rate_hz: f64) -> Result<Self, DesignError> {
        let model = DeviceModel::new(profile, Quantity::Displacement, sample_rate_hz)?;
        Ok(Self {
            model,
            excursion_m: profile.excursion_m,
            rated_square: profile.rated_drive * profile.rated_drive,
            heating: -libm::expm1(-1.0 / (profile.thermal_time_s * sample_rate_hz)),
            release: release_share(sample_rate_hz),
        })
    }

    /// The largest factor 0–1 on `drive` that keeps |z| inside after this step.
    fn excursion_factor(&self, z: [f64; 2], drive: f64) -> f64 {
        let free = self.model.next(z, 0.0);
        let b = self.model.drive().map(|b| b * drive);
        // |free + t b|² = limit²
        let (bb, fb) = (square(b), free[0] * b[0] + free[1] * b[1]);
        let room = (self.excursion_m * self.excursion_m - square(free)).max(0.0);
        if bb == 0.0 {
            return 1.0;
        }
        let root = libm::sqrt(fb * fb + bb * room);
        // The positive root, without cancellation.
        let t = if fb > 0.0 { room / (fb + root) } else { (root - fb) / bb };
        t.clamp(0.0, 1.0)
    }
}

fn square(z: [f64; 2]) -> f64 {
    z[0] * z[0] + z[1] * z[1]
}

fn release_share(sample_rate_hz: f64) -> f64 {
    -libm::expm1(-1.0 / (RELEASE_TIME_S * sample_rate_hz))
}

impl ProtectionState {
    /// One sample of drive → the drive that is safe. A drive that is no finite number counts as 0.
    #[inline]
    pub fn tick(&mut self, design: &Protection, drive: f64) -> f64 {
        let drive = if drive.is_finite() { drive.clamp(-1e6, 1e6) } else { 0.0 };
        self.unlimited = rested(design.model.next(self.unlimited, drive));
        self.unlimited_heat += design.heating * (drive * drive - self.unlimited_heat);
        let wanted = self.smooth_gain(design, drive);
        self.gain = (self.gain + design.release * (1.0 - self.gain)).min(wanted);
        let mut safe = self.gain * drive;
        safe *= design.excursion_factor(self.z, safe);
        let kept = (1.0 - design.heating) * self.heat;
        let room = (design.rated_square - kept).max(0.0) / design.heating;
        if safe * safe > room {
            safe = libm::sqrt(room).copysign(safe);
        }
        // Rounding must not carry a bound over.
        self.z = rested(design.model.next(self.z, safe));
        self.heat = (kept + design.heating * safe * safe).min(design.rated_square);
        if self.heat < REST {
            self.heat = 0.0;
        }
        safe
    }

    /// The gain at which neither the envelope, nor the heat, nor the drive itself would pass its
    /// limit.
    fn smooth_gain(&mut self, design: &Protection, drive: f64) -> f64 {
        if self.unlimited_heat < REST {
            self.unlimited_heat = 0.0;
        }
        let excursion = square(self.unlimited) / (design.excursion_m * design.excursion_m);
        let worst = excursion.max(self.unlimited_heat / design.rated_square).max(drive * drive);
        if worst > 1.0 { 1.0 / libm::sqrt(worst) } else { 1.0 }
    }

    /// The gain at work, 1 = the limiter does nothing.
    #[must_use]
    pub fn gain(&self) -> f64 {
        self.gain
    }

    /// Amplitude of the modelled felt motion, m: never above the profile's excursion.
    #[must_use]
    pub fn amplitude_m(&self) -> f64 {
        libm::sqrt(square(self.z))
    }

    /// Mean square of the drive over the thermal time: never above the rating squared.
    #[must_use]
    pub fn heat(&self) -> f64 {
        self.heat
    }
}

/// Squares of denormal size are rest.
fn rested(z: [f64; 2]) -> [f64; 2] {
    if square(z) < REST { [0.0; 2] } else { z }
}

/// Hold of a [`PeakLimiter`]'s gain after a peak that came near the ceiling, s (chosen: half a
/// period of 10 Hz, so that no audible tone sees the gain move between two of its own peaks).
pub const HOLD_TIME_S: f64 = 0.05;

/// Share of the ceiling from which a peak holds the gain: −3.1 dB. A tone near a quarter of the
/// rate beats with it: for a while all its samples lie up to 3.01 dB below its peaks, and the gain
/// must not rise meanwhile (no other ratio beats deeper).
const NEAR_CEILING: f32 = 0.7;

/// Deepest gain: what is further above the ceiling, 80 dB, is a broken input and is cut, so that it
/// does not silence the seconds after it.
const DEEPEST_GAIN: f32 = 1e-4;

/// Peak limiter for an audio bus: no latency, never above the ceiling.
///
/// ```text
/// g ← c / |x|  where g |x| > c        otherwise, once no |g x| was above 0.7 c for 50 ms, g ← min(1, g e^(1/(τ rate)))
/// ```
/// A gain that rises between two peaks of one tone bends the tone: let go towards 1 with τ = 80 ms
/// at once, it left a sine 20 dB over the ceiling at −32 dB of distortion. So it holds between
/// peaks, and rises in decibels (109 dB a second): a sine's distortion is below −80 dB from its
/// second period on, and below −60 dB from the first beat on where its samples beat with the rate
/// (`tests/actuator.rs`). What goes on within 3.1 dB of the ceiling after something louder stays as
/// much quieter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakLimiter {
    ceiling: f32,
    /// Factor of the gain in a sample in which it rises.
    rise: f32,
    hold_samples: u32,
}

/// Memory of a [`PeakLimiter`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakLimiterState {
    gain: f32,
    /// The lowest that it was.
    deepest: f32,
    /// Samples for which the gain still holds.
    held: u32,
}

impl Default for PeakLimiterState {
    fn default() -> Self {
        Self { gain: 1.0, deepest: 1.0, held: 0 }
    }
}

impl PeakLimiter {
    /// A limiter that never lets a sample above `ceiling`.
    ///
    /// ```
    /// use asperity_dsp::actuator::{PeakLimiter, PeakLimiterState};
    ///
    /// let limiter = PeakLimiter::new(1.0, 44_100.0)?;
    /// let mut block = [0.5, 3.0, -8.0, f32::NAN];
    /// PeakLimiterState::default().run(&limiter, &mut block);
    /// assert!(block.iter().all(|x| x.abs() <= 1.0));
    /// # Ok::<(), asperity_dsp::DesignError>(())
    /// ```
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn new(ceiling: f64, sample_rate_hz: f64) -> Result<Self, DesignError> {
        let ceiling = DesignError::check("ceiling", ceiling, "above 0", |c| c > 0.0)? as f32;
        let rate = DesignError::check("sample_rate_hz", sample_rate_hz, "above 0 Hz", |r| r > 0.0)?;
        let rise = libm::exp(1.0 / (RELEASE_TIME_S * rate)) as f32;
        Ok(Self { ceiling, rise, hold_samples: (HOLD_TIME_S * rate) as u32 })
    }

    /// The ceiling.
    #[must_use]
    pub const fn ceiling(&self) -> f32 {
        self.ceiling
    }
}

impl PeakLimiterState {
    /// Limits `block` in place. A sample that is no finite number becomes 0.
    pub fn run(&mut self, design: &PeakLimiter, block: &mut [f32]) {
        for x in block {
            let peak = if x.is_finite() { x.abs() } else { 0.0 };
            self.follow(design, peak);
            *x = if x.is_finite() { (self.gain * *x).clamp(-design.ceiling, design.ceiling) } else { 0.0 };
        }
    }

    /// The gain falls at once, holds, and rises.
    #[inline]
    fn follow(&mut self, design: &PeakLimiter, peak: f32) {
        if self.gain * peak > NEAR_CEILING * design.ceiling {
            self.held = design.hold_samples;
        } else if self.held > 0 {
            self.held -= 1;
        } else {
            self.gain = (self.gain * design.rise).min(1.0);
        }
        if self.gain * peak > design.ceiling {
            self.gain = (design.ceiling / peak).max(DEEPEST_GAIN);
            self.deepest = self.deepest.min(self.gain);
        }
    }

    /// The lowest gain that was at work so far.
    #[must_use]
    pub const fn deepest(&self) -> f32 {
        self.deepest
    }

    /// The gain at work.
    #[must_use]
    pub const fn gain(&self) -> f32 {
        self.gain
    }
}
