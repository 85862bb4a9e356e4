//! Documents: every file they link to is there, and every test, bench and example they name exists.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Markdown files of the repository that people read.
fn documents() -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> =
        ["README.md", "CONTRIBUTING.md", "examples/README.md"].map(|f| root().join(f)).into();
    for folder in ["docs", "dsp", "texture", "fit", "fft", "cli", "adapters/pairs", "adapters/rapier"] {
        let files = fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path());
        found.extend(files.filter(|path| path.extension().is_some_and(|ending| ending == "md")));
    }
    found
}

/// Targets of `[…](target)` that are files, without their anchors.
fn links(text: &str) -> Vec<&str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split_once(')').map(|(target, _)| target));
    let files = targets.map(|target| target.split('#').next().unwrap_or_default());
    files.filter(|file| !file.is_empty() && !file.contains("://") && !file.contains(' ')).collect()
}

#[test]
fn every_link_between_the_documents_leads_to_a_file() {
    let documents = documents();
    assert!(documents.len() > 12, "{documents:?}");
    for document in documents {
        let text = fs::read_to_string(&document).unwrap();
        for link in links(&text) {
            let target = document.parent().unwrap().join(link);
            assert!(target.exists(), "{}: {link} is not there", document.display());
        }
    }
}

#[test]
fn every_test_bench_and_example_that_the_figures_name_exists() {
    let text = fs::read_to_string(root().join("docs/figures.md")).unwrap();
    let crates = ["", "dsp", "texture", "fit", "shape", "ports", "observer", "batch", "cli"];
    let exists = |folder: &str, name: &str| {
        let place = |within: &str| root().join(within).join(folder).join(name);
        let is_there = |path: &Path| path.with_extension("rs").exists() || path.join("main.rs").exists();
        crates.iter().any(|within| is_there(&place(within)))
    };
    let mut named = 0;
    for (option, folder) in [("--test ", "tests"), ("--bench ", "benches"), ("--example ", "examples")] {
        for rest in text.split(option).skip(1) {
            let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            assert!(exists(folder, &name), "docs/figures.md: {option}{name} does not exist");
            named += 1;
        }
    }
    for before in text.split("::`").filter(|before| before.len() < text.len()) {
        let reversed = before.chars().rev().take_while(|c| c.is_alphanumeric() || *c == '_');
        let name: String = reversed.collect::<Vec<_>>().into_iter().rev().collect();
        // The head of the page explains the pattern itself.
        if name != "NAME" && !name.is_empty() {
            assert!(exists("tests", &name), "docs/figures.md: {name}:: does not exist");
            named += 1;
        }
    }
    assert!(named > 20, "{named}");
}

#[test]
fn no_test_is_left_out_of_its_crates_program() {
    let mut seen = 0;
    for within in ["", "dsp", "texture", "fit", "shape", "ports", "batch", "cli"] {
        let folder = root().join(within).join("tests");
        let program = fs::read_to_string(folder.join("main.rs")).unwrap();
        let manifest = fs::read_to_string(root().join(within).join("Cargo.toml")).unwrap();
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            if path.extension().is_none_or(|kind| kind != "rs") || name == "main" {
                continue;
            }
            let joined = program.contains(&format!("mod {name};"));
            let alone = manifest.contains(&format!("\"tests/{name}.rs\""));
            assert!(joined || alone, "{}: is compiled by nothing; add it to tests/main.rs", path.display());
            seen += 1;
        }
    }
    assert!(seen > 100, "{seen}");
}
