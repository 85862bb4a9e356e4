//! The noise of up to N samples side by side.

use super::{
    FractalNoise, LONGEST_CELL_M, NoisePath, OCTAVES, ROTATION_RAD, ROTATIONS, finest_gain, fixed_point,
    footprint_weight, inverse_octave_ratio, tail_boost, within_0_1,
};
use crate::gradient_noise_2d::{Cells, gradient_noise};

/// N samples of a path in the form the octaves need.
struct Lanes<const N: usize> {
    /// Position in cells of the coarsest octave, by orientation and axis.
    cells: [[Cells<N>; 2]; ROTATIONS],
    samples_per_metre: [f32; N],
    finest_gain: [f32; N],
    coarser: [f32; N],
    boost: [f32; N],
    shortest_footprint_m: f32,
    longest_footprint_m: f32,
}

impl<const N: usize> Lanes<N> {
    #[inline(always)]
    fn new(
        noise: &FractalNoise,
        position: &[[f64; 2]; N],
        footprint: &[f64; N],
        roughness: &[f64; N],
    ) -> Self {
        let mut lanes = Self {
            cells: [[[0; N]; 2]; ROTATIONS],
            samples_per_metre: [0.0; N],
            finest_gain: [0.0; N],
            coarser: [0.0; N],
            boost: [0.0; N],
            shortest_footprint_m: 0.0,
            longest_footprint_m: 0.0,
        };
        let (mut x, mut y) = ([0.0; N], [0.0; N]);
        for n in 0..N {
            (x[n], y[n]) = (position[n][0], position[n][1]);
        }
        for (rotation, [u, v]) in lanes.cells.iter_mut().enumerate() {
            let [cosine, sine] = noise.rotations[rotation];
            for n in 0..N {
                u[n] = fixed_point(cosine * x[n] - sine * y[n]);
                v[n] = fixed_point(sine * x[n] + cosine * y[n]);
            }
        }
        let mut step = [0.0; N];
        for n in 0..N {
            step[n] = footprint[n] as f32;
            lanes.samples_per_metre[n] = 1.0 / (step[n] + f32::MIN_POSITIVE);
        }
        (lanes.shortest_footprint_m, lanes.longest_footprint_m) = range(step);
        let gains = lanes.finest_gain.iter_mut().zip(&mut lanes.coarser).zip(&mut lanes.boost);
        for (((finest, coarser), boost), &r) in gains.zip(roughness) {
            let r = within_0_1(r as f32);
            (*finest, *coarser, *boost) = (finest_gain(r), inverse_octave_ratio(r), tail_boost(r));
        }
        lanes
    }

    /// Sum of all octaves, from the finest to the coarsest.
    #[inline(always)]
    fn sum(&self, noise: &FractalNoise, band: &[f32; OCTAVES]) -> [f32; N] {
        let mut sum = [0.0; N];
        let mut gain = self.finest_gain;
        let mut finer = [0.0; N]; // footprint weight of the next finer octave
        let mut all_finer = false; // … is exactly 1 everywhere
        for (i, octave) in noise.octaves.iter().enumerate().rev() {
            let gone = octave.cell_m <= 2.0 * self.shortest_footprint_m;
            let whole = octave.cell_m >= 4.0 * self.longest_footprint_m;
            let mut weight = [1.0; N];
            if !whole {
                for (weight, samples) in weight.iter_mut().zip(&self.samples_per_metre) {
                    *weight = footprint_weight(octave.cell_m * samples);
                }
            }
            if !gone && band[i] != 0.0 {
                let [u, v] = &self.cells[i % ROTATIONS];
                let (mut x, mut y) = ([0; N], [0; N]);
                for n in 0..N {
                    x[n] = (u[n] << i).wrapping_add(octave.offset[0]);
                    y[n] = (v[n] << i).wrapping_add(octave.offset[1]);
                }
                let value = gradient_noise(&x, &y, octave.key);
                let mut scale = [band[i]; N];
                if !(whole && all_finer) {
                    for n in 0..N {
                        scale[n] *= weight[n] * (1.0 + self.boost[n] * (1.0 - finer[n]));
                    }
                }
                for n in 0..N {
                    sum[n] += gain[n] * scale[n] * value[n];
                }
            }
            for (gain, coarser) in gain.iter_mut().zip(self.coarser) {
                *gain *= coarser;
            }
            finer = weight;
            all_finer = whole;
        }
        sum
    }
}

/// Adds the noise along a path to `height_m`, N samples at a time.
#[inline(always)]
pub fn add<const N: usize>(
    noise: &FractalNoise,
    path: &NoisePath<'_>,
    roughness: &[f64],
    band: &[f32; OCTAVES],
    height_m: &mut [f64],
) {
    let (positions, positions_left) = path.position_m.as_chunks::<N>();
    let (footprints, footprints_left) = path.footprint_m.as_chunks::<N>();
    let (roughness, roughness_left) = roughness.as_chunks::<N>();
    let (heights, heights_left) = height_m.as_chunks_mut::<N>();
    let inputs = positions.iter().zip(footprints).zip(roughness);
    for (((position, footprint), roughness), height) in inputs.zip(heights) {
        let sum = Lanes::new(noise, position, footprint, roughness).sum(noise, band);
        for n in 0..N {
            height[n] += f64::from(sum[n]);
        }
    }
    if let Some(&first) = footprints_left.first() {
        // Lanes to spare repeat a footprint, so that they skip no octave.
        let position = padded(positions_left, [0.0; 2]);
        let lanes =
            Lanes::<N>::new(noise, &position, &padded(footprints_left, first), &padded(roughness_left, 0.0));
        for (height, sum) in heights_left.iter_mut().zip(lanes.sum(noise, band)) {
            *height += f64::from(sum);
        }
    }
}

/// Fewer than N values, and `fill` behind them.
fn padded<T: Copy, const N: usize>(values: &[T], fill: T) -> [T; N] {
    let mut out = [fill; N];
    for (out, value) in out.iter_mut().zip(values) {
        *out = *value;
    }
    out
}

/// Smallest and largest of N values, N a power of two.
#[inline(always)]
fn range<const N: usize>(values: [f32; N]) -> (f32, f32) {
    let (mut low, mut high) = (values, values);
    let mut half = N / 2;
    while half > 0 {
        for n in 0..half {
            low[n] = if low[n + half] < low[n] { low[n + half] } else { low[n] };
            high[n] = if high[n + half] > high[n] { high[n + half] } else { high[n] };
        }
        half /= 2;
    }
    (low[0], high[0])
}

/// Cosine and sine of each orientation, per metre in cells of the coarsest octave.
pub fn rotations() -> [[f64; 2]; ROTATIONS] {
    ROTATION_RAD.map(|angle| [libm::cos(angle) / LONGEST_CELL_M, libm::sin(angle) / LONGEST_CELL_M])
}
