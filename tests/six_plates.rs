//! The six plates of the Hasti study (§IV-B), the mirrored pair among them, judged by the frozen observer.
//!
//! A trial is one free exploration: a stroke along u and one along v at random places, speeds and forces, on a plate whose micro-relief has a
//! seed of its own. The observer learns each plate from other seeds, places, speeds and forces than those it is asked about, and knows where
//! the hand is, as the study's participants did. What it says is printed and stands in `docs/feel.md`, whatever it is; held to are
//! the controls: shuffled labels and a plate against itself at chance, and the figures of people as far as they are reached.

mod common;

use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine};
use asperity::offline::{Options, Render};
use asperity::{Config, Excitation, Extent, Roughness, Surface, Wrap};
use asperity_dsp::rng::Rng;
use asperity_observer::touch::{Hand, Unit, felt};
use asperity_observer::{Confusion, Judge, Percept, constants, sound};
use asperity_texture::height_map::HeightMap;
use asperity_texture::raster::Raster;
use common::{SIDE_M, render, si_config};
use std::f64::consts::PI;

const PLATES: [&str; 6] = ["matte-shiny", "shiny-matte", "ridge", "bumps", "sine", "sawtooth"];
/// Templates and trials a plate; people had 24 trials a plate.
const TEMPLATES: u64 = 16;
const TRIALS: u64 = 16;
/// R of printed plastic, as the demo's plates have it.
const PLASTIC: f64 = 0.6;
/// Full scale of the sound in pascals: the demo's gain, and 94 dB SPL at full scale.
const PASCALS: f64 = 5.0 * constants::LISTENING_PA;

fn height_m(plate: &str, x: f64, y: f64) -> f64 {
    let pitch = 0.007;
    match plate {
        "ridge" => {
            let across = (x - 0.5 * SIDE_M) / 0.009;
            if across.abs() < 1.0 { 0.002 * (1.0 + (PI * across).cos()) } else { 0.0 }
        }
        "bumps" => {
            let (u, v) = ((x / pitch).fract() - 0.5, (y / pitch).fract() - 0.5);
            let radius = u.hypot(v) / 0.45;
            if radius < 1.0 { 0.0005 * (1.0 + (PI * radius).cos()) } else { 0.0 }
        }
        "sine" => 0.0005 * (1.0 - (2.0 * PI * x / pitch).cos()),
        "sawtooth" => {
            let (phase, fall) = ((x / pitch).fract(), 0.06);
            0.001 * if phase < 1.0 - fall { phase / (1.0 - fall) } else { (1.0 - phase) / fall }
        }
        _ => 0.0,
    }
}

fn surface(plate: &str) -> Surface {
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let raster = |side: usize, of: &dyn Fn(f64, f64) -> f64| {
        let texel = SIDE_M / side as f64;
        Raster::from_fn(side, side, |x, y| of((x as f64 + 0.5) * texel, (y as f64 + 0.5) * texel))
    };
    let map = HeightMap::new(&raster(512, &|x, y| height_m(plate, x, y)), extent, Wrap::Clamp).unwrap();
    let halves = |x: f64| if (x < 0.5 * SIDE_M) == (plate == "matte-shiny") { 0.9 } else { 0.1 };
    let roughness = |x: f64, _: f64| if plate.contains("matte") { halves(x) } else { PLASTIC };
    let rough = HeightMap::new(&raster(128, &roughness), extent, Wrap::Clamp).unwrap();
    let surface = Surface::new(map, SIDE_M, SIDE_M).unwrap().roughness(Roughness::Map(Box::new(rough)));
    surface.excitation(Excitation::BOTH)
}

/// Strokes across the plate, one along each axis, and where the hand is at a sample.
struct Exploration {
    log: ContactLog,
    strokes: [(f64, f64, [f64; 2], f64); 2],
}

impl Exploration {
    fn new(seed: u64) -> Self {
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

/// What is felt, and what is heard, of a plate.
fn percepts(plate: &str, seed: u64) -> [Percept; 2] {
    let exploration = Exploration::new(seed);
    let config = Config { seed, ..si_config() };
    let Render { sample_rate_hz, haptic, audio, .. } =
        render(config, surface(plate), &exploration.log, &Options { tail_s: 0.0, ..Options::default() });
    // Touch ends at 1 kHz: every eighth sample of what is low-passed on the way.
    let every = 8;
    let low: Vec<f64> = haptic[0]
        .chunks_exact(every)
        .map(|x| x.iter().map(|x| f64::from(*x)).sum::<f64>() / every as f64)
        .collect();
    let low_hz = sample_rate_hz / every as f64;
    let (place, axis) = exploration.hand(low.len(), low_hz);
    let touched = felt(&low, low_hz, Unit::Displacement, Some(Hand { place: &place, axis: &axis }));
    let pascals: Vec<f64> = audio[0].iter().map(|x| PASCALS * f64::from(*x)).collect();
    let (place, axis) = exploration.hand(pascals.len(), sample_rate_hz);
    let heard = sound::heard(&pascals, sample_rate_hz, None, Some(Hand { place: &place, axis: &axis }));
    [touched, heard]
}

type Senses = fn(&[Percept; 2]) -> Percept;

const CONDITIONS: [(&str, Senses); 3] =
    [("touch", |p| p[0].clone()), ("sound", |p| p[1].clone()), ("both", |p| p[0].clone().and(&p[1]))];

fn lot(from: u64, count: u64) -> Vec<Vec<[Percept; 2]>> {
    let of = |(index, plate): (usize, &&str)| {
        (0..count).map(|n| percepts(plate, from + 1000 * index as u64 + n)).collect()
    };
    PLATES.iter().enumerate().map(of).collect()
}

fn seen(lot: &[Vec<[Percept; 2]>], senses: Senses) -> Vec<Vec<Percept>> {
    lot.iter().map(|plate| plate.iter().map(senses).collect()).collect()
}

#[test]
fn the_observer_tells_the_six_plates_as_the_study_s_participants_did() {
    println!("observer {}", constants::constants_sha256());
    let (known, asked) = (lot(50_000, TEMPLATES), lot(90_000, TRIALS));
    let chance = 1.0 / PLATES.len() as f64;
    let independent = PLATES.len() * TRIALS as usize;
    let chance_se = (chance * (1.0 - chance) / independent as f64).sqrt();
    for (condition, senses) in CONDITIONS {
        let (templates, trials) = (seen(&known, senses), seen(&asked, senses));
        for kappa in [0.0, 0.5, 1.0, 2.0] {
            let judge = Judge::new(templates.clone(), kappa);
            let confusion = Confusion::of(&judge, &trials, if kappa == 0.0 { 1 } else { 10 }, 11);
            let each: Vec<String> = (0..6).map(|plate| format!("{:.2}", confusion.right(plate))).collect();
            println!("{condition:>6}, κ = {kappa}: mean {:.3}; {}", confusion.mean(), each.join(" "));
            if kappa == 1.0 {
                confusion.counts.iter().zip(PLATES).for_each(|(row, plate)| println!("{plate:>12} {row:?}"));
            }
        }
        // Templates dealt out to the plates in turn: nothing is left to learn.
        let mut shuffled = vec![Vec::new(); PLATES.len()];
        for (n, template) in templates.iter().flatten().enumerate() {
            shuffled[(n * 7 + n / 6) % PLATES.len()].push(template.clone());
        }
        let confusion = Confusion::of(&Judge::new(shuffled, 1.0), &trials, 10, 13);
        println!("{condition:>6}, shuffled labels: {:.3}", confusion.mean());
        assert!((confusion.mean() - chance).abs() < 2.0 * chance_se, "{condition}: {}", confusion.mean());
    }
    // A plate against itself.
    let mut right = 0.0;
    for (plate, trials) in known.iter().zip(&asked) {
        let half = |lot: &[[Percept; 2]], side: usize| -> Vec<Percept> {
            lot.iter().skip(side).step_by(2).map(|p| p[0].clone().and(&p[1])).collect()
        };
        let judge = Judge::new(vec![half(plate, 0), half(plate, 1)], 1.0);
        right +=
            Confusion::of(&judge, &[half(trials, 0), half(trials, 1)], 10, 17).mean() / PLATES.len() as f64;
    }
    println!("a plate against itself: {right:.3}");
    assert!((right - 0.5).abs() < 2.0 * (0.25 / independent as f64).sqrt(), "{right}");
}
