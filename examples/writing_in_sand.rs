//! A finger writes a word into a box of sand: what is heard and felt, the force on the finger, and
//! the sand afterwards.
//!
//! ```sh
//! cargo run --release --example writing_in_sand [FOLDER]     # default writing_in_sand/
//! ```
//!
//! Writes sand.audio.wav, sand.haptic.wav, forces.svg, sand.png (lit from the top left) and
//! sand.heights.png (16 bits).

#[path = "surfaces/mod.rs"]
mod surfaces;

use asperity::files::contact_log::{ContactLog, Names};
use asperity::offline::{self, Options};
use asperity::surface::sand::{SandDesign, SandSource, Tool};
use asperity::{ActuatorSettings, AudioBus, Config, Surface};
use std::collections::HashMap;
use std::error::Error;
use surfaces::{Forces, Hand};

const SIDE_M: f64 = 0.38;
const CELLS: usize = 760;
const RATE_HZ: f64 = 44_100.0;

/// The letters s, a, n, d as lines on a field one wide and two high, x to the right and y down.
const LETTERS: [&[[f64; 2]]; 4] = [
    &[[0.85, 1.1], [0.5, 1.0], [0.15, 1.15], [0.2, 1.4], [0.75, 1.55], [0.85, 1.8], [0.5, 2.0], [0.1, 1.85]],
    &[[0.85, 1.15], [0.5, 1.0], [0.15, 1.25], [0.15, 1.75], [0.5, 2.0], [0.8, 1.8], [0.85, 1.05], [0.9, 2.0]],
    &[[0.1, 1.0], [0.15, 2.0], [0.15, 1.4], [0.45, 1.05], [0.75, 1.15], [0.85, 1.5], [0.85, 2.0]],
    &[[0.85, 1.2], [0.5, 1.0], [0.15, 1.3], [0.2, 1.8], [0.5, 2.0], [0.8, 1.8], [0.85, 0.2], [0.9, 2.0]],
];

/// The same line without corners: every corner is cut three times at a quarter of its sides.
fn rounded(line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut line = line.to_vec();
    for _ in 0..3 {
        let ends = (line[0], line[line.len() - 1]);
        let cut = |a: [f64; 2], b: [f64; 2], t: f64| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
        let inner = line.windows(2).flat_map(|p| [cut(p[0], p[1], 0.25), cut(p[0], p[1], 0.75)]);
        line = std::iter::once(ends.0).chain(inner).chain([ends.1]).collect();
    }
    line
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = surfaces::folder("writing_in_sand")?;
    let hand = Hand { side_m: SIDE_M, speed_m_s: 0.2, normal_force_n: 3.5, surface: "sand" };
    let mut log = ContactLog { lines: Vec::new() };
    let mut now_s = 0.1;
    for (n, letter) in LETTERS.iter().enumerate() {
        let place = |p: &[f64; 2]| [0.018 + 0.088 * n as f64 + 0.078 * p[0], 0.02 + 0.125 * p[1]];
        let line = rounded(&letter.iter().map(place).collect::<Vec<_>>());
        now_s = hand.draw(&mut log, n as u64 + 1, &line, now_s) + 0.25;
    }

    let config = Config {
        sample_rate_hz: RATE_HZ,
        actuators: vec![ActuatorSettings { full_scale: 1.0, ..ActuatorSettings::default() }],
        audio: vec![AudioBus { gain: 20.0, ..AudioBus::default() }],
        ..Config::default()
    };
    let asperity::Engine { mut scene, renderer, .. } = config.build()?;
    let board = scene.add_body(surfaces::board()?)?;
    let design = SandDesign {
        width_m: SIDE_M,
        height_m: SIDE_M,
        cells: CELLS,
        depth_m: 0.03,
        tool: Tool::Sphere { radius_m: 0.006 },
        ..SandDesign::default()
    };
    let sand = Surface::new(SandSource::synchronous(&design, 1)?, SIDE_M, SIDE_M)?;
    let surface = scene.add_surface(sand.wraps(false).body(board))?;
    let names = Names { surfaces: HashMap::from([("sand".to_owned(), surface)]), ..Names::default() };
    let mut forces = Forces::new(RATE_HZ);
    let options = Options { tail_s: 0.3, ..Options::default() };
    let take = offline::render_tapped(scene, renderer, &log, &names, &options, &mut forces)?;

    take.write_audio_wav(folder.join("sand.audio.wav"))?;
    take.write_haptic_wav(folder.join("sand.haptic.wav"))?;
    surfaces::plot(&[("finger in sand", forces.means_n())], &folder.join("forces.svg"))?;
    let after = take.sand.first().ok_or("no sand came back")?;
    let (raster, range_m) = (&after.picture.raster, 65_535.0 * after.picture.metres_per_grey);
    let side = raster.width;
    let lit = surfaces::lit(side, SIDE_M / side as f64, |x, y| range_m * raster.at(x, y));
    image::save_buffer(
        folder.join("sand.png"),
        &lit,
        side as u32,
        raster.height as u32,
        image::ExtendedColorType::L8,
    )?;
    let grey: Vec<u8> =
        raster.values.iter().flat_map(|h| ((h * 65_535.0).round() as u16).to_ne_bytes()).collect();
    let heights = folder.join("sand.heights.png");
    image::save_buffer(heights, &grey, side as u32, raster.height as u32, image::ExtendedColorType::L16)?;
    let figures = after.figures;
    println!(
        "{:.1} s; {:.6} l of sand before, {:.6} l after ({} units of drift); steepest slope {:.2}°; relief {:.1} mm",
        take.duration_s(),
        1e3 * figures.volume_before_m3,
        1e3 * figures.volume_after_m3,
        figures.drift_units,
        figures.max_slope_deg,
        1e3 * range_m
    );
    println!("wrote {}", folder.display());
    Ok(())
}
