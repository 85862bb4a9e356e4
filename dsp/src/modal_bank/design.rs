//! From modes to the coefficients of one group of 16 lanes; fallible, in `f64`, once.

use super::LANES;
use crate::DesignError;
use crate::mode::Mode;
use core::f64::consts::PI;

/// Samples between two trims; an absolute grid, so that no split into blocks changes a sample.
pub const GRID_SAMPLES: u64 = 64;

/// How a group is designed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GroupOptions {
    /// The bank is fed from an impulse ring ([`crate::hertz`]): each mode is divided by the ring's
    /// cubic kernel at the mode's own complex frequency, and advanced by the kernel's latency.
    pub impulse_kernel_compensation: bool,
    /// Undo on the 64-sample grid what rounding R² and m to `f32` did to decay and pitch.
    pub true_t60: bool,
}

impl Default for GroupOptions {
    fn default() -> Self {
        Self { impulse_kernel_compensation: false, true_t60: true }
    }
}

impl GroupOptions {
    /// For a bank that listens to an impulse ring: compensated and trimmed.
    pub const IMPULSE_RING: Self = Self { impulse_kernel_compensation: true, true_t60: true };
}

/// Coefficients of 16 modes, one a lane; plain data the caller stores. An unused lane is silent.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct ModeGroup {
    /// R².
    pub(super) r2: [f32; LANES],
    /// m = 1 − 2R cos θ + R², for the R² that was really stored.
    pub(super) m: [f32; LANES],
    /// Output gain of y.
    pub(super) out_y: [f32; LANES],
    /// Output gain of d.
    pub(super) out_d: [f32; LANES],
    /// Once in [`GRID_SAMPLES`]: y gains `trim_yy` · y + `trim_yd` · d.
    pub(super) trim_yy: [f32; LANES],
    pub(super) trim_yd: [f32; LANES],
    /// And d gains `trim_dy` · y + `trim_dd` · d.
    pub(super) trim_dy: [f32; LANES],
    pub(super) trim_dd: [f32; LANES],
    /// a sin θ: one component of the lane's amplitude in output units is this · y.
    pub(super) level: [f32; LANES],
    /// a (cos θ − R): the other component is this · y + `quad_d` · d.
    pub(super) quad_y: [f32; LANES],
    /// a R.
    pub(super) quad_d: [f32; LANES],
}

/// What 16 modes remember between samples.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct GroupState {
    pub(super) y: [f32; LANES],
    pub(super) d: [f32; LANES],
}

impl GroupState {
    /// At rest.
    pub const REST: Self = Self { y: [0.0; LANES], d: [0.0; LANES] };

    /// True when every lane is exactly at rest.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.y.iter().chain(&self.d).all(|&x| x == 0.0)
    }
}

impl Default for GroupState {
    fn default() -> Self {
        Self::REST
    }
}

/// What each lane takes from one of several inputs: the mode shape where that contact strikes, or
/// 1 and 0 to let the modes of several bodies share a group.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct LaneGains(pub [f32; LANES]);

/// A mode at one sample rate, ready for any form of the filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pole {
    /// −ln R = decay · step.
    pub decay: f64,
    pub theta: f64,
    pub amplitude: f64,
    pub phase_rad: f64,
}

impl Pole {
    /// `None` when the mode is at or above the Nyquist frequency: it stays silent.
    pub fn new(mode: &Mode, rate_hz: f64, options: &GroupOptions) -> Result<Option<Self>, DesignError> {
        let rate = DesignError::check("sample_rate_hz", rate_hz, "above 0 Hz", |r| r > 0.0)?;
        let f = DesignError::check("frequency_hz", mode.frequency_hz, "above 0 Hz", |f| f > 0.0)?;
        let d = DesignError::check("decay_per_s", mode.decay_per_s, "0 or more", |d| d >= 0.0)?;
        DesignError::check("amplitude", mode.amplitude, "below 1e12", |a| a.abs() < 1e12)?;
        DesignError::check("phase_rad", mode.phase_rad, "finite", |_| true)?;
        if f >= 0.5 * rate {
            return Ok(None);
        }
        let (decay, theta) = (d / rate, 2.0 * PI * f / rate);
        let (mut amplitude, mut phase_rad) = (mode.amplitude, mode.phase_rad);
        if options.impulse_kernel_compensation {
            let (gain, angle) = crate::hertz::kernel_at(decay, theta);
            let latency = crate::hertz::KERNEL_LATENCY as f64;
            amplitude *= libm::exp(-decay * latency) / gain;
            phase_rad += theta * latency - angle;
        }
        Ok(Some(Self { decay, theta, amplitude, phase_rad }))
    }

    /// b₀ and b₁ of the numerator b₀ + b₁ z⁻¹.
    pub fn numerator(&self) -> (f64, f64) {
        let r = libm::exp(-self.decay);
        let b0 = self.amplitude * libm::sin(self.phase_rad);
        (b0, self.amplitude * r * libm::sin(self.theta - self.phase_rad))
    }
}

impl ModeGroup {
    /// Sixteen silent lanes.
    pub const SILENT: Self = Self {
        r2: [0.0; LANES],
        // With R² = 0 and m = 1 a lane holds its last input and nothing older.
        m: [1.0; LANES],
        out_y: [0.0; LANES],
        out_d: [0.0; LANES],
        trim_yy: [0.0; LANES],
        trim_yd: [0.0; LANES],
        trim_dy: [0.0; LANES],
        trim_dd: [0.0; LANES],
        level: [0.0; LANES],
        quad_y: [0.0; LANES],
        quad_d: [0.0; LANES],
    };

    fn set_lane(&mut self, lane: usize, pole: &Pole, options: &GroupOptions) {
        let r2 = libm::exp(-2.0 * pole.decay) as f32;
        // The pole pair that f32 really stores: its radius is √r2, and m is chosen for that radius.
        let stored = f64::from(r2);
        let radius = libm::sqrt(stored);
        let half = libm::sin(0.5 * pole.theta);
        let gap = 1.0 - radius;
        let (b0, b1) = pole.numerator();
        self.r2[lane] = r2;
        self.m[lane] = (gap * gap + 4.0 * radius * half * half) as f32;
        self.out_y[lane] = (b0 + b1) as f32;
        self.out_d[lane] = -b1 as f32;
        if options.true_t60 {
            self.set_trim(lane, pole);
        }
        let a = pole.amplitude.abs();
        self.level[lane] = (a * libm::sin(pole.theta)) as f32;
        self.quad_y[lane] = (a * (gap - 2.0 * half * half)) as f32;
        self.quad_d[lane] = (a * radius) as f32;
    }
}

impl ModeGroup {
    /// The turn e^((λ − λ stored) · 64 samples) − 1 that the stored pole lacks, for the pair (y, d).
    fn set_trim(&mut self, lane: usize, pole: &Pole) {
        let Some(stored) = StoredPole::read(self.r2[lane], self.m[lane]) else { return };
        let grid = GRID_SAMPLES as f64;
        let grow = libm::expm1(grid * (-pole.decay - libm::log(stored.radius)));
        let turn = grid * (pole.theta - stored.theta);
        let (half, sin) = (libm::sin(0.5 * turn), libm::sin(turn));
        // (1 + grow) e^(i turn) − 1
        let a = grow - 2.0 * (1.0 + grow) * half * half;
        let b = (1.0 + grow) * sin;
        // q = k y + l d is the quadrature of y.
        let (k, l) = (stored.cos_less_radius / stored.sin, stored.radius / stored.sin);
        self.trim_yy[lane] = (a + b * k) as f32;
        self.trim_yd[lane] = (b * l) as f32;
        self.trim_dy[lane] = (-b * (1.0 + k * k) / l) as f32;
        self.trim_dd[lane] = (a - b * k) as f32;
    }
}

/// The pole pair that a lane's two stored numbers stand for.
pub(super) struct StoredPole {
    pub radius: f64,
    pub theta: f64,
    /// cos θ − R, without cancellation.
    pub cos_less_radius: f64,
    pub sin: f64,
}

impl StoredPole {
    /// `None` for a silent lane.
    pub fn read(r2: f32, m: f32) -> Option<Self> {
        let radius = libm::sqrt(f64::from(r2));
        let gap = 1.0 - radius;
        let half_square = (f64::from(m) - gap * gap) / (4.0 * radius);
        // False for the silent lane's 1/0 as well.
        if !(half_square > 0.0 && half_square < 1.0) {
            return None;
        }
        let half = libm::sqrt(half_square);
        Some(Self {
            radius,
            theta: 2.0 * libm::asin(half),
            cos_less_radius: gap - 2.0 * half_square,
            sin: 2.0 * libm::sqrt(half_square * (1.0 - half_square)),
        })
    }
}

/// Designs one group from up to 16 modes; modes at or above Nyquist and unused lanes are silent.
///
/// # Errors
/// Names the field that is out of range, or `modes` when there are more than [`LANES`].
pub fn design_group(
    modes: &[Mode],
    sample_rate_hz: f64,
    options: &GroupOptions,
) -> Result<ModeGroup, DesignError> {
    DesignError::check("modes", modes.len() as f64, "16 or fewer a group", |n| n <= LANES as f64)?;
    let mut group = ModeGroup::SILENT;
    for (lane, mode) in modes.iter().enumerate() {
        if let Some(pole) = Pole::new(mode, sample_rate_hz, options)? {
            group.set_lane(lane, &pole, options);
        }
    }
    Ok(group)
}

/// Groups that `modes` modes need.
#[must_use]
pub const fn groups_for(modes: usize) -> usize {
    modes.div_ceil(LANES)
}

/// Puts the slowest decays first, as the sleep of [`super::Awake`] wants them; allocates nothing.
pub fn sort_by_decay(modes: &mut [Mode]) {
    modes.sort_unstable_by(|a, b| {
        a.decay_per_s.total_cmp(&b.decay_per_s).then(a.frequency_hz.total_cmp(&b.frequency_hz))
    });
}
