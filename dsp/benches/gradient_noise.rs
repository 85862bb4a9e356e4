//! Value and gradient of one octave: ns per sample is the printed time of one element.

use asperity_dsp::gradient_noise_3d::{GradientNoise3d, Noise3Batch};
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::Level;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

const POINTS: usize = 512;

fn gradient_noise(c: &mut Criterion) {
    let mut group = c.benchmark_group("gradient noise");
    group.throughput(Throughput::Elements(POINTS as u64)).sample_size(40);
    let mut rng = Rng::new(2);
    let anywhere: [Vec<f64>; 3] =
        core::array::from_fn(|_| (0..POINTS).map(|_| rng.uniform() * 1000.0 - 500.0).collect());
    // 100 mm/s at 44.1 kHz over cells of 0.2 mm.
    let path: [Vec<f64>; 3] =
        [0.718, 0.513, 0.471].map(|along| (0..POINTS).map(|i| 3.7 + along * 0.0113 * i as f64).collect());
    let noise = GradientNoise3d::new(1);
    group.bench_function("one point at a time", |b| {
        b.iter(|| {
            let [x, y, z] = black_box(&anywhere);
            let points = x.iter().zip(y).zip(z).map(|((&x, &y), &z)| noise.at([x, y, z]));
            points.fold(0.0, |sum, n| sum + n.value + n.gradient[0] + n.gradient[1] + n.gradient[2])
        });
    });
    let mut out = [vec![0.0; POINTS], vec![0.0; POINTS], vec![0.0; POINTS], vec![0.0; POINTS]];
    for level in Level::available() {
        let noise = noise.on(level);
        for (name, axis) in [("anywhere", &anywhere), ("along a path", &path)] {
            group.bench_function(format!("batch {name}, {:?}", level.isa()), |b| {
                b.iter(|| {
                    let [value, dx, dy, dz] = &mut out;
                    let [x, y, z] = black_box(axis);
                    noise.batch(x, y, z, &mut Noise3Batch { value, dx, dy, dz });
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, gradient_noise);
criterion_main!(benches);
