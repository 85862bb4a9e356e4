//! The impulse ring: where pulses of any length and sampled forces become one impulse a sample.

use super::shape::{Smoothed, fourfold, fourfold_after};
use super::{HertzPulse, KERNEL_LATENCY};

/// Shorter contacts are computed with this many samples of contact time: their spectrum is flat to
/// 1e-6.
pub const SHORTEST_SAMPLES: f64 = 1e-3;

/// Samples a pulse occupies beyond its contact time.
pub const KERNEL_SAMPLES: usize = 5;

/// Impulses below this are read as zero, so that no denormal number enters a bank, N·s.
pub const SMALLEST_IMPULSE_N_S: f64 = 1e-25;

impl HertzPulse {
    /// Adds the pulse to `ring`, the impulses of the coming samples in N·s, at index sample &
    /// (length − 1); the length is a power of two, 16 or more. The contact begins `onset_offset`
    /// (0–1) of a step after the absolute sample `onset_sample`; sample k > `onset_sample` receives
    /// `J · (p ∗ β³)(k − 2 − onset)`, exact in area whatever the contact time.
    ///
    /// The last sample written is the pulse's length + 5 after the onset. A contact longer than the
    /// ring's length − 6 samples is shortened to it (the impulse is kept). A pulse that holds no
    /// finite number is ignored.
    pub fn deposit(&self, ring: &mut [f64], onset_sample: u64, onset_offset: f64, sample_rate_hz: f64) {
        for part in self.elastic_parts().filter(|_| onset_offset.is_finite()) {
            let Some(length) = part.samples_in(ring.len(), sample_rate_hz) else { continue };
            let mut write = Writer { ring: &mut *ring, at: onset_sample.wrapping_add(1) };
            // Distance from the onset to the first sample that receives something.
            let first = 1.0 - onset_offset.clamp(0.0, 1.0);
            if length < 4.0 {
                short(&mut write, part.impulse_n_s, length, first)
            } else {
                long(&mut write, part.impulse_n_s, length, first)
            }
        }
    }
}

impl HertzPulse {
    /// One past the last sample that the pulse reaches in a ring, if its contact begins in
    /// `onset_sample`.
    #[must_use]
    pub fn end_sample(&self, onset_sample: u64, sample_rate_hz: f64) -> u64 {
        // A saturating cast: an endless pulse is cut to the ring by the deposit itself.
        onset_sample + (self.length_s() * sample_rate_hz) as u64 + KERNEL_SAMPLES as u64 + 2
    }

    /// Contact time in samples as a ring of this length holds it; `None` for a pulse that holds no
    /// finite number, or a ring shorter than 16.
    pub(crate) fn samples_in(&self, ring: usize, sample_rate_hz: f64) -> Option<f64> {
        debug_assert!(ring.is_power_of_two() && ring >= 16);
        let length = self.contact_time_s * sample_rate_hz;
        let holds = self.impulse_n_s.is_finite() && length.is_finite() && ring >= 16;
        holds.then(|| length.clamp(SHORTEST_SAMPLES, (ring - KERNEL_SAMPLES - 1) as f64))
    }
}

/// Adds to consecutive samples.
struct Writer<'a> {
    ring: &'a mut [f64],
    at: u64,
}

impl Writer<'_> {
    #[inline]
    fn push(&mut self, value: f64) {
        let mask = self.ring.len() - 1;
        // An index under the mask always exists; `get_mut` keeps a wrong length from panicking.
        if let Some(x) = self.ring.get_mut(self.at as usize & mask) {
            *x += value;
        }
        self.at = self.at.wrapping_add(1);
    }
}

/// Fourth difference of the fourfold integral, for pulses shorter than the kernel.
fn short(write: &mut Writer<'_>, impulse: f64, length: f64, first: f64) {
    let step = 1.0 / length;
    let scale = impulse * length * length * length;
    let integral = |v: f64| {
        let u = v * step;
        if u >= 1.0 { fourfold_after(u) } else { fourfold(u) }
    };
    // Integrals at the last four samples; zero before the onset.
    let mut last = [0.0; 4];
    let mut v = first;
    while v < length + 4.0 {
        let now = integral(v);
        let difference = (now + last[3]) - 4.0 * (last[0] + last[2]) + 6.0 * last[1];
        write.push(scale * difference);
        last = [now, last[0], last[1], last[2]];
        v += 1.0;
    }
}

/// Pulses that hold the whole kernel: four samples at each end by differences, the inside by the
/// polynomial.
fn long(write: &mut Writer<'_>, impulse: f64, length: f64, first: f64) {
    let step = 1.0 / length;
    let (scale, inside) = (impulse * length * length * length, impulse * step);
    for x in edge(first, step) {
        write.push(scale * x);
    }
    let smoothed = Smoothed::new(step);
    let mut v = first + 4.0;
    while v < length {
        write.push(inside * smoothed.at((v - 2.0) * step));
        v += 1.0;
    }
    // Mirror image: distances to the end of the response, the smallest last.
    let [a, b, c, d] = edge(length + 1.0 - v, step);
    for x in [d, c, b, a] {
        write.push(scale * x);
    }
}

/// Fourth differences at v, v + 1, v + 2, v + 3 for v in 0..=1: before the onset the integral is
/// zero.
#[inline]
fn edge(v: f64, step: f64) -> [f64; 4] {
    let [a, b, c, d] = [0.0, 1.0, 2.0, 3.0].map(|i| fourfold((v + i) * step));
    [a, b - 4.0 * a, c - 4.0 * b + 6.0 * a, d - 4.0 * c + 6.0 * b - 4.0 * a]
}

/// Response that a mean force over one step still needs to have passed the kernel sinc⁴: sinc³ as a
/// symmetric filter of five taps about [`KERNEL_LATENCY`], equal to it up to θ⁴ (0.04 dB off at 10
/// kHz and 44.1 kHz, 0.07 dB at a quarter of any rate). The outer two taps undo the droop of the
/// mean itself.
pub const FORCE_TAPS: [f64; FORCE_HISTORY + 1] =
    [-7.0 / 1920.0, 67.0 / 480.0, 233.0 / 320.0, 67.0 / 480.0, -7.0 / 1920.0];

/// Samples of force that [`spread_force`] looks back.
pub const FORCE_HISTORY: usize = 2 * KERNEL_LATENCY;

/// Adds a sampled force to the ring: entry n of `impulses_n_s` is the mean force over a step × the
/// step, of the absolute sample `first_sample` + n, and reaches the ring through `FORCE_TAPS`, at
/// the same latency as a pulse, so one compensated bank serves both.
///
/// Cells are added to sample by sample, so any split into calls gives the same bits.
/// The block must be at least 4 samples shorter than the ring.
pub fn deposit_force(ring: &mut [f64], first_sample: u64, impulses_n_s: &[f64]) {
    debug_assert!(ring.len().is_power_of_two() && impulses_n_s.len() + FORCE_HISTORY <= ring.len());
    let mut first_tap = first_sample;
    for &impulse in impulses_n_s {
        let mut write = Writer { ring, at: first_tap };
        for weight in FORCE_TAPS {
            write.push(weight * impulse);
        }
        first_tap = first_tap.wrapping_add(1);
    }
}

/// Contents that [`deposit_force`] would leave in the ring, sample by sample: adds to `out[n]` the
/// force impulses up to it, `impulses_n_s[n + FORCE_HISTORY]` being those of `out[n]`'s own sample.
/// Lengths: as far as the shorter slice reaches.
pub fn spread_force(impulses_n_s: &[f64], out: &mut [f64]) {
    let [outer, inner, middle, ..] = FORCE_TAPS;
    for (y, window) in out.iter_mut().zip(impulses_n_s.windows(FORCE_HISTORY + 1)) {
        if let [a, b, c, d, e] = window {
            *y += (a + e) * outer + (b + d) * inner + c * middle;
        }
    }
}

/// Contents that [`spread_force`] adds to nothing.
pub fn spread_force_alone(impulses_n_s: &[f64], out: &mut [f64]) {
    let [outer, inner, middle, ..] = FORCE_TAPS;
    for (y, window) in out.iter_mut().zip(impulses_n_s.windows(FORCE_HISTORY + 1)) {
        if let [a, b, c, d, e] = window {
            *y = 0.0 + ((a + e) * outer + (b + d) * inner + c * middle);
        }
    }
}

/// Reads the impulses of `out.len()` samples from `first_sample` on and clears them for the ring's
/// next turn. What is below [`SMALLEST_IMPULSE_N_S`] or not finite is read as zero.
pub fn take(ring: &mut [f64], first_sample: u64, out: &mut [f32]) {
    debug_assert!(ring.len().is_power_of_two() && out.len() <= ring.len());
    let mask = ring.len().wrapping_sub(1);
    for (n, y) in out.iter_mut().enumerate() {
        let x =
            ring.get_mut(first_sample.wrapping_add(n as u64) as usize & mask).map_or(0.0, core::mem::take);
        *y = if x.abs() >= SMALLEST_IMPULSE_N_S && x.abs() < 1e30 { x as f32 } else { 0.0 };
    }
}
