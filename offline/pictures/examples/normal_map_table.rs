//! Prints how well heights come out of normal maps, as they are and as people have them, against
//! the displacement maps of the same sets. `cargo run --release -p asperity-pictures
//! --example normal_map_table -- FOLDER…`, folders of files named `…NormalGL.…` (or
//! `…NormalDX.…`) and `…Displacement.…`. `--write DIR` also writes every row's red, green, blue and
//! true heights, raw 32-bit floats one after the other, for `tests/independent/integrators.py`,
//! which says what other integrators reach on the same input.
//!
//! The scale of a displacement map is not known: power is stated of heights that are scaled to it.

#[path = "../tests/normals/mod.rs"]
mod normals;

use asperity_pictures::normal_map::{NormalMapOptions, heights_from_normals};
use asperity_surface::image_io::{Channel, load_channel};
use asperity_surface::raster::Raster;
use image::imageops::FilterType;
use normals::{as_jpeg, cut, halved, halved_heights_by, thirds, without_slant};
use std::path::{Path, PathBuf};
use std::time::Instant;

fn main() {
    println!(
        "set, variant                                  r    power in thirds of the spectrum       derivative        tiles      s"
    );
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let inputs = arguments.iter().position(|a| a == "--write").map(|at| {
        arguments.remove(at);
        PathBuf::from(arguments.remove(at))
    });
    let inputs = inputs.as_deref();
    for folder in arguments {
        let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
            .expect("a folder")
            .map(|entry| entry.expect("a file").path())
            .collect();
        files.sort();
        for file in &files {
            let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let Some(kind) = ["NormalGL", "NormalDX"].into_iter().find(|kind| name.contains(kind)) else {
                continue;
            };
            let truth = files.iter().find(|f| {
                let other = f.file_stem().unwrap_or_default().to_string_lossy();
                name.starts_with(&other.replace("Displacement", kind)) && other.contains("Displacement")
            });
            if let Some(truth) = truth {
                set(&name, file, truth, inputs);
            }
        }
    }
}

fn set(name: &str, normals: &Path, displacement: &Path, inputs: Option<&Path>) {
    let row = |name: &str, variant: &str, map: &[Raster; 3], truth: &Raster| {
        if let Some(folder) = inputs {
            write_inputs(folder, name, variant, map, truth);
        }
        row(name, variant, map, truth);
    };
    let map = [Channel::R, Channel::G, Channel::B].map(|c| load_channel(normals, c).expect("a map").raster);
    let truth = load_channel(displacement, Channel::Luma).expect("a map").raster;
    row(name, "whole", &map, &truth);
    let half = |filter| halved(&map, filter);
    row(
        name,
        "halved, bilinear",
        &half(FilterType::Triangle),
        &halved_heights_by(&truth, FilterType::Triangle),
    );
    let small = halved_heights_by(&truth, FilterType::Lanczos3);
    row(name, "halved, Lanczos", &half(FilterType::Lanczos3), &small);
    row(name, "halved, JPEG 75", &as_jpeg(&half(FilterType::Lanczos3), 75, true), &small);
    for quality in [75, 90] {
        row(name, &format!("JPEG {quality}"), &as_jpeg(&map, quality, true), &truth);
    }
    let size = [600.min(truth.width - 40), 480.min(truth.height - 20)];
    let piece = map.each_ref().map(|channel| cut(channel, [37, 11], size));
    row(name, "cut", &piece, &cut(&truth, [37, 11], size));
    row(name, "cut, JPEG 85", &as_jpeg(&piece, 85, true), &cut(&truth, [37, 11], size));
}

fn row(name: &str, variant: &str, map: &[Raster; 3], truth: &Raster) {
    let start = Instant::now();
    let found =
        heights_from_normals(&map[0], &map[1], &map[2], &NormalMapOptions::default()).expect("a normal map");
    let seconds = start.elapsed().as_secs_f64();
    let whole = !variant.starts_with("cut");
    let [z, t] = [&found.height_px, truth].map(|h| if whole { h.clone() } else { without_slant(h) });
    let (zm, tm) = (z.mean(), t.mean());
    let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
        z.values.iter().zip(&t.values).map(|(z, t)| f(z - zm, t - tm)).sum()
    };
    let (both, made, true_power) = (sum(&|z, t| z * t), sum(&|z, _| z * z), sum(&|_, t| t * t));
    let scaled = z.map(|z| (z - zm) * true_power / both);
    let [low, middle, high] = thirds(&scaled, &t, whole);
    println!(
        "{name:38.38} {variant:16} {:.4} {low:8.3} {middle:8.3} {high:8.3}   {:?}{}   {}   {seconds:.2}",
        both / (made * true_power).sqrt(),
        found.derivative,
        if found.derivative_is_certain { "" } else { "?" },
        found.tileable
    );
}

fn write_inputs(folder: &Path, name: &str, variant: &str, map: &[Raster; 3], truth: &Raster) {
    let rasters = map.iter().chain([truth]);
    let bytes: Vec<u8> = rasters.flat_map(|r| &r.values).flat_map(|&v| (v as f32).to_le_bytes()).collect();
    let file = format!("{name}__{variant}__{}x{}.f32", truth.width, truth.height)
        .replace(", ", "_")
        .replace(' ', "_");
    std::fs::write(folder.join(file), bytes).expect("a folder to write to");
}
