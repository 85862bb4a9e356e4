//! The observer is what the literature's procedures say, and stays so.

use asperity_dsp::rng::Rng;
use asperity_evidence::observer::constants::{constants_sha256, touch_threshold_m};
use asperity_evidence::observer::touch::{Hand, Unit, felt};
use asperity_evidence::observer::{Confusion, Judge, Percept, sound};
use std::f64::consts::PI;

const RATE_HZ: f64 = 8000.0;

fn sine(frequency_hz: f64, peak: f64, seconds: f64) -> Vec<f64> {
    (0..(seconds * RATE_HZ) as usize)
        .map(|n| peak * (2.0 * PI * frequency_hz * n as f64 / RATE_HZ).sin())
        .collect()
}

fn noise(seed: u64, seconds: f64, sd: f64) -> Vec<f64> {
    let mut rng = Rng::new(seed);
    (0..(seconds * RATE_HZ) as usize).map(|_| sd * rng.normal()).collect()
}

#[test]
fn no_constant_has_been_changed_since_the_observer_was_frozen() {
    println!("observer {}", constants_sha256());
    assert_eq!(constants_sha256(), "1c9f91ec8bbe9786331d81a1e2398351285d2ecf2f6b90c461c9bd27d78f16f4");
}

#[test]
fn sines_one_threshold_apart_are_told_apart_at_threshold() {
    for (frequency_hz, weber) in [(10.0, 0.58), (125.0, 0.20), (250.0, 0.20)] {
        let peak = 10.0 * 2f64.sqrt() * touch_threshold_m(frequency_hz);
        let look = |peak| felt(&sine(frequency_hz, peak, 1.0), RATE_HZ, Unit::Displacement, None);
        let (less, more) = (look(peak), look(peak * (1.0 + weber)));
        let d_prime = less.d_prime(&more);
        println!("{frequency_hz} Hz: d' {d_prime:.3}");
        assert!((d_prime - 1.16).abs() < 0.03, "{frequency_hz} Hz: {d_prime}");
        // One interval, two answers: Φ(d′/2) less the lapses; two intervals make it 0.794.
        let judge = Judge::new(vec![vec![less.clone()], vec![more.clone()]], 1.0);
        let right = Confusion::of(&judge, &[vec![less], vec![more]], 20_000, 3).mean();
        assert!((right - (0.98 * 0.719 + 0.01)).abs() < 0.01, "{right}");
    }
}

#[test]
fn acceleration_and_displacement_of_one_vibration_are_one_percept() {
    let omega = 2.0 * PI * 100.0;
    let as_metres = felt(&sine(100.0, 1e-5, 2.0), RATE_HZ, Unit::Displacement, None);
    let as_acceleration = felt(&sine(100.0, -1e-5 * omega * omega, 2.0), RATE_HZ, Unit::Acceleration, None);
    assert!(as_metres.d_prime(&as_acceleration) < 0.01);
}

#[test]
fn what_is_below_threshold_is_nothing() {
    let nothing = felt(&noise(1, 1.0, 1e-9), RATE_HZ, Unit::Displacement, None);
    assert!(nothing.features.iter().all(|feature| feature.value == 0.0));
    let silence = sound::heard(&noise(2, 1.0, 1e-8), RATE_HZ, None, None);
    assert!(silence.features.iter().filter(|f| f.value.is_finite()).all(|feature| feature.value == 0.0));
}

#[test]
fn equal_noises_are_told_apart_by_chance() {
    let take = |seed| felt(&noise(seed, 1.0, 1e-5), RATE_HZ, Unit::Displacement, None);
    let class = |from: u64, count| -> Vec<Percept> { (from..from + count).map(take).collect() };
    for kappa in [0.0, 1.0] {
        // Each pair of classes has its own templates: what one lot of templates prefers is no
        // property of the observer.
        let pairs = 40;
        let right = |pair: u64| {
            let judge = Judge::new(vec![class(1000 * pair, 8), class(1000 * pair + 100, 8)], kappa);
            Confusion::of(&judge, &[class(1000 * pair + 200, 2), class(1000 * pair + 300, 2)], 10, pair)
                .mean()
        };
        let mean = (0..pairs).map(right).sum::<f64>() / pairs as f64;
        println!("κ = {kappa}: {mean:.3}");
        assert!((mean - 0.5).abs() < 2.0 * (0.25f64 / (4 * pairs) as f64).sqrt(), "κ = {kappa}: {mean}");
    }
}

#[test]
fn a_level_step_is_missed_more_often_the_noisier_the_observer() {
    let take = |seed, sd| felt(&noise(seed, 1.0, sd), RATE_HZ, Unit::Displacement, None);
    let class = |from: u64, sd| -> Vec<Percept> { (from..from + 12).map(|seed| take(seed, sd)).collect() };
    let right = |kappa| {
        let judge = Judge::new(vec![class(10, 1e-6), class(50, 1.06e-6)], kappa);
        Confusion::of(&judge, &[class(80, 1e-6), class(120, 1.06e-6)], 60, 7).mean()
    };
    let (half, one, two) = (right(0.5), right(1.0), right(2.0));
    println!("κ = ½: {half:.3}, 1: {one:.3}, 2: {two:.3}");
    assert!(half > one && one > two && two > 0.5, "{half} {one} {two}");
}

#[test]
fn mirrored_halves_differ_only_with_the_hands_place() {
    let samples = (2.0 * RATE_HZ) as usize;
    let place: Vec<[f64; 2]> = (0..samples).map(|n| [n as f64 / samples as f64, 0.5]).collect();
    let axis = vec![0; samples];
    let hand = Hand { place: &place, axis: &axis };
    let take = |seed, loud_first: bool, hand: Option<Hand<'_>>| {
        let mut x = noise(seed, 2.0, 1e-6);
        let half = samples / 2;
        let quiet = if loud_first { &mut x[half..] } else { &mut x[..half] };
        quiet.iter_mut().for_each(|x| *x *= 0.3);
        felt(&x, RATE_HZ, Unit::Displacement, hand)
    };
    let right = |hand: Option<Hand<'_>>| {
        let class =
            |from: u64, first| -> Vec<Percept> { (from..from + 8).map(|s| take(s, first, hand)).collect() };
        let judge = Judge::new(vec![class(10, true), class(30, false)], 1.0);
        Confusion::of(&judge, &[class(50, true), class(70, false)], 40, 9).mean()
    };
    let (with, without) = (right(Some(hand)), right(None));
    println!("with the place {with:.3}, without {without:.3}");
    assert!(with > 0.95 && (without - 0.5).abs() < 0.25);
}

#[test]
fn a_decay_is_heard_as_it_was_made() {
    let ring = |decay_per_s: f64| -> Vec<f64> {
        (0..(0.8 * RATE_HZ) as usize)
            .map(|n| {
                let t = n as f64 / RATE_HZ;
                0.1 * (-decay_per_s * t).exp() * (2.0 * PI * 700.0 * t).sin()
            })
            .collect()
    };
    let decay = |d| sound::heard(&ring(d), RATE_HZ, Some(1), None).features.last().map(|f| f.value.exp());
    for d in [8.0, 20.0] {
        let found = decay(d).unwrap_or(f64::NAN);
        assert!((found / d - 1.0).abs() < 0.1, "{found} for {d}");
    }
}
