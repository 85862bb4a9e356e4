//! Sand as a surface: reproducible renders, a hand-over that never waits, what is felt and heard.

use crate::common;

use asperity_surface::height_field::{
    HeightField, MAX_BLOCK, PathBlock, Reaction, SurfaceBlock, Touch, TouchKind,
};
use asperity_surface::raster::Raster;
use asperity_surface::sand::{SandDesign, SandLaw, SandSource, Tool};
use common::{bits, rms};

const RATE: f64 = 44_100.0;

fn design() -> SandDesign {
    SandDesign { width_m: 0.2, height_m: 0.1, cells: 400, ..SandDesign::default() }
}

/// A stroke as the engine makes it: a touch every 64 samples of the absolute grid, blocks of any
/// length between them.
fn play(
    source: &mut dyn HeightField,
    first_sample: u64,
    samples: usize,
    lengths: &[usize],
    force_n: f64,
    mut each: impl FnMut(&Reaction),
) -> Vec<f64> {
    let (start, velocity) = ([0.03, 0.05], [0.08, 0.01]);
    let position = |n: usize| [0, 1].map(|a| start[a] + velocity[a] * n as f64 / RATE);
    let mut out = SurfaceBlock::default();
    let mut heights = Vec::with_capacity(samples);
    let mut turn = 0;
    while heights.len() < samples {
        let n = heights.len();
        let sample = first_sample + n as u64;
        if sample.is_multiple_of(MAX_BLOCK as u64) {
            let touch = Touch {
                contact: 0,
                sample,
                position_m: position(n),
                velocity_m_s: velocity,
                normal_force_n: force_n,
                ..Touch::default()
            };
            each(&source.touch(&touch));
        }
        let to_grid = MAX_BLOCK - (sample % MAX_BLOCK as u64) as usize;
        let length = lengths[turn % lengths.len()].min(to_grid).min(samples - n);
        turn += 1;
        let path: Vec<[f64; 2]> = (n..n + length).map(position).collect();
        let block = PathBlock {
            position_m: &path,
            velocity_m_s: &vec![velocity; length],
            footprint_m: &vec![0.0806 / RATE; length],
            normal_force_n: &[],
            first_sample: sample,
            contact: 0,
            slopes: true,
            ..PathBlock::default()
        };
        source.sample(&block, &mut out);
        heights.extend_from_slice(&out.height_m[..length]);
    }
    heights
}

/// The force that carries a tip at a depth, N.
fn support_force_n(sand: &mut SandSource, position_m: [f64; 2], depth_m: f64) -> Option<f64> {
    let kind = TouchKind::Stands { depth_m };
    sand.touch(&Touch { kind, position_m, ..Touch::default() }).support_force_n
}

#[test]
fn synchronous_sand_renders_the_same_bits_and_keeps_its_volume() {
    let run = |lengths: &[usize]| {
        let mut sand = SandSource::synchronous(&design(), 1).unwrap();
        let heights = play(&mut sand, 1000, 60_000, lengths, 2.0, |_| ());
        (bits(&heights), sand.finish().unwrap())
    };
    let (whole, (figures, picture)) = run(&[64]);
    assert_eq!(figures.drift_units, 0);
    assert!(figures.max_slope_deg <= 30.5 && figures.max_slope_deg > 3.0, "{figures:?}");
    assert!(picture.metres_per_grey > 0.0);
    let (split, (other, _)) = run(&[1, 17, 64, 5]);
    assert_eq!(whole, split);
    assert_eq!(figures, other);
}

#[test]
fn fresh_flat_sand_is_flat_but_for_its_grains() {
    let mut sand = SandSource::synchronous(&design(), 1).unwrap();
    let heights = play(&mut sand, 0, 60_000, &[64], 1.0, |_| ());
    // Grains alone, from a source that is never pressed.
    let mut still = SandSource::synchronous(&design(), 1).unwrap();
    let grains = play(&mut still, 0, 60_000, &[64], 0.0, |_| ());
    let rest: Vec<f64> = heights.iter().zip(&grains).map(|(a, b)| a - b).collect();
    let depth = SandLaw::default().depth_m(1.0);
    println!("grains {:.2e} m, the rest {:.2e} m, depth {depth:.2e} m", rms(&grains), rms(&rest));
    assert!(rms(&grains) > 1e-6 && rms(&rest) < 0.05 * depth);
    // The part at 60 Hz and its harmonics, against the depth.
    let at = |hz: f64| {
        let turn = std::f64::consts::TAU * hz / RATE;
        let (mut re, mut im) = (0.0, 0.0);
        for (n, r) in rest[10_000..50_000].iter().enumerate() {
            let window = (std::f64::consts::PI * n as f64 / 40_000.0).sin().powi(2);
            re += window * r * (turn * n as f64).cos();
            im += window * r * (turn * n as f64).sin();
        }
        4.0 * re.hypot(im) / 40_000.0
    };
    let frame_hz = RATE / 704.0;
    for k in 1..5 {
        let db = 20.0 * (at(f64::from(k) * frame_hz) / depth).log10();
        println!("{:.0} Hz: {db:.0} dB", f64::from(k) * frame_hz);
        assert!(db < -50.0, "{db} dB");
    }
}

#[test]
fn an_old_groove_is_felt_by_a_stroke_across_it() {
    let mut sand = SandSource::synchronous(&design(), 1).unwrap();
    // A trench across the stroke at u = 0.07 m, 2 mm deep.
    sand.shape(|x, _| 0.05 - 0.002 * (-((x as f64 * 0.0005 - 0.07) / 0.003).powi(2)).exp());
    let heights = play(&mut sand, 0, 44_100, &[64], 0.3, |_| ());
    let near = |u: f64| {
        let n = ((u - 0.03) / 0.08 * RATE) as usize;
        heights[n - 200..n + 200].iter().sum::<f64>() / 400.0
    };
    println!("before {:.5}, in the trench {:.5}, after {:.5}", near(0.05), near(0.07), near(0.09));
    assert!(near(0.07) < -0.0008 && near(0.05) > -3e-4 && near(0.09) > -3e-4);
}

#[test]
fn a_finger_lifted_and_put_down_is_not_dragged_across() {
    // Two taps of the same voice, 0.1 m apart, with half a second between them or hardly any.
    for gap in [22_016, 64] {
        let mut sand = SandSource::synchronous(&design(), 1).unwrap();
        let tap = |sand: &mut SandSource, first: u64, u: f64| {
            for k in 0..40 {
                sand.touch(&Touch {
                    contact: 0,
                    sample: first + 64 * k,
                    position_m: [u, 0.05],
                    velocity_m_s: [0.0; 2],
                    normal_force_n: 3.0,
                    ..Touch::default()
                });
            }
            first + 64 * 40
        };
        let end = tap(&mut sand, 0, 0.05);
        tap(&mut sand, end + gap, 0.15);
        sand.finish().unwrap();
        let height = |u: f64| sand.simulation().unwrap().grid().height_at_m([u, 0.05]) - 0.05;
        println!("{gap}: {:.5} {:.5} {:.5}", height(0.05), height(0.1), height(0.15));
        assert!(height(0.05) < -1e-3 && height(0.15) < -1e-3 && height(0.1).abs() < 1e-9);
    }
}

#[test]
fn a_touch_is_answered_by_grains_in_proportion_to_what_is_displaced() {
    let answers = |force: f64| {
        let mut sand = SandSource::synchronous(&design(), 1).unwrap();
        let mut last = Reaction::default();
        play(&mut sand, 0, 22_050, &[64], force, |r| last = *r);
        last
    };
    let (light, heavy) = (answers(0.5), answers(4.0));
    println!("{light:?}\n{heavy:?}");
    assert!(light.grain_rate_per_s > 0.0 && heavy.grain_rate_per_s > 2.0 * light.grain_rate_per_s);
    // 0.3 mm of quartz at 0.08 m/s.
    assert!((heavy.grain_impulse_n_s / 3.0e-9 - 1.0).abs() < 0.05, "{}", heavy.grain_impulse_n_s);
}

#[test]
fn the_audio_half_goes_on_while_the_simulation_is_stuck_for_good() {
    let (mut sand, worker) = SandSource::threaded(&design(), 1).unwrap();
    // The worker never runs: poses fill their ring and are dropped, the surface stays what it was.
    let heights = play(&mut sand, 0, 300_000, &[64], 2.0, |_| ());
    assert!(heights.iter().all(|h| h.is_finite() && h.abs() < 1e-3));
    assert!(sand.finish().is_none());
    drop(worker);
    // Nor does a simulation that is gone.
    assert_eq!(play(&mut sand, 300_000, 6400, &[64], 2.0, |_| ()).len(), 6400);
}

#[test]
fn the_simulation_catches_up_after_a_pause() {
    let (mut sand, mut worker) = SandSource::threaded(&design(), 1).unwrap();
    let mut touches = 0;
    for round in 0..40 {
        play(&mut sand, round * 70_400, 70_400, &[64], 2.0, |_| {
            touches += 1;
            // A frame every 11 touches, with pauses of half a second in between.
            if touches % 11 == 0 && touches % 700 > 350 {
                worker.frame();
            }
        });
    }
    let figures = worker.simulation().figures();
    assert_eq!(figures.drift_units, 0);
    assert!(figures.max_slope_deg > 3.0, "the tool was heard: {figures:?}");
}

#[test]
fn a_simulation_on_its_own_thread_moves_sand_and_gives_it_back() {
    let (mut sand, worker) = SandSource::threaded(&design(), 1).unwrap();
    let thread = worker.spawn();
    for round in 0..30 {
        play(&mut sand, round * 6400, 6400, &[64], 2.0, |_| ());
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let mut simulation = thread.stop().unwrap();
    simulation.settle();
    let figures = simulation.figures();
    assert_eq!(figures.drift_units, 0);
    assert!(figures.max_slope_deg > 3.0 && figures.max_slope_deg <= 30.5, "{figures:?}");
}

#[test]
fn the_force_of_another_law_comes_without_a_step() {
    let mut sand = SandSource::synchronous(&design(), 1).unwrap();
    let mut forces = Vec::new();
    let touch = |sample| Touch {
        contact: 0,
        sample,
        position_m: [0.05, 0.05],
        velocity_m_s: [0.08, 0.0],
        normal_force_n: 1.0,
        ..Touch::default()
    };
    for sample in 0..20_000 {
        if sample == 5000 {
            assert!(sand.set(&SandLaw { drag_s_per_m: 200.0, ..SandLaw::default() }, sample));
        }
        forces.push(pushed(&mut sand, &touch(sample))[0]);
    }
    let step = forces.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    assert!((forces[0] + 1.6).abs() < 1e-12 && (forces[19_999] + 16.0).abs() < 1e-12);
    assert!(20.0 * (step / 16.0).log10() < -60.0, "{step} N a sample");
}

#[test]
fn a_law_is_exchanged_at_run_time_if_possible() {
    let mut sand = SandSource::synchronous(&design(), 1).unwrap();
    let wet = SandLaw { wetness: 1.0, ..SandLaw::default() };
    assert!(sand.set(&wet, 0));
    assert!(!sand.set(&SandLaw { drag_s_per_m: -1.0, ..wet }, 0));
    assert_eq!(sand.simulation().unwrap().law().wetness, 1.0);
    let touch = Touch {
        contact: 0,
        sample: 0,
        position_m: [0.05; 2],
        velocity_m_s: [0.08, 0.0],
        normal_force_n: 1.0,
        ..Touch::default()
    };
    assert!((pushed(&mut sand, &touch)[0] + 1.6).abs() < 1e-12);
}

/// What the sand pushes along itself, for a contact force as large as what presses; its slope does
/// not push.
fn pushed(sand: &mut SandSource, touch: &Touch) -> [f64; 2] {
    let path = PathBlock {
        position_m: &[touch.position_m],
        velocity_m_s: &[touch.velocity_m_s],
        footprint_m: &[0.0],
        normal_force_n: &[touch.normal_force_n],
        first_sample: touch.sample,
        contact: touch.contact,
        slopes: true,
        ..PathBlock::default()
    };
    let mut out = SurfaceBlock::default();
    sand.sample(&path, &mut out);
    let answer = out.answer.at(0);
    assert_eq!((out.friction[0], answer.force_n), (0.0, [0.0; 3]));
    [0, 1].map(|a| answer.force_n[a] + touch.normal_force_n * (answer.push_per_n[a] - out.gradient[0][a]))
}

#[test]
fn drag_is_the_documents_in_any_direction() {
    for (force, velocity) in [(0.5, [0.08, 0.01]), (4.0, [-0.3, 0.2]), (2.0, [0.0, 0.0])] {
        let mut sand = SandSource::synchronous(&design(), 1).unwrap();
        for k in 0..400 {
            let t = k as f64 / RATE;
            let position_m = [0, 1].map(|a| 0.05 + velocity[a] * t);
            let (sample, normal_force_n) = (k, force);
            let touch = Touch {
                contact: 0,
                sample,
                position_m,
                velocity_m_s: velocity,
                normal_force_n,
                ..Touch::default()
            };
            if k % 64 == 0 {
                sand.touch(&touch);
            }
            let sideways = pushed(&mut sand, &touch);
            assert!((0..2).all(|a| (sideways[a] + 20.0 * velocity[a] * force).abs() < 1e-12), "{sideways:?}");
        }
    }
}

#[test]
fn a_tip_is_carried_by_the_law_at_its_depth() {
    for law in [SandLaw::default(), SandLaw { wetness: 0.6, exponent_per_m: 80.0, ..SandLaw::default() }] {
        let bed = SandDesign { law, ..design() };
        let mut sand = SandSource::synchronous(&bed, 1).unwrap();
        for depth_m in [-0.01, 0.0, 0.001, 0.003, 0.008] {
            let n = support_force_n(&mut sand, [0.05, 0.05], depth_m).unwrap();
            assert!((n - law.force_n(depth_m)).abs() <= 0.01 * law.force_n(depth_m), "{depth_m}: {n}");
        }
        // Where the bed is 2 mm lower there is 2 mm less of it to stand in.
        sand.shape(|_, _| bed.depth_m - 0.002);
        assert_eq!(support_force_n(&mut sand, [0.05, 0.05], 0.002), Some(0.0));
        let n = support_force_n(&mut sand, [0.05, 0.05], 0.005).unwrap();
        assert!((n / law.force_n(0.003) - 1.0).abs() < 1e-4, "{n}");
    }
}

#[test]
fn a_wider_tool_sinks_less_under_the_same_force() {
    let depth_m = |radius_m: f64| {
        let tool = Tool::Sphere { radius_m };
        SandLaw::default().under(tool.bearing(), tool.tip_radius_m()).depth_m(3.005)
    };
    let depths = [0.0025, 0.005, 0.01, 0.015].map(depth_m);
    println!("{depths:?}");
    assert!((depths[1] / 0.003 - 1.0).abs() < 1e-3);
    assert!(depths.windows(2).all(|pair| pair[0] > 1.2 * pair[1]));
    // As wide as the sphere's print at 3 mm, and flat: carried alike.
    let bearing = Tool::Sphere { radius_m: 0.005 }.print_radius_m(0.003);
    let inside = |k: usize| (k as f64 + 0.5 - 50.0) * 1e-4;
    let map =
        Raster::from_fn(
            100,
            100,
            |x, y| {
                if inside(x).hypot(inside(y)) < bearing { 0.0 } else { f64::INFINITY }
            },
        );
    assert!((Tool::LowerMap { map, texel_m: 1e-4 }.bearing() - 1.0).abs() < 0.02);
}

#[test]
fn a_contact_lands_on_the_sand_as_it_lies_simulated_anywhere() {
    // A trench 1 mm deep and 6 mm wide, which the coarse view of the whole bed hardly shows.
    let trench = |x: usize, _: usize| 0.05 - 0.001 * (-((x as f64 * 0.0005 - 0.07) / 0.003).powi(2)).exp();
    let mut here = SandSource::synchronous(&design(), 1).unwrap();
    here.shape(trench);
    let (mut elsewhere, mut worker) = SandSource::threaded(&design(), 1).unwrap();
    worker.shape(trench);
    worker.frame();
    for u in [0.05, 0.07, 0.075] {
        let touch = Touch {
            contact: 0,
            sample: 0,
            position_m: [u, 0.05],
            velocity_m_s: [0.0; 2],
            normal_force_n: 1.0,
            ..Touch::default()
        };
        let [a, b] = [&mut here, &mut elsewhere].map(|sand| {
            sand.touch(&Touch { kind: TouchKind::Begins, ..touch });
            let path = PathBlock {
                position_m: &[touch.position_m],
                velocity_m_s: &[[0.0; 2]],
                footprint_m: &[0.0],
                normal_force_n: &[1.0],
                first_sample: 0,
                contact: 0,
                slopes: false,
                ..PathBlock::default()
            };
            let mut out = SurfaceBlock::default();
            sand.sample(&path, &mut out);
            out.height_m[0]
        });
        let carried =
            [&mut here, &mut elsewhere].map(|sand| support_force_n(sand, [u, 0.05], 0.003).unwrap());
        println!("u = {u}: {a:.6} m here, {b:.6} m elsewhere; {carried:.3?} N");
        assert!((a - b).abs() < 5e-5, "{a} {b}");
        assert!((carried[0] - carried[1]).abs() < 0.03 * carried[0], "{carried:?}");
    }
}
