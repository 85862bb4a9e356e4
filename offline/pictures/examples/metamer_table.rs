//! A table of metamers of maps: `cargo run --release -p asperity-pictures
//! --example metamer_table -- ORIGINAL REFERENCE [ORIGINAL REFERENCE …]` prints a row a pair,
//! distances as in `asperity texture metamer`.

use asperity_pictures::metamer::{MetamerOptions, metamer};
use asperity_surface::image_io::{Channel, load_channel};
use asperity_surface::raster::Raster;
use std::path::Path;
use std::time::Instant;

fn load(path: &str) -> Raster {
    load_channel(path, Channel::Luma).expect("a map").raster
}

fn main() {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    println!(
        "| original | reference | before | after | heights | kept | of the reference | borrowed | s |\n|---|---|---|---|---|---|---|---|---|"
    );
    for pair in paths.chunks_exact(2) {
        let (original, reference) = (load(&pair[0]), load(&pair[1]));
        let start = Instant::now();
        let made = metamer(&original, &reference, &MetamerOptions::default(), |_| {}).expect("a metamer");
        let name =
            |path: &str| Path::new(path).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        println!(
            "| {} | {} | {:.3} | {:.4} | {:.4} | {:.2} | {:.2} | {} | {:.2} |",
            name(&pair[0]),
            name(&pair[1]),
            made.before.mean,
            made.after.mean,
            made.after.heights,
            made.correlation_with_original,
            made.correlation_with_reference,
            made.borrowed,
            start.elapsed().as_secs_f64()
        );
    }
}
