//! Specification: what a data set is made of, as a TOML file says it.
//!
//! ```toml
//! name = "strokes"
//! seed = 7
//! strokes = 10_000
//! per_shard = 500
//! [surface]
//! choice = ["maps/*.toml", { solid = "granite" }]      # scene files, or keys of a [[surface]]
//! roughness = { uniform = [0, 1] }                     # any key of a [[surface]], over what the choice says
//! [finger]
//! speed_m_s = { log_uniform = [0.02, 0.3] }
//! ```
//! Every value under `surface`, `body`, `probe` and `finger` may be a distribution
//! ([`crate::distribution`]).

mod output;

use asperity::Isa;
use asperity::files::{FileError, nearest};
use serde::Deserialize;
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

pub use output::{Audio, Force, Format, Haptic, Output};

/// Most strokes of a data set; their numbers have twelve digits.
pub const MOST_STROKES: u64 = 1_000_000_000_000;
/// Names of distributions.
const DISTRIBUTIONS: [&str; 4] = ["uniform", "log_uniform", "normal", "choice"];
/// Most strokes of a shard.
pub const MOST_PER_SHARD: u64 = 1_000_000;

/// A specification, read and checked.
#[derive(Debug, Clone)]
pub struct Spec {
    /// The file, for messages and for paths inside it.
    pub path: PathBuf,
    /// Its bytes.
    pub text: String,
    /// Contents.
    pub says: Says,
}

/// The keys of a specification.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Says {
    /// Name of the data set; missing: the file's.
    #[serde(default)]
    pub name: String,
    /// Seed of every draw.
    #[serde(default)]
    pub seed: u64,
    /// Number of strokes.
    pub strokes: u64,
    /// Strokes a shard.
    #[serde(default = "per_shard")]
    pub per_shard: u64,
    /// Kernel family; missing: portable, whose bits do not depend on the processor.
    #[serde(default = "portable")]
    pub kernel: String,
    /// Surface.
    pub surface: Surfaces,
    /// Body: keys of a `[[body]]`; missing: that of the choice, or none.
    #[serde(default)]
    pub body: Table,
    /// Probe: keys of `[probe]`.
    #[serde(default)]
    pub probe: Table,
    /// Motion.
    #[serde(default)]
    pub finger: Finger,
    /// Outputs that are kept.
    #[serde(default)]
    pub output: Output,
    /// Who learns and who is asked.
    #[serde(default)]
    pub split: Split,
}

/// Surfaces.
#[derive(Debug, Clone, Deserialize)]
pub struct Surfaces {
    /// Scene files (a name may hold `*`), or tables with the keys of a `[[surface]]`.
    pub choice: Vec<Value>,
    /// Keys of a `[[surface]]`, over what the choice says.
    #[serde(flatten)]
    pub over: Table,
}

/// Motion of a finger.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Finger {
    /// Speed along the path, m/s; the highest of a stroke to and fro.
    pub speed_m_s: Value,
    /// Force, N.
    pub force_n: Value,
    /// `line`, `arc` or `back-and-forth`.
    pub path: Value,
    /// Duration of touch, s.
    pub duration_s: Value,
    /// Reports a second, Hz.
    pub reports_hz: Value,
}

/// Who learns and who is asked: shares that add up to 1.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Split {
    /// `surface`: all strokes of a surface are in one part, so that nothing is asked about what was
    /// learned; `stroke`: at random.
    pub by: SplitBy,
    /// Share of `train`.
    pub train: f64,
    /// Share of `validation`.
    pub validation: f64,
    /// Share of `test`.
    pub test: f64,
}

/// Group that is never parted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SplitBy {
    /// The strokes of a surface.
    #[default]
    Surface,
    /// Nothing but a stroke.
    Stroke,
}

fn per_shard() -> u64 {
    1000
}

fn portable() -> String {
    Isa::Portable.name().to_owned()
}

impl Default for Finger {
    fn default() -> Self {
        Self {
            speed_m_s: Value::Float(0.1),
            force_n: Value::Float(1.0),
            path: Value::String("line".to_owned()),
            duration_s: Value::Float(1.0),
            reports_hz: Value::Float(60.0),
        }
    }
}

impl Default for Split {
    fn default() -> Self {
        Self { by: SplitBy::Surface, train: 0.8, validation: 0.1, test: 0.1 }
    }
}

impl Spec {
    /// Reads a specification.
    ///
    /// # Errors
    /// When it cannot be read, is not TOML, or a key is unknown, missing or out of its range; the
    /// message names it.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        let text = fs::read_to_string(path).map_err(|error| FileError::read(path, &error))?;
        Self::parse(text, path)
    }

    /// Checks the text of a specification that lies at `path`.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn parse(text: String, path: &Path) -> Result<Self, FileError> {
        let right = "docs/formats/data-sets.md has the keys of a specification";
        let says: Says = toml::from_str(&text)
            .map_err(|error| FileError::toml(&text, &error, right).within(path.display()))?;
        let mut spec = Self { path: path.to_owned(), text, says };
        if spec.says.name.is_empty() {
            spec.says.name =
                path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        }
        let checked = spec.check().and_then(|()| spec.check_words());
        checked.map_err(|error| error.at_line_in(&spec.text).within(path.display()))?;
        Ok(spec)
    }

    /// SHA-256 of its bytes, in hexadecimal digits.
    #[must_use]
    pub fn sha256(&self) -> String {
        sha256(self.text.as_bytes())
    }

    /// Number of shards.
    #[must_use]
    pub fn shards(&self) -> u64 {
        self.says.strokes.div_ceil(self.says.per_shard)
    }

    /// The kernel family.
    #[must_use]
    pub fn kernel(&self) -> Isa {
        Isa::from_name(&self.says.kernel).unwrap_or(Isa::Portable)
    }

    /// Misspelt distributions.
    fn check_words(&self) -> Result<(), FileError> {
        let says = &self.says;
        let Finger { speed_m_s, force_n, path, duration_s, reports_hz } = &says.finger;
        let finger = [speed_m_s, force_n, path, duration_s, reports_hz];
        let tables = [&says.body, &says.probe, &says.surface.over].into_iter().flat_map(Table::values);
        let values = tables.chain(finger).chain(&says.surface.choice);
        values.into_iter().try_for_each(check_distribution)
    }

    /// Checks what is felt and the force.
    fn check_felt(&self) -> Result<(), FileError> {
        let output = &self.says.output;
        if output.haptic.is_empty() {
            return Err(FileError::new("output.haptic", "is empty", "name a quantity, or leave it out"));
        }
        let known = ["displacement", "acceleration", "tangential", "force"];
        for (place, haptic) in output.haptic.iter().enumerate() {
            let fastest = [100.0, output.audio.rate_hz];
            let right = "must be 100 Hz to the rate of the audio";
            number("output.haptic.rate_hz", haptic.rate_hz, fastest, right)?;
            number("output.haptic.felt_force_exponent", haptic.exponent(), [0.0, 1.0], "must be 0 to 1")?;
            if !known.contains(&haptic.output.as_str()) {
                return Err(unknown("output.haptic.output", &haptic.output, &known.join(", ")));
            }
            if output.haptic[..place].iter().any(|other| other.output == haptic.output) {
                let what = format!("{} stands there twice", haptic.output);
                return Err(FileError::new("output.haptic", what, "name each quantity once"));
            }
        }
        let Some(force) = output.force else { return Ok(()) };
        let range = asperity::limits::output::FORCE_RATE_HZ;
        if force.rate_hz > output.audio.rate_hz {
            let what = format!("{} is refused", force.rate_hz);
            let right = "must be at most the rate of the audio";
            return Err(FileError::new("output.force.rate_hz", what, right));
        }
        number("output.force.rate_hz", force.rate_hz, [range.low, range.high], range.words)
    }

    fn check(&self) -> Result<(), FileError> {
        let says = &self.says;
        whole("strokes", says.strokes, MOST_STROKES)?;
        whole("per_shard", says.per_shard, MOST_PER_SHARD)?;
        if Isa::from_name(&says.kernel).is_none() {
            return Err(unknown("kernel", &says.kernel, &Isa::ALL.map(Isa::name).join(", ")));
        }
        if says.surface.choice.is_empty() {
            let right = "write choice = [\"maps/*.toml\", { solid = \"granite\" }]";
            return Err(FileError::new("surface.choice", "is empty", right));
        }
        let rates = asperity::limits::output::SAMPLE_RATE_HZ;
        number("output.audio.rate_hz", says.output.audio.rate_hz, [8000.0, 384_000.0], rates.words)?;
        self.check_felt()?;
        number("output.tail_s", says.output.tail_s, [0.0, 60.0], "must be 0 to 60 s")?;
        says.output.audio.codec.check(says.output.audio.rate_hz)?;
        let shares =
            [("train", says.split.train), ("validation", says.split.validation), ("test", says.split.test)];
        for (name, share) in shares {
            number(&format!("split.{name}"), share, [0.0, 1.0], "must be 0 to 1")?;
        }
        let sum: f64 = shares.iter().map(|(_, share)| share).sum();
        if (sum - 1.0).abs() > 1e-6 {
            return Err(FileError::new(
                "split",
                format!("the shares add up to {sum}"),
                "they must add up to 1",
            ));
        }
        Ok(())
    }
}

/// Refuses a table that holds a misspelt distribution, however deep.
fn check_distribution(value: &Value) -> Result<(), FileError> {
    let inner: Vec<&Value> = match value {
        Value::Table(table) => {
            if let (1, Some((key, Value::Array(_)))) = (table.len(), table.iter().next())
                && !DISTRIBUTIONS.contains(&key.as_str())
                && let Some(meant) = nearest(key, &DISTRIBUTIONS)
            {
                return Err(FileError::new(key, "unknown key", format!("write {meant}")));
            }
            table.values().collect()
        }
        Value::Array(values) => values.iter().collect(),
        _ => Vec::new(),
    };
    inner.into_iter().try_for_each(check_distribution)
}

/// A word that is none of those that would be right.
pub(crate) fn unknown(at: &str, word: &str, known: &str) -> FileError {
    let meant = nearest(word, &known.split(", ").collect::<Vec<_>>());
    let meant = meant.map_or_else(String::new, |meant| format!("write \"{meant}\"; "));
    FileError::new(at, format!("\"{word}\" is unknown"), format!("{meant}must be one of {known}"))
}

fn whole(name: &str, value: u64, most: u64) -> Result<(), FileError> {
    if (1..=most).contains(&value) {
        return Ok(());
    }
    Err(FileError::new(name, format!("{value} is refused"), format!("must be 1 to {most}")))
}

fn number(name: &str, value: f64, [low, high]: [f64; 2], right: &str) -> Result<(), FileError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(FileError::new(name, format!("{value} is refused"), right))
}

/// SHA-256 in hexadecimal digits.
#[must_use]
pub fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Bytes in hexadecimal digits.
#[must_use]
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
