//! Data sets of rendered touch: shards as pure functions of a specification and an index, made in
//! the process that asks.

use crate::error::{refused, refused_at};
use crate::interrupt::Pulse;
use asperity_batch::manifest::Manifest;
use asperity_batch::{DataSet, Outcome, Spec};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// A data set that is being made. One shard at a time: who makes several at once opens it as often.
#[pyclass(frozen, module = "asperity._native")]
pub struct NativeDataSet {
    set: Mutex<DataSet>,
    shards: u64,
    strokes: u64,
    per_shard: u64,
    name: String,
}

#[pymethods]
impl NativeDataSet {
    /// Opens a folder for the text of a specification that lies, or lay, at `path`.
    #[new]
    fn new(py: Python<'_>, text: String, path: PathBuf, folder: PathBuf) -> PyResult<Self> {
        let spec = Spec::parse(text, &path).map_err(refused)?;
        let (shards, says) = (spec.shards(), &spec.says);
        let (strokes, per_shard, name) = (says.strokes, says.per_shard, says.name.clone());
        let set = py.detach(|| DataSet::open(spec, &folder)).map_err(refused)?;
        Ok(Self { set: Mutex::new(set), shards, strokes, per_shard, name })
    }

    #[getter]
    fn shards(&self) -> u64 {
        self.shards
    }

    #[getter]
    fn strokes(&self) -> u64 {
        self.strokes
    }

    #[getter]
    fn per_shard(&self) -> u64 {
        self.per_shard
    }

    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Makes a shard unless it is there: its file, whether it was made, its strokes, and the
    /// samples that 16 bits have cut off.
    #[pyo3(signature = (index, *, progress=None))]
    fn shard(
        &self,
        py: Python<'_>,
        index: u64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(String, bool, u64, u64)> {
        if index >= self.shards {
            let right = self.shards - 1;
            return Err(refused(format!("index: {index} is refused; must be 0 to {right}")));
        }
        let strokes = self.per_shard.min(self.strokes - index * self.per_shard);
        let pulse = Pulse::new(progress);
        let (file, outcome) = py.detach(|| {
            // Work that Ctrl-C has left by unwinding has changed nothing in here.
            let set = self.set.lock().unwrap_or_else(PoisonError::into_inner);
            let made = pulse.run(|tell| {
                let mut done = 0;
                set.shard(index, &mut || {
                    done += 1;
                    tell(done as f64 / strokes as f64);
                })
            });
            made.map(|outcome| (set.file(index), outcome))
        })?;
        Ok(match outcome.map_err(refused)? {
            Outcome::Made { clipped } => (file, true, strokes, clipped),
            Outcome::Kept => (file, false, strokes, 0),
        })
    }

    /// Writes `manifest.json` with every shard that is there; its text.
    fn write_manifest(&self, py: Python<'_>) -> PyResult<String> {
        let manifest = py.detach(|| self.set.lock().unwrap_or_else(PoisonError::into_inner).write_manifest());
        serde_json::to_string(&manifest.map_err(refused)?).map_err(refused)
    }
}

/// Compares every shard with the manifest and renders a share of the strokes again: shards, strokes
/// rendered, shards missing.
#[pyfunction]
#[pyo3(signature = (folder, sample, *, progress=None))]
pub fn verify(
    py: Python<'_>,
    folder: PathBuf,
    sample: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<(u64, u64, u64)> {
    if !(0.0..=1.0).contains(&sample) {
        return Err(refused(format!("sample: {sample} is refused; must be 0 to 1")));
    }
    let at = |error| refused_at(&folder.join(asperity_batch::manifest::NAME), error);
    let shards = Manifest::load(&folder).map_err(at)?.map_or(0, |manifest| manifest.shards.len());
    let pulse = Pulse::new(progress);
    let found = py.detach(|| {
        pulse.run(|tell| {
            let mut done = 0;
            asperity_batch::verify(&folder, sample, &mut || {
                done += 1;
                tell(done as f64 / shards.max(1) as f64);
            })
        })
    })?;
    found.map(|found| (found.shards, found.rendered, found.missing)).map_err(at)
}

/// Names this build; a shard that says it was made by another is refused by `shard`.
#[pyfunction]
pub fn build<'py>(py: Python<'py>, text: String, path: PathBuf) -> PyResult<Bound<'py, PyDict>> {
    let build = asperity_batch::Build::of(&Spec::parse(text, &path).map_err(refused)?);
    let told = PyDict::new(py);
    for (name, value) in [
        ("spec_sha256", build.spec_sha256),
        ("version", build.version),
        ("kernel", build.kernel),
        ("target", build.target),
    ] {
        told.set_item(name, value)?;
    }
    Ok(told)
}
