//! Solid noise as a surface and as a force: its definition, its units, its changes at run time.

use crate::common;

use asperity_dsp::rng::Rng;
use asperity_surface::height_field::{HeightField, PathBlock, Setup, SurfaceBlock, Touch};
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::{ForceDirection, SolidCut, SolidNoise};
use common::{Stroke, bits, rms};

const RATE: f64 = 44_100.0;

fn made(material: SolidMaterial) -> SolidNoise {
    SolidNoise::new(material.parameters(), 7).unwrap()
}

#[test]
fn heights_agree_with_the_definition_to_1e_9_m_along_any_path() {
    let mut rng = Rng::new(1);
    for material in SolidMaterial::SEVEN {
        let mut source = made(material);
        let parameters = material.parameters();
        for _ in 0..20 {
            let mut normal = || [rng.normal() * 0.3, rng.normal() * 0.3];
            let stroke = Stroke::new(normal(), normal().map(|v| 0.1 * v), RATE, 200);
            let oracle = source.clone();
            stroke.run(
                &mut source,
                &[64],
                |_, _| (),
                |n, out, i| {
                    let wanted = parameters.amplitude_m
                        * oracle.definition(&parameters, SolidCut::SLANTED.at(stroke.position_m(n)));
                    assert!((out.height_m[i] - wanted).abs() < 1e-9, "{material:?}");
                },
            );
        }
    }
}

#[test]
fn slopes_agree_with_finite_differences() {
    for material in SolidMaterial::SEVEN {
        let source = made(material);
        let p = material.parameters();
        let height = |at: [f64; 2]| p.amplitude_m * source.definition(&p, SolidCut::SLANTED.at(at));
        let stroke = Stroke::new([0.013, -0.007], [1e-3, 2e-3], RATE, 300);
        stroke.run(
            &mut source.clone(),
            &[64],
            |_, _| (),
            |n, out, i| {
                let at = stroke.position_m(n);
                for a in 0..2 {
                    // The value is in f32: 1e-7 of ±12 · A over 4e-6 m bounds what a difference can
                    // tell.
                    let step = 2e-6;
                    let shifted = |s: f64| {
                        let mut q = at;
                        q[a] += s;
                        height(q)
                    };
                    let slope = (shifted(step) - shifted(-step)) / (2.0 * step);
                    let bound = 0.002 + 2e-6 * p.amplitude_m * 12.0 / step;
                    assert!((slope - out.gradient[i][a]).abs() < bound, "{material:?}: {slope}");
                }
            },
        );
    }
}

#[test]
fn any_split_into_blocks_gives_the_same_bits_also_across_a_change() {
    let stroke = Stroke::new([0.01, 0.02], [0.11, -0.05], RATE, 12_000);
    let run = |lengths: &[usize]| {
        let mut source = made(SolidMaterial::Wood);
        // The engine splits blocks at messages, so a change always meets the start of a block.
        assert!(source.set(&SolidMaterial::Gravel.parameters(), 1001));
        assert!(source.set(&SolidMaterial::Sand.parameters(), 3003));
        stroke.heights(&mut source, lengths)
    };
    let whole = bits(&run(&[64]));
    assert_eq!(whole, bits(&run(&[1])));
    assert_eq!(whole, bits(&run(&[7, 64, 13, 1, 32])));
}

#[test]
fn a_tool_at_rest_feels_a_constant_force() {
    let source = made(SolidMaterial::Granite);
    let force_at = |sample| felt(&mut source.clone(), sample, 0.5)[0];
    let first = force_at(0);
    assert!(first[0] != 0.0 && first[1] == 0.0 && first[2] == 0.0, "along x only: {first:?}");
    for n in 1..100 {
        assert_eq!(force_at(64 * n), first);
    }
}

/// Answers to a tool that stands somewhere.
fn felt(source: &mut SolidNoise, first_sample: u64, normal_force_n: f64) -> Vec<[f64; 3]> {
    let path = PathBlock {
        position_m: &[[0.0312, 0.0417]; 64],
        velocity_m_s: &[[0.0; 2]; 64],
        footprint_m: &[0.0; 64],
        normal_force_n: &[normal_force_n; 64],
        first_sample,
        contact: 0,
        slopes: true,
        ..PathBlock::default()
    };
    let mut out = SurfaceBlock::default();
    source.sample(&path, &mut out);
    (0..64).map(|i| out.answer.at(i).force_n).collect()
}

#[test]
fn an_empty_block_is_felt_neither_as_texture_nor_medium() {
    for material in SolidMaterial::SEVEN {
        assert_eq!(felt(&mut made(material), 0, 0.0), vec![[0.0; 3]; 64], "{material:?}");
        assert_eq!(made(material).force_n([0.01, 0.02], [0.1, 0.0], 0.0, 0.0, 0), [0.0; 3]);
        assert!(felt(&mut made(material), 0, 1e-5)[0][0] != 0.0, "{material:?}");
    }
}

#[test]
fn a_flowing_block_feels_like_a_moving_tool_and_keeps_it_awake() {
    let mut parameters = SolidMaterial::Gravel.parameters();
    let still = SolidNoise::new(parameters, 7).unwrap();
    parameters.flow_m_s = [0.08, -0.03, 0.0];
    let mut flows = SolidNoise::new(parameters, 7).unwrap();
    flows.prepare(&Setup { sample_rate_hz: RATE, voices: 1, tip_radii_m: &[] }).unwrap();
    for block in [0, 100, 700] {
        for (i, force) in felt(&mut flows, 64 * block, 0.5).iter().enumerate() {
            let t = (64 * block + i as u64) as f64 / RATE;
            let wanted = still.force_n([0.0312 - 0.08 * t, 0.0417 + 0.03 * t], [0.0; 2], 0.5, 0.0, 0);
            assert!((force[0] - wanted[0]).abs() < 1e-6, "{force:?} {wanted:?}");
        }
    }
    let touch = Touch {
        contact: 0,
        sample: 0,
        position_m: [0.0; 2],
        velocity_m_s: [0.0; 2],
        normal_force_n: 0.5,
        ..Touch::default()
    };
    assert!(flows.touch(&touch).wakes_contact && !still.clone().touch(&touch).wakes_contact);
    // Out of the surface it boils in its place.
    parameters.flow_m_s = [0.0, 0.0, 0.05];
    let mut boils = SolidNoise::new(parameters, 7).unwrap();
    boils.prepare(&Setup { sample_rate_hz: RATE, voices: 1, tip_radii_m: &[] }).unwrap();
    assert!(felt(&mut boils, 0, 0.5)[0] == felt(&mut still.clone(), 0, 0.5)[0]);
    assert!(felt(&mut boils, 6400, 0.5)[0] != felt(&mut boils, 0, 0.5)[0]);
}

#[test]
fn force_stays_under_its_cap_and_the_medium_drags() {
    let mut parameters = SolidMaterial::Pebbles.parameters();
    parameters.limit_n = 1.0;
    parameters.direction = ForceDirection::Tangent;
    let source = SolidNoise::new(parameters, 1).unwrap();
    let velocity = [0.06, -0.08];
    let drag = parameters.viscosity_n_s_m;
    let (mut highest, mut capped) = (0.0_f64, 0);
    for n in 0..4000 {
        let at = [f64::from(n) * 1.3e-4, 0.017];
        let force = source.force_n(at, velocity, 0.5, 1e-4, 0);
        let texture = [force[0] + drag * velocity[0], force[1] + drag * velocity[1]];
        let along = texture[0] * 0.6 - texture[1] * 0.8;
        assert!((texture[0] * 0.8 + texture[1] * 0.6).abs() < 1e-12 && force[2] == 0.0);
        highest = highest.max(along.abs());
        capped += i32::from(along.abs() > 0.999_999);
    }
    assert!(highest <= 1.0 + 1e-12 && capped > 100, "{highest}, {capped}");
}

#[test]
fn the_seven_presets_stay_within_the_cap_without_clipping_much() {
    for material in SolidMaterial::SEVEN {
        let mut p = material.parameters();
        p.viscosity_n_s_m = 0.0;
        let source = SolidNoise::new(p, 3).unwrap();
        let force: Vec<f64> = (0..20_000)
            .map(|n| source.force_n([f64::from(n) * 3.1e-5, 0.1], [0.0; 2], 0.5, 0.0, 0)[0])
            .collect();
        let clipped = force.iter().filter(|f| f.abs() >= p.cap_n).count();
        println!("{:12} rms {:.3} N", material.name(), rms(&force));
        assert!(clipped < 20, "{material:?} is clipped {clipped} times");
        assert!(rms(&force) > 0.01);
    }
}

#[test]
fn no_change_of_parameters_makes_a_step_above_minus_60_db() {
    for (from, to) in [
        (SolidMaterial::Sandpaper, SolidMaterial::Pebbles),
        (SolidMaterial::Pebbles, SolidMaterial::RoughGlass),
        (SolidMaterial::Wood, SolidMaterial::Gravel),
    ] {
        for rate in [22_050.0, 44_100.0, 192_000.0] {
            let change = to.parameters();
            // At rest nothing but the change moves the height, so that every step is its step.
            for place in 0..30 {
                let at = [0.0007 * f64::from(place), 0.011];
                let stroke = Stroke::new(at, [0.0; 2], rate, (0.2 * rate) as usize);
                let mut source = SolidNoise::new(from.parameters(), 7).unwrap();
                source.prepare(&Setup { sample_rate_hz: rate, voices: 1, tip_radii_m: &[] }).unwrap();
                assert!(source.set(&change, 500));
                let heights = stroke.heights(&mut source, &[64]);
                let step = heights.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
                // The signal: what a stroke over the weaker of the two surfaces peaks at.
                let peak = |m: SolidMaterial| {
                    let p = m.parameters();
                    p.amplitude_m * p.modules.iter().map(|m| m.magnitude).sum::<f64>()
                };
                let db = 20.0 * (step / peak(from).max(peak(to))).log10();
                assert!(db < -60.0, "{from:?} to {to:?} at {rate} Hz: {db} dB");
            }
        }
    }
}

#[test]
fn octaves_stop_where_the_footprint_no_longer_resolves_them() {
    // Sandpaper's cell is 0.2 mm: whole at 1 m/s and 44.1 kHz, gone at 8 m/s.
    let heights = |speed: f64| {
        let stroke = Stroke::new([0.0; 2], [speed, 0.0], RATE, 4000);
        rms(&stroke.heights(&mut made(SolidMaterial::Sandpaper), &[64]))
    };
    let (slow, fast, gone) = (heights(0.1), heights(1.0), heights(8.0));
    assert!((fast / slow - 1.0).abs() < 0.15 && gone == 0.0, "{slow} {fast} {gone}");
    // In between it fades without a step.
    let mut last = heights(3.0);
    for k in 1..=30 {
        let next = heights(3.0 - 0.05 * f64::from(k));
        assert!((next - last).abs() < 0.2 * slow);
        last = next;
    }
}

#[test]
fn impossible_parameters_are_refused_by_name_and_change_nothing() {
    let mut source = made(SolidMaterial::Sand);
    let before = source.parameters();
    for (field, spoil) in [
        (
            "frequency",
            (|p| p.modules[0].frequency = 0.0)
                as fn(&mut asperity_surface::solid_noise::SolidNoiseParameters),
        ),
        ("octaves", |p| p.modules[0].octaves = 99),
        ("texture_factor_per_m", |p| p.texture_factor_per_m = f64::NAN),
        ("limit_n", |p| p.limit_n = 2.0),
        ("viscosity_n_s_m", |p| p.viscosity_n_s_m = -1.0),
    ] {
        let mut parameters = before;
        spoil(&mut parameters);
        assert_eq!(SolidNoise::new(parameters, 1).unwrap_err().field, field);
        assert!(!source.set(&parameters, 10));
        assert_eq!(source.parameters(), before);
    }
}

#[test]
fn material_names_are_found_however_they_are_spelt() {
    for material in SolidMaterial::SEVEN {
        assert_eq!(SolidMaterial::from_name(material.name()), Some(material));
    }
    assert_eq!(SolidMaterial::from_name("Rough-Glass "), Some(SolidMaterial::RoughGlass));
    assert_eq!(SolidMaterial::from_name("velvet"), None);
}
