//! The same lanes compiled for several instruction sets, and which of them this machine has.
//!
//! Fused multiply-adds are not used, because they would change the bits.
#![allow(unsafe_code)]

use super::{FractalNoise, Kernel, NoisePath, OctaveWeights, lanes};
use crate::vector::Portable;
#[cfg(target_arch = "x86_64")]
use crate::vector::{Avx2, Avx512};

/// Whether this machine can run a kernel.
pub fn is_available(kernel: Kernel) -> bool {
    match kernel {
        Kernel::Portable => true,
        #[cfg(all(feature = "std", target_arch = "x86_64"))]
        Kernel::Avx2 => std::arch::is_x86_feature_detected!("avx2"),
        #[cfg(all(feature = "std", target_arch = "x86_64"))]
        Kernel::Avx512 => {
            std::arch::is_x86_feature_detected!("avx512f")
                && std::arch::is_x86_feature_detected!("avx512dq")
                && std::arch::is_x86_feature_detected!("avx512bw")
                && std::arch::is_x86_feature_detected!("avx512vl")
        }
        #[cfg(not(all(feature = "std", target_arch = "x86_64")))]
        Kernel::Avx2 | Kernel::Avx512 => false,
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_avx2(
    noise: &FractalNoise,
    path: &NoisePath<'_>,
    roughness: &[f64],
    weights: &OctaveWeights,
    height_m: &mut [f64],
) {
    // SAFETY: this function is called only where the processor has the instruction set.
    lanes::add(unsafe { Avx2::new() }, noise, path, roughness, weights, height_m);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl")]
fn add_avx512(
    noise: &FractalNoise,
    path: &NoisePath<'_>,
    roughness: &[f64],
    weights: &OctaveWeights,
    height_m: &mut [f64],
) {
    // SAFETY: as above.
    lanes::add(unsafe { Avx512::new() }, noise, path, roughness, weights, height_m);
}

/// Adds the noise on the field's instruction set.
pub fn add(
    noise: &FractalNoise,
    path: &NoisePath<'_>,
    roughness: &[f64],
    weights: &OctaveWeights,
    height_m: &mut [f64],
) {
    match noise.kernel {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `FractalNoise::with_kernel` stores a kernel only if `is_available` found its features.
        Kernel::Avx512 => unsafe { add_avx512(noise, path, roughness, weights, height_m) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Kernel::Avx2 => unsafe { add_avx2(noise, path, roughness, weights, height_m) },
        _ => lanes::add::<8, _>(Portable, noise, path, roughness, weights, height_m),
    }
}
