//! Tables of modes, as the program reads them.

#[path = "../../../cli/src/fit/columns.rs"]
pub mod columns;
#[path = "../../../cli/src/fit/import.rs"]
#[allow(dead_code)]
pub mod import;
