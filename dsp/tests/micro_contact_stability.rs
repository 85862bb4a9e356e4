//! Hard cases: stiff, light, unloaded, jumping, stuck, hostile, and long.

use asperity_dsp::micro_contact::{ContactSample, ContactState, Integrator, MicroContact, Probe};
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::Level;
use std::time::Instant;

const RATES_HZ: [f64; 6] = [8_000.0, 22_050.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0];

fn is_finite(row: &ContactSample) -> bool {
    let onset = row.onset.is_none_or(|o| o.offset >= 0.0 && o.offset <= 1.0 && o.closing_m_s.is_finite());
    onset
        && row.height_m.is_finite()
        && row.normal_force_n.is_finite()
        && row.pad_m.is_finite()
        && row.pad_velocity_m_s.is_finite()
        && row.finger_m.is_finite()
        && row.contact_force_n.is_finite()
        && row.contact_force_n >= 0.0
}

fn run(
    design: &MicroContact,
    state: &mut ContactState,
    height_m: &[f64],
    force_n: &[f64],
) -> Vec<ContactSample> {
    let mut out = vec![ContactSample::default(); height_m.len()];
    design.run(state, height_m, force_n, &mut out);
    out
}

/// A rough surface with jumps, standstills and force steps; every input allowed.
fn rough(rng: &mut Rng, count: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut height, mut force, mut slope) = (0.0, 0.5, 0.0);
    let mut inputs = (vec![], vec![]);
    for n in 0..count {
        match rng.next_u32() % 400 {
            0 => height += 4e-4 * rng.normal(),
            1 => force = [0.0, 0.02, 0.5, 5.0, -0.3][rng.next_u32() as usize % 5],
            2 => slope = 0.0,
            3 => slope = 1e-6 * rng.normal(),
            _ => {}
        }
        height = (height + slope) * 0.9999;
        let noise = if n % 5000 < 2500 { 1e-6 * rng.normal() } else { 0.0 };
        inputs.0.push(height + noise);
        inputs.1.push(force);
    }
    inputs
}

#[test]
fn every_stiffness_mass_and_rate_stays_bounded_on_a_rough_surface() {
    let mut rng = Rng::new(1);
    let (heights, forces) = rough(&mut rng, 6000);
    for rate_hz in RATES_HZ {
        for contact_stiffness_n_m in [1e3, 1e4, 5e4, 1e6, 1e7, 1e8] {
            for pad_mass_kg in [1e-5, 0.15e-3] {
                for integrator in Integrator::ALL {
                    let probe = Probe { contact_stiffness_n_m, pad_mass_kg, ..Probe::default() };
                    let design = MicroContact::new(&probe, integrator, rate_hz).unwrap();
                    let mut state = design.at_rest(heights[0], forces[0]);
                    for row in run(&design, &mut state, &heights, &forces) {
                        assert!(is_finite(&row), "{} {probe:?} {row:?}", design.choice());
                        assert!(
                            (row.pad_m - row.height_m).abs() < 0.1,
                            "{} {probe:?} {row:?}",
                            design.choice()
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn a_pad_pressed_far_into_soft_ground_is_not_a_lost_one() {
    for integrator in Integrator::ALL {
        let probe = Probe { contact_stiffness_n_m: 1e3, ..Probe::default() };
        let design = MicroContact::new(&probe, integrator, 44_100.0).unwrap();
        let mut state = design.at_rest(0.0, 20.0);
        // 60 mm deep at 60 N; what swings beyond the new rest is held too.
        let forces: Vec<f64> = (0..44_100).map(|n| if n < 100 { 20.0 } else { 60.0 }).collect();
        let rows = run(&design, &mut state, &[0.0; 44_100], &forces);
        assert_eq!(state.resets(), 0, "{integrator:?}");
        let last = rows[44_099];
        assert!((last.contact_force_n - 60.0).abs() < 0.06, "{integrator:?} {last:?}");
        assert!((last.pad_m + 0.06).abs() < 6e-5, "{integrator:?} {last:?}");
    }
}

#[test]
fn random_probes_gain_no_energy_from_a_surface_at_rest() {
    let mut rng = Rng::new(2);
    let mut range = |low: f64, high: f64| low * (high / low).powf(rng.uniform());
    for case in 0..1500 {
        let probe = Probe {
            pad_mass_kg: range(1e-5, 1e-3),
            pad_stiffness_n_m: range(10.0, 1e5),
            pad_damping_n_s_m: range(1e-3, 10.0),
            finger_mass_kg: range(1e-3, 0.1),
            contact_stiffness_n_m: range(1e3, 1e8),
            leash_m: 0.05,
            tip_radius_m: 0.0,
            force_exponent: 0.0,
            ridge_m: 0.0,
            ..Probe::default()
        };
        let rate_hz = range(8e3, 192e3);
        let speed = range(1e-3, 0.5);
        let integrator = Integrator::ALL[case % 4];
        let design = MicroContact::new(&probe, integrator, rate_hz).unwrap();
        let mut state = design.landing(0.0, 0.0, speed);
        let start = design.energy_j(&state);
        let mut largest = 0.0_f64;
        let mut row = [ContactSample::default()];
        for _ in 0..500 {
            design.run(&mut state, &[0.0], &[0.0], &mut row);
            assert!(is_finite(&row[0]), "{} {probe:?}", design.choice());
            largest = largest.max(design.energy_j(&state) / start);
        }
        // The Euler schemes look at positions and velocities half a step apart.
        let bar = match design.integrator() {
            Integrator::EnergyConserving => 1.0 + 1e-9,
            Integrator::ExactEvent => 1.002,
            _ => 1.7,
        };
        assert!(largest <= bar, "case {case}: {} {probe:?}: gain {largest}", design.choice());
    }
}

#[test]
fn hostile_inputs_are_counted_and_forgotten_within_64_samples() {
    let hostile = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 1e9, f64::MIN_POSITIVE / 4.0];
    for integrator in Integrator::ALL {
        let design = MicroContact::new(&Probe::default(), integrator, 44_100.0).unwrap();
        let heights: Vec<f64> = (0..2000).map(|n| 5e-5 * (f64::from(n) * 0.02).sin()).collect();
        let forces = vec![0.5; heights.len()];
        let mut calm = design.at_rest(0.0, 0.5);
        let reference = run(&design, &mut calm, &heights, &forces);
        for bad in hostile {
            for (in_force, cut) in [(false, 1), (true, 1), (false, 64), (true, 64)] {
                let (mut heights, mut forces) = (heights.clone(), forces.clone());
                if in_force {
                    forces[1000] = bad
                } else {
                    heights[1000] = bad
                }
                let mut state = design.at_rest(0.0, 0.5);
                let blocks = heights.chunks(cut).zip(forces.chunks(cut));
                let rows: Vec<_> = blocks.flat_map(|(h, f)| run(&design, &mut state, h, f)).collect();
                assert!(rows.iter().all(is_finite), "{integrator:?} {bad}");
                assert_eq!(
                    state.resets(),
                    u32::from(bad.is_nan() || bad.abs() > 1000.0),
                    "{integrator:?} {bad}"
                );
                for (row, wanted) in rows.iter().zip(&reference).skip(1064) {
                    assert!((row.pad_m - wanted.pad_m).abs() < 1e-6, "{integrator:?} {bad}: {row:?}");
                }
            }
        }
    }
}

#[test]
fn a_storm_of_nan_and_infinities_never_comes_out() {
    for integrator in Integrator::ALL {
        let design = MicroContact::new(&Probe::default(), integrator, 44_100.0).unwrap();
        let mut rng = Rng::new(3);
        let wild = |rng: &mut Rng| match rng.next_u32() % 8 {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => -1e308,
            3 => f64::from_bits((u64::from(rng.next_u32()) << 32) | u64::from(rng.next_u32())),
            4 => rng.normal(),
            _ => 1e-4 * rng.normal(),
        };
        let heights: Vec<f64> = (0..20_000).map(|_| wild(&mut rng)).collect();
        let forces: Vec<f64> = (0..20_000).map(|_| wild(&mut rng)).collect();
        let mut state = design.at_rest(f64::NAN, f64::INFINITY);
        assert_eq!(state.resets(), 2);
        for row in run(&design, &mut state, &heights, &forces) {
            assert!(is_finite(&row), "{integrator:?} {row:?}");
        }
        assert!(state.resets() > 10_000);
        // And it is itself again at once.
        let after = run(&design, &mut state, &[1e-3; 44_100], &[0.5; 44_100]);
        assert!(after[..64].iter().all(|row| (row.pad_m - 1e-3).abs() < 2e-3), "{integrator:?}");
        assert!(design.is_settled(&state, 1e-3, 0.5), "{integrator:?} {state:?}");
    }
}

#[test]
fn any_split_into_blocks_gives_the_same_bits() {
    let mut rng = Rng::new(4);
    let (heights, forces) = rough(&mut rng, 5000);
    for integrator in Integrator::ALL {
        for stiffness in [5e4, 3e5] {
            let probe = Probe { contact_stiffness_n_m: stiffness, ..Probe::default() };
            let design = MicroContact::new(&probe, integrator, 44_100.0).unwrap();
            let mut whole_state = design.landing(0.0, 0.5, 0.1);
            let whole = run(&design, &mut whole_state, &heights, &forces);
            for most in [1, 7, 64, 1024] {
                let mut state = design.landing(0.0, 0.5, 0.1);
                let (mut split, mut at) = (vec![], 0);
                while at < heights.len() {
                    let end = (at + 1 + rng.next_u32() as usize % most).min(heights.len());
                    split.extend(run(&design, &mut state, &heights[at..end], &forces[at..end]));
                    at = end;
                }
                assert!(split == whole && state == whole_state, "{integrator:?} in blocks up to {most}");
            }
        }
    }
}

#[test]
fn the_portable_kernels_agree_with_the_wide_ones() {
    let (heights, forces) = rough(&mut Rng::new(6), 1000);
    for integrator in Integrator::ALL {
        let design = MicroContact::new(&Probe::default(), integrator, 44_100.0).unwrap();
        let mut states = [design.at_rest(0.0, 0.5); 2];
        let wide = run(&design, &mut states[0], &heights, &forces);
        let portable = run(&design.on(Level::PORTABLE), &mut states[1], &heights, &forces);
        for (a, b) in wide.iter().zip(&portable) {
            assert!((a.pad_m - b.pad_m).abs() < 1e-12, "{integrator:?}: {a:?} {b:?}");
        }
    }
}

#[test]
fn a_resting_contact_costs_no_more_than_a_busy_one() {
    for integrator in Integrator::ALL {
        let design = MicroContact::new(&Probe::default(), integrator, 44_100.0).unwrap();
        let busy: Vec<f64> = (0..44_100).map(|n| 5e-5 * (f64::from(n) * 0.02).sin()).collect();
        let mut out = vec![ContactSample::default(); busy.len()];
        let mut time = |state: &mut ContactState, height: &[f64], force: f64| {
            let force = vec![force; height.len()];
            let runs = (0..9).map(|_| {
                let start = Instant::now();
                design.run(state, height, &force, &mut out);
                start.elapsed()
            });
            runs.min().unwrap().as_secs_f64()
        };
        let mut state = design.at_rest(0.0, 0.5);
        let busy_s = time(&mut state, &busy, 0.5);
        let rests: [(f64, f64); 3] = [(0.0, 0.5), (0.0, 0.0), (1e-310, 0.0)];
        for (height, force) in rests {
            let rest_s = time(&mut state, &vec![height; busy.len()], force);
            // Denormals would cost twenty times as much; the rest is room for a shared machine.
            assert!(
                rest_s < 2.5 * busy_s,
                "{integrator:?} at {height} m, {force} N: {rest_s} s, busy {busy_s} s"
            );
        }
    }
}

#[test]
fn the_builder_refuses_sub_steps_or_switches_and_says_so() {
    let with = |contact_stiffness_n_m, wanted, rate_hz| {
        let probe = Probe { contact_stiffness_n_m, ..Probe::default() };
        MicroContact::new(&probe, wanted, rate_hz).unwrap()
    };
    let plain = with(5e4, Integrator::SemiImplicitEuler, 44_100.0);
    assert_eq!((plain.integrator(), plain.substeps()), (Integrator::SemiImplicitEuler, 1));
    let stepped = with(3e5, Integrator::SemiImplicitEuler, 44_100.0);
    assert_eq!((stepped.integrator(), stepped.substeps()), (Integrator::SemiImplicitEuler, 3));
    assert!(stepped.choice().to_string().contains("3 sub-steps"));
    let switched = with(5e4, Integrator::SemiImplicitEuler, 8_000.0);
    assert_eq!(switched.integrator(), Integrator::EnergyConserving);
    assert!(switched.choice().to_string().contains("instead of semi-implicit-euler"));
    assert_eq!([plain, stepped, switched].map(|design| design.choice().is_as_asked()), [true, false, false]);
    let exact = with(5e6, Integrator::ExactEvent, 44_100.0);
    assert_eq!((exact.integrator(), exact.latency_samples()), (Integrator::ExactEvent, 1));
    let stiff = with(6e6, Integrator::ExactEvent, 44_100.0);
    assert_eq!((stiff.integrator(), stiff.latency_samples()), (Integrator::EnergyConserving, 0));
    let bad = Probe { pad_mass_kg: f64::NAN, ..Probe::default() };
    assert_eq!(MicroContact::new(&bad, Integrator::ExactEvent, 44_100.0).unwrap_err().field, "pad_mass_kg");
    let rate = MicroContact::new(&Probe::default(), Integrator::ExactEvent, 0.0).unwrap_err();
    assert_eq!(rate.field, "sample_rate_hz");
    for integrator in Integrator::ALL {
        assert_eq!(Integrator::from_name(integrator.name()), Some(integrator));
    }
}

#[test]
fn three_million_samples_of_sliding_neither_drift_nor_reset() {
    // 3·10⁶ samples stand for 10⁹: nothing in the state counts beyond a grid of 64.
    for integrator in [Integrator::ExactEvent, Integrator::EnergyConserving, Integrator::SemiImplicitEuler] {
        let design = MicroContact::new(&Probe::default(), integrator, 44_100.0).unwrap();
        let period: Vec<f64> =
            (0..441).map(|n| 5e-5 * (f64::from(n) * std::f64::consts::TAU / 441.0).sin()).collect();
        let heights: Vec<f64> = period.iter().copied().cycle().take(44_100).collect();
        let forces = vec![0.5; heights.len()];
        let mut state = design.at_rest(0.0, 0.5);
        run(&design, &mut state, &heights, &forces);
        let early = run(&design, &mut state, &heights, &forces);
        let mut late = early.clone();
        for _ in 0..(3_000_000 / heights.len()) {
            design.run(&mut state, &heights, &forces, &mut late);
        }
        assert_eq!(state.resets(), 0);
        for (a, b) in early.iter().zip(&late) {
            assert!((a.pad_m - b.pad_m).abs() < 1e-12, "{integrator:?}: {a:?} {b:?}");
        }
    }
}
