//! The shipped defaults forget: a path moved by 1e-12 m is felt and heard the same. Where a contact bounces for good it would be chaotic
//! instead, and only levels could be compared.

mod common;

use asperity::files::contact_log::{ContactLog, LogEvent};
use asperity::offline::Options;
use asperity::texture::solid_materials::SolidMaterial;
use asperity::texture::solid_noise::SolidNoise;
use asperity::{Config, Surface};
use common::{SIDE_M, grating, plate, render, rms, stroke};

/// The same stroke 1e-12 m further along u.
fn moved(log: &ContactLog, width_m: f64) -> ContactLog {
    let mut log = log.clone();
    for line in &mut log.lines {
        if let LogEvent::Begin { sample, .. } | LogEvent::Move { sample, .. } = &mut line.event {
            sample.uv[0] += 1e-12 / width_m;
        }
    }
    log
}

/// Level of the difference, dB: felt and heard.
fn difference_db(make: &dyn Fn() -> Surface, speed_m_s: f64, force_n: f64) -> [f64; 2] {
    let log = stroke(SIDE_M, speed_m_s, force_n, 1.0);
    let one = render(Config::default(), make(), &log, &Options::default());
    let other = render(Config::default(), make(), &moved(&log, SIDE_M), &Options::default());
    let db = |a: &[f32], b: &[f32]| {
        let apart: Vec<f32> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        20.0 * (rms(&apart) / rms(a)).max(1e-12).log10()
    };
    [db(&one.haptic[0], &other.haptic[0]), db(&one.audio[0], &other.audio[0])]
}

fn solid(material: SolidMaterial) -> Surface {
    Surface::new(SolidNoise::new(material.parameters(), 5).unwrap(), SIDE_M, SIDE_M).unwrap()
}

#[test]
fn a_path_moved_by_a_picometre_gives_the_same_render_with_the_shipped_defaults() {
    let polished = || plate(0.1);
    let matte = || plate(0.9);
    let coarse = || grating(7e-3, 2e-4);
    let fine = || grating(2e-3, 1e-5);
    let granite = || solid(SolidMaterial::Granite);
    let wood = || solid(SolidMaterial::Wood);
    let surfaces: [(&str, &dyn Fn() -> Surface); 6] = [
        ("polished", &polished),
        ("matte", &matte),
        ("grating of 7 mm", &coarse),
        ("grating of 2 mm", &fine),
        ("granite", &granite),
        ("wood", &wood),
    ];
    for (name, make) in surfaces {
        for (speed_m_s, force_n) in [(0.05, 0.5), (0.1, 0.6), (0.2, 1.0)] {
            let [felt_db, heard_db] = difference_db(make, speed_m_s, force_n);
            println!("{name}, {speed_m_s} m/s, {force_n} N: felt {felt_db:.0} dB, heard {heard_db:.0} dB");
            assert!(felt_db.max(heard_db) < -80.0, "{name}: felt {felt_db} dB, heard {heard_db} dB");
        }
    }
}
