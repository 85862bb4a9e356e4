//! The chain from a photograph to displacement and roughness.

#![cfg(feature = "offline")]

mod surfaces;

use asperity_texture::from_photo::{PhotoOptions, TEXEL_M, surface_from_photo};
use asperity_texture::image_io::{Channel, load_channel};
use asperity_texture::light::Light;
use asperity_texture::raster::Raster;
use asperity_texture::shape_from_shading::Method;
use surfaces::{correlation, fractal, ground};

fn made(picture: &Raster, options: PhotoOptions) -> asperity_texture::from_photo::PhotoSurface {
    surface_from_photo(picture, &options, |_| {}).unwrap()
}

#[test]
fn tiles_are_taken_apart_and_grout_is_deep() {
    let rough = ground(96);
    let tiles = Raster::from_fn(96, 96, |x, y| {
        let base = if x % 16 < 3 || y % 12 < 3 { 0.25 } else { 0.7 };
        base + 0.05 * (rough.at(x, y) - 0.5)
    });
    let surface = made(&tiles, PhotoOptions::default());
    let repetition = surface.repetition.expect("tiles repeat");
    let cell = repetition.lattice.cell_area_px2();
    assert!((cell - 192.0).abs() < 2.0 && repetition.share > 0.9, "{repetition:?}");
    // Symmetric part and residual make the picture again.
    for (i, value) in tiles.values.iter().enumerate() {
        assert!((surface.symmetric.values[i] + surface.residual.values[i] - value).abs() < 1e-12);
    }
    assert_eq!(surface.shape.method, Method::DarkIsDeep);
    let mean = |grout: bool| {
        let inside = |i: &usize| ((i % 96) % 16 == 1 || (i / 96) % 12 == 1) == grout;
        let places: Vec<usize> = (0..96 * 96).filter(inside).collect();
        places.iter().map(|&i| surface.displacement.values[i]).sum::<f64>() / places.len() as f64
    };
    assert!(mean(true) + 0.2 < mean(false));
    assert_eq!(surface.displacement.range(), (0.0, 1.0));
    assert!(surface.relief_m > 1e-5 && surface.micro_relief_m > 0.0);
}

#[test]
fn a_pattern_that_wanders_off_its_lattice_is_not_blurred_into_a_mean_cell() {
    // Bumps 12 texels apart; bent, they run through every phase of their lattice.
    let bumps = |bend: f64, noise: f64| {
        let mut rng = asperity_dsp::rng::Rng::new(72);
        Raster::from_fn(192, 192, |x, y| {
            let (x, y) = (x as f64, y as f64);
            let x = x + bend * (std::f64::consts::TAU * y / 192.0).sin();
            let wave = |t: f64| (std::f64::consts::TAU * t / 12.0).cos();
            0.5 + 0.12 * (wave(x) + wave(y) + wave(x + y)) + noise * rng.normal()
        })
    };
    let bent = bumps(4.5, 0.0);
    let surface = made(&bent, PhotoOptions::default());
    let repetition = surface.repetition.as_ref().expect("bumps repeat");
    assert!(repetition.wanders && repetition.share < 0.8, "{repetition:?}");
    assert!(correlation(&surface.displacement, &bent) > 0.9);
    // Noise as strong as the pattern is no reason: there the mean cell is what is wanted.
    let noisy = made(&bumps(0.0, 0.2), PhotoOptions::default());
    let repetition = noisy.repetition.as_ref().expect("bumps repeat");
    assert!(!repetition.wanders, "{repetition:?}");
    assert!(correlation(&noisy.displacement, &bumps(0.0, 0.0)) > 0.9);
}

#[test]
fn a_picture_without_repetition_keeps_everything() {
    let picture = fractal(128, 2.6, 1.0, 71);
    let surface = made(&picture, PhotoOptions::default());
    assert!(surface.repetition.is_none());
    assert_eq!(surface.primitive, picture);
    assert!(surface.residual.values.iter().all(|&v| v == 0.0));
    // Spectral synthesis falls short of its nominal dimension, so only the order is asked for.
    let smoother = made(&fractal(128, 3.6, 1.0, 71), PhotoOptions::default());
    let (rough, smooth) = (surface.roughness.mean(), smoother.roughness.mean());
    assert!(rough > smooth + 0.2 && rough < 0.7, "R {rough} and {smooth}");
}

#[test]
fn sizes_and_factors_do_what_they_say() {
    let picture = ground(64);
    let plain = made(&picture, PhotoOptions::default());
    let larger = made(&picture, PhotoOptions { texel_m: 2.0 * TEXEL_M, ..Default::default() });
    assert!((larger.relief_m / plain.relief_m - 2.0).abs() < 1e-12);
    let twice = made(&picture, PhotoOptions { exaggeration: 2.0, ..Default::default() });
    assert!((twice.relief_m / plain.relief_m - 2.0).abs() < 1e-12);
    let told = made(&picture, PhotoOptions { relief_m: Some(1e-3), ..Default::default() });
    assert_eq!((told.relief_m, &told.displacement), (1e-3, &plain.displacement));
    let lit = made(&picture, PhotoOptions { light: Some(Light::ABOVE_LEFT), ..Default::default() });
    assert!(matches!(lit.shape.method, Method::Integrable(_)));
}

#[test]
fn bad_photographs_and_options_are_refused_by_name() {
    let refused =
        |picture: &Raster, options| surface_from_photo(picture, &options, |_| {}).unwrap_err().field;
    assert_eq!(refused(&Raster::constant(8, 40, 0.1), PhotoOptions::default()), "photo side");
    assert_eq!(refused(&Raster::constant(32, 40, f64::NAN), PhotoOptions::default()), "photo");
    let options = PhotoOptions { texel_m: 0.0, ..Default::default() };
    assert_eq!(refused(&Raster::constant(32, 40, 0.1), options), "texel_m");
    // A black photograph is a flat surface, not an error.
    let black = made(&Raster::constant(64, 64, 0.0), PhotoOptions::default());
    assert!(black.displacement.values.iter().all(|v| v.is_finite()) && black.dimension.is_none());
}

#[test]
fn real_photographs_pass_without_a_tuned_parameter() {
    let folder = std::env::var("ASPERITY_CORPUS").unwrap_or_else(|_| "../../shared/corpus".into());
    let folder = std::path::Path::new(&folder).join("photos");
    if !folder.exists() {
        assert!(std::env::var("CI").is_err(), "the test corpus is missing: {}", folder.display());
        println!("skipped: no test corpus at {}", folder.display());
        return;
    }
    // Which of them repeat, as a person sees it, and which of those wander off their lattice.
    let photographs = [
        ("MetalWalkway006_1K-PNG_Color.png", true, false),
        ("Facade005_tiles_albedo.jpg", true, false),
        // Scales on a skin that is bent along its middle.
        ("portilla_reptil_skin.pgm", true, true),
        ("Bricks102_1K-JPG_Color.jpg", false, false),
        ("skimage_gravel.png", false, false),
        ("portilla_nuts.pgm", false, false),
        // Bricks in strong perspective: near ones are twice as large as far ones.
        ("skimage_brick.png", false, false),
    ];
    for (name, repeats, wanders) in photographs {
        let picture = load_channel(folder.join(name), Channel::Luma).unwrap().raster;
        let surface = made(&picture, PhotoOptions::default());
        println!(
            "{name}: {:?}, {:?}, R {:.2}, relief {:.2} mm",
            surface.repetition.as_ref().map(|r| (r.lattice.t1_px, r.lattice.t2_px, r.group)),
            surface.shape.method,
            surface.roughness.mean(),
            surface.relief_m * 1e3
        );
        assert_eq!(surface.repetition.is_some(), repeats, "{name}");
        assert_eq!(surface.repetition.as_ref().is_some_and(|found| found.wanders), wanders, "{name}");
        assert_eq!(surface.shape.method, Method::DarkIsDeep, "{name}: no side light stands out");
        assert!(surface.roughness.values.iter().all(|r| (0.0..=1.0).contains(r)));
    }
}
