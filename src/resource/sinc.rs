//! Interpolation between samples: a sinc of [`LOBES`] zero crossings to either side under a Kaiser
//! window, from a table.

use std::sync::LazyLock;

/// Zero crossings to either side.
pub(crate) const LOBES: usize = 16;
/// Points between two zero crossings.
const POINTS: usize = 512;
/// Shape of the window: side lobes of −90 dB.
const BETA: f64 = 9.0;

/// One side of the kernel.
static KERNEL: LazyLock<Box<[f32]>> = LazyLock::new(|| {
    let bessel = |x: f64| {
        let term = |t: &mut f64, n: i32| {
            *t *= (x / (2.0 * f64::from(n))).powi(2);
            Some(*t)
        };
        1.0 + (1..60).scan(1.0, term).sum::<f64>()
    };
    let at = |point: usize| {
        let u = point as f64 / POINTS as f64;
        let phase = std::f64::consts::PI * u;
        let sinc = if point.is_multiple_of(POINTS) {
            f64::from(u8::from(point == 0))
        } else {
            libm::sin(phase) / phase
        };
        let edge = (1.0 - (u / LOBES as f64).powi(2)).max(0.0).sqrt();
        (sinc * bessel(BETA * edge) / bessel(BETA)) as f32
    };
    (0..=LOBES * POINTS + 1).map(at).collect()
});

/// Makes the table, so that nobody has to wait for it later.
pub(crate) fn prepare() {
    LazyLock::force(&KERNEL);
}

/// Weight of a sample at a distance, in samples of the lower rate.
pub(crate) fn kernel(distance: f64) -> f32 {
    let place = distance * POINTS as f64;
    let whole = (place as usize).min(LOBES * POINTS);
    let [a, b] = [KERNEL[whole], KERNEL[whole + 1]];
    a + (b - a) * (place - whole as f64).min(1.0) as f32
}

/// Samples at another rate, as many as last as long.
pub(crate) fn resampled(samples: &[f32], from_hz: f64, to_hz: f64) -> Vec<f32> {
    if from_hz == to_hz {
        return samples.to_vec();
    }
    let (step, cutoff) = (from_hz / to_hz, (to_hz / from_hz).min(1.0));
    let reach = LOBES as f64 / cutoff;
    let count = (samples.len() as f64 / step).ceil() as usize;
    let at = |n: usize| {
        let place = n as f64 * step;
        let [first, last] = [(place - reach).ceil().max(0.0) as usize, (place + reach).floor() as usize];
        let taps = (first..=last.min(samples.len() - 1))
            .map(|i| f64::from(samples[i]) * f64::from(kernel((i as f64 - place).abs() * cutoff)));
        (cutoff * taps.sum::<f64>()) as f32
    };
    (0..count).map(at).collect()
}
