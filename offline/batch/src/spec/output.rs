//! Outputs of a data set: the table `[output]` of a specification.

use crate::codec::Codec;
use asperity::FELT_FORCE_EXPONENT;
use serde::Deserialize;
use toml::Value;

/// Outputs that are kept.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// `parquet` or `webdataset`.
    pub format: Format,
    /// Ring-out after the finger lifts, s.
    pub tail_s: f64,
    /// Haptic quantities: the first is the column `haptic`, further ones are `haptic_QUANTITY`.
    #[serde(deserialize_with = "haptics")]
    pub haptic: Vec<Haptic>,
    /// The 3-D force and the path, as `STEM.force.csv` has them; missing: not kept.
    pub force: Option<Force>,
    /// Audio.
    pub audio: Audio,
}

/// The force on the finger, and where it is.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Force {
    /// Rows a second, Hz.
    #[serde(default = "force_rate")]
    pub rate_hz: f64,
}

/// Haptic quantity.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Haptic {
    /// Samples a second, Hz.
    pub rate_hz: f64,
    /// `displacement` (m), `acceleration` (m/s²), `tangential` (m) or `force` (N).
    pub output: String,
    /// Meaning of sample value 1; missing: by the level policy of the first surface, for all.
    pub full_scale: Option<f64>,
    /// n of a finger's displacement ∝ Fⁿ, 0 to 1; missing: as in a scene file.
    pub felt_force_exponent: Option<f64>,
}

impl Haptic {
    /// The column of a quantity that is not the first.
    #[must_use]
    pub fn further_column(&self) -> String {
        format!("haptic_{}", self.output)
    }

    /// n of a finger's displacement ∝ Fⁿ, as the level policy has it.
    #[must_use]
    pub fn exponent(&self) -> f64 {
        let by_policy = self.full_scale.is_none() && self.output == "displacement";
        self.felt_force_exponent.unwrap_or(if by_policy { FELT_FORCE_EXPONENT } else { 0.0 })
    }
}

/// Audio.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Audio {
    /// Samples a second, Hz: the engine's own rate.
    pub rate_hz: f64,
    /// Codec of samples.
    pub codec: Codec,
    /// Linear gain; missing: by the level policy of the first surface, for all.
    pub gain: Option<f64>,
}

/// Format of shards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// A table, one row a stroke.
    #[default]
    Parquet,
    /// A tar file, files of one name a stroke.
    WebDataset,
}

impl Format {
    /// Ending of its shards.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Parquet => "parquet",
            Self::WebDataset => "tar",
        }
    }
}

/// One quantity or a list of them; each a name, or a table whose `output` may be a list too.
fn haptics<'de, D: serde::Deserializer<'de>>(value: D) -> Result<Vec<Haptic>, D::Error> {
    use serde::de::Error;
    let one = |value: Value| -> Result<Vec<Haptic>, D::Error> {
        match value {
            Value::String(output) => Ok(vec![Haptic { output, ..Haptic::default() }]),
            Value::Table(mut table) => {
                let outputs = match table.remove("output") {
                    Some(Value::Array(outputs)) => outputs.into_iter().map(Some).collect(),
                    output => vec![output],
                };
                let with = |output: Option<Value>| {
                    let mut table = table.clone();
                    table.extend(output.map(|output| ("output".to_owned(), output)));
                    table.try_into().map_err(|error: toml::de::Error| Error::custom(error.message()))
                };
                outputs.into_iter().map(with).collect()
            }
            _ => Err(Error::custom("haptic must be a quantity, a table of one, or a list of them")),
        }
    };
    match Value::deserialize(value)? {
        Value::Array(values) => {
            Ok(values.into_iter().map(one).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
        }
        value => one(value),
    }
}

fn force_rate() -> f64 {
    1000.0
}

impl Default for Output {
    fn default() -> Self {
        Self {
            format: Format::Parquet,
            tail_s: 0.1,
            haptic: vec![Haptic::default()],
            force: None,
            audio: Audio::default(),
        }
    }
}

impl Default for Haptic {
    fn default() -> Self {
        Self {
            rate_hz: 8000.0,
            output: "displacement".to_owned(),
            full_scale: None,
            felt_force_exponent: None,
        }
    }
}

impl Default for Audio {
    fn default() -> Self {
        Self { rate_hz: 44_100.0, codec: Codec::F32, gain: None }
    }
}
