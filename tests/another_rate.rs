//! The device comes back at another sample rate: the scene goes on, and every id means what it
//! meant.

use asperity::live::channel_map::{ChannelMap, Interleaver};
use asperity::live::null_sink::NullSink;
use asperity::surface::height_map::HeightMap;
use asperity::surface::raster::Raster;
use asperity::surface::sand::{SandDesign, SandSource};
use asperity::{
    Body, BodyId, BusId, ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Extent, Impact,
    ModalModel, Mode, Renderer, Scene, Surface, SurfaceId, Touching, probe_by_name,
};
use std::f64::consts::TAU;

const MODE_HZ: f64 = 812.0;
const WAVE_M: f64 = 2e-3;

/// A bell under a grating, at a rate.
fn game(sample_rate_hz: f64) -> (Scene, Renderer, BodyId, SurfaceId) {
    let Engine { mut scene, renderer, .. } = Config { sample_rate_hz, ..Config::default() }.build().unwrap();
    let mode = Mode { frequency_hz: MODE_HZ, decay_per_s: 10.0, amplitude: 0.3, phase_rad: 0.0 };
    let bell = scene.add_body(Body::new(ModalModel::new(vec![mode], 0.01).unwrap())).unwrap();
    let values = (0..200).map(|x| 0.5 + 0.5 * (TAU * f64::from(x) / 20.0).sin()).collect();
    let raster = Raster { width: 200, height: 1, values };
    let extent = Extent { width_m: 10.0 * WAVE_M, height_m: 0.02, relief_m: 1e-4 };
    let map = HeightMap::new(&raster, extent, asperity::Wrap::Repeat).unwrap();
    let grating = Surface::new(map, extent.width_m, 0.02).unwrap().micro_relief_m(0.0).body(bell);
    let grating = scene.add_surface(grating).unwrap();
    (scene, renderer, bell, grating)
}

fn render(renderer: &mut Renderer, seconds: f64) -> [Vec<f32>; 2] {
    let frames = (seconds * renderer.sample_rate_hz()).round() as usize;
    let [mut haptic, mut audio] = [vec![0.0; frames], vec![0.0; frames]];
    renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    [haptic, audio]
}

/// Amplitude of a tone over a whole stretch.
fn tone(samples: &[f32], hz: f64, rate_hz: f64) -> f64 {
    let turn = |i: usize| TAU * hz * i as f64 / rate_hz;
    let sum = samples.iter().enumerate().fold([0.0; 2], |[c, s], (i, x)| {
        [c + f64::from(*x) * turn(i).cos(), s + f64::from(*x) * turn(i).sin()]
    });
    2.0 * sum[0].hypot(sum[1]) / samples.len() as f64
}

/// Strokes at 0.2 m/s from one time to another; what is felt and heard.
fn stroke(
    scene: &mut Scene,
    renderer: &mut Renderer,
    on: SurfaceId,
    from: u32,
    to: u32,
    begins: bool,
) -> [Vec<f32>; 2] {
    let mut all = [Vec::new(), Vec::new()];
    for step in from..to {
        let t = f64::from(step) / 50.0;
        let sample = ContactSample {
            uv: [0.2 * t / (10.0 * WAVE_M), 0.5],
            velocity_m_s: Some([0.2, 0.0]),
            normal_force_n: 0.6,
            closing_m_s: 0.0,
            ..ContactSample::default()
        };
        let event = if begins && step == from {
            ContactEvent::begin(ContactId(1), on, ChannelId(0), sample)
        } else {
            ContactEvent::moved(ContactId(1), sample)
        };
        scene.report(t, event).unwrap();
        let rendered = render(renderer, 0.02);
        all.iter_mut().zip(rendered).for_each(|(all, rendered)| all.extend(rendered));
    }
    all
}

#[test]
fn bodies_surfaces_contacts_and_ids_go_on_at_the_same_second() {
    let (mut scene, mut renderer, bell, grating) = game(44_100.0);
    scene.set_audio_gain(BusId(0), 0.5).unwrap();
    stroke(&mut scene, &mut renderer, grating, 0, 50, true);
    let mut renderer = scene.at_rate(renderer, 48_000.0).unwrap().renderer;
    assert_eq!((renderer.sample_rate_hz(), renderer.position()), (48_000.0, 48_000));
    assert_eq!(scene.config().sample_rate_hz, 48_000.0);
    // The finger is still there: its next move brings it back.
    let [felt, _] = stroke(&mut scene, &mut renderer, grating, 50, 100, false);
    let stats = scene.stats();
    assert_eq!((stats.orphaned, stats.refused, stats.quarantined, stats.contacts), (0, 0, 0, 1));

    // As in an engine that ran at that rate all the time.
    let (mut other, mut its_renderer, _, its_grating) = game(48_000.0);
    let [fresh, _] = stroke(&mut other, &mut its_renderer, its_grating, 0, 100, true);
    let late = |samples: &[f32]| tone(&samples[samples.len() - 19_200..], 0.2 / WAVE_M, 48_000.0);
    assert!((late(&felt) / late(&fresh) - 1.0).abs() < 0.01, "{} {}", late(&felt), late(&fresh));

    scene.report(2.0, ContactEvent::end(ContactId(1))).unwrap();
    render(&mut renderer, 1.0);
    scene.report(3.0, ContactEvent::Impact(Impact::on(bell))).unwrap();
    let [_, heard] = render(&mut renderer, 0.5);
    let (there, elsewhere) = (tone(&heard, MODE_HZ, 48_000.0), tone(&heard, MODE_HZ * 48.0 / 44.1, 48_000.0));
    assert!(there > 20.0 * elsewhere, "the pitch: {there} {elsewhere}");
    scene.replace_body(bell, ModalModel::silent()).unwrap();
    scene.remove_surface(grating).unwrap();
    assert!(scene.remove_surface(grating).is_err());
}

#[test]
fn probes_gains_and_sand_are_kept_and_waiting_events_come() {
    let config = Config { audio: vec![asperity::AudioBus::default(); 2], ..Config::default() };
    let Engine { mut scene, mut renderer, .. } = config.build().unwrap();
    let mode = Mode { frequency_hz: MODE_HZ, decay_per_s: 10.0, amplitude: 0.3, phase_rad: 0.0 };
    let bell = scene.add_body(ModalModel::new(vec![mode], 0.01).unwrap()).unwrap();
    scene.set_body_bus(bell, BusId(1)).unwrap();
    let stylus = scene.add_probe(probe_by_name("stylus").unwrap()).unwrap();
    let design = SandDesign { cells: 64, ..SandDesign::default() };
    let sand = Surface::new(SandSource::synchronous(&design, 1).unwrap(), 0.25, 0.25).unwrap();
    let sand = scene.add_surface(sand).unwrap();
    scene.set_haptic_gain(ChannelId(0), 0.0).unwrap();
    let play = |renderer: &mut Renderer, seconds: f64| {
        let frames = (seconds * renderer.sample_rate_hz()).round() as usize;
        let [mut haptic, mut left, mut right] = [vec![0.0; frames], vec![0.0; frames], vec![0.0; frames]];
        renderer.render(&mut [&mut haptic], &mut [&mut left, &mut right]);
        [haptic, left, right]
    };
    play(&mut renderer, 0.5);
    // Reported before the change, for after it.
    scene.report(0.75, ContactEvent::Impact(Impact::on(bell))).unwrap();
    let mut renderer = scene.at_rate(renderer, 96_000.0).unwrap().renderer;
    let [_, left, right] = play(&mut renderer, 0.5);
    let first = right.iter().position(|x| *x != 0.0).unwrap() as f64 / 96_000.0;
    assert!(left.iter().all(|x| *x == 0.0) && (first - 0.25).abs() < 1e-3, "struck after {first} s");
    let touching = Touching::on(sand).felt_by(ChannelId(0)).probe(stylus);
    for step in 0..30 {
        let t = 1.0 + f64::from(step) / 60.0;
        let sample = ContactSample {
            uv: [0.2 + 0.3 * (t - 1.0), 0.5],
            velocity_m_s: Some([0.08, 0.0]),
            normal_force_n: 0.6,
            closing_m_s: 0.0,
            ..ContactSample::default()
        };
        let event = if step == 0 {
            ContactEvent::begin_with(ContactId(1), touching, sample)
        } else {
            ContactEvent::moved(ContactId(1), sample)
        };
        scene.report(t, event).unwrap();
        let [haptic, ..] = play(&mut renderer, 1.0 / 60.0);
        assert!(haptic.iter().all(|x| *x == 0.0), "the channel is muted");
    }
    scene.set_haptic_gain(ChannelId(0), 1.0).unwrap();
    let [haptic, ..] = play(&mut renderer, 0.2);
    assert!(haptic.iter().any(|x| *x != 0.0));
    assert_eq!(scene.stats().orphaned + scene.stats().refused + scene.stats().quarantined, 0);
}

#[test]
fn a_rate_that_no_engine_has_leaves_everything_as_it_was() {
    let (mut scene, renderer, bell, _) = game(44_100.0);
    let refused = scene.at_rate(renderer, 100.0).unwrap_err();
    assert!(refused.to_string().contains("sample_rate_hz: 100 is refused"), "{refused}");
    let mut renderer = *refused.renderer;
    scene.report(0.0, ContactEvent::Impact(Impact::on(bell))).unwrap();
    let [_, heard] = render(&mut renderer, 0.3);
    assert!(tone(&heard, MODE_HZ, 44_100.0) > 1e-3);
}

#[test]
fn a_null_sink_returns_its_renderer_and_another_continues_with_it() {
    let (mut scene, renderer, bell, _) = game(44_100.0);
    let map = || ChannelMap::stereo_then_haptics(1);
    let sink = NullSink::start(Interleaver::new(renderer, map()), 256).unwrap();
    std::thread::sleep(std::time::Duration::from_millis(50));
    let (device, _) = sink.stop().unwrap();
    let renderer = scene.at_rate(device.into_renderer(), 48_000.0).unwrap().renderer;
    let sink = NullSink::start(Interleaver::new(renderer, map()), 256).unwrap();
    let now_s = scene.stats().position as f64 / 48_000.0;
    scene.report(now_s, ContactEvent::Impact(Impact::on(bell))).unwrap();
    let began = std::time::Instant::now();
    while scene.stats().impacts == 0 && began.elapsed().as_secs() < 20 {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    assert!(sink.stop().is_some() && scene.stats().impacts == 1);
}
