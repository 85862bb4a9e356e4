//! Prints nanoseconds per sample of value and gradient, one octave, for every kernel.

use asperity_dsp::gradient_noise_3d::{GradientNoise3d, Kernel, Noise3Batch};
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
    for kernel in [Kernel::Portable, Kernel::Avx2, Kernel::Avx512] {
        if !kernel.is_available() {
            println!("{kernel:?}: not on this processor");
            continue;
        }
        let noise = noise.with_kernel(kernel);
        let ns = best_ns(n, || {
            for block in (0..n).step_by(64) {
                let [value, dx, dy, dz] = &mut out;
                let range = block..block + 64;
                noise.batch(
                    &axis[0][range.clone()],
                    &axis[1][range.clone()],
                    &axis[2][range],
                    &mut Noise3Batch { value, dx, dy, dz },
                );
            }
            black_box(&out);
        });
        println!("{kernel:?}, blocks of 64: {ns:.2} ns");
    }
}
