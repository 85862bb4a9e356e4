//! Ground that rises or falls as a whole: a leash holds the finger to it, not to the world.

use asperity_dsp::micro_contact::{ContactSample, Integrator, MicroContact, Probe};
use asperity_dsp::rng::Rng;
use std::f64::consts::TAU;

const RATE_HZ: f64 = 44_100.0;
const PRESSED_N: f64 = 0.5;

/// Relief over a second: forty sines between 20 Hz and 1 kHz, falling with frequency.
fn relief(rms_m: f64, seed: u64) -> Vec<f64> {
    let mut rng = Rng::new(seed);
    let waves: Vec<[f64; 3]> = (0..40)
        .map(|k| {
            let hz = 20.0 * 50_f64.powf((f64::from(k) + rng.uniform()) / 40.0);
            [TAU * hz / RATE_HZ, TAU * rng.uniform(), (20.0 / hz).powf(0.7)]
        })
        .collect();
    let power: f64 = waves.iter().map(|[_, _, peak]| peak * peak / 2.0).sum();
    let at = |n: f64| waves.iter().map(|[step, phase, peak]| peak * (step * n + phase).sin()).sum::<f64>();
    (0..RATE_HZ as usize).map(|n| rms_m / power.sqrt() * at(n as f64)).collect()
}

/// Mean contact force on this relief where it rises at `rise_m_s` as a whole.
fn mean_force_n(design: &MicroContact, relief_m: &[f64], rise_m_s: f64) -> f64 {
    let height = |(n, relief_m): (usize, &f64)| relief_m + rise_m_s * (n as f64 / RATE_HZ);
    let heights: Vec<f64> = relief_m.iter().enumerate().map(height).collect();
    let mut state = design.riding(heights[0], PRESSED_N, rise_m_s);
    let mut rows = vec![ContactSample::default(); heights.len()];
    design.run(&mut state, &heights, &vec![PRESSED_N; heights.len()], &mut rows);
    assert_eq!(state.resets(), 0);
    rows.iter().map(|row| row.contact_force_n).sum::<f64>() / rows.len() as f64
}

fn tool(masses_kg: [f64; 2], pad: [f64; 2], contact_stiffness_n_m: f64) -> Probe {
    let [pad_stiffness_n_m, pad_damping_n_s_m] = pad;
    let [pad_mass_kg, finger_mass_kg] = masses_kg;
    Probe {
        pad_mass_kg,
        pad_stiffness_n_m,
        pad_damping_n_s_m,
        finger_mass_kg,
        contact_stiffness_n_m,
        ..Probe::default()
    }
}

#[test]
fn a_finger_presses_as_hard_on_a_ramp_as_on_the_flat() {
    let probes = [
        Probe::default(),
        tool([0.5e-3, 20e-3], [5e3, 5.0], 1e6),
        tool([30e-3, 0.3], [1e3, 39.0], 6.5e3),
        tool([20e-3, 0.5], [1e4, 20.0], 1e6),
    ];
    for (seed, rms_m) in [(1, 5e-6), (2, 20e-6)] {
        let relief_m = relief(rms_m, seed);
        for probe in probes {
            for integrator in Integrator::ALL {
                let design = MicroContact::new(&probe, integrator, RATE_HZ).unwrap();
                for rise_m_s in [-2.0, -0.5, -0.1, 0.1, 0.5, 1.0, 2.0] {
                    let mean_n = mean_force_n(&design, &relief_m, rise_m_s);
                    let off = mean_n / PRESSED_N - 1.0;
                    assert!(off.abs() <= 0.01, "{} {rms_m} m, {rise_m_s} m/s: {mean_n} N", design.choice());
                }
            }
        }
    }
}

#[test]
fn a_rigid_thing_leaving_rising_ground_is_not_stopped() {
    let design =
        MicroContact::new(&tool([20e-3, 0.5], [1e4, 20.0], 1e6), Integrator::ExactEvent, RATE_HZ).unwrap();
    let relief_m = relief(80e-6, 3);
    let flat_n = mean_force_n(&design, &relief_m, 0.0);
    for rise_m_s in [0.1, 0.5, 1.0, 2.0] {
        let ramp_n = mean_force_n(&design, &relief_m, rise_m_s);
        assert!((ramp_n / flat_n - 1.0).abs() <= 0.1, "{rise_m_s} m/s: {ramp_n} N, {flat_n} N on the flat");
    }
}
