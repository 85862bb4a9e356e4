//! Stick–slip against its closed form, its energy, and an integrator of another making.

use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_dsp::stick_slip::{Friction, RubState, RubbedBody, RubbedModes, Sweep};
use std::f64::consts::{PI, TAU};

/// A body of one mode with a modal mass of `mass_kg`.
fn oscillator(frequency_hz: f64, decay_per_s: f64, rate_hz: f64) -> [RubbedModes; 1] {
    let mode = Mode { frequency_hz, decay_per_s, amplitude: 1.0, phase_rad: 0.0 };
    [RubbedModes::new(&[mode], rate_hz).unwrap()]
}

fn modes(frequency_hz: &[f64], decay_per_s: f64, rate_hz: f64) -> Vec<RubbedModes> {
    let mode = |&frequency_hz: &f64| Mode { frequency_hz, decay_per_s, amplitude: 1.0, phase_rad: 0.0 };
    let modes: Vec<Mode> = frequency_hz.iter().map(mode).collect();
    modes.chunks(RubbedModes::LANES).map(|c| RubbedModes::new(c, rate_hz).unwrap()).collect()
}

struct Case {
    frequency_hz: f64,
    mass_kg: f64,
    /// A ω / V: how deep in the stick–slip regime.
    depth: f64,
    rate_hz: f64,
}

/// Mean of the periods between two beginnings of slipping, s.
fn period_s(case: &Case, friction: &Friction, sweep_m_s: f64, normal_force_n: f64) -> f64 {
    let mut rows = oscillator(case.frequency_hz, 0.0, case.rate_hz);
    let mut body = RubbedBody::new(&mut rows, case.rate_hz);
    let mut state = RubState::default();
    let phi = case.mass_kg.powf(-0.5) as f32;
    body.touch_at(&mut state, |_| phi);
    let mut begun = Vec::new();
    let mut stuck = false;
    let now = Sweep { sweep_m_s, normal_force_n, other_n_s: 0.0 };
    let samples = (case.rate_hz * (2.0 + 400.0 / case.frequency_hz)) as usize;
    for n in 0..samples {
        let rub = body.tick(&mut state, friction, &now);
        if stuck && !rub.sticks && n > samples / 4 {
            begun.push(n);
        }
        stuck = rub.sticks;
    }
    assert!(begun.len() > 20, "only {} slips", begun.len());
    (begun[begun.len() - 1] - begun[0]) as f64 / (begun.len() - 1) as f64 / case.rate_hz
}

#[test]
fn the_period_is_that_of_the_closed_form() {
    let mut cases = Vec::new();
    for (frequency_hz, mass_kg, depth) in
        [(50.0, 0.5, 3.0), (220.0, 0.08, 5.0), (430.0, 0.02, 2.0), (800.0, 0.004, 8.0)]
    {
        for rate_hz in [44_100.0, 96_000.0, 192_000.0] {
            cases.push(Case { frequency_hz, mass_kg, depth, rate_hz });
        }
    }
    let mut worst = 0.0_f64;
    for case in &cases {
        let friction = Friction { mu_static: 0.8, mu_kinetic: 0.3, slip_speed_m_s: 1e-9 };
        let w = TAU * case.frequency_hz;
        let normal_force_n = 1.5;
        let a = normal_force_n * 0.5 / (case.mass_kg * w * w);
        let v = a * w / case.depth;
        let exact = 2.0 * a / v + 2.0 / w * (PI - (a * w / v).atan());
        let error = 100.0 * (period_s(case, &friction, v, normal_force_n) / exact - 1.0);
        println!("{} Hz at {} Hz: {error:+.3} %", case.frequency_hz, case.rate_hz);
        worst = worst.max(error.abs());
    }
    assert!(worst <= 0.2, "worst {worst:.3} %");
}

#[test]
fn friction_faster_than_its_spring_never_sticks() {
    // Held in place by μ_k until its amplitude A ω reaches V: sticking begins only below V_c = A ω.
    let (frequency_hz, mass_kg, rate_hz) = (200.0, 0.05, 96_000.0);
    let friction = Friction { mu_static: 0.9, mu_kinetic: 0.4, slip_speed_m_s: 1e-9 };
    for normal_force_n in [0.5, 1.0, 4.0] {
        let w = TAU * frequency_hz;
        let critical_m_s = normal_force_n * 0.4 / (mass_kg * w * w) * w;
        for (share, sticks) in [(0.9, true), (1.1, false)] {
            let mut rows = oscillator(frequency_hz, 0.0, rate_hz);
            let mut body = RubbedBody::new(&mut rows, rate_hz);
            let mut state = RubState::default();
            body.touch_at(&mut state, |_| mass_kg.powf(-0.5) as f32);
            let now = Sweep { sweep_m_s: share * critical_m_s, normal_force_n, other_n_s: 0.0 };
            let stuck = (0..96_000).filter(|_| body.tick(&mut state, &friction, &now).sticks).count();
            assert_eq!(stuck > 100, sticks, "{normal_force_n} N, {share} of the critical speed: {stuck}");
        }
    }
}

#[test]
fn a_million_steps_of_random_numbers_never_take_energy_from_the_friction() {
    let mut rng = Rng::new(4711);
    let hz = [83.0, 190.0, 412.0, 733.0, 1_210.0, 2_900.0, 5_100.0, 9_800.0, 15_000.0, 19_000.0];
    let mut least = f64::INFINITY;
    for rate_hz in [44_100.0, 192_000.0] {
        let mut rows = modes(&hz, 8.0, rate_hz);
        let mut body = RubbedBody::new(&mut rows, rate_hz);
        let mut state = RubState::default();
        for n in 0..500_000 {
            if n % 50 == 0 {
                let size = 10.0_f64.powf(-1.0 + 2.0 * rng.uniform()) as f32;
                body.touch_at(&mut state, |_| size * (rng.uniform() as f32 - 0.5));
            }
            let mu_static = 2.0 * rng.uniform();
            let friction = Friction {
                mu_static,
                mu_kinetic: mu_static * rng.uniform(),
                slip_speed_m_s: 10.0_f64.powf(-9.0 + 9.0 * rng.uniform()),
            };
            let now =
                Sweep { sweep_m_s: 0.3 * rng.normal(), normal_force_n: 50.0 * rng.uniform(), other_n_s: 0.0 };
            let rub = body.tick(&mut state, &friction, &now);
            let taken_w = rub.force_n * (now.sweep_m_s - rub.body_m_s);
            least = least.min(taken_w / (rub.force_n.abs() * now.sweep_m_s.abs().max(1e-3)).max(1e-30));
            assert!(rub.force_n.abs() <= mu_static * now.normal_force_n * (1.0 + 1e-9) + 1e-12 || rub.sticks);
            assert!(rub.force_n.is_finite() && rub.body_m_s.is_finite());
        }
    }
    println!("least {least:e} of force times speed");
    assert!(least >= -1e-9, "{least:e}");
}

#[test]
fn what_rings_under_a_resting_hand_never_grows_whatever_presses() {
    let mut rng = Rng::new(99);
    let hz = [61.0, 190.0, 412.0, 733.0, 1_210.0, 2_900.0];
    let mut most = 0.0_f64;
    for run in 0..200 {
        let rate_hz = [44_100.0, 96_000.0][run % 2];
        let mut rows = modes(&hz, 0.0, rate_hz);
        let mut body = RubbedBody::new(&mut rows, rate_hz);
        let mut state = RubState::default();
        body.touch_at(&mut state, |_| 3.0 * (rng.uniform() as f32 - 0.3));
        let kick = Sweep { sweep_m_s: 0.0, normal_force_n: 0.0, other_n_s: 0.01 };
        let friction = Friction { mu_static: 0.7, mu_kinetic: 0.3, slip_speed_m_s: 0.05 };
        body.tick(&mut state, &friction, &kick);
        let begun_j = body.energy_j();
        for _ in 0..5_000 {
            let normal_force_n = 50.0 * rng.uniform().powi(4);
            body.tick(&mut state, &friction, &Sweep { normal_force_n, other_n_s: 0.0, ..kick });
            most = most.max(body.energy_j() / begun_j);
        }
    }
    println!("at most {most:.6} of the energy of the beginning");
    assert!(most <= 1.001, "{most}");
}

#[test]
fn an_impulse_from_elsewhere_moves_a_free_mass_by_its_share() {
    let (mass_kg, rate_hz) = (0.05_f64, 96_000.0);
    let mut rows = oscillator(1.0, 0.0, rate_hz);
    let (mut body, mut state) = (RubbedBody::new(&mut rows, rate_hz), RubState::default());
    body.touch_at(&mut state, |_| mass_kg.powf(-0.5) as f32);
    let friction = Friction { mu_static: 0.8, mu_kinetic: 0.3, slip_speed_m_s: 0.01 };
    for (other_n_s, wanted_m_s) in [(0.002, 0.04), (0.0, 0.04), (-0.003, -0.02)] {
        let now = Sweep { sweep_m_s: 0.0, normal_force_n: 0.0, other_n_s };
        let body_m_s = body.tick(&mut state, &friction, &now).body_m_s;
        assert!((body_m_s - wanted_m_s).abs() < 1e-6, "{body_m_s} and not {wanted_m_s} m/s");
    }
}

// scipy.integrate.solve_ivp with events, tests/independent/stick_slip.py: frequency, decay, mass,
// normal force, sweep, μ_s, μ_k, u_s, and the mean period, s.
const INTEGRATED: [[f64; 9]; 4] = [
    [110.0, 4.0, 0.2, 2.0, 0.004, 0.8, 0.3, 0.002, 0.011_595_540_41],
    [220.0, 20.0, 0.05, 1.0, 0.01, 0.6, 0.2, 0.005, 0.004_743_987_452],
    [440.0, 30.0, 0.02, 3.0, 0.03, 0.9, 0.35, 0.01, 0.002_523_833_48],
    [880.0, 15.0, 0.01, 1.5, 0.01, 0.7, 0.3, 0.004, 0.001_291_293_272],
];

#[test]
fn it_agrees_with_another_integrator_on_smooth_curves() {
    for [frequency_hz, decay_per_s, mass_kg, normal_force_n, sweep_m_s, mu_static, mu_kinetic, slip, exact] in
        INTEGRATED
    {
        let friction = Friction { mu_static, mu_kinetic, slip_speed_m_s: slip };
        for (rate_hz, bound) in [(96_000.0, 0.7), (192_000.0, 0.35)] {
            let mut rows = oscillator(frequency_hz, decay_per_s, rate_hz);
            let mut body = RubbedBody::new(&mut rows, rate_hz);
            let mut state = RubState::default();
            body.touch_at(&mut state, |_| mass_kg.powf(-0.5) as f32);
            let now = Sweep { sweep_m_s, normal_force_n, other_n_s: 0.0 };
            let (mut begun, mut stuck) = (Vec::new(), false);
            for n in 0..2 * rate_hz as u32 {
                let rub = body.tick(&mut state, &friction, &now);
                if stuck && !rub.sticks && n > rate_hz as u32 {
                    begun.push(n);
                }
                stuck = rub.sticks;
            }
            let mean = f64::from(begun[begun.len() - 1] - begun[0]) / (begun.len() - 1) as f64 / rate_hz;
            let error = 100.0 * (mean / exact - 1.0);
            println!("{frequency_hz} Hz at {rate_hz} Hz: {error:+.3} %");
            // The growth of slipping out of sticking on a steep curve is right to the first order
            // of the step.
            assert!(error.abs() <= bound, "{frequency_hz} Hz: {error:+.3} %");
        }
    }
}

#[test]
fn impossible_friction_is_refused_and_what_cannot_yield_gives_numbers() {
    let good = Friction { mu_static: 0.8, mu_kinetic: 0.3, slip_speed_m_s: 0.1 };
    assert!(good.checked().is_ok());
    assert_eq!(Friction { mu_kinetic: 0.9, ..good }.checked().unwrap_err().field, "mu_kinetic");
    assert_eq!(Friction { mu_static: f64::NAN, ..good }.checked().unwrap_err().field, "mu_static");
    assert_eq!(Friction { slip_speed_m_s: 0.0, ..good }.checked().unwrap_err().field, "slip_speed_m_s");
    let mut rows = modes(&[30_000.0], 1.0, 44_100.0);
    let mut body = RubbedBody::new(&mut rows, 44_100.0);
    let mut state = RubState::default();
    body.touch_at(&mut state, |_| 1.0);
    for normal_force_n in [0.0, 1.0, -1.0, 1e9] {
        let rub = body.tick(&mut state, &good, &Sweep { sweep_m_s: 0.1, normal_force_n, other_n_s: 0.0 });
        assert!(rub.force_n.is_finite() && rub.body_m_s == 0.0);
    }
}
