//! Shape from shading against surfaces whose heights are known.

use crate::surfaces;

use asperity_pictures::gradient_field::{Derivative, slopes};
use asperity_pictures::light::{Light, estimate_light};
use asperity_pictures::shape_from_shading::{Method, STEPS, shape_by, shape_from_shading};
use asperity_surface::raster::Raster;
use std::f64::consts::TAU;
use surfaces::{correlation, fractal};

/// The image of a surface under a light, 8 bits, with an albedo.
fn photograph(surface: &Raster, light: Light, albedo: f64) -> Raster {
    let field = slopes(surface, Derivative::Exact);
    let [sx, sy, sz] = light.direction();
    let both = field.along_u.values.iter().zip(&field.along_v.values);
    let lit = both.map(|(p, q)| (sz - sx * p - sy * q) / (1.0 + p * p + q * q).sqrt());
    let values = lit.map(|r| (r.max(0.0) * albedo * 255.0).round() / 255.0).collect();
    Raster { width: surface.width, height: surface.height, values }
}

fn known_surfaces() -> Vec<(&'static str, Raster)> {
    let n = 128;
    let scaled = |surface: Raster, slope: f64| {
        let power = slopes(&surface, Derivative::Exact).power();
        surface.map(|z| z * slope / power.sqrt())
    };
    let egg = |i: usize| (i as f64 * TAU * 4.0 / n as f64).sin();
    let ridge = fractal(n, 5.0, 1.0, 43);
    // Caps of spheres on a plane: the document's own test pattern.
    let cap = |i: usize| ((i % 16) as f64 - 7.5).powi(2);
    vec![
        ("ground", scaled(fractal(n, 4.0, 1.0, 41), 0.5)),
        ("hills", scaled(fractal(n, 5.0, 1.0, 42), 0.4)),
        ("egg crate", scaled(Raster::from_fn(n, n, |x, y| egg(x) * egg(y)), 0.4)),
        (
            "ridges",
            scaled(
                Raster::from_fn(n, n, |x, y| {
                    (TAU * (4 * x + 3 * y) as f64 / n as f64).sin() + 4.0 * ridge.at(x, y)
                }),
                0.5,
            ),
        ),
        ("spheres", scaled(Raster::from_fn(n, n, |x, y| (81.0 - cap(x) - cap(y)).max(32.0).sqrt()), 0.5)),
    ]
}

#[test]
fn known_heights_are_found_better_than_by_tsai_and_shah() {
    for (name, surface) in known_surfaces() {
        for slant_deg in [10.0_f64, 20.0, 30.0, 45.0, 60.0] {
            let light = Light::at(slant_deg.to_radians(), -2.2).unwrap();
            let image = photograph(&surface, light, 0.9);
            let found = |method| {
                let shape = shape_by(method, &image, light, |_| {}).unwrap();
                correlation(&shape.height_px, &surface)
            };
            let ours = found(Method::Integrable(STEPS));
            let theirs = [1, 2, 5].map(|steps| found(Method::TsaiShah(steps)));
            let best = theirs.into_iter().fold(f64::MIN, f64::max);
            println!("{name:10} {slant_deg:2}°: ours {ours:.3}, Tsai–Shah {theirs:.2?}");
            assert!(ours > best + 0.3, "{name} at {slant_deg}°");
        }
    }
}

#[test]
fn heights_come_in_texels_whatever_the_albedo() {
    let surface = &known_surfaces()[1].1;
    let light = Light::at(45.0_f64.to_radians(), -2.0).unwrap();
    for albedo in [0.3, 0.9] {
        let image = photograph(surface, light, albedo);
        let shape = shape_from_shading(&image, Some(light), |_| {}).unwrap();
        let rms = |r: &Raster| (slopes(r, Derivative::Exact).power()).sqrt();
        let ratio = rms(&shape.height_px) / rms(surface);
        println!("albedo {albedo}: slopes {ratio:.3} of the true ones");
        assert!((ratio - 1.0).abs() < 0.1);
        assert!(shape.unexplained.unwrap() < 0.1);
    }
}

#[test]
fn the_first_step_of_tsai_and_shah_is_the_negative_image() {
    let surface = &known_surfaces()[0].1;
    let light = Light::at(0.5, -2.0).unwrap();
    let image = photograph(surface, light, 0.9);
    let shape = shape_by(Method::TsaiShah(1), &image, light, |_| {}).unwrap();
    assert!((correlation(&shape.height_px, &image).abs() - 1.0).abs() < 1e-9);
}

#[test]
fn a_light_is_found_to_a_few_degrees_or_reported_missing() {
    for (seed, tilt) in [(51, -1.0), (52, -1.57), (53, -2.4)] {
        let surface = fractal(128, 4.5, 1.0, seed);
        let power = slopes(&surface, Derivative::Exact).power();
        let surface = surface.map(|z| z * 0.35 / power.sqrt());
        let light = Light::at(50.0_f64.to_radians(), tilt).unwrap();
        let found = estimate_light(&photograph(&surface, light, 0.9)).expect("lit from a side");
        let [x, y, _] = found.direction();
        let off = (y.atan2(x) - tilt).to_degrees();
        println!(
            "tilt {:.0}°: off by {off:.1}°, slant {:.0}°",
            tilt.to_degrees(),
            found.slant_rad().to_degrees()
        );
        assert!(off.abs() < 8.0);
        // Skylight: brightness follows height, no direction.
        assert_eq!(estimate_light(&surface.map(|z| 0.5 + 0.02 * z)), None);
    }
}

#[test]
fn lights_are_found_on_renderings_that_set_no_limit() {
    let mut rng = asperity_dsp::rng::Rng::new(2024);
    let (mut found, mut worst_deg, mut invented) = (0, 0.0_f64, 0);
    for seed in 0..24 {
        let surface = fractal(160, 3.6 + 1.6 * rng.uniform(), 1.0, 900 + seed);
        let power = slopes(&surface, Derivative::Exact).power();
        let gain = (0.15 + 0.25 * rng.uniform()) / power.sqrt();
        let surface = surface.map(|z| z * gain);
        // Up the image, as light is taken to come from.
        let tilt = -0.2 - (std::f64::consts::PI - 0.4) * rng.uniform();
        let light = Light::at((30.0 + 30.0 * rng.uniform()).to_radians(), tilt).unwrap();
        if let Some(light) = estimate_light(&photograph(&surface, light, 0.5 + 0.5 * rng.uniform())) {
            let [x, y, _] = light.direction();
            found += 1;
            worst_deg = worst_deg.max((y.atan2(x) - tilt).to_degrees().abs());
        }
        // Without a side light: painted, or bright where it is high.
        let paint = fractal(160, 2.0 + 2.0 * rng.uniform(), 1.0 + 3.0 * rng.uniform(), 700 + seed);
        invented += usize::from(estimate_light(&paint).is_some());
        invented += usize::from(estimate_light(&surface.map(|z| 0.5 + 0.02 * z)).is_some());
    }
    println!("found {found} of 24, off by at most {worst_deg:.1}°; invented {invented} of 48");
    assert!(found >= 23 && worst_deg < 6.0 && invented <= 1);
}

#[test]
fn a_diffuse_photograph_is_deep_where_it_is_dark() {
    let surface = fractal(128, 3.5, 1.0, 61);
    let shape = shape_from_shading(&surface, None, |_| {}).unwrap();
    assert_eq!((shape.method, shape.light), (Method::DarkIsDeep, None));
    let r = correlation(&shape.height_px, &surface);
    assert!(r > 0.5, "r {r}");
}

#[test]
fn half_the_contrast_is_half_the_height() {
    let picture = fractal(128, 3.5, 1.0, 61);
    let mean = picture.mean();
    let found = |contrast: f64| {
        let faint = picture.map(|v| mean + contrast * (v - mean));
        shape_from_shading(&faint, None, |_| {}).unwrap().height_px.range().1
    };
    assert!((found(0.5) / found(1.0) - 0.5).abs() < 1e-9);
}

#[test]
fn light_from_the_viewer_is_refused_where_slopes_are_wanted() {
    let image = fractal(64, 3.5, 1.0, 62);
    for light in [Light::OVERHEAD, Light::at(0.1, 1.0).unwrap()] {
        let refused = shape_by(Method::Integrable(5), &image, light, |_| {}).unwrap_err();
        assert_eq!(refused.field, "light slant");
        let shape = shape_from_shading(&image, Some(light), |_| {}).unwrap();
        assert_eq!(shape.method, Method::DarkIsDeep);
    }
}

#[test]
fn a_flat_sheet_scratched_one_way_is_not_lit_from_a_side() {
    // Bright scratches, most of them within 30° of one direction: their power goes as cos² of the
    // angle, as a light's would.
    let mut rng = asperity_dsp::rng::Rng::new(81);
    let n = 256;
    let mut sheet = Raster::constant(n, n, 0.4);
    for _ in 0..900 {
        let (x, y) = (n as f64 * rng.uniform(), n as f64 * rng.uniform());
        let (angle, length) = (0.9 + 0.5 * rng.normal(), 6.0 + 40.0 * rng.uniform());
        let bright = 0.1 + 0.2 * rng.uniform();
        for step in 0..(2.0 * length) as usize {
            let along = 0.5 * step as f64;
            let (x, y) = (x + along * angle.cos(), y + along * angle.sin());
            let (i, j) = (x.rem_euclid(n as f64) as usize % n, y.rem_euclid(n as f64) as usize % n);
            sheet.values[j * n + i] = (sheet.values[j * n + i] + 0.5 * bright).min(1.0);
        }
    }
    assert_eq!(estimate_light(&sheet), None);
}

#[test]
fn black_images_and_images_that_are_no_images_do_no_harm() {
    let light = Light::at(0.7, -2.0).unwrap();
    for value in [0.0, 1.0] {
        for method in [Method::Integrable(5), Method::TsaiShah(3), Method::DarkIsDeep] {
            let shape = shape_by(method, &Raster::constant(16, 9, value), light, |_| {}).unwrap();
            assert!(shape.height_px.values.iter().all(|z| z.is_finite()), "{method:?}");
        }
    }
    assert_eq!(
        shape_from_shading(&Raster::constant(4, 9, 0.0), None, |_| {}).unwrap_err().field,
        "image side"
    );
    let nan = Raster::constant(9, 9, f64::NAN);
    assert_eq!(shape_from_shading(&nan, None, |_| {}).unwrap_err().field, "image");
}
