//! Slopes and back, with and without borders.

use super::*;
use std::f64::consts::TAU;

fn waves(width: usize, height: usize) -> Raster {
    let surface = Raster::from_fn(width, height, |x, y| {
        let (u, v) = (TAU * x as f64 / width as f64, TAU * y as f64 / height as f64);
        (3.0 * u).cos() + 0.7 * (2.0 * u - 5.0 * v + 0.4).sin() + 0.3 * (7.0 * v).cos()
    });
    let mean = surface.mean();
    surface.map(|z| z - mean)
}

fn worst(a: &Raster, b: &Raster) -> f64 {
    a.values.iter().zip(&b.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn slopes_of_waves_are_their_derivatives_and_integrate_back() {
    let surface = waves(48, 35);
    let field = slopes(&surface, Derivative::Exact);
    let (u, v) = (TAU * 5.0 / 48.0, TAU * 9.0 / 35.0);
    let p = TAU / 48.0 * (-3.0 * (3.0 * u).sin() + 1.4 * (2.0 * u - 5.0 * v + 0.4).cos());
    assert!((field.along_u.at(5, 9) - p).abs() < 1e-12);
    for derivative in DERIVATIVES {
        let field = slopes(&surface, derivative);
        assert!(curl(&field, derivative) < 1e-25);
        assert!(worst(&integrate_periodic(&field, derivative), &surface) < 1e-11);
    }
}

#[test]
fn the_right_derivative_has_the_smallest_curl() {
    let surface = waves(40, 40);
    for made in DERIVATIVES {
        let field = slopes(&surface, made);
        for other in DERIVATIVES.into_iter().filter(|&d| d != made) {
            assert!(curl(&field, other) > 1e4 * curl(&field, made), "{made:?} taken for {other:?}");
        }
    }
}

#[test]
fn a_surface_that_does_not_tile_comes_back_with_its_tilt() {
    let surface = Raster::from_fn(61, 44, |x, y| {
        let (x, y) = (x as f64 / 10.0, y as f64 / 10.0);
        0.3 * x - 0.2 * y + (x * y * 0.4).sin() + 0.1 * x * x
    });
    let mean = surface.mean();
    let surface = surface.map(|z| z - mean);
    // Its true slopes, and differences of texels.
    let slope =
        |f: fn(f64, f64) -> f64| Raster::from_fn(61, 44, |x, y| f(x as f64 / 10.0, y as f64 / 10.0) / 10.0);
    let true_slopes = Slopes {
        along_u: slope(|x, y| 0.3 + 0.4 * y * (x * y * 0.4).cos() + 0.2 * x),
        along_v: slope(|x, y| -0.2 + 0.4 * x * (x * y * 0.4).cos()),
    };
    for derivative in DERIVATIVES {
        let exact = derivative == Derivative::Exact;
        let field = if exact { true_slopes.clone() } else { differences(&surface, derivative) };
        let made = integrate_open(&field, derivative);
        let (low, high) = surface.range();
        let error = worst(&made, &surface) / (high - low);
        assert!(error < 1e-3, "{derivative:?}: {error} of the range");
    }
}

#[test]
fn open_differences_of_a_smooth_surface_are_its_derivative() {
    let field = differences(
        &Raster::from_fn(40, 30, |x, y| (0.3 * x as f64).sin() * (0.2 * y as f64).cos()),
        Derivative::Exact,
    );
    let exact = 0.3 * (0.3 * 20.0_f64).cos() * (0.2 * 11.0_f64).cos();
    assert!((field.along_u.at(20, 11) - exact).abs() < 1e-7);
}

#[test]
fn projecting_removes_what_turns_and_keeps_the_rest() {
    let surface = waves(32, 32);
    let field = slopes(&surface, Derivative::Exact);
    let turning = slopes(&waves(32, 32), Derivative::Exact);
    let mut mixed = field.clone();
    // A field of rotated slopes has no height at all.
    for i in 0..mixed.along_u.values.len() {
        mixed.along_u.values[i] -= 0.5 * turning.along_v.values[i];
        mixed.along_v.values[i] += 0.5 * turning.along_u.values[i];
    }
    Projection::new(32, 32, Derivative::Exact).project(&mut mixed);
    assert!(worst(&mixed.along_u, &field.along_u) < 1e-12);
    assert!(worst(&mixed.along_v, &field.along_v) < 1e-12);
}

/// Central differences with `share` of the difference to the only neighbour at the borders.
fn shared(surface: &Raster, derivative: Derivative, share: f64) -> Slopes {
    let mut field = differences(surface, derivative);
    let (w, h) = (surface.width, surface.height);
    for y in 0..h {
        field.along_u.values[y * w] *= share;
        field.along_u.values[y * w + w - 1] *= share;
    }
    for x in 0..w {
        field.along_v.values[x] *= share;
        field.along_v.values[(h - 1) * w + x] *= share;
    }
    field
}

#[test]
fn whatever_a_converter_did_at_the_borders_the_surface_comes_back() {
    let surface = Raster::from_fn(61, 44, |x, y| {
        let (x, y) = (x as f64 / 10.0, y as f64 / 10.0);
        0.3 * x - 0.2 * y + (x * y * 0.4).sin() + 0.1 * x * x
    });
    let mean = surface.mean();
    let surface = surface.map(|z| z - mean);
    for derivative in [Derivative::Central, Derivative::Sobel] {
        for share in [1.0, 0.5] {
            let made = integrate_open(&shared(&surface, derivative, share), derivative);
            assert!(worst(&made, &surface) < 1e-6, "{derivative:?} {share}: {}", worst(&made, &surface));
        }
    }
    // Mirrored at the last texel: the differences there are 0, and no difference sees the wave of
    // two texels.
    let made = integrate_open(&shared(&surface, Derivative::Central, 0.0), Derivative::Central);
    assert!(worst(&made, &surface) < 1e-3, "{}", worst(&made, &surface));
}
