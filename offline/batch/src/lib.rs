//! Data sets of rendered touch.
//!
//! A specification ([`spec`]) says what is touched and how; stroke *k* is a pure function of it and
//! of *k*, a shard of it and of its index. Machines share nothing but a folder: each makes its
//! shards, keeps those that are there, and lists all of them.
//!
//! ```text
//! (spec, k) ─ draw ─► scene + contact log ─ asperity::offline ─► sound, vibration ─ codec, resample ─► record ─► shard ─► manifest
//! ```
//!
//! ```no_run
//! use asperity_batch::{DataSet, Spec};
//!
//! let set = DataSet::open(Spec::load("strokes.toml".as_ref())?, "strokes".as_ref())?;
//! for index in 0..set.spec().shards() {
//!     set.shard(index, &mut || ())?;
//! }
//! set.write_manifest()?;
//! # Ok::<(), asperity::files::FileError>(())
//! ```

mod build;
mod check;
pub mod codec;
mod data_set;
pub mod distribution;
pub mod draw;
pub mod force;
pub mod manifest;
pub mod parquet_file;
pub mod path;
pub mod record;
pub mod spec;
pub mod stroke;
pub mod surfaces;
mod verify;
pub mod webdataset;
mod whole_file;

pub use build::Build;
pub use data_set::{DataSet, Outcome};
pub use spec::Spec;
pub use verify::{Verified, verify};
