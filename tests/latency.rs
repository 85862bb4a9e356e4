//! Latency from event to sample: at most one block and three samples in the engine; haptics and
//! audio together.

use crate::common;

use asperity::{
    ActuatorSettings, ChannelId, ClockMode, Config, ContactEvent, ContactId, ContactSample, Excitation,
    Impact, Material, ModalModel, Mode, Quantity,
};
use asperity_dsp::rng::Rng;
use common::plate;

const RATE_HZ: f64 = 44_100.0;

/// A body that is silent again after a few milliseconds.
fn tick() -> ModalModel {
    let mode = Mode { frequency_hz: 3000.0, decay_per_s: 4000.0, amplitude: 1.0, phase_rad: 0.0 };
    ModalModel::new(vec![mode], 0.01).unwrap()
}

fn impact(body: asperity::BodyId) -> ContactEvent {
    ContactEvent::Impact(Impact {
        body,
        other: None,
        speed_m_s: 2.0,
        mass_kg: 0.001,
        radius_m: 0.001,
        striker: Material::STEEL,
        restitution: 1.0,
        position: 0,
        ..Impact::on(body)
    })
}

#[test]
fn a_stamped_event_sounds_at_its_own_sample() {
    for block in [64, 256, 1000] {
        for sample in [0u64, 1, 63, 64, 255, 777] {
            let asperity::Engine { mut scene, mut renderer, .. } = Config::default().build().unwrap();
            let body = scene.add_body(tick()).unwrap();
            scene.report(sample as f64 / RATE_HZ, impact(body)).unwrap();
            let mut heard = Vec::new();
            while heard.len() < 2000 {
                let (mut h, mut a) = (vec![0.0; block], vec![0.0; block]);
                renderer.render(&mut [&mut h], &mut [&mut a]);
                heard.extend(a);
            }
            let onset = onset(&heard) as u64;
            let due = sample + renderer.audio_latency_samples() as u64;
            assert!(onset >= due && onset <= due + 1, "sample {sample}: heard at {onset}, due at {due}");
        }
    }
}

/// The first sample that is more than what rounding leaves of the ring's two samples before a
/// strike.
fn onset(heard: &[f32]) -> usize {
    let loudest = heard.iter().fold(0.0_f32, |loudest, x| loudest.max(x.abs()));
    heard.iter().position(|x| x.abs() > 1e-5 * loudest).unwrap()
}

/// Samples from an impact to the first that is heard: a mode begins at the zero of its sine.
fn rise_samples() -> f64 {
    let asperity::Engine { mut scene, mut renderer, .. } = Config::default().build().unwrap();
    let body = scene.add_body(tick()).unwrap();
    scene.report(100.0 / RATE_HZ, impact(body)).unwrap();
    let (mut h, mut a) = ([0.0; 512], [0.0; 512]);
    renderer.render(&mut [&mut h], &mut [&mut a]);
    (onset(&a) - renderer.audio_latency_samples()) as f64 - 100.0
}

/// A game that reports at random moments, a device that renders at the start of each block.
fn latencies(block: usize, events: usize) -> Vec<f64> {
    let asperity::Engine { mut scene, mut renderer, .. } =
        Config { clock: ClockMode::LIVE, ..Config::default() }.build().unwrap();
    let body = scene.add_body(tick()).unwrap();
    let mut rng = Rng::new(3);
    let (mut now, mut heard) = (5000.0, Vec::<f32>::new());
    let mut found = Vec::new();
    for _ in 0..events {
        now += 4000.0 + 3000.0 * rng.uniform();
        // Every callback whose turn came before the event has been rendered.
        let render_to = |renderer: &mut asperity::Renderer, heard: &mut Vec<f32>, sample: f64| {
            while heard.len() as f64 <= sample {
                let (mut h, mut a) = (vec![0.0; block], vec![0.0; block]);
                renderer.render(&mut [&mut h], &mut [&mut a]);
                heard.extend(a);
            }
        };
        render_to(&mut renderer, &mut heard, now);
        scene.report(77.0 + now / RATE_HZ, impact(body)).unwrap();
        let from = heard.len();
        render_to(&mut renderer, &mut heard, now + 2500.0);
        let onset = from + onset(&heard[from..]);
        found.push(onset as f64 - now);
    }
    // An offline render has no latency: what its impact takes to rise is the mode's, not the
    // engine's.
    let rise = rise_samples();
    found.iter_mut().for_each(|latency| *latency -= rise);
    found
}

#[test]
fn live_an_event_is_heard_within_one_block_and_three_samples() {
    for block in [64, 128, 256, 512, 1024] {
        let found = latencies(block, 200);
        let most = found.iter().copied().fold(0.0, f64::max);
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        eprintln!("blocks of {block}: latency mean {mean:.1}, at most {most:.1} samples");
        // Two of them are the ring's.
        assert!(most <= (block + 3) as f64, "blocks of {block}: {most} samples");
    }
}

#[test]
fn one_micro_collision_is_heard_within_two_samples_after_it_is_felt() {
    for excitation in [Excitation::COLLISIONS, Excitation::BOTH] {
        for begin in [1000u64, 1037, 1063, 1064] {
            let actuators = vec![ActuatorSettings {
                output: Quantity::Acceleration,
                full_scale: 1.0,
                highpass_hz: 0.0,
                ..ActuatorSettings::default()
            }];
            let asperity::Engine { mut scene, mut renderer, .. } =
                Config { actuators, ..Config::default() }.build().unwrap();
            let body = scene.add_body(tick()).unwrap();
            let flat = plate(0.5).micro_relief_m(0.0).body(body).excitation(excitation);
            let surface = scene.add_surface(flat).unwrap();
            let sample = ContactSample {
                uv: [0.5, 0.5],
                velocity_m_s: Some([0.0, 0.0]),
                normal_force_n: 0.5,
                closing_m_s: 0.1,
                ..ContactSample::default()
            };
            let event = ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample);
            scene.report(begin as f64 / RATE_HZ, event).unwrap();
            let (mut felt, mut heard) = (vec![0.0f32; 4096], vec![0.0f32; 4096]);
            renderer.render(&mut [&mut felt], &mut [&mut heard]);
            let felt = felt.iter().position(|x| *x != 0.0).unwrap();
            let heard = onset(&heard);
            eprintln!("{excitation:?} from {begin}: felt {felt}, heard {heard}");
            // A pulse is spread over the ring's two samples before the middle of its sound and two
            // after it.
            assert!((felt..=felt + 2).contains(&heard), "{excitation:?} from {begin}: {felt}, {heard}");
        }
    }
}
