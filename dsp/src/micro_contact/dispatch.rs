//! Chooses the widest vectors of the machine for the same arithmetic.
//!
//! The kernels are plain Rust on small arrays, compiled once more with wider vectors; nothing is
//! fused or reordered, so that every path gives the same bits.
#![allow(unsafe_code)]

use super::{ContactSample, ContactState, EulerLanes, LANES, LaneRow, Lanes, MicroContact};

/// Runs the design's kernel on the widest vectors.
#[inline]
pub(super) fn run(
    design: &MicroContact,
    state: &mut ContactState,
    height_m: &[f64],
    force_n: &[f64],
    out: &mut [ContactSample],
) {
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine has AVX2, the only thing the function asks for.
        return unsafe { run_avx2(design, state, height_m, force_n, out) };
    }
    run_portable(design, state, height_m, force_n, out);
}

/// The same on whatever vectors the crate was compiled for.
pub(super) fn run_portable(
    design: &MicroContact,
    state: &mut ContactState,
    height_m: &[f64],
    force_n: &[f64],
    out: &mut [ContactSample],
) {
    design.run_blocks(state, height_m, force_n, out);
}

#[cfg(all(target_arch = "x86_64", feature = "std"))]
#[target_feature(enable = "avx2")]
fn run_avx2(
    design: &MicroContact,
    state: &mut ContactState,
    height_m: &[f64],
    force_n: &[f64],
    out: &mut [ContactSample],
) {
    design.run_blocks(state, height_m, force_n, out);
}

/// Eight contacts on the widest vectors.
#[inline]
pub(super) fn run_lanes(
    lanes: &EulerLanes<'_>,
    states: &mut [ContactState; LANES],
    height_m: &[Lanes],
    force_n: &[Lanes],
    out: &mut [LaneRow],
) {
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    {
        if std::arch::is_x86_feature_detected!("avx512f") {
            // SAFETY: the machine has AVX-512F, the only thing the function asks for.
            return unsafe { lanes_avx512(lanes, states, height_m, force_n, out) };
        }
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the machine has AVX2, the only thing the function asks for.
            return unsafe { lanes_avx2(lanes, states, height_m, force_n, out) };
        }
    }
    lanes.run_blocks(states, height_m, force_n, out);
}

#[cfg(all(target_arch = "x86_64", feature = "std"))]
#[target_feature(enable = "avx512f")]
fn lanes_avx512(
    lanes: &EulerLanes<'_>,
    states: &mut [ContactState; LANES],
    height_m: &[Lanes],
    force_n: &[Lanes],
    out: &mut [LaneRow],
) {
    lanes.run_blocks(states, height_m, force_n, out);
}

#[cfg(all(target_arch = "x86_64", feature = "std"))]
#[target_feature(enable = "avx2")]
fn lanes_avx2(
    lanes: &EulerLanes<'_>,
    states: &mut [ContactState; LANES],
    height_m: &[Lanes],
    force_n: &[Lanes],
    out: &mut [LaneRow],
) {
    lanes.run_blocks(states, height_m, force_n, out);
}
