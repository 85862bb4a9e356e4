//! The native half of the Python package `asperity`: whole tasks in, arrays out.
//!
//! Everything a Python scene is crosses the border as the files the program itself reads (a scene's
//! text, logs, modes files), with arrays as decoded pictures beside them, so that both say the same
//! and render the same bits. The Python half (`python/asperity`) gives it the shape that people
//! use.

#![allow(unsafe_code, reason = "pyo3's macros")]
#![warn(missing_docs)]

mod analysis;
mod data_sets;
mod devices;
mod error;
mod fitting;
mod interrupt;
mod live;
mod microphones;
mod photograph;
mod pictures;
mod reduction;
mod rendering;
mod shaping;
mod sources;
mod stepped;
mod strokes;
mod tracked;
mod watch;

use pyo3::prelude::*;

/// The module `asperity._native`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::analysis::{analyze, from_normals, metamer, read_picture};
    #[pymodule_export]
    use super::data_sets::{NativeDataSet, build, verify};
    #[pymodule_export]
    use super::devices::{LiveFrames, LiveLevels};
    #[pymodule_export]
    use super::fitting::fit;
    #[pymodule_export]
    use super::live::{LiveRenderer, LiveScene, open};
    #[pymodule_export]
    use super::microphones::Microphones;
    #[pymodule_export]
    use super::photograph::{compare, from_photo, read_photograph};
    #[pymodule_export]
    use super::reduction::{NativeClip, reduce};
    #[pymodule_export]
    use super::rendering::{render, write_wav};
    #[pymodule_export]
    use super::shaping::modes;
    #[pymodule_export]
    use super::sources::{as_toml, names_of, parse_log};
    #[pymodule_export]
    use super::strokes::from_stroke;
    #[pymodule_export]
    use super::tracked::TrackedTip;

    use pyo3::prelude::*;

    /// The engine's version, and the names that options take.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("VERSION", env!("CARGO_PKG_VERSION"))
    }
}
