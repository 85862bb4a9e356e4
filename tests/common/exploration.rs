//! A free exploration of a surface: one stroke along u and one along v at random places, speeds and
//! forces; and what an observer knows of it.
#![allow(dead_code)]

use super::{SIDE_M, render};
use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine};
use asperity::offline::{Options, Render};
use asperity::{Config, Surface};
use asperity_dsp::rng::Rng;
use asperity_evidence::observer::touch::{Hand, Unit, felt};
use asperity_evidence::observer::{Percept, sound};

/// Strokes across the plate, one along each axis, and where the hand is at a sample.
pub struct Exploration {
    /// The strokes as they are reported.
    pub log: ContactLog,
    strokes: [(f64, f64, [f64; 2], f64); 2],
}

impl Exploration {
    /// Places, speeds and forces of a seed.
    pub fn new(seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let mut log = ContactLog { lines: Vec::new() };
        let mut strokes = [(0.0, 0.0, [0.0; 2], 0.0); 2];
        let mut at_s = 0.05;
        for (axis, stroke) in strokes.iter_mut().enumerate() {
            let speed_m_s = 0.06 + 0.16 * rng.uniform();
            let normal_force_n = 0.4 + 0.6 * rng.uniform();
            let mut from = [0.08 + 0.04 * rng.uniform(), 0.2 + 0.6 * rng.uniform()];
            if axis == 1 {
                from.swap(0, 1);
            }
            let length_s = 0.8 * SIDE_M / speed_m_s;
            let sample = |t: f64| {
                let mut uv = from;
                uv[axis] += speed_m_s * t / SIDE_M;
                let mut velocity = [0.0; 2];
                velocity[axis] = speed_m_s;
                ContactSample {
                    uv,
                    velocity_m_s: Some(velocity),
                    normal_force_n,
                    closing_m_s: 0.0,
                    ..ContactSample::default()
                }
            };
            let contact = axis as u64;
            log.lines.push(LogLine { t: at_s, event: LogEvent::begin(contact, "s", 0, sample(0.0)) });
            for step in 1..(length_s * 60.0) as usize {
                let t = step as f64 / 60.0;
                log.lines.push(LogLine { t: at_s + t, event: LogEvent::moved(contact, sample(t)) });
            }
            log.lines.push(LogLine { t: at_s + length_s, event: LogEvent::End { contact } });
            *stroke = (at_s, at_s + length_s, from, speed_m_s);
            at_s += length_s + 0.1;
        }
        Self { log, strokes }
    }

    fn hand(&self, samples: usize, rate_hz: f64) -> (Vec<[f64; 2]>, Vec<usize>) {
        let at = |n: usize| {
            let t = n as f64 / rate_hz;
            let axis = usize::from(t > self.strokes[0].1 + 0.05);
            let (from_s, to_s, mut uv, speed_m_s) = self.strokes[axis];
            uv[axis] += speed_m_s * (t.clamp(from_s, to_s) - from_s) / SIDE_M;
            (uv, axis)
        };
        (0..samples).map(at).unzip()
    }
}

/// What is felt, and what is heard, of a surface. `pascals`: of a full-scale sample. With the place
/// of the hand where the task gives it.
pub fn percepts(config: Config, surface: Surface, seed: u64, pascals: f64, placed: bool) -> [Percept; 2] {
    let exploration = Exploration::new(seed);
    let config = Config { seed, ..config };
    let Render { sample_rate_hz, haptic, audio, .. } =
        render(config, surface, &exploration.log, &Options { tail_s: 0.0, ..Options::default() });
    // Touch ends at 1 kHz: every eighth sample of what is low-passed on the way.
    let every = 8;
    let low: Vec<f64> = haptic[0]
        .chunks_exact(every)
        .map(|x| x.iter().map(|x| f64::from(*x)).sum::<f64>() / every as f64)
        .collect();
    let low_hz = sample_rate_hz / every as f64;
    let (place, axis) = exploration.hand(low.len(), low_hz);
    let hand = placed.then_some(Hand { place: &place, axis: &axis });
    let touched = felt(&low, low_hz, Unit::Displacement, hand);
    let heard: Vec<f64> = audio[0].iter().map(|x| pascals * f64::from(*x)).collect();
    let (place, axis) = exploration.hand(heard.len(), sample_rate_hz);
    let hand = placed.then_some(Hand { place: &place, axis: &axis });
    [touched, sound::heard(&heard, sample_rate_hz, None, hand)]
}
