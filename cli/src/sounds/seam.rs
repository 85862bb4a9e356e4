//! Seam of a loop: the end of a stretch is blended into what came before its beginning, so that it
//! can follow itself.
//!
//! ```text
//! y(n) = x(from + n)                                              n < N − F
//! y(n) = (a x(from + n − N) + (1 − a) x(from + n)) / g            n ≥ N − F,  a = (n − N + F + 1) / (F + 1)
//! g    = √(a² + (1 − a)² + 2 ρ a (1 − a))                         ρ the correlation of the two
//! ```
//! The last sample is all but x(from − 1), and x(from) follows: the step at the seam is one of the
//! signal's own. With ρ the level holds for what repeats (ρ = 1) and for noise (ρ = 0).

use asperity::offline::Render;

/// Longest blend, s, and its largest share of the loop.
const BLEND_S: f64 = 0.1;
const BLEND_SHARE: f64 = 0.25;

/// A stretch of a rendering that is to follow itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loop {
    /// Beginning, s.
    pub from_s: f64,
    /// Length, s.
    pub seconds: f64,
}

impl Loop {
    /// Cuts every channel to the loop. Returns the first sample, the one behind the last, and how
    /// many were blended.
    pub fn apply(&self, render: &mut Render) -> [usize; 3] {
        let rate_hz = render.sample_rate_hz;
        let frames = render.audio.first().map_or(0, Vec::len);
        let from = ((self.from_s * rate_hz).round() as usize).min(frames);
        let length = ((self.seconds * rate_hz).round() as usize).min(frames - from);
        let blend = (BLEND_S * rate_hz).min(BLEND_SHARE * length as f64).min(from as f64) as usize;
        for channel in render.audio.iter_mut().chain(&mut render.haptic) {
            *channel = closed(channel, from, length, blend);
        }
        [from, from + length, blend]
    }
}

fn closed(x: &[f32], from: usize, length: usize, blend: usize) -> Vec<f32> {
    let mut y = x[from..from + length].to_vec();
    let before = &x[from - blend..from];
    let end = &mut y[length - blend..];
    let correlation = correlation(before, end);
    for (index, (old, new)) in before.iter().zip(end).enumerate() {
        let a = (index + 1) as f64 / (blend + 1) as f64;
        let power = a * a + (1.0 - a) * (1.0 - a) + 2.0 * correlation * a * (1.0 - a);
        *new = ((a * f64::from(*old) + (1.0 - a) * f64::from(*new)) / power.sqrt()) as f32;
    }
    y
}

/// ρ of two stretches, 0 to 1: what is opposed counts as unrelated.
fn correlation(a: &[f32], b: &[f32]) -> f64 {
    let product =
        |a: &[f32], b: &[f32]| -> f64 { a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum() };
    let power = (product(a, a) * product(b, b)).sqrt();
    if power > 0.0 { (product(a, b) / power).clamp(0.0, 1.0) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    fn largest_step(x: &[f32]) -> f32 {
        x.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max)
    }

    #[test]
    fn a_loop_of_noise_keeps_its_level_and_follows_itself() {
        let mut rng = Rng::new(3);
        let mut smooth = 0.0;
        let mut next = || {
            smooth += 0.05 * (rng.normal() - smooth);
            smooth as f32
        };
        let x: Vec<f32> = (0..40_000).map(|_| next()).collect();
        let y = closed(&x, 10_000, 20_000, 4000);
        assert!((y[0] - y[y.len() - 1]).abs() <= largest_step(&y));
        let power = |x: &[f32]| x.iter().map(|x| f64::from(x * x)).sum::<f64>() / x.len() as f64;
        let ratio = power(&y[16_000..]) / power(&x);
        assert!((0.6..1.6).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_tone_whose_period_fits_is_left_as_it_is() {
        let x: Vec<f32> = (0..3000).map(|i| (std::f32::consts::TAU * i as f32 / 100.0).sin()).collect();
        let y = closed(&x, 1000, 1000, 250);
        assert!(y.iter().zip(&x[1000..]).all(|(y, x)| (y - x).abs() < 1e-4));
    }
}
