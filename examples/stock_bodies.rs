//! Stock bodies: one strike of every material as a bar, and of every shape in brass, without a
//! recording.
//!
//! Run `cargo run --release --example stock_bodies -- FOLDER`; it writes FOLDER/NAME.wav and a
//! table: the lowest mode, its T60, the level.

use asperity::files::wav::write_wav;
use asperity::{Body, Config, ContactEvent, Engine, Impact, Material, Stock};
use std::error::Error;
use std::path::PathBuf;

const RATE_HZ: f64 = 44_100.0;
/// Length of a strike, s.
const SECONDS: f64 = 3.0;
/// Longest side or diameter, m.
const SIZE_M: f64 = 0.3;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).map_or_else(|| PathBuf::from("."), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    println!("{:<14}{:>10}{:>9}{:>9}{:>10}", "body", "lowest Hz", "T60 s", "mass kg", "peak dB");
    for preset in Material::PRESETS {
        strike(&folder, &format!("bar of {}", preset.name), Stock::Bar, preset.material)?;
    }
    for (name, shape) in Stock::ALL {
        strike(&folder, &format!("brass {name}"), shape, Material::BRASS)?;
    }
    Ok(())
}

/// A blow of 2 g of wood, as of a small mallet, at 1 m/s.
fn strike(
    folder: &std::path::Path,
    name: &str,
    shape: Stock,
    material: Material,
) -> Result<(), Box<dyn Error>> {
    let Engine { mut scene, mut renderer, .. } = Config::default().build()?;
    let model = shape.modes(&material, SIZE_M)?;
    let lowest = model.modes.iter().min_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz)).copied();
    let body = scene.add_body(Body::new(model).material(material))?;
    let blow = Impact { mass_kg: 0.002, speed_m_s: 1.0, striker: Material::WOOD, ..Impact::on(body) };
    scene.report(0.05, ContactEvent::Impact(blow))?;

    let mut sound = vec![0.0f32; (SECONDS * RATE_HZ) as usize];
    let mut haptic = vec![0.0f32; sound.len()];
    renderer.render(&mut [&mut haptic], &mut [&mut sound]);
    write_wav(&folder.join(format!("{}.wav", name.replace(' ', "_"))), &[&sound], RATE_HZ)?;

    let peak = sound.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
    let (frequency_hz, t60_s) = lowest.map_or((0.0, 0.0), |mode| (mode.frequency_hz, mode.t60_s()));
    let mass_kg = shape.mass_kg(&material, SIZE_M);
    println!("{name:<16}{frequency_hz:>8.0}{t60_s:>9.2}{mass_kg:>9.3}{:>10.1}", 20.0 * peak.log10());
    Ok(())
}
