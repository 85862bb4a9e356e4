//! The doors under libFuzzer; `ASPERITY_DOOR` names one. Without it their names are printed.
#![no_main]

mod calls;
mod clips;
#[cfg(feature = "offline")]
#[path = "../../../cli/src/columns.rs"]
#[allow(dead_code)]
mod columns;
#[path = "../targets.rs"]
mod engine;
#[cfg(feature = "offline")]
#[path = "../../../cli/src/error.rs"]
#[allow(dead_code)]
mod error;
#[cfg(feature = "offline")]
#[allow(dead_code)]
mod export;
#[cfg(feature = "offline")]
mod files;
#[cfg(feature = "offline")]
mod fit;
#[cfg(feature = "offline")]
#[path = "../../../cli/src/import/mod.rs"]
#[allow(dead_code)]
mod import;
#[cfg(feature = "offline")]
#[path = "../../../cli/src/output.rs"]
#[allow(dead_code)]
mod output;
#[cfg(feature = "offline")]
#[path = "../../../cli/src/paths.rs"]
#[allow(dead_code)]
mod paths;
#[cfg(feature = "offline")]
mod program;
#[cfg(feature = "offline")]
#[path = "../../../cli/src/unwrap.rs"]
#[allow(dead_code)]
mod unwrap;

/// Part of the verb `modes` that the import of glTF calls.
#[cfg(feature = "offline")]
mod modes {
    use crate::error::CliError;

    pub fn preset(name: &str) -> Result<asperity::Material, CliError> {
        asperity::Material::by_name(name).ok_or_else(|| CliError::new("--material", name, "is unknown"))
    }
}

use std::sync::OnceLock;

/// A door's name, and what any bytes do there.
type Door = (&'static str, fn(&[u8]));

static DOOR: OnceLock<fn(&[u8])> = OnceLock::new();

fn doors() -> impl Iterator<Item = Door> {
    #[cfg(feature = "offline")]
    let offline = files::DOORS.iter().chain(program::DOORS);
    #[cfg(not(feature = "offline"))]
    let offline = [].iter();
    engine::DOORS.iter().chain(clips::DOORS).chain(calls::DOORS).chain(offline).copied()
}

libfuzzer_sys::fuzz_target!(
    init: {
        let name = std::env::var("ASPERITY_DOOR").unwrap_or_default();
        let Some((_, door)) = doors().find(|(door, _)| *door == name) else {
            doors().for_each(|(name, _)| println!("{name}"));
            std::process::exit(i32::from(!name.is_empty()));
        };
        let _ = DOOR.set(door);
    },
    |data: &[u8]| DOOR.get().expect("a door is chosen before anything comes in")(data)
);
