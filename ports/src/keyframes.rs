//! Keyframes: a waveform as few points joined by half waves.
//!
//! ```text
//! y(t) = y₀ + (y₁ − y₀) (3h − 2τ) τ² / h³      τ = t − t₀,  h = t₁ − t₀
//! ```
//! The curve is flat in every keyframe, as a waveform is at its extremes; so keyframes begin there, and more are put where the error is
//! greatest until the wanted ratio is reached or no more are allowed.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Which samples stand for the rest: their indices, from the first to the last.
#[must_use]
pub fn keyframes(samples: &[f64], most: usize, wanted_snr_db: f64) -> Vec<usize> {
    let Some(last) = samples.len().checked_sub(1).filter(|last| *last > 0) else {
        return (0..samples.len()).collect();
    };
    let most = most.clamp(2, samples.len());
    let mut kept = extremes(samples);
    if kept.len() > most {
        kept = strongest(samples, &kept, most);
    }
    let energy: f64 = samples.iter().map(|x| x * x).sum();
    let allowed = energy * 10f64.powf(-0.1 * wanted_snr_db);
    let mut heap: BinaryHeap<Span> =
        kept.windows(2).map(|pair| Span::new(samples, pair[0], pair[1])).collect();
    let mut error: f64 = heap.iter().map(|span| span.error).sum();
    while kept.len() < most && error > allowed {
        let Some(span) = heap.pop() else { break };
        if span.error <= 0.0 {
            break;
        }
        let parts = [Span::new(samples, span.from, span.worst), Span::new(samples, span.worst, span.to)];
        error += parts[0].error + parts[1].error - span.error;
        kept.push(span.worst);
        heap.extend(parts);
    }
    kept.sort_unstable();
    debug_assert!(kept.first() == Some(&0) && kept.last() == Some(&last));
    kept
}

/// Samples between keyframes, sample by sample.
#[must_use]
pub fn joined(keyframes: &[(usize, f64)]) -> Vec<f64> {
    let mut out = Vec::new();
    for pair in keyframes.windows(2) {
        let ((from, a), (to, b)) = (pair[0], pair[1]);
        out.extend((from..to).map(|n| between(n, (from, a), (to, b))));
    }
    out.extend(keyframes.last().map(|(_, value)| *value));
    out
}

fn between(n: usize, (from, a): (usize, f64), (to, b): (usize, f64)) -> f64 {
    let x = (n - from) as f64 / (to - from) as f64;
    a + (b - a) * (3.0 - 2.0 * x) * x * x
}

/// First, last, and every sample where the slope turns.
fn extremes(samples: &[f64]) -> Vec<usize> {
    let mut kept = vec![0];
    let mut rising = 0.0;
    for n in 1..samples.len() {
        let slope = samples[n] - samples[n - 1];
        if slope * rising < 0.0 && n - 1 > 0 {
            kept.push(n - 1);
        }
        if slope != 0.0 {
            rising = slope;
        }
    }
    kept.push(samples.len() - 1);
    kept
}

/// The ends, and of the extremes those that stand out most from their neighbours.
fn strongest(samples: &[f64], kept: &[usize], most: usize) -> Vec<usize> {
    let mut inner: Vec<(f64, usize)> = kept
        .windows(3)
        .map(|w| {
            let [a, b, c] = [samples[w[0]], samples[w[1]], samples[w[2]]];
            ((b - a).abs().min((b - c).abs()), w[1])
        })
        .collect();
    inner.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut few: Vec<usize> = inner.iter().take(most - 2).map(|(_, n)| *n).collect();
    few.extend([kept[0], kept[kept.len() - 1]]);
    few.sort_unstable();
    few
}

/// A stretch between two keyframes.
struct Span {
    from: usize,
    to: usize,
    error: f64,
    worst: usize,
}

impl Span {
    fn new(samples: &[f64], from: usize, to: usize) -> Self {
        let (mut error, mut worst, mut most) = (0.0, from, 0.0);
        for n in from + 1..to {
            let square = (samples[n] - between(n, (from, samples[from]), (to, samples[to]))).powi(2);
            error += square;
            if square > most {
                (most, worst) = (square, n);
            }
        }
        Self { from, to, error: if most > 0.0 { error } else { 0.0 }, worst }
    }
}

impl PartialEq for Span {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Span {}
impl PartialOrd for Span {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Span {
    fn cmp(&self, other: &Self) -> Ordering {
        // Equal errors in the order of time, so that the same samples always give the same file.
        self.error.total_cmp(&other.error).then(other.from.cmp(&self.from))
    }
}
