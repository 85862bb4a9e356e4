//! A path by the most likely band-limited motion: no later than dead reckoning, and it knows how a
//! hand speeds up and turns.
//!
//! ```text
//! p(t) = c₀ + c₁ t + Σ A √S_k (a_k cos ω_k t + b_k sin ω_k t)      a_k, b_k ~ N(0, 1); c₀, c₁ as good as free
//! S_k ∝ 1/(1 + f⁴) · 1/(1 + (f/15)¹⁶)                             f in Hz; 24 of them up to 30 Hz
//! report i: place p(tᵢ) + σ, and velocity p′(tᵢ) + σᵥ if it was reported
//! output = E[p | the last six reports] at t − lag, + r            r″ = −(1/τᵥ + 1/τ_p) r′ − r/(τᵥ τ_p)
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | A | `AMPLITUDE_M` | assumed: 0.1 m/s rms; where reports are exact the estimate does not depend on it |
//! | σ, σᵥ | `NOISE` | exact, rounded or a tracker's; whichever has predicted the last reports best counts |
//! | r | `Estimate::rest` | what the estimate jumps by at a report, made up smoothly: slowly in place (τ_p), at once in velocity (τᵥ) |
//! | lag | the 30 Hz filter's delay | the same as that of the other modes |
//!
//! This is linear estimation of a stationary process from irregular samples (Wiener;
//! Gaussian-process regression), with the stamps as they are: jitter costs nothing. The mean of the
//! posterior is worked out once a report and laid down as a polynomial about the middle of the time
//! for which it is wanted.
//!
//! A finger that is said to stand while the estimate has it move stands: what it did before no
//! longer counts, because no band holds a dead stop.
//!
//! **Where it fails.** A finger that meets an edge and goes on elsewhere between two reports moves
//! in no band: the estimate overshoots for some milliseconds. Jittered stamps of a straight stroke
//! lead it by up to 2 ms. It is a choice for hands on smooth strokes, and not the default.

use super::reckoning::Horizon;
use super::{PathMode, TrajectoryDesign};

/// Reports that count.
const KEPT: usize = 6;
/// Places and velocities of them.
const OBSERVED: usize = 2 * KEPT;
/// Frequencies of the motion …
const WAVES: usize = 24;
/// … up to, Hz.
const TOP_HZ: f64 = 30.0;
/// Terms of the polynomial.
const TERMS: usize = 8;
/// Size of ordinary motion, m: with this spectrum 0.1 m/s rms. Assumed.
const AMPLITUDE_M: f64 = 0.0125;
/// Errors of places, m, and of reported velocities, m/s: a game's in `f64`; rounded to `f32`; a
/// tracker's places.
const NOISE: [[f64; 2]; MODELS] = [[3e-8, 3e-7], [1e-6, 1e-6], [5e-5, 1e-6]];
/// Number of these.
const MODELS: usize = 3;
/// Freedom of the line under the motion: variance of its place and of its slope (1/s), in units of
/// the motion's own.
const LINE: [f64; 2] = [1e2, 1e4];
/// Times in which a jump of the velocity is made up, and one of the place, s.
const MADE_UP_S: [f64; 2] = [7e-4, 0.1];
/// Weight of the past when the models of noise are compared …
const FORGETTING: f64 = 0.8;
/// … more noise counts where it foretells so much better, of a variance …
const SELECTION_RATIO: f64 = 0.6;
/// … and the most that one report may count, m².
const MOST_M2: f64 = 4e-6;

/// A finger that is said to stand and is estimated to be faster has stopped dead, m/s: what is left
/// of a hand's smooth end is below.
const DEAD_STOP_M_S: f64 = 0.02;

/// Reports, about the path's origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Report {
    sample: u64,
    position_m: [f64; 2],
    velocity_m_s: Option<[f64; 2]>,
}

/// Position as a polynomial of the time since `centre_s` after the latest report, one for each
/// axis.
type Polynomial = [[f64; TERMS]; 2];

/// The estimate of one path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Estimate {
    reports: [Report; KEPT],
    len: usize,
    centre_s: f64,
    /// One for each model of noise.
    polynomials: [Polynomial; MODELS],
    /// Prediction errors of each, m².
    innovation_m2: [f64; MODELS],
    /// Place and velocity of what is still to be made up, of each axis.
    rest: [[f64; 2]; 2],
    /// Since the velocity is no longer believed: place and velocity.
    glide: Option<[[f64; 2]; 2]>,
}

impl Estimate {
    /// A contact that lands at the origin and has come along a line.
    pub fn begin(design: &TrajectoryDesign, sample: u64, velocity_m_s: Option<[f64; 2]>) -> Self {
        let report = Report { sample, position_m: [0.0; 2], velocity_m_s };
        let mut estimate = Self {
            reports: [report; KEPT],
            len: 1,
            centre_s: 0.0,
            polynomials: [[[0.0; TERMS]; 2]; MODELS],
            innovation_m2: [0.0; MODELS],
            rest: [[0.0; 2]; 2],
            glide: None,
        };
        // An estimate that the mode does not use is left as it is.
        if design.mode == PathMode::BandLimited {
            estimate.settle(design);
        }
        estimate
    }

    /// Another report, at the origin; `afresh` where it has nothing to do with those before. `now`
    /// is the next sample of the path.
    pub fn push(
        &mut self,
        design: &TrajectoryDesign,
        (now, sample): (u64, u64),
        belief: Horizon,
        velocity_m_s: Option<[f64; 2]>,
        afresh: bool,
    ) {
        let before = self.at(design, now, belief);
        let latest = self.reports[self.len - 1].sample;
        for (innovation_m2, polynomial) in self.innovation_m2.iter_mut().zip(&self.polynomials) {
            let since_s = (sample - latest) as f64 * design.sample_period_s - self.centre_s;
            let [u, v] = [0, 1].map(|axis| value(&polynomial[axis], since_s)[0]);
            *innovation_m2 = FORGETTING * *innovation_m2 + (u * u + v * v).min(MOST_M2);
        }
        let report = Report { sample, position_m: [0.0; 2], velocity_m_s };
        let has_stopped = velocity_m_s == Some([0.0; 2]) && {
            let since_s = (sample - latest) as f64 * design.sample_period_s - self.centre_s;
            let [u, v] = [0, 1].map(|axis| value(&self.best()[axis], since_s)[1]);
            libm::hypot(u, v) > DEAD_STOP_M_S
        };
        if afresh || has_stopped || self.glide.is_some() {
            (self.len, self.reports[0]) = (1, report);
        } else if sample == latest {
            self.reports[self.len - 1] = report;
        } else if self.len < KEPT {
            self.reports[self.len] = report;
            self.len += 1;
        } else {
            self.reports.copy_within(1.., 0);
            self.reports[KEPT - 1] = report;
        }
        self.glide = None;
        self.settle(design);
        // Goes on from where the path is.
        self.rest = [[0.0; 2]; 2];
        let after = self.at(design, now, belief);
        self.rest = [0, 1].map(|axis| [0, 1].map(|of| before[axis][of] - after[axis][of]));
    }

    /// Moves the origin.
    pub fn shift(&mut self, step_m: [f64; 2]) {
        for axis in 0..2 {
            self.reports[..self.len].iter_mut().for_each(|report| report.position_m[axis] += step_m[axis]);
            self.polynomials.iter_mut().for_each(|polynomial| polynomial[axis][0] += step_m[axis]);
            if let Some(glide) = &mut self.glide {
                glide[axis][0] += step_m[axis];
            }
        }
    }

    /// Prediction of the model of noise with the least error.
    fn best(&self) -> &Polynomial {
        let better = |best: usize, model: usize| {
            if self.innovation_m2[model] < SELECTION_RATIO * self.innovation_m2[best] { model } else { best }
        };
        &self.polynomials[(1..MODELS).fold(0, better)]
    }

    /// Place and velocity of each axis at a sample; beyond belief those at its end.
    fn at(&self, design: &TrajectoryDesign, sample: u64, belief: Horizon) -> [[f64; 2]; 2] {
        let latest = self.reports[self.len - 1].sample;
        let age = (sample.wrapping_sub(latest) as i64).min(belief.whole_samples);
        let since_s = age as f64 * design.sample_period_s - design.filter.group_delay_s() - self.centre_s;
        let polynomial = self.best();
        [0, 1].map(|axis| {
            let [place, velocity] =
                self.glide.map_or_else(|| value(&polynomial[axis], since_s), |glide| glide[axis]);
            [place + self.rest[axis][0], velocity + self.rest[axis][1]]
        })
    }

    /// Place and velocity along u and v at the next sample; `kept` from [`kept_a_sample`].
    pub fn next(
        &mut self,
        design: &TrajectoryDesign,
        sample: u64,
        belief: Horizon,
        [kept_fast, kept_slow]: [f64; 2],
    ) -> [[f64; 2]; 2] {
        let latest = self.reports[self.len - 1].sample;
        if sample.wrapping_sub(latest) as i64 > belief.whole_samples {
            self.glide_on(design, sample, belief);
        }
        let out = self.at(design, sample, belief);
        let [fast, slow] = MADE_UP_S.map(|time_s| 1.0 / time_s);
        for [place, velocity] in &mut self.rest {
            // The exact step of two real poles.
            let of_fast = -(*velocity + slow * *place) / (fast - slow);
            let of_slow = *place - of_fast;
            *place = of_fast * kept_fast + of_slow * kept_slow;
            *velocity = -fast * of_fast * kept_fast - slow * of_slow * kept_slow;
        }
        out
    }

    /// One sample further while nothing is reported.
    fn glide_on(&mut self, design: &TrajectoryDesign, sample: u64, belief: Horizon) {
        let rest = core::mem::take(&mut self.rest);
        let mut glide = self.at(design, sample, belief);
        self.rest = rest;
        let keep = libm::exp(-design.sample_period_s / belief.fade_s);
        for [place, velocity] in &mut glide {
            *velocity *= keep;
            *place += *velocity * design.sample_period_s;
        }
        if libm::hypot(glide[0][1], glide[1][1]) < super::REST_SPEED_M_S {
            (glide[0][1], glide[1][1]) = (0.0, 0.0);
        }
        self.glide = Some(glide);
    }

    /// Works the polynomials out anew.
    fn settle(&mut self, design: &TrajectoryDesign) {
        let period_s = match self.len {
            1 => 1.0 / 60.0,
            len => {
                (self.reports[len - 1].sample - self.reports[len - 2].sample) as f64 * design.sample_period_s
            }
        };
        self.centre_s = 0.5 * period_s.min(0.03) - design.filter.group_delay_s();
        let features = Features::of(design, &self.reports[..self.len]);
        for (polynomial, noise) in self.polynomials.iter_mut().zip(NOISE) {
            *polynomial = features.posterior(noise, self.centre_s);
        }
    }
}

/// Remainder of a jump of the velocity, and of the place, after a sample.
pub(super) fn kept_a_sample(design: &TrajectoryDesign) -> [f64; 2] {
    MADE_UP_S.map(|time_s| libm::exp(-design.sample_period_s / time_s))
}

/// Value and derivative of a polynomial.
fn value(terms: &[f64; TERMS], x: f64) -> [f64; 2] {
    terms.iter().rev().fold([0.0; 2], |[value, slope], term| [value * x + term, slope * x + value])
}

/// Frequency in 1/s and variance of a wave of the motion.
fn wave(index: usize) -> [f64; 2] {
    let hz = (index as f64 + 0.5) * TOP_HZ / WAVES as f64;
    let fourth = |x: f64| x * x * x * x;
    [2.0 * core::f64::consts::PI * hz, 1.0 / ((1.0 + fourth(hz)) * (1.0 + fourth(fourth(hz / 15.0))))]
}

/// Part of line and waves that each observation sees: two numbers of the line, then cosine and sine
/// of each wave.
struct Features {
    rows: [[f64; 2 + 2 * WAVES]; OBSERVED],
    seen: [[f64; 2]; OBSERVED],
    is_velocity: [bool; OBSERVED],
    count: usize,
    /// Variance of each feature.
    variance: [f64; 2 + 2 * WAVES],
}

impl Features {
    fn of(design: &TrajectoryDesign, reports: &[Report]) -> Self {
        let mut variance = [0.0; 2 + 2 * WAVES];
        let all: f64 = (0..WAVES).map(|index| wave(index)[1]).sum();
        (variance[0], variance[1]) = (LINE[0], LINE[1]);
        for index in 0..WAVES {
            variance[2 + 2 * index] = wave(index)[1] / all;
            variance[3 + 2 * index] = wave(index)[1] / all;
        }
        let mut features = Self {
            rows: [[0.0; 2 + 2 * WAVES]; OBSERVED],
            seen: [[0.0; 2]; OBSERVED],
            is_velocity: [false; OBSERVED],
            count: 0,
            variance,
        };
        let latest = reports[reports.len() - 1].sample;
        for report in reports {
            let t = -((latest - report.sample) as f64) * design.sample_period_s;
            let mut row = [0.0; 2 + 2 * WAVES];
            let mut slopes = [0.0; 2 + 2 * WAVES];
            (row[0], row[1], slopes[1]) = (1.0, t, 1.0);
            for index in 0..WAVES {
                let w = wave(index)[0];
                let (sin, cos) = libm::sincos(w * t);
                (row[2 + 2 * index], row[3 + 2 * index]) = (cos, sin);
                (slopes[2 + 2 * index], slopes[3 + 2 * index]) = (-w * sin, w * cos);
            }
            features.add(row, report.position_m, false);
            if let Some(velocity_m_s) = report.velocity_m_s {
                features.add(slopes, velocity_m_s, true);
            }
        }
        features
    }

    fn add(&mut self, row: [f64; 2 + 2 * WAVES], seen: [f64; 2], is_velocity: bool) {
        (self.rows[self.count], self.seen[self.count]) = (row, seen);
        self.is_velocity[self.count] = is_velocity;
        self.count += 1;
    }

    /// The mean of the motion given what was seen, as polynomials about a time after the latest
    /// report.
    #[expect(clippy::needless_range_loop, reason = "indices are those of the equations")]
    fn posterior(&self, noise: [f64; 2], centre_s: f64) -> Polynomial {
        let n = self.count;
        let mut covariance = [[0.0; OBSERVED]; OBSERVED];
        for i in 0..n {
            for j in 0..=i {
                let pairs = self.rows[i].iter().zip(&self.rows[j]).zip(&self.variance);
                covariance[i][j] = pairs.map(|((a, b), variance)| a * b * variance).sum();
            }
            let noise = noise[usize::from(self.is_velocity[i])] / AMPLITUDE_M;
            covariance[i][i] += noise * noise;
        }
        cholesky(&mut covariance, n);
        [0, 1].map(|axis| {
            let mut weights = [0.0; OBSERVED];
            (0..n).for_each(|i| weights[i] = self.seen[i][axis]);
            solve(&covariance, n, &mut weights);
            let mut found = [0.0; 2 + 2 * WAVES];
            for (row, weight) in self.rows[..n].iter().zip(&weights) {
                for ((found, feature), variance) in found.iter_mut().zip(row).zip(&self.variance) {
                    *found += weight * feature * variance;
                }
            }
            taylor(&found, centre_s)
        })
    }
}

/// The polynomial about a time of a sum of line and waves.
fn taylor(found: &[f64; 2 + 2 * WAVES], centre_s: f64) -> [f64; TERMS] {
    let mut terms = [0.0; TERMS];
    terms[0] = found[0] + found[1] * centre_s;
    terms[1] = found[1];
    for index in 0..WAVES {
        let w = wave(index)[0];
        let (sin, cos) = libm::sincos(w * centre_s);
        let (a, b) = (found[2 + 2 * index], found[3 + 2 * index]);
        // Value and derivative over ω turn into each other by a quarter.
        let mut turning = [a * cos + b * sin, b * cos - a * sin];
        let mut factor = 1.0;
        for (order, term) in terms.iter_mut().enumerate() {
            *term += factor * turning[0];
            turning = [turning[1], -turning[0]];
            factor *= w / (order + 1) as f64;
        }
    }
    terms
}

/// A symmetric matrix, of which the lower half is given, as L Lᵀ in its place.
#[expect(clippy::needless_range_loop, reason = "indices are those of the equations")]
fn cholesky(a: &mut [[f64; OBSERVED]; OBSERVED], n: usize) {
    for j in 0..n {
        for i in j..n {
            let mut sum = a[i][j];
            for k in 0..j {
                sum -= a[i][k] * a[j][k];
            }
            a[i][j] = if i == j { libm::sqrt(sum.max(1e-16)) } else { sum / a[j][j] };
        }
    }
}

/// Solves L Lᵀ x = b in place.
fn solve(l: &[[f64; OBSERVED]; OBSERVED], n: usize, b: &mut [f64; OBSERVED]) {
    for i in 0..n {
        for k in 0..i {
            b[i] -= l[i][k] * b[k];
        }
        b[i] /= l[i][i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            b[i] -= l[k][i] * b[k];
        }
        b[i] /= l[i][i];
    }
}
