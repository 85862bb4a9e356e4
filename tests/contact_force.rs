//! A channel that plays the normal contact force, through the whole engine.

use crate::common;

use asperity::{
    ActuatorSettings, Body, ChannelId, Config, ContactBlock, ContactEvent, Engine, Impact, Material, Probe,
    Quantity, Stock, Surface, Tap, probe_by_name,
};
use common::{plate, render_tapped, stroke};

const RATE_HZ: f64 = 44_100.0;

fn config(highpass_hz: f64, probe: &str) -> Config {
    let output = Quantity::Force;
    let channel = ActuatorSettings { output, full_scale: 1.0, highpass_hz, ..ActuatorSettings::default() };
    Config { actuators: vec![channel], probe: probe_by_name(probe).unwrap(), ..Config::default() }
}

/// Contact force of each sample.
#[derive(Default)]
struct Forces(Vec<f64>);

impl Tap for Forces {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        self.0.extend(block.contact_samples.iter().map(|row| row.contact_force_n));
    }
}

fn felt(config: Config, surface: Surface, force_n: f64, block_frames: usize) -> (Vec<f32>, Vec<f64>) {
    let mut tap = Forces::default();
    let log = stroke(common::SIDE_M, 0.1, force_n, 0.5);
    let options = asperity::offline::Options { tail_s: 0.0, block_frames, ..Default::default() };
    let render = render_tapped(config, surface, &log, &options, &mut tap);
    (render.haptic[0].clone(), tap.0)
}

#[test]
fn without_a_high_pass_it_is_the_contact_force_itself() {
    for (probe, roughness) in [("fingertip", 0.5), ("stylus", 0.5), ("fingernail", 0.3)] {
        let (felt, forces) = felt(config(0.0, probe), plate(roughness), 0.8, 256);
        let apart = felt.iter().zip(&forces).skip(2000).map(|(x, n)| (f64::from(*x) - n).abs());
        let worst = apart.take(18_000).fold(0.0, f64::max);
        assert!(worst < 1e-5, "{probe}: {worst:e} N");
        let mean = forces[2000..20_000].iter().sum::<f64>() / 18_000.0;
        assert!((mean / 0.8 - 1.0).abs() < 0.02, "{probe}: {mean} N pressed with 0.8");
    }
}

#[test]
fn on_smooth_ground_it_is_the_pressing_force() {
    let smooth = || plate(0.5).micro_relief_m(0.0);
    let (steady, _) = felt(config(0.0, "fingertip"), smooth(), 0.8, 256);
    assert!((f64::from(steady[20_000]) - 0.8).abs() < 1e-6, "{}", steady[20_000]);
    let (silent, _) = felt(config(10.0, "fingertip"), smooth(), 0.8, 256);
    assert!(common::peak(&silent) < 1e-6, "{:e} N", common::peak(&silent));
}

#[test]
fn any_split_into_blocks_presses_with_the_same_bits() {
    let whole = felt(config(10.0, "stylus"), plate(0.5), 0.8, 256).0;
    assert!(common::rms(&whole) > 1e-3);
    for block_frames in [1, 63, 480] {
        assert!(felt(config(10.0, "stylus"), plate(0.5), 0.8, block_frames).0 == whole, "{block_frames}");
    }
}

#[test]
fn a_blow_in_the_hand_is_felt_as_its_force_pulse() {
    let Engine { mut scene, mut renderer, .. } = config(0.0, "rigid").build().unwrap();
    let body = scene.add_body(Body::stock(Stock::Plate, Material::WOOD, 0.3).unwrap()).unwrap();
    let impact = Impact { speed_m_s: 0.5, mass_kg: 0.02, restitution: 0.5, ..Impact::on(body) };
    scene.report(0.01, ContactEvent::Impact(Impact { actuator: Some(ChannelId(0)), ..impact })).unwrap();
    let (mut haptic, mut audio) = (vec![0.0; 4410], vec![0.0; 4410]);
    renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    let impulse_n_s = haptic.iter().map(|x| f64::from(*x)).sum::<f64>() / RATE_HZ;
    // m v (1 + e)
    assert!((impulse_n_s / (0.02 * 0.5 * 1.5) - 1.0).abs() < 1e-4, "{impulse_n_s} N·s");
    assert!(haptic.iter().all(|force_n| *force_n >= -1e-3), "a blow only pushes");
}

#[test]
fn a_tool_presses_with_its_felt_chain_whatever_it_sounds_by() {
    let stylus = probe_by_name("stylus").unwrap();
    let with = felt(config(10.0, "stylus"), plate(0.5), 0.8, 256).0;
    let without = Config { probe: Probe { tip: None, ..stylus }, ..config(10.0, "stylus") };
    assert!(felt(without, plate(0.5), 0.8, 256).0 == with);
}
