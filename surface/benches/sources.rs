//! Surfaces that are not maps: ns per sample of a block is the printed time of one element; a frame
//! of sand and settling are whole.

#[path = "../tests/common/naive_sand.rs"]
mod naive_sand;

use asperity_surface::brownian::BrownianDesign;
use asperity_surface::brownian::rendering::{BrownianPath, Rendering};
use asperity_surface::footprint::{footprint_radius_m, sample_under};
use asperity_surface::height_field::{HeightField, MAX_BLOCK, PathBlock, SurfaceBlock};
use asperity_surface::height_map::{Extent, HeightMap};
use asperity_surface::lattice::Lattice;
use asperity_surface::raster::Raster;
use asperity_surface::sand::erosion::Erosion;
use asperity_surface::sand::simulation::Pose;
use asperity_surface::sand::{SandDesign, SandGrid, SandSimulation, SandSource};
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::SolidNoise;
use asperity_surface::wrap::Wrap;
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

const BLOCKS: u64 = 256;

fn sources() -> Vec<(String, Box<dyn HeightField>)> {
    let mut all: Vec<(String, Box<dyn HeightField>)> = Vec::new();
    for material in SolidMaterial::SEVEN {
        let noise = SolidNoise::new(material.parameters(), 1).expect("a preset");
        all.push((format!("solid, {}", material.name()), Box::new(noise)));
    }
    let design = BrownianDesign { size: 256, ..BrownianDesign::new(0.5, 1e-4, 1) };
    let relief = design.surface().expect("a surface");
    let square = Extent { width_m: 0.1, height_m: 0.1, relief_m: 1.0 };
    let map = HeightMap::new(&relief, square, Wrap::Repeat).expect("a map");
    all.push(("Brownian surface".to_owned(), Box::new(map)));
    let path = design.path().expect("a path");
    let graph = BrownianPath::new(&path, 4e-4, Some(Rendering::Lateral)).expect("a graph");
    all.push(("Brownian graph".to_owned(), Box::new(graph)));
    let cell = Raster::from_fn(64, 64, |x, y| 1e-5 * (x * y % 7) as f64);
    let lattice = Lattice::new(&cell, [0.01, 0.0], [0.003, 0.01]).expect("a lattice");
    all.push(("lattice".to_owned(), Box::new(lattice)));
    let sand = SandSource::synchronous(&SandDesign::default(), 1).expect("sand");
    all.push(("sand".to_owned(), Box::new(sand)));
    all
}

/// A finger at 88 mm/s.
fn blocks(c: &mut Criterion) {
    let mut group = c.benchmark_group("sources");
    group.throughput(Throughput::Elements(MAX_BLOCK as u64 * BLOCKS)).sample_size(20);
    for (name, mut source) in sources() {
        let mut out = SurfaceBlock::default();
        group.bench_function(name, |b| {
            b.iter(|| {
                let mut sum = 0.0;
                for block in 0..BLOCKS {
                    let first_sample = 64 * block;
                    let position_m: [[f64; 2]; MAX_BLOCK] =
                        core::array::from_fn(|i| [0.01 + 2e-6 * (first_sample + i as u64) as f64, 0.02]);
                    source.sample(
                        black_box(&PathBlock {
                            position_m: &position_m,
                            velocity_m_s: &[[0.0882, 0.0]; MAX_BLOCK],
                            footprint_m: &[2e-6; MAX_BLOCK],
                            normal_force_n: &[],
                            first_sample,
                            contact: 0,
                            slopes: true,
                            ..PathBlock::default()
                        }),
                        &mut out,
                    );
                    sum += out.height_m[MAX_BLOCK - 1];
                }
                sum
            });
        });
    }
    group.finish();
}

/// A ball of 8 mm that stands 1 mm deep in a soft map, dragged at 88 mm/s.
fn footprint(c: &mut Criterion) {
    let relief = Raster::from_fn(512, 512, |x, y| ((x * 7 + y * 13) % 32) as f64 / 31.0);
    let square = Extent { width_m: 0.1, height_m: 0.1, relief_m: 1e-3 };
    let mut map = HeightMap::new(&relief, square, Wrap::Repeat).expect("a map");
    let mut group = c.benchmark_group("footprint");
    group.throughput(Throughput::Elements(MAX_BLOCK as u64)).sample_size(20);
    for (name, radius_m) in [("a point", 0.0), ("a ball", footprint_radius_m(8e-3, 1e-3))] {
        let mut out = SurfaceBlock::default();
        let position_m: [[f64; 2]; MAX_BLOCK] = core::array::from_fn(|i| [0.01 + 2e-6 * i as f64, 0.02]);
        let path = PathBlock {
            position_m: &position_m,
            velocity_m_s: &[[0.0882, 0.0]; MAX_BLOCK],
            footprint_m: &[2e-6; MAX_BLOCK],
            normal_force_n: &[],
            first_sample: 0,
            contact: 0,
            slopes: true,
            ..PathBlock::default()
        };
        group.bench_function(name, |b| {
            b.iter(|| sample_under(&mut map, black_box(&path), &[radius_m; MAX_BLOCK], &mut out));
        });
    }
    group.finish();
}

/// A frame while a fingertip is dragged over a million cells.
fn sand_frame(c: &mut Criterion) {
    let design = SandDesign { width_m: 1.0, height_m: 1.0, cells: 1000, ..SandDesign::default() };
    let mut sand = SandSimulation::new(&design).expect("sand");
    let mut frame = 0_u32;
    c.bench_function("sand, a frame of 1000 x 1000 cells", |b| {
        b.iter(|| {
            let t = f64::from(frame) / 60.0;
            frame += 1;
            let position_m = [0.5 + 0.25 * (1.1 * t).sin(), 0.5 + 0.2 * (2.3 * t).cos()];
            let velocity_m_s = [0.275 * (1.1 * t).cos(), -0.46 * (2.3 * t).sin()];
            sand.set_pose(Pose { contact: 0, position_m, velocity_m_s, normal_force_n: 5.0, landed: false });
            sand.frame();
        });
    });
}

/// A random field of 256 x 256 cells until nothing slides; the example `settling` has the
/// document's pass beside it.
fn settling(c: &mut Criterion) {
    let mut group = c.benchmark_group("sand, settling of 256 x 256 cells");
    group.sample_size(10);
    for (name, start) in naive_sand::random_fields(256, 5) {
        let mut grid = SandGrid::flat(256, 256, 1e-3, 0.05).expect("a grid");
        grid.fill(|x, y| start[y * 256 + x]);
        let mut erosion = Erosion::new(&grid, 30.0).expect("an angle");
        erosion.activate_all();
        group.bench_function(name, |b| {
            b.iter_batched(
                || (grid.clone(), erosion.clone()),
                |(mut grid, mut erosion)| erosion.settle(&mut grid),
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, blocks, footprint, sand_frame, settling);
criterion_main!(benches);
