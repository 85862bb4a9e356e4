//! Studies of the sources, ready to be asked, and what the sources found.
//!
//! | name | asks | source |
//! |---|---|---|
//! | six-plates | which of six plates | Chan, Tymms and Colonnese 2021, §IV: 8 people, 3 trials a plate and condition |
//! | seven-materials | how real and how fitting, which of seven materials | solid-noise textures: 16 people, 7 materials, one by one |
//! | metamers | ABX of five reliefs, and of the same made alike | metamers of tactile textures: 10 people, two matrices of pairs |
//! | heights | how rough, three heights of two patterns | haptic textures from pictures: ratings of variants × 1, 2, 4 |
//! | dimension | how rough, by fractal dimension | the same: ratings against the dimension of Brownian surfaces |

use super::spec::Protocol;
use crate::demo::plates::{PLATES, Plate};
use crate::demo::scenes::{plate_modes, plate_scene};
use crate::demo::strokes::{Finger, log};
use crate::error::CliError;
use crate::output::Outputs;
use asperity::surface::solid_materials::SolidMaterial;
use asperity_dsp::rng::Rng;
use asperity_evidence::compare::all_like_the_first;
use asperity_pictures::metamer::Method;
use asperity_plot::pixels;
use asperity_surface::raster::Raster;
use asperity_surface::solid_noise::{SolidCut, SolidNoise};
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

/// Names for the command line.
pub const NAMES: [&str; 5] = ["six-plates", "seven-materials", "metamers", "heights", "dimension"];
/// Takes of each stimulus: other strokes, other micro-relief.
const TAKES: u64 = 3;
/// Side of a surface that is stroked, m.
const SIDE_M: f64 = 0.14;
/// Texels a side of the reliefs of metamers and heights, and that side, m.
const TEXELS: usize = 128;
/// See [`TEXELS`].
const MAP_M: f64 = 0.04;
/// The five reliefs of the metamers; the first is the one the others are made like.
const RELIEFS: [&str; 5] = ["dots", "weave", "ribs", "bricks", "waves"];
/// Materials whose names the answers sort by.
const MATERIALS: [SolidMaterial; 7] = SolidMaterial::SEVEN;

/// Place of a name among those of a source; names of no source come last.
pub fn order(name: &str) -> usize {
    let plates = PLATES.iter().map(|plate| plate.name);
    let all: Vec<&str> = plates.chain(MATERIALS.iter().map(|material| material.name())).collect();
    all.iter().position(|one| *one == name).unwrap_or(all.len())
}

/// The source's figures for answers on these stimuli; null where there is none.
pub fn paper(protocol: Protocol, labels: &[String]) -> Value {
    let are = |names: &[&str]| {
        names.len() == labels.len() && names.iter().all(|name| labels.iter().any(|one| one == name))
    };
    let plates: Vec<&str> = PLATES.iter().map(|plate| plate.name).collect();
    let materials: Vec<&str> = MATERIALS.iter().map(|material| material.name()).collect();
    match protocol {
        Protocol::Identification if are(&plates) => json!({
            "source": "Chan, Tymms and Colonnese 2021, Fig. 10: each plate above 0.60, 0.85 on average, both senses best",
            "n": 8, "share_correct": 0.85, "each_above": 0.60, "most_confused": ["bumps", "sine"],
        }),
        Protocol::Identification if are(&materials) => json!({
            "source": "seven solid-noise materials: 95 of 112 right, gravel and pebbles 0.938, wood and granite least",
            "n": 16, "share_correct": 0.848, "ci95": [0.77, 0.91], "best": ["gravel", "pebbles"], "least": ["wood", "granite"],
        }),
        Protocol::Rating if are(&materials) => json!({
            "source": "seven solid-noise materials: realism and correspondence above 85 of 100 for each",
            "n": 16, "each_above": 85.0,
        }),
        _ => Value::Null,
    }
}

/// Files of an example so far.
struct Example<'a> {
    folder: &'a Path,
    outputs: Outputs,
    study: String,
}

/// Writes DIR/study.toml and what it names.
///
/// # Errors
/// When a file cannot be written.
pub fn write(name: &str, folder: &Path) -> Result<(), CliError> {
    let mut example = Example { folder, outputs: Outputs::new(), study: String::new() };
    match name {
        "six-plates" => example.six_plates()?,
        "seven-materials" => example.seven_materials()?,
        "metamers" => example.metamers()?,
        "heights" => example.heights()?,
        _ => example.dimension()?,
    }
    example.outputs.write(&folder.join("study.toml"), example.study.as_bytes())?;
    example.outputs.commit()?;
    Ok(())
}

impl Example<'_> {
    fn file(&mut self, name: &str, bytes: &[u8]) -> Result<(), CliError> {
        self.outputs.write(&self.folder.join(name), bytes)
    }

    fn head(&mut self, title: &str, protocol: &str, trials: u64, more: &str) {
        let _ = write!(
            self.study,
            "title = \"{title}\"\nprotocol = \"{protocol}\"\ntrials = {trials}\nseed = 1\n\
             senses = \"sound\"          # or \"touch\", \"both\": then plug in an actuator\nattention = 2\n{more}"
        );
    }

    fn stimulus(&mut self, name: &str, scene: &str, more: &str) {
        let _ = write!(self.study, "\n[[stimulus]]\nname = \"{name}\"\nscene = \"{scene}\"\n{more}");
    }

    /// A surface stroked along both axes: scene, log, stimulus.
    fn stroked(
        &mut self,
        name: &str,
        file: &str,
        (seed, side_m): (u64, f64),
        toml: &str,
        more: &str,
    ) -> Result<(), CliError> {
        self.file(&format!("{file}.jsonl"), strokes(seed, side_m).to_jsonl().as_bytes())?;
        self.file(
            &format!("{file}.toml"),
            format!("contacts = \"{file}.jsonl\"\nseed = {seed}\n{toml}").as_bytes(),
        )?;
        self.stimulus(name, &format!("{file}.toml"), more);
        Ok(())
    }

    fn six_plates(&mut self) -> Result<(), CliError> {
        self.head("Six plates", "identification", 3, "question = \"Which plate was stroked?\"\n");
        self.file("plate.modes.json", plate_modes().to_json().as_bytes())?;
        for plate in &PLATES {
            let scene = plate_scene(plate);
            for (name, bytes) in &scene.assets {
                self.file(name, bytes)?;
            }
            let name = plate.name;
            self.file(&format!("{name}.png"), &picture(plate))?;
            let toml = scene.toml.replace(&format!("contacts = \"{name}.jsonl\"\n"), "");
            for take in 1..=TAKES {
                let seed = take + 10 * order(name) as u64;
                self.stroked(
                    name,
                    &format!("{name}-{take}"),
                    (seed, SIDE_M),
                    &toml,
                    &format!("picture = \"{name}.png\"\n"),
                )?;
            }
        }
        Ok(())
    }

    /// Ratings beside a picture; the identification is a file of its own.
    fn seven_materials(&mut self) -> Result<(), CliError> {
        self.head(
            "Seven materials: which is it?",
            "identification",
            1,
            "question = \"Which material was stroked?\"\n",
        );
        for (index, material) in MATERIALS.into_iter().enumerate() {
            let name = material.name();
            let file = name.replace(' ', "-");
            self.file(&format!("{file}.png"), &solid_picture(material)?)?;
            for take in 1..=TAKES {
                let toml = surface(&format!("solid = \"{name}\"\nmicro_relief_m = 0.0\n"), SIDE_M);
                self.stroked(name, &format!("{file}-{take}"), (10 * index as u64 + take, SIDE_M), &toml, "")?;
            }
        }
        // Named by touch or ear alone, rated beside the picture of what it shall be.
        let mut stimuli = self.study[self.study.find("\n[[").unwrap_or(0)..].to_owned();
        for name in MATERIALS.map(SolidMaterial::name) {
            let line = format!("name = \"{name}\"\n");
            let picture = format!("{line}picture = \"{}.png\"\n", name.replace(' ', "-"));
            stimuli = stimuli.replace(&line, &picture);
        }
        let asked = std::mem::take(&mut self.study);
        self.head("Seven materials: how real?", "rating", 1, "scales = [\"realism\", \"correspondence\"]\nquestion = \"Compared with the material in the picture, from 0 (not at all) to 100 (completely)\"\n");
        let ratings = std::mem::replace(&mut self.study, asked) + &stimuli;
        self.file("ratings.toml", ratings.as_bytes())
    }

    fn metamers(&mut self) -> Result<(), CliError> {
        self.head("Metamers", "abx", 4, "");
        let originals: Vec<Raster> = RELIEFS.iter().map(|name| relief(name)).collect();
        let alike = all_like_the_first(&originals, Method::Iterated(4), |_| {})
            .map_err(|(_, error)| CliError::from_error(error))?;
        for (set, letter, maps) in [("originals", 'O', &originals), ("metamers", 'M', &alike)] {
            for (index, map) in maps.iter().enumerate() {
                let name = format!("{letter}{}", index + 1);
                self.map(&name, &name, map, 5e-4, &format!("set = \"{set}\"\n"), index as u64)?;
            }
        }
        Ok(())
    }

    fn heights(&mut self) -> Result<(), CliError> {
        self.head("Heights", "rating", 2, "scales = [\"roughness\"]\nquestion = \"How rough is it, from 0 (smooth) to 100 (very rough)?\"\n");
        for (index, pattern) in ["dots", "weave"].into_iter().enumerate() {
            for factor in [1, 2, 4] {
                let relief_m = 0.0002 * f64::from(factor);
                let file = format!("{pattern}-{factor}");
                let seed = 1 + index as u64;
                self.map(&format!("{pattern} × {factor}"), &file, &relief(pattern), relief_m, "", seed)?;
            }
        }
        Ok(())
    }

    fn dimension(&mut self) -> Result<(), CliError> {
        self.head("Fractal dimension", "rating", 2, "scales = [\"roughness\"]\nquestion = \"How rough is it, from 0 (smooth) to 100 (very rough)?\"\n");
        for tenths in [1, 3, 5, 7, 9] {
            let hurst = f64::from(tenths) / 10.0;
            let toml = surface(
                &format!("brownian = {{ hurst = {hurst}, rms_m = 5e-5 }}\nmicro_relief_m = 0.0\n"),
                SIDE_M,
            );
            let name = format!("dimension {}", f64::from(30 - tenths) / 10.0);
            self.stroked(&name, &format!("hurst-{hurst}"), (7, SIDE_M), &toml, "")?;
        }
        Ok(())
    }

    #[allow(clippy::too_many_arguments)]
    fn map(
        &mut self,
        name: &str,
        file: &str,
        map: &Raster,
        relief_m: f64,
        more: &str,
        seed: u64,
    ) -> Result<(), CliError> {
        let grey: Vec<u16> =
            map.values.iter().map(|x| (x.clamp(0.0, 1.0) * 65_535.0).round() as u16).collect();
        self.file(&format!("{file}.png"), &pixels::png16(map.width, map.height, &grey))?;
        let keys = format!(
            "displacement = \"{file}.png\"\nrelief_m = {relief_m}\nroughness = 0.2\nwrap = \"repeat\"\n"
        );
        self.stroked(name, file, (seed, MAP_M), &surface(&keys, MAP_M), more)
    }
}

/// A surface of these keys on a plate of PLA; one level for all, so that they stay comparable.
fn surface(keys: &str, side_m: f64) -> String {
    format!(
        "tail_s = 0.3\n\n[[body]]\nname = \"plate\"\nstock = \"plate\"\nmaterial = \"pla\"\nsize_m = {SIDE_M}\n\n\
         [[surface]]\nname = \"plate\"\nbody = \"plate\"\nwidth_m = {side_m}\nheight_m = {side_m}\n{keys}\n\
         [[actuator]]\noutput = \"displacement\"\nfull_scale = 1e-3\n\n[audio]\ngain = 1.0\n"
    )
}

/// Across and back along u, then along v, at speeds and forces of the seed; a map of a smaller side
/// repeats.
fn strokes(seed: u64, side_m: f64) -> asperity::files::contact_log::ContactLog {
    let mut rng = Rng::new(seed);
    let mut near = |middle: f64| middle * (0.8 + 0.4 * rng.uniform());
    let row_m = near(0.07);
    let finger = Finger {
        contact: 1,
        surface: "plate",
        extent_m: [side_m; 2],
        start_s: 0.1,
        normal_force_n: near(0.6),
        from_m: [0.018, row_m],
        strokes: vec![
            ([0.122, row_m], near(0.09)),
            ([0.018, row_m], near(0.18)),
            ([near(0.035), 0.03], near(0.15)),
            ([near(0.035), 0.12], near(0.12)),
        ],
    };
    log(finger.lines())
}

/// A plate lit from the left: relief by its slope, what is matte with grain.
fn picture(plate: &Plate) -> Vec<u8> {
    let ((side, heights), (rough_side, rough)) = (plate.displacement(), plate.roughness());
    let size = 280;
    let mut rng = Rng::new(1);
    let grey = (0..size * size).map(|i| {
        let (x, y) = (i % size * (side - 4) / size, i / size * side / size);
        let slope = f64::from(heights[y * side + x + 3]) - f64::from(heights[y * side + x]);
        let matte = f64::from(rough[y * rough_side / side * rough_side + x * rough_side / side]) / 255.0;
        let grain = 90.0 * (matte - 0.5).max(0.0) * (rng.uniform() - 0.5);
        let gloss = if matte < 0.3 { 50.0 } else { 0.0 };
        (130.0 + 0.05 * slope + gloss + grain).clamp(0.0, 255.0) as u8
    });
    pixels::png8(size, size, &grey.collect::<Vec<u8>>())
}

/// A solid of 35 mm lit from the left: grey by its slope.
fn solid_picture(material: SolidMaterial) -> Result<Vec<u8>, CliError> {
    const PIXEL_M: f64 = 1.25e-4;
    let size = 280;
    let parameters = material.parameters();
    let noise = SolidNoise::new(parameters, 1).map_err(CliError::from_error)?;
    let height = |x: usize, y: usize| {
        noise.definition(&parameters, SolidCut::SLANTED.at([x, y].map(|n| PIXEL_M * n as f64)))
    };
    let slope = |i: usize| height(i % size + 1, i / size) - height(i % size, i / size);
    let slopes: Vec<f64> = (0..size * size).map(slope).collect();
    let rms = (slopes.iter().map(|x| x * x).sum::<f64>() / slopes.len() as f64).sqrt();
    let grey = slopes.iter().map(|x| (128.0 + 45.0 * x / rms).clamp(0.0, 255.0) as u8);
    Ok(pixels::png8(size, size, &grey.collect::<Vec<u8>>()))
}

/// A periodic relief of 40 mm, heights 0–1.
fn relief(name: &str) -> Raster {
    let wave = |x: f64| 0.5 - 0.5 * (TAU * x).cos();
    Raster::from_fn(TEXELS, TEXELS, |x, y| {
        let (u, v) = (x as f64 / TEXELS as f64, y as f64 / TEXELS as f64);
        match name {
            "dots" => {
                let (a, b) = ((16.0 * u).fract() - 0.5, (16.0 * v).fract() - 0.5);
                (1.0 - (a.hypot(b) / 0.45).powi(2)).max(0.0).sqrt()
            }
            "weave" => {
                let (a, b) = ((20.0 * u) as usize, (20.0 * v) as usize);
                if (a + b) % 2 == 0 {
                    wave(20.0 * u) * 0.6 + 0.4 * wave(10.0 * v)
                } else {
                    wave(20.0 * v) * 0.6 + 0.4 * wave(10.0 * u)
                }
            }
            "ribs" => (wave(12.0 * u) * 3.0).min(1.0),
            "bricks" => {
                let shift = if ((8.0 * v) as usize).is_multiple_of(2) { 0.0 } else { 0.5 };
                let joint = |x: f64| (x.fract().min(1.0 - x.fract()) * 12.0).min(1.0);
                joint(4.0 * u + shift).min(joint(8.0 * v))
            }
            _ => 0.5 * wave(6.0 * u + 0.3 * (TAU * 2.0 * v).sin()) + 0.5 * wave(5.0 * v),
        }
    })
}
