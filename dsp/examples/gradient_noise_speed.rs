//! Prints nanoseconds per sample of value and gradient, one octave, for every kernel: points
//! anywhere, and the samples of a finger at 100 mm/s on sandpaper (cells of 0.2 mm).

use asperity_dsp::gradient_noise_3d::{GradientNoise3d, Noise3Batch};
use asperity_dsp::simd::Level;
use std::hint::black_box;
use std::time::Instant;

fn best_ns(count: usize, mut run: impl FnMut()) -> f64 {
    let time = |run: &mut dyn FnMut()| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64() * 1e9 / count as f64
    };
    (0..20_000).map(|_| time(&mut run)).fold(f64::INFINITY, f64::min)
}

fn main() {
    let noise = GradientNoise3d::new(1);
    let n = 512;
    let mut rng = asperity_dsp::rng::Rng::new(2);
    let axis: [Vec<f64>; 3] =
        core::array::from_fn(|_| (0..n).map(|_| rng.uniform() * 1000.0 - 500.0).collect());
    let step = 0.1 / 44_100.0 / 2e-4;
    let path: [Vec<f64>; 3] =
        [0.718, 0.513, 0.471].map(|along| (0..n).map(|i| 3.7 + along * step * i as f64).collect());
    let scalar = best_ns(n, || {
        let mut sum = 0.0;
        for ((&x, &y), &z) in axis[0].iter().zip(&axis[1]).zip(&axis[2]) {
            let noise = noise.at([x, y, z]);
            sum += noise.value + noise.gradient[0] + noise.gradient[1] + noise.gradient[2];
        }
        black_box(sum);
    });
    println!("one point at a time: {scalar:.2} ns");
    let mut out = [vec![0.0_f32; 64], vec![0.0; 64], vec![0.0; 64], vec![0.0; 64]];
    for level in Level::available() {
        let isa = level.isa();
        let noise = noise.on(level);
        let mut batches = |axis: &[Vec<f64>; 3]| {
            best_ns(n, || {
                for block in (0..n).step_by(64) {
                    let [value, dx, dy, dz] = &mut out;
                    let [x, y, z] = [0, 1, 2].map(|a| &axis[a][block..block + 64]);
                    noise.batch(x, y, z, &mut Noise3Batch { value, dx, dy, dz });
                }
                black_box(&out);
            })
        };
        let (anywhere, on_path) = (batches(&axis), batches(&path));
        println!("{isa:?}, blocks of 64: {anywhere:.2} ns anywhere, {on_path:.2} ns along a path");
    }
}
