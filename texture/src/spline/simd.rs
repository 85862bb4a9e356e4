//! A block of samples, compiled for the vectors of this machine.
//!
//! Nothing here but `#[target_feature]`: the compiler vectorises the lanes. Fused multiply-adds are not
//! enabled, because they would change the bits.
#![allow(unsafe_code)]

use super::{Samples, Spline};

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn sample_block_avx2(spline: &Spline, position_m: &[[f64; 2]], out: &mut Samples) {
    spline.sample_block_in_lanes(position_m, out);
}

/// [`Spline::sample_block`] on the widest vectors at hand; the same bits on all.
pub fn sample_block(spline: &Spline, position_m: &[[f64; 2]], out: &mut Samples) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine has AVX2, all that the function asks for.
        return unsafe { sample_block_avx2(spline, position_m, out) };
    }
    spline.sample_block_in_lanes(position_m, out);
}
