//! Surfaces and bodies replaced under a sliding contact: no sample step above −60 dB of the signal.

use crate::common;
use crate::sliding;

use asperity::{ChannelId, Material};
use common::{grating, peak, plate};
use sliding::{Stroke, assert_no_step, low_body};

#[test]
fn a_surface_swapped_under_a_sliding_contact_makes_no_step() {
    let mut stroke = Stroke::begin(1.0);
    stroke.slide(0.5);
    for height_m in [5e-5, 0.0, 3e-5, 1e-5] {
        let new = grating(2e-3, height_m).body(stroke.body);
        stroke.scene.replace_surface(stroke.surface, new).unwrap();
        stroke.slide(0.2);
    }
    assert_no_step(&stroke, 0.3, "surface swapped");
    // Each swap frees what the one before left behind.
    assert_eq!(stroke.scene.collect(), 1, "the last of the old surfaces comes home");
}

#[test]
fn surfaces_swapped_faster_than_they_can_fade_make_no_step() {
    let mut stroke = Stroke::begin(1.0);
    stroke.slide(0.5);
    for i in 0..200 {
        let new = grating(2e-3, 1e-6 * f64::from(i % 40)).body(stroke.body);
        stroke.scene.replace_surface(stroke.surface, new).unwrap();
        stroke.slide(0.002);
    }
    assert_no_step(&stroke, 0.3, "surface swapped every 2 ms");
}

#[test]
fn a_surface_of_another_size_lets_its_contacts_fade_without_a_step() {
    let mut stroke = Stroke::begin(1.0);
    stroke.slide(0.5);
    stroke.scene.replace_surface(stroke.surface, grating(3e-3, 2e-5).body(stroke.body)).unwrap();
    stroke.slide(0.5);
    assert_no_step(&stroke, 0.3, "surface of another size");
    assert!(peak(&stroke.haptic[40_000..]) > 0.0, "the contact comes back with its next move");
}

#[test]
fn a_removed_surface_fades_without_a_step() {
    let mut stroke = Stroke::begin(1.0);
    stroke.slide(0.5);
    stroke.scene.remove_surface(stroke.surface).unwrap();
    stroke.slide(0.3);
    assert_no_step(&stroke, 0.3, "surface removed");
    assert_eq!(peak(&stroke.haptic[stroke.haptic.len() - 64..]), 0.0);
    assert!(stroke.scene.collect() >= 1, "its memory comes home");
}

#[test]
fn modes_replaced_while_they_ring_make_no_step() {
    let mut stroke = Stroke::begin(1.0);
    stroke.slide(0.5);
    for i in 0..10 {
        stroke
            .scene
            .replace_body(stroke.body, asperity::Body::new(low_body()).material(Material::GLASS))
            .unwrap();
        stroke.slide(if i < 8 { 0.003 } else { 0.2 });
    }
    assert_no_step(&stroke, 0.3, "modes replaced");
}

#[test]
fn a_muted_channel_fades_and_comes_back_without_a_step() {
    let mut stroke = Stroke::begin(1.0);
    stroke.slide(0.5);
    stroke.scene.set_haptic_gain(ChannelId(0), 0.0).unwrap();
    stroke.slide(0.1);
    assert_eq!(peak(&stroke.haptic[stroke.haptic.len() - 64..]), 0.0);
    stroke.scene.set_haptic_gain(ChannelId(0), 1.0).unwrap();
    stroke.slide(0.1);
    assert_no_step(&stroke, 0.3, "mute");
    assert!(peak(&stroke.haptic[stroke.haptic.len() - 64..]) > 0.0);
}

#[test]
fn a_flat_plate_with_micro_relief_takes_over_without_a_step() {
    let mut stroke = Stroke::begin(1.0);
    stroke.slide(0.5);
    let smooth = plate(0.2).micro_relief_m(0.0);
    // The plate is as wide as the grating, so contacts go on.
    stroke.scene.replace_surface(stroke.surface, smooth.body(stroke.body)).unwrap();
    stroke.slide(0.3);
    assert_no_step(&stroke, 0.3, "plate");
}

/// The sound of a stroke over ribs, its collisions alone, on a body that is of `before` and then
/// replaced by one of `after`.
fn scraped(before: Material, after: Material) -> Vec<f32> {
    let asperity::Engine { mut scene, renderer, .. } = asperity::Config::default().build().unwrap();
    let body = scene.add_body(asperity::Body::new(common::bar()).material(before)).unwrap();
    let ribs = grating(2e-3, 2e-4).body(body).excitation(asperity::Excitation::COLLISIONS);
    let width_m = 70.0 * 2e-3;
    let surface = scene.add_surface(ribs).unwrap();
    if after != before {
        scene.replace_body(body, asperity::Body::new(common::bar()).material(after)).unwrap();
    }
    let names = asperity::files::contact_log::Names {
        surfaces: std::collections::HashMap::from([("s".to_owned(), surface)]),
        ..Default::default()
    };
    let log = common::stroke(width_m, 0.2, 0.2, 0.4);
    asperity::offline::render(scene, renderer, &log, &names, &Default::default())
        .unwrap()
        .audio
        .swap_remove(0)
}

#[test]
fn strokes_on_a_replaced_body_take_its_new_material() {
    let steel = scraped(Material::STEEL, Material::STEEL);
    let rubber = scraped(Material::RUBBER, Material::RUBBER);
    assert!(common::rms(&steel) > 1.2 * common::rms(&rubber), "rubber is duller than steel");
    assert_eq!(scraped(Material::STEEL, Material::RUBBER), rubber);
}
