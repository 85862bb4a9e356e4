//! Lists the files of the page that `asperity web` carries, where `bindings/web/build` has staged
//! them. Only with the feature `web`.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    if env::var_os("CARGO_FEATURE_WEB").is_none() {
        return Ok(());
    }
    let web = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("../bindings/web");
    let page = web.join("dist/page");
    println!("cargo::rerun-if-changed={}", if page.is_dir() { &page } else { &web }.display());
    let mut files = Vec::new();
    if page.is_dir() {
        for file in fs::read_dir(&page)? {
            files.push(file?.path().canonicalize()?);
        }
    }
    files.sort();
    let mut list = String::from("&[\n");
    for file in &files {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        writeln!(list, "    ({name:?}, include_bytes!({file:?})),")?;
    }
    list.push(']');
    fs::write(Path::new(&env::var("OUT_DIR")?).join("page.rs"), list)?;
    Ok(())
}
