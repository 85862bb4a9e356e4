//! Seeded mutations of valid files, for a few seconds: whatever is in a file, reading it gives a
//! result or a message. The same doors, and those of the offline crates, the program and the C
//! library, stand under libFuzzer (`fuzz/`); what it found stays here as a case.

use crate::mutation::drive;
use crate::targets;
use std::path::Path;

/// Made files that a door is given first.
fn seeds(door: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/seeds").join(door);
    let files = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

#[test]
fn every_door_of_the_engine_has_seeds_that_it_survives() {
    for (door, enter) in targets::DOORS {
        let seeds = seeds(door);
        assert!(!seeds.is_empty(), "{door}");
        seeds.iter().for_each(|seed| enter(seed));
    }
}

#[test]
fn any_contact_log_is_read_or_refused() {
    let runs = drive(&seeds("log"), targets::log);
    assert!(runs > 50, "{runs}");
}

#[test]
fn any_modes_file_is_read_or_refused() {
    let runs = drive(&seeds("modes"), targets::modes);
    assert!(runs > 50, "{runs}");
}

#[test]
fn any_scene_file_is_built_or_refused() {
    let runs = drive(&seeds("scene"), targets::scene);
    assert!(runs > 50, "{runs}");
}

#[test]
fn any_picture_is_read_or_refused() {
    let runs = drive(&["png", "jpeg", "gif", "pgm"].map(seeds).concat(), targets::image);
    assert!(runs > 50, "{runs}");
}
