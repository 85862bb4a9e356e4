//! An undamped finger that bounces for seconds must not gain energy.

use asperity_dsp::micro_contact::{ContactSample, ContactState, Integrator, MicroContact, Probe};

const NORMAL_FORCE_N: f64 = 0.5;

fn undamped(contact_stiffness_n_m: f64) -> Probe {
    Probe { pad_damping_n_s_m: 0.0, contact_stiffness_n_m, leash_m: 0.05, ..Probe::default() }
}

/// Largest and last energy, over the energy at landing, both above equilibrium.
fn bouncing_gain(design: &MicroContact, rate_hz: f64, seconds: f64) -> (f64, f64) {
    let mut state = design.landing(0.0, NORMAL_FORCE_N, 0.1);
    let probe = design.probe();
    let total =
        |state: &ContactState, row: &ContactSample| design.energy_j(state) + NORMAL_FORCE_N * row.finger_m;
    let resting = -0.5
        * NORMAL_FORCE_N
        * NORMAL_FORCE_N
        * (1.0 / probe.contact_stiffness_n_m + 1.0 / probe.pad_stiffness_n_m);
    let (mut largest, mut last) = (0.0_f64, 0.0);
    let mut row = [ContactSample::default()];
    design.run(&mut state, &[0.0], &[NORMAL_FORCE_N], &mut row);
    let start = total(&state, &row[0]) - resting;
    for _ in 0..(seconds * rate_hz) as usize {
        design.run(&mut state, &[0.0], &[NORMAL_FORCE_N], &mut row);
        last = (total(&state, &row[0]) - resting) / start;
        largest = largest.max(last);
    }
    assert_eq!(state.resets(), 0);
    (largest, last)
}

#[test]
fn the_exact_scheme_gains_two_per_mille_in_ten_seconds() {
    for stiffness in [1e3, 1e4, 5e4, 2e5, 1e6, 3e6, 5e6] {
        let design = MicroContact::new(&undamped(stiffness), Integrator::ExactEvent, 44_100.0).unwrap();
        assert_eq!(design.integrator(), Integrator::ExactEvent);
        let (largest, last) = bouncing_gain(&design, 44_100.0, 10.0);
        println!("{stiffness:.0e} N/m: largest {largest:.9}, after 10 s {last:.9}");
        assert!(largest <= 1.002, "{stiffness:.0e} N/m: gain {largest}");
        assert!(last >= 0.99, "{stiffness:.0e} N/m: {last} left");
    }
}

#[test]
fn the_energy_conserving_scheme_conserves_energy_to_1e_9() {
    for rate_hz in [8_000.0, 44_100.0, 192_000.0] {
        for stiffness in [5e4, 1e6, 9e7] {
            let design =
                MicroContact::new(&undamped(stiffness), Integrator::EnergyConserving, rate_hz).unwrap();
            let (largest, last) = bouncing_gain(&design, rate_hz, 10.0 * (44_100.0 / rate_hz).min(1.0));
            println!("{rate_hz} Hz {stiffness:.0e} N/m: {:.2e} {:.2e}", largest - 1.0, last - 1.0);
            assert!(largest <= 1.0 + 1e-9, "{rate_hz} Hz, {stiffness:.0e} N/m: gain {largest}");
            assert!(last >= 1.0 - 1e-9, "{rate_hz} Hz, {stiffness:.0e} N/m: {last} left");
        }
    }
}

#[test]
fn the_builders_limits_keep_the_gain_to_a_few_per_cent() {
    // Plain Euler is what the paper has; at the largest phase the rule allows it random-walks.
    for rate_hz in [8_000.0, 22_050.0, 44_100.0, 96_000.0, 192_000.0] {
        for stiffness in [1e3, 5e4, 1e6, 1e8] {
            for wanted in Integrator::ALL {
                let design = MicroContact::new(&undamped(stiffness), wanted, rate_hz).unwrap();
                let (largest, _) = bouncing_gain(&design, rate_hz, 0.2);
                let limit = match design.integrator() {
                    Integrator::EnergyConserving => 1.0 + 1e-9,
                    Integrator::ExactEvent => 1.002,
                    _ => 2.0,
                };
                assert!(
                    largest <= limit,
                    "{} at {rate_hz} Hz, {stiffness:.0e} N/m: gain {largest}",
                    design.choice()
                );
            }
        }
    }
}
