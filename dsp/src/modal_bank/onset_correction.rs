//! The first samples of a strike, which a bank behind an impulse ring leaves out.
//!
//! The ring spreads a pulse over four samples ([`crate::hertz`]), and the bank sounds two samples
//! late ([`super::GroupOptions::impulse_kernel_compensation`]). From four samples after the contact
//! on nothing is missing; before, part of the spread pulse is still to come, and a mode rises
//! through the kernel instead of beginning two samples after the contact:
//!
//! ```text
//! y(n) = Σₖ x(k) h'(n − k) + ∫ F(t) E(n − t₀ − t) dt        E(u) = h(u − 2) − Σⱼ β³(u − 2 − j) h'(j),   0 ≤ j ≤ u < 4
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | F, t₀ | the force and the onset of [`HertzPulse`] |
//! | x, β³ | what the pulse leaves in the ring, and the ring's cubic kernel |
//! | h, h' | response of all modes to an impulse, 0 before it, and of the compensated ones with their direct terms: the bank's |
//! | E | [`OnsetCorrection`]: a polynomial for each of its four samples, and its moments |
//!
//! Effect (`dsp/tests/strike_waveform.rs`): ten modes to 9.5 kHz at 44.1 kHz were 5 % (a 10
//! µs contact, rms over 50 ms) to 14 % (the same with a tenth of the ringing) from the response of
//! the equation, and are 0.03 %. What is left is the ring's: modes above 0.4 of the rate hear their
//! image of contacts shorter than a sample.

use super::design::{GroupOptions, Pole};
use crate::DesignError;
use crate::hertz::{CENTRED_SHAPE, HertzPulse, KERNEL_LATENCY, pulse_shape};
use crate::mode::Mode;
use core::f64::consts::PI;

/// Samples of which something is missing after each part of a pulse.
const REACH: usize = 2 * KERNEL_LATENCY;
/// Chebyshev coefficients a sample: exact to 1e-5 for a mode at the Nyquist frequency.
const TERMS: usize = 9;
/// Coefficients of the pulse's polynomial in x = 2 t/τ − 1.
const POWERS: usize = 11;

/// Places and weights of Gauss's rule on −1…1: exact to degree 11.
const GAUSS: [(f64, f64); 6] = [
    (-0.932_469_514_203_152, 0.171_324_492_379_170_3),
    (-0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (-0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_3),
];

/// E of some modes at the Chebyshev nodes of each sample; what [`OnsetCorrection`] are made from
/// where several places of a body share its modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnsetSamples([[f64; TERMS]; REACH]);

impl OnsetSamples {
    /// No mode.
    pub const NOTHING: Self = Self([[0.0; TERMS]; REACH]);

    /// One mode.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn of(mode: &Mode, sample_rate_hz: f64) -> Result<Self, DesignError> {
        Self::of_derivative(mode, 0, sample_rate_hz)
    }

    /// One mode of a bank that sounds as so many time derivatives ([`GroupOptions::derivative`]).
    /// The share that passes at once stays as wide as the ring's kernel.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn of_derivative(mode: &Mode, derivative: u8, sample_rate_hz: f64) -> Result<Self, DesignError> {
        let ring = GroupOptions { derivative, ..GroupOptions::IMPULSE_RING };
        let plain = GroupOptions { impulse_kernel_compensation: false, ..ring };
        let heard = Pole::new(mode, sample_rate_hz, &ring)?;
        let (Some(heard), Some(wanted)) = (heard, Pole::new(mode, sample_rate_hz, &plain)?) else {
            return Ok(Self::NOTHING);
        };
        let early: [f64; REACH] =
            core::array::from_fn(|j| heard.at(j as f64) + if j == 0 { heard.direct_correction } else { 0.0 });
        Ok(Self(core::array::from_fn(|first| {
            core::array::from_fn(|i| {
                let u = first as f64 + 0.5 + 0.5 * chebyshev_node(i);
                let latency = KERNEL_LATENCY as f64;
                let risen = (0..=first).map(|j| cubic_kernel(u - latency - j as f64) * early[j]);
                let begun = if u >= latency { wanted.at(u - latency) } else { 0.0 };
                begun - risen.sum::<f64>()
            })
        })))
    }

    /// Adds `share` of other modes.
    pub fn add(&mut self, other: &Self, share: f64) {
        for (sum, x) in self.0.as_flattened_mut().iter_mut().zip(other.0.as_flattened()) {
            *sum += share * x;
        }
    }

    /// The modes so far, ready to be added to strikes.
    #[must_use]
    pub fn first_samples(&self) -> OnsetCorrection {
        let mut all = OnsetCorrection {
            pieces: self.0.map(|piece| chebyshev_series(&piece)),
            ..OnsetCorrection::NOTHING
        };
        for k in 0..POWERS {
            all.moments[k] = all.moment(k as i32);
        }
        all
    }
}

/// Deficit of the response to an impulse of 1 N·s at one place of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnsetCorrection {
    /// E over each sample, in Chebyshev polynomials.
    pieces: [[f64; TERMS]; REACH],
    /// ∫ E(u) (u − 2)ᵏ du.
    moments: [f64; POWERS],
}

impl OnsetCorrection {
    /// Nothing is missing: a body without modes.
    pub const NOTHING: Self = Self { pieces: [[0.0; TERMS]; REACH], moments: [0.0; POWERS] };

    /// For a bank designed from these modes with [`GroupOptions::IMPULSE_RING`]; modes at or above
    /// Nyquist are silent.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn new(modes: impl IntoIterator<Item = Mode>, sample_rate_hz: f64) -> Result<Self, DesignError> {
        let mut all = OnsetSamples::NOTHING;
        for mode in modes {
            all.add(&OnsetSamples::of(&mode, sample_rate_hz)?, 1.0);
        }
        Ok(all.first_samples())
    }

    fn moment(&self, power: i32) -> f64 {
        let pieces = self.pieces.iter().enumerate();
        let part = |(first, piece): (usize, &[f64; TERMS])| -> f64 {
            let at = |(x, weight): &(f64, f64)| {
                let u = first as f64 + 0.5 + 0.5 * x - KERNEL_LATENCY as f64;
                0.5 * weight * series(piece, *x) * libm::pow(u, f64::from(power))
            };
            GAUSS.iter().map(at).sum()
        };
        pieces.map(part).sum()
    }

    /// Adds what is missing of a strike to `ring`, the outputs of the coming samples at index
    /// sample & (length − 1), for a pulse that [`HertzPulse::deposit`] lays into a ring as long
    /// with the same onset.
    pub fn deposit(
        &self,
        pulse: &HertzPulse,
        ring: &mut [f32],
        onset_sample: u64,
        onset_offset: f64,
        sample_rate_hz: f64,
    ) {
        for part in pulse.elastic_parts() {
            let Some(length) = part.samples_in(ring.len(), sample_rate_hz) else { continue };
            let peak = part.impulse_n_s / length;
            let mask = ring.len() - 1;
            let inside = self.inside(length);
            let mut at = onset_sample.wrapping_add(1);
            let mut v = 1.0 - onset_offset.clamp(0.0, 1.0);
            while v < length + REACH as f64 {
                let missing = if v >= REACH as f64 && v <= length {
                    let x = 2.0 * (v - KERNEL_LATENCY as f64) / length - 1.0;
                    inside.iter().rev().fold(0.0, |sum, c| sum * x + c)
                } else {
                    self.near_an_edge(v, length)
                };
                if let Some(y) = ring.get_mut(at as usize & mask) {
                    *y += (peak * missing) as f32;
                }
                at = at.wrapping_add(1);
                v += 1.0;
            }
        }
    }

    /// ∫ p((v − u)/length) E(u) du, piece by piece.
    fn near_an_edge(&self, v: f64, length: f64) -> f64 {
        let mut sum = 0.0;
        for (first, piece) in self.pieces.iter().enumerate() {
            let first = first as f64;
            let (from, to) = (first.max(v - length), (first + 1.0).min(v));
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            if half > 0.0 {
                for (x, weight) in GAUSS {
                    let u = middle + half * x;
                    sum += weight
                        * half
                        * pulse_shape((v - u) / length)
                        * series(piece, 2.0 * (u - first) - 1.0);
                }
            }
        }
        sum
    }

    /// Deficit where the pulse covers all of E: Σ (−2/length)ᵏ mₖ/k! p⁽ᵏ⁾, powers of x at two
    /// samples back.
    fn inside(&self, length: f64) -> [f64; POWERS] {
        let mut derivative: [f64; POWERS] =
            core::array::from_fn(|i| if i % 2 == 0 { CENTRED_SHAPE[i / 2] } else { 0.0 });
        let (mut sum, mut scale) = ([0.0; POWERS], 1.0);
        for (k, moment) in self.moments.iter().enumerate() {
            for (sum, c) in sum.iter_mut().zip(derivative) {
                *sum += scale * moment * c;
            }
            derivative = core::array::from_fn(|i| derivative.get(i + 1).map_or(0.0, |c| c * (i + 1) as f64));
            scale *= -2.0 / (length * (k + 1) as f64);
        }
        sum
    }
}

impl Pole {
    /// The response to an impulse, `samples` later.
    fn at(&self, samples: f64) -> f64 {
        let angle = self.theta * samples + self.phase_rad;
        self.amplitude * libm::exp(-self.decay * samples) * libm::sin(angle)
    }
}

fn chebyshev_node(i: usize) -> f64 {
    libm::cos(PI * (i as f64 + 0.5) / TERMS as f64)
}

/// Coefficients of the series through values at the nodes.
fn chebyshev_series(values: &[f64; TERMS]) -> [f64; TERMS] {
    core::array::from_fn(|k| {
        let cosine = |i: usize| libm::cos(PI * k as f64 * (i as f64 + 0.5) / TERMS as f64);
        let sum: f64 = values.iter().enumerate().map(|(i, e)| e * cosine(i)).sum();
        if k == 0 { sum / TERMS as f64 } else { 2.0 * sum / TERMS as f64 }
    })
}

/// Σ cₖ Tₖ(x) (Clenshaw).
fn series(c: &[f64; TERMS], x: f64) -> f64 {
    let (mut b1, mut b2) = (0.0, 0.0);
    for c in c[1..].iter().rev() {
        (b1, b2) = (c + 2.0 * x * b1 - b2, b1);
    }
    c[0] + x * b1 - b2
}

/// β³, 0 beyond ±2.
fn cubic_kernel(x: f64) -> f64 {
    let x = x.abs();
    if x < 1.0 {
        2.0 / 3.0 - x * x * (1.0 - 0.5 * x)
    } else if x < 2.0 {
        (2.0 - x) * (2.0 - x) * (2.0 - x) / 6.0
    } else {
        0.0
    }
}
