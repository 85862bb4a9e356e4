use super::*;
use crate::simd::Isa;
use std::vec;
use std::vec::Vec;

#[test]
fn roughness_maps_to_the_exponents_of_the_paper() {
    assert_eq!(FractalNoise::alpha(0.0), 2.5);
    assert_eq!(FractalNoise::alpha(1.0), 1.0);
    assert_eq!(FractalNoise::alpha(-3.0), 2.5);
}

#[test]
fn a_field_is_its_seed() {
    assert_eq!(FractalNoise::new(4), FractalNoise::new(4));
    assert_ne!(FractalNoise::new(4), FractalNoise::new(4 + (1 << 40)));
}

#[test]
fn remembered_cells_change_no_bit_wherever_the_path_is_cut() {
    let relief = |longest_wavelength_m| Relief {
        rms_at_1mm_m: 2e-6,
        outer_scale_m: 0.01,
        tip_radius_m: 5e-4,
        longest_wavelength_m,
    };
    let sets = [OctaveWeights::new(&relief(6e-4)), OctaveWeights::new(&relief(f64::INFINITY))];
    let mut rng = Rng::new(31);
    let (mut at, mut position_m, mut footprint_m, mut roughness) = ([0.1, 0.2], vec![], vec![], vec![]);
    for n in 0..4096 {
        // Slow, fast, and now and then somewhere else.
        let step_m = if n % 1500 < 900 { 2e-6 } else { 2e-5 };
        at = if n % 700 == 699 {
            [rng.uniform(), -rng.uniform()]
        } else {
            [at[0] + step_m, at[1] - 0.3 * step_m]
        };
        position_m.push(at);
        footprint_m.push(1.05 * step_m);
        roughness.push(if n < 2000 { 0.4 } else { rng.uniform() });
    }
    for isa in Isa::ALL {
        let Some(level) = Level::find(isa) else { continue };
        let (field, other) = (FractalNoise::new(7).on(level), FractalNoise::new(8).on(level));
        let path = |from: usize, to: usize| NoisePath {
            position_m: &position_m[from..to],
            footprint_m: &footprint_m[from..to],
        };
        let alone = sets.map(|weights| {
            let mut height_m = vec![0.0; 4096];
            field.add(&path(0, 4096), &roughness, &weights, &mut height_m);
            height_m
        });
        let (mut cells, mut at) = (NoiseCells::default(), 0);
        while at < 4096 {
            let end = (at + 1 + rng.next_u32() as usize % 70).min(4096);
            let (mut under_m, mut all_m) = (vec![0.0; end - at], vec![0.0; end - at]);
            let [under, all] = &sets;
            let mut heights_m = [&mut under_m[..], &mut all_m[..]];
            field.add_each(&path(at, end), &roughness[at..end], &[under, all], &mut heights_m, &mut cells);
            assert!(under_m == alone[0][at..end] && all_m == alone[1][at..end], "{isa:?}, {at}..{end}");
            if at % 5 == 0 {
                // Another field's cells are not taken for this one's.
                other.add_each(
                    &path(at, end),
                    &roughness[at..end],
                    &[all],
                    &mut [&mut all_m[..]],
                    &mut cells,
                );
            }
            at = end;
        }
    }
}

#[test]
fn what_cubics_miss_is_estimated_within_a_factor() {
    for (footprint_m, roughness, tip_radius_m) in
        [(2.3e-6, 0.5, 0.0), (1.8e-5, 0.5, 0.0), (7e-6, 0.2, 0.0), (3.4e-5, 0.9, 0.0), (1.8e-5, 0.5, 5e-4)]
    {
        let relief = Relief {
            rms_at_1mm_m: 2e-5,
            outer_scale_m: 4e-3,
            tip_radius_m,
            longest_wavelength_m: f64::INFINITY,
        };
        let weights = OctaveWeights::new(&relief);
        // Two places a sample.
        let count = 20_000;
        let position_m: Vec<_> =
            (0..count).map(|n| [0.5 * footprint_m * n as f64, 0.2 * footprint_m * n as f64]).collect();
        let (along, mut height_m) = (libm::hypot(1.0, 0.4), vec![0.0; count]);
        let path = NoisePath { position_m: &position_m, footprint_m: &vec![along * footprint_m; count] };
        FractalNoise::new(5).add(&path, &vec![roughness; count], &weights, &mut height_m);
        let beside: Vec<f64> = (3..count - 3)
            .step_by(2)
            .map(|n| {
                let [a, b, c, d] = [n - 3, n - 1, n + 1, n + 3].map(|k| height_m[k]);
                height_m[n] - (9.0 * (b + c) - a - d) / 16.0
            })
            .collect();
        // Midway a cubic misses most: 1.27 times its rms over the sample.
        let rms_m = libm::sqrt(beside.iter().map(|m| m * m).sum::<f64>() / beside.len() as f64) / 1.27;
        let footprints_m = [along * footprint_m; 2];
        let told_m = weights.missed(roughness, footprints_m, 0.0).all_m;
        assert!(
            (0.66..1.5).contains(&(told_m / rms_m)),
            "{footprint_m} m, R {roughness}: {told_m} for {rms_m}"
        );
        // The octaves that it leaves out miss no more than they may, and with one octave more they
        // would.
        for share in [0.5, 0.1, 0.01, 0.001] {
            let left_m = share * told_m;
            let octave = weights.missed(roughness, footprints_m, left_m).octave;
            let seen_m = |octave| weights.from_octave(octave).missed(roughness, footprints_m, 0.0).all_m;
            let missed_m = |octave| libm::sqrt(told_m * told_m - seen_m(octave) * seen_m(octave));
            assert!(missed_m(octave) <= left_m + 1e-9 * told_m, "{share}: {octave}");
            assert!(missed_m(octave + 1) > left_m, "{share}: {octave}");
        }
        let nothing = weights.missed(roughness, [0.0; 2], 0.0);
        assert_eq!((nothing.all_m, nothing.octave), (0.0, OCTAVES));
    }
}
