//! Documents: every file they link to is there, and every test, bench and example they name exists.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Crates whose tests are one program.
const CRATES: [&str; 10] = [
    "",
    "dsp",
    "surface",
    "offline/pictures",
    "offline/fit",
    "offline/shape",
    "offline/ports",
    "offline/batch",
    "offline/stroke",
    "cli",
];

/// Markdown files of the repository that people read.
fn documents() -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> =
        ["README.md", "CONTRIBUTING.md", "examples/README.md"].map(|f| root().join(f)).into();
    let folders = CRATES.iter().chain(&[
        "docs",
        "docs/lab",
        "offline/fft",
        "bindings/physics/pairs",
        "bindings/physics/rapier",
    ]);
    for folder in folders.filter(|folder| !folder.is_empty()) {
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

/// Tests whether a path of a document leads somewhere: from the top, from `src`, or with `src`
/// behind the crate's folder, its ending left out or not.
fn is_there(path: &str) -> bool {
    let (first, rest) = path.split_once('/').unwrap_or((path, ""));
    let in_crate = format!("{first}/src/{rest}");
    [path, &format!("src/{path}"), &in_crate].iter().any(|path| {
        let path = root().join(path.trim_end_matches('/'));
        path.exists() || path.with_extension("rs").exists()
    })
}

#[test]
fn every_path_that_a_document_prints_is_there() {
    let doors: Vec<String> = [root(), root().join("src")]
        .iter()
        .flat_map(|folder| fs::read_dir(folder).unwrap())
        .map(|entry| entry.unwrap())
        .filter(|entry| entry.path().is_dir() && entry.file_name() != "target")
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    let (mut seen, mut lost) = (0, Vec::new());
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        for quoted in text.split('`').skip(1).step_by(2) {
            let plain =
                quoted.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || "_-./".contains(c));
            let begins = quoted.split('/').next().unwrap_or_default();
            if plain && quoted.contains('/') && doors.iter().any(|door| door == begins) {
                seen += 1;
                if !is_there(quoted) {
                    lost.push(format!("{}: {quoted}", document.display()));
                }
            }
        }
    }
    assert!(seen > 100, "{seen}");
    assert!(lost.is_empty(), "{lost:#?}");
}

/// First fenced block of a language, indented or not; its fence has to stand at the margin.
fn first_block(text: &str, language: &str) -> String {
    let fence = format!("```{language}");
    let mut lines = text.lines().skip_while(|line| line.trim() != fence);
    assert_eq!(lines.next(), Some(&*fence), "the first block of {language} is indented, or there is none");
    lines.take_while(|line| *line != "```").map(|line| format!("{line}\n")).collect()
}

#[test]
fn the_first_blocks_of_a_bindings_readme_run_as_they_stand() {
    for (binding, language, part) in [
        ("c", "c", "int main("),
        ("python", "python", "import asperity"),
        ("web", "js", "from 'asperity/"),
        ("godot", "gdscript", "extends SceneTree"),
        ("bevy", "rust", "fn main()"),
    ] {
        let path = root().join("bindings").join(binding).join("README.md");
        let text = fs::read_to_string(path).unwrap();
        assert!(!first_block(&text, "sh").is_empty(), "{binding}");
        let program = first_block(&text, language);
        assert!(program.contains(part), "{binding}: {program}");
    }
}

#[test]
fn every_test_bench_and_example_that_the_figures_name_exists() {
    let text = fs::read_to_string(root().join("docs/lab/figures.md")).unwrap();
    let crates = CRATES.iter().chain(&["offline/evidence"]);
    let exists = |folder: &str, name: &str| {
        let place = |within: &str| root().join(within).join(folder).join(name);
        let is_there = |path: &Path| path.with_extension("rs").exists() || path.join("main.rs").exists();
        crates.clone().any(|within| is_there(&place(within)))
    };
    let mut named = 0;
    for (option, folder) in [("--bench ", "benches"), ("--example ", "examples")] {
        for rest in text.split(option).skip(1) {
            let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            assert!(exists(folder, &name), "docs/lab/figures.md: {option}{name} does not exist");
            named += 1;
        }
    }
    for before in text.split("::`").filter(|before| before.len() < text.len()) {
        let reversed = before.chars().rev().take_while(|c| c.is_alphanumeric() || *c == '_');
        let name: String = reversed.collect::<Vec<_>>().into_iter().rev().collect();
        // The head of the page explains the pattern itself.
        if name != "NAME" && !name.is_empty() {
            assert!(exists("tests", &name), "docs/lab/figures.md: {name}:: does not exist");
            named += 1;
        }
    }
    assert!(named > 20, "{named}");
}

#[test]
fn cargo_knows_every_program_of_tests_that_a_document_names() {
    let crates = CRATES.iter().chain(&["offline/evidence"]);
    let manifest = |within| fs::read_to_string(root().join(within).join("Cargo.toml")).unwrap();
    let manifests: String = crates.map(manifest).collect();
    for document in documents() {
        for rest in fs::read_to_string(&document).unwrap().split("--test ").skip(1) {
            let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let declared = manifests.contains(&format!("[[test]]\nname = \"{name}\"\n"));
            assert!(declared, "{}: --test {name}: is declared by no Cargo.toml", document.display());
        }
    }
}

#[test]
fn no_test_is_left_out_of_its_crates_program() {
    let mut seen = 0;
    for within in CRATES {
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

/// Rust sources of the repository, bindings and tests among them.
fn sources() -> Vec<PathBuf> {
    let mut folders = vec![root()];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() && name != "target" && !name.starts_with('.') {
                folders.push(path);
            } else if path.extension().is_some_and(|kind| kind == "rs") {
                found.push(path);
            }
        }
    }
    found
}

/// Columns of a comment line; of a table's row, which cannot be broken, none.
fn columns(line: &str) -> usize {
    let text = line.trim_start().trim_start_matches(['/', '!']).trim_start();
    if text.starts_with('|') { 0 } else { line.chars().count() }
}

#[test]
fn no_comment_is_wider_than_a_hundred_columns() {
    let sources = sources();
    assert!(sources.len() > 800, "{}", sources.len());
    let mut wide = Vec::new();
    for path in sources {
        let text = fs::read_to_string(&path).unwrap();
        // Code and equations stand as they are.
        let mut is_fenced = false;
        for (number, line) in text.lines().enumerate() {
            let said = line.trim_start();
            let is_comment = said.starts_with("//");
            is_fenced =
                is_comment && (is_fenced ^ said.trim_start_matches(['/', '!', ' ']).starts_with("```"));
            if is_comment && !is_fenced && columns(line) > 100 {
                wide.push(format!("{}:{}", path.display(), number + 1));
            }
        }
    }
    assert!(wide.is_empty(), "{} comments are wider than 100 columns: {wide:#?}", wide.len());
}

/// First words of a documentation comment that name nothing.
const NO_NOUN: [&str; 12] = [
    "What", "Whether", "The same", "So many", "How", "As many", "Of", "Nobody", "That of", "Those", "Where",
    "When",
];
#[test]
fn documentation_comments_begin_with_a_noun() {
    let mut found = Vec::new();
    for path in sources() {
        let inside = path.strip_prefix(root()).unwrap();
        if inside.iter().any(|part| part == "tests" || part == "benches" || part == "examples") {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let mut before = "";
        for (number, line) in text.lines().enumerate() {
            let line = line.trim_start();
            let kind = if line.starts_with("///") || line.starts_with("//!") { &line[..3] } else { "" };
            let begins = !kind.is_empty() && kind != before;
            before = kind;
            let says = line[kind.len()..].trim_start();
            let word = |first: &&str| {
                says.strip_prefix(*first).is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric()))
            };
            if begins && NO_NOUN.iter().any(word) {
                found.push(format!("{}:{}", inside.display(), number + 1));
            }
        }
    }
    assert!(found.is_empty(), "comments begin without a noun: {found:#?}");
}

/// Functions of the standard library whose last digits are the platform's.
const OF_THE_PLATFORM: [&str; 19] = [
    "acos", "asin", "atan", "atan2", "cbrt", "cos", "cosh", "exp", "exp2", "exp_m1", "hypot", "ln", "log10",
    "log2", "powf", "sin", "sin_cos", "sinh", "tan",
];

#[test]
fn what_renders_takes_its_functions_from_libm() {
    let mut found = Vec::new();
    for path in sources() {
        let inside = path.strip_prefix(root()).unwrap();
        let renders = ["src", "dsp/src", "surface/src"].iter().any(|folder| inside.starts_with(folder));
        if !renders || inside.ends_with("tests.rs") || inside.iter().any(|part| part == "tests") {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let code = text.lines().take_while(|line| *line != "#[cfg(test)]").enumerate();
        for (number, line) in code.filter(|(_, line)| !line.trim_start().starts_with("//")) {
            // Called on a number, called by its path, handed over by its path.
            let calls = |name: &&str| {
                let by_path = ["f64::", "f32::"].map(|kind| format!("{kind}{name}"));
                let ends = |rest: &str| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_');
                line.contains(&format!(".{name}("))
                    || by_path.iter().any(|path| line.split(path.as_str()).skip(1).any(ends))
            };
            if OF_THE_PLATFORM.iter().any(calls) {
                found.push(format!("{}:{}", inside.display(), number + 1));
            }
        }
    }
    assert!(found.is_empty(), "write libm::…, whose digits are the same everywhere: {found:#?}");
}

/// Names of tests are sentences that fit into the runner's line.
const MOST_WORDS: usize = 12;

#[test]
fn names_of_tests_have_twelve_words_at_most() {
    let mut long = Vec::new();
    for path in sources() {
        let text = fs::read_to_string(&path).unwrap();
        let mut is_test = false;
        for line in text.lines().map(str::trim_start) {
            is_test |= line.starts_with("#[test]");
            let Some((_, after)) = line.split_once("fn ").filter(|_| is_test) else { continue };
            is_test = false;
            let name = after.split('(').next().unwrap_or(after);
            if name.split('_').count() > MOST_WORDS {
                long.push(format!("{}: {name}", path.display()));
            }
        }
    }
    assert!(long.is_empty(), "names of more than {MOST_WORDS} words: {long:#?}");
}
