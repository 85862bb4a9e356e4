//! Times of the offline image tools at the sizes of the bars.

#[path = "../tests/surfaces/mod.rs"]
mod surfaces;

use asperity_pictures::fft2::Fft2;
use asperity_pictures::gradient_field::{Derivative, integrate_open, integrate_periodic, slopes};
use asperity_pictures::light::Light;
use asperity_pictures::metamer::{MetamerOptions, Method, metamer};
use asperity_pictures::pyramid::{Pyramid, Sampling};
use asperity_pictures::shape_from_shading::{Method as Shading, STEPS, shape_by};
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use surfaces::{fractal, ground, wood};

fn transforms(c: &mut Criterion) {
    let image = ground(256);
    let mut fft = Fft2::new(256, 256);
    c.bench_function("fft2 256² there and back", |b| {
        b.iter(|| {
            let mut spectrum = fft.spectrum(black_box(&image.values));
            fft.image(&mut spectrum)
        });
    });
    for (name, sampling) in [("reduced", Sampling::Reduced), ("full", Sampling::Full)] {
        let mut pyramid = Pyramid::new(256, 256, 4, 4, sampling).expect("256² holds four bands");
        c.bench_function(&format!("pyramid 256², 4 × 4, build and reconstruct, {name} (bar 6 ms)"), |b| {
            b.iter(|| {
                let split = pyramid.split(black_box(&image.values));
                pyramid.join(&split)
            });
        });
    }
}

fn metamers(c: &mut Criterion) {
    let (original, reference) = (wood(256), ground(256));
    let mut group = c.benchmark_group("metamer 256²");
    group.sample_size(10);
    for (name, method) in [
        ("single pass", Method::SinglePass),
        ("default (bar 1 s)", MetamerOptions::default().method),
        ("spectrum", Method::Spectrum),
    ] {
        let options = MetamerOptions { method, ..Default::default() };
        group.bench_function(name, |b| b.iter(|| metamer(&original, &reference, &options, |_| {})));
    }
}

fn heights(c: &mut Criterion) {
    let surface = fractal(256, 4.0, 1.0, 31).map(|z| 40.0 * z);
    let field = slopes(&surface, Derivative::Exact);
    let mut group = c.benchmark_group("heights 256²");
    group.sample_size(10);
    group.bench_function("from slopes that tile", |b| {
        b.iter(|| integrate_periodic(black_box(&field), Derivative::Exact));
    });
    group.bench_function("from slopes that do not", |b| {
        b.iter(|| integrate_open(black_box(&field), Derivative::Exact));
    });
    let image = surface.map(|z| 0.2 + z / 80.0);
    for (name, method) in [
        ("integrable", Shading::Integrable(STEPS)),
        ("Tsai–Shah", Shading::TsaiShah(5)),
        ("dark is deep", Shading::DarkIsDeep),
    ] {
        group.bench_function(name, |b| {
            b.iter(|| shape_by(method, black_box(&image), Light::ABOVE_LEFT, |_| {}));
        });
    }
}

criterion_group!(benches, transforms, metamers, heights);
criterion_main!(benches);
