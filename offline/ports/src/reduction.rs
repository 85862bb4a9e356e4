//! Reduction: samples become a clip that is felt alike through the device's own renderer.
//!
//! ```text
//! L_i  level of what is felt about node i                       20 ms, weighted by the detection threshold
//! f_i  one of three ways: the strongest tone, a tone drawn by the golden ratio, or the wave inside the range followed by its phase
//! A_i  = √2 L_i / W(f_i)                                        a sine that is felt as much
//! repeat: render the clip, measure L'_i, A_i ← A_i (L_i / L'_i); draw more of the third octaves that came out too weak
//! keep what scores best of all ways and rounds, then leave out the points that nobody would miss
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | nodes i | [`Options::points_per_s`] | evenly over the clip |
//! | W | [`crate::felt`] | |
//! | the score | [`crate::score`] | |
//! | strokes | [`Options::strokes_s`] | begin where a contact began or something struck; never guessed from the samples |
//!
//! Ours: the drawn tone and the choice by score. It looks ahead; what looks back only is the kernel
//! `asperity_dsp::vibration_points`.

use crate::clip::{About, AmplitudePoint, Clip, Emphasis, FrequencyPoint, LONGEST_S};
use crate::device::Device;
use crate::error::{PortError, within};
use crate::felt::{RATE_HZ, felt, power, weight};
use crate::nodes::Nodes;
use crate::resample::resampled;
use crate::score::{Reference, Score, third_octaves};
use crate::thinning::thinned;
use crate::tone_track::{Choice, ToneTrack};
use crate::{oscillator, wave_track};

/// Choice of the frequency that follows the samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// The strongest tone of every moment.
    Strongest,
    /// A tone drawn so that every third octave gets its share.
    Drawn,
    /// The wave inside the device's range, followed by its phase.
    Wave,
}

impl Way {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Strongest, Self::Drawn, Self::Wave];

    /// Its word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Strongest => "strongest",
            Self::Drawn => "drawn",
            Self::Wave => "wave",
        }
    }
}

/// Specification.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// Most points a second of either envelope; none: what the device holds.
    pub points_per_s: Option<f64>,
    /// Beginnings of strokes, s.
    pub strokes_s: Vec<f64>,
    /// Bring the peak to 1 even where it lies below.
    pub normalise: bool,
    /// One way only; none: whichever scores best.
    pub way: Option<Way>,
    /// Text of the file about itself.
    pub about: About,
}

/// Result.
#[derive(Debug, Clone, PartialEq)]
pub struct Reduction {
    /// The clip.
    pub clip: Clip,
    /// Factor of the samples that fits them into 0–1.
    pub gain: f64,
    /// Which way was taken longest.
    pub way: Way,
    /// The original at 8 kHz, with the gain.
    pub original: Vec<f64>,
    /// Output of the device, at 8 kHz.
    pub left: Vec<f64>,
    /// Distance of the two.
    pub score: Score,
}

/// Rounds of the loop.
const ROUNDS: usize = 5;
/// Clips are reduced piece by piece, s: a piece has its own spectrum to come near.
const PIECE_S: f64 = 20.0;
/// Number of pieces that try every way; those after them take the one that was taken most.
const ALL_WAYS_PIECES: usize = 3;
/// Half of the window of a level, s.
const LEVEL_S: f64 = 0.012;
/// Strokes stand out from the loudest moment by no more than this, or they are left out.
const FAINTEST_STROKE: f64 = 0.05;

/// Reduces samples at `rate_hz` to a clip for a device. `progress` gets how much is done, 0 to 1.
///
/// ```
/// use asperity_ports::device::Device;
/// use asperity_ports::reduction::{Options, reduce};
///
/// let buzz: Vec<f64> = (0..8000).map(|n| (n as f64 / 8000.0 * 170.0 * std::f64::consts::TAU).sin()).collect();
/// let reduced = reduce(&buzz, 8000.0, &Device::quest(), &Options::default(), &mut |_| {})?;
/// assert_eq!(reduced.left.len(), reduced.original.len());
/// # Ok::<(), asperity_ports::PortError>(())
/// ```
///
/// # Errors
/// When there are no samples, one is not finite, the rate or an option is refused.
pub fn reduce(
    samples: &[f64],
    rate_hz: f64,
    device: &Device,
    options: &Options,
    progress: &mut dyn FnMut(f64),
) -> Result<Reduction, PortError> {
    let original = checked(samples, rate_hz)?;
    let points_per_s = within("points", options.points_per_s.unwrap_or(device.points_per_s), [1.0, 4000.0])?;
    let duration_s = samples.len() as f64 / rate_hz;
    let pieces = (duration_s / PIECE_S).ceil().max(1.0) as usize;
    let most = ((points_per_s * duration_s).floor() as usize).max(2);
    let mut nodes = Nodes::default();
    let mut ways = [0usize; 3];
    for piece in 0..pieces {
        let span = |k: usize| duration_s * k as f64 / pieces as f64;
        let (from_s, to_s) = (span(piece), span(piece + 1));
        let first = (from_s * RATE_HZ).round() as usize;
        let last = ((to_s * RATE_HZ).round() as usize).min(original.len());
        let steps = ((most - 1) / pieces).max(1);
        let strokes: Vec<f64> =
            options.strokes_s.iter().filter(|t| (from_s..to_s).contains(*t)).map(|t| t - from_s).collect();
        let task = Piece::new(&original[first..last.max(first + 1)], to_s - from_s, steps, device, strokes);
        let (way, best) = task.best(options.way.or((piece >= ALL_WAYS_PIECES).then(|| most_taken(&ways))));
        ways[Way::ALL.iter().position(|w| *w == way).unwrap_or(0)] += 1;
        nodes.append(best, from_s);
        progress((piece + 1) as f64 / pieces as f64);
    }
    finish(original, nodes, most_taken(&ways), device, options)
}

fn most_taken(ways: &[usize; 3]) -> Way {
    Way::ALL[(0..3).fold(0, |most, k| if ways[k] > ways[most] { k } else { most })]
}

/// Samples at 8 kHz, when they are some and all of them are numbers.
///
/// # Errors
/// As [`reduce`].
pub fn checked(samples: &[f64], rate_hz: f64) -> Result<Vec<f64>, PortError> {
    within("rate", rate_hz, [100.0, 1e6])?;
    if samples.len() < 2 {
        return Err(PortError::new("samples", format!("are {} only", samples.len()), "must last longer"));
    }
    within("duration", samples.len() as f64 / rate_hz, [0.0, LONGEST_S])?;
    if let Some(index) = samples.iter().position(|x| !x.is_finite() || x.abs() > 1e30) {
        let what = format!("is {}", samples[index]);
        return Err(PortError::new(format!("sample {index}"), what, "must be a finite number"));
    }
    Ok(resampled(samples, rate_hz, RATE_HZ))
}

/// Gain, strokes and thinning, and the score of what is written.
fn finish(
    mut original: Vec<f64>,
    nodes: Nodes,
    way: Way,
    device: &Device,
    options: &Options,
) -> Result<Reduction, PortError> {
    let peak = nodes.peak();
    let gain = if peak > 1.0 || (options.normalise && peak > 0.0) { 1.0 / peak } else { 1.0 };
    original.iter_mut().for_each(|x| *x *= gain);
    let reference = Reference::new(&original, device.band_hz);
    let whole = nodes.clip(gain, device, &options.about);
    let score_of = |clip: &Clip| {
        let mut left = oscillator::rendered(clip, device, RATE_HZ);
        left.resize(original.len(), 0.0);
        (reference.score(&left), left)
    };
    let (mut score, mut left) = score_of(&whole);
    let mut clip = whole;
    // The coarsest that nobody would miss.
    for tolerance in [0.02, 0.01, 0.004, 0.001] {
        let thin = thinned(&clip, tolerance);
        let (thin_score, thin_left) = score_of(&thin);
        if thin_score.in_band_error_db <= score.in_band_error_db + 0.2
            && thin_score.balance_db <= score.balance_db + 0.3
            && (thin_score.level_bias_db.abs() - score.level_bias_db.abs()) < 0.15
            && thin_score.envelope_correlation >= score.envelope_correlation - 0.003
        {
            (clip, score, left) = (thin, thin_score, thin_left);
            break;
        }
    }
    Ok(Reduction { clip: clip.checked()?, gain, way, original, left, score })
}

/// One stretch of samples on its way to nodes.
struct Piece<'a> {
    samples: &'a [f64],
    time_s: Vec<f64>,
    device: &'a Device,
    strokes: Vec<(f64, Emphasis)>,
    levels: Vec<f64>,
    reference: Reference,
}

impl<'a> Piece<'a> {
    fn new(
        samples: &'a [f64],
        duration_s: f64,
        steps: usize,
        device: &'a Device,
        strokes_s: Vec<f64>,
    ) -> Self {
        let time_s: Vec<f64> = (0..=steps).map(|i| duration_s * i as f64 / steps as f64).collect();
        let weighted = felt(samples);
        let levels = levels_at(&weighted, &time_s);
        let reference = Reference::new(samples, device.band_hz);
        let mut piece = Self { samples, time_s, device, strokes: Vec::new(), levels, reference };
        piece.strokes =
            strokes_s.iter().filter_map(|at| piece.stroke(*at).map(|stroke| (*at, stroke))).collect();
        piece
    }

    /// Stroke that begins at a contact: as strong as the 20 ms behind it, as sharp as they are
    /// high.
    fn stroke(&self, begins_s: f64) -> Option<Emphasis> {
        let first = (begins_s * RATE_HZ) as usize;
        let stretch = self.samples.get(first..(first + 160).min(self.samples.len()))?;
        let peak = |x: &[f64]| x.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
        let (here, all) = (peak(stretch), peak(self.samples));
        if here <= FAINTEST_STROKE * all || all == 0.0 {
            return None;
        }
        let spectrum = power(stretch);
        let part = |from: f64, to: f64| -> f64 {
            let bins = spectrum.iter().enumerate().map(|(bin, p)| (crate::felt::bin_hz(bin), p));
            bins.filter(|(hz, _)| (from..to).contains(hz)).map(|(hz, p)| p * weight(hz).powi(2)).sum()
        };
        let (low, high) = (part(5.0, 100.0), part(100.0, 1000.0));
        Some(Emphasis {
            amplitude: here,
            frequency: if low + high > 0.0 { high / (low + high) } else { 0.5 },
        })
    }

    fn best(&self, only: Option<Way>) -> (Way, Nodes) {
        let mut best: Option<(f64, Way, Nodes)> = None;
        let tones = ToneTrack::new(self.samples, &self.time_s, self.device.band_hz);
        for way in Way::ALL.into_iter().filter(|way| only.is_none_or(|only| only == *way)) {
            let (cost, nodes) = self.loop_of(way, &tones);
            if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
                best = Some((cost, way, nodes));
            }
        }
        let (_, way, nodes) = best.unwrap_or((0.0, Way::Strongest, Nodes::default()));
        (way, nodes)
    }

    /// The closed loop of one way: its best round.
    fn loop_of(&self, way: Way, tones: &ToneTrack) -> (f64, Nodes) {
        let mut tilt = vec![1.0; self.reference.bands.len()];
        let wave =
            (way == Way::Wave).then(|| wave_track::track(self.samples, &self.time_s, self.device.band_hz));
        let mut hz = match &wave {
            Some(wave) => wave.hz.clone(),
            None => tones.hz(choice(way), &tilt),
        };
        let mut amplitude: Vec<f64> = match &wave {
            Some(wave) => wave.amplitude.clone(),
            None => self
                .levels
                .iter()
                .zip(&hz)
                .map(|(l, hz)| std::f64::consts::SQRT_2 * l / weight(*hz))
                .collect(),
        };
        let mut best: Option<(f64, Nodes)> = None;
        for round in 0..ROUNDS {
            let mut nodes = Nodes {
                time_s: self.time_s.clone(),
                amplitude: amplitude.clone(),
                hz: hz.clone(),
                strokes: self.strokes.clone(),
            };
            let left = self.left(&nodes);
            let score = self.reference.score(&left);
            // What is left of a constant error is taken out when all is done, so it costs nothing
            // here.
            let whole = 10f64.powf(-score.level_bias_db.clamp(-20.0, 20.0) / 20.0);
            nodes.amplitude.iter_mut().for_each(|a| *a *= whole);
            let cost = cost(&Score { level_bias_db: 0.0, ..score }) + 0.1 * score.level_bias_db.abs();
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, nodes));
            }
            if round + 1 == ROUNDS {
                break;
            }
            let is = levels_at(&felt(&left), &self.time_s);
            for ((a, was), is) in amplitude.iter_mut().zip(&self.levels).zip(&is) {
                let ratio = if *is > 0.0 { (was / is).clamp(0.5, 2.0) } else { 1.0 };
                *a *= ratio.powf(0.8);
            }
            if wave.is_none() {
                let bands = third_octaves(&power(&left), self.device.band_hz);
                for ((tilt, was), is) in tilt.iter_mut().zip(&self.reference.bands).zip(&bands) {
                    let ratio = if *is > 0.0 { (was / is).clamp(0.25, 4.0) } else { 1.0 };
                    *tilt = (*tilt * ratio.powf(0.6)).clamp(1e-3, 1e3);
                }
                let next = tones.hz(choice(way), &tilt);
                for ((a, was), is) in amplitude.iter_mut().zip(&hz).zip(&next) {
                    *a *= weight(*was) / weight(*is);
                }
                hz = next;
            }
        }
        best.unwrap_or_default()
    }

    fn left(&self, nodes: &Nodes) -> Vec<f64> {
        // Unbounded on purpose: the gain that makes it fit comes last.
        let amplitude = nodes.time_s.iter().zip(&nodes.amplitude);
        let mut clip = Clip {
            amplitude: amplitude
                .map(|(t, a)| AmplitudePoint { time_s: *t, amplitude: *a, emphasis: None })
                .collect(),
            frequency: Vec::new(),
            about: About::default(),
        };
        clip.frequency = nodes
            .time_s
            .iter()
            .zip(&nodes.hz)
            .map(|(t, hz)| FrequencyPoint { time_s: *t, frequency: self.device.frequency(*hz) })
            .collect();
        for (begins_s, stroke) in &nodes.strokes {
            let index =
                clip.amplitude.partition_point(|p| p.time_s < *begins_s).min(clip.amplitude.len() - 1);
            clip.amplitude[index].emphasis = Some(*stroke);
        }
        oscillator::rendered(&clip, self.device, RATE_HZ)
    }
}

fn choice(way: Way) -> Choice {
    if way == Way::Strongest { Choice::Strongest } else { Choice::Drawn }
}

/// Cost that rounds and ways are compared by, dB: the four numbers, each weighed by how near its
/// bound it lies.
fn cost(score: &Score) -> f64 {
    score.in_band_error_db
        + 0.5 * score.balance_db
        + 2.0 * (score.level_bias_db.abs() - 0.3).max(0.0)
        + 40.0 * (0.975 - score.envelope_correlation).max(0.0)
}

/// Levels about nodes: Hann windows of 24 ms, or of two steps where those are longer.
fn levels_at(felt: &[f64], time_s: &[f64]) -> Vec<f64> {
    let step_s = if time_s.len() > 1 { time_s[1] - time_s[0] } else { 0.0 };
    let half = (LEVEL_S.max(step_s) * RATE_HZ) as isize;
    let window: Vec<f64> = (-half..=half)
        .map(|n| 0.5 + 0.5 * (std::f64::consts::PI * n as f64 / (half + 1) as f64).cos())
        .collect();
    time_s
        .iter()
        .map(|t| {
            let middle = (t * RATE_HZ).round() as isize;
            let (mut energy, mut sum) = (0.0, 0.0);
            for (w, n) in window.iter().zip(middle - half..) {
                if let Some(x) = usize::try_from(n).ok().and_then(|n| felt.get(n)) {
                    energy += w * x * x;
                    sum += w;
                }
            }
            if sum > 0.0 { (energy / sum).sqrt() } else { 0.0 }
        })
        .collect()
}
