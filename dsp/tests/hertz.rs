//! Hertz pulses against the integrated equation of motion, and the ring and the bank against the
//! exact response.

use asperity_dsp::hertz::{
    Elastic, FORCE_HISTORY, HertzContact, HertzPulse, KERNEL_LATENCY, OnsetMerge, deposit_force, pulse_shape,
    spread_force, take,
};
use asperity_dsp::modal_bank::{
    GroupOptions, GroupState, Inputs, ModalBank, ReferenceMode, ReferenceState, design_group,
};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::Level;
use std::f64::consts::PI;

const STEEL: Elastic = Elastic { young_pa: 200e9, poisson: 0.3 };
const RUBBER: Elastic = Elastic { young_pa: 1e7, poisson: 0.49 };

/// The elastic pulse by integrating x'' = −x^1.5 from x' = 1 (Runge–Kutta): (contact time · v /
/// largest x, samples of the force over u in 0..1 at STEPS + 1 points with area 1).
const STEPS: usize = 2_000;
fn integrated() -> (f64, Vec<f64>) {
    let slope = |x: f64| -x.max(0.0).powf(1.5);
    let step = |x: f64, v: f64, h: f64| {
        let (k1, l1) = (v, slope(x));
        let (k2, l2) = (v + 0.5 * h * l1, slope(x + 0.5 * h * k1));
        let (k3, l3) = (v + 0.5 * h * l2, slope(x + 0.5 * h * k2));
        let (k4, l4) = (v + h * l3, slope(x + h * k3));
        (x + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4), v + h / 6.0 * (l1 + 2.0 * (l2 + l3) + l4))
    };
    let (mut x, mut v, mut t) = (0.0, 1.0, 0.0);
    let h = 1e-4;
    let mut half = 0.0;
    // Up to the turning point, which is half of it.
    while v > 0.0 {
        let next = step(x, v, h);
        half = t + h * v / (v - next.1);
        (x, v) = next;
        t += h;
    }
    let contact = 2.0 * half;
    let (mut x, mut v) = (0.0, 1.0);
    let mut force = vec![0.0];
    for _ in 0..STEPS {
        for _ in 0..20 {
            (x, v) = step(x, v, contact / (20 * STEPS) as f64);
        }
        force.push(x.max(0.0).powf(1.5) * contact / 2.0);
    }
    (contact / 1.25_f64.powf(0.4), force)
}

/// ∫ F e^(−s t) dt of the integrated pulse of impulse 1 for s = −decay + iω (Simpson).
fn transform(force: &[f64], contact_time_s: f64, decay_per_s: f64, omega: f64) -> (f64, f64) {
    let (mut re, mut im) = (0.0, 0.0);
    for (i, f) in force.iter().enumerate() {
        let weight = if i == 0 || i == STEPS { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
        let u = i as f64 / STEPS as f64;
        let g = weight * f / (3.0 * STEPS as f64) * (decay_per_s * u * contact_time_s).exp();
        let angle = omega * u * contact_time_s;
        re += g * angle.cos();
        im -= g * angle.sin();
    }
    (re, im)
}

#[test]
fn the_shape_is_that_of_the_integrated_equation() {
    let (constant, force) = integrated();
    assert!((constant - 2.943_275_18).abs() < 1e-6, "τ v / x_max = {constant}");
    let peak = 1.839_547;
    for (i, f) in force.iter().enumerate() {
        let error = (pulse_shape(i as f64 / STEPS as f64) - f).abs() / peak;
        assert!(error < 1e-3, "{error} at {i}");
    }
    let rms: f64 =
        force.iter().enumerate().map(|(i, f)| (pulse_shape(i as f64 / STEPS as f64) - f).powi(2)).sum();
    assert!((rms / force.iter().map(|f| f * f).sum::<f64>()).sqrt() < 3.5e-4);
    assert_eq!((pulse_shape(-0.1), pulse_shape(1.1), pulse_shape(f64::NAN)), (0.0, 0.0, 0.0));
}

// scipy.integrate.solve_ivp (DOP853), tests/independent/hertz_pulse.py.
#[test]
fn the_shape_agrees_with_scipy() {
    let figures = [
        0.1036666, 0.2907914, 0.5248405, 0.7846941, 1.0506516, 1.3031190, 1.5232311, 1.6941361, 1.8024494,
        1.8395470,
    ];
    for (i, expected) in figures.into_iter().enumerate() {
        let u = 0.05 * (i + 1) as f64;
        assert!((pulse_shape(u) - expected).abs() < 1e-3 * 1.84, "{u}");
        assert!((pulse_shape(1.0 - u) - pulse_shape(u)).abs() < 1e-12);
    }
}

#[test]
fn contact_time_force_and_impulse_follow_hertz() {
    let mass = |r: f64| 7_800.0 * 4.0 / 3.0 * PI * r.powi(3);
    let ball = HertzContact::new(&STEEL, &STEEL, 0.005, mass(0.005)).unwrap();
    assert!((ball.effective_modulus_pa() / 109.89e9 - 1.0).abs() < 1e-4);
    for speed in [0.01, 0.1, 1.0, 7.3] {
        // Everything from x_max = (5 m v² / 4k)^(2/5).
        let k = 4.0 / 3.0 * ball.effective_modulus_pa() * 0.005_f64.sqrt();
        let deepest = (5.0 * ball.mass_kg() * speed * speed / (4.0 * k)).powf(0.4);
        let time = ball.contact_time_s(speed);
        assert!((time / (2.943_275_18 * deepest / speed) - 1.0).abs() < 1e-7, "{speed} m/s: {time} s");
        assert!((ball.impulse_n_s(speed) - 2.0 * ball.mass_kg() * speed).abs() < 1e-12);
    }
    // Hand figures: 86, 54 and 34 µs at 0.01, 0.1 and 1 m/s; a rubber ball of the same size touches
    // for milliseconds.
    assert!((ball.contact_time_s(0.1) * 1e6 - 54.0).abs() < 2.0, "{}", ball.contact_time_s(0.1));
    let soft = HertzContact::new(&RUBBER, &STEEL, 0.005, 0.000_6).unwrap().contact_time_s(1.0);
    assert!((5e-4..3e-3).contains(&soft), "{soft}");
}

#[test]
fn a_speed_that_is_no_speed_gives_no_impulse() {
    let ball = HertzContact::new(&STEEL, &STEEL, 0.005, 0.004).unwrap();
    for speed in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let pulse = ball.pulse(speed);
        assert!(pulse.impulse_n_s == 0.0 && pulse.contact_time_s.is_finite());
    }
}

#[test]
fn impossible_contacts_are_refused_by_name() {
    let field = |a: Elastic, r, m| HertzContact::new(&a, &STEEL, r, m).unwrap_err().field;
    assert_eq!(field(Elastic { young_pa: 0.0, poisson: 0.3 }, 0.01, 0.01), "young_pa");
    assert_eq!(field(Elastic { young_pa: 1e9, poisson: 0.6 }, 0.01, 0.01), "poisson");
    assert_eq!(field(STEEL, -1.0, 0.01), "radius_m");
    assert_eq!(field(STEEL, 0.01, f64::NAN), "mass_kg");
}

fn beta3(t: f64) -> f64 {
    let t = t.abs();
    if t < 1.0 {
        2.0 / 3.0 - t * t + 0.5 * t * t * t
    } else if t < 2.0 {
        (2.0 - t).powi(3) / 6.0
    } else {
        0.0
    }
}

#[test]
fn the_ring_receives_the_pulse_under_the_cubic_kernel() {
    for length in [0.01, 0.3, 1.0, 2.7, 3.999, 4.0, 4.001, 5.5, 9.0, 40.0, 200.0] {
        for offset in [0.0, 0.123, 0.5, 0.999, 1.0] {
            let mut ring = vec![0.0; 512];
            HertzPulse::elastic(3.0, length).deposit(&mut ring, 1_000, offset, 1.0);
            for k in 0..length as usize + 8 {
                // Brute force: the middle of 4000 pieces of the pulse.
                let n = 4_000;
                let pieces = (0..n).map(|i| {
                    let u = (i as f64 + 0.5) / f64::from(n);
                    pulse_shape(u) * beta3(k as f64 - 2.0 - offset - u * length)
                });
                let exact = 3.0 * pieces.sum::<f64>() / f64::from(n);
                let y = ring[(1_000 + k) & 511];
                assert!(
                    (y - exact).abs() < 3e-6,
                    "length {length}, offset {offset}, sample {k}: {y}, {exact}"
                );
            }
        }
    }
}

#[test]
fn impulse_onset_and_length_are_exact_to_rounding() {
    let mut rng = Rng::new(1);
    for _ in 0..2_000 {
        let length = 1e-3 * 1e6_f64.powf(rng.uniform());
        let offset = rng.uniform();
        let mut ring = vec![0.0; 2048];
        HertzPulse::elastic(1.0, length / 44_100.0).deposit(&mut ring, 0, offset, 44_100.0);
        let moment = |power: i32| -> f64 {
            let centre = KERNEL_LATENCY as f64 + offset + 0.5 * length;
            ring.iter().enumerate().map(|(k, x)| x * (k as f64 - centre).powi(power)).sum()
        };
        assert!((moment(0) - 1.0).abs() < 1e-9, "area of a pulse of {length} samples: {}", moment(0));
        assert!(
            moment(1).abs() < 1e-8 * length.max(1.0),
            "centroid of a pulse of {length} samples: {}",
            moment(1)
        );
        // Kernel 1/3, pulse 0.037665 of its length squared (scipy's shape).
        let width = moment(2) - 1.0 / 3.0;
        assert!(
            (width / (length * length) - 0.037_665).abs() < 2e-5 || length < 0.01,
            "{}",
            width / (length * length)
        );
    }
}

/// Largest |response − exact| / J over modes up to 10 kHz, onsets and phases, of the f64 reference
/// mode.
fn worst_error(rate: f64, contact_time_s: f64, force: &[f64], rng: &mut Rng) -> f64 {
    let mut worst = 0.0_f64;
    for frequency_hz in [50.0, 440.0, 1_000.0, 3_000.0, 6_000.0, 8_000.0, 10_000.0] {
        for _ in 0..8 {
            let decay_per_s = 5.0 + 500.0 * rng.uniform();
            let mode = Mode { frequency_hz, decay_per_s, amplitude: 1.0, phase_rad: 6.0 * rng.uniform() };
            let design = ReferenceMode::new(&mode, rate, &GroupOptions::IMPULSE_RING).unwrap();
            let (mut state, mut ring) = (ReferenceState::default(), vec![0.0; 1024]);
            let offset = rng.uniform();
            HertzPulse::elastic(1.0, contact_time_s).deposit(&mut ring, 20, offset, rate);
            let omega = 2.0 * PI * frequency_hz;
            let (re, im) = transform(force, contact_time_s, decay_per_s, omega);
            let (level, angle) = ((re * re + im * im).sqrt(), im.atan2(re));
            let onset = (20.0 + offset) / rate;
            let end = 20 + (contact_time_s * rate) as usize + 6;
            let mut error = 0.0_f64;
            for (n, u) in ring.iter().enumerate() {
                let y = design.tick(&mut state, *u);
                if n >= end {
                    let t = (n - KERNEL_LATENCY) as f64 / rate - onset;
                    let decay = (-decay_per_s * t).exp();
                    let exact = level * decay * (omega * t + mode.phase_rad + angle).sin();
                    error = error.max((y - exact).abs() / decay);
                }
            }
            worst = worst.max(error);
        }
    }
    worst
}

#[test]
fn a_struck_mode_answers_like_the_integrated_pulse_within_1_percent() {
    let (_, force) = integrated();
    let mut rng = Rng::new(2);
    for rate in [44_100.0, 48_000.0, 96_000.0, 192_000.0] {
        for contact_time_s in [1e-6, 1e-5, 2e-5, 4e-5, 8e-5, 1.6e-4, 3e-4, 6e-4, 1e-3, 3e-3] {
            let worst = worst_error(rate, contact_time_s, &force, &mut rng);
            println!("{rate} Hz, {:.0} µs: {:.3} %", contact_time_s * 1e6, 100.0 * worst);
            assert!(worst < 0.01, "{rate} Hz, {contact_time_s} s: {worst}");
        }
    }
}

#[test]
fn an_impact_is_equally_loud_at_every_rate() {
    for contact_time_s in [1e-5, 5e-5, 3e-4] {
        let mut levels = vec![];
        for rate in [44_100.0, 48_000.0, 96_000.0, 192_000.0] {
            let mode =
                |frequency_hz| Mode { frequency_hz, decay_per_s: 60.0, amplitude: 1.0, phase_rad: 0.0 };
            let modes = [mode(400.0), mode(2_500.0), mode(6_300.0), mode(9_900.0)];
            let group = design_group(&modes, rate, &GroupOptions::IMPULSE_RING).unwrap();
            let mut ring = vec![0.0; 1 << 16];
            HertzPulse::elastic(1e-3, contact_time_s).deposit(&mut ring, 10, 0.3, rate);
            let samples = (0.25 * rate) as usize;
            let (mut impulses, mut out) = (vec![0.0; samples], vec![0.0; samples]);
            take(&mut ring, 0, &mut impulses);
            let mut bank = ModalBank::new(Level::detect(), [group], [GroupState::REST]);
            bank.render(0, Inputs::One(&impulses), &mut out);
            levels.push(10.0 * (out.iter().map(|y| f64::from(*y).powi(2)).sum::<f64>() / rate).log10());
        }
        println!("{contact_time_s} s: {levels:?}");
        assert!(levels.iter().all(|l| (l - levels[3]).abs() < 0.1), "{contact_time_s} s: {levels:?} dB");
    }
}

#[test]
fn a_mean_force_reaches_a_mode_as_a_pulse_does() {
    let mut ring = vec![0.0; 16];
    deposit_force(&mut ring, 0, &[1.0]);
    for theta in (1..=100).map(|i| 0.5 * PI * 0.01 * f64::from(i)) {
        let taps: f64 = ring.iter().zip(0..).map(|(x, n)| x * (theta * f64::from(n - 2)).cos()).sum();
        let mean = (0.5 * theta).sin() / (0.5 * theta);
        let level_db = 20.0 * (taps * mean / mean.powi(4)).log10();
        assert!(level_db.abs() < 0.1, "θ {theta}: {level_db} dB");
    }
}

#[test]
fn sampled_force_and_pulses_reach_a_mode_alike() {
    // A smooth push of 2 ms, sampled, against its exact transform.
    let (rate, frequency_hz, width) = (44_100.0, 700.0, 3e-4);
    let mode = Mode { frequency_hz, decay_per_s: 30.0, amplitude: 1.0, phase_rad: 0.2 };
    let design = ReferenceMode::new(&mode, rate, &GroupOptions::IMPULSE_RING).unwrap();
    let at = 0.01;
    let push =
        |n: usize| (-0.5 * ((n as f64 / rate - at) / width).powi(2)).exp() / (width * (2.0 * PI).sqrt());
    let force: Vec<f64> = (0..1_000).map(|n| push(n) / rate).collect();
    let mut ring = vec![0.0; 2048];
    // In blocks, as the engine does.
    for (i, block) in force.chunks(64).enumerate() {
        deposit_force(&mut ring, 64 * i as u64, block);
    }
    let mut state = ReferenceState::default();
    let omega = 2.0 * PI * frequency_hz;
    // Transform of a Gaussian at −d + iω about its centre.
    let level = (0.5 * width * width * (mode.decay_per_s.powi(2) - omega * omega)).exp();
    let angle = -mode.decay_per_s * omega * width * width;
    for (n, u) in ring.iter().enumerate().take(1_500) {
        let y = design.tick(&mut state, *u);
        let t = (n as f64 - KERNEL_LATENCY as f64) / rate - at;
        if t > 8.0 * width {
            let exact = level * (-30.0 * t).exp() * (omega * t + 0.2 + angle).sin();
            assert!((y - exact).abs() < 1e-3, "sample {n}: {y} {exact}");
        }
    }
}

#[test]
fn the_ring_wraps_clamps_and_ignores_what_is_no_pulse() {
    let mut ring = vec![0.0; 64];
    HertzPulse::elastic(1.0, 1.0).deposit(&mut ring, u64::MAX - 3, 0.5, 44_100.0);
    let sum: f64 = ring.iter().sum();
    assert!(
        (sum - 1.0).abs() < 1e-9 && ring.iter().all(|x| *x >= 0.0),
        "a contact too long keeps its impulse: {sum}"
    );
    // The onset's own sample belongs to the past and is never written.
    assert_eq!(ring[(u64::MAX - 3) as usize & 63], 0.0);
    let mut ring = vec![0.0; 64];
    for (j, t, o) in
        [(f64::NAN, 1e-4, 0.0), (1.0, f64::NAN, 0.0), (1.0, 1e-4, f64::NAN), (f64::INFINITY, 1e-4, 0.0)]
    {
        HertzPulse::elastic(j, t).deposit(&mut ring, 0, o, 44_100.0);
    }
    assert!(ring.iter().all(|x| *x == 0.0));
    HertzPulse::elastic(1.0, -1.0).deposit(&mut ring, 0, 7.0, 44_100.0);
    assert!((ring.iter().sum::<f64>() - 1.0).abs() < 1e-9);
}

#[test]
fn a_pulse_is_the_same_wherever_in_the_ring_it_begins() {
    let at = |onset: u64, offset: f64, samples: f64| {
        let mut ring = [0.0; 64];
        HertzPulse::elastic(1.0, samples).deposit(&mut ring, onset, offset, 1.0);
        ring.rotate_left((onset % 64) as usize);
        ring
    };
    let mut rng = Rng::new(57);
    for onset in (0..200).chain(4000..4200).chain(u64::MAX - 200..u64::MAX) {
        let (offset, samples) = (rng.uniform(), 1.0 + 50.0 * rng.uniform());
        assert_eq!(at(onset, offset, samples), at(0, offset, samples), "onset {onset}");
    }
}

#[test]
fn reading_clears_the_ring_and_lets_no_denormal_through() {
    let mut ring = vec![0.0; 16];
    ring[14] = 2.0;
    ring[15] = 1e-40;
    ring[0] = f64::NAN;
    ring[1] = 1e300;
    let mut out = [9.0; 5];
    take(&mut ring, 14, &mut out);
    assert_eq!(out, [2.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(ring.iter().all(|x| *x == 0.0));
}

#[test]
fn onsets_within_a_contact_add_only_what_is_harder() {
    let (mut merge, rate) = (OnsetMerge::default(), 44_100.0);
    let hit = |j| HertzPulse::elastic(j, 4.0 / rate);
    assert_eq!(merge.merge_onset(hit(1.0), 100, 0.5, rate), Some(hit(1.0)));
    assert_eq!(merge.merge_onset(hit(0.7), 102, 0.0, rate), None);
    let more = merge.merge_onset(hit(1.5), 103, 0.0, rate).unwrap();
    assert!((more.impulse_n_s - 0.5).abs() < 1e-12);
    // The harder hit prolongs the contact to 107; then a new one begins.
    assert_eq!(merge.merge_onset(hit(0.2), 106, 0.9, rate), None);
    assert_eq!(merge.merge_onset(hit(0.2), 107, 0.0, rate), Some(hit(0.2)));
    assert_eq!(merge.merge_onset(hit(f64::NAN), 108, 0.0, rate), None);
}

#[test]
fn a_force_spread_by_samples_is_what_the_ring_would_give() {
    let mut rng = Rng::new(12);
    let mut forces = vec![0.0; FORCE_HISTORY];
    forces.extend((0..200).map(|_| rng.normal()));
    let mut ring = vec![0.0; 512];
    deposit_force(&mut ring, 0, &forces[FORCE_HISTORY..]);
    let mut spread = vec![0.0; 200];
    // In two parts, as blocks come.
    let (first, second) = spread.split_at_mut(77);
    spread_force(&forces[..FORCE_HISTORY + 77], first);
    spread_force(&forces[77..], second);
    for (n, (a, b)) in spread.iter().zip(&ring).enumerate() {
        assert!((a - b).abs() < 1e-15, "sample {n}: {a} against {b}");
    }
}

/// Force of m x'' = −x^1.5 (1 + a x') from x' = 1, its step, and the speed at which the bodies
/// part.
fn damped(restitution: f64) -> (Vec<f64>, f64, f64) {
    // a (1 + e) = ln((1 + a) / (1 − a e)), by halving.
    let (mut low, mut high) = (1e-9, (1.0 - 1e-12) / restitution);
    for _ in 0..200 {
        let a = 0.5 * (low + high);
        let over = a * (1.0 + restitution) - ((1.0 + a) / (1.0 - a * restitution)).ln();
        if over > 0.0 { low = a } else { high = a }
    }
    let pull = |x: f64, v: f64| -> f64 { -x.max(0.0).powf(1.5) * (1.0 + low * v) };
    let (mut x, mut v, mut force, h) = (0.0, 1.0, vec![0.0], 1e-3);
    while x >= 0.0 {
        let (k1, l1) = (v, pull(x, v));
        let (k2, l2) = (v + 0.5 * h * l1, pull(x + 0.5 * h * k1, v + 0.5 * h * l1));
        let (k3, l3) = (v + 0.5 * h * l2, pull(x + 0.5 * h * k2, v + 0.5 * h * l2));
        let (k4, l4) = (v + h * l3, pull(x + h * k3, v + h * l3));
        x += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        v += h / 6.0 * (l1 + 2.0 * (l2 + l3) + l4);
        force.push(-pull(x, v));
    }
    (force, h, -v)
}

/// |∫ F e^(−iωt) dt|² of a force that is sampled this finely.
fn power_at(force: &[f64], step_s: f64, hz: f64) -> f64 {
    let at = |(i, f): (usize, &f64)| {
        let angle = 2.0 * PI * hz * i as f64 * step_s;
        [f * angle.cos(), f * angle.sin()]
    };
    let [re, im] = force.iter().enumerate().map(at).fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y]);
    (re * re + im * im) * step_s * step_s
}

#[test]
fn a_lossy_blow_is_as_bright_as_its_law_makes_it() {
    let (elastic, step_s, _) = damped(0.999_999);
    let time_s = (elastic.len() - 1) as f64 * step_s;
    for restitution in [0.95, 0.85, 0.7, 0.55, 0.5, 0.4, 0.25, 0.12] {
        let (force, step_s, parted) = damped(restitution);
        assert!((parted - restitution).abs() < 2e-3, "{restitution}: the law parts with {parted}");
        let pulse = HertzPulse { restitution, ..HertzPulse::elastic(1.0 + restitution, time_s) };
        let ours: Vec<f64> = (0..4_000).map(|i| pulse.force_n(f64::from(i) * 1e-3)).collect();
        let mut band_hz = 0.25 / time_s;
        while band_hz < 5.0 / time_s {
            let power = |force: &[f64], step_s: f64| -> f64 {
                (0..8).map(|i| power_at(force, step_s, band_hz * 2f64.powf(f64::from(i) / 24.0))).sum()
            };
            let apart_db = 10.0 * (power(&ours, 1e-3) / power(&force, step_s)).log10();
            let bound_db = if band_hz < 3.0 / time_s { 1.6 } else { 3.0 };
            assert!(apart_db.abs() < bound_db, "e {restitution}, {:.2} / τ: {apart_db} dB", band_hz * time_s);
            band_hz *= 2f64.powf(1.0 / 3.0);
        }
        let peak = |force: &[f64]| force.iter().copied().fold(0.0, f64::max);
        assert!(
            (peak(&ours) / peak(&force) - 1.0).abs() < 0.1,
            "e {restitution}: {}",
            peak(&ours) / peak(&force)
        );
    }
}

#[test]
fn a_lossy_pulse_keeps_its_impulse_and_an_elastic_one_its_bits() {
    let mut rng = Rng::new(7);
    for _ in 0..500 {
        let restitution = rng.uniform();
        let (impulse_n_s, contact_time_s) = (1.0 + rng.uniform(), 1e-6 * 1e4f64.powf(rng.uniform()));
        let pulse = HertzPulse { restitution, ..HertzPulse::elastic(impulse_n_s, contact_time_s) };
        let (mut ring, offset) = (vec![0.0; 1024], rng.uniform());
        pulse.deposit(&mut ring, 30, offset, 44_100.0);
        assert!((ring.iter().sum::<f64>() / impulse_n_s - 1.0).abs() < 1e-9, "e {restitution}");
        let end = pulse.end_sample(30, 44_100.0) as usize;
        assert!(ring[end..].iter().chain(&ring[..30]).all(|x| *x == 0.0), "e {restitution}: past its end");
    }
    let whole = HertzPulse::elastic(0.3, 2e-4);
    assert_eq!(whole.elastic_parts().collect::<Vec<_>>(), [whole]);
    let stuck = HertzPulse { restitution: 0.0, ..whole };
    assert_eq!(stuck.elastic_parts().collect::<Vec<_>>(), [whole]);
    assert_eq!(stuck.length_s(), whole.length_s());
}
