//! Fuzz targets, which must survive any bytes: reading them, and using whatever they are taken for.
//! A target panics when it finds a fault.
#![allow(dead_code)]

use asperity::files::contact_log::{ContactLog, Names};
use asperity::offline::{self, Options};
use asperity::{Config, Extent, ModalModel, Surface, Wrap};
use asperity_surface::height_map::HeightMap;
use asperity_surface::image_io::{self, Channel};
use asperity_surface::raster::Raster;
use std::collections::HashMap;

/// Longest log that is rendered, s.
const LONGEST_S: f64 = 2.0;

fn flat() -> Surface {
    let extent = Extent { width_m: 0.1, height_m: 0.1, relief_m: 1.0 };
    let map = HeightMap::flat(extent, 0.5).expect("a plane is a map");
    Surface::new(map, 0.1, 0.1).expect("a size that is accepted")
}

/// Renders a log on a body and demands numbers.
fn render(model: ModalModel, log: &ContactLog) {
    let asperity::Engine { mut scene, renderer, .. } =
        Config::default().build().expect("the default config is accepted");
    let Ok(body) = scene.add_body(model) else { return };
    let surface = scene.add_surface(flat().body(body)).expect("a surface that is accepted");
    let names = Names {
        surfaces: HashMap::from([("tiles".to_owned(), surface)]),
        bodies: HashMap::from([("tile".to_owned(), body)]),
        ..Default::default()
    };
    if log.end_s().is_nan() || log.end_s() > LONGEST_S {
        return;
    }
    if let Ok(take) = offline::render(
        scene,
        renderer,
        log,
        &names,
        &Options { block_frames: 256, tail_s: 0.01, ..Options::default() },
    ) {
        assert!(take.audio[0].iter().chain(take.haptic.iter().flatten()).all(|x| x.is_finite()));
    }
}

/// A contact log, read and rendered.
pub fn log(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(log) = ContactLog::parse(text, "fuzz.jsonl") {
        let mut written = Vec::new();
        log.write(&mut written).expect("memory takes all");
        let again = std::str::from_utf8(&written).expect("a log is text");
        assert_eq!(ContactLog::parse(again, "again").as_ref().ok(), Some(&log), "a log survives its file");
        let mode = asperity::Mode { frequency_hz: 700.0, decay_per_s: 9.0, amplitude: 0.4, phase_rad: 0.0 };
        render(ModalModel::new(vec![mode], 0.01).expect("a mode that is accepted"), &log);
    }
}

/// A modes file, read and struck.
pub fn modes(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(model) = ModalModel::parse(text) {
        assert_eq!(
            ModalModel::parse(&model.to_json()).ok().as_ref(),
            Some(&model),
            "modes survive their file"
        );
        let strike = r#"{"t":0.001,"event":"impact","body":"tile","speed_m_s":0.8,"mass_kg":0.01,"radius_m":0.005,"striker":"steel"}"#;
        render(model, &ContactLog::parse(strike, "strike").expect("a log that is accepted"));
    }
}

/// A picture, read and made a map.
pub fn image(data: &[u8]) {
    let name = format!("asperity-fuzz-{}-{:?}.png", std::process::id(), std::thread::current().id());
    let path = std::env::temp_dir().join(name);
    if std::fs::write(&path, data).is_err() {
        return;
    }
    let read = image_io::load_channel(&path, Channel::Luma);
    let _ = std::fs::remove_file(&path);
    if let Ok(picture) = read {
        let Raster { width, height, ref values } = picture.raster;
        assert!(width > 0 && height > 0 && values.len() == width * height);
        assert!(values.iter().all(|v| v.is_finite()));
        if values.len() < 1 << 14 {
            let extent = Extent { width_m: 0.1, height_m: 0.1, relief_m: 1e-3 };
            HeightMap::new(&picture.debanded(Wrap::Repeat), extent, Wrap::Repeat)
                .expect("a picture is a map");
        }
    }
}
