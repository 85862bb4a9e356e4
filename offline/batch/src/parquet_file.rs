//! Parquet shards: a table, one row a stroke.
//!
//! | column | type |
//! |---|---|
//! | `id`, `split`, `surface` | text |
//! | `speed_m_s`, `force_n`, `duration_s` | double |
//! | `audio` | list of float, or bytes of a FLAC file |
//! | `haptic`, and `haptic_QUANTITY` of further ones | list of float |
//! | the columns of [`crate::force`], where they are kept | list of double |
//! | `contacts`, `scene` | text |
//!
//! The file's key–value metadata hold the build, rates and levels.

use crate::build::Build;
use crate::codec::Codec;
use crate::force::{COLUMNS, ForceTable};
use crate::record::{Record, Samples, Sound};
use crate::spec::{Haptic, Output};
use asperity::files::FileError;
use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, FloatType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::record::RowAccessor;
use parquet::schema::parser::parse_message_type;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

/// Rows a row group: what is held in memory until it is written.
const ROWS: usize = 64;
/// Key of the build among the file's metadata.
const BUILD: &str = "asperity.build";

/// Writes a shard row by row.
#[derive(Debug)]
pub struct Shard<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    rows: Vec<Record>,
}

impl<W: Write + Send> Shard<W> {
    /// Begins a shard. `more` stands among the file's metadata.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn begin(
        out: W,
        build: &Build,
        output: &Output,
        more: &[(String, String)],
    ) -> Result<Self, ParquetError> {
        let schema = parse_message_type(&schema(output))?;
        let mut metadata = vec![KeyValue::new(BUILD.to_owned(), serde_json::to_string(build).ok())];
        metadata
            .extend(more.iter().map(|(key, value)| KeyValue::new(format!("asperity.{key}"), value.clone())));
        let properties = WriterProperties::builder()
            .set_created_by(format!("asperity {}", build.version))
            .set_compression(Compression::UNCOMPRESSED)
            // Samples never repeat: a dictionary of them is a copy.
            .set_dictionary_enabled(false)
            .set_key_value_metadata(Some(metadata))
            .build();
        let writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))?;
        Ok(Self { writer, rows: Vec::with_capacity(ROWS) })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn add(&mut self, record: Record) -> Result<(), ParquetError> {
        self.rows.push(record);
        if self.rows.len() == ROWS { self.flush() } else { Ok(()) }
    }

    /// Ends the file.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn finish(mut self) -> Result<W, ParquetError> {
        self.flush()?;
        self.writer.into_inner()
    }

    fn flush(&mut self) -> Result<(), ParquetError> {
        if self.rows.is_empty() {
            return Ok(());
        }
        let rows = std::mem::take(&mut self.rows);
        let mut group = self.writer.next_row_group()?;
        texts(&mut group, &rows, |row| &row.stroke.id)?;
        texts(&mut group, &rows, |row| row.stroke.split)?;
        texts(&mut group, &rows, |row| &row.stroke.surface)?;
        numbers(&mut group, &rows, |row| row.stroke.motion.speed_m_s)?;
        numbers(&mut group, &rows, |row| row.stroke.motion.force_n)?;
        numbers(&mut group, &rows, |row| row.stroke.motion.duration_s)?;
        match &rows[0].samples.audio {
            Sound::F32(_) => lists::<FloatType, W>(&mut group, &rows, |row| match &row.samples.audio {
                Sound::F32(samples) => samples,
                Sound::Flac(_) => &[],
            })?,
            Sound::Flac(_) => bytes(&mut group, &rows, |row| match &row.samples.audio {
                Sound::Flac(file) => file,
                Sound::F32(_) => &[],
            })?,
        }
        lists::<FloatType, W>(&mut group, &rows, |row| &row.samples.haptic)?;
        for place in 0..rows[0].samples.further.len() {
            lists::<FloatType, W>(&mut group, &rows, |row| &row.samples.further[place])?;
        }
        for place in 0..rows[0].samples.force.as_ref().map_or(0, |force| force.len()) {
            lists::<DoubleType, W>(&mut group, &rows, |row| {
                row.samples.force.as_ref().map_or(&[], |force| &force[place])
            })?;
        }
        texts(&mut group, &rows, |row| &row.stroke.contacts)?;
        texts(&mut group, &rows, |row| &row.stroke.scene)?;
        group.close()?;
        Ok(())
    }
}

fn schema(output: &Output) -> String {
    let list = |kind: &str, name: &str| {
        format!("REQUIRED GROUP {name} (LIST) {{ REPEATED GROUP list {{ REQUIRED {kind} element; }} }} ")
    };
    let further = output.haptic[1..].iter().map(|haptic| list("FLOAT", &haptic.further_column()));
    let force = output.force.iter().flat_map(|_| COLUMNS).map(|name| list("DOUBLE", name));
    let felt: String = std::iter::once(list("FLOAT", "haptic")).chain(further).chain(force).collect();
    let audio = match output.audio.codec {
        Codec::F32 => list("FLOAT", "audio"),
        Codec::Flac16 => "REQUIRED BYTE_ARRAY audio;".to_owned(),
    };
    format!(
        "message stroke {{ REQUIRED BYTE_ARRAY id (UTF8); REQUIRED BYTE_ARRAY split (UTF8); REQUIRED BYTE_ARRAY surface (UTF8); \
         REQUIRED DOUBLE speed_m_s; REQUIRED DOUBLE force_n; REQUIRED DOUBLE duration_s; {audio} {felt}\
         REQUIRED BYTE_ARRAY contacts (UTF8); REQUIRED BYTE_ARRAY scene (UTF8); }}"
    )
}

type Group<'a, W> = SerializedRowGroupWriter<'a, W>;

fn bytes<W: Write + Send>(
    group: &mut Group<'_, W>,
    rows: &[Record],
    of: impl Fn(&Record) -> &[u8],
) -> Result<(), ParquetError> {
    let values: Vec<ByteArray> = rows.iter().map(|row| ByteArray::from(of(row).to_vec())).collect();
    let mut column = next(group)?;
    column.typed::<ByteArrayType>().write_batch(&values, None, None)?;
    column.close()
}

fn texts<W: Write + Send>(
    group: &mut Group<'_, W>,
    rows: &[Record],
    of: impl Fn(&Record) -> &str,
) -> Result<(), ParquetError> {
    bytes(group, rows, |row| of(row).as_bytes())
}

fn numbers<W: Write + Send>(
    group: &mut Group<'_, W>,
    rows: &[Record],
    of: impl Fn(&Record) -> f64,
) -> Result<(), ParquetError> {
    let values: Vec<f64> = rows.iter().map(of).collect();
    let mut column = next(group)?;
    column.typed::<DoubleType>().write_batch(&values, None, None)?;
    column.close()
}

/// Lists are written as one column of samples, with the places where a row begins: repetition 0.
/// Definition 0 is an empty list.
fn lists<T: DataType, W: Write + Send>(
    group: &mut Group<'_, W>,
    rows: &[Record],
    of: impl Fn(&Record) -> &[T::T],
) -> Result<(), ParquetError> {
    let mut column = next(group)?;
    for row in rows {
        let samples = of(row);
        let (definitions, repetitions) = if samples.is_empty() {
            (vec![0], vec![0])
        } else {
            (vec![1; samples.len()], (0..samples.len()).map(|i| i16::from(i > 0)).collect::<Vec<_>>())
        };
        column.typed::<T>().write_batch(samples, Some(&definitions), Some(&repetitions))?;
    }
    column.close()
}

fn next<'a, W: Write + Send>(
    group: &'a mut Group<'_, W>,
) -> Result<parquet::file::writer::SerializedColumnWriter<'a>, ParquetError> {
    group
        .next_column()?
        .ok_or_else(|| ParquetError::General("the schema has fewer columns than a record".into()))
}

fn reader(path: &Path) -> Result<SerializedFileReader<File>, FileError> {
    let file = File::open(path).map_err(|error| FileError::read(path, &error))?;
    SerializedFileReader::new(file).map_err(|error| {
        FileError::file(path, format!("is no whole Parquet file ({error})"), "remove it and make it again")
    })
}

/// Build that made a shard, and its number of strokes.
///
/// # Errors
/// When it is no whole shard of ours.
pub fn build_of(path: &Path) -> Result<(Build, u64), FileError> {
    let reader = reader(path)?;
    let metadata = reader.metadata().file_metadata();
    let build = metadata.key_value_metadata().into_iter().flatten().find(|entry| entry.key == BUILD);
    let build = build.and_then(|entry| serde_json::from_str(entry.value.as_deref()?).ok());
    let build = build
        .ok_or_else(|| FileError::file(path, "does not say what made it", "remove it and make it again"))?;
    Ok((build, metadata.num_rows().unsigned_abs()))
}

/// Part of a record that is compared when it is rendered again.
#[derive(Debug, Clone, PartialEq)]
pub struct Kept {
    /// The stroke's number.
    pub id: String,
    /// Scene file.
    pub scene: String,
    /// Contact log.
    pub contacts: String,
    /// Audio and haptics.
    pub samples: Samples,
}

/// Reads the records of a shard whose number in it `wanted` says yes to.
///
/// # Errors
/// When it is no whole shard of ours.
pub fn records(
    path: &Path,
    further: &[Haptic],
    wanted: &dyn Fn(u64) -> bool,
) -> Result<Vec<Kept>, FileError> {
    let reader = reader(path)?;
    let broken = |error: ParquetError| {
        FileError::file(path, format!("cannot be read ({error})"), "remove it and make it again")
    };
    let rows = reader.get_row_iter(None).map_err(broken)?;
    let mut kept = Vec::new();
    for (number, row) in rows.enumerate() {
        let row = row.map_err(broken)?;
        if wanted(number as u64) {
            kept.push(kept_of(&row, further).map_err(broken)?);
        }
    }
    Ok(kept)
}

fn kept_of(row: &parquet::record::Row, further: &[Haptic]) -> Result<Kept, ParquetError> {
    let place =
        |name: &str| row.get_column_iter().position(|(column, _)| column == name).unwrap_or(usize::MAX);
    let text = |name: &str| row.get_string(place(name)).cloned();
    let samples = |name: &str| -> Result<Vec<f32>, ParquetError> {
        let list = row.get_list(place(name))?;
        list.elements()
            .iter()
            .map(|field| match field {
                parquet::record::Field::Float(sample) => Ok(*sample),
                other => Err(ParquetError::General(format!("{name} holds {other}, no sample"))),
            })
            .collect()
    };
    let audio = match row.get_bytes(place("audio")) {
        Ok(bytes) => Sound::Flac(bytes.data().to_vec()),
        Err(_) => Sound::F32(samples("audio")?),
    };
    let numbers = |name: &str| -> Result<Vec<f64>, ParquetError> {
        let list = row.get_list(place(name))?;
        list.elements()
            .iter()
            .map(|field| match field {
                parquet::record::Field::Double(number) => Ok(*number),
                other => Err(ParquetError::General(format!("{name} holds {other}, no number"))),
            })
            .collect()
    };
    let mut force = None;
    if place(COLUMNS[0]) < usize::MAX {
        let table = force.insert(ForceTable::default());
        for (column, name) in table.iter_mut().zip(COLUMNS) {
            *column = numbers(name)?;
        }
    }
    let further: Result<_, ParquetError> =
        further.iter().map(|haptic| samples(&haptic.further_column())).collect();
    let samples = Samples { audio, haptic: samples("haptic")?, further: further?, force, clipped: 0 };
    Ok(Kept { id: text("id")?, scene: text("scene")?, contacts: text("contacts")?, samples })
}
