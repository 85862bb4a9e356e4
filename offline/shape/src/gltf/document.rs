//! A glTF document: JSON with numbers in buffers beside it or inside it.

use crate::error::ShapeError;
use base64::Engine as _;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Largest file that is read, bytes.
const LARGEST: u64 = 1 << 30;
/// Most rows of an accessor that has no buffer: zeros but for its sparse rows.
const MOST_SPARSE: u64 = 3 * crate::surface_mesh::MOST_TRIANGLES as u64;

/// A document with its buffers.
#[derive(Debug)]
pub struct Document {
    /// The JSON.
    pub json: Value,
    path: PathBuf,
    buffers: Vec<Vec<u8>>,
}

/// An accessor's numbers, one row after the other.
#[derive(Debug)]
pub struct Rows {
    /// All of them.
    pub values: Vec<f64>,
}

impl Document {
    /// Reads `.gltf` and `.glb`.
    ///
    /// # Errors
    /// When the file or one it names cannot be read, or it is no glTF of version 2.
    pub fn read(path: &Path) -> Result<Self, ShapeError> {
        Self::parse(path, &file(path)?)
    }

    /// Reads a document that was loaded already; files that it names lie beside `path`.
    ///
    /// # Errors
    /// Those of [`Document::read`].
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, ShapeError> {
        let (json, chunk) = if bytes.starts_with(b"glTF") { chunks(bytes, path)? } else { (bytes, None) };
        let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
        let json: Value = serde_json::from_slice(json).map_err(|error| {
            at_file(path, format!("is no glTF ({error})"), "must be .gltf or .glb of version 2")
        })?;
        if json["asset"]["version"].as_str().is_none_or(|version| !version.starts_with("2.")) {
            return Err(ShapeError::new(
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
    pub fn wrong(&self, at: impl std::fmt::Display, what: impl std::fmt::Display, right: &str) -> ShapeError {
        ShapeError::new(format!("{}: {at}", self.path.display()), what.to_string(), right)
    }

    /// A list of the document; empty where it has none.
    #[must_use]
    pub fn list(&self, key: &str) -> &[Value] {
        self.json[key].as_array().map_or(&[][..], Vec::as_slice)
    }

    /// Files beside the document that it names: buffers and pictures.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        let uris = ["buffers", "images"].into_iter().flat_map(|key| self.list(key));
        let names = uris.filter_map(|entry| entry["uri"].as_str()).filter(|uri| !uri.starts_with("data:"));
        names.map(|uri| self.path.with_file_name(percent_decoded(uri))).collect()
    }

    /// Positions are packed by an extension that is not read.
    #[must_use]
    pub fn is_packed(&self, primitive: &Value) -> bool {
        let meshopt = |accessor: &Value| {
            let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap_or(0) as usize];
            view["extensions"].as_object().is_some_and(|e| e.keys().any(|key| key.contains("meshopt")))
        };
        let accessor = primitive["attributes"]["POSITION"].as_u64();
        !primitive["extensions"]["KHR_draco_mesh_compression"].is_null()
            || accessor.is_some_and(|i| meshopt(&self.json["accessors"][i as usize]))
    }

    /// The bytes that a uri names: inside it, or in a file beside the document.
    fn fetched(&self, uri: &str, at: &str) -> Result<Vec<u8>, ShapeError> {
        if let Some((_, text)) = uri.strip_prefix("data:").and_then(|rest| rest.split_once(";base64,")) {
            return base64::engine::general_purpose::STANDARD.decode(text).map_err(|error| {
                self.wrong(at, format!("is no base64 ({error})"), "must be a data uri or a file's name")
            });
        }
        let uri = &percent_decoded(uri);
        if uri.contains(':') || uri.starts_with('/') || uri.split('/').any(|part| part == "..") {
            return Err(self.wrong(
                at,
                "leads elsewhere",
                "must be a data uri or a file beside the document",
            ));
        }
        file(&self.path.with_file_name(uri))
    }

    fn view(&self, index: &Value, at: &str) -> Result<&[u8], ShapeError> {
        let wrong = || self.wrong(at, "lies outside its buffer", "must name a bufferView inside a buffer");
        let number = |value: &Value| value.as_u64().and_then(|n| usize::try_from(n).ok());
        let view = number(index).and_then(|i| self.json["bufferViews"].get(i)).ok_or_else(wrong)?;
        let buffer = number(&view["buffer"]).and_then(|i| self.buffers.get(i)).ok_or_else(wrong)?;
        let offset = number(&view["byteOffset"]).unwrap_or(0);
        let end =
            number(&view["byteLength"]).and_then(|length| offset.checked_add(length)).ok_or_else(wrong)?;
        buffer.get(offset..end).ok_or_else(wrong)
    }

    /// The numbers of an accessor of the type that is wanted, sparse ones filled in.
    ///
    /// # Errors
    /// When there is none of that type, or it lies outside its buffer.
    pub fn accessor(&self, index: &Value, kind: &str, at: &str) -> Result<Rows, ShapeError> {
        let wrong = |what: String, right: &str| self.wrong(at, what, right);
        let accessor = index.as_u64().and_then(|i| self.json["accessors"].get(i as usize));
        let accessor =
            accessor.ok_or_else(|| wrong(format!("{index} is no accessor"), "must be the index of one"))?;
        if accessor["type"].as_str() != Some(kind) {
            return Err(wrong(
                format!("is {}", accessor["type"]),
                &format!("must be numbers of type {kind}"),
            ));
        }
        let width = match kind {
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 1,
        };
        let count = accessor["count"].as_u64().unwrap_or(0);
        let component = accessor["componentType"].as_u64().unwrap_or(0);
        let normalised = accessor["normalized"].as_bool() == Some(true);
        let sparse = &accessor["sparse"];
        let mut values = if accessor["bufferView"].is_null() && !sparse.is_null() {
            if count > MOST_SPARSE {
                return Err(wrong(format!("counts {count}"), &format!("must be at most {MOST_SPARSE}")));
            }
            vec![0.0; count as usize * width]
        } else {
            self.numbers(accessor, count, width, component, normalised, at)?
        };
        if !sparse.is_null() {
            let at = format!("{at}, sparse");
            let (indices, few) = (&sparse["indices"], sparse["count"].as_u64().unwrap_or(0));
            let kind = indices["componentType"].as_u64().unwrap_or(0);
            let rows = self.numbers(indices, few, 1, kind, false, &format!("{at} indices"))?;
            let written =
                self.numbers(&sparse["values"], few, width, component, normalised, &format!("{at} values"))?;
            for (row, new) in rows.iter().zip(written.chunks_exact(width)) {
                let first = *row as usize * width;
                let Some(old) = values.get_mut(first..first + width) else {
                    return Err(self.wrong(
                        &at,
                        format!("names row {row}"),
                        &format!("must be below {count}"),
                    ));
                };
                old.copy_from_slice(new);
            }
        }
        if values.iter().any(|x| !x.is_finite()) {
            return Err(wrong("holds a number that is not finite".to_owned(), "must be finite"));
        }
        Ok(Rows { values })
    }

    /// `count` rows of `width` numbers where an object with a `bufferView` says.
    fn numbers(
        &self,
        of: &Value,
        count: u64,
        width: usize,
        component: u64,
        normalised: bool,
        at: &str,
    ) -> Result<Vec<f64>, ShapeError> {
        let size = match component {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            5125 | 5126 => 4,
            _ => return Err(self.wrong(at, "has another component type", "must be one of glTF 2.0")),
        };
        let bytes = self.view(&of["bufferView"], at)?;
        let offset = of["byteOffset"].as_u64().unwrap_or(0) as usize;
        let stride = self.json["bufferViews"][of["bufferView"].as_u64().unwrap_or(0) as usize]["byteStride"]
            .as_u64()
            .map_or(width * size, |stride| stride as usize);
        let count = count as usize;
        let needed = count
            .checked_sub(1)
            .and_then(|n| n.checked_mul(stride))
            .map(|n| n.saturating_add(width * size).saturating_add(offset));
        if needed.is_none_or(|needed| needed > bytes.len()) {
            let right = "must be at least 1 and lie inside its bufferView";
            return Err(self.wrong(at, format!("counts {count}"), right));
        }
        let places =
            (0..count).flat_map(|row| (0..width).map(move |column| offset + row * stride + column * size));
        Ok(places.map(|at| number(&bytes[at..at + size], component, normalised)).collect())
    }

    /// The bytes of the picture of a texture.
    ///
    /// # Errors
    /// When the texture has no picture, or it cannot be read.
    pub fn picture(&self, texture: &Value, at: &str) -> Result<Vec<u8>, ShapeError> {
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
    #[must_use]
    pub fn triples(&self) -> Vec<[f64; 3]> {
        self.values.chunks_exact(3).map(|row| [row[0], row[1], row[2]]).collect()
    }
}

/// A number as it is written; a normalised integer as the part of its range that it is.
fn number(bytes: &[u8], component: u64, normalised: bool) -> f64 {
    let mut word = [0; 4];
    word[..bytes.len()].copy_from_slice(bytes);
    let bits = u32::from_le_bytes(word);
    let (value, most) = match component {
        5120 => (f64::from(bits as u8 as i8), 127.0),
        5121 => (f64::from(bits), 255.0),
        5122 => (f64::from(bits as u16 as i16), 32_767.0),
        5123 => (f64::from(bits), 65_535.0),
        5126 => return f64::from(f32::from_bits(bits)),
        _ => return f64::from(bits),
    };
    if normalised { (value / most).max(-1.0) } else { value }
}

/// `%20` is a space.
fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        let code = after.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()).filter(|_| *first == b'%') {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    String::from_utf8(bytes).unwrap_or_else(|_| uri.to_owned())
}

fn at_file(path: &Path, what: impl Into<String>, right: &str) -> ShapeError {
    ShapeError::new(path.display().to_string(), what, right)
}

fn file(path: &Path) -> Result<Vec<u8>, ShapeError> {
    let readable =
        |error: std::io::Error| at_file(path, format!("cannot be read ({error})"), "give a readable file");
    let found = std::fs::metadata(path).map_err(readable)?;
    // A pipe that a document names would be waited for without end.
    if !found.is_file() {
        return Err(at_file(path, "is no file", "give a readable file"));
    }
    let length = found.len();
    if length > LARGEST {
        return Err(at_file(path, format!("has {length} bytes"), "must be at most 1 GiB"));
    }
    std::fs::read(path).map_err(readable)
}

/// JSON and binary chunk of a `.glb`.
fn chunks<'a>(bytes: &'a [u8], path: &Path) -> Result<(&'a [u8], Option<&'a [u8]>), ShapeError> {
    let wrong = || at_file(path, "is a broken .glb", "must have a JSON chunk and a binary one");
    let chunk = |from: usize| {
        let head = bytes.get(from..from + 8)?;
        let length = u32::from_le_bytes(head[..4].try_into().ok()?) as usize;
        Some((bytes.get(from + 8..from.checked_add(8)?.checked_add(length)?)?, from + 8 + length))
    };
    let (json, next) = chunk(12).ok_or_else(wrong)?;
    Ok((json, chunk(next).map(|(binary, _)| binary)))
}
