//! Four bodies around a listener: each plays on a bus of its own, and the game pans the buses.
//!
//! ```text
//! bus i → distance (1/r) → constant-power panning by the bearing (−90° left … +90° right) → stereo
//! ```
//! The engine knows no listener: it gives each body's sound apart, so that the game's own mixer,
//! reverb and head-related filters do the rest. This one is the smallest that is any use. Run
//! `cargo run --release --example four_bodies -- FOLDER`; it writes FOLDER/four_bodies.wav.

use asperity::files::wav::write_wav;
use asperity::{AudioBus, Body, BusId, Config, ContactEvent, Engine, Impact, Material, Stock};
use glam::DVec3;
use std::error::Error;
use std::f64::consts::FRAC_PI_4;
use std::path::PathBuf;

const RATE_HZ: f64 = 44_100.0;

/// Where a listener stands and looks.
struct Listener {
    position_m: DVec3,
    /// Of length 1.
    right: DVec3,
}

impl Listener {
    /// Gains of the left and the right channel for a source.
    fn gains(&self, source_m: DVec3) -> [f64; 2] {
        let towards = source_m - self.position_m;
        let distance_m = towards.length().max(0.1);
        // −1 left … 1 right, turned into 0 … 90° of constant power.
        let side = (towards / distance_m).dot(self.right);
        let angle = FRAC_PI_4 * (1.0 + side);
        [angle.cos() / distance_m, angle.sin() / distance_m]
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).map_or_else(|| PathBuf::from("."), PathBuf::from);
    let things = [
        (Stock::Bar, Material::WOOD, 0.3, DVec3::new(-2.0, 0.0, 0.5)),
        (Stock::Disc, Material::GLASS, 0.12, DVec3::new(-0.7, 0.0, 1.2)),
        (Stock::Tube, Material::STEEL, 0.35, DVec3::new(0.7, 0.0, 1.2)),
        (Stock::Bowl, Material::CERAMIC, 0.12, DVec3::new(2.0, 0.0, 0.5)),
    ];
    let config = Config { audio: vec![AudioBus::default(); things.len()], ..Config::default() };
    let Engine { mut scene, mut renderer, .. } = config.build()?;
    for (bus, (shape, material, size_m, _)) in things.iter().enumerate() {
        let body = scene.add_body(Body::stock(*shape, *material, *size_m)?.bus(BusId(bus)))?;
        scene.report(
            0.2 + 0.6 * bus as f64,
            ContactEvent::Impact(Impact::from_impulse(body, 0.002, 1.0, 0.6)),
        )?;
    }

    let frames = (3.5 * RATE_HZ) as usize;
    let mut stereo = [vec![0.0f32; frames], vec![0.0f32; frames]];
    for at in (0..frames).step_by(256) {
        let n = 256.min(frames - at);
        // The listener walks from left to right, looking along z.
        let walked = at as f64 / frames as f64;
        let listener = Listener { position_m: DVec3::new(2.0 * walked - 1.0, 0.0, 0.0), right: DVec3::X };
        let (mut buses, mut haptic) = ([[0.0f32; 256]; 4], [0.0f32; 256]);
        let mut slices = buses.each_mut().map(|bus| &mut bus[..n]);
        renderer.render(&mut [&mut haptic[..n]], &mut slices);
        for (bus, (.., position_m)) in buses.iter().zip(&things) {
            let gains = listener.gains(*position_m);
            for (channel, gain) in stereo.iter_mut().zip(gains) {
                for (out, x) in channel[at..at + n].iter_mut().zip(bus) {
                    *out += gain as f32 * x;
                }
            }
        }
    }

    std::fs::create_dir_all(&folder)?;
    let path = folder.join("four_bodies.wav");
    write_wav(&path, &[&stereo[0], &stereo[1]], RATE_HZ)?;
    // What a listener is to hear: each strike on its side.
    for (index, (_, material, _, position_m)) in things.iter().enumerate() {
        let from = ((0.2 + 0.6 * index as f64) * RATE_HZ) as usize;
        let level = |x: &[f32]| x[from..from + 4410].iter().map(|x| f64::from(*x).powi(2)).sum::<f64>();
        let balance_db = 10.0 * (level(&stereo[1]) / level(&stereo[0])).log10();
        println!(
            "{:>8} at x = {:+.1} m: right over left {balance_db:+.1} dB",
            material.name().unwrap_or_default(),
            position_m.x
        );
        assert_eq!(balance_db > 0.0, position_m.x > 0.0, "strike {index} is heard on the wrong side");
    }
    println!("{}", path.display());
    Ok(())
}
