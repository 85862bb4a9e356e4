//! Sources of a scene: its text, its arrays and modes files in memory, everything else on the disk.

use crate::error::refused;
use crate::pictures;
use asperity::files::contact_log::ContactLog;
use asperity::files::{Disk, Files, Memory};
use asperity::surface::picture::Picture;
use asperity::surface::solid_materials::SolidMaterial;
use asperity::{Integrator, Isa, Material, PROBE_PRESETS, Stock};
use pyo3::exceptions::PyFileNotFoundError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::borrow::Cow;
use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Files in memory before those on the disk; remembers the one that is nowhere.
pub struct Sources {
    memory: Memory,
    missing: Mutex<Option<PathBuf>>,
}

impl Sources {
    /// Bytes are files, arrays are pictures, by the path under which a scene names them.
    pub fn of(files: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut memory = Memory::new();
        for (path, file) in files.iter() {
            let path: String = path.extract()?;
            match file.cast::<PyBytes>() {
                Ok(bytes) => memory.add(&path, bytes.as_bytes()),
                Err(_) => memory.add_picture(&path, pictures::picture(&file)?),
            }
        }
        Ok(Self { memory, missing: Mutex::new(None) })
    }

    /// The engine's sentence: `FileNotFoundError` where it is about a file that is nowhere.
    pub fn told(&self, error: impl Display) -> PyErr {
        let missing = self.missing.lock().is_ok_and(|missing| missing.is_some());
        if missing { PyFileNotFoundError::new_err(error.to_string()) } else { refused(error) }
    }
}

impl Files for Sources {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let found = self.memory.read(path).or_else(|_| Disk.read(path));
        if let (Err(error), Ok(mut missing)) = (&found, self.missing.lock())
            && error.kind() == io::ErrorKind::NotFound
        {
            *missing = Some(path.to_owned());
        }
        found
    }

    fn picture(&self, path: &Path) -> Option<Cow<'_, Picture>> {
        self.memory.picture(path)
    }
}

/// The instruction set of a name.
pub fn kernel(name: Option<&str>) -> PyResult<Option<Isa>> {
    let known = Isa::ALL.map(Isa::name).join(", ");
    let find = |name| {
        Isa::from_name(name)
            .ok_or_else(|| refused(format!("kernel: \"{name}\" is unknown; must be one of: {known}")))
    };
    name.map(find).transpose()
}

/// The integrator of a name.
pub fn integrator(name: Option<&str>) -> PyResult<Option<Integrator>> {
    let known = Integrator::ALL.map(Integrator::name).join(", ");
    let find = |name| {
        Integrator::from_name(name)
            .ok_or_else(|| refused(format!("integrator: \"{name}\" is unknown; must be one of: {known}")))
    };
    name.map(find).transpose()
}

/// The TOML text of a JSON object: how a scene made in Python becomes a scene file.
#[pyfunction]
pub fn as_toml(json: &str) -> PyResult<String> {
    let value: toml::Value = serde_json::from_str(json).map_err(refused)?;
    toml::to_string(&value).map_err(refused)
}

/// Reads a contact log as strictly as the engine does; returns the keys that are read past.
#[pyfunction]
pub fn parse_log(text: &str, name: &str) -> PyResult<Vec<String>> {
    ContactLog::parse_telling(text, name).map(|(_, unread)| unread).map_err(refused)
}

/// Every name of a kind: "material", "solid", "stock", "probe", "kernel" or "integrator".
#[pyfunction]
pub fn names_of(kind: &str) -> PyResult<Vec<&'static str>> {
    Ok(match kind {
        "material" => Material::PRESETS.iter().map(|preset| preset.name).collect(),
        "solid" => SolidMaterial::all().map(SolidMaterial::name).chain(["grating"]).collect(),
        "stock" => Stock::ALL.iter().map(|(name, _)| *name).collect(),
        "probe" => PROBE_PRESETS.iter().map(|(name, _)| *name).collect(),
        "kernel" => Isa::ALL.map(Isa::name).to_vec(),
        "integrator" => Integrator::ALL.map(Integrator::name).to_vec(),
        other => return Err(refused(format!("kind: \"{other}\" is unknown"))),
    })
}
