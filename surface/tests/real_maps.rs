//! Maps that nobody made for us: 16 and 8 bits, indexed, interlaced, packed, measured, hostile.
//!
//! The corpus is not part of the repository: see `asperity_evidence::corpus`.
#![cfg(feature = "image")]

use asperity_surface::height_field::{HeightField, MAX_BLOCK, PathBlock, SurfaceBlock};
use asperity_surface::height_map::{Extent, HeightMap};
use asperity_surface::image_io::{Channel, ChannelImage, Problem, load_channel, save_gray16};
use asperity_surface::raster::Raster;
use asperity_surface::wrap::Wrap;
use std::path::{Path, PathBuf};

const RATE_HZ: f64 = 44_100.0;

/// A corpus file, or nothing (said aloud) where there is no corpus.
fn corpus(name: &str) -> Option<PathBuf> {
    asperity_evidence::corpus::corpus(&format!("textures/{name}"))
}

fn load(name: &str, channel: Channel) -> Option<ChannelImage> {
    Some(load_channel(corpus(name)?, channel).unwrap_or_else(|e| panic!("{e}")))
}

/// Heights under a finger at 0.1 m/s over a map of 0.14 m × 0.14 m and 4 mm relief.
fn stroke(raster: &Raster, len: usize) -> Vec<f64> {
    let extent = Extent { width_m: 0.14, height_m: 0.14, relief_m: 0.004 };
    let mut map = HeightMap::new(raster, extent, Wrap::Repeat).expect("a valid map");
    let at = |n: usize| [0.01 + 0.09 * n as f64 / RATE_HZ, 0.02 + 0.0436 * n as f64 / RATE_HZ];
    let positions: Vec<[f64; 2]> = (0..len).map(at).collect();
    let mut out = SurfaceBlock::default();
    let mut heights = Vec::new();
    for position_m in positions.chunks(MAX_BLOCK) {
        let path = PathBlock {
            position_m,
            velocity_m_s: &[[0.09, 0.0436]; MAX_BLOCK][..position_m.len()],
            footprint_m: &[0.1 / RATE_HZ; MAX_BLOCK][..position_m.len()],
            normal_force_n: &[],
            first_sample: heights.len() as u64,
            contact: 0,
            slopes: true,
            ..PathBlock::default()
        };
        map.sample(&path, &mut out);
        heights.extend_from_slice(&out.height_m[..position_m.len()]);
    }
    heights
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0f64), |(s, n), v| (s + v * v, n + 1.0));
    (sum / count).sqrt()
}

fn ac_rms(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    rms(values.iter().map(|v| v - mean))
}

#[test]
fn sixteen_bit_maps_keep_their_levels() {
    for (name, low, high, levels) in [
        ("MetalWalkway006_1K-PNG_Displacement.png", 0, 63_597, 54_661),
        ("CorrugatedSteel003_1K-PNG_Displacement.png", 0, 65_535, 65_510),
        ("Fabric061_1K-PNG_Displacement.png", 623, 58_346, 45_194),
        ("Rock003_1K-PNG_Displacement.png", 56, 65_535, 57_573),
        ("Ground048_1K-PNG_Displacement.png", 2059, 65_535, 40_011),
    ] {
        let Some(image) = load(name, Channel::Luma) else { continue };
        assert_eq!((image.raster.width, image.raster.height), (1024, 1024), "{name}");
        assert_eq!(image.step, 1.0 / 65_535.0, "{name}");
        let (black, white) = image.raster.range();
        let scaled = |v: f64| (v * 65_535.0).round() as i64;
        assert_eq!((scaled(black), scaled(white)), (low, high), "{name}");
        let mut seen: Vec<i64> = image.raster.values.iter().map(|&v| scaled(v)).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), levels, "{name}");
        let heights = stroke(&image.raster, 20_000);
        let (height, reach) = (ac_rms(&heights), heights.iter().fold(0.0f64, |m, h| m.max(h.abs())));
        println!("{name}: {:.1} µm rms under the finger", height * 1e6);
        assert!(height > 1e-5 && reach < 0.0045, "{name}: {height} m rms, {reach} m high");
    }
}

/// The JPEG is another export of the same height (other black and white points, compressed): after
/// a straight-line fit of grey to grey the two must be the same surface.
#[test]
fn the_16_bit_and_the_8_bit_export_of_one_ground_agree() {
    let (Some(fine), Some(coarse)) = (
        load("Ground048_1K-PNG_Displacement.png", Channel::Luma),
        load("Ground048_1K-JPG_Displacement.jpg", Channel::Luma),
    ) else {
        return;
    };
    assert_eq!(coarse.step, 1.0 / 255.0);
    let debanded = coarse.debanded(Wrap::Repeat);
    let (a, b) = (stroke(&fine.raster, 40_000), stroke(&debanded, 40_000));
    let n = a.len() as f64;
    let (mean_a, mean_b) = (a.iter().sum::<f64>() / n, b.iter().sum::<f64>() / n);
    let cross: f64 = a.iter().zip(&b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum();
    let gain = cross / a.iter().map(|a| (a - mean_a).powi(2)).sum::<f64>();
    let rest = rms(a.iter().zip(&b).map(|(a, b)| (b - mean_b) - gain * (a - mean_a)));
    let correlation = cross / (n * ac_rms(&a) * ac_rms(&b));
    println!(
        "Ground048 8 against 16 bits: correlation {correlation:.5}, gain {gain:.4}, offset {:.1} µm, rest {:.2} µm rms of {:.1} µm",
        (mean_b - gain * mean_a) * 1e6,
        rest * 1e6,
        ac_rms(&a) * 1e6
    );
    assert!(correlation > 0.99, "{correlation}");
    assert!(rest < 0.1 * ac_rms(&a), "{rest}");
}

#[test]
fn a_palette_is_looked_up_not_taken_for_grey() {
    // hterrain_sand_depth: entry i is grey i. hterrain_sand_roughness: entry i is grey i + 49.
    if let Some(depth) = load("hterrain_sand_depth.png", Channel::Luma) {
        let (black, white) = depth.raster.range();
        assert_eq!((depth.raster.width, black, white), (1024, 0.0, 1.0));
    }
    let Some(path) = corpus("hterrain_sand_roughness.png") else { return };
    let rough = load_channel(&path, Channel::Luma).expect("a readable map");
    let (indices, palette) = (raw_indices_range(&path), rough.raster.range());
    println!("indices {indices:?}, greys {:?}", (palette.0 * 255.0, palette.1 * 255.0));
    for channel in [Channel::R, Channel::G, Channel::B] {
        assert_eq!(load_channel(&path, channel).expect("a readable map").raster, rough.raster);
    }
    assert!((palette.0 * 255.0).round() as u8 >= 49, "raw indices were taken for grey");
}

/// Smallest and largest entry the palette of an indexed PNG has, by reading its PLTE chunk.
fn raw_indices_range(path: &Path) -> (u8, u8) {
    let bytes = std::fs::read(path).expect("a readable file");
    let at = bytes.windows(4).position(|w| w == b"PLTE").expect("a palette");
    let len = u32::from_be_bytes([bytes[at - 4], bytes[at - 3], bytes[at - 2], bytes[at - 1]]) as usize;
    let greys = bytes[at + 4..at + 4 + len].iter().step_by(3);
    (*greys.clone().min().expect("an entry"), *greys.max().expect("an entry"))
}

#[test]
fn an_interlaced_map_that_is_no_power_of_two_comes_out_whole() {
    let Some(depth) = load("bevy_cube_depth.png", Channel::Luma) else { return };
    assert_eq!((depth.raster.width, depth.raster.height), (348, 348));
    let (black, white) = depth.raster.range();
    assert_eq!((black, white), (0.0, 1.0));
    // Rows that were put in the wrong pass would jump from one to the next everywhere.
    let rough = (1..348).map(|y| rms((0..348).map(|x| depth.raster.at(x, y) - depth.raster.at(x, y - 1))));
    let mut jumps: Vec<f64> = rough.collect();
    jumps.sort_by(f64::total_cmp);
    assert!(jumps[174] < 0.05, "median jump between rows {}", jumps[174]);
    // Depth: relief is negative.
    let extent = Extent { width_m: 0.1, height_m: 0.1, relief_m: -0.002 };
    assert!(HeightMap::new(&depth.debanded(Wrap::Repeat), extent, Wrap::Repeat).is_ok());
}

#[test]
fn height_packed_into_alpha_is_found_there_and_missing_alpha_is_said() {
    if let Some(height) = load("rock023_alb_ht.png", Channel::A) {
        let mut levels: Vec<u8> = height.raster.values.iter().map(|v| (v * 255.0).round() as u8).collect();
        levels.sort_unstable();
        levels.dedup();
        println!("rock023 alpha: {} levels", levels.len());
        assert!(levels.len() > 100);
        let colour = load("rock023_alb_ht.png", Channel::Luma).expect("it was just there");
        assert_ne!(colour.raster, height.raster);
    }
    if let Some(path) = corpus("Rock003_1K-PNG_Displacement.png") {
        let error = load_channel(path, Channel::A).unwrap_err();
        assert!(matches!(error.problem, Problem::NoAlpha), "{error}");
    }
}

#[test]
fn the_coin_has_its_millimetres() {
    let Some(coin) = load("dime_truemap_16bit.png", Channel::Luma) else { return };
    assert_eq!((coin.raster.width, coin.raster.height), (300, 300));
    let extent = Extent { width_m: 18.9566e-3, height_m: 18.9566e-3, relief_m: 350.987e-6 };
    let mut map = HeightMap::new(&coin.raster, extent, Wrap::Clamp).expect("a valid map");
    let pixel = extent.width_m / 300.0;
    assert!((pixel - 63.189e-6).abs() < 1e-9);
    let mut out = SurfaceBlock::default();
    for (x, y) in [(0, 0), (150, 150), (37, 250), (299, 299)] {
        let position = [(x as f64 + 0.5) * pixel, (y as f64 + 0.5) * pixel];
        let path = PathBlock {
            position_m: &[position],
            velocity_m_s: &[[0.0; 2]],
            footprint_m: &[0.0],
            normal_force_n: &[],
            first_sample: 0,
            contact: 0,
            slopes: true,
            ..PathBlock::default()
        };
        map.sample(&path, &mut out);
        let expected = coin.raster.at(x, y) * 350.987e-6;
        assert!((out.height_m[0] - expected).abs() < 1e-9, "({x}, {y}): {} {expected}", out.height_m[0]);
    }
}

#[test]
fn a_jpeg_map_may_be_oblong() {
    let Some(bricks) = load("Bricks102_1K-JPG_Displacement.jpg", Channel::Luma) else { return };
    assert_eq!((bricks.raster.width, bricks.raster.height), (1024, 512));
    let rough = load("Bricks102_1K-JPG_Roughness.jpg", Channel::Luma).expect("beside the other");
    let extent = Extent { width_m: 0.2, height_m: 0.1, relief_m: 0.004 };
    let map = HeightMap::new(&bricks.debanded(Wrap::Repeat), extent, Wrap::Repeat).expect("a valid map");
    assert!(map.with_roughness_map(&rough.raster).is_ok());
}

#[cfg(feature = "exr")]
#[test]
fn an_exr_brush_keeps_its_floats() {
    let Some(brush) = load("brush_terrain1.exr", Channel::R) else { return };
    let (low, high) = brush.raster.range();
    assert_eq!((brush.raster.width, brush.raster.height, brush.step), (512, 512, 0.0));
    assert!((low - 2.146e-6).abs() < 1e-8 && high == 1.0, "{low} {high}");
}

#[cfg(not(feature = "exr"))]
#[test]
fn an_exr_file_without_the_feature_is_refused_with_the_remedy() {
    let Some(path) = corpus("brush_terrain1.exr") else { return };
    let error = load_channel(path, Channel::R).unwrap_err().to_string();
    assert!(error.contains("feature `exr`"), "{error}");
}

/// A folder of this test's own.
fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a writable target folder");
    folder
}

#[test]
fn sixteen_bits_go_out_and_return_exactly() {
    let folder = scratch("round_trip");
    let raster = Raster::from_fn(37, 21, |x, y| ((x * 1771 + y * 90) % 65_536) as f64 / 65_535.0);
    let path = folder.join("out.png");
    save_gray16(&path, &raster).expect("a writable folder");
    let back = load_channel(&path, Channel::Luma).expect("what was just written");
    assert_eq!(back.raster, raster);
    let names: Vec<_> = std::fs::read_dir(&folder).expect("it exists").collect();
    assert_eq!(names.len(), 1, "{names:?}");
    assert!(save_gray16(folder.join("none/out.png"), &raster).is_err());
    assert!(matches!(
        save_gray16(&path, &raster.map(|_| f64::NAN)).unwrap_err().problem,
        Problem::NotFinite { .. }
    ));
    assert_eq!(load_channel(&path, Channel::Luma).expect("the old file is still whole").raster, raster);
}

#[test]
fn eight_bits_in_a_sixteen_bit_file_are_recognised() {
    let path = scratch("scaled").join("scaled.png");
    save_gray16(&path, &Raster::from_fn(64, 64, |x, y| ((x + 3 * y) % 256) as f64 / 255.0))
        .expect("writable");
    assert!((load_channel(&path, Channel::Luma).expect("readable").step - 1.0 / 255.0).abs() < 1e-12);
}

#[test]
fn portable_grey_maps_of_any_depth_are_read() {
    let folder = scratch("pgm");
    let text = folder.join("plain.pgm");
    std::fs::write(&text, "P2\n# comment\n3 2\n15\n0 5 10\n15 3 6\n").expect("writable");
    let plain = load_channel(&text, Channel::Luma).expect("readable");
    assert_eq!((plain.raster.width, plain.raster.height), (3, 2));
    for (value, grey) in plain.raster.values.iter().zip([0.0, 5.0, 10.0, 15.0, 3.0, 6.0]) {
        assert!((value - grey / 15.0).abs() < 1e-3, "{value} for {grey}/15");
    }
    let binary = folder.join("deep.pgm");
    let mut bytes = b"P5 2 1 65535\n".to_vec();
    bytes.extend([0x12, 0x34, 0xFF, 0xFF]);
    std::fs::write(&binary, bytes).expect("writable");
    let deep = load_channel(&binary, Channel::Luma).expect("readable");
    assert_eq!(deep.raster.values, [f64::from(0x1234) / 65_535.0, 1.0]);
}

/// A PNG header that claims a size, with nothing behind it worth having.
fn png_claiming(width: u32, height: u32) -> Vec<u8> {
    let mut ihdr = b"IHDR".to_vec();
    ihdr.extend(width.to_be_bytes());
    ihdr.extend(height.to_be_bytes());
    ihdr.extend([16, 0, 0, 0, 0]);
    let mut crc = 0xFFFF_FFFFu32;
    for &byte in &ihdr {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 };
        }
    }
    let mut file = b"\x89PNG\r\n\x1a\n\0\0\0\r".to_vec();
    file.extend(ihdr);
    file.extend((!crc).to_be_bytes());
    file.extend(b"\0\0\0\x08IDAT\x78\x9c\x63\0\0\0\x01\0\x01");
    file
}

#[test]
fn hostile_files_are_refused_in_one_line_that_names_the_file() {
    let folder = scratch("hostile");
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("writable");
        path
    };
    let good = folder.join("good.png");
    save_gray16(&good, &Raster::from_fn(200, 200, |x, y| (x * y % 97) as f64 / 97.0)).expect("writable");
    let whole = std::fs::read(&good).expect("just written");
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 0x55;
    let cases = [
        write("text.png", b"This is a letter, not a picture.\n"),
        write("empty.png", b""),
        write("truncated.png", &whole[..whole.len() / 2]),
        write("flipped.png", &flipped),
        write("bomb.png", &png_claiming(2_000_000_000, 2_000_000_000)),
        write("long.png", &png_claiming(1_000_000, 3)),
        write("zero.png", &png_claiming(0, 10)),
        write("bomb.pgm", b"P5 60000 60000 65535\n\0\0"),
        write("huge.pgm", b"P5 99999999999999999999 1 255\n\0"),
        write("short.pgm", b"P5 100 100 255\nabc"),
        write("stub.jpg", b"\xFF\xD8\xFF\xE0\0\x10JFIF\0"),
        folder.join("missing.png"),
        folder.clone(),
    ];
    for path in cases {
        let error = load_channel(&path, Channel::Luma).expect_err("must be refused").to_string();
        let name = path.display().to_string();
        println!("{}", error.replace(&name, &path.file_name().unwrap_or_default().to_string_lossy()));
        assert!(error.starts_with(&name), "{error}");
        assert!(!error.contains('\n') && error.contains(';'), "{error}");
    }
}
