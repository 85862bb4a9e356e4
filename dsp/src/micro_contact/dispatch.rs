//! Chooses the widest vectors of the machine for the same arithmetic.
//!
//! Every kernel is written once over [`super::quad::Quad`], wrapped as [`Work`] and compiled for each.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
use super::quad::Halves;
#[cfg(not(target_arch = "x86_64"))]
use super::quad::Plain as Widest;
use super::quad::Quad;
#[cfg(all(target_arch = "x86_64", feature = "std"))]
use super::quad::Whole;
/// What every machine of this architecture has.
#[cfg(target_arch = "x86_64")]
type Widest = Halves<false>;

use super::{ContactSample, ContactState, EulerLanes, LANES, LaneRow, Lanes, MicroContact};

/// A kernel and all it works on.
trait Work {
    /// Whether it has more values at hand than 16 registers hold.
    // Nobody asks where there is no choice.
    #[cfg_attr(not(all(target_arch = "x86_64", feature = "std")), allow(dead_code))]
    const MANY_REGISTERS: bool;
    /// Does it with whichever of the two kinds of vectors suits its scheme. Inlines into the caller, whose instructions it
    /// uses.
    fn run<A: Quad, B: Quad>(self);
}

/// Does the work on the widest vectors.
#[inline]
fn widest<W: Work>(work: W) {
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
        if W::MANY_REGISTERS && std::arch::is_x86_feature_detected!("avx512vl") {
            // SAFETY: the machine has AVX-512VL (which includes AVX-512F) and all that AVX2 needs.
            return unsafe { avx512(work) };
        }
        // SAFETY: the machine has AVX2 and FMA, all that the function asks for.
        return unsafe { avx2(work) };
    }
    work.run::<Widest, Widest>();
}

#[cfg(all(target_arch = "x86_64", feature = "std"))]
#[target_feature(enable = "avx2,fma")]
fn avx2<W: Work>(work: W) {
    work.run::<Whole, Halves<true>>();
}

/// The same vectors, but twice the registers: no coefficient is spilled.
#[cfg(all(target_arch = "x86_64", feature = "std"))]
#[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
fn avx512<W: Work>(work: W) {
    work.run::<Whole, Halves<true>>();
}

/// One contact.
struct Single<'a> {
    design: &'a MicroContact,
    state: &'a mut ContactState,
    height_m: &'a [f64],
    force_n: &'a [f64],
    out: &'a mut [ContactSample],
}

impl Work for Single<'_> {
    const MANY_REGISTERS: bool = false;
    #[inline(always)]
    fn run<A: Quad, B: Quad>(self) {
        self.design.run_blocks::<A, B>(self.state, self.height_m, self.force_n, self.out);
    }
}

/// Runs the design's kernel on the widest vectors.
#[inline]
pub(super) fn run(
    design: &MicroContact,
    state: &mut ContactState,
    height_m: &[f64],
    force_n: &[f64],
    out: &mut [ContactSample],
) {
    widest(Single { design, state, height_m, force_n, out });
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

/// Eight contacts.
struct Eight<'a> {
    lanes: &'a EulerLanes<'a>,
    states: &'a mut [ContactState; LANES],
    height_m: &'a [Lanes],
    force_n: &'a [Lanes],
    out: &'a mut [LaneRow],
}

impl Work for Eight<'_> {
    const MANY_REGISTERS: bool = true;
    #[inline(always)]
    fn run<A: Quad, B: Quad>(self) {
        self.lanes.run_blocks::<A>(self.states, self.height_m, self.force_n, self.out);
    }
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
    widest(Eight { lanes, states, height_m, force_n, out });
}
