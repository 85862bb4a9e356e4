//! Thinning: a clip without the points that nobody would miss.

use crate::clip::Clip;

/// Both envelopes without the points that lie within a tolerance of the line between their
/// neighbours.
pub(crate) fn thinned(clip: &Clip, tolerance: f64) -> Clip {
    let peak = clip.amplitude.iter().map(|p| p.amplitude).fold(0.0, f64::max);
    let levels: Vec<(f64, f64)> = clip.amplitude.iter().map(|p| (p.time_s, p.amplitude)).collect();
    let mut keep = kept(&levels, tolerance * peak);
    keep.iter_mut().zip(&clip.amplitude).for_each(|(keep, p)| *keep |= p.emphasis.is_some());
    let tones: Vec<(f64, f64)> = clip.frequency.iter().map(|p| (p.time_s, p.frequency)).collect();
    let keep_tones = kept(&tones, tolerance);
    let mut some = keep.iter();
    let mut some_tones = keep_tones.iter();
    let mut thin = clip.clone();
    thin.amplitude.retain(|_| some.next().copied().unwrap_or(true));
    thin.frequency.retain(|_| some_tones.next().copied().unwrap_or(true));
    thin
}

/// Which points the line needs (Ramer, Douglas, Peucker, distances along the values).
fn kept(points: &[(f64, f64)], tolerance: f64) -> Vec<bool> {
    let mut keep = vec![false; points.len()];
    let Some(last) = points.len().checked_sub(1) else { return keep };
    (keep[0], keep[last]) = (true, true);
    let mut spans = vec![(0, last)];
    while let Some((from, to)) = spans.pop() {
        let (a, b) = (points[from], points[to]);
        let slope = if b.0 > a.0 { (b.1 - a.1) / (b.0 - a.0) } else { 0.0 };
        let off = |i: usize| (points[i].1 - a.1 - slope * (points[i].0 - a.0)).abs();
        let worst = (from + 1..to).fold(from, |worst, i| if off(i) > off(worst) { i } else { worst });
        if worst > from && off(worst) > tolerance {
            keep[worst] = true;
            spans.extend([(from, worst), (worst, to)]);
        }
    }
    keep
}
