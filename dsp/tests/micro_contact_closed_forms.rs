//! Motions with known formulas, at every rate.

use asperity_dsp::micro_contact::{ContactSample, Integrator, MicroContact, Probe};
use asperity_dsp::simd::Level;

const RATES_HZ: [f64; 6] = [8_000.0, 22_050.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0];

fn run(
    design: &MicroContact,
    height_m: f64,
    force_n: f64,
    closing: Option<f64>,
    count: usize,
) -> Vec<ContactSample> {
    let mut state = match closing {
        Some(speed) => design.landing(height_m, force_n, speed),
        None => design.at_rest(height_m, force_n),
    };
    let mut out = vec![ContactSample::default(); count];
    design.run(&mut state, &vec![height_m; count], &vec![force_n; count], &mut out);
    assert_eq!(state.resets(), 0);
    out
}

/// The contact that has closed forms: linear, 50 kN/m.
fn linear() -> Probe {
    Probe { contact_stiffness_n_m: 5e4, force_exponent: 0.0, ..Probe::default() }
}

/// A skin that hardly feels the finger: it lands, turns and leaves as a mass on one spring.
fn lone_mass() -> Probe {
    Probe { pad_stiffness_n_m: 1e-3, pad_damping_n_s_m: 0.0, leash_m: 0.05, ..linear() }
}

#[test]
fn a_resting_finger_stays_where_the_springs_hold_it() {
    for (rate_hz, level) in
        RATES_HZ.into_iter().flat_map(|rate| Level::available().map(move |level| (rate, level)))
    {
        // Products and sums that round apart: 2.1e-16 m at the worst; fused 3e-20.
        let digits_m = if level == Level::PORTABLE { 4e-16 } else { 1e-16 };
        for integrator in Integrator::ALL {
            let design = MicroContact::new(&linear(), integrator, rate_hz).unwrap().on(level);
            for (height_m, force_n) in [(0.0, 0.5), (4e-3, 2.0), (-1e-3, 0.02), (0.3, 0.0)] {
                for row in run(&design, height_m, force_n, None, 4000) {
                    assert!(
                        (row.pad_m - (height_m - force_n / 5e4)).abs() <= digits_m,
                        "{integrator:?} {row:?}"
                    );
                    assert!((row.finger_m - (row.pad_m - force_n / 1000.0)).abs() <= digits_m, "{row:?}");
                    assert!((row.contact_force_n - force_n).abs() <= 1e-11, "{integrator:?} {row:?}");
                    assert!(row.onset.is_none());
                }
            }
        }
    }
}

#[test]
fn a_landing_mass_follows_the_half_sine_of_a_linear_contact() {
    let probe = lone_mass();
    let omega = (probe.contact_stiffness_n_m / probe.pad_mass_kg).sqrt();
    for rate_hz in RATES_HZ {
        let design = MicroContact::new(&probe, Integrator::ExactEvent, rate_hz).unwrap();
        let speed = 0.1;
        let half_period_s = std::f64::consts::PI / omega;
        for (n, row) in run(&design, 0.0, 0.0, Some(speed), 64).iter().enumerate() {
            // The first row is one sample before the first input, when skin and surface meet.
            // (Later the weak spring to the finger shows.)
            let t = n as f64 / rate_hz;
            if t > 3.0 * half_period_s {
                break;
            }
            let wanted = if t < half_period_s {
                -speed / omega * (omega * t).sin()
            } else {
                speed * (t - half_period_s)
            };
            assert!(
                (row.pad_m - wanted).abs() <= 1e-4 * speed / omega,
                "{rate_hz} Hz, row {n}: {row:?}, {wanted:e}"
            );
        }
    }
}

#[test]
fn the_impulse_of_a_bounce_reverses_the_momentum() {
    let probe = lone_mass();
    for rate_hz in RATES_HZ {
        for integrator in [Integrator::ExactEvent, Integrator::EnergyConserving] {
            let design = MicroContact::new(&probe, integrator, rate_hz).unwrap();
            let rows = run(&design, 0.0, 0.0, Some(0.1), 64);
            let impulse: f64 = rows.iter().map(|row| row.contact_force_n / rate_hz).sum();
            let wanted = 2.0 * probe.pad_mass_kg * 0.1;
            assert!((impulse - wanted).abs() <= 1e-4 * wanted, "{integrator:?} {rate_hz} Hz: {impulse:e}");
        }
    }
}

#[test]
fn a_landing_is_reported_once_with_its_speed() {
    let probe = lone_mass();
    for rate_hz in RATES_HZ {
        for integrator in Integrator::ALL {
            let design = MicroContact::new(&probe, integrator, rate_hz).unwrap();
            let onsets: Vec<_> =
                run(&design, 1e-3, 0.0, Some(0.07), 64).iter().filter_map(|row| row.onset).collect();
            assert_eq!(onsets.len(), 1, "{integrator:?} {rate_hz} Hz: {onsets:?}");
            assert!((onsets[0].closing_m_s - 0.07).abs() <= 1e-6, "{integrator:?} {rate_hz} Hz: {onsets:?}");
            assert!((0.0..=1.0).contains(&onsets[0].offset));
        }
    }
}

#[test]
fn an_unloaded_pad_rings_down_as_two_masses() {
    // Pressed hard, then released: skin and finger fly up together, and their distance rings.
    let probe = Probe { pad_damping_n_s_m: 0.05, leash_m: 0.05, ..linear() };
    let mass = 1.0 / (1.0 / probe.pad_mass_kg + 1.0 / probe.finger_mass_kg);
    let decay = probe.pad_damping_n_s_m / (2.0 * mass);
    let omega = (probe.pad_stiffness_n_m / mass - decay * decay).sqrt();
    for rate_hz in RATES_HZ {
        for (integrator, bar) in [(Integrator::ExactEvent, 1e-9), (Integrator::EnergyConserving, 1e-9)] {
            let design = MicroContact::new(&probe, integrator, rate_hz).unwrap();
            let mut state = design.at_rest(0.0, 1.0);
            let count = (0.02 * rate_hz) as usize;
            let mut out = vec![ContactSample::default(); count];
            // The surface drops away by 20 mm at once.
            design.run(&mut state, &vec![-0.02; count], &vec![0.0; count], &mut out);
            let first = count / 4;
            let stretch = |n: usize| out[n].pad_m - out[n].finger_m;
            let (a, b) = (stretch(first), stretch(first + 1));
            // Two samples fix a damped sinusoid of known frequency and decay; all others must lie
            // on it.
            let (h, damp) = (1.0 / rate_hz, (-decay / rate_hz).exp());
            let sine = (b / damp - a * (omega * h).cos()) / (omega * h).sin();
            for n in first..count {
                let t = (n - first) as f64 * h;
                let wanted = (-decay * t).exp() * (a * (omega * t).cos() + sine * (omega * t).sin());
                assert!(
                    (stretch(n) - wanted).abs() <= bar * 1e-3 * rate_hz / 8e3,
                    "{integrator:?} {rate_hz} Hz, row {n}"
                );
            }
        }
    }
}

#[test]
fn an_unloaded_finger_stays_on_its_leash_and_comes_back() {
    for integrator in Integrator::ALL {
        let design = MicroContact::new(&linear(), integrator, 44_100.0).unwrap();
        let mut state = design.at_rest(0.0, 0.5);
        let mut row = [ContactSample::default()];
        let mut farthest = 0.0_f64;
        for n in 0..88_200 {
            // Slides for 0.2 s, then the force is gone for 1.8 s.
            let height = 5e-5 * (f64::from(n) * 0.15).sin();
            let force = if n < 8820 { 0.5 } else { 0.0 };
            design.run(&mut state, &[height], &[force], &mut row);
            farthest = farthest.max(row[0].pad_m - height);
        }
        assert!(farthest <= 1.3e-3, "{integrator:?}: {farthest} m away");
        let back = (0..44_100).find(|_| {
            design.run(&mut state, &[0.0], &[0.5], &mut row);
            row[0].contact_force_n > 0.0
        });
        assert!(back.is_some_and(|n| n < 600), "{integrator:?}: back after {back:?} samples");
    }
}

#[test]
fn a_finger_that_landed_settles_and_says_so() {
    for rate_hz in [8_000.0, 44_100.0, 192_000.0] {
        for integrator in Integrator::ALL {
            let design = MicroContact::new(&linear(), integrator, rate_hz).unwrap();
            let mut state = design.landing(1e-3, 0.5, 0.05);
            assert!(!design.is_settled(&state, 1e-3, 0.5));
            let count = rate_hz as usize;
            let mut out = vec![ContactSample::default(); count];
            design.run(&mut state, &vec![1e-3; count], &vec![0.5; count], &mut out);
            assert!(design.is_settled(&state, 1e-3, 0.5), "{integrator:?} {rate_hz} Hz: {state:?}");
            assert!(!design.is_settled(&state, 1e-3, 0.6) && !design.is_settled(&state, 1.1e-3, 0.5));
        }
    }
}

#[test]
fn a_finger_that_rides_on_rising_ground_goes_on_without_a_blow() {
    for integrator in Integrator::ALL {
        for velocity_m_s in [-0.3, 0.02, 0.3] {
            let design = MicroContact::new(&linear(), integrator, 44_100.0).unwrap();
            let mut state = design.riding(1e-3, 0.5, velocity_m_s);
            let heights: Vec<f64> =
                (1..=2000).map(|n| 1e-3 + velocity_m_s * f64::from(n) / 44_100.0).collect();
            let mut rows = vec![ContactSample::default(); heights.len()];
            design.run(&mut state, &heights, &[0.5; 2000], &mut rows);
            for row in &rows {
                assert!((row.contact_force_n - 0.5).abs() < 1e-6, "{integrator:?} {velocity_m_s}: {row:?}");
                assert!((row.pad_velocity_m_s - velocity_m_s).abs() < 1e-6, "{integrator:?}: {row:?}");
            }
            // A velocity that is no number is none.
            assert_eq!(design.riding(1e-3, 0.5, f64::NAN), design.at_rest(1e-3, 0.5));
            assert_eq!(design.riding(1e-3, 0.5, 1e300), design.at_rest(1e-3, 0.5));
        }
    }
}
