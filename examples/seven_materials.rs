//! The seven materials of the solid-noise paper under one finger: what each sounds and feels like,
//! the force a force-feedback device would give, and how the surfaces look.
//!
//! ```sh
//! cargo run --release --example seven_materials [FOLDER]     # default seven_materials/
//! ```
//!
//! Writes NAME.audio.wav and NAME.haptic.wav (pad displacement, m) for each, forces.svg and
//! materials.png: 20 mm × 20 mm each, lit from the top left, every relief stretched to the same
//! slope (by the printed factor), because granite's would not be seen.

#[path = "surfaces/mod.rs"]
mod surfaces;

use asperity::files::contact_log::{ContactLog, Names};
use asperity::offline::{self, Options};
use asperity::surface::solid_materials::SolidMaterial;
use asperity::surface::solid_noise::{SolidCut, SolidNoise};
use asperity::{ActuatorSettings, Config, Surface};
use std::collections::HashMap;
use std::error::Error;
use surfaces::{Forces, Hand};

const SIDE_M: f64 = 0.12;
const RATE_HZ: f64 = 44_100.0;
/// Side of one surface in the picture, pixels and m.
const PICTURE: (usize, f64) = (200, 0.02);

/// Rms slope of every surface in the picture.
const SHOWN_SLOPE: f64 = 0.35;

/// Rms slope along the rows of the picture.
fn rms_slope(height_m: &impl Fn(usize, usize) -> f64, spacing_m: f64) -> f64 {
    let count = PICTURE.0 * PICTURE.0;
    let square = |i: usize| {
        let (x, y) = (i % PICTURE.0, i / PICTURE.0);
        ((height_m(x + 1, y) - height_m(x, y)) / spacing_m).powi(2)
    };
    ((0..count).map(square).sum::<f64>() / count as f64).sqrt()
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = surfaces::folder("seven_materials")?;
    let hand = Hand { side_m: SIDE_M, speed_m_s: 0.09, normal_force_n: 0.7, surface: "material" };
    let mut log = ContactLog { lines: Vec::new() };
    let over = [[0.015, 0.02], [0.105, 0.03], [0.1, 0.06], [0.02, 0.05], [0.015, 0.09], [0.105, 0.1]];
    hand.draw(&mut log, 1, &over, 0.05);

    let mut panels = Vec::new();
    let mut picture = image::GrayImage::new((7 * PICTURE.0) as u32, PICTURE.0 as u32);
    for (column, material) in SolidMaterial::SEVEN.into_iter().enumerate() {
        let (name, parameters) = (material.name(), material.parameters());
        let config = Config {
            sample_rate_hz: RATE_HZ,
            actuators: vec![ActuatorSettings { full_scale: 1.0, ..ActuatorSettings::default() }],
            ..Config::default()
        };
        let asperity::Engine { mut scene, renderer, .. } = config.build()?;
        let board = scene.add_body(surfaces::board()?)?;
        let noise = SolidNoise::new(parameters, 1)?;
        let spacing_m = PICTURE.1 / PICTURE.0 as f64;
        let height_m = |x: usize, y: usize| {
            let at = SolidCut::SLANTED.at([x as f64 * spacing_m, y as f64 * spacing_m]);
            parameters.amplitude_m * noise.definition(&parameters, at)
        };
        let stretch = SHOWN_SLOPE / rms_slope(&height_m, spacing_m);
        let lit = surfaces::lit(PICTURE.0, spacing_m, |x, y| stretch * height_m(x, y));
        for (i, grey) in lit.into_iter().enumerate() {
            let (x, y) = (column * PICTURE.0 + i % PICTURE.0, i / PICTURE.0);
            picture.put_pixel(x as u32, y as u32, image::Luma([grey]));
        }
        let surface = Surface::new(noise, SIDE_M, SIDE_M)?.wraps(false).micro_relief_m(0.0).body(board);
        let surface = scene.add_surface(surface)?;
        let names = Names { surfaces: HashMap::from([("material".to_owned(), surface)]), ..Names::default() };
        let mut forces = Forces::new(RATE_HZ);
        let options = Options { tail_s: 0.3, ..Options::default() };
        let take = offline::render_tapped(scene, renderer, &log, &names, &options, &mut forces)?;
        take.write_audio_wav(folder.join(format!("{name}.audio.wav")))?;
        take.write_haptic_wav(folder.join(format!("{name}.haptic.wav")))?;
        let rms = |x: &[f32]| (x.iter().map(|x| f64::from(x * x)).sum::<f64>() / x.len() as f64).sqrt();
        println!(
            "{name:12} haptic {:6.2} µm rms, audio {:.1e} rms, picture stretched {stretch:5.1} times",
            1e6 * rms(&take.haptic[0]),
            rms(&take.audio[0])
        );
        panels.push((name, forces.means_n()));
    }
    surfaces::plot(&panels, &folder.join("forces.svg"))?;
    picture.save(folder.join("materials.png"))?;
    println!("wrote {}", folder.display());
    Ok(())
}
