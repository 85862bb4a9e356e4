//! Coefficient design for one group of 16 modes; fallible, in `f64`, once.

use super::LANES;
use crate::DesignError;
use crate::mode::Mode;
use core::f64::consts::PI;

/// Samples between two trims; an absolute grid, so that no split into blocks changes a sample.
pub const GRID_SAMPLES: u64 = 64;

/// Design of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GroupOptions {
    /// The bank is fed from an impulse ring ([`crate::hertz`]): each mode is divided by the ring's
    /// cubic kernel at the mode's own complex frequency. It sounds the kernel's latency later, and
    /// its direct term answers a slow force exactly.
    pub impulse_kernel_compensation: bool,
    /// Undo on the 64-sample grid what rounding R² and m to `f32` did to decay and pitch.
    pub true_t60: bool,
    /// Time derivatives of the modes' responses that sound instead of them, 0 to 2, for modes that
    /// begin at zero (`phase_rad` 0): of a displacement its velocity or its acceleration, to which
    /// a force belongs while it lasts (the pulse in the second derivative of a response that begins
    /// with a slope). That share is the direct term's, as wide as the ring's kernel.
    pub derivative: u8,
}

impl Default for GroupOptions {
    fn default() -> Self {
        Self { impulse_kernel_compensation: false, true_t60: true, derivative: 0 }
    }
}

impl GroupOptions {
    /// For a bank that listens to an impulse ring: compensated and trimmed.
    pub const IMPULSE_RING: Self = Self { impulse_kernel_compensation: true, true_t60: true, derivative: 0 };
}

/// Coefficients of 16 modes, one a lane; plain data the caller stores. An unused lane is silent.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct ModeGroup {
    /// Coefficients that every turn reads: [`STEP`] and [`OUT`]; lane l at [`place`].
    pub(super) hot: [Lanes; HOT],
    /// Once in [`GRID_SAMPLES`]: v gains `trim[0][0]` · v + `trim[0][1]` · w, w the same of row 1.
    pub(super) trim: [[Lanes; 2]; 2],
    /// The output at the turn's beginning, `now[0]` · v + `now[1]` · w.
    pub(super) now: [Lanes; 2],
    /// h₀, the direct term: what an impulse sends to the output of its own sample.
    pub(super) direct: Lanes,
    /// The output a quarter period later, but for the decay: the other component of its phasor.
    pub(super) quarter: [Lanes; 2],
    /// Response at the output of its own and of the next three samples to an impulse on all lanes:
    /// h₀…h₃.
    pub(super) heard_as: [f32; TURN],
}

/// Two samples of free motion: v becomes coefficient 0 · v + 1 · w, w becomes 2 · v + 3 · w.
pub(super) const STEP: usize = 0;
/// The turn's outputs, of five products where eight would be the obvious way. An impulse is heard n
/// samples later as hₙ, and the states are as good as two impulses: w in the last but one sample, v
/// − w in the last. So output n is hₙ₊₁ (v − w) + hₙ₊₂ w: a filter of two taps over h₁…h₅, for
/// which the shortest method (Toom and Cook's, Winograd's F(4, 2)) multiplies v − w, v, v − 2w, v +
/// w and w by these. [`super::sums::outputs`] puts the products together.
pub(super) const OUT: usize = 4;
/// Coefficients that every turn reads.
pub(super) const HOT: usize = 9;
/// Samples in a turn of the hot loop, which begins at absolute multiples of it.
pub(super) const TURN: usize = 4;

/// Place of a lane in coefficient `i` of [`ModeGroup::hot`]: the halves of every other one change
/// places. Vectors of eight from the same half of several cache lines come at 1.9 a cycle, from
/// either half in turn at 2.5.
pub(super) const fn place(i: usize, lane: usize) -> usize {
    lane ^ (i % 2 * (LANES / 2))
}

/// One number for each mode of a group.
pub(super) type Lanes = [f32; LANES];

/// State of 16 modes between samples.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct GroupState {
    pub(super) v: Lanes,
    pub(super) w: Lanes,
    /// Inputs of the lanes in the samples so far of a turn that is not complete; otherwise zero.
    pub(super) pending: [Lanes; TURN - 1],
    /// Part of those samples' inputs in the outputs of the turn's other samples; kept by the first
    /// group of a bank.
    pub(super) carried: [f32; TURN],
}

impl GroupState {
    /// At rest.
    pub const REST: Self =
        Self { v: [0.0; LANES], w: [0.0; LANES], pending: [[0.0; LANES]; TURN - 1], carried: [0.0; TURN] };

    /// True when every lane is exactly at rest.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        let lanes = self.v.iter().chain(&self.w).chain(self.pending.as_flattened());
        lanes.chain(&self.carried).all(|&x| x == 0.0)
    }
}

impl Default for GroupState {
    fn default() -> Self {
        Self::REST
    }
}

/// Gain of each lane from one of several inputs: the mode shape where that contact strikes, or
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
    /// Added to h₀: ∫ h − Σ hⱼ, j ≥ 0, of the wanted mode's continuous and this one's sampled
    /// response.
    pub direct_correction: f64,
    /// Added to h₀: what passes at once, of the second derivative.
    pub passed: f64,
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
        let (mode, passed) = derived(mode, options.derivative);
        let (mut amplitude, mut phase_rad) = (mode.amplitude, mode.phase_rad);
        if options.impulse_kernel_compensation {
            let (gain, angle) = crate::hertz::kernel_at(decay, theta);
            amplitude /= gain;
            phase_rad -= angle;
        }
        let passed = passed * rate;
        let mut pole = Self { decay, theta, amplitude, phase_rad, direct_correction: 0.0, passed };
        if options.impulse_kernel_compensation {
            // A steady force is answered as by the equation; so is a slow one, up to its first
            // derivative.
            let (b0, b1) = pole.numerator();
            let (sin, cos) = (libm::sin(mode.phase_rad), libm::cos(mode.phase_rad));
            let continuous = mode.amplitude * (theta * cos + decay * sin) / (decay * decay + theta * theta);
            let (r, cos_theta) = (libm::exp(-decay), libm::cos(theta));
            pole.direct_correction = continuous - (b0 + b1) / (1.0 - 2.0 * r * cos_theta + r * r);
        }
        Ok(Some(pole))
    }

    /// b₀ and b₁ of the numerator b₀ + b₁ z⁻¹.
    pub fn numerator(&self) -> (f64, f64) {
        let r = libm::exp(-self.decay);
        let b0 = self.amplitude * libm::sin(self.phase_rad);
        (b0, self.amplitude * r * libm::sin(self.theta - self.phase_rad))
    }
}

/// A mode that sounds as so many derivatives of another, and the impulse at the onset of the last.
///
/// ```text
/// d/dt a e^(−dt) sin(ωt + φ) = a ω₀ e^(−dt) sin(ωt + φ + ψ)        ω₀² = ω² + d²,   ψ = atan2(ω, −d)
/// ```
fn derived(mode: &Mode, derivatives: u8) -> (Mode, f64) {
    let (omega, mut of, mut onset) = (2.0 * PI * mode.frequency_hz, *mode, 0.0);
    for _ in 0..derivatives {
        onset = of.amplitude * libm::sin(of.phase_rad);
        of.amplitude *= libm::hypot(omega, mode.decay_per_s);
        of.phase_rad += libm::atan2(omega, -mode.decay_per_s);
    }
    (of, onset)
}

impl ModeGroup {
    /// Sixteen silent lanes.
    pub const SILENT: Self = {
        let lanes = [0.0; LANES];
        let (two, four) = ([lanes; 2], [[lanes; 2]; 2]);
        Self { hot: [lanes; HOT], trim: four, now: two, direct: lanes, quarter: two, heard_as: [0.0; TURN] }
    };

    fn set_lane(&mut self, lane: usize, pole: &Pole, options: &GroupOptions) {
        let radius = libm::exp(-pole.decay);
        let (sin, cos) = (libm::sin(pole.theta), libm::cos(pole.theta));
        let (b0, b1) = pole.numerator();
        let next = free_step(pole);
        let [_, [_, g]] = next;
        let step = square(next);
        let now = [b0, b0 * g + b1];
        // Rows of (v, w): the output in each sample of the turn and the next. What is times v is
        // h₁, h₂, …
        let mut row = now;
        let h: [[f64; 2]; 5] = core::array::from_fn(|_| {
            [row] = product([row], next);
            row
        });
        let quarter = [0, 1].map(|i| (h[0][i] / radius - cos * now[i]) / sin);
        let mut set = |i: usize, x: f64| self.hot[i][place(i, lane)] = x as f32;
        for (i, x) in step.into_iter().flatten().enumerate() {
            set(STEP + i, x);
        }
        let [h1, h2, h3, h4, h5] = h.map(|row| row[0]);
        for (i, x) in out_of([h1, h2, h3, h4, h5]).into_iter().enumerate() {
            set(OUT + i, x);
        }
        let direct = b0 + pole.direct_correction + pole.passed;
        self.direct[lane] = direct as f32;
        for (sum, h) in self.heard_as.iter_mut().zip([direct, h1, h2, h3]) {
            *sum += h as f32;
        }
        for i in 0..2 {
            self.now[i][lane] = now[i] as f32;
            self.quarter[i][lane] = quarter[i] as f32;
        }
        if options.true_t60 {
            self.set_trim(lane, step);
        }
    }

    /// Deficit of the stored step of two samples after a whole grid: (exact ^ 32) (stored ^ 32)⁻¹ −
    /// 1.
    fn set_trim(&mut self, lane: usize, step: Matrix) {
        let stored =
            [[0, 1], [2, 3]].map(|row| row.map(|i| f64::from(self.hot[STEP + i][place(STEP + i, lane)])));
        let [exact, [[a, b], [c, d]]] = [step, stored].map(|x| (0..5).fold(x, |x, _| square(x)));
        let det = a * d - b * c;
        // A mode that decays by 60 dB within the grid needs no exact decay.
        if det > 1e-6 {
            let [[vv, vw], [wv, ww]] = product(exact, [[d / det, -b / det], [-c / det, a / det]]);
            for (to, row) in self.trim.iter_mut().zip([[vv - 1.0, vw], [wv, ww - 1.0]]) {
                (to[0][lane], to[1][lane]) = (row[0] as f32, row[1] as f32);
            }
        }
    }
}

/// The coefficients at [`OUT`] of h₁…h₅.
pub(super) fn out_of([h1, h2, h3, h4, h5]: [f64; 5]) -> [f64; 5] {
    [
        (2.0 * h1 - h2 - 2.0 * h3 + h4) / 2.0,
        (2.0 * h2 + h3 - h4) / 2.0,
        (3.0 * h3 - 2.0 * h2 - h4) / 6.0,
        (h4 - h2) / 6.0,
        2.0 * h2 - h3 - 2.0 * h4 + h5,
    ]
}

/// Rows of a linear map of (v, w).
pub(super) type Matrix = [[f64; 2]; 2];

fn product<const N: usize>(left: [[f64; 2]; N], right: Matrix) -> [[f64; 2]; N] {
    left.map(|row| [0, 1].map(|i| row[0] * right[0][i] + row[1] * right[1][i]))
}

/// One sample of free motion.
pub(super) fn free_step(pole: &Pole) -> Matrix {
    let radius = libm::exp(-pole.decay);
    let (gap, half) = (-libm::expm1(-pole.decay), libm::sin(0.5 * pole.theta));
    let m = gap * gap + 4.0 * radius * half * half;
    [[1.0, -m], [1.0, 1.0 - (m - libm::expm1(-2.0 * pole.decay))]]
}

pub(super) fn square(x: Matrix) -> Matrix {
    product(x, x)
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

/// Designs the groups of a body, 16 modes each in their order; modes at or above Nyquist are
/// silent.
///
/// # Errors
/// Each group names the field that is out of range.
pub fn design_groups(
    modes: &[Mode],
    sample_rate_hz: f64,
    options: &GroupOptions,
) -> impl ExactSizeIterator<Item = Result<ModeGroup, DesignError>> {
    modes.chunks(LANES).map(move |chunk| design_group(chunk, sample_rate_hz, options))
}

/// Puts the slowest decays first, as the sleep of a [`super::ModalBank`] wants them; allocates
/// nothing.
pub fn sort_by_decay(modes: &mut [Mode]) {
    modes.sort_unstable_by(|a, b| {
        a.decay_per_s.total_cmp(&b.decay_per_s).then(a.frequency_hz.total_cmp(&b.frequency_hz))
    });
}
