//! The texture verbs from outside: what they print and write, and that their results go on into a
//! render.

use crate::maps;
use crate::support;
use crate::surfaces;

use asperity_pictures::metamer::{MetamerOptions, Statistics};
use asperity_surface::image_io::{Channel, load_channel};
use asperity_surface::raster::Raster;
use maps::with_maps;
use serde_json::Value;
use std::path::Path;
use support::{Scene, TOML, asperity, assert_refused, message, stroke};
use surfaces::{fractal, grid, ground, ridges, wood};

/// Runs a verb with `--json`, which must succeed.
fn report(scene: &Scene, arguments: &[&str]) -> Value {
    let mut all = vec!["texture"];
    all.extend(arguments);
    all.push("--json");
    let (status, out, err) = message(&asperity(scene.folder.path(), &all));
    assert_eq!((status, err.as_str()), (0, ""), "{arguments:?}");
    serde_json::from_str(&out).unwrap()
}

fn number(report: &Value, field: &str) -> f64 {
    report[field].as_f64().unwrap_or_else(|| panic!("{field} in {report}"))
}

fn grey(scene: &Scene, name: &str) -> Raster {
    load_channel(scene.path(name), Channel::Luma).unwrap().raster
}

/// An OpenGL or DirectX normal map of heights that tile, with true derivatives taken by central
/// differences of a fine sine.
fn save_normal_map(path: &Path, slope: impl Fn(f64, f64) -> [f64; 2], green_up: bool, size: u32) {
    let picture = image::RgbImage::from_fn(size, size, |x, y| {
        let [p, q] = slope(f64::from(x), f64::from(y));
        let up = 1.0 / (1.0 + p * p + q * q).sqrt();
        let level = |n: f64| ((0.5 * n + 0.5) * 255.0).round() as u8;
        image::Rgb([level(-p * up), level(if green_up { q * up } else { -q * up }), level(up)])
    });
    picture.save(path).unwrap();
}

const WAVE: f64 = std::f64::consts::TAU / 32.0;

fn bumps(x: f64, y: f64) -> f64 {
    2.0 * (WAVE * x).sin() * (2.0 * WAVE * y).cos() + (WAVE * (x + y)).sin()
}

fn slopes_of_bumps(x: f64, y: f64) -> [f64; 2] {
    let both = WAVE * (WAVE * (x + y)).cos();
    [
        2.0 * WAVE * (WAVE * x).cos() * (2.0 * WAVE * y).cos() + both,
        -4.0 * WAVE * (WAVE * x).sin() * (2.0 * WAVE * y).sin() + both,
    ]
}

#[test]
fn a_metamer_has_the_originals_size_and_the_references_roughness() {
    let scene = with_maps(&[("look.png", wood(96)), ("feel.png", ground(128))]);
    let made = report(&scene, &["metamer", "look.png", "feel.png", "-o", "both.png", "--bands", "3"]);
    let bands = made["bands"].as_array().unwrap();
    // Three bands of four orientations and two residuals.
    assert_eq!(bands.len(), 14);
    for band in bands.iter().filter(|band| band["kind"] == "oriented") {
        assert!(number(band, "after") < 0.05 && number(band, "before") > number(band, "after"), "{band}");
    }
    assert!(number(&made, "mean_after") < 0.02 && number(&made, "mean_before") > 0.2, "{made}");
    let picture = image::open(scene.path("both.png")).unwrap();
    assert_eq!((picture.width(), picture.height(), picture.color()), (96, 96, image::ColorType::L16));
    let single =
        ["metamer", "look.png", "feel.png", "-o", "one.png", "--bands", "3", "--method", "single-pass"];
    let single = report(&scene, &single);
    assert!(number(&single, "mean_after") > 3.0 * number(&made, "mean_after"));
    assert!(single["iterations"].is_null());
}

/// Bars of two heights, the full range, and a surface to give their feel.
fn with_a_full_range_reference() -> Scene {
    with_maps(&[("look.png", fractal(128, 3.4, 1.0, 7)), ("feel.png", grid(128))])
}

#[test]
fn distances_are_those_of_the_file_for_any_method() {
    let scene = with_a_full_range_reference();
    let reference = grey(&scene, "feel.png");
    for more in [&[][..], &["--method", "single-pass"], &["--method", "spectrum"], &["--borrow", "0"]] {
        let mut arguments = vec!["metamer", "look.png", "feel.png", "-o", "both.png", "--bands", "3"];
        arguments.extend(more);
        let made = report(&scene, &arguments);
        let file = grey(&scene, "both.png");
        let (offset, scale) = (number(&made, "offset"), number(&made, "scale"));
        let heights = file.map(|grey| offset + scale * grey);
        let settings = MetamerOptions { bands: 3, ..MetamerOptions::default() };
        let mut feel = Statistics::new(&reference, 128, 128, &settings).unwrap();
        let found = feel.distance(&heights, true);
        for (stated, found) in [("mean_after", found.mean), ("heights_after", found.heights)] {
            let stated = number(&made, stated);
            assert!((stated - found).abs() <= 0.05 * found, "{more:?}: told {stated}, in the file {found}");
        }
        let limit = file.values.iter().filter(|grey| **grey <= 0.0 || **grey >= 1.0).count();
        let stretched = (offset, scale) != (0.0, 1.0);
        // Where heights leave the reference's range the file is stretched and says so: next to
        // nothing is at its limits.
        assert_eq!(stretched, more.contains(&"--method"), "{more:?}");
        assert!(!stretched || limit < 100, "{more:?}: {limit} of the texels at the limits");
        let warned = made["warnings"].to_string();
        assert_eq!(stretched, warned.contains("relief_m"), "{warned}");
        assert!((number(&made, "relief_m") - 0.002 * scale).abs() < 1e-12);
        // A grid's sub-bands leave room for little else, and what is left is told and warned of.
        let kept = number(&made, "correlation_with_original");
        let taken = number(&made, "correlation_with_reference");
        assert!(kept.abs() <= 1.0 && taken.abs() <= 1.0, "{kept} {taken}");
        assert_eq!(
            !more.contains(&"--method") && kept < 0.3,
            warned.contains("arrangement is left"),
            "{more:?}: {kept} {warned}"
        );
        // What has the feel of a grid and keeps nothing of the look is the grid itself, where it
        // was or somewhere else.
        let is_told = taken > 0.5 && taken > kept;
        assert!(!more.is_empty() || (kept < 0.3 && is_told), "{kept} {taken} {made}");
    }
    let (low, high) = grey(&scene, "both.png").range();
    assert_eq!((low, high), (0.0, 1.0));
}

/// Volume (mm³) and extents (mm) of a binary STL, and whether every edge is met once in either
/// direction.
fn solid(bytes: &[u8]) -> (f64, [f64; 3], bool) {
    let float = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let count = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) as usize;
    assert_eq!(bytes.len(), 84 + 50 * count);
    let mut edges = std::collections::HashMap::new();
    let (mut volume, mut low, mut high) = (0.0, [f64::MAX; 3], [f64::MIN; 3]);
    for triangle in 0..count {
        let corner = |i: usize| [0, 1, 2].map(|axis| float(84 + 50 * triangle + 12 + 12 * i + 4 * axis));
        let corners = [corner(0), corner(1), corner(2)];
        let [a, b, c] = corners.map(|corner| corner.map(f64::from));
        volume += (a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]))
            / 6.0;
        for i in 0..3 {
            let [from, to] = [i, (i + 1) % 3].map(|i| corners[i].map(f32::to_bits));
            *edges.entry((from, to)).or_insert(0) += 1;
            *edges.entry((to, from)).or_insert(0) -= 1;
            for axis in 0..3 {
                low[axis] = f64::min(low[axis], f64::from(corners[i][axis]));
                high[axis] = f64::max(high[axis], f64::from(corners[i][axis]));
            }
        }
    }
    (volume, std::array::from_fn(|axis| high[axis] - low[axis]), edges.values().all(|count| *count == 0))
}

#[test]
fn a_metamer_has_the_stated_size_and_coarse_texels_warn() {
    let scene = with_a_full_range_reference();
    let print = ["metamer", "look.png", "feel.png", "-o", "both.png", "--bands", "3", "--stl", "both.stl"];
    for (width_mm, coarse) in [("20", false), ("64", true)] {
        let mut arguments = print.to_vec();
        arguments.extend(["--width-mm", width_mm, "--base-mm", "3", "--relief-mm", "1.5"]);
        let made = report(&scene, &arguments);
        let (volume, size, closed) = solid(&std::fs::read(scene.path("both.stl")).unwrap());
        let stated =
            [number(&made, "width_mm"), number(&made, "height_mm"), 3.0 + number(&made, "relief_mm")];
        assert!(closed && stated[0].to_string() == width_mm && (stated[2] - 4.5).abs() < 1e-9);
        assert!(
            size.iter().zip(stated).all(|(size, stated)| (size - stated).abs() < 1e-4),
            "{size:?} {stated:?}"
        );
        let mean_mm = 1.5 * grey(&scene, "both.png").mean();
        assert!((volume / (stated[0] * stated[1] * (3.0 + mean_mm)) - 1.0).abs() < 2e-3, "{volume}");
        assert_eq!(made["warnings"].to_string().contains("0.25 mm"), coarse);
    }
    for (bad, field) in [("--base-mm", "base_m"), ("--width-mm", "texel_m")] {
        let mut arguments = vec!["texture"];
        arguments.extend(print);
        arguments[9] = "other.stl";
        arguments.extend([bad, "1e9"]);
        let stated = asperity(scene.folder.path(), &arguments);
        assert_refused(&stated, &[field]);
        assert!(!scene.path("other.stl").exists());
    }
}

#[test]
fn a_height_map_becomes_a_solid_of_its_size_in_either_format() {
    let rough = |x: usize, y: usize| 0.2 + 0.6 * (((x * 37 + y * 91) % 53) as f64 / 52.0);
    let scene = with_maps(&[("rough.png", Raster::from_fn(24, 16, rough))]);
    let sizes = ["--relief-mm", "1.5", "--width-mm", "30", "--base-mm", "3"];
    let make =
        |output: &str| report(&scene, &[&["solid-of", "rough.png", "-o", output], &sizes[..]].concat());
    let made = make("rough.stl");
    let (volume, size, closed) = solid(&std::fs::read(scene.path("rough.stl")).unwrap());
    let heights = grey(&scene, "rough.png");
    let (low, high) = heights.range();
    let exact = [30.0, 20.0, 3.0 + 1.5 * (high - low)];
    assert!(
        closed && size.iter().zip(exact).all(|(size, stated)| (size / stated - 1.0).abs() < 1e-6),
        "{size:?}"
    );
    let exact = 600.0 * (3.0 + 1.5 * (heights.mean() - low));
    assert!((volume / exact - 1.0).abs() < 1e-4 && (number(&made, "volume_mm3") / exact - 1.0).abs() < 1e-12);
    // The mesh solver reads the other format, and finds it as large; a thing of plastic weighs
    // that.
    make("rough.glb");
    let solve = ["modes", "rough.glb", "--material", "plastic", "--max-modes", "3", "-o", "r.json", "--json"];
    let stated = asperity(scene.folder.path(), &solve);
    let solved: Value = serde_json::from_slice(&stated.stdout).unwrap();
    assert!((number(&solved, "volume_m3") * 1e9 / exact - 1.0).abs() < 0.05, "{solved}");
    let refused = |output: &str, base: &str| {
        let arguments = ["texture", "solid-of", "rough.png", "-o", output, "--base-mm", base];
        assert_refused(
            &asperity(scene.folder.path(), &arguments),
            &[if base == "3" { ".glb" } else { "base_m" }],
        );
        assert!(!scene.path(output).exists());
    };
    refused("rough.obj", "3");
    refused("other.stl", "1e9");
}

#[test]
fn a_map_matched_to_itself_is_the_same_file_whatever_the_options() {
    let scene = with_maps(&[("map.png", ridges(64))]);
    for more in [
        &["--bands", "2", "--orientations", "3", "--iterations", "4"][..],
        &["--bands", "3", "--method", "spectrum"],
        &["--bands", "3", "--method", "single-pass", "--borders", "smooth"],
        &["--bands", "3", "--mm-per-px", "0.2", "--reference-mm-per-px", "0.2"],
    ] {
        let mut arguments = vec!["metamer", "map.png", "map.png", "-o", "same.png"];
        arguments.extend(more);
        report(&scene, &arguments);
        let (before, after) = (grey(&scene, "map.png"), grey(&scene, "same.png"));
        let worst = before.values.iter().zip(&after.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 2.0 / 65_535.0, "{more:?} moved it by {worst}");
    }
}

#[test]
fn five_textures_are_told_apart_and_their_metamers_are_not() {
    let scene = with_maps(&[
        ("1.png", fractal(256, 3.4, 1.6, 9)),
        ("2.png", wood(256)),
        ("3.png", grid(256)),
        ("4.png", ground(256)),
        ("5.png", ridges(256)),
    ]);
    let maps = ["compare", "1.png", "2.png", "3.png", "4.png", "5.png"];
    let mut arguments = maps.to_vec();
    arguments.extend(["--metamers", "--strokes", "60"]);
    let stated = report(&scene, &arguments);
    let mean = |table: &str| number(&stated[table], "mean");
    let (originals, single, metamers) = (mean("originals"), mean("single_pass"), mean("metamers"));
    println!("originals {originals:.2}, single pass {single:.2}, metamers {metamers:.2}");
    assert!(originals > 0.95 && single > 0.8, "{stated}");
    assert!(metamers <= 0.65, "{stated}");
    // The pairs that matter: the reference, first, against each metamer.
    let row = stated["metamers"]["rows"][0].as_array().unwrap();
    let expected = row[1..].iter().map(|cell| cell.as_f64().unwrap()).sum::<f64>() / 4.0;
    assert!(
        (number(&stated["metamers"], "reference") - expected).abs() < 1e-12 && expected <= 0.7,
        "{stated}"
    );
    for table in ["originals", "single_pass", "metamers"] {
        let same = number(&stated[table], "same");
        assert!((same - 0.5).abs() <= 0.09, "{table}: a surface against itself {same}");
        let rows = stated[table]["rows"].as_array().unwrap();
        assert!(rows.len() == 5 && rows.iter().all(|row| row.as_array().unwrap().len() == 5));
    }
}

#[test]
fn a_normal_map_of_either_green_becomes_heights_that_render() {
    for green_up in [true, false] {
        let scene = Scene::new();
        save_normal_map(&scene.path("normal.png"), slopes_of_bumps, green_up, 96);
        let made = report(&scene, &["from-normals", "normal.png", "-o", "height.png", "--width-m", "0.04"]);
        assert_eq!(made["green"], if green_up { "opengl" } else { "directx" });
        assert_eq!((&made["green_is_certain"], &made["tileable"]), (&Value::Bool(true), &Value::Bool(true)));
        let (relief_px, relief_m) = (number(&made, "relief_per_px"), number(&made, "relief_m"));
        assert!((relief_m - relief_px * 0.04 / 96.0).abs() < 1e-12);
        let heights = grey(&scene, "height.png");
        let truth = Raster::from_fn(96, 96, |x, y| bumps(x as f64, y as f64));
        let (mean, offset) = (heights.mean() * relief_px, truth.mean());
        let both = heights.values.iter().zip(&truth.values);
        let error: f64 = both.map(|(h, t)| (h * relief_px - mean - (t - offset)).powi(2)).sum();
        let power: f64 = truth.values.iter().map(|t| (t - offset).powi(2)).sum();
        assert!((error / power).sqrt() < 0.006, "{}", (error / power).sqrt());
        let map = format!("displacement = \"height.png\"\nrelief_m = {relief_m}");
        scene.write("scene.toml", TOML.replace("roughness = 0.7", &map));
        scene.write("stroke.jsonl", stroke(1, 0.3));
        assert!(scene.report(&[])["haptic_peak"][0].as_f64().unwrap() > 1e-7);
    }
}

#[test]
fn a_photograph_is_a_rendered_stroke_in_two_commands() {
    let rough = ground(96);
    let tiles = Raster::from_fn(96, 80, |x, y| {
        let mortar = x % 16 < 2 || y % 16 < 2;
        (if mortar { 0.2 } else { 0.7 }) + 0.05 * rough.at(x, y)
    });
    let scene = with_maps(&[("photo.png", tiles)]);
    let made = report(&scene, &["from-photo", "photo.png", "-o", "wall", "--variants"]);
    for axis in 0..2 {
        let lattice = &made["lattice"];
        let (t1, t2) = (lattice["t1_px"][axis].as_f64().unwrap(), lattice["t2_px"][axis].as_f64().unwrap());
        let truth = [16.0, 0.0];
        assert!((t1 - truth[axis]).abs() < 0.05 && (t2 - truth[1 - axis]).abs() < 0.05, "{lattice}");
    }
    for file in made["files"].as_array().unwrap() {
        assert!(scene.path("wall").join(file.as_str().unwrap()).is_file(), "{file}");
    }
    let mut peaks = Vec::new();
    for name in ["scene_x1", "scene_x2", "scene_x4", "scene"] {
        let file = format!("wall/{name}.toml");
        let (status, out, err) =
            message(&asperity(scene.folder.path(), &["render", &file, "-o", "take", "--json"]));
        assert_eq!((status, err.as_str()), (0, ""));
        let stated: Value = serde_json::from_str(&out).unwrap();
        assert_eq!((number(&stated, "quarantined"), number(&stated, "dropped")), (0.0, 0.0));
        assert!(number(&stated, "audio_peak") > 0.0 && number(&stated, "duration_s") > 1.9);
        peaks.push(stated["haptic_peak"][0].as_f64().unwrap());
    }
    assert!(peaks[0] < peaks[1] && peaks[1] < peaks[2] && peaks[0] == peaks[3], "{peaks:?}");
}

#[test]
fn maps_without_relief_and_of_one_height_are_no_failure() {
    let flat = || Raster::constant(64, 64, 0.5);
    let step = Raster::from_fn(64, 64, |x, _| if x < 32 { 0.0 } else { 1.0 });
    let scene = with_maps(&[("flat.png", flat()), ("other.png", flat()), ("step.png", step)]);
    for pair in [["flat.png", "step.png"], ["step.png", "flat.png"], ["flat.png", "other.png"]] {
        let made = report(&scene, &["metamer", pair[0], pair[1], "-o", "out.png"]);
        assert!(made["mean_after"].as_f64().is_some_and(f64::is_finite), "{made}");
    }
    let pair = ["compare", "flat.png", "other.png", "--strokes", "20"];
    let made = report(&scene, &pair);
    assert!((0.0..=1.0).contains(&number(&made["originals"], "mean")));
    // In words the table says what its rows are, and how large a map was taken to be.
    let words = asperity(scene.folder.path(), &[&["texture"], &pair[..]].concat());
    let words = String::from_utf8(words.stdout).unwrap();
    for part in ["40 mm wide and 2 mm from black to white", "rows and columns are the maps", "\n  2  0."] {
        assert!(words.contains(part), "{words}");
    }
    // A grey picture as a normal map, and one that is flat.
    let heights = report(&scene, &["from-normals", "flat.png", "-o", "height.png"]);
    assert!(number(&heights, "relief_per_px").is_finite());
    save_normal_map(&scene.path("normal.png"), |_, _| [0.0, 0.0], true, 32);
    let heights = report(&scene, &["from-normals", "normal.png", "-o", "height.png"]);
    assert!(number(&heights, "relief_per_px").abs() < 1e-6, "{heights}");
    assert!(grey(&scene, "height.png").values.iter().all(|v| (0.0..=1.0).contains(v)));
}

#[test]
fn a_normal_map_is_neither_compared_nor_ranked_as_heights() {
    let scene = with_maps(&[("ground.png", ground(96))]);
    std::fs::create_dir(scene.path("maps")).unwrap();
    std::fs::copy(scene.path("ground.png"), scene.path("maps/other.png")).unwrap();
    for normals in ["normal.png", "maps/normal.png"] {
        save_normal_map(&scene.path(normals), slopes_of_bumps, true, 96);
    }
    let compared = asperity(scene.folder.path(), &["texture", "compare", "ground.png", "normal.png"]);
    assert_refused(&compared, &["normal.png", "is a normal map"]);
    let ranked = report(&scene, &["rank", "ground.png", "maps"]);
    assert!(ranked["ranking"].as_array().is_some_and(|files| files.len() == 1), "{ranked}");
    assert!(ranked["warnings"].to_string().contains("normal.png"), "{ranked}");
}
