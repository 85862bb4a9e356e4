//! Surfaces and bodies replaced under a sliding contact: no sample step above −60 dB of the signal.

mod common;
#[path = "common/steps.rs"]
mod steps;

use asperity::{
    Actuator, ActuatorSettings, Config, ContactEvent, ContactId, ContactSample, Material, ModalModel, Mode,
    Renderer, Scene, SurfaceId,
};
use common::{grating, peak, plate};
use steps::largest_step;

/// Modes low enough for their own ringing not to look like steps.
fn low_body() -> ModalModel {
    let mode = |frequency_hz, amplitude| Mode { frequency_hz, decay_per_s: 8.0, amplitude, phase_rad: 0.0 };
    ModalModel::new(vec![mode(180.0, 0.3), mode(310.0, 0.2), mode(470.0, 0.1)], 0.01).unwrap()
}

struct Stroke {
    scene: Scene,
    renderer: Renderer,
    surface: SurfaceId,
    body: asperity::BodyId,
    reported: u64,
    haptic: Vec<f32>,
    audio: Vec<f32>,
}

const SPEED_M_S: f64 = 0.1;

impl Stroke {
    fn begin(full_scale: f64) -> Self {
        let actuators = vec![ActuatorSettings { full_scale, ..ActuatorSettings::default() }];
        let (mut scene, renderer) = Config { actuators, ..Config::default() }.build().unwrap();
        let body = scene.add_body(low_body()).unwrap();
        let surface = scene.add_surface(grating(2e-3, 2e-5).on(body)).unwrap();
        let mut stroke =
            Self { scene, renderer, surface, body, reported: 0, haptic: Vec::new(), audio: Vec::new() };
        let event = ContactEvent::begin(ContactId(1), surface, Actuator(0), sample_at(0.0));
        stroke.scene.report(0.0, event).unwrap();
        stroke
    }

    /// Slides on; the game reports at 60 Hz.
    fn slide(&mut self, seconds: f64) {
        let end = self.audio.len() + (seconds * 44_100.0) as usize;
        while self.audio.len() < end {
            let time_s = self.reported as f64 / 60.0;
            if time_s * 44_100.0 <= (self.audio.len() + 64) as f64 {
                self.scene.report(time_s, ContactEvent::moved(ContactId(1), sample_at(time_s))).unwrap();
                self.reported += 1;
            }
            let (mut h, mut a) = ([0.0f32; 64], [0.0f32; 64]);
            self.renderer.render(&mut [&mut h], &mut [&mut a]);
            self.haptic.extend(h);
            self.audio.extend(a);
        }
    }

    /// Largest step of what was rendered from `from_s` on, in dB of the signal's peak: haptics, audio.
    fn steps_db(&self, from_s: f64) -> [f64; 2] {
        let from = (from_s * 44_100.0) as usize;
        [&self.haptic, &self.audio].map(|x| 20.0 * (largest_step(&x[from..]) / peak(&x[from..])).log10())
    }
}

fn sample_at(time_s: f64) -> ContactSample {
    ContactSample {
        uv: [0.1 + SPEED_M_S * time_s / common::SIDE_M, 0.5],
        velocity_m_s: Some([SPEED_M_S, 0.0]),
        normal_force_n: 0.6,
        closing_m_s: 0.0,
    }
}

fn assert_no_step(stroke: &Stroke, from_s: f64, what: &str) {
    let [felt, heard] = stroke.steps_db(from_s);
    eprintln!("{what}: largest step felt {felt:.1} dB, heard {heard:.1} dB of the peak");
    assert!(felt < -60.0 && heard < -60.0, "{what}: felt {felt} dB, heard {heard} dB");
}

#[test]
fn a_surface_swapped_under_a_sliding_contact_makes_no_step() {
    let mut stroke = Stroke::begin(1.0);
    stroke.slide(0.5);
    for height_m in [5e-5, 0.0, 3e-5, 1e-5] {
        let new = grating(2e-3, height_m).on(stroke.body);
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
        let new = grating(2e-3, 1e-6 * f64::from(i % 40)).on(stroke.body);
        stroke.scene.replace_surface(stroke.surface, new).unwrap();
        stroke.slide(0.002);
    }
    assert_no_step(&stroke, 0.3, "surface swapped every 2 ms");
}

#[test]
fn a_surface_of_another_size_lets_its_contacts_fade_without_a_step() {
    let mut stroke = Stroke::begin(1.0);
    stroke.slide(0.5);
    stroke.scene.replace_surface(stroke.surface, grating(3e-3, 2e-5).on(stroke.body)).unwrap();
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
        stroke.scene.replace_body(stroke.body, low_body(), Material::GLASS).unwrap();
        stroke.slide(if i < 8 { 0.003 } else { 0.2 });
    }
    assert_no_step(&stroke, 0.3, "modes replaced");
}

#[test]
fn a_muted_channel_fades_and_comes_back_without_a_step() {
    let mut stroke = Stroke::begin(1.0);
    stroke.slide(0.5);
    stroke.scene.set_haptic_gain(Actuator(0), 0.0).unwrap();
    stroke.slide(0.1);
    assert_eq!(peak(&stroke.haptic[stroke.haptic.len() - 64..]), 0.0);
    stroke.scene.set_haptic_gain(Actuator(0), 1.0).unwrap();
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
    stroke.scene.replace_surface(stroke.surface, smooth.on(stroke.body)).unwrap();
    stroke.slide(0.3);
    assert_no_step(&stroke, 0.3, "plate");
}
