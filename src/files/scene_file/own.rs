//! `own = { kind = "NAME", … }`: a source from outside the engine, made by the program that opens
//! the scene.

use super::fields::Fields;
use crate::files::FileError;
use asperity_surface::height_field::HeightField;
use serde::de::DeserializeOwned;
use toml::{Table, Value};

/// Table of a scene for a source of somebody's own.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnSource {
    /// Which one.
    pub kind: String,
    table: Table,
}

/// Makes the sources of one kind from what a scene says, for a surface of so many metres along u
/// and v.
///
/// A function: it captures nothing. What it makes is steered with
/// [`Scene::change_surface`](crate::Scene::change_surface), by the id that
/// [`Engine::names`](crate::Engine) holds; a source that is to hold a handle of its own (an `Arc`)
/// is added in code, by `Surface::new`. It may be called more than once for a surface: where a
/// scene leaves levels out, reference strokes touch a copy.
pub type MakeSource = fn(&OwnSource, [f64; 2]) -> Result<Box<dyn HeightField>, FileError>;

impl OwnSource {
    /// Keys beside `kind`, as plain data; let `T` refuse unknown fields.
    ///
    /// # Errors
    /// When a key is missing, unknown or of another type.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, FileError> {
        Value::Table(self.table.clone()).try_into().map_err(|error: toml::de::Error| {
            let right = format!("write what a {} is made of", self.kind);
            FileError::new(format!("own: {}", self.kind), error.message(), right)
        })
    }

    /// The source, by the maker of its kind.
    pub(crate) fn make(
        &self,
        makers: &[(&str, MakeSource)],
        size_m: [f64; 2],
    ) -> Result<Box<dyn HeightField>, FileError> {
        match makers.iter().find(|(kind, _)| *kind == self.kind) {
            Some((_, make)) => make(self, size_m),
            None => {
                let known: Vec<&str> = makers.iter().map(|(kind, _)| *kind).collect();
                let right = match known.as_slice() {
                    [] => "open the scene with the program that has it".to_owned(),
                    known => format!("must be one of: {}", known.join(", ")),
                };
                Err(FileError::new("own: kind", format!("\"{}\" is unknown", self.kind), right))
            }
        }
    }
}

/// Reads the table.
pub(super) fn read(mut fields: Fields) -> Result<OwnSource, FileError> {
    let kind = fields.needed_text("kind")?;
    Ok(OwnSource { kind, table: fields.rest() })
}
