//! A second observer: the first one's senses, an ear for rhythm, and a hand that senses how fast
//! and how hard it strokes.
//!
//! It was written, with its constants and their sources, before it was asked anything; their
//! SHA-256 ([`constants_sha256`]) was fixed then. What differs from the first observer:
//!
//! | | first | second |
//! |---|---|---|
//! | signal | the whole exploration | each stroke by itself, with its speed and force |
//! | rhythm | level by frames of 0.1 s | modulation filters of 4–64 Hz in three groups of carriers; the hand's speed says which filter has which period of the ground |
//! | template | as it was learnt | carried to the speed and force of the hand, along the class's own line in ln v and ln F |
//! | two senses | product of likelihoods | each likelihood to the power of its reliability, as far as the known plates show it (Ernst and Banks 2002: weights by reliability) |
//!
//! ```text
//! t′ = t + b (ln v − ln v_t) + c (ln F − ln F_t)      b, c: least squares over the class's templates
//! ln p(x | class) = Σ_s w_s ln mean over templates Π N(x_s; t′_s, (κσ)² + 2 c²)
//! w_s: maximum likelihood of the templates' own classes, each template left out in turn
//! ```

use crate::observer::constants::{self, D_PRIME_AT_THRESHOLD, LAPSE, SOUND_GROUPS_HZ};
use crate::observer::judge::{Confusion, Feature, Percept};
use crate::observer::spectra::{Band, Spectra};
use crate::observer::touch::chance_db;
use asperity_dsp::rng::Rng;
use sha2::{Digest, Sha256};

/// Rates of the modulation filters, from and to, Hz.
pub const MODULATION_HZ: [f64; 2] = [4.0, 64.0];
/// Bandwidth of a modulation filter: 5 Hz up to 10 Hz, above that half its rate (Dau, Kollmeier and
/// Kohlrausch 1997, abstract: "constant bandwidth of 5 Hz", "constant Q value of 2").
pub const MODULATION_FILTER: (f64, f64) = (5.0, 2.0);
/// Modulation that is just heard on broad-band noise, (Hz, dB re full depth): Viemeister 1979.
/// **Recalled**, to about 2 dB. Between points linear in log f.
pub const MODULATION_THRESHOLD_DB: [(f64, f64); 5] =
    [(4.0, -25.0), (8.0, -25.0), (16.0, -24.0), (32.0, -22.0), (64.0, -19.0)];
/// Deviation of one look at the depth of a modulation, dB: difference thresholds of depth are about
/// 1–2 dB well above threshold (Wakefield and Viemeister 1990). **Recalled.**
pub const MODULATION_SD_DB: f64 = 1.5;
/// Periods of the ground that the hand's speed turns rates into, m: half an octave apart, the width
/// of the filters.
pub const PERIODS_M: [f64; 9] = [0.032, 0.0226, 0.016, 0.0113, 0.008, 0.005_66, 0.004, 0.002_83, 0.002];
/// Difference threshold of a limb's movement, share: 8 % (Jones, Hunter and Irwin 1992, abstract).
pub const SPEED_WEBER: f64 = 0.08;
/// Difference threshold of a finger's force, share: 7 % (Pang, Tan and Durlach 1991, abstract).
pub const FORCE_WEBER: f64 = 0.07;
/// Rate at which envelopes are sampled, Hz, and the window they are taken through, s.
pub const ENVELOPE: (f64, f64) = (400.0, 0.008);
/// Powers of two among which a sense's reliability is looked for, in steps of a half.
pub const RELIABILITY_LOG2: [f64; 2] = [-8.0, 1.0];

/// SHA-256 of all constants, the first observer's among them, in hexadecimal.
#[must_use]
pub fn constants_sha256() -> String {
    let text = format!(
        "{} {MODULATION_HZ:?} {MODULATION_FILTER:?} {MODULATION_THRESHOLD_DB:?} {MODULATION_SD_DB} {PERIODS_M:?} \
         {SPEED_WEBER} {FORCE_WEBER} {ENVELOPE:?} {RELIABILITY_LOG2:?}",
        constants::constants_sha256()
    );
    Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// One stroke as it is felt and heard.
#[derive(Debug, Clone)]
pub struct Stroke {
    /// By touch, by ear; a sense that is not given has no features.
    pub senses: [Percept; 2],
    /// ln of the speed, m/s, and of the force, N.
    pub hand: [f64; 2],
}

/// Strokes of one exploration, in the same order for every trial.
pub type Trial = Vec<Stroke>;

/// Depth of modulation by the period of the ground, in three groups of carriers, of a stroke in
/// pascals.
#[must_use]
pub fn rhythm(
    signal: &[f64],
    rate_hz: f64,
    speed_m_s: f64,
    weight: impl Fn(f64) -> f64 + Copy,
) -> Vec<Feature> {
    let (envelope_hz, window_s) = ENVELOPE;
    let length = ((window_s * rate_hz) as usize).clamp(1, signal.len().max(1));
    let spectra = Spectra::new(length, rate_hz);
    let hop = rate_hz / envelope_hz;
    let frames = ((signal.len().saturating_sub(length)) as f64 / hop) as usize;
    let powers: Vec<Vec<f64>> = (0..frames)
        .map(|frame| {
            let at = (frame as f64 * hop) as usize;
            spectra.power(&signal[at..at + length])
        })
        .collect();
    let groups = SOUND_GROUPS_HZ.windows(2).map(|edges| Band { low_hz: edges[0], high_hz: edges[1] });
    groups
        .flat_map(|band| {
            let power = powers.iter().map(|power| spectra.in_band(power, band, weight));
            let envelope: Vec<f64> = power.map(f64::sqrt).collect();
            depths(&envelope, envelope_hz, speed_m_s)
        })
        .collect()
}

/// Depths over threshold of an envelope whose unit is that of the threshold of hearing.
fn depths(envelope: &[f64], envelope_hz: f64, speed_m_s: f64) -> Vec<Feature> {
    let mean = envelope.iter().sum::<f64>() / envelope.len().max(1) as f64;
    let seconds = envelope.len() as f64 / envelope_hz;
    let centred: Vec<f64> = envelope.iter().map(|x| x - mean).collect();
    let spectrum = Spectra::new(centred.len().max(1), envelope_hz);
    let power = spectrum.power(&centred);
    let of = |period_m: &f64| {
        let rate = speed_m_s / period_m;
        let (least, quality) = MODULATION_FILTER;
        let width = least.max(rate / quality);
        let chance = chance_db(width * seconds);
        let is_heard = (MODULATION_HZ[0]..=MODULATION_HZ[1]).contains(&rate) && mean > 1.0;
        if !is_heard {
            return Feature { value: f64::NAN, sd: MODULATION_SD_DB, chance };
        }
        let band = Band { low_hz: (rate - 0.5 * width).max(1.0), high_hz: rate + 0.5 * width };
        let depth = (2.0 * spectrum.in_band(&power, band, |_| 1.0)).sqrt() / mean;
        let over = 20.0 * depth.max(1e-9).log10() - constants::between(&MODULATION_THRESHOLD_DB, rate);
        Feature { value: over.max(0.0), sd: MODULATION_SD_DB, chance }
    };
    PERIODS_M.iter().map(of).collect()
}

/// Templates of a class and the lines they are carried along.
#[derive(Debug, Clone)]
struct Class {
    templates: Vec<Trial>,
    /// By stroke, sense and feature: change a unit of ln v, of ln F.
    slopes: Vec<[Vec<[f64; 2]>; 2]>,
}

/// An observer that has learnt some classes.
#[derive(Debug, Clone)]
pub struct Judge {
    classes: Vec<Class>,
    kappa: f64,
    reliability: [f64; 2],
}

impl Judge {
    /// Learns each class from its templates; κ scales the observer's noise, 0 is none.
    #[must_use]
    pub fn new(classes: Vec<Vec<Trial>>, kappa: f64) -> Self {
        let classes = classes.into_iter().map(Class::new).collect();
        let mut judge = Self { classes, kappa, reliability: [1.0; 2] };
        judge.reliability = [0, 1].map(|sense| judge.learn_reliability(sense));
        judge
    }

    /// Power of the likelihood by touch and by ear.
    #[must_use]
    pub fn reliability(&self) -> [f64; 2] {
        self.reliability
    }

    /// Power of a sense's likelihood under which the templates, each left out in turn, are most
    /// likely of their own classes.
    fn learn_reliability(&self, sense: usize) -> f64 {
        let mut rng = Rng::new(1 + sense as u64);
        let mut lots: Vec<(usize, Vec<f64>)> = Vec::new();
        for (own, class) in self.classes.iter().enumerate() {
            for (left_out, template) in class.templates.iter().enumerate() {
                let seen = self.noisy(template, &mut rng);
                let each = self.classes.iter().enumerate().map(|(of, class)| {
                    class.likelihood(&seen, sense, self.kappa, (of == own).then_some(left_out))
                });
                lots.push((own, each.collect()));
            }
        }
        let score = |power: f64| -> f64 {
            lots.iter()
                .map(|(own, each)| {
                    let top = each.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                    let sum: f64 = each.iter().map(|x| (power * (x - top)).exp()).sum();
                    power * (each[*own] - top) - sum.ln()
                })
                .sum()
        };
        let steps = (2.0 * (RELIABILITY_LOG2[1] - RELIABILITY_LOG2[0])) as i32;
        let powers = (0..=steps).map(|step| 2f64.powf(RELIABILITY_LOG2[0] + 0.5 * f64::from(step)));
        powers.max_by(|a, b| score(*a).total_cmp(&score(*b))).unwrap_or(1.0)
    }

    fn noisy(&self, trial: &Trial, rng: &mut Rng) -> Trial {
        let deviation = |weber: f64| self.kappa * (1.0 + weber).ln() / D_PRIME_AT_THRESHOLD;
        let mut stroke = |stroke: &Stroke| Stroke {
            hand: [
                stroke.hand[0] + deviation(SPEED_WEBER) * rng.normal(),
                stroke.hand[1] + deviation(FORCE_WEBER) * rng.normal(),
            ],
            senses: [0, 1].map(|sense| stroke.senses[sense].noisy(self.kappa, rng)),
        };
        trial.iter().map(&mut stroke).collect()
    }

    /// The class that a trial is taken for by some of the senses.
    pub fn answer(&self, trial: &Trial, senses: &[usize], rng: &mut Rng) -> usize {
        let lapsed = self.kappa > 0.0 && rng.uniform() < LAPSE;
        let guess = (rng.uniform() * self.classes.len() as f64) as usize;
        let seen = self.noisy(trial, rng);
        if lapsed {
            return guess;
        }
        let likelihood = |class: &Class| -> f64 {
            senses.iter().map(|s| self.reliability[*s] * class.likelihood(&seen, *s, self.kappa, None)).sum()
        };
        let each: Vec<f64> = self.classes.iter().map(likelihood).collect();
        (0..each.len()).max_by(|a, b| each[*a].total_cmp(&each[*b])).unwrap_or(guess)
    }

    /// Asks every trial of every class `repeats` times.
    #[must_use]
    pub fn ask(&self, trials: &[Vec<Trial>], senses: &[usize], repeats: usize, seed: u64) -> Confusion {
        let mut rng = Rng::new(seed);
        let mut counts = vec![vec![0; self.classes.len()]; trials.len()];
        for (row, trials) in counts.iter_mut().zip(trials) {
            for trial in trials.iter().flat_map(|trial| std::iter::repeat_n(trial, repeats)) {
                row[self.answer(trial, senses, &mut rng)] += 1;
            }
        }
        Confusion { counts }
    }
}

impl Class {
    fn new(templates: Vec<Trial>) -> Self {
        let strokes = templates.first().map_or(0, Vec::len);
        let of = |stroke: usize| {
            [0, 1].map(|sense| {
                let count = templates[0][stroke].senses[sense].features.len();
                (0..count).map(|feature| slopes(&templates, stroke, sense, feature)).collect()
            })
        };
        let slopes = (0..strokes).map(of).collect();
        Self { templates, slopes }
    }

    /// ln p(x | class) by one sense.
    fn likelihood(&self, seen: &Trial, sense: usize, kappa: f64, left_out: Option<usize>) -> f64 {
        let kept = self.templates.iter().enumerate().filter(|(index, _)| Some(*index) != left_out);
        let each: Vec<f64> = kept.map(|(_, template)| self.kernel(seen, template, sense, kappa)).collect();
        let top = each.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        top + (each.iter().map(|x| (x - top).exp()).sum::<f64>() / each.len().max(1) as f64).ln()
    }

    /// ln Π N, by as much as there are features to compare.
    fn kernel(&self, seen: &Trial, template: &Trial, sense: usize, kappa: f64) -> f64 {
        let (mut sum, mut known, mut all) = (0.0, 0usize, 0usize);
        for ((x, t), slopes) in seen.iter().zip(template).zip(&self.slopes) {
            let away = [0, 1].map(|of| x.hand[of] - t.hand[of]);
            let features = x.senses[sense].features.iter().zip(&t.senses[sense].features);
            for ((x, t), slope) in features.zip(&slopes[sense]) {
                let carried = t.value + slope[0] * away[0] + slope[1] * away[1];
                let variance = (kappa * x.sd).powi(2) + x.chance.powi(2) + t.chance.powi(2);
                let term = -0.5 * (x.value - carried).powi(2) / variance.max(1e-6);
                all += 1;
                if term.is_finite() {
                    sum += term;
                    known += 1;
                }
            }
        }
        sum * all as f64 / known.max(1) as f64
    }
}

/// Least squares of a feature over ln v and ln F; none where fewer than six templates have it.
fn slopes(templates: &[Trial], stroke: usize, sense: usize, feature: usize) -> [f64; 2] {
    let points: Vec<[f64; 3]> = templates
        .iter()
        .map(|trial| {
            let of = &trial[stroke];
            [of.hand[0], of.hand[1], of.senses[sense].features[feature].value]
        })
        .filter(|point| point[2].is_finite())
        .collect();
    let n = points.len() as f64;
    if n < 6.0 {
        return [0.0; 2];
    }
    let means: [f64; 3] = std::array::from_fn(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
    let product =
        |i: usize, j: usize| points.iter().map(|p| (p[i] - means[i]) * (p[j] - means[j])).sum::<f64>();
    let (vv, ff, vf, vx, fx) = (product(0, 0), product(1, 1), product(0, 1), product(0, 2), product(1, 2));
    let determinant = vv * ff - vf * vf;
    if determinant < 1e-9 * (vv * ff).max(1e-12) {
        return [0.0; 2];
    }
    [(ff * vx - vf * fx) / determinant, (vv * fx - vf * vx) / determinant]
}
