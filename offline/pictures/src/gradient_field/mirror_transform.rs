//! Fourier transforms of rectangles that go on mirrored, to twice their size without the work of
//! four times as many numbers.
//!
//! ```text
//! C(k) = ½ e^(−iπk/period) Σ_j e(j) e^(−2πi jk/period)        e = the row and its mirror image, period long
//! ```
//! is Σ x(j) cos(2πk(j + ½)/period) for a row mirrored half a texel beyond its ends; mirrored at a
//! texel, the half and the phase of half a texel fall away; mirrored with its sign turned, sines
//! take the cosines' place. Two rows travel through one complex transform.

use asperity_fft::num_complex::Complex64;
use asperity_fft::{Fft, FftPlanner};
use asperity_surface::raster::Raster;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Continuation of a row beyond its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mirror {
    /// Mirrored half a texel beyond the last one.
    EvenBetween,
    /// Mirrored with the sign turned.
    OddBetween,
    /// Mirrored at the last texel.
    EvenAt,
    /// Mirrored with the sign turned one texel beyond the last one, where it is 0.
    OddAt,
}

impl Mirror {
    fn period(self, texels: usize) -> usize {
        match self {
            Self::EvenBetween | Self::OddBetween => 2 * texels,
            Self::EvenAt => 2 * texels - 2,
            Self::OddAt => 2 * texels + 2,
        }
    }

    fn between(self) -> bool {
        matches!(self, Self::EvenBetween | Self::OddBetween)
    }

    fn odd(self) -> bool {
        matches!(self, Self::OddBetween | Self::OddAt)
    }
}

/// Number of waves of rows of a period: 0 … period/2 in a period.
fn waves(period: usize) -> usize {
    period / 2 + 1
}

/// Transforms of the rows of one length and mirror.
struct Rows {
    mirror: Mirror,
    texels: usize,
    period: usize,
    plan: Arc<dyn Fft<f64>>,
    back: Arc<dyn Fft<f64>>,
    /// ½ e^(−iπk/period), or i times that for sines.
    phase: Vec<Complex64>,
    buffer: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl Rows {
    fn new(planner: &mut FftPlanner, mirror: Mirror, texels: usize) -> Self {
        let period = mirror.period(texels);
        let (plan, back) = (planner.plan_fft_forward(period), planner.plan_fft_inverse(period));
        let turn = if mirror.between() { -PI / period as f64 } else { 0.0 };
        let kind = if mirror.odd() { Complex64::new(0.0, 0.5) } else { Complex64::new(0.5, 0.0) };
        let phase = (0..waves(period)).map(|k| kind * Complex64::cis(turn * k as f64)).collect();
        let needed = plan.get_inplace_scratch_len().max(back.get_inplace_scratch_len());
        let (buffer, scratch) = (vec![Complex64::default(); period], vec![Complex64::default(); needed]);
        Self { mirror, texels, period, plan, back, phase, buffer, scratch }
    }

    /// Calls `take` with k and C(k) of two rows.
    fn forward(&mut self, rows: [&[f64]; 2], mut take: impl FnMut(usize, [f64; 2])) {
        let sign = if self.mirror.odd() { -1.0 } else { 1.0 };
        self.buffer.fill(Complex64::default());
        let first = usize::from(self.mirror == Mirror::OddAt);
        let last = self.period + first - usize::from(self.mirror.between());
        for (j, (a, b)) in rows[0].iter().zip(rows[1]).enumerate() {
            let value = Complex64::new(*a, *b);
            self.buffer[j + first] = value;
            // A mirrored texel on a mirror is itself.
            let mirrored = match self.mirror {
                Mirror::OddAt => self.period - first - j,
                _ => (last - j) % self.period,
            };
            if mirrored != j + first {
                self.buffer[mirrored] = value * sign;
            }
        }
        self.plan.process_with_scratch(&mut self.buffer, &mut self.scratch);
        for (k, phase) in self.phase.iter().enumerate() {
            let value = self.buffer[k] * phase;
            take(k, [value.re, value.im]);
        }
    }

    /// The rows that have these C(k), of an even mirror.
    fn inverse(&mut self, waves: [&[f64]; 2], mut take: impl FnMut(usize, [f64; 2])) {
        let scale = 4.0 / self.period as f64;
        self.buffer.fill(Complex64::default());
        for (k, (a, b)) in waves[0].iter().zip(waves[1]).enumerate() {
            let value = Complex64::new(*a, *b) * scale;
            // phase is half of what turns back.
            self.buffer[k] = value * self.phase[k].conj();
            if k > 0 && 2 * k < self.period {
                self.buffer[self.period - k] = value * self.phase[k];
            }
        }
        self.back.process_with_scratch(&mut self.buffer, &mut self.scratch);
        for (j, value) in self.buffer[..self.texels].iter().enumerate() {
            take(j, [value.re, value.im]);
        }
    }
}

/// Waves 0 … of a mirrored rectangle, column by column.
#[derive(Debug, Clone)]
pub(super) struct Waves {
    pub along_u: usize,
    pub along_v: usize,
    pub values: Vec<f64>,
}

/// Transforms of rectangles that go on mirrored.
#[derive(Default)]
pub(super) struct MirrorTransform {
    planner: FftPlanner,
}

impl MirrorTransform {
    /// Σ Σ raster · (cosines or sines along u) · (cosines or sines along v).
    pub fn forward(&mut self, raster: &Raster, [across, down]: [Mirror; 2]) -> Waves {
        let (w, h) = (raster.width, raster.height);
        let mut rows = Rows::new(&mut self.planner, across, w);
        let mut columns = Rows::new(&mut self.planner, down, h);
        let (along_u, along_v) = (waves(rows.period), waves(columns.period));
        let mut between = vec![0.0; along_u * h];
        let nothing = vec![0.0; w];
        for y in (0..h).step_by(2) {
            let second = if y + 1 < h { raster.row(y + 1) } else { &nothing };
            rows.forward([raster.row(y), second], |k, [a, b]| {
                between[k * h + y] = a;
                if y + 1 < h {
                    between[k * h + y + 1] = b;
                }
            });
        }
        let mut values = vec![0.0; along_u * along_v];
        let nothing = vec![0.0; h];
        for kx in (0..along_u).step_by(2) {
            let second = if kx + 1 < along_u { &between[(kx + 1) * h..][..h] } else { &nothing };
            columns.forward([&between[kx * h..][..h], second], |ky, [a, b]| {
                values[kx * along_v + ky] = a;
                if kx + 1 < along_u {
                    values[(kx + 1) * along_v + ky] = b;
                }
            });
        }
        Waves { along_u, along_v, values }
    }

    /// The rectangle of `width` × `height` that has these waves, mirrored evenly both ways.
    pub fn inverse(&mut self, waves: &Waves, width: usize, height: usize, mirror: Mirror) -> Raster {
        let mut rows = Rows::new(&mut self.planner, mirror, width);
        let mut columns = Rows::new(&mut self.planner, mirror, height);
        let mut between = vec![0.0; height * waves.along_u];
        let column = |kx: usize| &waves.values[kx * waves.along_v..][..waves.along_v];
        let nothing = vec![0.0; waves.along_v];
        for kx in (0..waves.along_u).step_by(2) {
            let second = if kx + 1 < waves.along_u { column(kx + 1) } else { &nothing };
            columns.inverse([column(kx), second], |y, [a, b]| {
                between[y * waves.along_u + kx] = a;
                if kx + 1 < waves.along_u {
                    between[y * waves.along_u + kx + 1] = b;
                }
            });
        }
        let mut raster = Raster::constant(width, height, 0.0);
        let row = |y: usize| &between[y * waves.along_u..][..waves.along_u];
        let nothing = vec![0.0; waves.along_u];
        for y in (0..height).step_by(2) {
            let second = if y + 1 < height { row(y + 1) } else { &nothing };
            rows.inverse([row(y), second], |x, [a, b]| {
                raster.values[y * width + x] = a;
                if y + 1 < height {
                    raster.values[(y + 1) * width + x] = b;
                }
            });
        }
        raster
    }
}

/// Frequencies of the waves 0 … of `count`, up to half a wave a texel, radians per texel.
pub(super) fn frequencies(count: usize) -> Vec<f64> {
    let period = 2.0 * (count.max(2) - 1) as f64;
    (0..count).map(|k| TAU * k as f64 / period).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    fn noise(width: usize, height: usize) -> Raster {
        let mut rng = Rng::new(7);
        Raster::from_fn(width, height, |_, _| rng.normal())
    }

    #[test]
    fn waves_are_the_sums_that_define_them() {
        let raster = noise(7, 6);
        let wave = |mirror: Mirror, k: usize, j: usize, n: usize| {
            let turns = |place: f64| k as f64 * place / mirror.period(n) as f64 * TAU;
            match mirror {
                Mirror::EvenBetween => turns(j as f64 + 0.5).cos(),
                Mirror::OddBetween => turns(j as f64 + 0.5).sin(),
                Mirror::EvenAt => turns(j as f64).cos() * if j == 0 || j == n - 1 { 0.5 } else { 1.0 },
                Mirror::OddAt => turns(j as f64 + 1.0).sin(),
            }
        };
        let all = [Mirror::EvenBetween, Mirror::OddBetween, Mirror::EvenAt, Mirror::OddAt];
        for (across, down) in all.into_iter().flat_map(|a| all.map(|b| (a, b))) {
            let waves = MirrorTransform::default().forward(&raster, [across, down]);
            for (place, value) in waves.values.iter().enumerate() {
                let (kx, ky) = (place / waves.along_v, place % waves.along_v);
                let mut sum = 0.0;
                for y in 0..6 {
                    for x in 0..7 {
                        sum += raster.at(x, y) * wave(across, kx, x, 7) * wave(down, ky, y, 6);
                    }
                }
                assert!((sum - value).abs() < 1e-12, "{across:?} {down:?} {kx} {ky}: {sum} {value}");
            }
        }
    }

    #[test]
    fn there_and_back_again_is_the_rectangle() {
        for (width, height) in [(8, 8), (13, 9), (6, 17)] {
            for mirror in [Mirror::EvenBetween, Mirror::EvenAt] {
                let raster = noise(width, height);
                let mut transform = MirrorTransform::default();
                let waves = transform.forward(&raster, [mirror; 2]);
                let back = transform.inverse(&waves, width, height, mirror);
                for (a, b) in back.values.iter().zip(&raster.values) {
                    assert!((a - b).abs() < 1e-12, "{mirror:?} {width} × {height}");
                }
            }
        }
    }
}
