//! The six plates of Chan, Tymms and Colonnese 2021 and the seven materials of the solid-noise
//! paper, explored by a virtual hand through the engine and judged by both observers.
//!
//! An exploration is a stroke along u and one along v at random places, speeds (60–220 mm/s) and
//! forces (0.4–1 N), on a plate of PLA whose micro-relief has a seed of its own. The plate rings as
//! the stock disc of PLA does; a flat plate under 0.1 m/s and 1 N is heard at −32 dB re
//! [`LISTENING_PA`], the engine's own level.

use crate::observer::constants::LISTENING_PA;
use crate::observer::second::{self, Stroke, Trial};
use crate::observer::sound::{heard, threshold_pa2};
use crate::observer::touch::{Hand, Unit, felt};
use crate::observer::{Confusion, Judge, Percept};
use asperity::files::FileError;
use asperity::files::contact_log::{ContactLog, ContactSample, LogHand, LogLine, Names};
use asperity::offline::{self, Options, Render};
use asperity::surface::solid_materials::SolidMaterial;
use asperity::surface::solid_noise::SolidNoise;
use asperity::{
    ActuatorSettings, Body, Config, Engine, Excitation, Extent, Material, Roughness, Stock, Surface, Wrap,
};
use asperity_dsp::rng::Rng;
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Names of the plates.
pub const PLATES: [&str; 6] = ["matte-shiny", "shiny-matte", "ridge", "bumps", "sine", "sawtooth"];
/// Side of a surface, m.
const SIDE_M: f64 = 0.14;
/// Period of bumps, sine and sawtooth, m.
const PITCH_M: f64 = 0.007;
/// R of printed PLA.
const PLASTIC: f64 = 0.5;
/// Level of a flat plate under the reference stroke, dB re full scale.
const REFERENCE_DB: f64 = -32.0;
/// Samples of the haptic channel that make one: touch ends at 1 kHz.
const EVERY: usize = 8;

/// Senses of a condition.
pub const CONDITIONS: [(&str, &[usize]); 3] = [("touch", &[0]), ("sound", &[1]), ("both", &[0, 1])];

/// Height of a plate at a place, m; any other name is a flat one.
#[must_use]
pub fn height_m(plate: &str, x: f64, y: f64) -> f64 {
    let phase = (x / PITCH_M).fract();
    match plate {
        "ridge" => {
            let across = (x - 0.5 * SIDE_M) / 0.009;
            if across.abs() < 1.0 { 0.002 * (1.0 + (PI * across).cos()) } else { 0.0 }
        }
        "bumps" => {
            let radius = (phase - 0.5).hypot((y / PITCH_M).fract() - 0.5) / 0.45;
            if radius < 1.0 { 0.0005 * (1.0 + (PI * radius).cos()) } else { 0.0 }
        }
        "sine" => 0.0005 * (1.0 - (2.0 * PI * phase).cos()),
        "sawtooth" => 0.001 * if phase < 0.94 { phase / 0.94 } else { (1.0 - phase) / 0.06 },
        _ => 0.0,
    }
}

/// R of a plate at a place: halves that are glossy and matte, or printed PLA.
#[must_use]
pub fn roughness(plate: &str, x: f64) -> f64 {
    match plate.contains("matte") {
        false => PLASTIC,
        true if (x < 0.5 * SIDE_M) == (plate == "matte-shiny") => 0.9,
        true => 0.1,
    }
}

/// A plate of the study; any other name is a flat one.
///
/// # Errors
/// When the engine refuses it.
pub fn plate(name: &str) -> Result<Surface, FileError> {
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let map = |side: usize, of: &dyn Fn(f64, f64) -> f64| {
        let texel = SIDE_M / side as f64;
        let raster =
            Raster::from_fn(side, side, |x, y| of((x as f64 + 0.5) * texel, (y as f64 + 0.5) * texel));
        HeightMap::new(&raster, extent, Wrap::Clamp).map_err(FileError::from_error)
    };
    let rough = map(128, &|x, _| roughness(name, x))?;
    let surface = Surface::new(map(512, &|x, y| height_m(name, x, y))?, SIDE_M, SIDE_M);
    Ok(surface.map_err(FileError::from_error)?.roughness(Roughness::Map(Box::new(rough))))
}

/// One of the seven materials, a piece of its own.
///
/// # Errors
/// When the engine refuses it.
pub fn material(material: SolidMaterial, seed: u64) -> Result<Surface, FileError> {
    let source = SolidNoise::new(material.parameters(), seed).map_err(FileError::from_error)?;
    Surface::new(source, SIDE_M, SIDE_M).map_err(FileError::from_error)
}

/// A stroke: times, place where it begins, axis, speed, force.
#[derive(Debug, Clone, Copy)]
struct Way {
    from_s: f64,
    to_s: f64,
    from: [f64; 2],
    axis: usize,
    speed_m_s: f64,
    force_n: f64,
}

impl Way {
    fn place(&self, t: f64) -> [f64; 2] {
        let mut uv = self.from;
        uv[self.axis] += self.speed_m_s * (t.clamp(self.from_s, self.to_s) - self.from_s) / SIDE_M;
        uv
    }

    fn lines(&self) -> Vec<LogLine> {
        let mut velocity = [0.0; 2];
        velocity[self.axis] = self.speed_m_s;
        let times = (0..((self.to_s - self.from_s) * 60.0) as usize).map(|n| self.from_s + n as f64 / 60.0);
        let samples = times.map(|t| (t, ContactSample::new(self.place(t), self.force_n).sliding(velocity)));
        LogLine::contact(self.axis as u64, ("s", LogHand::felt_by(0)), samples, self.to_s)
    }
}

/// Two strokes, along u and along v.
#[derive(Debug, Clone, Copy)]
pub struct Exploration([Way; 2]);

impl Exploration {
    /// Places, speeds and forces of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let mut at_s = 0.05;
        Self([0, 1].map(|axis| {
            let speed_m_s = 0.06 + 0.16 * rng.uniform();
            let force_n = 0.4 + 0.6 * rng.uniform();
            let mut from = [0.08 + 0.04 * rng.uniform(), 0.2 + 0.6 * rng.uniform()];
            if axis == 1 {
                from.swap(0, 1);
            }
            let to_s = at_s + 0.8 * SIDE_M / speed_m_s;
            let way = Way { from_s: at_s, to_s, from, axis, speed_m_s, force_n };
            at_s = way.to_s + 0.1;
            way
        }))
    }

    /// The strokes as they are reported, on surface "s".
    #[must_use]
    pub fn log(&self) -> ContactLog {
        ContactLog { lines: self.0.iter().flat_map(Way::lines).collect() }
    }

    /// Percepts of its render; `pascals` of a sample of sound; `placed` where the task gives the
    /// place of the hand.
    #[must_use]
    pub fn percepts(&self, render: &Render, pascals: f64, placed: bool) -> Explored {
        let ways = self.0;
        let audio_hz = render.sample_rate_hz;
        let haptic_hz = audio_hz / EVERY as f64;
        let mean = |x: &[f32]| x.iter().map(|x| f64::from(*x)).sum::<f64>() / EVERY as f64;
        let haptic: Vec<f64> = render.haptic[0].chunks_exact(EVERY).map(mean).collect();
        let audio: Vec<f64> = render.audio[0].iter().map(|x| pascals * f64::from(*x)).collect();
        let hand = |samples: std::ops::Range<usize>, rate_hz: f64| -> (Vec<[f64; 2]>, Vec<usize>) {
            let at = |n: usize| {
                let t = n as f64 / rate_hz;
                let way = &ways[usize::from(t > ways[0].to_s + 0.05)];
                (way.place(t), way.axis)
            };
            samples.map(at).unzip()
        };
        let percepts = |from_s: f64, to_s: f64| {
            let piece = |signal: &[f64], rate_hz: f64| {
                let at = |s: f64| ((s * rate_hz) as usize).min(signal.len());
                at(from_s)..at(to_s)
            };
            let (h, a) = (piece(&haptic, haptic_hz), piece(&audio, audio_hz));
            let (place, axis) = hand(h.clone(), haptic_hz);
            let known = placed.then_some(Hand { place: &place, axis: &axis });
            let touched = felt(&haptic[h], haptic_hz, Unit::Displacement, known);
            let (place, axis) = hand(a.clone(), audio_hz);
            let known = placed.then_some(Hand { place: &place, axis: &axis });
            [touched, heard(&audio[a.clone()], audio_hz, None, known)].map(|percept| (percept, a.clone()))
        };
        let whole = percepts(0.0, f64::INFINITY).map(|(percept, _)| percept);
        let strokes = ways.map(|way| {
            let [(touch, _), (mut ear, piece)] = percepts(way.from_s, way.to_s);
            let rhythm = second::rhythm(&audio[piece], audio_hz, way.speed_m_s, |f| 1.0 / threshold_pa2(f));
            ear.features.extend(rhythm);
            Stroke { senses: [touch, ear], hand: [way.speed_m_s.ln(), way.force_n.ln()] }
        });
        Explored { first: whole, second: strokes.to_vec() }
    }
}

/// Percepts of one exploration, for both observers.
#[derive(Debug, Clone)]
pub struct Explored {
    /// By touch and by ear, as the first observer takes it.
    pub first: [Percept; 2],
    /// Stroke by stroke, as the second does.
    pub second: Trial,
}

fn play(surface: Surface, log: &ContactLog, seed: u64) -> Result<Render, FileError> {
    let config = Config {
        seed,
        actuators: vec![ActuatorSettings { full_scale: 1.0, ..ActuatorSettings::default() }],
        ..Config::default()
    };
    let Engine { mut scene, renderer, .. } = config.build().map_err(FileError::from_error)?;
    let body = Body::stock(Stock::Disc, Material::PLA, SIDE_M).map_err(FileError::from_error)?;
    let body = scene.add_body(body).map_err(FileError::from_error)?;
    let surface = surface.body(body).excitation(Excitation::BOTH);
    let id = scene.add_surface(surface).map_err(FileError::from_error)?;
    let names = Names { surfaces: HashMap::from([("s".to_owned(), id)]), ..Names::default() };
    let options = Options { tail_s: 0.0, ..Options::default() };
    offline::render(scene, renderer, log, &names, &options).map_err(FileError::from_error)
}

/// Pascals of a sample: the reference stroke over a flat plate lies at `REFERENCE_DB`.
///
/// # Errors
/// When the engine refuses the plate.
pub fn pascals() -> Result<f64, FileError> {
    let way = Way { from_s: 0.05, to_s: 1.05, from: [0.1, 0.5], axis: 0, speed_m_s: 0.1, force_n: 1.0 };
    let audio = &play(plate("flat")?, &ContactLog { lines: way.lines() }, 1)?.audio[0];
    let power = audio.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / audio.len().max(1) as f64;
    Ok(LISTENING_PA * 10f64.powf(REFERENCE_DB / 20.0) / power.sqrt())
}

/// Explores a surface; `placed` where the task gives the place of the hand.
///
/// # Errors
/// When the engine refuses the surface.
pub fn explore(surface: Surface, seed: u64, pascals: f64, placed: bool) -> Result<Explored, FileError> {
    let exploration = Exploration::new(seed);
    Ok(exploration.percepts(&play(surface, &exploration.log(), seed)?, pascals, placed))
}

/// Table of one observer under one condition.
#[derive(Debug, Clone)]
pub struct Table {
    /// `first` or `second`.
    pub observer: &'static str,
    /// Senses.
    pub condition: &'static str,
    /// Answers at κ = 1.
    pub confusion: Confusion,
    /// Mean share of right answers at κ = ½, 2 and 0.
    pub other_kappa: [f64; 3],
    /// Share of right answers where templates are dealt out to the classes in turn.
    pub shuffled: f64,
}

/// Makes a surface of a class by a seed.
pub type Make = Box<dyn Fn(u64) -> Result<Surface, FileError>>;

/// The six plates.
#[must_use]
pub fn six_plates() -> Vec<Make> {
    PLATES.iter().map(|name| Box::new(move |_| plate(name)) as Make).collect()
}

/// The seven materials.
#[must_use]
pub fn seven_materials() -> Vec<Make> {
    SolidMaterial::SEVEN.into_iter().map(|one| Box::new(move |seed| material(one, seed)) as Make).collect()
}

/// Explorations that both observers have learnt, and those that they are asked, class by class.
///
/// # Errors
/// When the engine refuses a surface.
pub fn lots(surfaces: &[Make], asked: u64, placed: bool) -> Result<[Vec<Vec<Explored>>; 2], FileError> {
    let pascals = pascals()?;
    let known = lot(surfaces, (150_000, 16), pascals, placed)?;
    Ok([known, lot(surfaces, (190_000, asked), pascals, placed)?])
}

/// Explorations of each class from a seed on.
///
/// # Errors
/// When the engine refuses a surface.
pub fn lot(
    surfaces: &[Make],
    (from, count): (u64, u64),
    pascals: f64,
    placed: bool,
) -> Result<Vec<Vec<Explored>>, FileError> {
    let of = |(index, surface): (usize, &Make)| {
        let seeds = (0..count).map(|n| from + 1000 * index as u64 + n);
        seeds.map(|seed| explore(surface(seed)?, seed, pascals, placed)).collect()
    };
    surfaces.iter().enumerate().map(of).collect()
}

/// Classes with their templates dealt out in turn: nothing is left to learn.
fn dealt<T: Clone>(classes: &[Vec<T>]) -> Vec<Vec<T>> {
    let count = classes.len();
    let mut out = vec![Vec::new(); count];
    for (n, template) in classes.iter().flatten().enumerate() {
        out[(n * (count + 1) + n / count) % count].push(template.clone());
    }
    out
}

/// Both observers' tables of the classes, for some conditions; each trial is asked ten times.
#[must_use]
pub fn judge(
    known: &[Vec<Explored>],
    asked: &[Vec<Explored>],
    conditions: &[(&'static str, &[usize])],
) -> Vec<Table> {
    let repeats = |kappa: f64| if kappa == 0.0 { 1 } else { 10 };
    let mut tables = Vec::new();
    for (condition, senses) in conditions {
        let percepts = |lot: &[Vec<Explored>]| -> Vec<Vec<Percept>> {
            let one = |e: &Explored| senses.iter().fold(Percept::default(), |all, s| all.and(&e.first[*s]));
            lot.iter().map(|class| class.iter().map(one).collect()).collect()
        };
        let (templates, trials) = (percepts(known), percepts(asked));
        let ask = |templates: &[Vec<Percept>], kappa: f64, seed: u64| {
            Confusion::of(&Judge::new(templates.to_vec(), kappa), &trials, repeats(kappa), seed)
        };
        tables.push(Table {
            observer: "first",
            condition,
            confusion: ask(&templates, 1.0, 11),
            other_kappa: [0.5, 2.0, 0.0].map(|kappa| ask(&templates, kappa, 11).mean()),
            shuffled: ask(&dealt(&templates), 1.0, 13).mean(),
        });
    }
    let strokes = |lot: &[Vec<Explored>]| -> Vec<Vec<Trial>> {
        lot.iter().map(|class| class.iter().map(|e| e.second.clone()).collect()).collect()
    };
    let (templates, trials) = (strokes(known), strokes(asked));
    let judges = [1.0, 0.5, 2.0, 0.0].map(|kappa| (kappa, second::Judge::new(templates.clone(), kappa)));
    let shuffled = second::Judge::new(dealt(&templates), 1.0);
    for (condition, senses) in conditions {
        let ask = |(kappa, judge): &(f64, second::Judge)| judge.ask(&trials, senses, repeats(*kappa), 11);
        tables.push(Table {
            observer: "second",
            condition,
            confusion: ask(&judges[0]),
            other_kappa: [1, 2, 3].map(|other| ask(&judges[other]).mean()),
            shuffled: shuffled.ask(&trials, senses, 10, 13).mean(),
        });
    }
    tables
}

/// Share of right answers of both observers who tell half of a class's explorations from the other
/// half, all senses together: chance is one half.
#[must_use]
pub fn against_itself(known: &[Vec<Explored>], asked: &[Vec<Explored>]) -> [f64; 2] {
    let halves =
        |lot: &[Explored]| [0, 1].map(|side| lot.iter().skip(side).step_by(2).cloned().collect::<Vec<_>>());
    let mut right = [0.0; 2];
    for (known, asked) in known.iter().zip(asked) {
        let tables = judge(&halves(known), &halves(asked), &CONDITIONS[2..]);
        for (sum, table) in right.iter_mut().zip(&tables) {
            *sum += table.confusion.mean();
        }
    }
    right.map(|sum| sum / known.len().max(1) as f64)
}
