//! Files import each other in one direction: no circle between files, none between the engine's
//! folders, no arrow back between crates.
//!
//! A file is a module. What a child imports from its own ancestors does not count: they are one
//! module in several files. A name that a module hands on (`pub use`) is an import of the file that
//! it comes from.

use asperity_evidence::corpus::skip;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::Command;

type Module = Vec<String>;
type Graph = BTreeMap<Module, BTreeSet<Module>>;

/// The modules under a folder with their sources, tests left out.
fn sources(folder: &Path, module: &Module, found: &mut BTreeMap<Module, String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let child = [module.clone(), vec![name.clone()]].concat();
        if path.is_dir() {
            sources(&path, &child, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") && name != "tests" {
            let text = fs::read_to_string(&path).unwrap();
            let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
            let is_parent = ["mod", "lib", "main"].contains(&name.as_str());
            let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
            found.insert(if is_parent { module.clone() } else { child }, lines.collect::<Vec<_>>().join(" "));
        }
    }
}

/// `a::{b, c::{d, e}}` as paths.
fn paths(tree: &str) -> Vec<String> {
    let Some((before, rest)) = tree.split_once('{') else {
        return vec![tree.split(" as ").next().unwrap_or_default().trim().to_owned()];
    };
    let inside = rest.rsplit_once('}').map_or(rest, |(inside, _)| inside);
    let (mut parts, mut depth) = (vec![String::new()], 0);
    for c in inside.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        match c {
            ',' if depth == 0 => parts.push(String::new()),
            _ => parts.last_mut().unwrap().push(c),
        }
    }
    let parts = parts.iter().filter(|part| !part.trim().is_empty());
    parts.flat_map(|part| paths(part)).map(|path| format!("{}{path}", before.trim())).collect()
}

/// A path of a `use` in a module, from the crate's root; none for other crates.
fn absolute(path: &str, module: &Module, known: &BTreeSet<Module>) -> Option<Module> {
    let parts: Vec<String> = path.split("::").map(|part| part.trim().to_owned()).collect();
    let up = parts.iter().take_while(|part| *part == "super").count();
    match parts[0].as_str() {
        "crate" => Some(parts[1..].to_vec()),
        "self" => Some([module.clone(), parts[1..].to_vec()].concat()),
        "super" => Some([module[..module.len().checked_sub(up)?].to_vec(), parts[up..].to_vec()].concat()),
        _ => {
            let own = [module.clone(), parts.clone()].concat();
            known.contains(&own[..=module.len()]).then_some(own)
        }
    }
}

/// The file that a path names something of.
fn file_of(path: &Module, known: &BTreeSet<Module>, handed_on: &BTreeMap<Module, Module>) -> Option<Module> {
    if known.contains(path) {
        return Some(path.clone());
    }
    let at = (0..path.len()).rev().find(|at| known.contains(&path[..*at]))?;
    match handed_on.get(&path[..=at]).filter(|origin| ***origin != path[..=at]) {
        Some(origin) => file_of(&[origin.clone(), path[at + 1..].to_vec()].concat(), known, handed_on),
        None => Some(path[..at].to_vec()),
    }
}

/// Which file imports which.
fn imports(files: &BTreeMap<Module, String>) -> Graph {
    let known: BTreeSet<Module> = files.keys().cloned().collect();
    let (mut handed_on, mut used) = (BTreeMap::new(), Vec::new());
    for (module, text) in files {
        for statement in text.split(';') {
            let Some((before, tree)) = statement.split_once("use ") else { continue };
            let before = before.trim_end();
            let is_statement =
                before.is_empty() || before.ends_with([')', ']', '}', ';']) || before.ends_with("pub");
            if !is_statement {
                continue;
            }
            for path in paths(tree) {
                let Some(path) = absolute(&path, module, &known) else { continue };
                if before.ends_with("pub") || before.ends_with(')') && before.contains("pub(") {
                    let name = path.last().cloned().unwrap_or_default();
                    handed_on.insert([module.clone(), vec![name]].concat(), path);
                } else {
                    used.push((module.clone(), path));
                }
            }
        }
    }
    let mut graph: Graph = known.iter().map(|module| (module.clone(), BTreeSet::new())).collect();
    for (module, path) in used {
        if let Some(file) = file_of(&path, &known, &handed_on).filter(|file| !module.starts_with(file)) {
            graph.entry(module).or_default().insert(file);
        }
    }
    graph
}

/// A circle, if there is one: nodes without arrows are taken away until none is left.
fn circle(mut graph: Graph) -> Vec<String> {
    loop {
        let done: Vec<Module> =
            graph.iter().filter(|(_, to)| to.is_empty()).map(|(node, _)| node.clone()).collect();
        if done.is_empty() {
            break;
        }
        for node in &done {
            graph.remove(node);
        }
        graph.values_mut().for_each(|to| to.retain(|to| !done.contains(to)));
    }
    graph.keys().map(|module| module.join("/")).collect()
}

fn read(folder: &str) -> BTreeMap<Module, String> {
    let mut files = BTreeMap::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &Vec::new(), &mut files);
    files
}

#[test]
fn no_file_imports_what_imports_it() {
    for folder in ["src", "dsp/src", "surface/src"] {
        let graph = imports(&read(folder));
        let arrows: usize = graph.values().map(BTreeSet::len).sum();
        assert!(arrows > 100, "{folder}: only {arrows} imports were found");
        assert_eq!(circle(graph), Vec::<String>::new(), "{folder}: on or behind a circle");
    }
}

#[test]
fn no_folder_of_the_engine_imports_what_imports_it() {
    let mut folders = Graph::new();
    for (module, to) in imports(&read("src")) {
        let Some(own) = module.first() else { continue };
        let others = to.iter().filter_map(|to| to.first()).filter(|to| *to != own).map(|to| vec![to.clone()]);
        folders.entry(vec![own.clone()]).or_default().extend(others);
    }
    assert_eq!(circle(folders), Vec::<String>::new());
}

#[test]
fn a_circle_through_a_name_that_is_handed_on_is_found() {
    let file = |name: &str, text: &str| (vec![name.to_owned()], text.to_owned());
    let circled = [
        (Vec::new(), "mod a; mod b; mod c; pub use c::Thing;".to_owned()),
        file("a", "use crate::b::{self, Other as Another};"),
        file("b", "use crate::Thing;"),
        file("c", "use super::a::Base;"),
    ];
    assert_eq!(circle(imports(&circled.clone().into())), ["a", "b", "c"]);
    let [root, a, b, _] = circled;
    assert_eq!(circle(imports(&[root, a, b, file("c", "use std::fmt;")].into())), Vec::<String>::new());
}

/// Crates that a crate of this folder may be built from.
const BUILT_FROM: [(&str, &[&str]); 12] = [
    ("dsp", &[]),
    ("offline/fft", &[]),
    ("surface", &["dsp", "fft"]),
    (".", &["dsp", "surface"]),
    ("offline/pictures", &["dsp", "fft", "surface"]),
    ("offline/fit", &["dsp", "fft"]),
    ("offline/shape", &["dsp", "engine"]),
    ("offline/ports", &["dsp", "fft"]),
    ("offline/stroke", &["dsp", "fft"]),
    ("offline/plot", &["fft"]),
    ("offline/batch", &["dsp", "engine", "ports"]),
    ("offline/evidence", &["dsp", "fft", "surface", "pictures", "engine"]),
];

/// Crates of the repository among the dependencies of a manifest.
fn dependencies(manifest: &str) -> BTreeSet<String> {
    let section = manifest.split("[dependencies]\n").nth(1).unwrap_or_default();
    let lines = section.lines().take_while(|line| !line.starts_with('['));
    let named = lines.filter_map(|line| line.split(['.', ' ']).next());
    let own = named.filter_map(|name| match name {
        "asperity" => Some("engine"),
        name => name.strip_prefix("asperity-"),
    });
    own.map(str::to_owned).collect()
}

#[test]
fn no_crate_is_built_from_one_that_stands_above_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (folder, allowed) in BUILT_FROM {
        let manifest = fs::read_to_string(root.join(folder).join("Cargo.toml")).unwrap();
        let above: Vec<String> =
            dependencies(&manifest).into_iter().filter(|name| !allowed.contains(&name.as_str())).collect();
        assert_eq!(above, Vec::<String>::new(), "{folder}/Cargo.toml");
    }
    let planted =
        "[package]\n[dependencies]\nasperity-cli = { path = \"../cli\" }\nasperity.workspace = true\n";
    assert_eq!(dependencies(planted), BTreeSet::from(["cli".to_owned(), "engine".to_owned()]));
}

/// Folders that git keeps: the output of a demo beside the sources is no door.
#[test]
fn the_repository_has_ten_doors() {
    let kept = Command::new("git").args(["ls-files"]).current_dir(env!("CARGO_MANIFEST_DIR")).output();
    let Some(kept) = kept.ok().filter(|kept| kept.status.success() && !kept.stdout.is_empty()) else {
        return skip("the folders at the top: no repository of git here");
    };
    let kept = String::from_utf8(kept.stdout).unwrap();
    let folders = kept.lines().filter_map(|path| path.split_once('/').map(|(folder, _)| folder));
    let doors: BTreeSet<&str> = folders.filter(|folder| !folder.starts_with('.')).collect();
    let allowed =
        ["benches", "bindings", "cli", "docs", "dsp", "examples", "offline", "src", "surface", "tests"];
    assert_eq!(doors, allowed.into());
}
