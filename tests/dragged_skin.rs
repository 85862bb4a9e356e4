//! An actuator that plays how friction drags the skin, through the whole engine.

use asperity::dsp::tangential::{FORCE_EXPONENT, STIFFNESS_N_M};
use asperity::{
    ActuatorSettings, ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Quantity, Surface,
};

fn stroke(surface: Surface, highpass_hz: f64, speed_m_s: f64, normal_force_n: f64, block: usize) -> Vec<f32> {
    let settings = ActuatorSettings {
        output: Quantity::Tangential,
        full_scale: 1.0,
        highpass_hz,
        ..ActuatorSettings::default()
    };
    let config = Config { actuators: vec![settings], ..Config::default() };
    let Engine { mut scene, mut renderer, .. } = config.build().unwrap();
    let surface = scene.add_surface(surface).unwrap();
    for step in 0..60 {
        let t = f64::from(step) / 60.0;
        let sample =
            ContactSample::new([0.1 + speed_m_s * t / 0.5, 0.5], normal_force_n).sliding([speed_m_s, 0.0]);
        let event = match step {
            0 => ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample),
            _ => ContactEvent::moved(ContactId(1), sample),
        };
        scene.report(t, event).unwrap();
    }
    let (mut haptic, mut audio) = (vec![0.0; 44_100], vec![0.0; 44_100]);
    for (haptic, audio) in haptic.chunks_mut(block).zip(audio.chunks_mut(block)) {
        renderer.render(&mut [haptic], &mut [audio]);
    }
    haptic
}

#[test]
fn on_a_smooth_plate_the_skin_stands_aside_by_friction_over_stiffness() {
    for (normal_force_n, friction) in [(0.2, 0.4), (1.0, 0.8), (3.0, 0.3)] {
        let plate = Surface::flat(0.5, 0.5).unwrap().micro_relief_m(0.0).friction(friction);
        let felt = stroke(plate, 0.0, 0.1, normal_force_n, 512);
        let exact = friction * normal_force_n / (STIFFNESS_N_M * f64::powf(normal_force_n, FORCE_EXPONENT));
        let found = f64::from(felt[30_000]);
        assert!((found / exact - 1.0).abs() < 1e-3, "{normal_force_n} N: {found:e} m of {exact:e}");
    }
}

#[test]
fn high_passed_it_begins_and_stays_silent_on_a_smooth_plate() {
    let plate = Surface::flat(0.5, 0.5).unwrap().micro_relief_m(0.0);
    let felt = stroke(plate, 10.0, 0.1, 1.0, 512);
    // 0.4 mm of steady drag: nothing of it is played, not even as it begins.
    let most = felt.iter().fold(0.0_f32, |a, x| a.max(x.abs()));
    assert!(most < 2e-6, "{most:e} m");
}

#[test]
fn any_split_into_blocks_drags_the_same_bits() {
    let rough = || Surface::flat(0.5, 0.5).unwrap().micro_relief_m(8e-6);
    let whole = stroke(rough(), 10.0, 0.15, 0.8, 44_100);
    assert!(whole.iter().any(|x| x.abs() > 1e-9));
    for block in [1, 63, 64, 480] {
        assert!(
            whole
                .iter()
                .zip(&stroke(rough(), 10.0, 0.15, 0.8, block))
                .all(|(a, b)| a.to_bits() == b.to_bits())
        );
    }
}
