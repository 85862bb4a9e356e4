//! Finding clicks.
#![allow(dead_code)]

/// Height of the largest sudden step in `x`, in the units of `x`.
///
/// The fourth difference of a step of height s peaks at 3 s, while a sine at frequency f only
/// reaches (2π f / rate)⁴ of its amplitude: −74 dB at 800 Hz and 44.1 kHz. What is smooth does not
/// count.
pub fn largest_step(x: &[f32]) -> f64 {
    let difference = |w: &[f32]| {
        let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|i| f64::from(w[i]));
        (a - 4.0 * b + 6.0 * c - 4.0 * d + e).abs() / 3.0
    };
    x.windows(5).map(difference).fold(0.0, f64::max)
}

#[test]
fn a_step_is_measured_and_a_smooth_tone_is_not() {
    let tone: Vec<f32> = (0..4000).map(|i| (i as f32 * 0.06).sin()).collect();
    let clicked: Vec<f32> =
        tone.iter().enumerate().map(|(i, x)| x + if i > 2000 { 0.01 } else { 0.0 }).collect();
    assert!(largest_step(&tone) < 1e-4);
    assert!((largest_step(&clicked) - 0.01).abs() < 1e-4);
}
