//! The height map against closed forms, scipy, and itself far away.

use asperity_dsp::rng::Rng;
use asperity_surface::height_field::{HeightField, MAX_BLOCK, PathBlock, SurfaceBlock, WavelengthBand};
use asperity_surface::height_map::{Extent, HeightMap, MapError};
use asperity_surface::raster::Raster;
use asperity_surface::wrap::Wrap;
use std::f64::consts::TAU;

const RATE_HZ: f64 = 44_100.0;
const EXTENT: Extent = Extent { width_m: 0.14, height_m: 0.14, relief_m: 0.004 };

#[derive(Debug, Clone, Copy, PartialEq)]
struct Seen {
    height_m: f64,
    gradient: [f64; 2],
    roughness: f64,
}

/// A map along a path, in blocks of `block` samples.
fn along(map: &mut HeightMap, positions: &[[f64; 2]], velocity: [f64; 2], block: usize) -> Vec<Seen> {
    along_at(RATE_HZ, map, positions, velocity, block)
}

/// [`along`] at another sample rate.
fn along_at(
    rate_hz: f64,
    map: &mut HeightMap,
    positions: &[[f64; 2]],
    velocity: [f64; 2],
    block: usize,
) -> Vec<Seen> {
    let footprint = velocity[0].hypot(velocity[1]) / rate_hz;
    let mut seen = Vec::new();
    let mut out = SurfaceBlock::default();
    for position_m in positions.chunks(block) {
        let path = PathBlock {
            position_m,
            velocity_m_s: &[velocity; MAX_BLOCK][..position_m.len()],
            footprint_m: &[footprint; MAX_BLOCK][..position_m.len()],
            normal_force_n: &[],
            first_sample: seen.len() as u64,
            contact: 0,
            slopes: true,
            ..PathBlock::default()
        };
        map.sample(&path, &mut out);
        seen.extend((0..position_m.len()).map(|n| Seen {
            height_m: out.height_m[n],
            gradient: out.gradient[n],
            roughness: out.roughness[n],
        }));
    }
    seen
}

fn stroke(start: [f64; 2], velocity: [f64; 2], len: usize) -> Vec<[f64; 2]> {
    stroke_at(RATE_HZ, start, velocity, len)
}

fn stroke_at(rate_hz: f64, start: [f64; 2], velocity: [f64; 2], len: usize) -> Vec<[f64; 2]> {
    (0..len)
        .map(|n| n as f64 / rate_hz)
        .map(|t| [start[0] + velocity[0] * t, start[1] + velocity[1] * t])
        .collect()
}

// tests/independent/spline.py: scipy.ndimage.map_coordinates, order 3, modes grid-wrap,
// reflect and nearest (which settles its prefilter over 12 texels: 1e-6).
#[test]
fn heights_between_texels_agree_with_scipy() {
    let texels = Raster::from_fn(7, 5, |x, y| ((x * 37 + y * 91 + x * x * y * 13) % 101) as f64 / 101.0);
    let points = [(0.0, 0.0), (0.3, 0.7), (3.25, 1.5), (6.4, 4.2), (-0.35, 2.1), (5.9, -0.45)];
    for (wrap, figures) in [
        (Wrap::Repeat, [0.0, 0.571_750_574, 0.231_774_978, 0.297_065_736, 0.687_318_627, 0.158_606_725]),
        (Wrap::Mirror, [0.0, 0.600_009_8, 0.225_175_278, 0.240_721_647, 0.860_054_618, 0.122_140_624]),
        (Wrap::Clamp, [0.0, 0.594_895_909, 0.225_762_684, 0.276_592_478, 0.825_899_805, 0.176_275_335]),
    ] {
        let extent = Extent { width_m: 0.07, height_m: 0.05, relief_m: 1.0 };
        let mut map = HeightMap::new(&texels, extent, wrap).unwrap();
        let positions = points.map(|(x, y)| [(x + 0.5) * 0.01, (y + 0.5) * 0.01]);
        for (seen, figure) in along(&mut map, &positions, [0.0; 2], 64).iter().zip(figures) {
            assert!((seen.height_m - figure).abs() < 2e-6, "{wrap:?}: {} for {figure}", seen.height_m);
        }
    }
}

#[test]
fn texel_centres_have_the_texels_heights_in_every_wrap_mode() {
    let mut rng = Rng::new(1);
    let texels = Raster::from_fn(13, 9, |_, _| rng.uniform());
    for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
        let mut map = HeightMap::new(&texels, Extent { height_m: 0.07, ..EXTENT }, wrap).unwrap();
        for (i, value) in texels.values.iter().enumerate() {
            let (x, y) = ((i % 13) as f64 + 0.5, (i / 13) as f64 + 0.5);
            let seen = along(&mut map, &[[x / 13.0 * 0.14, y / 9.0 * 0.07]], [0.0; 2], 64)[0];
            assert!((seen.height_m - 0.004 * value).abs() < 2e-9, "{wrap:?} {i}");
        }
    }
}

#[test]
fn the_slope_is_the_derivative_of_the_height_in_every_wrap_mode() {
    let mut rng = Rng::new(2);
    let texels = Raster::from_fn(16, 12, |_, _| rng.uniform());
    for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
        let mut map = HeightMap::new(&texels, EXTENT, wrap).unwrap();
        for _ in 0..300 {
            let p = [rng.uniform() * 0.5 - 0.2, rng.uniform() * 0.5 - 0.2];
            let d = 1e-7;
            let around = [p, [p[0] + d, p[1]], [p[0] - d, p[1]], [p[0], p[1] + d], [p[0], p[1] - d]];
            let s = along(&mut map, &around, [0.0; 2], 64);
            let numeric =
                [(s[1].height_m - s[2].height_m) / (2.0 * d), (s[3].height_m - s[4].height_m) / (2.0 * d)];
            for axis in 0..2 {
                let error = (s[0].gradient[axis] - numeric[axis]).abs();
                assert!(error < 2e-4, "{wrap:?} {p:?}: {:?} {numeric:?}", s[0].gradient);
            }
        }
    }
}

/// Power outside the fundamental of a signal that is a sine of known frequency, dB below it.
fn snr_db(signal: &[f64], radians_per_sample: f64) -> f64 {
    // Least squares for a sine, a cosine and a constant: over many periods they are orthogonal
    // enough after two rounds.
    let mut rest = signal.to_vec();
    let mut tone = [0.0; 2];
    for _ in 0..6 {
        let n = rest.len() as f64;
        let mean = rest.iter().sum::<f64>() / n;
        let (mut s, mut c) = (0.0, 0.0);
        for (i, x) in rest.iter().enumerate() {
            let (sin, cos) = (radians_per_sample * i as f64).sin_cos();
            s += 2.0 * (x - mean) * sin / n;
            c += 2.0 * (x - mean) * cos / n;
        }
        tone = [tone[0] + s, tone[1] + c];
        for (i, x) in rest.iter_mut().enumerate() {
            let (sin, cos) = (radians_per_sample * i as f64).sin_cos();
            *x -= mean + s * sin + c * cos;
        }
    }
    let noise = rest.iter().map(|x| x * x).sum::<f64>() / rest.len() as f64;
    10.0 * (0.5 * (tone[0] * tone[0] + tone[1] * tone[1]) / noise).log10()
}

// Bar of the project: velocity SNR ≥ 60 dB on an oblique path over a 16-bit sine of 12.8 texels a
// period.
#[test]
fn an_oblique_stroke_on_16_bits_exceeds_60_db_velocity_snr() {
    let sine = Raster::from_fn(1024, 1024, |x, _| {
        let value = 0.5 + 0.5 * (TAU * (x as f64 + 0.5) / 12.8).sin();
        (value * 65_535.0).round() / 65_535.0
    });
    let mut map = HeightMap::new(&sine, EXTENT, Wrap::Repeat).unwrap();
    let angle = 20f64.to_radians();
    let velocity = [0.1 * angle.cos(), 0.1 * angle.sin()];
    for rate in [22_050.0, RATE_HZ, 48_000.0, 96_000.0, 192_000.0] {
        let path = stroke_at(rate, [0.01, 0.02], velocity, (2.0 * rate) as usize);
        let seen = along_at(rate, &mut map, &path, velocity, 64);
        let per_sample = TAU * velocity[0] / rate / (12.8 * 0.14 / 1024.0);
        let heights: Vec<f64> = seen.iter().map(|s| s.height_m).collect();
        let differences: Vec<f64> = heights.windows(2).map(|w| (w[1] - w[0]) * rate).collect();
        let slope = |s: &Seen| s.gradient[0] * velocity[0] + s.gradient[1] * velocity[1];
        let slopes: Vec<f64> = seen.iter().map(slope).collect();
        let [height, felt, analytic] = [&heights, &differences, &slopes].map(|x| snr_db(x, per_sample));
        println!(
            "{rate} Hz: SNR of the height {height:.1} dB, velocity {felt:.1} dB, from the gradient {analytic:.1} dB"
        );
        assert!(height > 80.0 && felt > 60.0 && analytic > 60.0, "{rate} Hz: {height} {felt} {analytic}");
    }
}

#[test]
fn a_million_periods_away_the_surface_is_the_same() {
    let mut rng = Rng::new(3);
    let texels = Raster::from_fn(64, 64, |_, _| rng.uniform());
    for wrap in [Wrap::Repeat, Wrap::Mirror] {
        let mut map = HeightMap::new(&texels, EXTENT, wrap).unwrap();
        for periods in [1e6, -1e6] {
            let near = stroke([0.013, 0.057], [0.3, -0.2], 500);
            let far: Vec<[f64; 2]> = near.iter().map(|p| p.map(|x| x + 2.0 * periods * 0.14)).collect();
            let (near, far) = (along(&mut map, &near, [0.0; 2], 64), along(&mut map, &far, [0.0; 2], 64));
            for (a, b) in near.iter().zip(far) {
                assert!((a.height_m - b.height_m).abs() < 1e-9, "{wrap:?} {periods}");
            }
        }
    }
}

#[test]
fn positions_that_make_no_sense_give_finite_heights() {
    let mut map =
        HeightMap::new(&Raster::from_fn(8, 8, |x, y| (x * y) as f64), EXTENT, Wrap::Repeat).unwrap();
    for x in [1e300, -1e300, 1e16, f64::MAX, f64::NAN, f64::INFINITY] {
        let seen = along(&mut map, &[[x, 0.01], [0.01, x]], [0.1, 0.0], 64);
        assert!(
            seen.iter().all(|s| s.height_m.is_finite() && s.gradient.iter().all(|g| g.is_finite())),
            "{x}"
        );
    }
}

#[test]
fn any_split_into_blocks_gives_the_same_bits() {
    let mut rng = Rng::new(4);
    let texels = Raster::from_fn(50, 31, |_, _| rng.uniform());
    let mut map = HeightMap::new(&texels, EXTENT, Wrap::Mirror).unwrap().with_roughness_map(&texels).unwrap();
    for speed in [0.05, 30.0, 130.0] {
        let velocity = [0.8 * speed, -0.6 * speed];
        let path = stroke([0.0, 0.0], velocity, 2000);
        let whole = along(&mut map, &path, velocity, 64);
        for block in [1, 3, 17] {
            assert!(along(&mut map, &path, velocity, block) == whole, "{speed} m/s, blocks of {block}");
        }
    }
}

/// Random texels are all wavelengths at once: what is shorter than two footprints must go.
#[test]
fn an_accelerating_stroke_is_blurred_alike_wherever_it_is_cut() {
    let mut rng = Rng::new(21);
    let texels = Raster::from_fn(50, 31, |_, _| rng.uniform());
    let mut map = HeightMap::new(&texels, EXTENT, Wrap::Repeat).unwrap().with_roughness_map(&texels).unwrap();
    // From standing to a footprint of the whole map, through every level, several in one block.
    let footprints: Vec<f64> = (0..200).map(|n| 0.2 * (f64::from(n) / 200.0).powi(6)).collect();
    let positions: Vec<[f64; 2]> = (0..200).map(|n| [3e-4 * f64::from(n), 2e-4 * f64::from(n)]).collect();
    let velocities: Vec<[f64; 2]> =
        footprints.iter().map(|f| [0.8 * f * RATE_HZ, 0.6 * f * RATE_HZ]).collect();
    let mut seen = |block: usize| {
        let mut heights = Vec::new();
        let mut out = SurfaceBlock::default();
        for start in (0..200).step_by(block) {
            let cut = start..(start + block).min(200);
            let path = PathBlock {
                position_m: &positions[cut.clone()],
                velocity_m_s: &velocities[cut.clone()],
                footprint_m: &footprints[cut.clone()],
                normal_force_n: &[],
                first_sample: start as u64,
                contact: 0,
                slopes: true,
                ..PathBlock::default()
            };
            map.sample(&path, &mut out);
            heights.extend((0..cut.len()).map(|n| (out.height_m[n], out.gradient[n], out.roughness[n])));
        }
        heights
    };
    let whole = seen(MAX_BLOCK);
    for block in [1, 3, 17] {
        assert!(seen(block) == whole, "blocks of {block}");
    }
    let mean = texels.values.iter().sum::<f64>() / texels.values.len() as f64;
    let (last, _, roughness) = whole[199];
    assert!((last / EXTENT.relief_m - mean).abs() < 0.02 && (roughness - mean).abs() < 0.02, "{last}");
}

#[test]
fn a_fast_finger_does_not_alias() {
    // 8 texels a period: at 4 footprints a period all there, at 1.5 all gone.
    let fine = Raster::from_fn(512, 4, |x, _| 0.5 + 0.5 * (TAU * x as f64 / 8.0).cos());
    let mut map = HeightMap::new(&fine, EXTENT, Wrap::Repeat).unwrap();
    let period = 8.0 * 0.14 / 512.0;
    let rms = |map: &mut HeightMap, speed: f64| {
        let seen = along(map, &stroke([0.0; 2], [speed, 0.0], 4000), [speed, 0.0], 64);
        let mean = seen.iter().map(|s| s.height_m).sum::<f64>() / 4000.0;
        (seen.iter().map(|s| (s.height_m - mean).powi(2)).sum::<f64>() / 4000.0).sqrt()
    };
    let slow = rms(&mut map, 0.1);
    assert!((slow / (0.002 / 2f64.sqrt()) - 1.0).abs() < 0.03, "{slow}");
    let fast = rms(&mut map, period / 1.5 * RATE_HZ);
    println!("1.5 samples a period: {:.1} dB", 20.0 * (fast / slow).log10());
    assert!(fast / slow < 0.01, "{}", fast / slow);
}

#[test]
fn the_blur_sets_in_smoothly_with_speed() {
    let mut rng = Rng::new(6);
    let texels = Raster::from_fn(64, 64, |_, _| rng.uniform());
    let mut map = HeightMap::new(&texels, EXTENT, Wrap::Repeat).unwrap();
    let texel = 0.14 / 64.0;
    let height = |map: &mut HeightMap, samples: f64| {
        along(map, &[[0.05, 0.06]], [0.0, 0.5 * samples * texel * RATE_HZ], 1)[0].height_m
    };
    let mut before = height(&mut map, 0.5);
    for step in 1..4000 {
        let now = height(&mut map, 0.5 * 1.002f64.powi(step));
        assert!((now - before).abs() < 2e-5, "jump of {} m at step {step}", now - before);
        before = now;
    }
}

#[test]
fn a_constant_map_has_no_band_and_other_maps_have_theirs() {
    let flat = HeightMap::flat(EXTENT, 0.7).unwrap();
    assert_eq!(flat.properties([1.0; 2]).band, WavelengthBand::EMPTY);
    let grey = HeightMap::new(&Raster::constant(16, 16, 0.5), EXTENT, Wrap::Repeat).unwrap();
    assert_eq!(grey.properties([1.0; 2]).band, WavelengthBand::EMPTY);
    let seen = along(&mut flat.clone(), &[[0.1, 0.2]], [0.1, 0.0], 64)[0];
    assert_eq!((seen.height_m, seen.gradient, seen.roughness), (0.0, [0.0; 2], 0.7));
    let map = HeightMap::new(&Raster::from_fn(100, 50, |x, _| x as f64), EXTENT, Wrap::Clamp).unwrap();
    let band = map.properties([1.0; 2]).band;
    assert!((band.shortest_m - 2.8e-3).abs() < 1e-12 && band.longest_m == 0.14, "{band:?}");
}

#[test]
fn roughness_is_sampled_from_its_own_size_and_stays_within_its_range() {
    let heights = Raster::from_fn(64, 32, |x, _| x as f64);
    let steps = Raster::from_fn(8, 8, |x, _| if x < 4 { 0.0 } else { 1.0 });
    let mut map = HeightMap::new(&heights, EXTENT, Wrap::Clamp).unwrap().with_roughness_map(&steps).unwrap();
    let seen = along(&mut map, &stroke([0.0, 0.07], [0.14, 0.0], 44_100), [0.14, 0.0], 64);
    assert!(seen.iter().all(|s| (0.0..=1.0).contains(&s.roughness)));
    assert!(seen[44_100 / 16].roughness < 1e-6 && seen[44_100 * 15 / 16].roughness > 1.0 - 1e-6);
}

#[test]
fn impossible_maps_are_refused_by_name() {
    let fine = Raster::constant(2, 2, 0.0);
    let bad = |extent| HeightMap::new(&fine, extent, Wrap::Repeat).unwrap_err();
    assert!(matches!(bad(Extent { width_m: 0.0, ..EXTENT }), MapError::Extent { field: "width_m", .. }));
    assert!(matches!(
        bad(Extent { relief_m: f64::NAN, ..EXTENT }),
        MapError::Extent { field: "relief_m", .. }
    ));
    let torn = Raster { width: 3, height: 2, values: vec![0.0; 5] };
    assert!(matches!(HeightMap::new(&torn, EXTENT, Wrap::Repeat), Err(MapError::Shape { values: 5, .. })));
    let mut hole = fine.clone();
    hole.values[3] = f64::NAN;
    assert_eq!(HeightMap::new(&hole, EXTENT, Wrap::Repeat).unwrap_err(), MapError::NotFinite { x: 1, y: 1 });
    assert_eq!(HeightMap::flat(EXTENT, 1.5).unwrap_err(), MapError::Roughness(1.5));
}

#[test]
fn heights_are_the_same_bits_whether_or_not_anybody_asks_for_slopes() {
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        let mut rng = Rng::new(12);
        let texels = Raster::from_fn(48, 31, |_, _| rng.uniform());
        let mut map = HeightMap::new(&texels, EXTENT, wrap).unwrap().with_roughness_map(&texels).unwrap();
        let untouched = [7.0; 2];
        // Slow, across many texels a block, and so fast that the map is blurred.
        for velocity in [[0.05, 0.03], [30.0, -20.0], [300.0, 0.0]] {
            let velocities = [velocity; MAX_BLOCK];
            let all = stroke([-0.01, 0.02], velocity, 1024);
            for start in (0..1024).step_by(MAX_BLOCK) {
                let positions = &all[start..start + MAX_BLOCK];
                let footprints_m = [velocity[0].hypot(velocity[1]) / RATE_HZ; MAX_BLOCK];
                let path = |slopes| PathBlock {
                    position_m: positions,
                    velocity_m_s: &velocities,
                    footprint_m: &footprints_m,
                    normal_force_n: &[],
                    first_sample: start as u64,
                    contact: 0,
                    slopes,
                    ..PathBlock::default()
                };
                let (mut asked, mut not_asked) = (SurfaceBlock::default(), SurfaceBlock::default());
                not_asked.gradient = [untouched; MAX_BLOCK];
                map.sample(&path(true), &mut asked);
                map.sample(&path(false), &mut not_asked);
                assert_eq!(asked.height_m, not_asked.height_m, "{wrap:?}, {velocity:?}");
                assert_eq!(asked.roughness, not_asked.roughness, "{wrap:?}, {velocity:?}");
                assert_eq!(not_asked.gradient, [untouched; MAX_BLOCK]);
            }
        }
    }
}
