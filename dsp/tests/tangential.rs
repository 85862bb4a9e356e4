//! The dragged skin against closed forms, energy and an integrator of another making.

use asperity_dsp::rng::Rng;
use asperity_dsp::tangential::{
    DAMPING_N_S_M, FORCE_EXPONENT, MASS_KG, STIFFNESS_N_M, Tangential, TangentialState, friction_force_n,
};
use std::f64::consts::TAU;

const RATE_HZ: f64 = 44_100.0;

fn finger(normal_force_n: f64, rate_hz: f64) -> Tangential {
    Tangential::new(MASS_KG, normal_force_n, rate_hz).unwrap()
}

/// 20 log of the rms of `error` over the rms of `exact`.
fn error_db(pairs: &[(f64, f64)]) -> f64 {
    let error: f64 = pairs.iter().map(|(x, exact)| (x - exact).powi(2)).sum();
    10.0 * (error / pairs.iter().map(|(_, exact)| exact * exact).sum::<f64>()).log10()
}

#[test]
fn a_parabola_of_force_is_answered_to_rounding() {
    // u = α + β t + γ t² solves the equation for F = k u + b (β + 2 γ t) + 2 m γ.
    for (normal_force_n, rate_hz) in [(0.05, 22_050.0), (0.5, 44_100.0), (1.0, 96_000.0), (8.0, 192_000.0)] {
        let design = finger(normal_force_n, rate_hz);
        let (k, b) = (design.stiffness_n_m(), design.damping_n_s_m());
        let [alpha, beta, gamma] = [0.0, 0.02, 3.0];
        let exact = |t: f64| alpha + t * (beta + gamma * t);
        let force = |t: f64| k * exact(t) + b * (beta + 2.0 * gamma * t) + 2.0 * MASS_KG * gamma;
        let mut state = TangentialState::resting(&design, 0.0);
        let mut pairs = Vec::new();
        for n in 0..20_000 {
            let t = f64::from(n) / rate_hz;
            let u = state.tick(&design, force(t));
            if n > 10_000 {
                pairs.push((u, exact(t)));
            }
        }
        let error = error_db(&pairs);
        assert!(error < -200.0, "{normal_force_n} N, {rate_hz} Hz: {error:.0} dB");
    }
}

#[test]
fn a_sine_of_friction_moves_the_skin_as_two_states_do() {
    let mut worst = f64::NEG_INFINITY;
    for rate_hz in [44_100.0, 48_000.0, 96_000.0, 192_000.0] {
        for normal_force_n in [0.1, 0.5, 1.0, 3.0] {
            for frequency_hz in [10.0, 40.0, 100.0, 250.0, 500.0] {
                let design = finger(normal_force_n, rate_hz);
                let mut state = TangentialState::default();
                let w = TAU * frequency_hz;
                let (re, im) = (design.stiffness_n_m() - MASS_KG * w * w, design.damping_n_s_m() * w);
                let (size, phase) = (1.0 / re.hypot(im), -im.atan2(re));
                let mut pairs = Vec::new();
                for n in 0..rate_hz as usize / 2 {
                    let angle = w * n as f64 / rate_hz;
                    let u = state.tick(&design, angle.sin());
                    if n > rate_hz as usize / 4 {
                        pairs.push((u, size * (angle + phase).sin()));
                    }
                }
                worst = worst.max(error_db(&pairs));
            }
        }
    }
    println!("worst {worst:.1} dB");
    assert!(worst < -80.0, "{worst:.1} dB");
}

#[test]
fn a_lasting_force_moves_the_skin_by_force_over_stiffness() {
    for normal_force_n in [0.05, 0.3, 1.0, 2.7, 20.0] {
        let design = finger(normal_force_n, RATE_HZ);
        let firm = f64::powf(normal_force_n, FORCE_EXPONENT);
        assert!((design.stiffness_n_m() / (STIFFNESS_N_M * firm) - 1.0).abs() < 1e-12);
        assert!((design.damping_n_s_m() / (DAMPING_N_S_M * firm) - 1.0).abs() < 1e-12);
        let mut state = TangentialState::default();
        let last = (0..44_100).map(|_| state.tick(&design, 0.4)).last().unwrap();
        assert!((last * design.stiffness_n_m() / 0.4 - 1.0).abs() < 1e-9, "{last}");
    }
}

// scipy.integrate.solve_ivp (DOP853), tests/independent/tangential.py.
const INTEGRATED: [(f64, [f64; 5]); 3] = [
    (
        0.2,
        [4.013_073_156_0e-4, 4.056_385_623_2e-4, 2.833_925_216_9e-4, 3.397_286_844_0e-4, 3.137_773_386_3e-4],
    ),
    (
        1.0,
        [2.284_431_302_7e-4, 2.329_802_901_4e-4, 1.624_766_136_9e-4, 1.952_368_187_7e-4, 1.809_451_737_4e-4],
    ),
    (
        4.0,
        [1.406_052_199_8e-4, 1.440_806_190_3e-4, 1.002_470_766_3e-4, 1.206_124_898_5e-4, 1.119_698_641_4e-4],
    ),
];

#[test]
fn it_agrees_with_an_integrator_of_another_making() {
    let force = |t: f64| 0.3 + 0.1 * (TAU * 90.0 * t).sin() + 0.05 * (TAU * 310.0 * t + 0.7).cos();
    for (normal_force_n, expected) in INTEGRATED {
        let design = finger(normal_force_n, RATE_HZ);
        // The force before the beginning is what it was at it.
        let mut state = TangentialState::resting(&design, force(0.0));
        let all: Vec<f64> = (1..=4410).map(|n| state.tick(&design, force(f64::from(n) / RATE_HZ))).collect();
        let pairs: Vec<_> =
            [10, 100, 441, 1000, 4410].iter().zip(expected).map(|(n, u)| (all[n - 1], u)).collect();
        let error = error_db(&pairs);
        assert!(error < -80.0, "{normal_force_n} N: {error:.1} dB, {pairs:?}");
    }
}

#[test]
fn whatever_the_force_the_skin_stores_no_more_than_friction_gave() {
    let mut rng = Rng::new(41);
    for _ in 0..200 {
        let rate_hz = [22_050.0, 44_100.0, 48_000.0, 192_000.0][(rng.uniform() * 4.0) as usize];
        let mass_kg = 1.1e-4 + 1.2e-4 * rng.uniform();
        let start = Tangential::new(mass_kg, 20.0 * rng.uniform(), rate_hz).unwrap();
        let mut state = TangentialState::default();
        for _ in 0..400 {
            state.tick(&start, rng.normal());
        }
        // Three samples until the parabola has forgotten, then free: energy only falls, also when
        // the stiffness falls.
        let energy = |state: &TangentialState, u: f64, design: &Tangential| {
            0.5 * mass_kg * state.velocity_m_s().powi(2) + 0.5 * design.stiffness_n_m() * u * u
        };
        for _ in 0..3 {
            state.tick(&start, 0.0);
        }
        let mut before = f64::INFINITY;
        for _ in 0..300 {
            let u = state.tick(&start, 0.0);
            let now = energy(&state, u, &start);
            assert!(now <= before * (1.0 + 1e-12), "{now} after {before}");
            before = now;
        }
    }
}

#[test]
fn a_change_of_force_leaves_skin_and_speed_where_they_are() {
    let (light, firm) = (finger(0.3, RATE_HZ), finger(3.0, RATE_HZ));
    let mut state = TangentialState::default();
    let mut last = 0.0;
    for n in 0..1000 {
        let design = if n / 100 % 2 == 0 { &light } else { &firm };
        let u = state.tick(design, 0.4);
        let speed_m_s = 0.4 / DAMPING_N_S_M;
        assert!((u - last).abs() < 2.0 * speed_m_s / RATE_HZ, "a jump of {} m", u - last);
        last = u;
    }
}

#[test]
fn a_steep_slope_locks_nothing_and_hostile_numbers_are_refused_or_bounded() {
    assert_eq!(friction_force_n(2.0, 0.5, 0.0), 1.0);
    assert!((friction_force_n(1.0, 0.3, 0.2) - 0.5 / 0.94).abs() < 1e-15);
    assert!(friction_force_n(1.0, 1.0, 50.0).is_finite());
    assert_eq!(Tangential::new(0.0, 1.0, RATE_HZ).unwrap_err().field, "mass_kg");
    assert_eq!(Tangential::new(MASS_KG, f64::NAN, RATE_HZ).unwrap_err().field, "normal_force_n");
    assert_eq!(Tangential::new(MASS_KG, 1.0, 10.0).unwrap_err().field, "sample_rate_hz");
    assert!(finger(1.0, RATE_HZ).pressed_with(f64::NAN).stiffness_n_m() > 100.0);
}
