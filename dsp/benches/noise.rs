//! Micro-relief with all 12 octaves alive (0.09 m/s at 44.1 kHz), by instruction set: ns per sample
//! is the printed time of one element.

use asperity_dsp::fractal_noise::{FractalNoise, NoisePath, OctaveWeights};
use asperity_dsp::simd::Level;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

const BLOCK: usize = 64;
const BLOCKS: usize = 512;

fn path(speed_m_s: f64) -> (Vec<[f64; 2]>, Vec<f64>) {
    let step = speed_m_s / 44_100.0;
    let positions = (0..BLOCK * BLOCKS).map(|n| [0.02 + 0.8 * step * n as f64, 0.07 + 0.6 * step * n as f64]);
    (positions.collect(), vec![step; BLOCK * BLOCKS])
}

fn noise(c: &mut Criterion) {
    let mut group = c.benchmark_group("noise");
    group.throughput(Throughput::Elements((BLOCK * BLOCKS) as u64)).sample_size(40);
    let roughness = vec![0.5; BLOCK];
    for (name, speed, longest) in [("12 octaves", 0.09, f64::INFINITY), ("below a 0.3 mm map", 0.09, 3e-4)] {
        let (positions, footprints) = path(speed);
        for level in Level::available() {
            let noise = FractalNoise::new(1).on(level);
            let mut height = vec![0.0; BLOCK * BLOCKS];
            group.bench_function(format!("{name}, {:?}", level.isa()), |b| {
                b.iter(|| {
                    let blocks = positions.chunks(BLOCK).zip(footprints.chunks(BLOCK));
                    for ((position_m, footprint_m), out) in blocks.zip(height.chunks_mut(BLOCK)) {
                        let path = NoisePath { position_m, footprint_m };
                        noise.add(&path, &roughness, &OctaveWeights::pinned(2e-6, black_box(longest)), out);
                    }
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, noise);
criterion_main!(benches);
