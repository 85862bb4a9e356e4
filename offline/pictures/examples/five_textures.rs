//! Writes five textures of 256 × 256 texels for document 002's ABX table, the reference of the
//! metamers first: `cargo run --release -p asperity-pictures --example
//! five_textures -- DIR`, then `asperity texture compare DIR/*.png --metamers`.

#[path = "../tests/surfaces/mod.rs"]
mod surfaces;

use asperity_surface::image_io::save_gray16;
use std::path::PathBuf;
use surfaces::{fractal, grid, ground, ridges, wood};

fn main() {
    let folder = PathBuf::from(std::env::args().nth(1).expect("a folder to write to"));
    std::fs::create_dir_all(&folder).expect("a folder that can be made");
    let textures = [
        ("1-reference", fractal(256, 3.4, 1.6, 9)),
        ("2-wood", wood(256)),
        ("3-grid", grid(256)),
        ("4-ground", ground(256)),
        ("5-ridges", ridges(256)),
    ];
    for (name, texture) in textures {
        let path = folder.join(format!("{name}.png"));
        save_gray16(&path, &texture).expect("a file that can be written");
        println!("{}", path.display());
    }
}
