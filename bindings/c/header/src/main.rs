//! Writes `asperity.h` to the file that is named, from the sources of the library.

use std::error::Error;
use std::path::{Path, PathBuf};

/// Signs of the documentation that some compilers' code pages do not have, and how they are written
/// without.
const SIGNS: [(&str, &str); 9] = [
    ("π", " pi "),
    ("…", "..."),
    ("−", "-"),
    ("²⁶", "^26"),
    ("²⁴", "^24"),
    ("²", "2"),
    ("³", "3"),
    (" · ", " "),
    ("·", " "),
];

fn main() -> Result<(), Box<dyn Error>> {
    let to = std::env::args_os().nth(1).map(PathBuf::from).ok_or("name the file to write")?;
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).parent().ok_or("stands beside no library")?;
    let config = cbindgen::Config::from_file(library.join("cbindgen.toml"))?;
    let builder = cbindgen::Builder::new().with_config(config).with_src(library.join("src/lib.rs"));
    let mut header = Vec::new();
    builder.generate()?.write(&mut header);
    std::fs::write(to, plain(&String::from_utf8(header)?)?)?;
    Ok(())
}

/// The header in ASCII.
fn plain(header: &str) -> Result<String, String> {
    let header = SIGNS.iter().fold(header.to_owned(), |text, (sign, plain)| text.replace(sign, plain));
    match header.lines().find(|line| !line.is_ascii()) {
        Some(line) => Err(format!("{line}: holds a sign that is not ASCII; add it to SIGNS")),
        None => Ok(header),
    }
}
