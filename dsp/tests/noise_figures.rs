//! The micro-relief against its law: slope, level, speed, aliasing, revisits, instruction sets.

use crate::spectrum;

use asperity_dsp::fractal_noise::{FractalNoise, NoisePath, OctaveWeights};
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::Level;
use spectrum::power;

const RATE_HZ: f64 = 44_100.0;

/// `len` samples of a straight stroke somewhere, at some angle.
fn stroke(rng: &mut Rng, len: usize, step_m: f64) -> Vec<[f64; 2]> {
    let angle = rng.uniform() * std::f64::consts::TAU;
    let start = [rng.uniform() * 10.0, rng.uniform() * 10.0];
    let at =
        |n: usize| [start[0] + angle.cos() * step_m * n as f64, start[1] + angle.sin() * step_m * n as f64];
    (0..len).map(at).collect()
}

fn relief(noise: &FractalNoise, positions: &[[f64; 2]], footprint_m: f64, roughness: f64) -> Vec<f64> {
    let mut height = vec![0.0; positions.len()];
    let footprints = vec![footprint_m; positions.len()];
    let path = NoisePath { position_m: positions, footprint_m: &footprints };
    noise.add(
        &path,
        &vec![roughness; positions.len()],
        &OctaveWeights::pinned(1.0, f64::INFINITY),
        &mut height,
    );
    height
}

/// Mean power per bin over many strokes at a speed.
fn mean_power(roughness: f64, speed_m_s: f64, len: usize, strokes: u64) -> Vec<f64> {
    mean_power_at(RATE_HZ, roughness, speed_m_s, len, strokes)
}

/// [`mean_power`] at another sample rate.
fn mean_power_at(rate_hz: f64, roughness: f64, speed_m_s: f64, len: usize, strokes: u64) -> Vec<f64> {
    let step_m = speed_m_s / rate_hz;
    let mut mean = vec![0.0; len / 2];
    for seed in 0..strokes {
        let noise = FractalNoise::new(seed);
        let positions = stroke(&mut Rng::new(seed), len, step_m);
        let heights = relief(&noise, &positions, step_m, roughness);
        for (mean, power) in mean.iter_mut().zip(power(&heights)) {
            *mean += power / strokes as f64;
        }
    }
    mean
}

/// Power between two frequencies, dB.
fn band_db(power: &[f64], from_hz: f64, to_hz: f64) -> f64 {
    band_db_at(RATE_HZ, power, from_hz, to_hz)
}

fn band_db_at(rate_hz: f64, power: &[f64], from_hz: f64, to_hz: f64) -> f64 {
    let bin_hz = 0.5 * rate_hz / power.len() as f64;
    let inside = power.iter().enumerate().filter(|(k, _)| (from_hz..to_hz).contains(&(*k as f64 * bin_hz)));
    10.0 * inside.map(|(_, p)| p).sum::<f64>().log10()
}

fn third_octave_db(power: &[f64], centre_hz: f64) -> f64 {
    third_octave_db_at(RATE_HZ, power, centre_hz)
}

fn third_octave_db_at(rate_hz: f64, power: &[f64], centre_hz: f64) -> f64 {
    band_db_at(rate_hz, power, centre_hz * 2f64.powf(-1.0 / 6.0), centre_hz * 2f64.powf(1.0 / 6.0))
}

/// Slope and largest deviation from the straight line of equally spaced values.
fn line(values: &[f64], spacing: f64) -> (f64, f64) {
    let n = values.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let mean = values.iter().sum::<f64>() / n;
    let at = |i: usize| i as f64 - middle;
    let slope = values.iter().enumerate().map(|(i, v)| at(i) * (v - mean)).sum::<f64>()
        / values.iter().enumerate().map(|(i, _)| at(i) * at(i)).sum::<f64>();
    let worst = values.iter().enumerate().map(|(i, v)| (v - mean - slope * at(i)).abs()).fold(0.0, f64::max);
    (slope / spacing, worst)
}

// Bar of the project: ±0.1 dB per octave of −3.01 α over 2.5 decades (here 12.5 Hz – 4 kHz at 0.1
// m/s). The levels come from dsp/tests/independent/noise_spectrum.py.
#[test]
fn the_spectrum_falls_by_3_db_alpha_per_octave() {
    let figures = [
        (0.0, 2.5, [5.73, -5.29, -15.40, -25.68]),
        (1.0 / 3.0, 2.0, [2.25, -5.09, -11.76, -18.68]),
        (2.0 / 3.0, 1.5, [-1.25, -4.94, -8.20, -11.71]),
        (1.0, 1.0, [-4.77, -4.86, -4.72, -4.75]),
    ];
    for (roughness, alpha, levels_db) in figures {
        let power = mean_power(roughness, 0.1, 1 << 16, 64);
        // A third-octave band widens with frequency: 1/f^α falls by 3.01 (α − 1) dB per octave
        // there.
        let bands: Vec<f64> =
            (0..26).map(|i| third_octave_db(&power, 12.5 * 2f64.powf(f64::from(i) / 3.0))).collect();
        let (slope, worst) = line(&bands, 1.0 / 3.0);
        let error = slope + 3.0103 * (alpha - 1.0);
        println!("α {alpha}: slope error {error:.3} dB/oct, largest third-octave residual {worst:.2} dB");
        assert!(error.abs() < 0.1, "α {alpha}: {error} dB/oct");
        assert!(worst < 1.5, "α {alpha}: {worst} dB off the line");
        for (centre, level) in [20.0, 100.0, 500.0, 2500.0].into_iter().zip(levels_db) {
            let measured = third_octave_db(&power, centre);
            assert!((measured - level).abs() < 1.0, "α {alpha}, {centre} Hz: {measured} for {level} dB");
        }
    }
}

/// Wavelengths near the sample period are faded out, so at 22.05 kHz the two and a half decades end
/// at 2 kHz.
#[test]
fn the_slope_holds_at_every_sample_rate() {
    for (rate_hz, len, lowest_hz) in [
        (22_050.0, 1 << 16, 6.25),
        (48_000.0, 1 << 16, 12.5),
        (96_000.0, 1 << 17, 12.5),
        (192_000.0, 1 << 18, 12.5),
    ] {
        for (roughness, alpha) in [(0.0, 2.5), (1.0, 1.0)] {
            let power = mean_power_at(rate_hz, roughness, 0.1, len, 64);
            let band =
                |i: u32| third_octave_db_at(rate_hz, &power, lowest_hz * 2f64.powf(f64::from(i) / 3.0));
            let (slope, _) = line(&(0..26).map(band).collect::<Vec<_>>(), 1.0 / 3.0);
            let error = slope + 3.0103 * (alpha - 1.0);
            println!("{rate_hz} Hz, α {alpha}: slope error {error:.3} dB/oct");
            assert!(error.abs() < 0.1, "{rate_hz} Hz, α {alpha}: {error} dB/oct");
        }
    }
}

#[test]
fn the_octave_about_one_millimetre_has_the_wanted_rms() {
    for roughness in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let power = mean_power(roughness, 0.1, 1 << 15, 48);
        let level = band_db(&power, 100.0 / 2f64.sqrt(), 100.0 * 2f64.sqrt());
        println!("R {roughness}: {level:.2} dB");
        assert!(level.abs() < 0.3, "R {roughness}: {level} dB");
    }
}

// Bar of the project: ±0.1 dB of 6.02 (α − 1).
#[test]
fn four_times_the_speed_raises_the_level_by_alphas_law() {
    for (roughness, alpha) in [(0.0, 2.5), (1.0 / 3.0, 2.0), (2.0 / 3.0, 1.5), (1.0, 1.0)] {
        let (slow, fast) =
            (mean_power(roughness, 0.1, 1 << 14, 200), mean_power(roughness, 0.4, 1 << 14, 200));
        let centres: Vec<f64> = (0..12).map(|i| 200.0 * 2f64.powf(f64::from(i) / 3.0)).collect();
        let rise = |hz: &f64| third_octave_db(&fast, *hz) - third_octave_db(&slow, *hz);
        let mean = centres.iter().map(rise).sum::<f64>() / centres.len() as f64;
        let error = mean - 6.0206 * (alpha - 1.0);
        println!("α {alpha}: rise {mean:.3} dB, error {error:.3} dB");
        assert!(error.abs() < 0.1, "α {alpha}: {mean} dB");
    }
}

/// A stroke sampled 16 times as densely shows what lies above half the sample rate.
#[test]
fn what_the_sample_rate_cannot_hold_is_at_least_40_db_down() {
    const DENSER: usize = 16;
    for speed in [0.03, 0.09, 0.13, 0.18, 0.5, 2.0] {
        let step = speed / RATE_HZ;
        let (mut kept, mut lost) = (0.0, 0.0);
        for seed in 0..4 {
            let noise = FractalNoise::new(seed);
            let positions = stroke(&mut Rng::new(seed), 1 << 16, step / DENSER as f64);
            let power = power(&relief(&noise, &positions, step, 1.0));
            let limit = power.len() / DENSER;
            kept += power[..limit].iter().sum::<f64>();
            lost += power[limit..].iter().sum::<f64>();
        }
        let alias_db = 10.0 * (lost / kept).log10();
        println!("{speed} m/s: {alias_db:.1} dB");
        assert!(alias_db < -40.0, "{speed} m/s: {alias_db} dB");
    }
}

#[test]
fn the_same_place_has_the_same_height_out_and_back() {
    let noise = FractalNoise::new(5);
    for origin in [0.0, 1.4e5] {
        let step = 0.1 / RATE_HZ;
        let out: Vec<[f64; 2]> = (0..5000)
            .map(|n| [origin + 0.8 * step * f64::from(n), -origin + 0.6 * step * f64::from(n)])
            .collect();
        let back: Vec<[f64; 2]> = out.iter().rev().copied().collect();
        let (there, here) = (relief(&noise, &out, step, 0.3), relief(&noise, &back, step, 0.3));
        assert!(there.iter().eq(here.iter().rev()), "bits differ {origin} m away");
        // … and a place that is the same but for rounding is as high but for rounding, at 2 µm of
        // relief.
        let near: Vec<[f64; 2]> = out.iter().map(|p| [p[0] + 1e-12, p[1] - 1e-12]).collect();
        let worst = there
            .iter()
            .zip(relief(&noise, &near, step, 0.3))
            .fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        assert!(worst * 2e-6 < 1e-9, "{worst}");
    }
}

/// A path with everything changing: speed, direction, roughness.
fn wild(len: usize) -> (Vec<[f64; 2]>, Vec<f64>, Vec<f64>) {
    let mut rng = Rng::new(11);
    let mut at = [3.0, -2.0];
    let mut path = (Vec::new(), Vec::new(), Vec::new());
    for n in 0..len {
        let step = 1e-8 * 10f64.powf(4.0 * rng.uniform());
        at[0] += step * (n as f64 * 0.01).cos();
        at[1] += step * (n as f64 * 0.013).sin();
        path.0.push(at);
        path.1.push(if n % 50 == 0 { 0.0 } else { step });
        path.2.push(rng.uniform() * 1.2 - 0.1);
    }
    path
}

#[test]
fn blocks_and_instruction_sets_do_not_change_a_bit() {
    let (position_m, footprint_m, roughness) = wild(3000);
    let whole = |level| {
        let mut height = vec![1e-5; 3000];
        let path = NoisePath { position_m: &position_m, footprint_m: &footprint_m };
        FractalNoise::new(7).on(level).add(
            &path,
            &roughness,
            &OctaveWeights::pinned(2e-6, 3e-3),
            &mut height,
        );
        height
    };
    let portable = whole(Level::PORTABLE);
    assert!(portable.iter().all(|h| h.is_finite()));
    for level in Level::available() {
        assert!(whole(level) == portable, "{level:?} differs");
    }
    let noise = FractalNoise::new(7);
    let mut rng = Rng::new(2);
    let mut height = vec![1e-5; 3000];
    let mut n = 0;
    while n < height.len() {
        let end = (n + 1 + rng.next_u32() as usize % 70).min(height.len());
        let path = NoisePath { position_m: &position_m[n..end], footprint_m: &footprint_m[n..end] };
        noise.add(&path, &roughness[n..end], &OctaveWeights::pinned(2e-6, 3e-3), &mut height[n..end]);
        n = end;
    }
    assert!(height == portable, "blocks differ");
}

/// Alone, a sample finds no cell that another has left behind.
#[test]
fn cells_kept_from_sample_to_sample_do_not_change_a_bit() {
    const LEN: usize = 1500;
    let mut rng = Rng::new(21);
    for step in [0.0, 1e-9, 1e-7, 2e-6, 1e-5, 1e-3] {
        let mut position_m = stroke(&mut rng, LEN, step);
        for n in 0..40 {
            position_m[600 - n] = position_m[560 + n]; // back on itself
        }
        position_m[700] = [f64::NAN, 0.3];
        position_m[801] = [f64::INFINITY, -1e300];
        position_m[902] = [3e6, -2e7]; // a jump there and back
        let footprint_m: Vec<f64> =
            (0..LEN).map(|n| if n % 97 == 0 { step * 3.9 } else { step.min(3e-6) }).collect();
        let roughness: Vec<f64> = (0..LEN).map(|n| if n < 300 { 0.4 } else { n as f64 / 1000.0 }).collect();
        let heights = |noise: &FractalNoise, block: usize| {
            let mut height = vec![0.0; LEN];
            for start in (0..LEN).step_by(block) {
                let range = start..(start + block).min(LEN);
                let path = NoisePath {
                    position_m: &position_m[range.clone()],
                    footprint_m: &footprint_m[range.clone()],
                };
                noise.add(
                    &path,
                    &roughness[range.clone()],
                    &OctaveWeights::pinned(2e-6, f64::INFINITY),
                    &mut height[range],
                );
            }
            height
        };
        for level in Level::available() {
            let noise = FractalNoise::new(9).on(level);
            let alone = heights(&noise, 1);
            assert!(alone.iter().all(|h| h.is_finite()));
            assert!(heights(&noise, LEN) == alone, "{level:?}, {step} m a sample");
        }
    }
}

#[test]
fn octaves_longer_than_the_sources_own_band_are_left_to_the_source() {
    let noise = FractalNoise::new(3);
    let positions = stroke(&mut Rng::new(3), 1 << 16, 0.1 / RATE_HZ);
    let footprints = vec![0.1 / RATE_HZ; positions.len()];
    let spectrum = |longest_m: f64| {
        let mut height = vec![0.0; positions.len()];
        let path = NoisePath { position_m: &positions, footprint_m: &footprints };
        noise.add(&path, &vec![0.0; positions.len()], &OctaveWeights::pinned(1.0, longest_m), &mut height);
        power(&height)
    };
    let (all, fine) = (spectrum(f64::INFINITY), spectrum(0.3e-3));
    // 0.3 mm at 0.1 m/s is 333 Hz.
    let change = |from_hz: f64, to_hz: f64| band_db(&fine, from_hz, to_hz) - band_db(&all, from_hz, to_hz);
    assert!(change(20.0, 100.0) < -20.0, "{}", change(20.0, 100.0));
    assert!(change(1000.0, 4000.0).abs() < 0.5, "{}", change(1000.0, 4000.0));
}
