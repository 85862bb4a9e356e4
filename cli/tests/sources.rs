//! Every surface source through the scene file, sand outputs, and the pictures made from formulas.

use crate::support;

use std::fs;
use support::{Scene, TOML, asperity, assert_refused, message, stroke};

const CELL: &str =
    "relief_m = 0.0002\nlattice = { cell = \"cell.png\", t1_m = [0.004, 0.0], t2_m = [0.0, 0.004] }";

fn write_cell(scene: &Scene) {
    let cell = image::GrayImage::from_fn(16, 16, |x, y| image::Luma([((x * 13) ^ (y * 7)) as u8]));
    cell.save(scene.path("cell.png")).unwrap();
}

#[test]
fn every_source_is_felt_and_heard_and_depends_on_no_block_size() {
    let scene = Scene::new();
    write_cell(&scene);
    scene.write("stroke.jsonl", stroke(1, 0.3));
    for source in [
        "solid = \"gravel\"",
        "solid = \"rough-glass\"",
        "brownian = { hurst = 0.3, rms_m = 1e-4 }",
        CELL,
        "displacement = \"cell.png\"\nrelief_m = 0.0002\nwrap = \"mirror\"",
        "sand = { cells = 64, depth_m = 0.02 }",
    ] {
        scene.write("scene.toml", TOML.replace("roughness = 0.7", source));
        let report = scene.report(&["--block", "256"]);
        assert!(report["audio_peak"].as_f64().unwrap() > 0.0, "{source}");
        assert!(report["haptic_peak"][0].as_f64().unwrap() > 1e-7, "{source}");
        let first = fs::read(scene.path("out.haptic.wav")).unwrap();
        scene.report(&["--block", "37"]);
        assert!(fs::read(scene.path("out.haptic.wav")).unwrap() == first, "{source}");
    }
}

#[test]
fn sand_keeps_its_volume_and_leaves_a_picture() {
    let scene = Scene::new();
    scene.write(
        "scene.toml",
        TOML.replace("roughness = 0.7", "sand = { cells = 128, depth_m = 0.02, talus_deg = 30.0 }"),
    );
    scene.write("stroke.jsonl", stroke(1, 0.5).replace("\"normal_force_n\":0.6", "\"normal_force_n\":3.0"));
    let report = scene.report(&["--plot"]);
    let sand = &report["sand"]["plate"];
    let number = |field: &str| sand[field].as_f64().unwrap();
    assert_eq!(number("volume_before_m3"), number("volume_after_m3"));
    assert!(number("max_slope_deg") <= 30.5, "{sand}");
    assert!(number("metres_per_grey") > 0.0);
    let picture = image::open(scene.path("out.plate.sand.png")).unwrap();
    assert_eq!((picture.width(), picture.color()), (128, image::ColorType::L16));
    let relief_m = f64::from(*picture.to_luma16().iter().max().unwrap()) * number("metres_per_grey");
    assert!((5e-4..0.02).contains(&relief_m), "groove and rim span {relief_m} m");
    assert!(fs::read_to_string(scene.path("out.svg")).unwrap().contains("the sand afterwards"));
}

#[test]
fn texture_solid_and_brownian_write_sixteen_bit_pictures_with_their_scale() {
    let scene = Scene::new();
    for arguments in [
        &["texture", "solid", "pebbles", "--size", "64", "-o", "a.png", "--json"][..],
        &["texture", "brownian", "--hurst", "0.5", "--size", "64", "--seed", "3", "-o", "a.png", "--json"],
        &["texture", "brownian", "--hurst", "0.5", "--size", "65", "--midpoint", "-o", "a.png", "--json"],
    ] {
        let (status, out, err) = message(&asperity(scene.folder.path(), arguments));
        assert_eq!((status, err.as_str()), (0, ""));
        let report: serde_json::Value = serde_json::from_str(&out).unwrap();
        let picture = image::open(scene.path("a.png")).unwrap();
        assert_eq!(picture.color(), image::ColorType::L16);
        assert_eq!(u64::from(picture.width()), report["size"].as_u64().unwrap());
        let grey = picture.to_luma16();
        assert_eq!((grey.iter().min(), grey.iter().max()), (Some(&0), Some(&65_535)));
        let relief_m = report["relief_m"].as_f64().unwrap();
        assert!((report["metres_per_grey"].as_f64().unwrap() * 65_535.0 - relief_m).abs() < 1e-12);
        assert!(report["metres_per_px"].as_f64().unwrap() > 0.0);
    }
    assert_refused(
        &asperity(scene.folder.path(), &["texture", "solid", "cheese", "-o", "b.png"]),
        &["cheese", "pebbles"],
    );
    for wrong in [
        &["texture", "brownian", "--hurst", "1.5", "-o", "b.png"][..],
        &["texture", "brownian", "--hurst", "nan", "-o", "b.png"],
        &["texture", "solid", "wood", "--size", "0", "-o", "b.png"],
    ] {
        assert_eq!(message(&asperity(scene.folder.path(), wrong)).0, 2);
    }
    assert!(!scene.path("b.png").exists());
}
