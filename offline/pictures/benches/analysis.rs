//! Times of the offline analysis on a 256 × 256 map.

use asperity_pictures::fractal_dimension as fd;
use asperity_pictures::symmetry;
use asperity_surface::raster::Raster;
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;

fn map() -> Raster {
    let mut rng = asperity_dsp::rng::Rng::new(1);
    Raster::from_fn(256, 256, |x, y| ((x * x + 3 * y * y) as f64 * 1e-3).sin() + 0.2 * rng.normal())
}

fn analysis(c: &mut Criterion) {
    let map = map();
    let mut group = c.benchmark_group("analysis_256");
    group.bench_function("recommended_dimension", |b| b.iter(|| fd::transects(black_box(&map))));
    group.bench_function("cube_dimensions", |b| b.iter(|| fd::cube_dimensions(black_box(&map))));
    group.bench_function("probability_dimension", |b| b.iter(|| fd::probability_dimension(black_box(&map))));
    group.bench_function("local_map_64_every_4", |b| b.iter(|| fd::local_map(black_box(&map), 64, 4)));
    let tiles = Raster::from_fn(256, 256, |x, y| {
        (x as f64 * 0.37 + 0.05 * y as f64).sin() + (y as f64 * 0.29).cos() + 0.3 * map.at(x, y)
    });
    group.bench_function("feature_matrix", |b| b.iter(|| symmetry::feature_matrix(black_box(&tiles))));
    group.bench_function("find_lattice", |b| b.iter(|| symmetry::find_lattice(black_box(&tiles))));
    if let Some(lattice) = symmetry::find_lattice(&tiles) {
        group.bench_function("cell_and_wallpaper_group", |b| {
            b.iter(|| {
                symmetry::wallpaper_group(&symmetry::averaged_cell(black_box(&tiles), &lattice), &lattice)
            });
        });
        group.bench_function("separate", |b| b.iter(|| symmetry::separate(black_box(&tiles), &lattice)));
    }
    group.finish();
}

criterion_group!(benches, analysis);
criterion_main!(benches);
