//! Build: what the bytes of a shard depend on besides its specification.

use crate::spec::Spec;
use serde::{Deserialize, Serialize};

/// Shards of one data set are of one build; those of another are refused, never mixed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Build {
    /// SHA-256 of the specification's bytes.
    pub spec_sha256: String,
    /// Version of asperity.
    pub version: String,
    /// Kernel family.
    pub kernel: String,
    /// Processor and system; `sin` and `exp` of a system's library may differ in the last bit.
    pub target: String,
}

impl Build {
    /// Build of a specification here and now.
    #[must_use]
    pub fn of(spec: &Spec) -> Self {
        Self {
            spec_sha256: spec.sha256(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            kernel: spec.kernel().name().to_owned(),
            target: format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
        }
    }

    /// Difference from another build, in words; none where they are equal.
    #[must_use]
    pub fn differs(&self, other: &Self) -> Option<String> {
        let pairs = [
            ("spec_sha256", &self.spec_sha256, &other.spec_sha256),
            ("version", &self.version, &other.version),
            ("kernel", &self.kernel, &other.kernel),
            ("target", &self.target, &other.target),
        ];
        let (name, ours, theirs) = pairs.into_iter().find(|(_, ours, theirs)| ours != theirs)?;
        Some(format!("{name} {theirs} instead of {ours}"))
    }
}
