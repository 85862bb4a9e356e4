//! A bar and a plate struck at places, stroked across, held and let go: closed-form shapes, no file
//! needed.
//!
//! Run `cargo run --release --example struck_anywhere -- FOLDER`; it writes FOLDER/bar.wav and
//! FOLDER/plate.wav and a table: the level of each mode at each strike.

#[path = "../tests/common/closed_forms.rs"]
#[allow(dead_code)]
mod closed_forms;

use asperity::files::wav::write_wav;
use asperity::{
    ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Impact, Material, ModalModel, Surface,
    SurfaceFrame,
};
use closed_forms::{FREE_BAR, PLATE_M, bar, modes_file, plate, plate_orders};
use std::error::Error;
use std::f64::consts::TAU;
use std::path::PathBuf;

const RATE_HZ: f64 = 44_100.0;
/// From one strike to the next, s.
const BEAT_S: f64 = 1.5;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).map_or_else(|| PathBuf::from("."), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    let bar_hz = |m: usize| 260.0 * (FREE_BAR[m] / FREE_BAR[0]).powi(2);
    let shares = [0.0, 0.224, 0.5, 0.35];
    let places = shares.map(|x| [0.5 * x, 0.015, 0.0]);
    play(&folder.join("bar.wav"), &modes_file(&bar(), bar_hz, 3.0), [0.5, 0.03], &places, bar_hz, 4)?;
    let plate_hz = |m: usize| {
        let [a, b] = plate_orders(m);
        70.0 * (a * a + b * b * (PLATE_M[0] / PLATE_M[1]).powi(2))
    };
    let places = [[0.2, 0.15, 0.0], [0.1, 0.15, 0.0], [0.05, 0.04, 0.0], [0.3, 0.1, 0.0]];
    play(&folder.join("plate.wav"), &modes_file(&plate(), plate_hz, 4.0), PLATE_M, &places, plate_hz, 4)
}

/// Four strikes free, the last of them again while a finger presses, then a stroke right across.
fn play(
    wav: &std::path::Path,
    modes: &str,
    size_m: [f64; 2],
    places: &[[f64; 3]; 4],
    hz: impl Fn(usize) -> f64,
    shown: usize,
) -> Result<(), Box<dyn Error>> {
    let Engine { mut scene, mut renderer, .. } = Config::default().build()?;
    let body = scene.add_body(ModalModel::parse(modes)?)?;
    let frame = SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])?;
    let surface =
        Surface::flat(size_m[0], size_m[1])?.material(Material::STEEL).micro_relief_m(6e-6).frame(frame);
    let surface = scene.add_surface(surface.body(body))?;
    let held_s = BEAT_S * places.len() as f64;
    let stroke_s = held_s + BEAT_S;
    let total_s = stroke_s + 2.0;
    let finger = ContactId(1);
    for tick in 0..(60.0 * total_s) as usize {
        let t = tick as f64 / 60.0;
        if let Some(beat) = (tick % 90 == 0).then_some(tick / 90).filter(|beat| *beat <= places.len()) {
            scene
                .report(t, ContactEvent::Impact(Impact::on(body).at_m(places[beat.min(places.len() - 1)])))?;
        }
        // A finger that rests for the fifth strike, and strokes across after it.
        let u = 0.3 + 0.6 * ((t - stroke_s) / 1.5).clamp(0.0, 1.0);
        let speed_m_s = if (stroke_s..stroke_s + 1.5).contains(&t) { 0.4 * size_m[0] } else { 0.0 };
        let sample = ContactSample::new([u, 0.4], 1.0).sliding([speed_m_s, 0.0]);
        let first = (60.0 * (held_s - 0.2)) as usize;
        let last = (60.0 * (stroke_s + 1.5)) as usize;
        let event = match tick {
            _ if tick == first => Some(ContactEvent::begin(finger, surface, ChannelId(0), sample)),
            _ if tick > first && tick < last => Some(ContactEvent::moved(finger, sample)),
            _ if tick == last => Some(ContactEvent::end(finger)),
            _ => None,
        };
        if let Some(event) = event {
            scene.report(t, event)?;
        }
    }
    let samples = (total_s * RATE_HZ) as usize;
    let (mut haptic, mut audio) = (vec![0.0; samples], vec![0.0; samples]);
    for (haptic, audio) in haptic.chunks_mut(512).zip(audio.chunks_mut(512)) {
        renderer.render(&mut [haptic], &mut [audio]);
    }
    let peak = audio.iter().fold(0.0_f32, |a, x| a.max(x.abs()));
    println!("{}: peak {peak:.3e}", wav.display());
    for beat in 0..=places.len() {
        let from = ((BEAT_S * beat as f64 + 0.1) * RATE_HZ) as usize;
        let levels = (0..shown).map(|m| level_db(&audio[from..from + (0.8 * RATE_HZ) as usize], hz(m)));
        let levels: Vec<String> = levels.map(|db| format!("{db:7.1}")).collect();
        let what = if beat == places.len() { "the same, held" } else { "struck" };
        println!("  {what:<15} at {:?} m: {} dB", places[beat.min(places.len() - 1)], levels.join(" "));
    }
    audio.iter_mut().for_each(|x| *x *= 0.5 / peak.max(1e-12));
    write_wav(wav, &[&audio], RATE_HZ)?;
    Ok(())
}

/// Level of a frequency in some samples, dB re the output's unit.
fn level_db(sound: &[f32], hz: f64) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (n, y) in sound.iter().enumerate() {
        let window = (std::f64::consts::PI * n as f64 / sound.len() as f64).sin().powi(2);
        let angle = TAU * hz * n as f64 / RATE_HZ;
        re += window * f64::from(*y) * angle.cos();
        im += window * f64::from(*y) * angle.sin();
    }
    20.0 * (4.0 * re.hypot(im) / sound.len() as f64).max(1e-15).log10()
}
