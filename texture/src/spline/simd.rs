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
