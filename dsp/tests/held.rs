//! Held bodies against exact eigenvalues, the closed form of the first order, and passivity.

use asperity_dsp::held::{Complex, Hold, Pole, driving_point_n_s_m, held};
use asperity_dsp::micro_contact::Probe;
use asperity_dsp::rng::Rng;
use std::f64::consts::TAU;

/// numpy's eigenvalues, tests/independent/held.py 0.00015 1000 2 0.02 200000: mass of the body, kg;
/// frequency, decay and motion of a mode; frequency and decay while a fingertip presses.
const EIGENVALUES: &str = include_str!("independent/held_reference.csv");
/// Modes of each body there.
const MODES: usize = 12;

fn rows() -> Vec<[f64; 6]> {
    let row = |line: &str| {
        let mut numbers = line.split(',').map(|x| x.parse::<f64>().unwrap());
        std::array::from_fn(|_| numbers.next().unwrap())
    };
    EIGENVALUES.lines().map(row).collect()
}

fn percentile(errors: &mut [f64], share: f64) -> f64 {
    errors.sort_by(f64::total_cmp);
    errors[((errors.len() - 1) as f64 * share) as usize]
}

#[test]
fn decays_are_those_of_the_coupled_system() {
    let probe = Probe::default();
    let mut all = Vec::new();
    let mut p90_of_all = 0.0_f64;
    for mass_kg in [0.1, 0.15, 0.3, 0.6, 1.0, 2.0, 5.0] {
        let (mut errors, mut cents) = (Vec::new(), Vec::new());
        let rows: Vec<_> = rows().into_iter().filter(|row| row[0] == mass_kg).collect();
        for body in rows.chunks(MODES) {
            let free: Vec<Pole> =
                body.iter().map(|row| Pole { frequency_hz: row[1], decay_per_s: row[2] }).collect();
            let phi: Vec<f64> = body.iter().map(|row| row[3]).collect();
            let hold = Hold { probe: &probe, phi_per_sqrt_kg: &phi };
            for (mode, [.., exact_hz, exact_per_s]) in body.iter().enumerate() {
                let pole = held(&free, mode, &[hold]).unwrap();
                errors.push(100.0 * (pole.decay_per_s / exact_per_s - 1.0).abs());
                cents.push(1200.0 * (pole.frequency_hz / exact_hz).log2().abs());
            }
        }
        all.extend(errors.clone());
        let (median, p90) = (percentile(&mut errors, 0.5), percentile(&mut errors, 0.9));
        let pitch = percentile(&mut cents, 0.9);
        println!("{mass_kg} kg: decay median {median:.2} %, p90 {p90:.2} %; pitch p90 {pitch:.2} cents");
        p90_of_all = p90_of_all.max(p90);
    }
    println!("all: p90 {:.2} %", percentile(&mut all, 0.9));
    assert!(p90_of_all <= 8.0, "{p90_of_all:.1} %");
}

#[test]
fn a_light_touch_damps_by_half_of_what_the_impedance_says() {
    let probe = Probe::default();
    for (frequency_hz, phi_per_sqrt_kg) in [(150.0, 0.01), (900.0, 0.02), (6_000.0, 0.005)] {
        let free = Pole { decay_per_s: 3.0, frequency_hz };
        let pole = held(&[free], 0, &[Hold { probe: &probe, phi_per_sqrt_kg: &[phi_per_sqrt_kg] }]).unwrap();
        let s = Complex { re: -3.0, im: TAU * frequency_hz };
        let z = driving_point_n_s_m(&probe, s);
        let half = 0.5 * phi_per_sqrt_kg * phi_per_sqrt_kg;
        let (damped, detuned) = (pole.decay_per_s - 3.0, TAU * (pole.frequency_hz - frequency_hz));
        assert!((damped / (half * z.re) - 1.0).abs() < 0.01, "{damped} against {}", half * z.re);
        assert!((detuned + half * z.im).abs() < 0.01 * half * z.re.hypot(z.im), "{detuned}");
    }
}

#[test]
fn no_hold_lets_a_body_ring_longer_and_more_hold_never_less() {
    let mut rng = Rng::new(5);
    let within = |rng: &mut Rng, low: f64, high: f64| low * (high / low).powf(rng.uniform());
    for _ in 0..100_000 {
        let probe = Probe {
            pad_mass_kg: within(&mut rng, 1e-5, 0.1),
            pad_stiffness_n_m: within(&mut rng, 10.0, 1e6),
            pad_damping_n_s_m: within(&mut rng, 1e-3, 1e3),
            finger_mass_kg: within(&mut rng, 1e-3, 10.0),
            contact_stiffness_n_m: within(&mut rng, 1e3, 1e7),
            ..Probe::default()
        };
        let free =
            Pole { decay_per_s: within(&mut rng, 1e-2, 1e3), frequency_hz: within(&mut rng, 20.0, 2e4) };
        let other = Pole { frequency_hz: within(&mut rng, 20.0, 2e4), ..free };
        let phi = [within(&mut rng, 1e-3, 100.0), within(&mut rng, 1e-3, 100.0)];
        let hold = Hold { probe: &probe, phi_per_sqrt_kg: &phi };
        let pole = held(&[free, other], 0, &[hold, hold]).unwrap();
        assert!(pole.decay_per_s >= free.decay_per_s, "{free:?} {probe:?} {pole:?}");
        assert!(pole.frequency_hz.is_finite() && pole.frequency_hz > 0.0, "{pole:?}");
    }
}

#[test]
fn a_body_that_nobody_touches_keeps_its_poles_to_the_bit() {
    let probe = Probe::default();
    let free = Pole { decay_per_s: 0.1 + 0.2, frequency_hz: 1e3 / 3.0 };
    assert_eq!(held(&[free], 0, &[]), Some(free));
    assert_eq!(held(&[free], 0, &[Hold { probe: &probe, phi_per_sqrt_kg: &[0.0] }]), Some(free));
    assert_eq!(held(&[free], 0, &[Hold { probe: &probe, phi_per_sqrt_kg: &[] }]), Some(free));
    assert_eq!(held(&[free], 0, &[Hold { probe: &probe, phi_per_sqrt_kg: &[f64::NAN] }]), Some(free));
    assert_eq!(held(&[free], 1, &[]), None);
}
