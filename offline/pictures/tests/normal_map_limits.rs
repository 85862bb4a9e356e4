//! Limits of 8-bit normal maps: pairs of surfaces that have one and the same map. Whoever makes a
//! surface of that map errs by half of what the two differ by, in one case of the two, whatever he
//! does.

use crate::normals;
use crate::surfaces;

use asperity_fft::num_complex::Complex64;
use asperity_pictures::fft2::{Fft2, angular_frequency};
use asperity_pictures::gradient_field::{Derivative, Slopes, slopes};
use asperity_pictures::normal_map::{Green, NormalMapHeights, NormalMapOptions, heights_from_normals};
use asperity_surface::raster::Raster;
use normals::{normal_map, relative_error};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Bumps of one wavelength, out of phase with the texels so that nothing rounds both ways.
fn bumps(wavelength_px: f64, height_px: f64) -> Raster {
    let wave = |i: usize| ((i as f64 + 0.3) * TAU / wavelength_px).sin();
    Raster::from_fn(256, 256, |x, y| height_px * wave(x) * wave(y))
}

#[test]
fn one_wave_is_the_same_map_whichever_derivative_made_it() {
    for wavelength_px in [16.0, 32.0, 64.0] {
        let omega = TAU / wavelength_px;
        let gain = |derivative: Derivative| derivative.symbol([omega, omega])[0] / omega;
        let surface = |derivative| bumps(wavelength_px, 0.3 / omega / gain(derivative));
        let map = |derivative| normal_map(&slopes(&surface(derivative), derivative), Green::OpenGl);
        let exact = map(Derivative::Exact);
        for other in [Derivative::Central, Derivative::Sobel] {
            assert_eq!(map(other), exact, "{wavelength_px} {other:?}");
        }
        let [r, g, b] = exact;
        let made = |derivative: Option<Derivative>| {
            let options = NormalMapOptions { derivative, ..Default::default() };
            heights_from_normals(&r, &g, &b, &options).unwrap()
        };
        let found = made(None);
        assert!(!found.derivative_is_certain);
        let limit = |low: Derivative| (1.0 - gain(low)) / (1.0 + gain(low));
        let error = |made: &NormalMapHeights, by| relative_error(&made.height_px, &surface(by));
        for derivative in [Derivative::Exact, Derivative::Central] {
            let (untold, stated) = (error(&found, derivative), error(&made(Some(derivative)), derivative));
            let limit = limit(Derivative::Central);
            println!(
                "{wavelength_px} texels, {derivative:?}: {untold:.5}, told {stated:.5}; not knowing costs {limit:.5}"
            );
            assert!(
                untold <= (1.0 + limit) * (1.0 + stated) - 1.0,
                "{wavelength_px} {derivative:?}: {untold}"
            );
        }
        // Sobel lies outside of the two: a map is sooner taken for a baked one or one of plain
        // differences.
        let (untold, stated) =
            (error(&found, Derivative::Sobel), error(&made(Some(Derivative::Sobel)), Derivative::Sobel));
        let limit = limit(Derivative::Sobel);
        println!(
            "{wavelength_px} texels, Sobel: {untold:.5}, told {stated:.5}; not knowing costs {limit:.5} in the worst of three"
        );
        assert!(untold < 1.0 - gain(Derivative::Sobel) + stated, "{wavelength_px}: {untold}");
    }
}

/// Moves the slopes to the nearest ones whose normals round as those of the map do, with 2 % of
/// half a step to spare.
fn rounded_alike(field: &mut Slopes, [red, green, blue]: &[Raster; 3]) {
    let half = 0.98 * 0.5 / 127.5;
    let held = |value: f64, level: f64| value.clamp(2.0 * level - 1.0 - half, 2.0 * level - 1.0 + half);
    for i in 0..red.values.len() {
        let (p, q) = (field.along_u.values[i], field.along_v.values[i]);
        let length = (1.0 + p * p + q * q).sqrt();
        let (mut x, mut y) = (held(-p / length, red.values[i]), held(q / length, green.values[i]));
        for _ in 0..2 {
            let up = held((1.0 - x * x - y * y).sqrt(), blue.values[i]);
            let scale = (1.0 - up * up).sqrt() / x.hypot(y).max(1e-9);
            let outside = (up * up + x * x + y * y - 1.0).abs() > 1e-12;
            if outside {
                (x, y) = (held(x * scale, red.values[i]), held(y * scale, green.values[i]));
            }
        }
        let up = (1.0 - x * x - y * y).sqrt();
        (field.along_u.values[i], field.along_v.values[i]) = (-x / up, y / up);
    }
}

/// The surface with those waves turned over that Sobel's derivative hardly sees, changed as little
/// as it takes to have the same map.
fn twin(surface: &Raster) -> Option<Raster> {
    let n = surface.width;
    let mut fft = Fft2::new(n, n);
    let omega = |place: usize| [angular_frequency(place / n, n), angular_frequency(place % n, n)];
    let map = normal_map(&slopes(surface, Derivative::Sobel), Green::OpenGl);
    let mut spectrum = fft.spectrum(&surface.values);
    for (place, value) in spectrum.iter_mut().enumerate() {
        let [wx, wy] = omega(place);
        let [dx, dy] = Derivative::Sobel.symbol([wx, wy]);
        if dx * dx + dy * dy < 0.002 && wx.hypot(wy) > FRAC_PI_2 {
            *value = -*value;
        }
    }
    let mut twin = fft.image(&mut spectrum);
    for _ in 0..100 {
        let field = slopes(&twin, Derivative::Sobel);
        if normal_map(&field, Green::OpenGl) == map {
            return Some(twin);
        }
        let mut wanted = field.clone();
        rounded_alike(&mut wanted, &map);
        let missing = |to: &Raster, from: &Raster| -> Vec<f64> {
            to.values.iter().zip(&from.values).map(|(a, b)| a - b).collect()
        };
        let p = fft.spectrum(&missing(&wanted.along_u, &field.along_u));
        let mut step = fft.spectrum(&missing(&wanted.along_v, &field.along_v));
        for (place, (q, p)) in step.iter_mut().zip(&p).enumerate() {
            let [dx, dy] = Derivative::Sobel.symbol(omega(place));
            *q = (*p * dx + *q * dy) * Complex64::new(0.0, -1.9 / (dx * dx + dy * dy + 0.1));
        }
        let step = fft.image(&mut step);
        twin.values.iter_mut().zip(&step.values).for_each(|(z, d)| *z += d);
    }
    None
}

#[test]
fn sobel_ridges_have_a_twin_with_the_same_map() {
    let ridges = surfaces::known_surfaces().swap_remove(3).1;
    let twin = twin(&ridges).expect("a surface with the same map");
    let twin = twin.map(|z| z - twin.mean());
    let limit = 0.5 * relative_error(&twin, &ridges);
    let [r, g, b] = normal_map(&slopes(&ridges, Derivative::Sobel), Green::OpenGl);
    let made = heights_from_normals(&r, &g, &b, &NormalMapOptions::default()).unwrap();
    let errors = [&ridges, &twin].map(|truth| relative_error(&made.height_px, truth));
    println!("Sobel ridges: {:.5}, their twin {:.5}; nobody below {limit:.5} in both", errors[0], errors[1]);
    // Nobody can read the ridges to 0.6 %: 8 bits do not tell them from a surface that differs by
    // three times that.
    assert!(limit > 0.017, "{limit}");
    assert_eq!(made.derivative, Derivative::Sobel);
    assert!(errors[0] < 1.1 * limit && errors[1] < 1.4 * limit, "{errors:?}");
}
