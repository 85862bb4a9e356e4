//! WebDataset shards: a tar file, and in it files of one name a stroke.
//!
//! `ID.json` (split, surface, what was drawn, rates, levels, build), `ID.audio.npy` or
//! `ID.audio.flac`, `ID.haptic.npy` and `ID.haptic_QUANTITY.npy`, `ID.force.npy` (rows by columns
//! of [`crate::force`]), `ID.contacts.jsonl`, `ID.scene.toml`.

use crate::build::Build;
use crate::force::ForceTable;
use crate::parquet_file::Kept;
use crate::record::{Record, Samples, Sound};
use crate::spec::Haptic;
use asperity::files::FileError;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

/// Writes a shard stroke by stroke.
pub struct Shard<W: Write> {
    tar: tar::Builder<W>,
    build: Value,
    more: Vec<(String, String)>,
}

impl<W: Write> std::fmt::Debug for Shard<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shard").field("build", &self.build).finish_non_exhaustive()
    }
}

impl<W: Write> Shard<W> {
    /// Begins a shard. `more` stands in every record.
    pub fn begin(out: W, build: &Build, more: &[(String, String)]) -> Self {
        let build = serde_json::to_value(build).unwrap_or_default();
        Self { tar: tar::Builder::new(out), build, more: more.to_vec() }
    }

    /// Adds a stroke.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn add(&mut self, record: &Record, further: &[Haptic]) -> io::Result<()> {
        let stroke = &record.stroke;
        let mut about = json!({
            "id": stroke.id,
            "split": stroke.split,
            "surface": stroke.surface,
            "speed_m_s": stroke.motion.speed_m_s,
            "force_n": stroke.motion.force_n,
            "duration_s": stroke.motion.duration_s,
            "build": self.build,
        });
        for (key, value) in &self.more {
            about[key] = serde_json::from_str(value).unwrap_or_else(|_| Value::String(value.clone()));
        }
        self.file(&stroke.id, "json", about.to_string().as_bytes())?;
        match &record.samples.audio {
            Sound::F32(samples) => self.file(&stroke.id, "audio.npy", &npy(samples))?,
            Sound::Flac(bytes) => self.file(&stroke.id, "audio.flac", bytes)?,
        }
        self.file(&stroke.id, "haptic.npy", &npy(&record.samples.haptic))?;
        for (haptic, samples) in further.iter().zip(&record.samples.further) {
            self.file(&stroke.id, &format!("{}.npy", haptic.further_column()), &npy(samples))?;
        }
        if let Some(force) = &record.samples.force {
            self.file(&stroke.id, "force.npy", &npy_of_table(force))?;
        }
        self.file(&stroke.id, "contacts.jsonl", stroke.contacts.as_bytes())?;
        self.file(&stroke.id, "scene.toml", stroke.scene.as_bytes())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn finish(self) -> io::Result<W> {
        self.tar.into_inner()
    }

    fn file(&mut self, id: &str, kind: &str, bytes: &[u8]) -> io::Result<()> {
        // No owner, no time: the same bytes on any machine, at any time.
        let mut header = tar::Header::new_ustar();
        header.set_size(bytes.len() as u64);
        header.set_mode(0o644);
        header.set_mtime(0);
        header.set_uid(0);
        header.set_gid(0);
        self.tar.append_data(&mut header, format!("{id}.{kind}"), bytes)
    }
}

/// Samples as a file of numpy's format.
fn npy(samples: &[f32]) -> Vec<u8> {
    let mut bytes = npy_head("<f4", &format!("({},)", samples.len()));
    bytes.extend(samples.iter().flat_map(|sample| sample.to_le_bytes()));
    bytes
}

/// Rows by columns.
fn npy_of_table(table: &ForceTable) -> Vec<u8> {
    let rows = table[0].len();
    let mut bytes = npy_head("<f8", &format!("({rows}, {})", table.len()));
    let row = |row: usize| table.iter().flat_map(move |column| column[row].to_le_bytes());
    bytes.extend((0..rows).flat_map(row));
    bytes
}

fn table_of(bytes: &[u8]) -> Option<ForceTable> {
    let length = usize::from(u16::from_le_bytes(bytes.get(8..10)?.try_into().ok()?));
    let (numbers, rest) = bytes.get(10 + length..)?.as_chunks::<8>();
    let mut table = ForceTable::default();
    for row in numbers.chunks(table.len()) {
        table.iter_mut().zip(row).for_each(|(column, eight)| column.push(f64::from_le_bytes(*eight)));
    }
    rest.is_empty().then_some(table)
}

/// The head of a file of numpy's format, version 1.0.
fn npy_head(kind: &str, shape: &str) -> Vec<u8> {
    let head = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    // Magic, version and length take ten bytes; the whole head is a multiple of 64 long and ends a
    // line.
    let padded = (10 + head.len() + 1).next_multiple_of(64) - 10;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((padded as u16).to_le_bytes());
    bytes.extend(head.as_bytes());
    bytes.resize(10 + padded - 1, b' ');
    bytes.push(b'\n');
    bytes
}

fn samples_of(bytes: &[u8]) -> Option<Vec<f32>> {
    let length = usize::from(u16::from_le_bytes(bytes.get(8..10)?.try_into().ok()?));
    let (samples, rest) = bytes.get(10 + length..)?.as_chunks::<4>();
    rest.is_empty().then(|| samples.iter().map(|four| f32::from_le_bytes(*four)).collect())
}

type Files = BTreeMap<String, Vec<u8>>;

/// Calls `each` with the number and the files of every stroke of a shard, by what stands after the
/// id.
fn for_each(
    path: &Path,
    mut each: impl FnMut(u64, &str, Files) -> Result<(), FileError>,
) -> Result<u64, FileError> {
    let broken = |error: io::Error| {
        FileError::file(path, format!("is no whole tar file ({error})"), "remove it and make it again")
    };
    let file = File::open(path).map_err(|error| FileError::read(path, &error))?;
    let mut archive = tar::Archive::new(io::BufReader::with_capacity(1 << 18, file));
    let (mut number, mut id, mut files) = (0, String::new(), Files::new());
    for entry in archive.entries().map_err(broken)? {
        let mut entry = entry.map_err(broken)?;
        let name = entry.path().map_err(broken)?.to_string_lossy().into_owned();
        let (of, kind) = name.split_once('.').unwrap_or((&name, ""));
        if of != id && !files.is_empty() {
            each(number, &id, std::mem::take(&mut files))?;
            number += 1;
        }
        of.clone_into(&mut id);
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).map_err(broken)?;
        files.insert(kind.to_owned(), bytes);
    }
    if !files.is_empty() {
        each(number, &id, files)?;
        number += 1;
    }
    Ok(number)
}

/// Build that made a shard, and its number of strokes.
///
/// # Errors
/// When it is no whole shard of ours.
pub fn build_of(path: &Path) -> Result<(Build, u64), FileError> {
    let mut build = None;
    let count = for_each(path, |_, _, files| {
        if build.is_none() {
            let about = files.get("json").and_then(|bytes| serde_json::from_slice::<Value>(bytes).ok());
            build = about.and_then(|about| serde_json::from_value(about["build"].clone()).ok());
        }
        Ok(())
    })?;
    let build = build
        .ok_or_else(|| FileError::file(path, "does not say what made it", "remove it and make it again"))?;
    Ok((build, count))
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
    let mut kept = Vec::new();
    for_each(path, |number, id, files| {
        if wanted(number) {
            let record = kept_of(id, files, further);
            kept.push(record.ok_or_else(|| {
                FileError::file(path, format!("stroke {id} is not whole"), "remove it and make it again")
            })?);
        }
        Ok(())
    })?;
    Ok(kept)
}

fn kept_of(id: &str, mut files: Files, further: &[Haptic]) -> Option<Kept> {
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).ok();
    let audio = match files.remove("audio.flac") {
        Some(bytes) => Sound::Flac(bytes),
        None => Sound::F32(samples_of(files.get("audio.npy")?)?),
    };
    Some(Kept {
        id: id.to_owned(),
        scene: text(files.remove("scene.toml")?)?,
        contacts: text(files.remove("contacts.jsonl")?)?,
        samples: Samples {
            audio,
            haptic: samples_of(files.get("haptic.npy")?)?,
            further: further
                .iter()
                .map(|haptic| samples_of(files.get(&format!("{}.npy", haptic.further_column()))?))
                .collect::<Option<_>>()?,
            force: match files.get("force.npy") {
                Some(bytes) => Some(table_of(bytes)?),
                None => None,
            },
            clipped: 0,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_in_numpys_format_come_back() {
        for count in [0, 1, 7, 4410] {
            let samples: Vec<f32> = (0..count).map(|i| (i as f32).sin()).collect();
            let bytes = npy(&samples);
            assert_eq!((bytes.len() - 4 * count) % 64, 0);
            assert_eq!(samples_of(&bytes).unwrap(), samples);
        }
    }
}
