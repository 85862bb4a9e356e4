//! The chain from a photograph to displacement and roughness.

use crate::surfaces;

use asperity_pictures::fft2::{Fft2, angular_frequency};
use asperity_pictures::from_photo::{
    Doubt, Fallback, MOST_TEXELS, PhotoOptions, TEXEL_M, calibration, reduced, surface_from_photo,
};
use asperity_pictures::light::Light;
use asperity_pictures::shape_from_shading::Method;
use asperity_surface::image_io::{Channel, load_channel};
use asperity_surface::raster::Raster;
use surfaces::{correlation, fractal, ground};

fn made(picture: &Raster, options: PhotoOptions) -> asperity_pictures::from_photo::PhotoSurface {
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
fn grain_on_a_pattern_stays_in_the_map_and_dirt_does_not() {
    let tile = |x: usize, y: usize| if x % 16 < 3 || y % 12 < 3 { 0.35 } else { 0.7 };
    let mut rng = asperity_dsp::rng::Rng::new(70);
    let grain = Raster::from_fn(192, 192, |_, _| 0.06 * rng.normal());
    let stain =
        |x: usize, y: usize| 0.15 * (-((x as f64 - 90.0).powi(2) + (y as f64 - 70.0).powi(2)) / 200.0).exp();
    let clean = Raster::from_fn(192, 192, tile);
    let dirty = Raster::from_fn(192, 192, |x, y| tile(x, y) + stain(x, y));
    let grainy = Raster::from_fn(192, 192, |x, y| tile(x, y) + grain.at(x, y));
    let heights = |picture: &Raster| made(picture, PhotoOptions::default()).shape.height_px;
    let plain = heights(&clean);
    let beside_plain = |other: &Raster| Raster::from_fn(192, 192, |x, y| other.at(x, y) - plain.at(x, y));
    let rms = |raster: &Raster| (raster.values.iter().map(|v| v * v).sum::<f64>() / 36_864.0).sqrt();
    let kept = correlation(&beside_plain(&heights(&grainy)), &heights(&grain.map(|v| v + 0.6)));
    let alone = heights(&Raster::from_fn(192, 192, |x, y| 0.6 + stain(x, y)));
    let dirt = rms(&beside_plain(&heights(&dirty))) / rms(&alone);
    println!("correlation with the grain's own heights {kept:.2}; {dirt:.3} of the dirt's own are left");
    assert!(kept > 0.8 && dirt < 0.3);
}

#[test]
fn a_pattern_that_drifts_is_not_blurred_into_a_mean_cell() {
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
    let repeats = |doubt: &Doubt| doubt.to_string().contains("a pattern repeats");
    assert!(surface.doubts.iter().any(repeats), "{:?}", surface.doubts);
    assert!(correlation(&surface.displacement, &bent) > 0.9);
    // Noise as strong as the pattern is no reason: there the mean cell is what is wanted.
    let noisy = made(&bumps(0.0, 0.2), PhotoOptions::default());
    let repetition = noisy.repetition.as_ref().expect("bumps repeat");
    assert!(!repetition.wanders, "{repetition:?}");
    assert!(correlation(&noisy.symmetric, &bumps(0.0, 0.0)) > 0.9);
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
    let message = made(&picture, PhotoOptions { relief_m: Some(1e-3), ..Default::default() });
    assert_eq!((message.relief_m, &message.displacement), (1e-3, &plain.displacement));
    let lit = made(&picture, PhotoOptions { light: Some(Light::ABOVE_LEFT), ..Default::default() });
    assert!(matches!(lit.shape.method, Method::Integrable(_)));
}

/// A picture of 8 bits at a part of its contrast.
fn at_contrast(picture: &Raster, contrast: f64) -> Raster {
    let mean = picture.mean();
    picture.map(|v| ((mean + contrast * (v - mean)) * 255.0).round() / 255.0)
}

/// Gaussian noise of this many levels of 255.
fn with_noise(picture: &Raster, levels: f64, seed: u64) -> Raster {
    let mut rng = asperity_dsp::rng::Rng::new(seed);
    picture.map(|v| ((v * 255.0 + levels * rng.normal()).round() / 255.0).clamp(0.0, 1.0))
}

#[test]
fn relief_and_micro_relief_follow_the_contrast_of_the_picture() {
    let picture = fractal(256, 3.0, 1.0, 77).map(|v| 0.2 + 0.6 * v);
    let full = made(&at_contrast(&picture, 1.0), PhotoOptions::default());
    for contrast in [0.5, 0.2, 0.1] {
        let faint = made(&at_contrast(&picture, contrast), PhotoOptions::default());
        let relief = faint.relief_m / full.relief_m / contrast;
        let micro = faint.micro_relief_m / full.micro_relief_m / contrast;
        println!("contrast {contrast}: relief {relief:.3}, micro-relief {micro:.3} of what it should be");
        assert!((relief - 1.0).abs() < 0.2 && (micro - 1.0).abs() < 0.3);
    }
}

/// Power of the waves of at most 8 texels.
fn fine_power(raster: &Raster) -> f64 {
    let (w, h) = (raster.width, raster.height);
    let spectrum = Fft2::new(w, h).spectrum(&raster.values);
    let wave = |place: usize| angular_frequency(place / h, w).hypot(angular_frequency(place % h, h));
    let fine = spectrum.iter().enumerate().filter(|(place, _)| wave(*place) >= std::f64::consts::TAU / 8.0);
    fine.map(|(_, value)| value.norm_sqr()).sum()
}

#[test]
fn fine_levels_rank_as_plain_contrast_of_fine_texels() {
    // Twelve surfaces of unlike roughness and contrast under one light.
    let mut levels: Vec<(f64, f64)> = (0..12)
        .map(|i| {
            let roughness = 2.2 + 0.15 * f64::from((5 * i) % 12);
            let gain = 0.05 * 1.13_f64.powi((3 * i) % 13);
            let picture = fractal(128, roughness, 1.0, 90 + i as u64).map(|v| 0.45 + gain * (v - 0.5));
            let surface = made(&picture, PhotoOptions::default());
            (fine_power(&picture).log10(), fine_power(&surface.shape.height_px).log10())
        })
        .collect();
    levels.sort_by(|a, b| a.0.total_cmp(&b.0));
    let spread = levels[11].0 - levels[0].0;
    let out_of_order = levels.windows(2).filter(|pair| pair[1].1 < pair[0].1 - 0.1).count();
    println!("{spread:.1} of spread: {levels:.2?}");
    assert!(spread > 1.0 && out_of_order == 0);
}

#[test]
fn a_blank_wall_has_next_to_no_relief_whatever_its_noise() {
    for (grey, levels) in [(0.78, 0.0), (0.78, 0.8), (0.5, 2.0), (0.7, 4.0)] {
        let wall = with_noise(&Raster::constant(240, 200, grey), levels, 5);
        let surface = made(&wall, PhotoOptions::default());
        println!(
            "{levels} levels: relief {:.2e} m, micro {:.2e} m",
            surface.relief_m, surface.micro_relief_m
        );
        assert!(surface.relief_m < 3e-6 && surface.micro_relief_m < 1e-7);
    }
    let even = made(&Raster::constant(64, 64, 0.5), PhotoOptions::default());
    assert_eq!((even.relief_m, even.micro_relief_m), (0.0, 0.0));
    assert_eq!(even.doubts, [Doubt::Flat]);
}

#[test]
fn frontal_light_gives_heights_and_a_reason() {
    let options = PhotoOptions { light: Some(Light::OVERHEAD), ..Default::default() };
    let surface = made(&ground(128), options);
    assert!(surface.relief_m > 1e-5 && surface.shape.method == Method::DarkIsDeep);
    let reason = |d: &Doubt| matches!(d, Doubt::Fallback(Fallback::FrontalLight(_)));
    assert!(surface.doubts.iter().any(reason), "{:?}", surface.doubts);
}

#[test]
fn no_light_is_reported_where_none_was_found() {
    assert!(!made(&ground(96), PhotoOptions::default()).light_was_found);
    let message = PhotoOptions { light: Some(Light::ABOVE_LEFT), ..Default::default() };
    assert!(!made(&ground(96), message).light_was_found);
}

#[test]
fn a_guessed_sign_is_called_a_guess_and_shadows_decide() {
    let guess = made(&fractal(128, 3.0, 1.0, 78), PhotoOptions::default());
    assert!(!guess.sign.is_decided() && guess.doubts.contains(&Doubt::GuessedSign));
    // Narrow grooves full of shadow in an even plate.
    let mut rng = asperity_dsp::rng::Rng::new(79);
    let mut plate = Raster::from_fn(160, 160, |_, _| 0.6 + 0.01 * rng.normal());
    for _ in 0..60 {
        let (x, y, length) = (rng.uniform() * 150.0, rng.uniform() * 150.0, 10.0 + 30.0 * rng.uniform());
        for step in 0..length as usize {
            let (i, j) = ((x as usize + step) % 160, (y as usize + step / 2) % 160);
            plate.values[j * 160 + i] = 0.15;
            plate.values[j * 160 + (i + 1) % 160] = 0.3;
        }
    }
    let decided = made(&plate, PhotoOptions::default());
    assert!(decided.sign.is_decided() && !decided.sign.bright_is_deep, "{:?}", decided.sign);
    let turned = made(&plate, PhotoOptions { bright_is_deep: true, ..Default::default() });
    assert_eq!(turned.sign.confidence, 1.0);
    assert!((correlation(&turned.displacement, &decided.displacement) + 1.0).abs() < 1e-9);
}

#[test]
fn a_sample_of_known_relief_calibrates_other_pictures_of_the_same_camera() {
    let (sample, other) = (fractal(128, 3.0, 1.0, 80), fractal(128, 3.0, 1.0, 81));
    let options = PhotoOptions::default();
    let factor = calibration(&sample, 25e-6, &options).unwrap();
    let calibrated = PhotoOptions { calibration: factor, ..options };
    assert!((made(&sample, calibrated).relief_m / 25e-6 - 1.0).abs() < 1e-9);
    let [plain, scaled] = [options, calibrated].map(|options| made(&other, options));
    assert!((scaled.relief_m / plain.relief_m / factor - 1.0).abs() < 1e-9);
    assert!((scaled.micro_relief_m / plain.micro_relief_m / factor - 1.0).abs() < 1e-9);
    let blank = Raster::constant(128, 128, 0.5);
    assert_eq!(calibration(&blank, 25e-6, &options).unwrap_err().field, "known relief");
}

#[test]
fn a_small_picture_of_noise_is_rough_and_said_to_be_small() {
    let noise = with_noise(&Raster::constant(48, 48, 0.5), 40.0, 6);
    let surface = made(&noise, PhotoOptions::default());
    assert!(surface.roughness.mean() > 0.7, "R {}", surface.roughness.mean());
    assert!(surface.doubts.contains(&Doubt::Small));
    let tiny = made(&with_noise(&Raster::constant(16, 16, 0.5), 40.0, 7), PhotoOptions::default());
    assert!(tiny.doubts.contains(&Doubt::NoRoughness));
}

#[test]
fn the_documents_conditions_are_told_of_a_photograph_as_well() {
    let mut rng = asperity_dsp::rng::Rng::new(82);
    let lines: Vec<f64> = (0..128).map(|_| 0.5 + 0.1 * rng.normal()).collect();
    let wood = Raster::from_fn(128, 128, |_, y| lines[y] + 0.02 * rng.normal());
    let doubts = made(&wood, PhotoOptions::default()).doubts;
    assert!(doubts.iter().any(|d| d.to_string().contains("preferred direction")), "{doubts:?}");
}

#[test]
fn side_light_over_slow_shade_gives_neither_a_dome_nor_streaks() {
    // Pebbles under a side light in a picture that darkens towards its corners.
    let n = 192;
    let pebbles = fractal(n, 4.0, 1.0, 83);
    let field = asperity_pictures::gradient_field::slopes(
        &pebbles,
        asperity_pictures::gradient_field::Derivative::Exact,
    );
    let gain = 0.2 / field.power().sqrt();
    let light = Light::at(0.7, -2.3).unwrap();
    let [sx, sy, sz] = light.direction();
    let picture = Raster::from_fn(n, n, |x, y| {
        let (p, q) = (gain * field.along_u.at(x, y), gain * field.along_v.at(x, y));
        let far = ((x as f64 / 96.0 - 1.0).powi(2) + (y as f64 / 96.0 - 1.0).powi(2)) * 0.2;
        let lit = 0.5 * (1.0 - far) * (sz - sx * p - sy * q) / (1.0 + p * p + q * q).sqrt();
        lit.clamp(0.0, 1.0).powf(1.0 / 2.2)
    });
    let picture = with_noise(&picture, 1.0, 8);
    let surface = made(&picture, PhotoOptions { light: Some(light), ..Default::default() });
    let blocks = |raster: &Raster| {
        // Means of 48 × 48: what is slower than the pebbles.
        Raster::from_fn(4, 4, |x, y| {
            let cells = (0..48 * 48).map(|i| raster.at(48 * x + i % 48, 48 * y + i / 48));
            cells.sum::<f64>() / (48.0 * 48.0)
        })
    };
    let spread = |raster: &Raster| {
        let mean = raster.mean();
        raster.values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / raster.values.len() as f64
    };
    let slow = spread(&blocks(&surface.shape.height_px)) / spread(&surface.shape.height_px);
    println!("slow part {slow:.3} of the power");
    assert!(slow < 0.15);
}

#[test]
fn a_pattern_comes_with_a_cell_as_high_as_the_map() {
    let rough = ground(192);
    let tiles = Raster::from_fn(192, 192, |x, y| {
        let (u, v) = ((x % 24) as f64 - 11.5, (y % 24) as f64 - 11.5);
        0.3 + 0.4 * (-(u * u + v * v) / 60.0).exp() + 0.02 * (rough.at(x, y) - 0.5)
    });
    let surface = made(&tiles, PhotoOptions::default());
    assert!(surface.doubts.iter().any(|doubt| matches!(doubt, Doubt::Repeats(sure) if *sure > 0.5)));
    let cell = surface.cell.expect("tiles repeat");
    assert!((cell.relief_m / surface.relief_m - 1.0).abs() < 0.15, "{} {}", cell.relief_m, surface.relief_m);
    let length = cell.t1_m[0].hypot(cell.t1_m[1]);
    assert!((length / (24.0 * TEXEL_M) - 1.0).abs() < 0.01);
}

#[test]
fn pictures_of_many_megapixels_are_reduced() {
    let (small, n) = reduced(Raster::constant(300, 200, 0.25));
    assert_eq!((small.width, n), (300, 1));
    let (w, h) = (4001, 3000);
    let (large, n) = reduced(Raster::from_fn(w, h, |x, _| (x % 2) as f64));
    assert_eq!((large.width, large.height, n), (2000, 1500, 2));
    assert!(
        large.width * large.height <= MOST_TEXELS && large.values.iter().all(|v| (v - 0.5).abs() < 1e-12)
    );
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
    let Some(folder) = asperity_evidence::corpus::corpus("photos") else { return };
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
