//! A glTF document: JSON with numbers in buffers beside it or inside it.

use crate::error::CliError;
use base64::Engine as _;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Largest file that is read, bytes.
const LARGEST: u64 = 1 << 30;

/// A document with its buffers.
pub struct Document {
    /// The JSON.
    pub json: Value,
    path: PathBuf,
    buffers: Vec<Vec<u8>>,
}

/// An accessor's numbers, one row after the other.
pub struct Rows {
    /// All of them.
    pub values: Vec<f64>,
}

impl Document {
    /// Reads `.gltf` and `.glb`.
    pub fn read(path: &Path) -> Result<Self, CliError> {
        let bytes = file(path)?;
        let (json, chunk) =
            if bytes.starts_with(b"glTF") { chunks(&bytes, path)? } else { (&bytes[..], None) };
        let json: Value = serde_json::from_slice(json).map_err(|error| {
            CliError::file(path, format!("is no glTF ({error})"), "must be .gltf or .glb of version 2")
        })?;
        if json["asset"]["version"].as_str().is_none_or(|version| !version.starts_with("2.")) {
            return Err(CliError::new(
                format!("{}: asset.version", path.display()),
                "is missing or unknown",
                "must be 2.x",
            ));
        }
        let mut document = Self { json, path: path.to_owned(), buffers: Vec::new() };
        let count = document.json["buffers"].as_array().map_or(0, Vec::len);
        for index in 0..count {
            let buffer = &document.json["buffers"][index];
            let bytes = match (buffer["uri"].as_str(), chunk) {
                (Some(uri), _) => document.fetched(uri, &format!("buffers[{index}].uri"))?,
                (None, Some(chunk)) if index == 0 => chunk.to_vec(),
                (None, _) => {
                    return Err(document.wrong(
                        format!("buffers[{index}]"),
                        "has no bytes",
                        "must have a uri",
                    ));
                }
            };
            document.buffers.push(bytes);
        }
        Ok(document)
    }

    /// An error at a place of the document.
    pub fn wrong(&self, at: impl std::fmt::Display, what: impl std::fmt::Display, right: &str) -> CliError {
        CliError::new(format!("{}: {at}", self.path.display()), what, right)
    }

    /// The bytes that a uri names: inside it, or in a file beside the document.
    fn fetched(&self, uri: &str, at: &str) -> Result<Vec<u8>, CliError> {
        if let Some((_, text)) = uri.strip_prefix("data:").and_then(|rest| rest.split_once(";base64,")) {
            return base64::engine::general_purpose::STANDARD.decode(text).map_err(|error| {
                self.wrong(at, format!("is no base64 ({error})"), "must be a data uri or a file's name")
            });
        }
        if uri.contains(':') || uri.starts_with('/') || uri.split('/').any(|part| part == "..") {
            return Err(self.wrong(
                at,
                "leads elsewhere",
                "must be a data uri or a file beside the document",
            ));
        }
        let beside = self.path.with_file_name(uri);
        crate::output::reads([&beside]);
        file(&beside)
    }

    fn view(&self, index: &Value, at: &str) -> Result<&[u8], CliError> {
        let wrong = || self.wrong(at, "lies outside its buffer", "must name a bufferView inside a buffer");
        let number = |value: &Value| value.as_u64().and_then(|n| usize::try_from(n).ok());
        let view = number(index).and_then(|i| self.json["bufferViews"].get(i)).ok_or_else(wrong)?;
        let buffer = number(&view["buffer"]).and_then(|i| self.buffers.get(i)).ok_or_else(wrong)?;
        let offset = number(&view["byteOffset"]).unwrap_or(0);
        let end =
            number(&view["byteLength"]).and_then(|length| offset.checked_add(length)).ok_or_else(wrong)?;
        buffer.get(offset..end).ok_or_else(wrong)
    }

    /// The numbers of an accessor of the type that is wanted.
    pub fn accessor(&self, index: &Value, kind: &str, at: &str) -> Result<Rows, CliError> {
        let wrong = |what: String, right: &str| self.wrong(at, what, right);
        let accessor = index.as_u64().and_then(|i| self.json["accessors"].get(i as usize));
        let accessor =
            accessor.ok_or_else(|| wrong(format!("{index} is no accessor"), "must be the index of one"))?;
        if accessor["type"].as_str() != Some(kind) || !accessor["sparse"].is_null() {
            return Err(wrong(
                format!("is {}", accessor["type"]),
                "must be plain numbers of the type the draft wants",
            ));
        }
        let width = if kind == "VEC3" { 3 } else { 1 };
        let size = match accessor["componentType"].as_u64() {
            Some(5126 | 5125) => 4,
            Some(5123) => 2,
            _ => {
                return Err(wrong(
                    "has another component type".to_owned(),
                    "must be FLOAT, UNSIGNED_INT or UNSIGNED_SHORT",
                ));
            }
        };
        let bytes = self.view(&accessor["bufferView"], at)?;
        let offset = accessor["byteOffset"].as_u64().unwrap_or(0) as usize;
        let stride =
            self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap_or(0) as usize]["byteStride"]
                .as_u64()
                .map_or(width * size, |stride| stride as usize);
        let count = accessor["count"].as_u64().unwrap_or(0) as usize;
        let needed = count
            .checked_sub(1)
            .and_then(|n| n.checked_mul(stride))
            .map(|n| n.saturating_add(width * size).saturating_add(offset));
        if needed.is_none_or(|needed| needed > bytes.len()) {
            return Err(wrong(format!("counts {count}"), "must be at least 1 and lie inside its bufferView"));
        }
        let float = accessor["componentType"].as_u64() == Some(5126);
        let values: Vec<f64> = (0..count)
            .flat_map(|row| (0..width).map(move |column| offset + row * stride + column * size))
            .map(|at| {
                let mut word = [0; 4];
                word[..size].copy_from_slice(&bytes[at..at + size]);
                if float { f64::from(f32::from_le_bytes(word)) } else { f64::from(u32::from_le_bytes(word)) }
            })
            .collect();
        if values.iter().any(|x| !x.is_finite()) {
            return Err(wrong("holds a number that is not finite".to_owned(), "must be finite"));
        }
        Ok(Rows { values })
    }

    /// The bytes of the picture of a texture.
    pub fn picture(&self, texture: &Value, at: &str) -> Result<Vec<u8>, CliError> {
        let wrong =
            || self.wrong(at, "names no picture", "must be the index of a texture whose source is an image");
        let texture =
            texture.as_u64().and_then(|i| self.json["textures"].get(i as usize)).ok_or_else(wrong)?;
        let image =
            texture["source"].as_u64().and_then(|i| self.json["images"].get(i as usize)).ok_or_else(wrong)?;
        match image["uri"].as_str() {
            Some(uri) => self.fetched(uri, at),
            None => self.view(&image["bufferView"], at).map(<[u8]>::to_vec),
        }
    }
}

impl Rows {
    /// Rows of three.
    pub fn triples(&self) -> Vec<[f64; 3]> {
        self.values.chunks_exact(3).map(|row| [row[0], row[1], row[2]]).collect()
    }
}

fn file(path: &Path) -> Result<Vec<u8>, CliError> {
    let length = std::fs::metadata(path).map_err(|error| CliError::read(path, &error))?.len();
    if length > LARGEST {
        return Err(CliError::file(path, format!("has {length} bytes"), "must be at most 1 GiB"));
    }
    std::fs::read(path).map_err(|error| CliError::read(path, &error))
}

/// JSON and binary chunk of a `.glb`.
fn chunks<'a>(bytes: &'a [u8], path: &Path) -> Result<(&'a [u8], Option<&'a [u8]>), CliError> {
    let wrong = || CliError::file(path, "is a broken .glb", "must have a JSON chunk and a binary one");
    let chunk = |from: usize| {
        let head = bytes.get(from..from + 8)?;
        let length = u32::from_le_bytes(head[..4].try_into().ok()?) as usize;
        Some((bytes.get(from + 8..from.checked_add(8)?.checked_add(length)?)?, from + 8 + length))
    };
    let (json, next) = chunk(12).ok_or_else(wrong)?;
    Ok((json, chunk(next).map(|(binary, _)| binary)))
}
