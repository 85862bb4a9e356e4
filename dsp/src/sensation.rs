//! Sensation of vibration: displacement weighted by how little of it a fingertip detects.
//!
//! ```text
//!            (s + ω₀)²             g ω₂²                ω₃²
//! W(s) = ───────────────── · ───────────────── · ─────────────────
//!        s² + ω₁s/Q₁ + ω₁²   s² + ω₂s/Q₂ + ω₂²   s² + ω₃s/Q₃ + ω₃²
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | \|W\| | [`Sensation::gain`] | 1 near 250 Hz, where a fingertip feels best; 1/100 is 40 dB less sensitive |
//! | ω₀ … ω₃ | [`ZERO_HZ`], [`SECTIONS`] | fitted by us |
//!
//! Source: [`THRESHOLD_DB`], its inverse fitted from 12 to 800 Hz by least squares: 0.9 dB at
//! worst. The three sections are trapezoidal state-variable filters in `f64`, so a slow path under
//! a fast vibration costs no accuracy.

use crate::DesignError;
use core::f64::consts::PI;

/// Detection threshold of a fingertip, (Hz, dB re 1 µm rms): Bolanowski, Gescheider, Verrillo and
/// Checkosky 1988 (thenar, 2.9 cm²; peak values less 3 dB). **Recalled**, to about 3 dB.
pub const THRESHOLD_DB: [(f64, f64); 11] = [
    (10.0, 13.0),
    (16.0, 10.0),
    (25.0, 7.0),
    (40.0, 2.0),
    (63.0, -6.0),
    (100.0, -15.0),
    (160.0, -21.0),
    (250.0, -24.0),
    (400.0, -17.0),
    (630.0, -4.0),
    (1000.0, 14.0),
];

/// The double zero below which the threshold hardly changes any more, Hz.
pub const ZERO_HZ: f64 = 23.073;
/// Frequency, Hz, and quality of each section.
pub const SECTIONS: [[f64; 2]; 3] = [[131.182, 1.03358], [268.693, 1.63606], [539.192, 1.39978]];
/// g: makes the greatest gain about 1.
const GAIN: f64 = 0.406_369;

/// The design at one rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensation {
    sections: [Section; 3],
    /// ω₀/ω₁.
    zero: f64,
}

/// Memory of one signal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SensationState([SectionState; 3]);

/// A resonant section of second order: its low-pass, band-pass and high-pass from one state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Section {
    damping: f64,
    a1: f64,
    a2: f64,
    a3: f64,
}

/// Memory of a section.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct SectionState {
    band: f64,
    low: f64,
}

/// Output of a section for one sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SectionOutput {
    pub(crate) low: f64,
    /// 1 at the section's frequency when multiplied by 1/Q; the derivative of `low` over ω.
    pub(crate) band: f64,
    pub(crate) high: f64,
}

impl Section {
    /// With its frequency kept exactly where it is said to be.
    pub(crate) fn new(frequency_hz: f64, quality: f64, sample_rate_hz: f64) -> Self {
        let g = libm::tan(PI * frequency_hz / sample_rate_hz);
        let damping = 1.0 / quality;
        let a1 = 1.0 / (1.0 + g * (g + damping));
        Self { damping, a1, a2: g * a1, a3: g * g * a1 }
    }
}

impl SectionState {
    #[inline]
    pub(crate) fn tick(&mut self, section: &Section, x: f64) -> SectionOutput {
        let rest = x - self.low;
        let band = section.a1 * self.band + section.a2 * rest;
        let low = self.low + section.a2 * self.band + section.a3 * rest;
        self.band = 2.0 * band - self.band;
        self.low = 2.0 * low - self.low;
        SectionOutput { low, band, high: x - section.damping * band - low }
    }
}

impl Sensation {
    /// At `sample_rate_hz`, from 1.5 kHz on: below, the highest section would lie beyond what is
    /// sampled.
    ///
    /// # Errors
    /// When the rate is refused.
    pub fn new(sample_rate_hz: f64) -> Result<Self, DesignError> {
        let rate_hz = DesignError::check("sample_rate_hz", sample_rate_hz, "from 1500 Hz to 1 MHz", |r| {
            (1500.0..=1e6).contains(&r)
        })?;
        let sections = SECTIONS.map(|[frequency_hz, quality]| Section::new(frequency_hz, quality, rate_hz));
        Ok(Self { sections, zero: ZERO_HZ / SECTIONS[0][0] })
    }

    /// |W| at a frequency: the closed form.
    #[must_use]
    pub fn gain(frequency_hz: f64) -> f64 {
        let square = frequency_hz * frequency_hz;
        let pole = |[f0, q]: [f64; 2]| {
            let (real, imaginary) = (f0 * f0 - square, frequency_hz * f0 / q);
            libm::sqrt(real * real + imaginary * imaginary)
        };
        let [first, second, third] = SECTIONS;
        let zeros = square + ZERO_HZ * ZERO_HZ;
        let level = |[f0, _]: [f64; 2]| f0 * f0;
        GAIN * zeros / pole(first) * level(second) / pole(second) * level(third) / pole(third)
    }
}

impl SensationState {
    /// One sample of displacement → the same, weighted.
    #[inline]
    pub fn tick(&mut self, design: &Sensation, x: f64) -> f64 {
        let [first, second, third] = &mut self.0;
        let out = first.tick(&design.sections[0], x);
        let zeros = out.high + design.zero * (2.0 * out.band + design.zero * out.low);
        let peaked = second.tick(&design.sections[1], zeros).low;
        GAIN * third.tick(&design.sections[2], peaked).low
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use core::f64::consts::TAU;

    /// Root mean square of what a sine of peak 1 becomes.
    fn through(frequency_hz: f64, rate_hz: f64) -> f64 {
        let design = Sensation::new(rate_hz).unwrap();
        let mut state = SensationState::default();
        let mut energy = 0.0;
        let count = (2.0 * rate_hz) as usize;
        for n in 0..2 * count {
            let y = state.tick(&design, libm::sin(TAU * frequency_hz * n as f64 / rate_hz));
            if n >= count {
                energy += y * y;
            }
        }
        libm::sqrt(energy / count as f64)
    }

    #[test]
    fn a_sine_is_weighted_as_the_closed_form_says_at_any_rate() {
        for rate_hz in [8e3, 44_100.0, 192e3] {
            for frequency_hz in [20.0, 55.0, 100.0, 160.0, 250.0, 400.0] {
                let want = Sensation::gain(frequency_hz) * core::f64::consts::FRAC_1_SQRT_2;
                let got = through(frequency_hz, rate_hz);
                // The trapezoidal rule bends what lies between its fixed points: 2 % at 400 Hz of 8
                // kHz.
                assert!((got / want - 1.0).abs() < 0.04, "{rate_hz} {frequency_hz}: {got} for {want}");
            }
        }
    }

    #[test]
    fn a_sum_is_weighted_as_its_parts_are() {
        let design = Sensation::new(44_100.0).unwrap();
        let mut rng = Rng::new(5);
        let [mut a, mut b, mut both] = [SensationState::default(); 3];
        for _ in 0..20_000 {
            let (x, y) = (rng.normal(), rng.normal());
            let sum = a.tick(&design, x) + b.tick(&design, y);
            assert!((both.tick(&design, x + y) - sum).abs() < 1e-9);
        }
    }

    #[test]
    fn it_is_the_inverse_of_the_published_threshold_to_a_decibel() {
        // The weight is 0 dB where the threshold is least, at −24 dB.
        for (frequency_hz, db) in THRESHOLD_DB.into_iter().filter(|(hz, _)| (12.0..800.0).contains(hz)) {
            let ours = 20.0 * libm::log10(Sensation::gain(frequency_hz));
            assert!((ours + db + 24.0).abs() < 1.0, "{frequency_hz} Hz: {ours}");
        }
    }

    #[test]
    fn a_rate_that_cannot_hold_it_is_refused() {
        assert_eq!(Sensation::new(1000.0).unwrap_err().field, "sample_rate_hz");
        assert!(Sensation::new(f64::NAN).is_err());
    }
}
