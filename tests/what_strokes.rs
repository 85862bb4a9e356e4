//! What touches decides what is heard: a finger is a patch of asperities, a pen has a shaft, a
//! crate has a face. What is felt of a tool stays what it was without a tip of its own.

use crate::common;

use asperity::files::contact_log::{ContactLog, Names};
use asperity::offline::{self, Options, Render};
use asperity::{
    ActuatorSettings, Body, Config, Elastic, Excitation, HeardTip, Material, Probe, Quantity, Stock, Surface,
    probe_by_name,
};
use common::strokes::{power, rms_and_centroid};
use common::{SIDE_M, grating, plate, rms, stroke};
use std::collections::HashMap;

const HARD: [Material; 15] = [
    Material::STEEL,
    Material::IRON,
    Material::ALUMINIUM,
    Material::BRASS,
    Material::COPPER,
    Material::GLASS,
    Material::CERAMIC,
    Material::STONE,
    Material::CONCRETE,
    Material::BRICK,
    Material::WOOD,
    Material::SOFTWOOD,
    Material::PLA,
    Material::PLASTIC,
    Material::ACRYLIC,
];

fn preset(name: &str) -> Probe {
    probe_by_name(name).unwrap()
}

/// A log over a surface on a stock plate of 0.3 m, in numbers of the plate's own.
fn rendered(probe: Probe, body: Material, surface: Surface, log: &ContactLog, block_frames: usize) -> Render {
    let channel = |output| ActuatorSettings { full_scale: 1.0, output, ..ActuatorSettings::default() };
    let config = Config { probe, actuators: vec![channel(Quantity::Acceleration)], ..Config::default() };
    let asperity::Engine { mut scene, renderer, .. } = config.build().unwrap();
    let body = scene.add_body(Body::stock(Stock::Plate, body, 0.3).unwrap()).unwrap();
    let surface = scene.add_surface(surface.body(body).excitation(Excitation::BOTH)).unwrap();
    let names = Names { surfaces: HashMap::from([("s".to_owned(), surface)]), ..Default::default() };
    offline::render(
        scene,
        renderer,
        log,
        &names,
        &Options { block_frames, tail_s: 0.0, ..Options::default() },
    )
    .unwrap()
}

/// Level, dB, and centroid, Hz, of a stroke of 0.1 m/s and 1 N.
fn heard(probe: Probe, body: Material, surface: Surface) -> [f64; 2] {
    let render = rendered(probe, body, surface, &stroke(SIDE_M, 0.1, 1.0, 0.8), 512);
    let (rms, centroid_hz) = rms_and_centroid(&power(&render.audio[0], 44_100.0), 20.0, 20e3);
    [20.0 * rms.log10(), centroid_hz]
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn a_pen_is_louder_than_a_finger_or_nail_below_a_rod() {
    for roughness in [0.2, 0.9] {
        let mut over_default = Vec::new();
        for body in HARD {
            let of = |name: &str| heard(preset(name), body, plate(roughness))[0];
            let soft = of("fingertip-soft");
            let [nail, pen, rod] = ["fingernail", "stylus-steel", "steel-rod"].map(|name| of(name) - soft);
            println!("{:?} R {roughness}: nail {nail:.1}, pen {pen:.1}, rod {rod:.1} dB", body.name());
            assert!(nail < pen && pen < rod, "{:?}, R {roughness}: {nail} {pen} {rod}", body.name());
            assert!(nail > 6.0 && pen < 25.0 && rod < 28.0, "{:?}: {nail} {pen} {rod}", body.name());
            over_default.push(pen + soft - of("fingertip"));
        }
        assert!(over_default.iter().all(|db| *db > 0.0), "{over_default:?}");
        assert!((3.0..28.0).contains(&median(over_default)));
    }
}

#[test]
fn a_steel_tip_is_brighter_than_plastic_on_hard_ground() {
    for body in [Material::STEEL, Material::GLASS, Material::STONE] {
        let [steel, plastic] =
            ["stylus-steel", "stylus"].map(|name| heard(preset(name), body, plate(0.5))[1]);
        println!("{:?}: steel {steel:.0} Hz, plastic {plastic:.0} Hz", body.name());
        assert!(steel > 1.25 * plastic, "{:?}: {steel} and {plastic} Hz", body.name());
    }
}

#[test]
fn a_tools_own_tip_changes_no_bit_of_what_is_felt() {
    let log = stroke(SIDE_M, 0.1, 1.0, 0.5);
    for name in ["stylus", "fingernail", "rigid"] {
        let with = preset(name);
        let without = Probe { tip: None, ..with };
        for surface in [|| plate(0.5), || grating(2e-3, 5e-5)] {
            let [with, without] =
                [with, without].map(|probe| rendered(probe, Material::STEEL, surface(), &log, 512));
            assert_eq!(with.haptic, without.haptic, "{name}");
            assert_ne!(with.audio, without.audio, "{name}");
        }
    }
}

#[test]
fn a_tip_sounds_the_same_in_blocks_of_any_length() {
    let log = stroke(SIDE_M, 0.1, 1.0, 0.3);
    let of = |block| rendered(preset("stylus-steel"), Material::STEEL, plate(0.7), &log, block);
    let whole = of(4096);
    for block in [1, 37, 512] {
        assert!(of(block).audio == whole.audio, "blocks of {block}");
    }
}

#[test]
fn asperities_sharing_the_load_sound_as_their_numbers_root() {
    let log = stroke(SIDE_M, 0.1, 0.8, 0.5);
    let of = |asperities| {
        let probe = Probe { asperities, ..Probe::default() };
        rendered(probe, Material::WOOD, plate(0.9), &log, 512)
    };
    let (one, many) = (of(1.0), of(64.0));
    assert_eq!(one.haptic, many.haptic);
    assert!((rms(&many.audio[0]) / rms(&one.audio[0]) - 0.125).abs() < 1e-5);
}

// Closed form: a tip that stays on sines of ground is a linear oscillator, and what it sends is
// k_H times how deep the ground presses into it.
#[test]
fn over_a_grating_a_tip_sends_what_its_shafts_impedance_asks() {
    let (speed_m_s, wave_m, height_m) = (0.1, 1e-3, 2e-7);
    let tip = HeardTip {
        mass_kg: 1e-3,
        damping_n_s_m: 20.0,
        material: Elastic { young_pa: 2e11, poisson: 0.3 },
        contact_radius_m: 4e-4,
        asperity_radius_m: 0.0,
    };
    let log = stroke(SIDE_M, speed_m_s, 1.0, 1.0);
    let level = |probe| {
        let surface = grating(wave_m, height_m).micro_relief_m(0.0);
        let audio = &rendered(probe, Material::STEEL, surface, &log, 512).audio[0];
        rms(&audio[22_050..])
    };
    // Twice the resistance and twice the mass: twice the force, as far as its own spring is stiff
    // and the tool's soft at 100 Hz.
    let twice = HeardTip { mass_kg: 2.0 * tip.mass_kg, damping_n_s_m: 2.0 * tip.damping_n_s_m, ..tip };
    let of = |tip| level(Probe { tip: Some(tip), pad_stiffness_n_m: 50.0, ..preset("rigid") });
    let ratio = of(twice) / of(tip);
    assert!((ratio - 2.0).abs() < 0.05, "{ratio}");
}

#[test]
fn a_crate_spans_what_a_point_falls_into_and_scrapes_more_softly() {
    let log = stroke(SIDE_M, 1.0, 60.0, 1.0);
    let of = |micro_relief_m, face_m, asperities| {
        let probe = Probe { face_m, asperities, ..preset("rigid") };
        let bricks = grating(60e-3, 2.5e-3).micro_relief_m(micro_relief_m);
        let render = rendered(probe, Material::BRICK, bricks, &log, 512);
        [&render.haptic[0], &render.audio[0]].map(|x| 20.0 * rms(&x[22_050..]).log10())
    };
    let felt_db = of(0.0, 0.0, 1.0)[0] - of(0.0, 0.3, 64.0)[0];
    let heard_db = of(22e-6, 0.0, 1.0)[1] - of(22e-6, 0.3, 64.0)[1];
    println!("a face of 0.3 m: felt {felt_db:.1} dB less, heard {heard_db:.1} dB less");
    assert!(felt_db > 15.0 && heard_db > 15.0, "{felt_db} and {heard_db} dB");
}
