//! The model of an actuator against the samples of its sweep.

use super::Sweep;
use asperity_fft::num_complex::Complex64;
use asperity_fft::{Fft, FftPlanner};
use nalgebra::{SMatrix, SVector};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Steps of the fit.
const STEPS: usize = 40;
/// Periods of the resonance over which a residual may be correlated.
const CORRELATED_PERIODS: f64 = 2.0;

/// Parameters of the model.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    pub(super) resonance_hz: f64,
    pub(super) quality: f64,
    pub(super) lag_s: f64,
    pub(super) felt_m: f64,
    pub(super) offset_m_s2: f64,
}

impl Fit {
    /// Felt motion over drive at ω over D₀, without the lag.
    pub(super) fn motion(&self, w: f64) -> Complex64 {
        let w0 = TAU * self.resonance_hz;
        Complex64::from(w0 * w0 / self.quality) / self.denominator(w)
    }

    fn denominator(&self, w: f64) -> Complex64 {
        let w0 = TAU * self.resonance_hz;
        Complex64::new(w0 * w0 - w * w, w * w0 / self.quality)
    }

    pub(super) fn acceleration(&self, w: f64) -> Complex64 {
        -w * w * self.motion(w) * Complex64::cis(-w * self.lag_s)
    }

    /// Derivatives of ln(acceleration) by ln ω₀, ln Q and τ.
    fn slopes(&self, w: f64) -> [Complex64; 3] {
        let w0 = TAU * self.resonance_hz;
        let damping = Complex64::new(0.0, w * w0 / self.quality);
        let d = self.denominator(w);
        [2.0 - (2.0 * w0 * w0 + damping) / d, damping / d - 1.0, Complex64::new(0.0, -w)]
    }

    fn moved(&self, step: &SVector<f64, 5>) -> Self {
        Self {
            resonance_hz: self.resonance_hz * step[0].clamp(-0.2, 0.2).exp(),
            quality: (self.quality * step[1].clamp(-0.7, 0.7).exp()).clamp(0.1, 1e4),
            lag_s: self.lag_s + step[2].clamp(-5e-4, 5e-4),
            felt_m: self.felt_m * step[3].clamp(-0.7, 0.7).exp(),
            offset_m_s2: self.offset_m_s2 + step[4],
        }
    }
}

/// A sweep and its transforms.
pub(super) struct Record<'a> {
    pub(super) sweep: &'a Sweep,
    forward: Arc<dyn Fft<f64>>,
    inverse: Arc<dyn Fft<f64>>,
    /// Length of the transforms.
    pub(super) length: usize,
    pub(super) drive: Vec<Complex64>,
}

/// Normal equations of a step, and sums of squares: of the residual, and of its pull by blocks.
#[derive(Default)]
struct Normal {
    matrix: SMatrix<f64, 5, 5>,
    pull: SVector<f64, 5>,
    blocks: SMatrix<f64, 5, 5>,
    squares: f64,
    count: f64,
}

impl<'a> Record<'a> {
    pub(super) fn new(sweep: &'a Sweep) -> Self {
        // A second of silence behind the record: what rings on does not come round.
        let length = (sweep.drive.len() + sweep.rate_hz as usize).next_power_of_two();
        let mut planner = FftPlanner::new();
        let (forward, inverse) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
        let mut record = Self { sweep, forward, inverse, length, drive: Vec::new() };
        record.drive = record.spectrum(sweep.drive.iter().copied());
        record
    }

    pub(super) fn spectrum(&self, samples: impl Iterator<Item = f64>) -> Vec<Complex64> {
        let mut all: Vec<Complex64> = samples.map(Complex64::from).collect();
        all.resize(self.length, Complex64::ZERO);
        self.forward.process(&mut all);
        all.truncate(self.length / 2 + 1);
        all
    }

    pub(super) fn frequency_hz(&self, bin: usize) -> f64 {
        bin as f64 * self.sweep.rate_hz / self.length as f64
    }

    /// Two real signals of their spectra over that of the drive, by one transform.
    fn signals(&self, of: impl Fn(f64) -> [Complex64; 2]) -> [Vec<f64>; 2] {
        let mut all = vec![Complex64::ZERO; self.length];
        for bin in 1..self.length / 2 {
            let w = TAU * self.frequency_hz(bin);
            let [a, b] = of(w).map(|x| x * self.drive[bin] / self.length as f64);
            all[bin] = a + Complex64::I * b;
            all[self.length - bin] = a.conj() + Complex64::I * b.conj();
        }
        self.inverse.process(&mut all);
        all.truncate(self.sweep.drive.len());
        [all.iter().map(|z| z.re).collect(), all.iter().map(|z| z.im).collect()]
    }

    /// The model without its offset, and its derivatives by ln ω₀, ln Q and τ.
    pub(super) fn model(&self, fit: &Fit) -> [Vec<f64>; 4] {
        let at = |w: f64| fit.felt_m * fit.acceleration(w);
        let [model, by_resonance] = self.signals(|w| [at(w), at(w) * fit.slopes(w)[0]]);
        let [by_quality, by_lag] = self.signals(|w| {
            let [_, quality, lag] = fit.slopes(w);
            [at(w) * quality, at(w) * lag]
        });
        [model, by_resonance, by_quality, by_lag]
    }

    /// Largest felt motion of the sweep, m.
    pub(super) fn felt_m(&self, fit: &Fit) -> f64 {
        let [motion, _] = self.signals(|w| [fit.felt_m * fit.motion(w), Complex64::ZERO]);
        motion.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
    }

    /// Least squares over the samples that are kept.
    pub(super) fn refine(&self, mut fit: Fit, kept: &[bool]) -> Fit {
        let mut damping = 1e-3;
        let mut now = self.normal(&fit, kept, usize::MAX);
        for _ in 0..STEPS {
            let mut matrix = now.matrix;
            (0..5).for_each(|i| matrix[(i, i)] *= 1.0 + damping);
            let Some(step) = matrix.cholesky().map(|solved| solved.solve(&now.pull)) else { break };
            let tried = fit.moved(&step);
            let next = self.normal(&tried, kept, usize::MAX);
            if next.squares > now.squares || !next.squares.is_finite() {
                damping *= 10.0;
                if damping > 1e6 {
                    break;
                }
                continue;
            }
            let is_done = step[0].abs() < 1e-8 && step[1].abs() < 1e-6;
            (fit, now, damping) = (tried, next, damping * 0.1);
            if is_done {
                break;
            }
        }
        fit
    }

    /// Standard errors of ln ω₀, ln Q, τ and ln D₀.
    pub(super) fn spread(&self, fit: &Fit, kept: &[bool]) -> [f64; 4] {
        let block = (CORRELATED_PERIODS * self.sweep.rate_hz / fit.resonance_hz) as usize;
        let normal = self.normal(fit, kept, block.max(1));
        let Some(inverse) = normal.matrix.try_inverse() else { return [f64::INFINITY; 4] };
        let white = inverse * (normal.squares / (normal.count - 5.0).max(1.0));
        let correlated = inverse * normal.blocks * inverse;
        std::array::from_fn(|i| white[(i, i)].max(correlated[(i, i)]).sqrt())
    }

    fn normal(&self, fit: &Fit, kept: &[bool], block: usize) -> Normal {
        let [model, by_resonance, by_quality, by_lag] = self.model(fit);
        let mut normal = Normal::default();
        let mut part = SVector::<f64, 5>::zeros();
        for (at, recorded) in self.sweep.acceleration_m_s2.iter().enumerate() {
            if kept[at] {
                let row = SVector::from([by_resonance[at], by_quality[at], by_lag[at], model[at], 1.0]);
                let rest = recorded - model[at] - fit.offset_m_s2;
                normal.matrix += row * row.transpose();
                normal.pull += row * rest;
                part += row * rest;
                normal.squares += rest * rest;
                normal.count += 1.0;
            }
            if (at + 1) % block == 0 {
                normal.blocks += part * part.transpose();
                part.fill(0.0);
            }
        }
        normal
    }
}
