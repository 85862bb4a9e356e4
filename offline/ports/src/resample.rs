//! Resampling: another rate, not a sample late.
//!
//! ```text
//! y(t) = Σ_n x(n) · c sinc(c (t − n)) · w((t − n) c / 32)      c = min(1, to/from) · 0.94
//! ```
//! with a Kaiser window w of β = 9 over 32 zero crossings on either side: what would fold back lies
//! below −85 dB, what is kept is flat to 0.01 dB up to 0.9 of the lower Nyquist frequency.

use asperity_dsp::bessel::bessel_i0;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Zero crossings on either side.
const CROSSINGS: usize = 32;
/// Steps of the table between two crossings.
const STEPS: usize = 512;
const BETA: f64 = 9.0;
/// Middle of the passband's edge.
const EDGE: f64 = 0.94;

/// `samples` at `from_hz` → at `to_hz`; sample 0 stays at time 0, and as many come out as the
/// duration holds.
#[must_use]
pub fn resampled(samples: &[f64], from_hz: f64, to_hz: f64) -> Vec<f64> {
    if from_hz == to_hz {
        return samples.to_vec();
    }
    // The same for every rate: made once, because it takes as long as two seconds of samples.
    static TABLE: OnceLock<Vec<f64>> = OnceLock::new();
    let table = TABLE.get_or_init(kernel);
    let step = from_hz / to_hz;
    let cut = EDGE * (to_hz / from_hz).min(1.0);
    let count = (samples.len() as f64 / step - 1e-9).ceil() as usize;
    if let Some(ratio) = Ratio::of(from_hz, to_hz).filter(|ratio| ratio.to <= count) {
        return ratio.resampled(samples, count, table, cut);
    }
    let reach = CROSSINGS as f64 / cut;
    (0..count)
        .map(|k| {
            let at = k as f64 * step;
            let first = (at - reach).ceil().max(0.0) as usize;
            let last = ((at + reach).floor() as usize).min(samples.len() - 1);
            let sum: f64 = (first..=last).map(|n| samples[n] * weight(table, cut, at - n as f64)).sum();
            cut * sum
        })
        .collect()
}

/// The kernel so many samples from its middle.
fn weight(table: &[f64], cut: f64, distance: f64) -> f64 {
    let place = distance.abs() * cut * STEPS as f64;
    let index = place as usize;
    let part = place - index as f64;
    table[index] + part * (table[index + 1] - table[index])
}

/// Two rates in whole numbers without a common divisor: the kernel then stands at as many places
/// between two samples as `to` says.
struct Ratio {
    from: usize,
    to: usize,
}

/// The kernel at one place between two samples.
struct Phase {
    /// Distance of the first weight, from the sample before the place.
    first: isize,
    weights: Vec<f64>,
}

impl Ratio {
    fn of(from_hz: f64, to_hz: f64) -> Option<Self> {
        let whole = |hz: f64| (hz.fract() == 0.0 && (1.0..1e9).contains(&hz)).then_some(hz as usize);
        let (from, to) = (whole(from_hz)?, whole(to_hz)?);
        let (mut a, mut b) = (from, to);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        Some(Self { from: from / a, to: to / a })
    }

    fn phase(&self, index: usize, table: &[f64], cut: f64) -> Phase {
        let reach = CROSSINGS as f64 / cut;
        let part = index as f64 / self.to as f64;
        let (first, last) = ((part - reach).ceil() as isize, (part + reach).floor() as isize);
        let weights = (first..=last).map(|n| cut * weight(table, cut, part - n as f64)).collect();
        Phase { first, weights }
    }

    fn resampled(&self, samples: &[f64], count: usize, table: &[f64], cut: f64) -> Vec<f64> {
        let phases: Vec<Phase> = (0..self.to).map(|index| self.phase(index, table, cut)).collect();
        (0..count)
            .map(|k| {
                let Phase { first, weights } = &phases[k * self.from % self.to];
                let begin = (k * self.from / self.to) as isize + first;
                // What lies before the first sample and behind the last is silence.
                let left_out = begin.min(0).unsigned_abs().min(weights.len());
                let heard = &samples[(begin.max(0) as usize).min(samples.len())..];
                let weights = &weights[left_out..];
                let length = heard.len().min(weights.len());
                product(&heard[..length], &weights[..length])
            })
            .collect()
    }
}

/// Σ a b, in as many parts as a processor adds at once; the order is the same on every one.
fn product(a: &[f64], b: &[f64]) -> f64 {
    const AT_ONCE: usize = 8;
    let mut sums = [0.0; AT_ONCE];
    let (a_parts, b_parts) = (a.chunks_exact(AT_ONCE), b.chunks_exact(AT_ONCE));
    let rest: f64 = a_parts.remainder().iter().zip(b_parts.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_parts.zip(b_parts) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}

fn kernel() -> Vec<f64> {
    (0..=CROSSINGS * STEPS + 1)
        .map(|i| {
            let x = i as f64 / STEPS as f64;
            let part = (x / CROSSINGS as f64).min(1.0);
            let sinc = if i == 0 { 1.0 } else { (PI * x).sin() / (PI * x) };
            sinc * bessel_i0(BETA * (1.0 - part * part).sqrt()) / bessel_i0(BETA)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(frequency_hz: f64, rate_hz: f64, count: usize) -> Vec<f64> {
        (0..count).map(|n| (2.0 * PI * frequency_hz * n as f64 / rate_hz).sin()).collect()
    }

    #[test]
    fn a_sine_is_the_same_sine_not_a_sample_late() {
        for (from_hz, to_hz) in
            [(44_100.0, 8000.0), (8000.0, 44_100.0), (48_000.0, 2000.0), (22_050.0, 8000.0)]
        {
            let count = from_hz as usize;
            let y = resampled(&sine(150.0, from_hz, count), from_hz, to_hz);
            assert_eq!(y.len(), to_hz as usize);
            let want = sine(150.0, to_hz, y.len());
            let edge = (0.1 * to_hz) as usize;
            let worst = (edge..y.len() - edge).map(|n| (y[n] - want[n]).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-3, "{from_hz} → {to_hz}: {worst}");
        }
    }

    #[test]
    fn whole_rates_come_out_as_the_sum_over_all_samples_says() {
        for (from_hz, to_hz, count) in
            [(44_100.0, 8000.0, 4001), (8000.0, 44_100.0, 900), (48_000.0, 8000.0, 77)]
        {
            let x = sine(150.0, from_hz, count);
            let y = resampled(&x, from_hz, to_hz);
            let (table, cut) = (kernel(), EDGE * (to_hz / from_hz).min(1.0));
            let within = |distance: f64| distance.abs() * cut <= CROSSINGS as f64;
            for (k, y) in y.iter().enumerate() {
                let at = |n: usize| k as f64 * from_hz / to_hz - n as f64;
                let terms = x.iter().enumerate().filter(|(n, _)| within(at(*n)));
                let sum: f64 = terms.map(|(n, x)| cut * x * weight(&table, cut, at(n))).sum();
                assert!((y - sum).abs() < 1e-9, "{from_hz} → {to_hz}, {k}: {y} against {sum}");
            }
        }
    }

    #[test]
    fn what_the_lower_rate_cannot_hold_does_not_fold_back() {
        let y = resampled(&sine(6000.0, 44_100.0, 44_100), 44_100.0, 8000.0);
        let worst = y[800..7200].iter().fold(0.0_f64, |worst, x| worst.max(x.abs()));
        assert!(worst < 1e-4, "{worst}");
    }
}
