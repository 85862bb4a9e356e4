//! The corpus: recordings, maps and trajectories that tests try the programs on.
//!
//! They are not part of the repository. `ASPERITY_CORPUS` names their folder; without it, it is
//! looked for at `../shared/corpus` beside the workspace. Where a piece is absent a test says that
//! it skips, unless `ASPERITY_NOTHING_SKIPPED=1` demands it: `.ci/run` sets that where the folder
//! is there.

use std::path::{Path, PathBuf};

/// Set to 1, it makes everything obligatory that tests may otherwise skip.
const NOTHING_SKIPPED: &str = "ASPERITY_NOTHING_SKIPPED";

/// The folder or file `piece` of the corpus; none, with a word, where it is absent and may be
/// skipped.
///
/// # Panics
/// When it is absent and `ASPERITY_NOTHING_SKIPPED=1`.
#[must_use]
pub fn corpus(piece: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/corpus");
    let path = std::env::var_os("ASPERITY_CORPUS").map_or_else(beside, PathBuf::from).join(piece);
    if path.exists() {
        return Some(path);
    }
    skip(&format!("no {}; set ASPERITY_CORPUS to the folder of the corpus", path.display()));
    None
}

/// Says that something is skipped, and why.
///
/// # Panics
/// When `ASPERITY_NOTHING_SKIPPED=1`.
pub fn skip(why: &str) {
    assert!(std::env::var(NOTHING_SKIPPED).as_deref() != Ok("1"), "nothing may be skipped: {why}");
    println!("skipped: {why}");
}
