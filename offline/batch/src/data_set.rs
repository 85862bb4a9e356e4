//! Data set: its shards made, kept and listed.

use crate::build::Build;
use crate::check::check;
use crate::draw::Draws;
use crate::manifest::{self, Manifest};
use crate::record::{Record, Samples};
use crate::spec::{Format, Haptic, Spec, SplitBy, hex};
use crate::stroke::{DataLevels, Stroke, data_levels};
use crate::surfaces::{Choice, choices, split};
use crate::{parquet_file, webdataset, whole_file};
use asperity::files::FileError;
use asperity::load::Maps;
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

/// A data set that is being made.
#[derive(Debug)]
pub struct DataSet {
    spec: Spec,
    folder: PathBuf,
    choices: Vec<Choice>,
    levels: DataLevels,
    build: Build,
    maps: Maps,
    doubts: Vec<String>,
    fresh: Fresh,
}

/// Strokes that are looked at for a part without any.
const MOST_COUNTED: u64 = 100_000;

/// The first folder that had to be made for a data set; none where it was there.
#[derive(Debug, Clone)]
struct Fresh(Option<PathBuf>);

impl Fresh {
    fn make(folder: &Path) -> Result<Self, FileError> {
        let missing = |path: &&Path| !path.as_os_str().is_empty() && !path.exists();
        let made = folder.ancestors().take_while(missing).last().map(Path::to_owned);
        fs::create_dir_all(folder).map_err(|error| FileError::write(folder, &error))?;
        Ok(Self(made))
    }

    /// Removes it again, unless a shard lies there or is being made.
    fn undo(&self, folder: &Path) {
        let Some(made) = &self.0 else { return };
        let mut names = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
        if names.all(|entry| !entry.file_name().to_string_lossy().contains("shard-")) {
            let _ = fs::remove_dir_all(made);
        }
    }
}

/// Result of making a shard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// It was made.
    Made {
        /// Samples of the sound that 16 bits have cut off.
        clipped: u64,
    },
    /// It was there, whole and of this build.
    Kept,
}

impl DataSet {
    /// Opens a folder for a specification: copies what the surfaces are made of, finds the levels.
    ///
    /// # Errors
    /// When a surface cannot be used, the folder cannot be written, or holds shards of another
    /// build.
    pub fn open(spec: Spec, folder: &Path) -> Result<Self, FileError> {
        let fresh = Fresh::make(folder)?;
        Self::in_folder(spec, folder, fresh.clone()).inspect_err(|_| fresh.undo(folder))
    }

    fn in_folder(spec: Spec, folder: &Path, fresh: Fresh) -> Result<Self, FileError> {
        let build = Build::of(&spec);
        if let Some(there) = Manifest::load(folder)? {
            same_build(&folder.join(manifest::NAME), &build, &there.build)?;
        }
        let choices = choices(&spec, folder).map_err(|error| error.within(spec.path.display()))?;
        let doubts = check(&spec, &choices, folder)?;
        let maps = Maps::default();
        let levels = data_levels(&spec, &choices, folder, &maps)?;
        whole_file::write_once(&folder.join("spec.toml"), spec.text.as_bytes())?;
        Ok(Self { spec, folder: folder.to_owned(), choices, levels, build, maps, doubts, fresh })
    }

    /// Parts of the data set that have a share and no stroke, and why.
    #[must_use]
    pub fn empty_parts(&self) -> Option<String> {
        let says = &self.spec.says;
        let count = self.choices.len();
        let parts: BTreeSet<&str> = match says.split.by {
            SplitBy::Surface => (0..count).map(|surface| split(&self.spec, surface, count, 0)).collect(),
            SplitBy::Stroke => (0..says.strokes.min(MOST_COUNTED))
                .map(|stroke| split(&self.spec, 0, count, stroke))
                .collect(),
        };
        let shares =
            [("train", says.split.train), ("validation", says.split.validation), ("test", says.split.test)];
        let empty = shares.iter().filter(|(name, share)| *share > 0.0 && !parts.contains(name));
        let empty: Vec<&str> = empty.map(|(name, _)| *name).collect();
        let right = match says.split.by {
            SplitBy::Surface => format!(
                "there are {count} surfaces, and none is parted; add surfaces, write by = \"stroke\", or other shares under [split]"
            ),
            SplitBy::Stroke => "make more strokes, or write other shares under [split]".to_owned(),
        };
        (!empty.is_empty()).then(|| format!("no stroke belongs to {}: {right}", empty.join(" and ")))
    }

    /// Specification that it is made of.
    #[must_use]
    pub fn spec(&self) -> &Spec {
        &self.spec
    }

    /// Doubts about units, and about the pictures that were read so far ([`Maps::remarks`]).
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        [self.doubts.clone(), self.maps.remarks()].concat()
    }

    /// The file of a shard.
    #[must_use]
    pub fn file(&self, index: u64) -> String {
        format!("shard-{index:06}.{}", self.spec.says.output.format.extension())
    }

    /// Makes a shard, unless it is there. `progress` is called after each stroke.
    ///
    /// # Errors
    /// When a stroke is refused, the disk is full, or the shard that is there is of another build.
    pub fn shard(&self, index: u64, progress: &mut dyn FnMut()) -> Result<Outcome, FileError> {
        self.made(index, progress).inspect_err(|_| self.fresh.undo(&self.folder))
    }

    fn made(&self, index: u64, progress: &mut dyn FnMut()) -> Result<Outcome, FileError> {
        let name = self.file(index);
        let path = self.folder.join(&name);
        let per_shard = self.spec.says.per_shard;
        let (first, last) = (index * per_shard, self.spec.says.strokes.min((index + 1) * per_shard));
        if self.is_there(&path, last - first)? {
            (first..last).for_each(|_| progress());
            return Ok(Outcome::Kept);
        }
        // Another process that clears up must not come between the file and its lock.
        let began = manifest::lock(&self.folder)?;
        let mut began = Some(began);
        let mut clipped = 0;
        let mut sum = String::new();
        let mut refused = None;
        let written = whole_file::write_with(&path, |file| {
            drop(began.take());
            let mut out = Summed { out: file, sum: Sha256::new() };
            let made = self.write(&mut out, first..last, &mut clipped, progress);
            sum = hex(&out.sum.finalize_reset());
            made.map_err(|failure| match failure {
                Failure::Disk(error) => error,
                Failure::Refused(error) => {
                    refused = Some(error);
                    io::ErrorKind::Other.into()
                }
            })
        });
        match (refused, written) {
            (Some(error), _) | (None, Err(error)) => return Err(error),
            (None, Ok(())) => {}
        }
        whole_file::write(
            &self.folder.join(manifest::sum_name(&name)),
            format!("{sum}  {name}\n").as_bytes(),
        )?;
        Ok(Outcome::Made { clipped })
    }

    /// Writes the manifest with every shard that is there.
    ///
    /// # Errors
    /// When the folder cannot be read or written.
    pub fn write_manifest(&self) -> Result<Manifest, FileError> {
        let count = self.choices.len();
        let splits = match self.spec.says.split.by {
            SplitBy::Surface => self
                .choices
                .iter()
                .enumerate()
                .map(|(i, choice)| (choice.name.clone(), split(&self.spec, i, count, 0).to_owned()))
                .collect(),
            SplitBy::Stroke => Default::default(),
        };
        let mut manifest = Manifest::new(&self.spec, &self.build, &self.levels, splits);
        manifest.write(&self.folder)?;
        Ok(manifest)
    }

    /// Tests whether a shard is there whole. One that was cut off is made again; one of another
    /// build is an error.
    fn is_there(&self, path: &Path, strokes: u64) -> Result<bool, FileError> {
        if !path.exists() {
            return Ok(false);
        }
        let Ok((build, held)) = build_of(path) else { return Ok(false) };
        same_build(path, &self.build, &build)?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let sum = fs::read_to_string(path.with_file_name(manifest::sum_name(&name))).unwrap_or_default();
        Ok(held == strokes && sum.split_whitespace().next() == Some(sha256_of(path)?.as_str()))
    }

    fn write(
        &self,
        out: &mut (dyn Write + Send),
        strokes: std::ops::Range<u64>,
        clipped: &mut u64,
        progress: &mut dyn FnMut(),
    ) -> Result<(), Failure> {
        let output = &self.spec.says.output;
        let mut more = [
            ("audio_rate_hz", output.audio.rate_hz.to_string()),
            ("haptic_rate_hz", output.haptic[0].rate_hz.to_string()),
            ("haptic_full_scale", self.levels.full_scale[0].to_string()),
            ("audio_gain", self.levels.gain.to_string()),
        ]
        .map(|(key, value)| (key.to_owned(), value))
        .to_vec();
        for (haptic, full_scale) in output.haptic.iter().zip(&self.levels.full_scale).skip(1) {
            let column = haptic.further_column();
            more.push((format!("{column}_rate_hz"), haptic.rate_hz.to_string()));
            more.push((format!("{column}_full_scale"), full_scale.to_string()));
        }
        more.extend(output.force.map(|force| ("force_rate_hz".to_owned(), force.rate_hz.to_string())));
        let records = strokes.map(|number| {
            let record = self.record(number);
            progress();
            record.inspect(|record| *clipped += record.samples.clipped)
        });
        match output.format {
            Format::Parquet => {
                let mut shard = parquet_file::Shard::begin(out, &self.build, output, &more).map_err(disk)?;
                for record in records {
                    shard.add(record.map_err(Failure::Refused)?).map_err(disk)?;
                }
                shard.finish().map_err(disk)?.flush().map_err(Failure::Disk)
            }
            Format::WebDataset => {
                let mut shard = webdataset::Shard::begin(out, &self.build, &more);
                for record in records {
                    let record = record.map_err(Failure::Refused)?;
                    shard.add(&record, &output.haptic[1..]).map_err(Failure::Disk)?;
                }
                shard.finish().and_then(Write::flush).map_err(Failure::Disk)
            }
        }
    }

    /// The record of a stroke.
    ///
    /// # Errors
    /// When a draw is out of its range, or the scene cannot be rendered.
    pub fn record(&self, number: u64) -> Result<Record, FileError> {
        let stroke = Stroke::drawn(&self.spec, &self.choices, Some(&self.levels), number, &self.folder)?;
        let take = stroke
            .rendered(&self.spec, &self.levels, &self.maps)
            .map_err(|error| error.within(format!("{}: stroke {number}", self.spec.path.display())))?;
        let samples = Samples::of(&stroke.id, take, &self.spec.says.output)?;
        Ok(Record { stroke, samples })
    }
}

/// Why a shard was not written.
enum Failure {
    Disk(io::Error),
    Refused(FileError),
}

fn disk(error: parquet::errors::ParquetError) -> Failure {
    match error {
        parquet::errors::ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(error) => Failure::Disk(*error),
            Err(inner) => Failure::Disk(io::Error::other(inner.to_string())),
        },
        other => Failure::Disk(io::Error::other(other.to_string())),
    }
}

fn same_build(path: &Path, ours: &Build, theirs: &Build) -> Result<(), FileError> {
    match ours.differs(theirs) {
        None => Ok(()),
        Some(_) if ours.spec_sha256 != theirs.spec_sha256 => Err(FileError::file(
            path,
            "is of another specification",
            "choose another folder, or the specification that began this one: its copy is spec.toml there",
        )),
        Some(what) => Err(FileError::file(
            path,
            format!("is of another build: {what}"),
            "choose another folder, or the build that began this one",
        )),
    }
}

/// Build that made a shard, and its number of strokes.
pub(crate) fn build_of(path: &Path) -> Result<(Build, u64), FileError> {
    if is_tar(path) { webdataset::build_of(path) } else { parquet_file::build_of(path) }
}

/// Some records of a shard.
pub(crate) fn records(
    path: &Path,
    further: &[Haptic],
    wanted: &dyn Fn(u64) -> bool,
) -> Result<Vec<parquet_file::Kept>, FileError> {
    if is_tar(path) {
        webdataset::records(path, further, wanted)
    } else {
        parquet_file::records(path, further, wanted)
    }
}

fn is_tar(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "tar")
}

/// SHA-256 of a file.
pub(crate) fn sha256_of(path: &Path) -> Result<String, FileError> {
    let mut file = File::open(path).map_err(|error| FileError::read(path, &error))?;
    let (mut sum, mut buffer) = (Sha256::new(), vec![0; 1 << 18]);
    loop {
        let read = file.read(&mut buffer).map_err(|error| FileError::read(path, &error))?;
        if read == 0 {
            return Ok(hex(&sum.finalize()));
        }
        sum.update(&buffer[..read]);
    }
}

/// Sums what it writes.
struct Summed {
    out: BufWriter<File>,
    sum: Sha256,
}

impl Write for Summed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.sum.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Which strokes of a shard are looked at again: one in 1/share, by their numbers.
pub(crate) fn is_sampled(seed: u64, stroke: u64, share: f64) -> bool {
    share >= 1.0 || Draws { seed, stroke }.unit("verify") < share
}
