//! A height map under a moving finger: ns per sample is the printed time of one element.

use asperity_surface::height_field::{HeightField, MAX_BLOCK, PathBlock, SurfaceBlock};
use asperity_surface::height_map::{Extent, HeightMap};
use asperity_surface::raster::Raster;
use asperity_surface::wrap::Wrap;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const BLOCKS: usize = 512;
const EXTENT: Extent = Extent { width_m: 0.14, height_m: 0.14, relief_m: 0.004 };

fn map(size: usize) -> Raster {
    Raster::from_fn(size, size, |x, y| 0.5 + 0.3 * (x as f64 * 0.11).sin() * (y as f64 * 0.07).cos())
}

fn height_map(c: &mut Criterion) {
    let mut group = c.benchmark_group("height map");
    group.throughput(Throughput::Elements((MAX_BLOCK * BLOCKS) as u64)).sample_size(40);
    for (name, speed, rough_map) in [
        ("0.1 m/s", 0.1, false),
        ("0.1 m/s with roughness map", 0.1, true),
        ("1 m/s", 1.0, false),
        ("4 m/s, two mip levels", 4.0, false),
    ] {
        let mut map_under = HeightMap::new(&map(1024), EXTENT, Wrap::Repeat).expect("a valid map");
        if rough_map {
            map_under = map_under.with_roughness_map(&map(512)).expect("a valid map");
        }
        let step = speed / 44_100.0;
        let at = |n: usize| [0.02 + 0.8 * step * n as f64, 0.07 + 0.6 * step * n as f64];
        let positions: Vec<[f64; 2]> = (0..MAX_BLOCK * BLOCKS).map(at).collect();
        let velocity_m_s = [[0.8 * speed, 0.6 * speed]; MAX_BLOCK];
        let footprint_m = [step; MAX_BLOCK];
        let mut out = SurfaceBlock::default();
        group.bench_function(name, |b| {
            b.iter(|| {
                let mut sum = 0.0;
                for position_m in positions.chunks(MAX_BLOCK) {
                    let path = PathBlock {
                        position_m,
                        velocity_m_s: &velocity_m_s,
                        footprint_m: &footprint_m,
                        normal_force_n: &[],
                        first_sample: 0,
                        contact: 0,
                        slopes: true,
                        ..PathBlock::default()
                    };
                    map_under.sample(&path, &mut out);
                    sum += out.height_m[7];
                }
                sum
            });
        });
    }
    group.finish();
}

criterion_group!(benches, height_map);
criterion_main!(benches);
