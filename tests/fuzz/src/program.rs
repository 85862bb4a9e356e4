//! Doors of the program: tables of modes and of strokes, glTF scenes, studies, requests of
//! `--tune`.

use crate::Door;
use crate::columns::Columns;
use crate::engine::{as_file, one_line};
use crate::fit::import::{self as table, Missing};
use crate::import;
use crate::unwrap::UnwrapOptions;
use asperity::files::scene_file::SceneFile;
use asperity_shape::unwrap::PHI;
use document::Document;
use std::path::Path;

#[path = "../../../cli/src/play/tune/document.rs"]
#[allow(dead_code)]
mod document;
#[path = "../../../cli/src/study/spec.rs"]
#[allow(dead_code)]
mod spec;

pub const DOORS: &[Door] = &[
    ("table-csv", |data| modes_of_table("csv", data)),
    ("table-json", |data| modes_of_table("json", data)),
    ("stroke-csv", columns_of_a_stroke),
    ("gltf", scene_of_gltf),
    ("study", study),
    ("tune", turned),
];

fn modes_of_table(ending: &str, data: &[u8]) {
    let missing = Missing { entry: None, base_hz: Some(200.0), t60_s: Some(0.5), table_rate_hz: 44_100.0 };
    as_file(ending, data, |path| match table::read(path, &missing) {
        Ok(read) => assert!(read.modes.iter().all(|mode| mode.frequency_hz.is_finite())),
        Err(refused) => one_line(&refused),
    });
}

/// A recorded stroke or sweep: as many numbers in every column, and its rate.
fn columns_of_a_stroke(data: &[u8]) {
    as_file("csv", data, |path| {
        let columns = match Columns::read(path) {
            Ok(columns) => columns,
            Err(refused) => return one_line(&refused),
        };
        assert!(columns.values.iter().all(|values| values.len() == columns.values[0].len()));
        let rate = columns.rate_hz();
        rate.as_ref().err().into_iter().for_each(one_line);
        assert!(rate.ok().flatten().is_none_or(|rate_hz| rate_hz > 0.0));
        columns.column("acceleration_m_s2").err().iter().for_each(one_line);
    });
}

/// A study, in which at least one thing is asked of at least one stimulus.
fn study(data: &[u8]) {
    as_file("toml", data, |path| match spec::Study::load(path) {
        Ok(study) => assert!(study.trials > 0 && !study.names().is_empty()),
        Err(refused) => one_line(&refused),
    });
}

fn scene_of_gltf(data: &[u8]) {
    as_file("gltf", data, |path| {
        let output = path.with_extension("d");
        let material = "ceramic".to_owned();
        let options = import::Options {
            document: path.to_owned(),
            output: output.clone(),
            material,
            // A mesh's modes take seconds, where the linear algebra is not optimised half a minute;
            // meshes have doors of their own.
            surfaces_only: true,
            unwrap: UnwrapOptions { unwrap: None, phi: PHI },
            json: false,
        };
        match import::run(&options) {
            Ok(()) => drop(SceneFile::load(&output.join("scene.toml")).expect("an import is a scene")),
            Err(refused) => one_line(&refused),
        }
        let _ = std::fs::remove_dir_all(output);
    });
}

/// A scene's text, a line of dashes, and requests of the page: `path key numbers`.
fn turned(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let (scene, requests) = text.split_once("\n---\n").unwrap_or((text, ""));
    let mut document = match Document::parse(scene, Path::new("fuzz.toml")) {
        Ok(document) => document,
        Err(refused) => return one_line(&refused),
    };
    let _ = document.settings();
    for request in requests.lines() {
        let words: Vec<&str> = request.split(' ').collect();
        let [path, key, numbers @ ..] = words.as_slice() else { continue };
        let numbers: Vec<f64> = numbers.iter().filter_map(|number| number.parse().ok()).collect();
        if let Err(refused) = document.set(path, key, &numbers) {
            one_line(&refused);
        }
    }
    let after = document.text();
    Document::parse(&after, Path::new("fuzz.toml")).expect("what was turned is TOML");
    if let Err(refused) = SceneFile::parse(&after, Path::new("fuzz.toml")) {
        one_line(&refused);
    }
}
