//! Statistics of answers that people give: shares, means, sensitivity, thresholds, each with a 95 %
//! interval.
//!
//! | figure | estimate | interval |
//! |---|---|---|
//! | share | right / asked | Wilson 1927 |
//! | mean over participants | mean | bootstrap, percentiles widened for few participants (Hesterberg 2015) |
//! | d′ | of m alternatives: p = ∫ φ(x − d′) Φ(x)^(m−1) dx; of ABX: p = Φ(d′/√2) Φ(d′/2) + Φ(−d′/√2) Φ(−d′/2) (Macmillan and Creelman 2005) | – |
//! | threshold | greatest likelihood · s^−½ of γ + (1 − γ − λ) Φ(s (x − μ)) over μ and s; λ = 0.02 | profile likelihood |
//!
//! Answers at levels that a staircase has chosen make the likeliest slope too steep (Kaernbach
//! 2001) and intervals of the threshold too narrow: without s^−½ they hold it in 0.90 of lots.

use asperity_dsp::rng::Rng;

/// Normal quantile of 97.5 %.
const Z: f64 = 1.959_963_985;
/// Share of answers that have nothing to do with the stimulus, in a psychometric function.
const LAPSE: f64 = 0.02;
/// Factor on the half-width of intervals of thresholds: staircases that end by their reversals
/// cover 93 to 94 % without it.
const SEQUENTIAL: f64 = 1.05;
/// Samples of a bootstrap.
const RESAMPLES: usize = 2000;
/// Places of μ and of s that are looked at.
const GRID: (usize, usize) = (241, 33);

/// A figure and where it lies with a probability of 95 %.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Figure.
    pub value: f64,
    /// Ends; infinite where the answers do not bound it.
    pub ci95: [f64; 2],
}

/// Standard normal distribution function.
#[must_use]
pub fn normal_cdf(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}

/// Quantile of Student's t for 97.5 % (Cornish and Fisher; exact for one and two degrees).
#[must_use]
pub fn t_975(degrees: usize) -> f64 {
    match degrees {
        0 => f64::INFINITY,
        1 => 12.706,
        2 => 4.303,
        _ => {
            let n = degrees as f64;
            let a = (Z.powi(3) + Z) / 4.0;
            let b = (5.0 * Z.powi(5) + 16.0 * Z.powi(3) + 3.0 * Z) / 96.0;
            let c = (3.0 * Z.powi(7) + 19.0 * Z.powi(5) + 17.0 * Z.powi(3) - 15.0 * Z) / 384.0;
            Z + a / n + b / (n * n) + c / (n * n * n)
        }
    }
}

/// Share of right answers with Wilson's interval.
#[must_use]
pub fn share(right: usize, asked: usize) -> Estimate {
    let n = asked.max(1) as f64;
    let p = right as f64 / n;
    let middle = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let half = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    Estimate { value: p, ci95: [(middle - half).max(0.0), (middle + half).min(1.0)] }
}

/// Mean over participants with a bootstrap interval; unbounded for a single one.
#[must_use]
pub fn mean(values: &[f64], seed: u64) -> Estimate {
    let n = values.len();
    let value = values.iter().sum::<f64>() / n.max(1) as f64;
    if n < 2 {
        return Estimate { value, ci95: [f64::NEG_INFINITY, f64::INFINITY] };
    }
    let mut rng = Rng::new(seed);
    let mut drawn = || values[((rng.uniform() * n as f64) as usize).min(n - 1)];
    let mut means: Vec<f64> =
        (0..RESAMPLES).map(|_| (0..n).map(|_| drawn()).sum::<f64>() / n as f64).collect();
    means.sort_by(f64::total_cmp);
    let tail = normal_cdf(-(n as f64 / (n - 1) as f64).sqrt() * t_975(n - 1));
    let at = |share: f64| means[(share * (RESAMPLES - 1) as f64).round() as usize];
    Estimate { value, ci95: [at(tail), at(1.0 - tail)] }
}

/// d′ of so many right answers among `alternatives`; all or none right count as half an answer
/// less or more.
#[must_use]
pub fn d_prime(right: usize, asked: usize, alternatives: usize) -> f64 {
    sensitivity(right, asked, 1.0 / alternatives.max(2) as f64, |d| {
        let step = 0.02;
        let at = |i: i32| -8.0 + step * f64::from(i);
        let density = |x: f64| (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
        (0..1000)
            .map(|i| step * density(at(i) - d) * normal_cdf(at(i)).powi(alternatives.max(2) as i32 - 1))
            .sum()
    })
}

/// d′ of ABX by an observer who compares both intervals with the third.
#[must_use]
pub fn d_prime_abx(right: usize, asked: usize) -> f64 {
    sensitivity(right, asked, 0.5, |d| {
        let (a, b) = (d * std::f64::consts::FRAC_1_SQRT_2, 0.5 * d);
        normal_cdf(a) * normal_cdf(b) + normal_cdf(-a) * normal_cdf(-b)
    })
}

/// d′ at which `expected` gives the share that was found; 0 at chance and below.
fn sensitivity(right: usize, asked: usize, chance: f64, expected: impl Fn(f64) -> f64) -> f64 {
    let n = asked.max(1) as f64;
    let share = (right as f64 / n).clamp(0.5 / n, 1.0 - 0.5 / n);
    if share <= chance {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, 7.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        *(if expected(middle) < share { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

/// Level at which `at` of the answers are right, by the greatest likelihood of answers at levels
/// above 0 (their logarithms) or at any levels; `chance` is the share of right guesses. None where
/// all answers are alike or there is one level only.
#[must_use]
pub fn threshold(answers: &[(f64, bool)], chance: f64, at: f64) -> Option<Estimate> {
    let is_log = answers.iter().all(|(level, _)| *level > 0.0);
    let scale = |level: f64| if is_log { level.ln() } else { level };
    let mut counts: Vec<(f64, f64, f64)> = Vec::new();
    for (level, right) in answers {
        let x = scale(*level);
        let (yes, no) = (f64::from(u8::from(*right)), f64::from(u8::from(!*right)));
        match counts.iter_mut().find(|(of, _, _)| (*of - x).abs() < 1e-12) {
            Some((_, y, n)) => (*y, *n) = (*y + yes, *n + no),
            None => counts.push((x, yes, no)),
        }
    }
    let mut levels: Vec<f64> = counts.iter().map(|(x, _, _)| *x).collect();
    levels.sort_by(f64::total_cmp);
    let (low, high) = (*levels.first()?, *levels.last()?);
    let wrong: f64 = counts.iter().map(|(_, _, no)| no).sum();
    if high <= low || wrong == 0.0 || wrong == answers.len() as f64 {
        return None;
    }
    let fitted = profile(&counts, [low, high], chance, at)?;
    let back = |x: f64| if is_log { x.exp() } else { x };
    Some(Estimate { value: back(fitted.value), ci95: fitted.ci95.map(back) })
}

/// Threshold and its profile interval on the scale of the fit.
fn profile(counts: &[(f64, f64, f64)], [low, high]: [f64; 2], chance: f64, at: f64) -> Option<Estimate> {
    let range = high - low;
    let (places, slopes) = GRID;
    // Φ⁻¹ of the share of the function without guesses and lapses.
    let wanted = ((at - chance) / (1.0 - chance - LAPSE)).clamp(0.01, 0.99);
    let (mut from, mut to) = (-4.0, 4.0);
    for _ in 0..50 {
        let middle = 0.5 * (from + to);
        *(if normal_cdf(middle) < wanted { &mut from } else { &mut to }) = middle;
    }
    let place = |i: usize| low - 0.75 * range + 2.5 * range * i as f64 / (places - 1) as f64;
    let slope = |j: usize| 100.0_f64.powf(j as f64 / (slopes - 1) as f64) / range;
    let likelihood = |threshold: f64, slope: f64| -> f64 {
        let each = |(x, yes, no): &(f64, f64, f64)| {
            let p = chance + (1.0 - chance - LAPSE) * normal_cdf(slope * (x - threshold) + from);
            yes * p.ln() + no * (1.0 - p).ln()
        };
        counts.iter().map(each).sum::<f64>() - 0.5 * slope.ln()
    };
    let profiled: Vec<f64> = (0..places)
        .map(|i| (0..slopes).map(|j| likelihood(place(i), slope(j))).fold(f64::NEG_INFINITY, f64::max))
        .collect();
    let best = (0..places).max_by(|a, b| profiled[*a].total_cmp(&profiled[*b]))?;
    let asked: f64 = counts.iter().map(|(_, yes, no)| yes + no).sum();
    let width = SEQUENTIAL * t_975((asked as usize).saturating_sub(2));
    let floor = profiled[best] - 0.5 * width * width;
    // Ends between places, by a straight line.
    let crossing = |inner: usize, outer: usize| {
        let part = (profiled[inner] - floor) / (profiled[inner] - profiled[outer]);
        place(inner) + part * (place(outer) - place(inner))
    };
    let below = (0..best).rev().find(|i| profiled[*i] < floor);
    let above = (best + 1..places).find(|i| profiled[*i] < floor);
    let ends = [
        below.map_or(f64::NEG_INFINITY, |i| crossing(i + 1, i)),
        above.map_or(f64::INFINITY, |i| crossing(i - 1, i)),
    ];
    Some(Estimate { value: vertex(best, &profiled, place), ci95: ends })
}

/// Top of the parabola through a maximum and its neighbours.
fn vertex(best: usize, profiled: &[f64], place: impl Fn(usize) -> f64) -> f64 {
    let Some([a, b, c]) = best.checked_sub(1).and_then(|i| profiled.get(i..i + 3)?.first_chunk::<3>()) else {
        return place(best);
    };
    let shift = 0.5 * (a - c) / (a - 2.0 * b + c).min(-1e-12);
    place(best) + shift.clamp(-0.5, 0.5) * (place(best) - place(best - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of 2,000 that cover, with what is asked of it.
    fn covers(name: &str, covered: usize) {
        let coverage = covered as f64 / 2000.0;
        println!("{name}: {coverage:.4}");
        assert!((0.93..=0.97).contains(&coverage), "{name}: {coverage}");
    }

    #[test]
    fn closed_forms_hold() {
        // Wilson 1927 for 8 of 10; R's binom::binom.wilson(8, 10).
        let wilson = share(8, 10);
        assert!((wilson.ci95[0] - 0.4901625).abs() < 1e-6 && (wilson.ci95[1] - 0.9433178).abs() < 1e-6);
        assert!((t_975(7) - 2.3646).abs() < 2e-3 && (t_975(30) - 2.0423).abs() < 1e-4);
        // 2AFC: d′ = √2 z(p); Φ(0.6745) = 0.75.
        assert!((d_prime(7500, 10_000, 2) - 2f64.sqrt() * 0.67449).abs() < 1e-3);
        // Of six, d′ = 1.5 is right in 0.62 (the integral by another program).
        assert!((d_prime(62, 100, 6) - 1.5).abs() < 0.05, "{}", d_prime(62, 100, 6));
        assert_eq!(d_prime_abx(40, 100), 0.0);
        assert!(d_prime_abx(10, 10).is_finite());
    }

    #[test]
    fn nineteen_of_twenty_intervals_of_shares_and_means_hold_the_truth() {
        let mut rng = Rng::new(1);
        let mut wilson = 0;
        let mut bootstrap = 0;
        for seed in 0..2000 {
            let right = (0..54).filter(|_| rng.uniform() < 0.85).count();
            let [low, high] = share(right, 54).ci95;
            wilson += usize::from(low <= 0.85 && 0.85 <= high);
            let values: Vec<f64> = (0..12).map(|_| 60.0 + 15.0 * rng.normal()).collect();
            let [low, high] = mean(&values, seed).ci95;
            bootstrap += usize::from(low <= 60.0 && 60.0 <= high);
        }
        covers("shares", wilson);
        covers("means", bootstrap);
    }

    /// Answers to the staircase of a study's page: three down, one up over levels a step apart, two
    /// steps at once until the second reversal, from the top; it ends by its reversals. The truth
    /// is a logistic function.
    fn staircase(rng: &mut Rng, decades: f64, slope: f64, truth: f64) -> Vec<(f64, bool)> {
        let top = (1.0 / decades).round() as i32;
        let (mut index, mut streak, mut reversals, mut way) = (top, 0, 0, 0);
        let mut answers = Vec::new();
        while reversals < 12 {
            let level = 10f64.powf(decades * f64::from(index));
            let right = rng.uniform() < 0.5 + 0.49 / (1.0 + (-slope * (level / truth).ln()).exp());
            answers.push((level, right));
            streak = if right { streak + 1 } else { 0 };
            let turn = if right { -i32::from(streak == 3) } else { 1 };
            if turn != 0 {
                streak = 0;
                reversals += i32::from(way != 0 && way != turn);
                way = turn;
                index = (index + turn * if reversals < 2 { 2 } else { 1 }).clamp(0, top);
            }
        }
        answers
    }

    #[test]
    fn nineteen_of_twenty_intervals_of_staircases_hold_the_planted_threshold() {
        let mut rng = Rng::new(3);
        for (decades, slope) in [(0.05, 6.0), (0.1, 3.0)] {
            let (mut covered, mut logs) = (0, 0.0);
            for _ in 0..2000 {
                let truth = 2.0 * 2f64.powf(rng.uniform());
                let answers = staircase(&mut rng, decades, slope, truth);
                let found = threshold(&answers, 0.5, 0.75).unwrap();
                covered += usize::from(found.ci95[0] <= truth && truth <= found.ci95[1]);
                logs += (found.value / truth).ln() / 2000.0;
            }
            println!("mean error {:.1} %", 100.0 * (logs.exp() - 1.0));
            assert!(logs.abs() < 0.1, "{logs}");
            covers("thresholds", covered);
        }
    }

    #[test]
    fn answers_that_bound_no_threshold_give_none() {
        assert_eq!(threshold(&[(1.0, true), (2.0, true)], 0.5, 0.75), None);
        assert_eq!(threshold(&[(1.0, true), (1.0, false)], 0.5, 0.75), None);
    }
}
