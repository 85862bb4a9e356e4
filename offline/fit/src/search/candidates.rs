//! Mode candidates: poles of the bands of one level whose gates open.
//!
//! Bands and the poles in them are independent of each other and shared among the threads allowed.

use crate::noise::noise_floor::NoiseFloor;
use crate::search::esprit::{band_order, energies, poles};
use crate::search::limits::Limits;
use crate::search::model_order::{Gate, KEPT_HALF_WIDTH};
use crate::search::sub_band::{Bands, Level, split};
use crate::sinusoid::partial::Partial;
use nalgebra::Complex;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Nepers by which a mode may have decayed within a level's span and still be that level's
/// business.
pub(crate) const SPAN_NEPERS: f64 = 3.0;
/// Singular values this far below a band's largest are no modes of their own where a recording is
/// no sum of modes: a real decay is an exponential to some 40 dB, and what lies far below the
/// band's strongest mends it.
const MISMATCH: f64 = 3e-3;
/// Most candidates of one round there: the cost of a joint fit grows with their cube.
const MOST_AT_ONCE: usize = 100;
/// Poles taken of a band there, the strongest: of long bands, and of those decimated by less than
/// `SHORT`.
const A_BAND: usize = 4;
const A_SHORT_BAND: usize = 8;
const SHORT: usize = 32;

/// A partial without amplitude, and its energy in its band.
type Ranked = (Partial, f64);

/// Tools of a search.
pub(crate) struct Search<'a> {
    limits: &'a Limits,
    noise: &'a NoiseFloor,
    /// The recording is no sum of modes: the strongest poles of each band only.
    strongest_only: bool,
}

impl<'a> Search<'a> {
    /// For everything that noise does not explain.
    pub(crate) fn thorough(limits: &'a Limits, noise: &'a NoiseFloor) -> Self {
        Self { limits, noise, strongest_only: false }
    }

    /// For the strongest poles of every band, where there is no end of them.
    pub(crate) fn strongest(limits: &'a Limits, noise: &'a NoiseFloor) -> Self {
        Self { limits, noise, strongest_only: true }
    }

    /// Poles of all bands of a level, as partials without amplitudes, and whether bands were left
    /// out because what they hold may have leaked from stronger ones.
    pub(crate) fn candidates(&self, level: Level, residual: &[f64]) -> (Vec<Partial>, bool) {
        let bands = split(residual, level);
        let samples = bands.bands[0].len();
        if samples < 8 {
            return (Vec::new(), false);
        }
        let gate = Gate::new(samples, bands.bands.len());
        let real = level.decimation == 1;
        let peaks = self.on_threads(bands.bands.len(), &|k| gate.peaks(&bands.bands[k], real));
        let leak = strongest(&peaks);
        let mut open = Vec::new();
        let mut hidden = false;
        for (k, peaks) in peaks.iter().enumerate() {
            if !self.within_limits(level, k) {
                continue;
            }
            let noise_std = self.noise_std(level, &bands, k);
            if gate.opens(peaks, noise_std, &leak) {
                open.push((peaks.iter().copied().fold(0.0, f64::max), k));
            } else {
                hidden |= gate.opens(peaks, noise_std, &[0.0; 4]);
            }
        }
        // Every open band holds a mode: more bands than modes are wanted need not be looked into.
        let most = if self.strongest_only { MOST_AT_ONCE } else { self.limits.max_partials };
        if open.len() > most {
            hidden = true;
            open.sort_by(|a, b| b.0.total_cmp(&a.0));
            open.truncate(most);
            open.sort_by_key(|(_, k)| *k);
        }
        let found =
            self.on_threads(open.len(), &|i| (open[i].1, self.band_partials(level, &bands, open[i].1)));
        let mut found = without_doubles(found, level, samples);
        // Of more than may be kept, the strongest; the others get their turn when these are
        // subtracted.
        found.sort_by(|a, b| b.1.total_cmp(&a.1));
        hidden |= found.len() > most;
        found.truncate(most);
        (found.into_iter().map(|(partial, _)| partial).collect(), hidden)
    }

    /// Mean number of singular values over the noise's edge in the `count` strongest bands of a
    /// level.
    pub(crate) fn mean_order(&self, level: Level, signal: &[f64], count: usize) -> f64 {
        let bands = split(signal, level);
        let energy = |k: &usize| bands.bands[*k].iter().map(Complex::norm_sqr).sum::<f64>();
        let mut inside: Vec<(f64, usize)> = (0..bands.bands.len())
            .filter(|&k| self.within_limits(level, k))
            .map(|k| (energy(&k), k))
            .collect();
        inside.sort_by(|a, b| b.0.total_cmp(&a.0));
        inside.truncate(count);
        let orders = self.on_threads(inside.len(), &|i| {
            let k = inside[i].1;
            band_order(&bands.bands[k], self.noise_std(level, &bands, k))
        });
        orders.iter().sum::<usize>() as f64 / orders.len().max(1) as f64
    }

    /// `work(0 .. count)` in order, shared among the threads allowed.
    fn on_threads<T: Send>(&self, count: usize, work: &(dyn Fn(usize) -> T + Sync)) -> Vec<T> {
        let threads = self.limits.threads.clamp(1, count.max(1));
        if threads == 1 {
            return (0..count).map(work).collect();
        }
        let next = AtomicUsize::new(0);
        let take = || {
            let mut mine = Vec::new();
            loop {
                let i = next.fetch_add(1, Ordering::Relaxed);
                if i >= count {
                    break mine;
                }
                mine.push((i, work(i)));
            }
        };
        let mut all = std::thread::scope(|scope| {
            let others: Vec<_> = (1..threads).map(|_| scope.spawn(take)).collect();
            let mut all = take();
            for other in others {
                match other.join() {
                    Ok(results) => all.extend(results),
                    Err(panic) => std::panic::resume_unwind(panic),
                }
            }
            all
        });
        all.sort_by_key(|(i, _)| *i);
        all.into_iter().map(|(_, result)| result).collect()
    }

    fn reach(level: Level) -> f64 {
        if level.decimation == 1 { PI } else { 2.0 * PI * KEPT_HALF_WIDTH / level.decimation as f64 }
    }

    fn within_limits(&self, level: Level, k: usize) -> bool {
        let (centre, reach) = (level.centre(k), Self::reach(level));
        centre + reach >= self.limits.bounds.omega_low && centre - reach <= self.limits.bounds.omega_high
    }

    fn noise_std(&self, level: Level, bands: &Bands, k: usize) -> f64 {
        (self.noise.variance_at(level.centre(k)) * bands.noise_gain).sqrt()
    }

    fn band_partials(&self, level: Level, bands: &Bands, k: usize) -> Vec<Ranked> {
        let (centre, reach) = (level.centre(k), Self::reach(level));
        let bounds = &self.limits.bounds;
        let d = level.decimation as f64;
        let band = &bands.bands[k];
        let noise_std = self.noise_std(level, bands, k);
        let longest_delta = SPAN_NEPERS / (level.span() as f64).max(1.0);
        let least_share = if self.strongest_only { MISMATCH } else { 0.0 };
        let poles = poles(band, noise_std, least_share);
        let energies = energies(band, &poles);
        let mut found: Vec<Ranked> = poles
            .into_iter()
            .zip(energies)
            .filter_map(|(z, energy)| {
                let omega = centre + z.arg() / d;
                let delta = -z.norm().ln() / d;
                let growth = -delta * d * band.len() as f64;
                let kept = (omega - centre).abs() <= reach
                    && (bounds.omega_low..=bounds.omega_high).contains(&omega)
                    && delta <= bounds.delta_high.min(longest_delta)
                    && growth < 1.0;
                let c = Complex::new(0.0, 0.0);
                kept.then(|| (Partial { omega, delta: delta.max(bounds.delta_low), c }, energy))
            })
            .collect();
        if self.strongest_only {
            found.sort_by(|a, b| b.1.total_cmp(&a.1));
            found.truncate(if level.decimation < SHORT { A_SHORT_BAND } else { A_BAND });
        }
        found
    }
}

/// The largest peak of every window over all bands.
fn strongest(peaks: &[[f64; 4]]) -> [f64; 4] {
    peaks.iter().fold([0.0; 4], |most, peaks| std::array::from_fn(|w| most[w].max(peaks[w])))
}

/// Joins the bands' partials; a pole that two neighbouring bands saw is kept once, from the band
/// whose centre is nearer.
fn without_doubles(found: Vec<(usize, Vec<Ranked>)>, level: Level, samples: usize) -> Vec<Ranked> {
    let tolerance = 1.0 / (samples * level.decimation) as f64;
    let mut kept: Vec<(usize, Ranked)> = Vec::new();
    for (k, partials) in found {
        for ranked in partials {
            let partial = ranked.0;
            let double = kept.iter().rposition(|(other, (p, _))| {
                *other + 1 == k && (p.omega - partial.omega).abs() < tolerance + 0.2 * partial.delta
            });
            match double {
                None => kept.push((k, ranked)),
                Some(i) => {
                    let distance = |k: usize| (partial.omega - level.centre(k)).abs();
                    if distance(k) < distance(kept[i].0) {
                        kept[i] = (k, ranked);
                    }
                }
            }
        }
    }
    kept.into_iter().map(|(_, ranked)| ranked).collect()
}
