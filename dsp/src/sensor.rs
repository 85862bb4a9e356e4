//! Accelerometer or contact microphone: from what its place does to the volts of its converter.
//!
//! ```text
//! H(s) = ω₀² / (s² + ω₀/Q s + ω₀²) · s/(s + ω_low) · ω_high²/(s² + √2 ω_high s + ω_high²)
//! volts = round(clamp(H · x + noise, ±clip) · gain / step) · step        step = 2 clip gain / 2^bits
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | ω₀, Q | [`SensorProfile::resonance_hz`], [`quality`](SensorProfile::quality): the seismic mass, or what it is mounted with |
//! | ω_low, ω_high | [`SensorProfile::band_hz`]: −3 dB each; 0 below, and above the Nyquist frequency, is none |
//! | noise | white, σ = density · √(rate/2), added behind the resonance: it has the sensor's own spectrum |
//!
//! Digital form: each second-order factor has the poles of the equation and a numerator whose
//! magnitude is exact at three frequencies (M. Vicanek, "Matched second order digital filters",
//! 2016), so that nothing is warped; changed: these are 0 and `MATCHED`, where the greatest error
//! is least, instead of 0, the resonance and the Nyquist frequency (1 to 5 dB off). A resonance
//! beyond the Nyquist frequency has the three taps of the numerator alone. Measured in
//! `dsp/tests/sensor.rs`, up to 0.45 of the rate: within 0.3 dB of the equation for resonances up
//! to 0.48 and from 0.87 of the rate on; within 2 dB from 0.6 on; between 0.48 and 0.6 a resonance
//! of Q above 2 is up to 10 dB off in the last octave.

use crate::DesignError;
use crate::limits::sensor as limits;
use crate::rng::Rng;
use core::f64::consts::{FRAC_1_SQRT_2, PI};

/// Frequencies beside 0 where the magnitude is exact, over the Nyquist frequency.
const MATCHED: [f64; 2] = [0.65, 0.88];
/// Frequencies of a filter without poles.
const MATCHED_TAPS: [f64; 2] = [0.55, 0.86];

/// A sensor as its data sheet describes it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SensorProfile {
    /// f₀, Hz.
    pub resonance_hz: f64,
    /// Q.
    pub quality: f64,
    /// Band, Hz; 0 is no lower end.
    pub band_hz: [f64; 2],
    /// Noise density, m/s²/√Hz.
    pub noise_m_s2_rthz: f64,
    /// Greatest reading, m/s².
    pub clip_m_s2: f64,
    /// Gain, V/(m/s²).
    pub gain_v_per_m_s2: f64,
    /// Bits of the converter over ±clip; 0 = none.
    pub adc_bits: u32,
}

impl SensorProfile {
    /// Checks every field.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn check(&self) -> Result<(), DesignError> {
        limits::RESONANCE_HZ.check("resonance_hz", self.resonance_hz)?;
        limits::QUALITY.check("quality", self.quality)?;
        let [low, high] = self.band_hz;
        limits::BAND_HZ.check("band_hz", low)?;
        let ordered = limits::BAND_HZ.holds(high) && low < high;
        DesignError::check("band_hz", high, limits::BAND_HZ.words, |_| ordered)?;
        limits::NOISE_M_S2_RTHZ.check("noise_m_s2_rthz", self.noise_m_s2_rthz)?;
        limits::CLIP_M_S2.check("clip_m_s2", self.clip_m_s2)?;
        limits::GAIN_V_PER_M_S2.check("gain_v_per_m_s2", self.gain_v_per_m_s2)?;
        limits::ADC_BITS.check("adc_bits", f64::from(self.adc_bits)).map(|_| ())
    }

    /// |H| at a frequency, as the equation has it.
    #[must_use]
    pub fn response(&self, hz: f64) -> f64 {
        let [low, high] = self.band_hz;
        let below = if low > 0.0 { hz / libm::hypot(hz, low) } else { 1.0 };
        let square =
            low_pass_square(hz / self.resonance_hz, self.quality) * low_pass_square(hz / high, FRAC_1_SQRT_2);
        libm::sqrt(square) * below
    }
}

/// |1 / (1 − r² + i r/Q)|².
fn low_pass_square(r: f64, quality: f64) -> f64 {
    let real = 1.0 - r * r;
    1.0 / (real * real + r * r / (quality * quality))
}

/// Filters of a sensor at the rate of what they hear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorFilter {
    sections: [Section; 3],
}

/// State of a [`SensorFilter`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SensorFilterState([[f64; 2]; 3]);

/// b₀ + b₁ z⁻¹ + b₂ z⁻² over 1 + a₁ z⁻¹ + a₂ z⁻².
#[derive(Debug, Clone, Copy, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

impl Section {
    const PLAIN: Self = Self { b: [1.0, 0.0, 0.0], a: [0.0; 2] };

    /// First-order high-pass.
    fn high_pass(hz: f64, rate_hz: f64) -> Self {
        // −3 dB where it is written, by the bilinear transform.
        let k = libm::tan(PI * (hz / rate_hz).min(0.49));
        let b = 1.0 / (1.0 + k);
        Self { b: [b, -b, 0.0], a: [(k - 1.0) * b, 0.0] }
    }

    /// Second-order low-pass.
    fn low_pass(hz: f64, quality: f64, rate_hz: f64) -> Self {
        let (omega, damping) = (2.0 * PI * hz / rate_hz, 0.5 / quality);
        let square = |w: f64| low_pass_square(w / omega, quality);
        let (radius, under) = (libm::exp(-damping * omega), 1.0 - damping * damping);
        let swing = libm::sqrt(under.abs()) * omega;
        let cosine = if under >= 0.0 { libm::cos(swing) } else { libm::cosh(swing) };
        let (a, matched) = if omega < PI {
            ([-2.0 * radius * cosine, radius * radius], MATCHED)
        } else {
            ([0.0; 2], MATCHED_TAPS)
        };
        let (one, other) = (1.0 + a[0] + a[1], 1.0 - a[0] + a[1]);
        let poles = [one * one, other * other, -4.0 * a[1]];
        // |numerator|² = B₀ cos² + B₁ sin² + B₂ sin² 2·, of half the angle.
        let terms = |w: f64| {
            let high = libm::sin(0.5 * w) * libm::sin(0.5 * w);
            [1.0 - high, high, 4.0 * high * (1.0 - high)]
        };
        let [(near, near_rest), (far, far_rest)] = matched.map(|at| {
            let terms = terms(at * PI);
            let sum: f64 = poles.iter().zip(terms).map(|(pole, term)| pole * term).sum();
            (terms, square(at * PI) * sum - poles[0] * terms[0])
        });
        let determinant = near[1] * far[2] - near[2] * far[1];
        let second = ((near_rest * far[2] - near[2] * far_rest) / determinant).max(0.0);
        let third = (near[1] * far_rest - near_rest * far[1]) / determinant;
        let (first, second) = (libm::sqrt(poles[0]), libm::sqrt(second));
        let mean = 0.5 * (first + second);
        let b0 = 0.5 * (mean + libm::sqrt((mean * mean + third).max(0.0)));
        Self { b: [b0, 0.5 * (first - second), -0.25 * third / b0], a }
    }

    /// Transposed direct form II.
    fn tick(&self, [s1, s2]: &mut [f64; 2], x: f64) -> f64 {
        let y = self.b[0] * x + *s1;
        *s1 = self.b[1] * x - self.a[0] * y + *s2;
        *s2 = self.b[2] * x - self.a[1] * y;
        y
    }
}

impl SensorFilter {
    /// For samples at this rate.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn new(profile: &SensorProfile, rate_hz: f64) -> Result<Self, DesignError> {
        profile.check()?;
        DesignError::check("sample_rate_hz", rate_hz, "above 0 Hz", |rate| rate > 0.0)?;
        let ([low, high], mut sections) = (profile.band_hz, [Section::PLAIN; 3]);
        sections[0] = Section::low_pass(profile.resonance_hz, profile.quality, rate_hz);
        if low > 0.0 {
            sections[1] = Section::high_pass(low, rate_hz);
        }
        if high < 0.5 * rate_hz {
            sections[2] = Section::low_pass(high, FRAC_1_SQRT_2, rate_hz);
        }
        Ok(Self { sections })
    }
}

impl SensorFilterState {
    /// Filters a block in place.
    pub fn run(&mut self, filter: &SensorFilter, block: &mut [f32]) {
        for x in block {
            let mut y = f64::from(*x);
            for (section, state) in filter.sections.iter().zip(&mut self.0) {
                y = section.tick(state, y);
            }
            *x = y as f32;
        }
        // A filter that rings out ends in zero and not in denormal numbers.
        for s in self.0.as_flattened_mut().iter_mut().filter(|s| s.abs() < 1e-30) {
            *s = 0.0;
        }
    }
}

/// Converter of a sensor: noise, clipping, gain, steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Converter {
    noise_m_s2: f64,
    clip_m_s2: f64,
    gain: f64,
    /// Height of a step, m/s²; 0 = none.
    step_m_s2: f64,
    rng: Rng,
}

impl Converter {
    /// For samples that leave at this rate; equal seeds, equal noise.
    #[must_use]
    pub fn new(profile: &SensorProfile, seed: u64, rate_hz: f64) -> Self {
        let steps = libm::exp2(f64::from(profile.adc_bits));
        let step_m_s2 = if profile.adc_bits == 0 { 0.0 } else { 2.0 * profile.clip_m_s2 / steps };
        Self {
            noise_m_s2: profile.noise_m_s2_rthz * libm::sqrt(0.5 * rate_hz),
            clip_m_s2: profile.clip_m_s2,
            gain: profile.gain_v_per_m_s2,
            step_m_s2,
            rng: Rng::new(seed),
        }
    }

    /// The volts of one reading, m/s².
    pub fn tick(&mut self, x: f32) -> f32 {
        let noise = if self.noise_m_s2 > 0.0 { self.noise_m_s2 * self.rng.normal() } else { 0.0 };
        let clipped = (f64::from(x) + noise).clamp(-self.clip_m_s2, self.clip_m_s2);
        let step = self.step_m_s2;
        // Two's complement: one step less above than below.
        let read = if step > 0.0 {
            (libm::round(clipped / step) * step).min(self.clip_m_s2 - step)
        } else {
            clipped
        };
        (read * self.gain) as f32
    }
}
