//! SIMD: the one room that asks which instructions this processor has.
//!
//! A [`Level`] is found once and carried by every design. A kernel is written once, over the
//! vectors of `fearless_simd`, whose values exist only where their instructions do; `at_level!`
//! compiles it for each set and picks the one of a level. Nothing else in the crate asks the
//! processor anything.
//!
//! | level | vectors | a · b + c |
//! |---|---|---|
//! | portable: SSE2, WebAssembly SIMD128, or arrays | 128 bits | rounds twice |
//! | NEON | 128 bits | rounds once |
//! | AVX2 with FMA (x86-64-v3) | 256 bits | rounds once |
//! | AVX-512 (Ice Lake and later) | 512 bits | rounds once |
//!
//! A kernel that must give the same bits everywhere never asks for a · b + c in one operation.
//! Where one does, all sets that round once agree with each other to the bit, and all that round
//! twice do.

mod set;
mod vector;

pub use fearless_simd;
pub use set::Set;
pub(crate) use vector::{Eight, Single, Sixteen, Vector, Word};

/// An instruction set the kernels are compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Isa {
    /// Instructions that every processor of the build target has; multiplication and addition round
    /// apart.
    Portable,
    /// 64-bit ARM.
    Neon,
    /// x86-64 with AVX2 and FMA.
    Avx2,
    /// x86-64 with AVX-512 as Ice Lake has it.
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
#[derive(Debug, Clone, Copy)]
pub struct Level(Token);

/// The sets of the build target. A value is the proof that the processor has them.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
#[allow(missing_docs)]
pub enum Token {
    #[cfg(target_arch = "x86_64")]
    Portable(fearless_simd::Sse2),
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    Portable(fearless_simd::WasmSimd128),
    #[cfg(not(any(target_arch = "x86_64", all(target_arch = "wasm32", target_feature = "simd128"))))]
    Portable(fearless_simd::Fallback),
    #[cfg(target_arch = "aarch64")]
    Neon(fearless_simd::Neon),
    #[cfg(target_arch = "x86_64")]
    Avx2(fearless_simd::Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(fearless_simd::Avx512),
}

/// The vectors every processor of the target has, for numbers that are never multiplied and added
/// at once.
#[cfg(target_arch = "x86_64")]
pub(crate) type Base = fearless_simd::Sse2;
#[cfg(target_arch = "aarch64")]
pub(crate) type Base = fearless_simd::Neon;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
pub(crate) type Base = fearless_simd::WasmSimd128;
#[cfg(not(any(
    target_arch = "x86_64",
    target_arch = "aarch64",
    all(target_arch = "wasm32", target_feature = "simd128")
)))]
pub(crate) type Base = fearless_simd::Fallback;

/// The right to use them.
#[allow(unsafe_code)]
// SAFETY: every x86-64 processor has SSE2 and FXSR, every aarch64 NEON, or could not run a program
// of this target.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
pub(crate) const BASE: Base = unsafe { Base::assume_supported() };
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
pub(crate) const BASE: Base = Base::assume_supported();
#[cfg(not(any(
    target_arch = "x86_64",
    target_arch = "aarch64",
    all(target_arch = "wasm32", target_feature = "simd128")
)))]
pub(crate) const BASE: Base = Base::new();

/// Runs an expression with the token of a level, compiled for its instruction set:
/// `at_level!(level, s => kernel(s, …))`. All that the expression calls must be
/// `#[inline(always)]`.
#[macro_export]
#[doc(hidden)]
macro_rules! at_level {
    ($level:expr, $s:ident => $work:expr) => {
        $crate::simd::at_level!($level, $s => $work, wide $s => $work)
    };
    // 512-bit vectors may be another kernel.
    ($level:expr, $s:ident => $work:expr, wide $t:ident => $wide:expr) => {{
        use $crate::simd::fearless_simd::Simd as _;
        match $level.token() {
            $crate::simd::Token::Portable($s) => $s.vectorize(#[inline(always)] || $work),
            #[cfg(target_arch = "aarch64")]
            $crate::simd::Token::Neon($s) => $s.vectorize(#[inline(always)] || $work),
            #[cfg(target_arch = "x86_64")]
            $crate::simd::Token::Avx2($s) => $s.vectorize(#[inline(always)] || $work),
            #[cfg(target_arch = "x86_64")]
            $crate::simd::Token::Avx512($t) => $t.vectorize(#[inline(always)] || $wide),
        }
    }};
}
#[doc(inline)]
pub use at_level;

impl PartialEq for Level {
    fn eq(&self, other: &Self) -> bool {
        self.isa() == other.isa()
    }
}

impl Eq for Level {}

impl Level {
    /// Runs everywhere, with the same bits.
    #[cfg(not(target_arch = "aarch64"))]
    pub const PORTABLE: Self = Self(Token::Portable(BASE));
    /// Runs everywhere, with the same bits.
    #[cfg(target_arch = "aarch64")]
    pub const PORTABLE: Self = Self(Token::Portable(fearless_simd::Fallback::new()));

    /// The fastest set of this processor. Without the feature `std`, the set of the build target.
    #[must_use]
    pub fn detect() -> Self {
        [Isa::Avx512, Isa::Avx2, Isa::Neon].into_iter().find_map(Self::find).unwrap_or(Self::PORTABLE)
    }

    /// The level of `isa`, if this processor has it.
    #[must_use]
    pub fn find(isa: Isa) -> Option<Self> {
        #[allow(unused_variables)] // One target asks one question.
        let found = {
            #[cfg(feature = "std")]
            {
                fearless_simd::Level::new()
            }
            #[cfg(not(feature = "std"))]
            {
                fearless_simd::Level::baseline()
            }
        };
        match isa {
            Isa::Portable => Some(Self::PORTABLE),
            #[cfg(target_arch = "aarch64")]
            Isa::Neon => found.as_neon().map(|token| Self(Token::Neon(token))),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => found.as_avx2().map(|token| Self(Token::Avx2(token))),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => found.as_avx512().map(|token| Self(Token::Avx512(token))),
            #[allow(unreachable_patterns)] // Sets of other architectures.
            _ => None,
        }
    }

    /// Every level of this processor, the portable one first.
    pub fn available() -> impl Iterator<Item = Self> {
        Isa::ALL.into_iter().filter_map(Self::find)
    }

    /// Which instruction set this is.
    #[must_use]
    pub const fn isa(self) -> Isa {
        match self.0 {
            Token::Portable(_) => Isa::Portable,
            #[cfg(target_arch = "aarch64")]
            Token::Neon(_) => Isa::Neon,
            #[cfg(target_arch = "x86_64")]
            Token::Avx2(_) => Isa::Avx2,
            #[cfg(target_arch = "x86_64")]
            Token::Avx512(_) => Isa::Avx512,
        }
    }

    /// Dispatch with vectors of at most 256 bits, for kernels that gain nothing from wider ones.
    #[must_use]
    pub fn at_most_256_bits(self) -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Token::Avx512(token) = self.0 {
            return fearless_simd::Level::Avx512(token)
                .as_avx2()
                .map_or(self, |token| Self(Token::Avx2(token)));
        }
        self
    }

    #[doc(hidden)]
    #[must_use]
    pub const fn token(self) -> Token {
        self.0
    }
}
