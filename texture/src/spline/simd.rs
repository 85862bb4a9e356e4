//! A block of samples, compiled for the vectors of this machine.
//!
//! Fused multiply-adds are not enabled, because they would change the bits.
#![allow(unsafe_code)]

use super::vector::Portable;
#[cfg(target_arch = "x86_64")]
use super::vector::{Avx2, Avx512};
use super::{Places, Samples, Spline};

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn sample_block_avx512<const SLOPES: bool>(
    spline: &Spline,
    position_m: &[[f64; 2]],
    places: &mut Places,
    out: &mut Samples,
) {
    // SAFETY: this function is called only where the processor has the instruction set.
    let (v, rows) = unsafe { (Avx512::new(), Avx2::new()) };
    spline.sample_block_in_lanes::<8, _, _, SLOPES>(v, rows, position_m, places, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn sample_block_avx2<const SLOPES: bool>(
    spline: &Spline,
    position_m: &[[f64; 2]],
    places: &mut Places,
    out: &mut Samples,
) {
    // SAFETY: as above.
    let v = unsafe { Avx2::new() };
    spline.sample_block_in_lanes::<4, _, _, SLOPES>(v, v, position_m, places, out);
}

/// Values, and slopes if `SLOPES`, on the widest vectors at hand; the same bits on all.
pub fn sample_block<const SLOPES: bool>(
    spline: &Spline,
    position_m: &[[f64; 2]],
    places: &mut Places,
    out: &mut Samples,
) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx512f") {
        // SAFETY: the machine has AVX-512F, all that the function asks for.
        return unsafe { sample_block_avx512::<SLOPES>(spline, position_m, places, out) };
    } else if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine has AVX2, all that the function asks for.
        return unsafe { sample_block_avx2::<SLOPES>(spline, position_m, places, out) };
    }
    spline.sample_block_in_lanes::<4, _, _, SLOPES>(Portable, Portable, position_m, places, out);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::Raster;
    use crate::wrap::Wrap;
    use asperity_dsp::rng::Rng;

    type Kernel = (&'static str, fn(&Spline, &[[f64; 2]], &mut Places, &mut Samples));

    /// Every kernel that this machine can run.
    fn kernels() -> Vec<Kernel> {
        let portable: Kernel = ("portable", |spline, position_m, places, out| {
            spline.sample_block_in_lanes::<4, _, _, true>(Portable, Portable, position_m, places, out);
        });
        let mut kernels = vec![portable];
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            kernels.push(("AVX2", |spline, position_m, places, out| {
                // SAFETY: just detected.
                unsafe { sample_block_avx2::<true>(spline, position_m, places, out) }
            }));
        }
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx512f") {
            kernels.push(("AVX-512", |spline, position_m, places, out| {
                // SAFETY: just detected.
                unsafe { sample_block_avx512::<true>(spline, position_m, places, out) }
            }));
        }
        kernels
    }

    /// Value and slopes at one position, in plain arithmetic.
    fn alone(spline: &Spline, position_m: [f64; 2]) -> (f64, [f64; 2]) {
        let (x, y) = (spline.axes[0].place(position_m[0]), spline.axes[1].place(position_m[1]));
        let p = spline.cell(Portable, x.texel, y.texel).powers;
        let t = x.fraction;
        // The four powers of y side by side.
        let (mut level, mut rise) = ([0.0; 4], [0.0; 4]);
        for j in 0..4 {
            level[j] = ((p[3][j] * t + p[2][j]) * t + p[1][j]) * t + p[0][j];
            rise[j] = (3.0 * p[3][j] * t + 2.0 * p[2][j]) * t + p[1][j];
        }
        let t = y.fraction;
        let along_u = ((rise[3] * t + rise[2]) * t + rise[1]) * t + rise[0];
        let along_v = (3.0 * level[3] * t + 2.0 * level[2]) * t + level[1];
        let value = ((level[3] * t + level[2]) * t + level[1]) * t + level[0];
        (value, [along_u * x.slope, along_v * y.slope])
    }

    #[test]
    fn blocks_on_every_instruction_set_give_the_bits_of_single_samples() {
        let mut rng = Rng::new(5);
        let raster = Raster::from_fn(19, 23, |_, _| rng.uniform());
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            let spline = Spline::new(&raster, [0.19, 0.23], wrap);
            for (name, kernel) in kernels() {
                // From many samples a texel to several texels a sample, blocks of every length.
                for len in 1..=64 {
                    let step = [1e-4, 1e-3, 0.03][len % 3];
                    let start = [rng.uniform() - 0.5, rng.uniform() - 0.5];
                    let position_m: Vec<_> = (0..len)
                        .map(|n| [start[0] + step * n as f64, start[1] - 0.7 * step * n as f64])
                        .collect();
                    let (mut places, mut out) = (Places::new(), Samples::EMPTY);
                    kernel(&spline, &position_m, &mut places, &mut out);
                    for (n, position_m) in position_m.iter().enumerate() {
                        let block = (out.value[n], [out.slope_u[n], out.slope_v[n]]);
                        assert_eq!(block, alone(&spline, *position_m), "{name}, {wrap:?}, {position_m:?}");
                    }
                }
            }
        }
    }
}
