//! One actuator channel: the sum of its contacts, SI units in, samples out.

use super::Quantity;
use super::device::DeviceProfile;
use super::equaliser::{Equaliser, EqualiserState};
use super::limiter::{Protection, ProtectionState};
use crate::DesignError;
use crate::limits::output as limits;

/// Time in which a changed user gain or mute takes effect, s (chosen).
pub const GAIN_RAMP_S: f64 = 0.02;

/// Samples below this are written as zero: 300 dB below full scale.
const SMALLEST_SAMPLE: f64 = 1e-15;

/// Inputs are clamped to this many times full scale, so that a broken one does not ring for
/// seconds.
const LARGEST_INPUT: f64 = 1e6;

/// Samples of silence after which the filters are exactly at rest.
const QUIET_SAMPLES: u32 = 64;

/// Design of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelOptions {
    /// Which quantity comes in.
    pub quantity: Quantity,
    /// m or m/s² at sample value 1.0; with an equaliser, at the device's resonance.
    pub full_scale: f64,
    /// Time from silence to full gain after the start, s; 0 = at once.
    pub soft_start_s: f64,
    /// Device whose response is inverted.
    pub equalise: Option<DeviceProfile>,
    /// Device whose limits are kept.
    pub limit: Option<DeviceProfile>,
}

impl Default for ChannelOptions {
    /// 0.1 mm is full scale; no soft start, no device.
    fn default() -> Self {
        Self {
            quantity: Quantity::Displacement,
            full_scale: 1e-4,
            soft_start_s: 0.0,
            equalise: None,
            limit: None,
        }
    }
}

/// Coefficients of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channel {
    scale: f64,
    soft_start_step: f64,
    ramp_step: f64,
    equaliser: Option<Equaliser>,
    protection: Option<Protection>,
}

/// Settings of the person wearing the device, at any time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelControl {
    /// Linear gain, 0–100.
    pub gain: f64,
    /// True: silence, after a short ramp.
    pub mute: bool,
}

impl Default for ChannelControl {
    fn default() -> Self {
        Self { gain: 1.0, mute: false }
    }
}

/// Memory of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ChannelState {
    /// Progress of the soft start, 0–1.
    started: f64,
    /// User gain at work; none before the first sample.
    gain: Option<f64>,
    equaliser: EqualiserState,
    protection: ProtectionState,
    quiet: u32,
}

impl Channel {
    /// Designs the channel.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn new(options: &ChannelOptions, sample_rate_hz: f64) -> Result<Self, DesignError> {
        let rate = DesignError::check("sample_rate_hz", sample_rate_hz, "above 0 Hz", |r| r > 0.0)?;
        let full = limits::FULL_SCALE.check("full_scale", options.full_scale)?;
        let soft = DesignError::check("soft_start_s", options.soft_start_s, "0 s or more", |t| t >= 0.0)?;
        let equaliser = match &options.equalise {
            Some(profile) => Some(Equaliser::new(profile, options.quantity, rate)?),
            None => None,
        };
        let protection = match &options.limit {
            Some(profile) => Some(Protection::new(profile, rate)?),
            None => None,
        };
        Ok(Self {
            scale: 1.0 / full,
            soft_start_step: if soft > 0.0 { 1.0 / (soft * rate) } else { 1.0 },
            ramp_step: 1.0 / (GAIN_RAMP_S * rate),
            equaliser,
            protection,
        })
    }

    /// Delay of the equaliser, s; everything else is without delay.
    #[must_use]
    pub fn group_delay_s(&self) -> f64 {
        self.equaliser.as_ref().map_or(0.0, Equaliser::group_delay_s)
    }
}

impl ChannelState {
    /// Turns the summed contacts, m or m/s², into samples. Lengths: as far as the shorter slice
    /// reaches.
    pub fn run(&mut self, design: &Channel, control: &ChannelControl, sum_si: &[f64], out: &mut [f32]) {
        let wanted =
            if control.mute || !control.gain.is_finite() { 0.0 } else { control.gain.clamp(0.0, 100.0) };
        let plain = design.equaliser.is_none() && design.protection.is_none();
        if plain && self.started == 1.0 && self.gain == Some(wanted) {
            return self.run_plain(design.scale, wanted, sum_si, out);
        }
        for (&x, y) in sum_si.iter().zip(out) {
            let gain = self.ramped(design, wanted);
            let x = if x.is_finite() { x } else { 0.0 };
            if x == 0.0 && self.quiet >= QUIET_SAMPLES {
                // Only the limiter's memory is still moving.
                if let Some(protection) = &design.protection {
                    self.protection.tick(protection, 0.0);
                }
                *y = 0.0;
                continue;
            }
            let mut drive = (x * design.scale).clamp(-LARGEST_INPUT, LARGEST_INPUT);
            if let Some(equaliser) = &design.equaliser {
                drive = self.equaliser.tick(equaliser, drive);
            }
            self.count_quiet(x, drive);
            drive *= gain;
            if let Some(protection) = &design.protection {
                drive = self.protection.tick(protection, drive);
            }
            *y = if drive.abs() < SMALLEST_SAMPLE { 0.0 } else { drive.clamp(-1e30, 1e30) as f32 };
        }
    }

    /// Samples as the general loop gives them, where nothing ramps and nothing is held.
    fn run_plain(&mut self, scale: f64, gain: f64, sum_si: &[f64], out: &mut [f32]) {
        let sane = |x: f64| if x.is_finite() { x } else { 0.0 };
        for (&x, y) in sum_si.iter().zip(&mut *out) {
            let drive = (sane(x) * scale).clamp(-LARGEST_INPUT, LARGEST_INPUT) * gain;
            *y = if drive.abs() < SMALLEST_SAMPLE { 0.0 } else { drive as f32 };
        }
        let count = sum_si.len().min(out.len());
        let silent = |x: &&f64| sane(**x) == 0.0;
        let tail = sum_si[..count].iter().rev().take_while(silent).count();
        let before = if tail == count { self.quiet } else { 0 };
        self.quiet = before.saturating_add(tail as u32).min(QUIET_SAMPLES);
    }

    /// After a while of silence in and out the filters are put exactly to rest.
    #[inline]
    fn count_quiet(&mut self, input: f64, drive: f64) {
        self.quiet = if input == 0.0 && drive.abs() < SMALLEST_SAMPLE { self.quiet + 1 } else { 0 };
        if self.quiet == QUIET_SAMPLES {
            self.equaliser = EqualiserState::default();
        }
    }

    /// Soft start times the user gain, which moves at most one step a sample.
    #[inline]
    fn ramped(&mut self, design: &Channel, wanted: f64) -> f64 {
        self.started = (self.started + design.soft_start_step).min(1.0);
        let now = self.gain.unwrap_or(wanted);
        let step = design.ramp_step * now.max(wanted).max(1.0);
        let gain = now + (wanted - now).clamp(-step, step);
        self.gain = Some(gain);
        gain * self.started
    }

    /// The limiter's memory, for statistics.
    #[must_use]
    pub fn protection(&self) -> &ProtectionState {
        &self.protection
    }
}
