//! Instruction sets of the bank, and its entry points.
#![allow(unsafe_code)]

use super::design::{GRID_SAMPLES, GroupState, ModeGroup};
use super::job::{Feed, Input, Job, MAX_INPUTS};
use super::sleep;
use super::vector::Baseline;
use super::walk::walk;

/// An instruction set the bank has code for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Isa {
    /// Plain Rust at the baseline of the build target; multiplication and addition round apart.
    Portable,
    /// 64-bit ARM.
    Neon,
    /// x86-64 with AVX2 and FMA.
    Avx2,
    /// x86-64 with AVX-512F.
    Avx512,
}

impl Isa {
    /// Every instruction set.
    pub const ALL: [Self; 4] = [Self::Portable, Self::Neon, Self::Avx2, Self::Avx512];

    /// Its name on the command line, in settings and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Neon => "neon",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// The instruction set of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|isa| isa.name() == name)
    }
}

/// Permission to run one instruction set; exists only for sets this processor has.
///
/// All sets with a fused multiply-add give the same bits; [`Isa::Portable`] differs from them in the
/// last digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kernel(Isa);

impl Kernel {
    /// Runs everywhere.
    pub const PORTABLE: Self = Self(Isa::Portable);

    /// The fastest set of this processor. Without the feature `std`, the set of the build target.
    #[must_use]
    pub fn detect() -> Self {
        [Isa::Avx512, Isa::Avx2, Isa::Neon].into_iter().find_map(Self::find).unwrap_or(Self::PORTABLE)
    }

    /// The kernel for `isa`, if this processor has it.
    #[must_use]
    pub fn find(isa: Isa) -> Option<Self> {
        let present = match isa {
            Isa::Portable => true,
            Isa::Neon => cfg!(target_arch = "aarch64"),
            Isa::Avx2 => has_avx2(),
            Isa::Avx512 => has_avx2() && has_avx512(),
        };
        present.then_some(Self(isa))
    }

    /// Which instruction set this is.
    #[must_use]
    pub const fn isa(self) -> Isa {
        self.0
    }

    /// Adds the bank's response to `impulses_n_s` to `out`; sample 0 of both is the absolute sample
    /// `first_sample`, which goes on where the last call ended. Every lane hears the one input at gain 1. Slices of unequal length are used as far
    /// as the shortest reaches.
    pub(super) fn render(
        self,
        first_sample: u64,
        groups: &[ModeGroup],
        states: &mut [GroupState],
        impulses_n_s: &[f32],
        out: &mut [f32],
    ) {
        let input = [Input { impulses: impulses_n_s, gains: &[] }];
        self.walk(first_sample, groups, states, Feed { inputs: &input, shared: true }, out);
    }

    /// As [`Kernel::render`] for up to [`MAX_INPUTS`] inputs (more are not heard), each with a gain for every
    /// lane. Two inputs cost two to three more operations a mode and sample than the shared one.
    pub(super) fn render_mixed(
        self,
        first_sample: u64,
        groups: &[ModeGroup],
        states: &mut [GroupState],
        inputs: &[Input<'_>],
        out: &mut [f32],
    ) {
        let inputs = &inputs[..inputs.len().min(MAX_INPUTS)];
        self.walk(first_sample, groups, states, Feed { inputs, shared: false }, out);
    }

    fn walk(
        self,
        first_sample: u64,
        groups: &[ModeGroup],
        states: &mut [GroupState],
        feed: Feed<'_>,
        out: &mut [f32],
    ) {
        let samples = feed.inputs.iter().fold(out.len(), |n, input| n.min(input.impulses.len()));
        let mut count = groups.len().min(states.len());
        if !feed.shared {
            count = feed.inputs.iter().fold(count, |n, input| n.min(input.gains.len()));
        }
        if feed.inputs.is_empty() || count == 0 || samples == 0 {
            return;
        }
        let mut job = Job {
            groups: &groups[..count],
            states: &mut states[..count],
            feed,
            pairs: [0.0; GRID_SAMPLES as usize / 2],
        };
        let out = &mut out[..samples];
        match self.0 {
            // SAFETY: the plain vector needs no instruction beyond the baseline.
            Isa::Portable => unsafe { walk::<Baseline, 4, 1>(first_sample, &mut job, out) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: a Kernel of this set exists only where the processor has it.
            Isa::Avx2 => unsafe { walk_avx2(first_sample, &mut job, out) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Isa::Avx512 => unsafe { walk_avx512(first_sample, &mut job, out) },
            #[cfg(target_arch = "aarch64")]
            // SAFETY: NEON is part of the base of this architecture.
            Isa::Neon => unsafe { walk::<super::vector::neon::Neon, 4, 3>(first_sample, &mut job, out) },
            // Sets of other architectures: `find` never makes such a kernel.
            #[allow(unreachable_patterns)]
            _ => {}
        }
    }

    /// Puts lanes whose amplitude is below `threshold` (output units) exactly to rest and returns how
    /// many leading groups still ring; the rest need no rendering until the next input. Lanes that
    /// hold no finite number are put to rest as well.
    ///
    /// Call it at absolute multiples of [`super::GRID_SAMPLES`], or the output depends on the split into blocks.
    pub(super) fn settle(self, groups: &[ModeGroup], states: &mut [GroupState], threshold: f32) -> usize {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: a Kernel of these sets exists only where the processor has them.
            Isa::Avx2 | Isa::Avx512 => unsafe { settle_avx2(groups, states, threshold) },
            _ => sleep::settle(groups, states, threshold),
        }
    }
}

#[cfg(all(target_arch = "x86_64", feature = "std"))]
fn has_avx2() -> bool {
    std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma")
}
#[cfg(all(target_arch = "x86_64", feature = "std"))]
fn has_avx512() -> bool {
    std::is_x86_feature_detected!("avx512f")
}
#[cfg(not(all(target_arch = "x86_64", feature = "std")))]
fn has_avx2() -> bool {
    cfg!(all(target_arch = "x86_64", target_feature = "avx2", target_feature = "fma"))
}
#[cfg(not(all(target_arch = "x86_64", feature = "std")))]
fn has_avx512() -> bool {
    cfg!(all(target_arch = "x86_64", target_feature = "avx512f"))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn walk_avx2(first_sample: u64, job: &mut Job<'_>, out: &mut [f32]) {
    // SAFETY: this function is only called where AVX2 and FMA are present.
    unsafe { walk::<super::vector::x86::Avx2, 2, 4>(first_sample, job, out) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
unsafe fn walk_avx512(first_sample: u64, job: &mut Job<'_>, out: &mut [f32]) {
    // SAFETY: this function is only called where AVX-512F is present.
    unsafe { walk::<super::vector::x86::Avx512, 1, 4>(first_sample, job, out) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn settle_avx2(groups: &[ModeGroup], states: &mut [GroupState], threshold: f32) -> usize {
    sleep::settle(groups, states, threshold)
}
