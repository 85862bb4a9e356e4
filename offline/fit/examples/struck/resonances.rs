//! Resonances that came out as more than one mode.
//!
//! The strongest mode takes the modes within three half widths of the narrower of the two and
//! within 20 dB of it; the strongest of those left takes its own, and so on. A resonance of several
//! modes is *split* where fewer would do: where for some two of them one damped sinusoid, fitted to
//! what the recording has beside all other modes, leaves less than 18 dB under the resonance's
//! energy more than the two. Otherwise it beats, and its modes are real.

use asperity_dsp::mode::Mode;
use asperity_fft::num_complex::Complex;
use std::f64::consts::PI;

/// Strong modes lie within this of the strongest; what splits one lies within so many half widths,
/// at most so far below.
const STRONG_DB: f64 = 25.0;
const HALF_WIDTHS: f64 = 3.0;
const SPLIT_DB: f64 = 20.0;
/// What one mode in place of two may lose of the resonance's energy, dB.
const LOST_DB: f64 = 18.0;
/// A mode is followed for so many nepers.
const FOLLOWED_NEPERS: f64 = 8.0;
/// Halvings of the search for the best pole.
const HALVINGS: usize = 14;

/// Strong resonances.
#[derive(Clone, Copy, Default)]
pub struct Resonances {
    /// Those of several modes of which fewer would do.
    pub split: usize,
    /// Those of several modes that all are needed.
    pub beating: usize,
    /// All.
    pub all: usize,
}

/// Of `modes` in `sound`, of which the modes leave `left`.
pub fn resonances(modes: &[Mode], sound: &[f64], left: &[f64], rate: f64) -> Resonances {
    let seconds = sound.len() as f64 / rate;
    let energy = |m: &Mode| {
        let d = m.decay_per_s.max(1e-9);
        m.amplitude.powi(2) * (1.0 - (-2.0 * d * seconds).exp()) / d
    };
    let below = |db: f64| 10.0_f64.powf(-0.1 * db);
    let mut ranked: Vec<Mode> = modes.to_vec();
    ranked.sort_by(|a, b| energy(b).total_cmp(&energy(a)));
    let most = ranked.first().map_or(0.0, energy);
    let mut counted = Resonances::default();
    while let Some(&head) = ranked.first().filter(|m| energy(m) > most * below(STRONG_DB)) {
        let own = |m: &Mode| {
            let width = m.decay_per_s.min(head.decay_per_s) / (2.0 * PI);
            let near = (m.frequency_hz - head.frequency_hz).abs() < HALF_WIDTHS * width;
            *m == head || (near && energy(m) > energy(&head) * below(SPLIT_DB))
        };
        let (members, others): (Vec<Mode>, Vec<Mode>) = ranked.into_iter().partition(own);
        ranked = others;
        counted.all += 1;
        if members.len() > 1 {
            if least_loss(&members, left, rate) < below(LOST_DB) {
                counted.split += 1;
            } else {
                counted.beating += 1;
            }
        }
    }
    counted
}

/// What the two that are likest one mode lose as one, of the energy of all `members`.
fn least_loss(members: &[Mode], left: &[f64], rate: f64) -> f64 {
    let slowest = members.iter().map(|m| m.decay_per_s).fold(f64::INFINITY, f64::min);
    let count = ((FOLLOWED_NEPERS / slowest * rate) as usize).min(left.len());
    let carrier = members.iter().map(|m| m.frequency_hz).sum::<f64>() / members.len() as f64;
    let reach = members.iter().map(|m| (m.frequency_hz - carrier).abs() + m.decay_per_s).fold(1.0, f64::max);
    let step = ((rate / (16.0 * reach)) as usize).max(1);
    let down = |x: &dyn Fn(usize) -> Complex<f64>| base_band(x, carrier, rate, step, count);
    let residual = down(&|n| Complex::new(2.0 * left[n], 0.0));
    let waves: Vec<Vec<Complex<f64>>> =
        members.iter().map(|m| down(&|n| analytic(m, n as f64 / rate))).collect();
    let sum = |of: &[usize]| -> Vec<Complex<f64>> {
        (0..residual.len()).map(|i| of.iter().map(|&k| waves[k][i]).sum()).collect()
    };
    let everything: Vec<usize> = (0..members.len()).collect();
    let whole = energy(&sum(&everything));
    let mut least = f64::INFINITY;
    for a in 0..members.len() {
        for b in a + 1..members.len() {
            let target: Vec<_> = sum(&[a, b]).iter().zip(&residual).map(|(s, r)| s + r).collect();
            let starts = [a, b].map(|k| pole(&members[k], carrier, rate / step as f64));
            let one = energy(&target) - most_explained(&target, starts);
            least = least.min((one - energy(&residual)) / whole.max(1e-300));
        }
    }
    least
}

fn analytic(mode: &Mode, t: f64) -> Complex<f64> {
    let angle = 2.0 * PI * mode.frequency_hz * t + mode.phase_rad - 0.5 * PI;
    Complex::from_polar(mode.amplitude * (-mode.decay_per_s * t).exp(), angle)
}

/// `x` about `carrier`, in means of `step` samples.
fn base_band(
    x: &dyn Fn(usize) -> Complex<f64>,
    carrier: f64,
    rate: f64,
    step: usize,
    count: usize,
) -> Vec<Complex<f64>> {
    let turned = |n: usize| x(n) * Complex::from_polar(1.0, -2.0 * PI * carrier / rate * n as f64);
    let mean = |from: usize| (from..from + step).map(turned).sum::<Complex<f64>>() / step as f64;
    (0..count / step).map(|i| mean(i * step)).collect()
}

/// (Decay, angle) of a mode about `carrier`, a sample of the base band.
fn pole(mode: &Mode, carrier: f64, rate: f64) -> (f64, f64) {
    (mode.decay_per_s / rate, 2.0 * PI * (mode.frequency_hz - carrier) / rate)
}

fn energy(x: &[Complex<f64>]) -> f64 {
    x.iter().map(Complex::norm_sqr).sum()
}

/// The most that one damped exponential explains of `x`.
fn most_explained(x: &[Complex<f64>], starts: [(f64, f64); 2]) -> f64 {
    let explained = |(decay, angle): (f64, f64)| {
        let z = Complex::from_polar((-decay).exp(), -angle);
        let (mut power, mut sum, mut length) = (Complex::new(1.0, 0.0), Complex::new(0.0, 0.0), 0.0);
        for value in x {
            sum += value * power;
            length += power.norm_sqr();
            power *= z;
        }
        sum.norm_sqr() / length
    };
    let search = |start: (f64, f64)| {
        let mut best = (explained(start), start);
        let mut step = 2.0 * start.0.max(1.0 / x.len() as f64);
        for _ in 0..HALVINGS {
            for _ in 0..8 {
                let (decay, angle) = best.1;
                let tried = [
                    (decay + step, angle),
                    ((decay - step).max(0.0), angle),
                    (decay, angle + step),
                    (decay, angle - step),
                ];
                let next = tried
                    .into_iter()
                    .map(|pole| (explained(pole), pole))
                    .fold(best, |best, next| if next.0 > best.0 { next } else { best });
                if next.0 <= best.0 {
                    break;
                }
                best = next;
            }
            step *= 0.5;
        }
        best.0
    };
    starts.into_iter().map(search).fold(0.0, f64::max)
}
