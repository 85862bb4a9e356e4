//! Half-size copies of a map for contacts that move fast.

use crate::raster::Raster;
use crate::wrap::Wrap;
use std::f64::consts::PI;

/// Lobes of the windowed sinc on either side, in texels of the smaller map.
const LOBES: f64 = 4.0;

/// `value` of the map's numbers at half its size (rounded up), with the wavelengths that no longer
/// fit filtered out.
pub fn halve(raster: &Raster, value: impl Fn(f64) -> f64, wrap: Wrap) -> Raster {
    let (width, height) = (raster.width.div_ceil(2), raster.height.div_ceil(2));
    let columns = taps(raster.width, width, wrap);
    let mut line = vec![0.0; raster.width];
    let mut narrow = Vec::with_capacity(width * raster.height);
    for y in 0..raster.height {
        line.iter_mut().zip(raster.row(y)).for_each(|(out, &v)| *out = value(v));
        narrow.extend(columns.iter().map(|taps| taps.iter().map(|&(i, w)| w * line[i]).sum::<f64>()));
    }
    let mut values = vec![0.0; width * height];
    for (out, taps) in values.chunks_exact_mut(width).zip(taps(raster.height, height, wrap)) {
        for (y, w) in taps {
            let row = &narrow[y * width..][..width];
            out.iter_mut().zip(row).for_each(|(out, v)| *out += w * v);
        }
    }
    Raster { width, height, values }
}

/// Weighted texels of which each texel of the smaller row is made; itself where there is but one.
fn taps(from: usize, to: usize, wrap: Wrap) -> Vec<Vec<(usize, f64)>> {
    (0..to).map(|i| if from == to { vec![(i, 1.0)] } else { taps_of(i, from, to, wrap) }).collect()
}

/// Which texels make texel `i` of the smaller row, and with what weights (their sum is 1).
fn taps_of(i: usize, from: usize, to: usize, wrap: Wrap) -> Vec<(usize, f64)> {
    let ratio = from as f64 / to as f64;
    let centre = (i as f64 + 0.5) * ratio - 0.5;
    let reach = LOBES * ratio;
    let (first, last) = ((centre - reach).ceil() as i64, (centre + reach).floor() as i64);
    let weight = |k: i64| {
        let t = (k as f64 - centre) / ratio;
        sinc(t) * sinc(t / LOBES)
    };
    let total: f64 = (first..=last).map(weight).sum();
    (first..=last).map(|k| (wrap.index(k, from), weight(k) / total)).collect()
}

fn sinc(t: f64) -> f64 {
    if t == 0.0 { 1.0 } else { libm::sin(PI * t) / (PI * t) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(n: usize, periods: f64) -> Raster {
        Raster::from_fn(n, 3, |x, _| (2.0 * PI * periods * (x as f64 + 0.5) / n as f64).cos())
    }

    #[test]
    fn a_long_wave_survives_halving_and_a_short_one_does_not() {
        for n in [64, 75] {
            let small = halve(&wave(n, 6.0), |v| v, Wrap::Repeat);
            assert_eq!((small.width, small.height), (n.div_ceil(2), 2));
            for (x, value) in small.row(0).iter().enumerate() {
                let expected = (2.0 * PI * 6.0 * (x as f64 + 0.5) / small.width as f64).cos();
                assert!((value - expected).abs() < 0.01, "{n}: {x}: {value} {expected}");
            }
            let short = halve(&wave(n, (0.42 * n as f64).round()), |v| v, Wrap::Repeat);
            assert!(short.row(0).iter().all(|v| v.abs() < 0.1), "{n}: {:?}", short.range());
        }
    }

    #[test]
    fn a_constant_stays_a_constant_whatever_its_size() {
        for n in 1..20 {
            let small = halve(&Raster::constant(n, 20 - n, 0.3), |v| v, Wrap::Clamp);
            assert!(small.values.iter().all(|v| (v - 0.3).abs() < 1e-15));
        }
    }
}
