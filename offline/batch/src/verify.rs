//! Verify: every shard is the one that was made, and its records render to what they hold.

use crate::data_set::{is_sampled, records, sha256_of};
use crate::manifest::{Manifest, NAME};
use crate::parquet_file::Kept;
use crate::record::Samples;
use crate::spec::Spec;
use crate::stroke::{DataLevels, rendered};
use asperity::files::FileError;
use asperity::load::Maps;
use serde::Serialize;
use std::path::Path;

/// Shards and strokes that were looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Verified {
    /// Shards whose bytes are those that were written.
    pub shards: u64,
    /// Shards of the specification that are not there yet.
    pub missing: u64,
    /// Strokes that were rendered again, to the same bits.
    pub rendered: u64,
}

/// Compares every shard with the manifest, and renders a share of the strokes again. `progress` is
/// called after each shard.
///
/// # Errors
/// The first shard that is bad, in one line.
pub fn verify(folder: &Path, share: f64, progress: &mut dyn FnMut()) -> Result<Verified, FileError> {
    let manifest = Manifest::load(folder)?.ok_or_else(|| {
        FileError::file(
            &folder.join(NAME),
            "no such file",
            "name the folder of a data set that asperity batch made",
        )
    })?;
    let spec = Spec::load(&folder.join("spec.toml"))?;
    if spec.sha256() != manifest.build.spec_sha256 {
        return Err(FileError::file(
            &spec.path,
            "is not what made this data set",
            "put the specification's copy back",
        ));
    }
    let maps = Maps::default();
    let levels = manifest.data_levels();
    let mut found = Verified { missing: spec.shards() - manifest.shards.len() as u64, ..Verified::default() };
    for shard in &manifest.shards {
        let path = folder.join(&shard.file);
        if sha256_of(&path)? != shard.sha256 {
            let right = "remove it and run asperity batch again";
            return Err(FileError::file(&path, "has other bytes than the manifest says", right));
        }
        if share > 0.0 {
            found.rendered += again(&path, (&spec, &levels), share, folder, &maps)?;
        }
        found.shards += 1;
        progress();
    }
    Ok(found)
}

fn again(
    path: &Path,
    (spec, levels): (&Spec, &DataLevels),
    share: f64,
    folder: &Path,
    maps: &Maps,
) -> Result<u64, FileError> {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let index: u64 = name
        .trim_start_matches("shard-")
        .split('.')
        .next()
        .and_then(|digits| digits.parse().ok())
        .unwrap_or(0);
    let first = index * spec.says.per_shard;
    let further = &spec.says.output.haptic[1..];
    let kept = records(path, further, &|row| is_sampled(spec.says.seed, first + row, share))?;
    for record in &kept {
        if !same(record, (spec, levels), folder, maps)? {
            let what = format!("stroke {} renders to other samples than it holds", record.id);
            return Err(FileError::file(
                path,
                what,
                "use the build that made it, or remove it and run asperity batch again",
            ));
        }
    }
    Ok(kept.len() as u64)
}

/// Tests whether a record's scene and contacts render to its samples, to the bit.
fn same(
    kept: &Kept,
    (spec, levels): (&Spec, &DataLevels),
    folder: &Path,
    maps: &Maps,
) -> Result<bool, FileError> {
    let take = rendered(&kept.scene, &kept.contacts, (spec, levels), &kept.id, folder, maps)?;
    Ok(Samples::of(&kept.id, take, &spec.says.output)?.same_bits(&kept.samples))
}
