//! Keyframes: a waveform as few points joined by half waves.
//!
//! ```text
//! y(t) = y₀ + (y₁ − y₀) s(x)      s(x) = (3 − 2x) x²      x = (t − t₀)/(t₁ − t₀)
//! places: least Σ (error of each span) + λ (number of spans), by dynamic programming over a second at a time; λ by bisection
//! values: least squares between the places chosen (a tridiagonal system)
//! ```
//! The curve is flat in every keyframe, as a waveform is at its extremes, so a point put anywhere
//! else may do harm: that is why places are not simply added where the error is greatest.

/// Samples in which places are chosen together.
const BLOCK: usize = 8000;
/// Spans tried: every short one, and some longer.
const SPANS: [usize; 32] = [
    1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 20, 22, 24, 27, 30, 34, 40, 48, 64, 96,
    128, 192, 256, 512,
];

/// Places and values that stand for samples: at most `most` of them, fewer when the wanted ratio is
/// reached with fewer.
#[must_use]
pub fn keyframes(samples: &[f64], most: usize, wanted_snr_db: f64) -> Vec<(usize, f64)> {
    let Some(last) = samples.len().checked_sub(1).filter(|last| *last > 0) else {
        return samples.iter().copied().enumerate().collect();
    };
    let most = most.clamp(2, samples.len());
    let energy: f64 = samples.iter().map(|x| x * x).sum();
    let allowed = energy * 10f64.powf(-0.1 * wanted_snr_db) / samples.len() as f64;
    let mut kept = vec![0];
    for from in (0..last).step_by(BLOCK) {
        let to = (from + BLOCK).min(last);
        // Its part of the points, those not used before included.
        let budget = ((most - 1) as f64 * to as f64 / last as f64) as usize;
        let spans = budget.saturating_sub(kept.len() - 1).max(1);
        kept.extend(
            places(&samples[from..=to], spans, allowed * (to - from) as f64).into_iter().map(|n| from + n),
        );
    }
    if kept.len() > most {
        kept = strongest(samples, &kept, most);
    }
    let values = values(samples, &kept);
    kept.into_iter().zip(values).collect()
}

/// Ends of the spans of a block: no more than `most`, unless the longest spans need more.
fn places(samples: &[f64], most: usize, allowed: f64) -> Vec<usize> {
    let errors = errors(samples);
    let energy: f64 = samples.iter().map(|x| x * x).sum();
    if energy == 0.0 {
        return vec![samples.len() - 1];
    }
    let fits = |(ends, error): &(Vec<usize>, f64)| ends.len() <= most && *error <= allowed;
    // The price of a point, between nothing and everything: the dearest that still reaches what is
    // wanted, or the cheapest allowed.
    let (mut cheap, mut dear) = (1e-12 * energy, energy);
    let mut best = cheapest(samples.len(), &errors, dear);
    for _ in 0..16 {
        let price = (cheap * dear).sqrt();
        let tried = cheapest(samples.len(), &errors, price);
        if fits(&tried) || tried.0.len() > most {
            cheap = price;
        } else {
            dear = price;
        }
        let better = match (fits(&tried), fits(&best)) {
            (true, true) => tried.0.len() <= best.0.len(),
            (true, false) => true,
            (false, true) => false,
            (false, false) => tried.0.len() <= most && tried.1 <= best.1 || best.0.len() > most,
        };
        if better {
            best = tried;
        }
    }
    best.0
}

/// Squared error of every span that ends at every sample, span by span.
fn errors(samples: &[f64]) -> Vec<Vec<f32>> {
    SPANS
        .iter()
        .map(|&span| {
            let shape: Vec<f64> = (1..span).map(|n| smooth(n as f64 / span as f64)).collect();
            (0..samples.len().saturating_sub(span))
                .map(|from| {
                    let (a, b) = (samples[from], samples[from + span]);
                    let inner = &samples[from + 1..from + span];
                    inner.iter().zip(&shape).map(|(x, s)| (x - a - (b - a) * s).powi(2)).sum::<f64>() as f32
                })
                .collect()
        })
        .collect()
}

/// The chain of spans that costs least at a price a point: where they end, and their error.
fn cheapest(count: usize, errors: &[Vec<f32>], price: f64) -> (Vec<usize>, f64) {
    let mut cost = vec![f64::INFINITY; count];
    let mut step = vec![0usize; count];
    cost[0] = 0.0;
    for to in 1..count {
        for (k, span) in SPANS.iter().enumerate().take_while(|(_, span)| **span <= to) {
            let tried = cost[to - span] + price + f64::from(errors[k][to - span]);
            if tried < cost[to] {
                (cost[to], step[to]) = (tried, *span);
            }
        }
    }
    let mut ends = Vec::new();
    let mut at = count - 1;
    while at > 0 {
        ends.push(at);
        at -= step[at];
    }
    ends.reverse();
    let error = cost[count - 1] - price * ends.len() as f64;
    (ends, error)
}

/// Values at the places by least squares, none beyond ±1 unless the samples are.
fn values(samples: &[f64], kept: &[usize]) -> Vec<f64> {
    let count = kept.len();
    let (mut diagonal, mut beside, mut right) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
    for (k, pair) in kept.windows(2).enumerate() {
        let between = &samples[pair[0]..pair[1]];
        for (n, sample) in between.iter().enumerate() {
            let s = smooth(n as f64 / between.len() as f64);
            diagonal[k] += (1.0 - s) * (1.0 - s);
            beside[k] += s * (1.0 - s);
            diagonal[k + 1] += s * s;
            right[k] += (1.0 - s) * sample;
            right[k + 1] += s * sample;
        }
    }
    diagonal[count - 1] += 1.0;
    right[count - 1] += samples[kept[count - 1]];
    for k in 1..count {
        let part = beside[k - 1] / diagonal[k - 1];
        diagonal[k] -= part * beside[k - 1];
        right[k] -= part * right[k - 1];
    }
    let mut values = vec![0.0; count];
    for k in (0..count).rev() {
        let behind = if k + 1 < count { beside[k] * values[k + 1] } else { 0.0 };
        values[k] = (right[k] - behind) / diagonal[k];
    }
    let peak = samples.iter().fold(1.0_f64, |peak, x| peak.max(x.abs()));
    values.iter().map(|x| x.clamp(-peak, peak)).collect()
}

fn smooth(x: f64) -> f64 {
    (3.0 - 2.0 * x) * x * x
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
    a + (b - a) * smooth(x)
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
