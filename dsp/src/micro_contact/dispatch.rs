//! Chooses the widest vectors of the machine for the same arithmetic.
//!
//! Every kernel is written once over [`super::quad::Quad`] and compiled for each.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
use super::quad::Halves;
#[cfg(not(target_arch = "x86_64"))]
use super::quad::Plain as Widest;
#[cfg(all(target_arch = "x86_64", feature = "std"))]
use super::quad::Whole;
/// What every machine of this architecture has.
#[cfg(target_arch = "x86_64")]
type Widest = Halves<false>;

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
    if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
        // SAFETY: the machine has AVX2 and FMA, all that the function asks for.
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
    design.run_blocks::<Widest, Widest>(state, height_m, force_n, out);
}

#[cfg(all(target_arch = "x86_64", feature = "std"))]
#[target_feature(enable = "avx2,fma")]
fn run_avx2(
    design: &MicroContact,
    state: &mut ContactState,
    height_m: &[f64],
    force_n: &[f64],
    out: &mut [ContactSample],
) {
    design.run_blocks::<Whole, Halves<true>>(state, height_m, force_n, out);
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
    if std::arch::is_x86_feature_detected!("avx512vl") && std::arch::is_x86_feature_detected!("fma") {
        // SAFETY: the machine has AVX-512VL (which includes AVX-512F and AVX2) and FMA.
        return unsafe { lanes_avx512(lanes, states, height_m, force_n, out) };
    }
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
        // SAFETY: the machine has AVX2 and FMA, all that the function asks for.
        return unsafe { lanes_avx2(lanes, states, height_m, force_n, out) };
    }
    lanes.run_blocks::<Widest>(states, height_m, force_n, out);
}

/// The same vectors, but twice the registers: no coefficient is spilled.
#[cfg(all(target_arch = "x86_64", feature = "std"))]
#[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
fn lanes_avx512(
    lanes: &EulerLanes<'_>,
    states: &mut [ContactState; LANES],
    height_m: &[Lanes],
    force_n: &[Lanes],
    out: &mut [LaneRow],
) {
    lanes.run_blocks::<Whole>(states, height_m, force_n, out);
}

#[cfg(all(target_arch = "x86_64", feature = "std"))]
#[target_feature(enable = "avx2,fma")]
fn lanes_avx2(
    lanes: &EulerLanes<'_>,
    states: &mut [ContactState; LANES],
    height_m: &[Lanes],
    force_n: &[Lanes],
    out: &mut [LaneRow],
) {
    lanes.run_blocks::<Whole>(states, height_m, force_n, out);
}
