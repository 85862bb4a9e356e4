//! The noise of up to N samples side by side.

use super::{
    FractalNoise, LONGEST_CELL_M, NoisePath, OCTAVES, ROTATION_RAD, ROTATIONS, finest_gain, fixed_point,
    footprint_weight, inverse_octave_ratio, tail_boost,
};
use crate::gradient_noise_2d::{Cells, gradient_noise_lanes};

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
    /// Up to N samples; lanes beyond them repeat the origin and are thrown away.
    #[inline(always)]
    fn gather(noise: &FractalNoise, path: &NoisePath<'_>, roughness: &[f64]) -> Self {
        let (mut x, mut y, mut footprint, mut r) = ([0.0; N], [0.0; N], [0.0; N], [0.0; N]);
        for (n, position) in path.position_m.iter().enumerate().take(N) {
            x[n] = position[0];
            y[n] = position[1];
        }
        for (n, &value) in path.footprint_m.iter().enumerate().take(N) {
            footprint[n] = value as f32;
        }
        for (n, &value) in roughness.iter().enumerate().take(N) {
            r[n] = if value < 1.0 { if value > 0.0 { value as f32 } else { 0.0 } } else { 1.0 };
        }
        let mut lanes = Self {
            cells: [[[0; N]; 2]; ROTATIONS],
            samples_per_metre: [0.0; N],
            finest_gain: [0.0; N],
            coarser: [0.0; N],
            boost: [0.0; N],
            shortest_footprint_m: f32::MAX,
            longest_footprint_m: 0.0,
        };
        for (rotation, [u, v]) in lanes.cells.iter_mut().enumerate() {
            let [cosine, sine] = noise.rotations[rotation];
            for n in 0..N {
                u[n] = fixed_point(cosine * x[n] - sine * y[n]);
                v[n] = fixed_point(sine * x[n] + cosine * y[n]);
            }
        }
        for n in 0..N {
            lanes.finest_gain[n] = finest_gain(r[n]);
            lanes.coarser[n] = inverse_octave_ratio(r[n]);
            lanes.boost[n] = tail_boost(r[n]);
            lanes.samples_per_metre[n] = 1.0 / (footprint[n] + f32::MIN_POSITIVE);
        }
        for &value in footprint.iter().take(path.position_m.len()) {
            lanes.longest_footprint_m =
                if value > lanes.longest_footprint_m { value } else { lanes.longest_footprint_m };
            lanes.shortest_footprint_m =
                if value < lanes.shortest_footprint_m { value } else { lanes.shortest_footprint_m };
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
                for n in 0..N {
                    weight[n] = footprint_weight(octave.cell_m * self.samples_per_metre[n]);
                }
            }
            if !gone && band[i] != 0.0 {
                let [u, v] = &self.cells[i % ROTATIONS];
                let (mut x, mut y) = ([0; N], [0; N]);
                for n in 0..N {
                    x[n] = (u[n] << i).wrapping_add(octave.offset[0]);
                    y[n] = (v[n] << i).wrapping_add(octave.offset[1]);
                }
                let value = gradient_noise_lanes(&x, &y, octave.key);
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
            for n in 0..N {
                gain[n] *= self.coarser[n];
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
    let positions = path.position_m.chunks(N);
    let footprints = path.footprint_m.chunks(N);
    let inputs = positions.zip(footprints).zip(roughness.chunks(N));
    for (((position_m, footprint_m), roughness), height_m) in inputs.zip(height_m.chunks_mut(N)) {
        let path = NoisePath { position_m, footprint_m };
        let sum = Lanes::<N>::gather(noise, &path, roughness).sum(noise, band);
        for (height, sum) in height_m.iter_mut().zip(sum) {
            *height += f64::from(sum);
        }
    }
}

/// Cosine and sine of each orientation, per metre in cells of the coarsest octave.
pub fn rotations() -> [[f64; 2]; ROTATIONS] {
    ROTATION_RAD.map(|angle| [libm::cos(angle) / LONGEST_CELL_M, libm::sin(angle) / LONGEST_CELL_M])
}
