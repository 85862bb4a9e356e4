//! Materials and stock bodies, heard and felt through the engine: nothing recorded, nothing fitted.

use asperity::files::scene_file::SceneFile;
use asperity::load::Overrides;
use asperity::{
    Body, ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Impact, Material, Stock, Surface,
};
use std::path::Path;

const RATE_HZ: f64 = 44_100.0;

fn render(engine: &mut Engine, seconds: f64) -> (Vec<f32>, Vec<f32>) {
    let frames = (seconds * RATE_HZ) as usize;
    let (mut haptic, mut audio) = (vec![0.0; frames], vec![0.0; frames]);
    engine.renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    (haptic, audio)
}

fn power(samples: &[f32]) -> f64 {
    samples.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / samples.len() as f64
}

/// Seconds in which a struck bar of 30 cm falls by 60 dB, from the energy of its sound run
/// backwards (Schroeder), −5 to −25 dB.
fn ringing_s(material: Material) -> f64 {
    let mut engine = Config::default().build().unwrap();
    let body = engine.scene.add_body(Body::stock(Stock::Bar, material, 0.3).unwrap()).unwrap();
    let blow = Impact { striker: Material::WOOD, ..Impact::on(body) };
    engine.scene.report(0.0, ContactEvent::Impact(blow)).unwrap();
    let (_, audio) = render(&mut engine, 6.0);
    let mut left: Vec<f64> = audio.iter().map(|x| f64::from(*x).powi(2)).collect();
    (0..left.len() - 1).rev().for_each(|i| left[i] += left[i + 1]);
    let falls_to = |db: f64| left.iter().position(|e| *e < left[0] * 10f64.powf(db / 10.0)).unwrap() as f64;
    3.0 * (falls_to(-25.0) - falls_to(-5.0)) / RATE_HZ
}

#[test]
fn metals_ring_longest_then_glass_stone_wood_plastic_and_rubber() {
    let order =
        ["aluminium", "glass", "stone", "wood", "pla", "rubber"].map(|name| Material::by_name(name).unwrap());
    let heard = order.map(ringing_s);
    assert!(heard.windows(2).all(|pair| pair[0] > 1.15 * pair[1]), "{heard:?}");
}

#[test]
fn every_material_strikes_and_strokes_without_anything_recorded() {
    for preset in Material::PRESETS {
        let mut engine = Config::default().build().unwrap();
        let scene = &mut engine.scene;
        let body = scene.add_body(Body::stock(Stock::Plate, preset.material, 0.3).unwrap()).unwrap();
        let top = Surface::flat(0.3, 0.3).unwrap().material(preset.material).body(body);
        let top = scene.add_surface(top).unwrap();
        scene.report(0.0, ContactEvent::Impact(Impact::on(body))).unwrap();
        let (_, struck) = render(&mut engine, 0.25);
        let sample = |t: f64| ContactSample {
            uv: [0.2 + 0.5 * t, 0.4],
            velocity_m_s: Some([0.15, 0.0]),
            normal_force_n: 0.8,
            closing_m_s: 0.0,
            ..ContactSample::default()
        };
        engine.scene.report(0.3, ContactEvent::begin(ContactId(1), top, ChannelId(0), sample(0.0))).unwrap();
        let (mut felt, mut heard) = (Vec::new(), Vec::new());
        for step in 1..60 {
            let t = f64::from(step) / 60.0;
            engine.scene.report(0.3 + t, ContactEvent::moved(ContactId(1), sample(t))).unwrap();
            let (haptic, audio) = render(&mut engine, 1.0 / 60.0);
            felt.extend(haptic);
            heard.extend(audio);
        }
        let levels = [power(&struck), power(&felt), power(&heard)].map(|power| 10.0 * power.log10());
        assert!(
            levels[0] > -70.0 && levels[1] > -90.0 && levels[2] > -120.0,
            "{}: {levels:?} dB",
            preset.name
        );
        assert_eq!(engine.scene.stats().quarantined, 0, "{}", preset.name);
    }
}

fn scene(text: &str) -> Result<Engine, String> {
    let file = SceneFile::parse(text, Path::new("scene.toml")).map_err(|error| error.to_string())?;
    Engine::from_scene(&file, &Overrides::default()).map_err(|error| error.to_string())
}

#[test]
fn a_scene_file_sounds_with_stock_body_and_flat_surface() {
    let text = "[[body]]\nname = \"desk\"\nstock = \"plate\"\nsize_m = 0.6\nmaterial = \"wood\"\n\
                [[surface]]\nname = \"top\"\nbody = \"desk\"\nwidth_m = 0.6\nheight_m = 0.6\n\
                [[actuator]]\nfull_scale = 1e-4\nlimit = false\n[audio]\ngain = 1.0\nlimit = false\n";
    let mut engine = scene(text).unwrap();
    let desk = engine.names.bodies["desk"];
    engine.scene.report(0.0, ContactEvent::Impact(Impact::on(desk))).unwrap();
    assert!(power(&render(&mut engine, 0.2).1) > 1e-6);

    // The same as the library makes it, to the last bit.
    let mut same = Config::default().build().unwrap();
    let body = same.scene.add_body(Body::stock(Stock::Plate, Material::WOOD, 0.6).unwrap()).unwrap();
    let top = Surface::flat(0.6, 0.6).unwrap().material(Material::WOOD).body(body);
    let top = same.scene.add_surface(top).unwrap();
    let mut again = scene(text).unwrap();
    let sample = ContactSample {
        uv: [0.1, 0.1],
        velocity_m_s: Some([0.2, 0.0]),
        normal_force_n: 1.0,
        closing_m_s: 0.1,
        ..ContactSample::default()
    };
    let from_file = again.names.surfaces["top"];
    again.scene.report(0.0, ContactEvent::begin(ContactId(1), from_file, ChannelId(0), sample)).unwrap();
    same.scene.report(0.0, ContactEvent::begin(ContactId(1), top, ChannelId(0), sample)).unwrap();
    assert!(render(&mut again, 0.2) == render(&mut same, 0.2));
}

#[test]
fn an_unknown_stock_body_is_refused_with_the_known_ones() {
    let body = |rest: &str| scene(&format!("[[body]]\nname = \"b\"\n{rest}\n")).map(|_| ()).unwrap_err();
    for (rest, words) in [
        ("stock = \"bell\"\nsize_m = 0.3", ["\"bell\" is unknown", "\"bowl\""]),
        ("stock = \"bar\"", ["size_m: is missing", "0.3"]),
        ("size_m = 0.3", ["size_m: stands without stock", "stock ="]),
        ("stock = \"bar\"\nsize_m = 0.3\nmodes = \"b.modes.json\"", ["stands beside modes", "one of them"]),
        ("material = \"cheese\"", ["\"cheese\" is unknown", "acrylic"]),
        (
            "material = { young_pa = 1e9, poisson = 0.3, density_kg_m3 = 900.0, eta = -1.0 }",
            ["eta", "0 to 10"],
        ),
        (
            "material = { young_pa = 1e9, poisson = 0.3, density_kg_m3 = 900.0, etta = 1.0 }",
            ["etta", "unknown key"],
        ),
    ] {
        let refused = body(rest);
        assert!(words.iter().all(|word| refused.contains(word)), "{rest}: {refused}");
    }
}

#[test]
fn a_log_keeps_a_striker_of_a_preset_by_its_name() {
    let mut engine = Config::default().build().unwrap();
    let body = engine.scene.add_body(Body::stock(Stock::Bar, Material::STEEL, 0.3).unwrap()).unwrap();
    engine.scene.start_recording(&engine.names);
    let odd = Material { eta: 0.05, ..Material::WOOD };
    for striker in [Material::WOOD, odd] {
        engine.scene.report(0.0, ContactEvent::Impact(Impact { striker, ..Impact::on(body) })).unwrap();
    }
    let mut text = Vec::new();
    engine.scene.stop_recording().write(&mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains("\"striker\":\"wood\"") && text.contains("\"eta\":0.05"), "{text}");
}
