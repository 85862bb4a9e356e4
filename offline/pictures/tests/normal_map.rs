//! Heights from normal maps: 8-bit maps of known surfaces, and a pair made by others.

use crate::normals;
use crate::surfaces;

use asperity_pictures::borders::Borders;
use asperity_pictures::gradient_field::{DERIVATIVES, Derivative, Slopes, differences, slopes};
use asperity_pictures::normal_map::{Green, NormalMapOptions, heights_from_normals};
use asperity_surface::raster::Raster;
use normals::{normal_map, relative_error};
use surfaces::{correlation, fractal, known_surfaces};

#[test]
fn heights_of_8_bit_maps_are_within_six_thousandths() {
    for (name, surface) in known_surfaces() {
        for derivative in DERIVATIVES {
            for green in [Green::OpenGl, Green::DirectX] {
                let [r, g, b] = normal_map(&slopes(&surface, derivative), green);
                let made = heights_from_normals(&r, &g, &b, &NormalMapOptions::default()).unwrap();
                let error = relative_error(&made.height_px, &surface);
                println!("{name:14} {derivative:?} {green:?}: {error:.5}, taken for {:?}", made.derivative);
                assert_eq!((made.green, made.green_is_certain), (green, true), "{name} {derivative:?}");
                assert!(made.tileable, "{name}");
                // A wave as long along u as along v does not tell how its slopes were taken,
                // everything else does.
                let message = if name == "bumps" { Derivative::ExactOrCentral } else { derivative };
                assert_eq!(
                    (made.derivative, made.derivative_is_certain),
                    (message, name != "bumps"),
                    "{name}"
                );
                // Where the bar is out of anybody's reach: tests/normal_map_limits.rs.
                let out_of_reach = derivative == Derivative::Sobel && ["ridges", "bumps"].contains(&name);
                assert!(out_of_reach || error < 0.006, "{name} {derivative:?} {green:?}: {error}");
            }
        }
    }
}

#[test]
fn a_single_wave_made_by_differences_comes_back_when_they_are_told() {
    let (_, bumps) = known_surfaces().pop().unwrap();
    for derivative in DERIVATIVES {
        let [r, g, b] = normal_map(&slopes(&bumps, derivative), Green::OpenGl);
        let options = NormalMapOptions { derivative: Some(derivative), ..Default::default() };
        let made = heights_from_normals(&r, &g, &b, &options).unwrap();
        let error = relative_error(&made.height_px, &bumps);
        println!("told {derivative:?}: {error:.5}");
        assert!(made.derivative_is_certain && error < 0.006, "{derivative:?}: {error}");
    }
}

#[test]
fn waves_of_any_length_come_back_when_their_differences_are_told() {
    for waves in 10..24 {
        let wave = |i: usize| (f64::from(waves) * i as f64 * std::f64::consts::TAU / 256.0).sin();
        // Rms slope 0.35.
        let height_px = 0.7 * 256.0 / std::f64::consts::TAU / (f64::from(waves) * 2.0_f64.sqrt());
        let bumps = Raster::from_fn(256, 256, |x, y| height_px * wave(x) * wave(y));
        for derivative in DERIVATIVES {
            let [r, g, b] = normal_map(&slopes(&bumps, derivative), Green::OpenGl);
            let options = NormalMapOptions { derivative: Some(derivative), ..Default::default() };
            let made = heights_from_normals(&r, &g, &b, &options).unwrap();
            let error = relative_error(&made.height_px, &bumps);
            println!("{waves} waves, told {derivative:?}: {error:.5}");
            assert!(error < 0.006, "{waves} {derivative:?}: {error}");
        }
    }
}

#[test]
fn a_map_cut_from_a_larger_one_gives_its_heights_back_too() {
    let surface = fractal(256, 4.5, 1.0, 34);
    let field = slopes(&surface.map(|z| 60.0 * z), Derivative::Exact);
    let cut = |raster: &Raster| Raster::from_fn(150, 111, |x, y| raster.at(x + 40, y + 70));
    let field = Slopes { along_u: cut(&field.along_u), along_v: cut(&field.along_v) };
    let [r, g, b] = normal_map(&field, Green::OpenGl);
    let options = NormalMapOptions { keep_tilt: true, ..Default::default() };
    let made = heights_from_normals(&r, &g, &b, &options).unwrap();
    let error = relative_error(&made.height_px, &cut(&surface).map(|z| 60.0 * z));
    println!("cut map: {error:.5}, tileable {}", made.tileable);
    assert!(!made.tileable && error < 0.006);
}

#[test]
fn the_same_cut_with_central_differences_and_borders_of_its_own() {
    let surface = Raster::from_fn(120, 90, |x, y| {
        let (x, y) = (x as f64, y as f64);
        4.0 * (0.11 * x).sin() * (0.07 * y).cos() + 0.02 * x
    });
    let [r, g, b] = normal_map(&differences(&surface, Derivative::Central), Green::DirectX);
    let options = NormalMapOptions { keep_tilt: true, ..Default::default() };
    let made = heights_from_normals(&r, &g, &b, &options).unwrap();
    let error = relative_error(&made.height_px, &surface);
    println!("differences with borders: {error:.5} {:?}", made.derivative);
    assert!(made.green == Green::DirectX && error < 0.006);
}

// Independent figure: tests/independent/normal_map.py integrates the same slopes with numpy.
#[test]
fn heights_agree_with_numpy() {
    let slope = |f: fn(f64, f64) -> f64| Raster::from_fn(32, 24, |x, y| f(x as f64, y as f64));
    let red = slope(|x, y| 0.5 + 0.2 * (0.4 * x + 0.1 * y).sin());
    let green = slope(|x, y| 0.5 + 0.15 * (0.3 * x - 0.5 * y).cos());
    let blue = Raster::constant(32, 24, 0.9);
    let options = NormalMapOptions {
        green: Green::DirectX,
        derivative: Some(Derivative::Exact),
        borders: Borders::Periodic,
        keep_tilt: false,
    };
    let made = heights_from_normals(&red, &green, &blue, &options).unwrap();
    for (x, y, figure) in FIGURES {
        assert!((made.height_px.at(x, y) - figure).abs() < 1e-9, "({x}, {y}): {}", made.height_px.at(x, y));
    }
}

const FIGURES: [(usize, usize, f64); 4] =
    [(0, 0, 0.595750687343), (5, 7, -1.489361521073), (31, 23, 0.318874859244), (16, 3, 0.603138917103)];

/// What is left of a surface that tiles without its mean over squares of `side`.
fn within(surface: &Raster, side: usize) -> Raster {
    let (w, h) = (surface.width, surface.height);
    let mut rows = surface.clone();
    for (way, n) in [(1, w), (w, h)] {
        let from = rows.clone();
        for (i, value) in rows.values.iter_mut().enumerate() {
            let at = i / way % n;
            let sum: f64 =
                (0..side).map(|k| from.values[i - at * way + (at + n + k - side / 2) % n * way]).sum();
            *value = sum / side as f64;
        }
    }
    Raster {
        width: w,
        height: h,
        values: surface.values.iter().zip(&rows.values).map(|(z, m)| z - m).collect(),
    }
}

#[test]
fn a_stone_wall_made_by_others_gives_its_displacement_back() {
    let Some(folder) = asperity_evidence::corpus::corpus("textures") else { return };
    let file = |name: &str| folder.join(format!("Bricks102_1K-JPG_{name}.jpg"));
    use asperity_surface::image_io::{Channel, load_channel};
    let load = |name, channel| load_channel(file(name), channel).unwrap().raster;
    let [r, g, b] = [Channel::R, Channel::G, Channel::B].map(|c| load("NormalGL", c));
    let truth = load("Displacement", Channel::Luma);
    let made = heights_from_normals(&r, &g, &b, &NormalMapOptions::default()).unwrap();
    // Their displacement was levelled over many stones, which normals cannot know: compare within
    // 64 texels.
    let r = correlation(&within(&made.height_px, 64), &within(&truth, 64));
    println!("stone wall: r = {r:.3}, {:?}, {:?}, tileable {}", made.green, made.derivative, made.tileable);
    assert_eq!(made.green, Green::OpenGl);
    assert!(r > 0.9, "{r}");
}

#[test]
fn channels_that_do_not_belong_together_are_refused_by_name() {
    let flat = Raster::constant(8, 8, 0.5);
    let refused = |r: &Raster, g: &Raster| {
        heights_from_normals(r, g, &flat, &NormalMapOptions::default()).unwrap_err().field
    };
    assert_eq!(refused(&flat, &Raster::constant(9, 8, 0.5)), "channel width");
    assert_eq!(refused(&flat, &Raster::constant(8, 8, 1.5)), "normal map");
    assert_eq!(refused(&Raster::constant(3, 8, 0.5), &flat), "normal map side");
}
