//! Refusals in the engine's own sentences, as Python's exceptions.

use pyo3::PyErr;
use pyo3::exceptions::{PyFileNotFoundError, PyValueError};
use std::fmt::Display;
use std::path::Path;

/// `ValueError`, in the engine's words.
pub fn refused(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// `FileNotFoundError` where that file is missing, `ValueError` otherwise.
pub fn refused_at(path: &Path, error: impl Display) -> PyErr {
    if path.exists() { refused(error) } else { PyFileNotFoundError::new_err(error.to_string()) }
}
