//! Left-out work that nobody would miss, and the price of leaving it out.

use crate::common;

use asperity::files::contact_log::{ContactLog, Names};
use asperity::offline::{self, Options};
use asperity::{
    AudioBus, ChannelId, Config, ContactEvent, ContactId, ContactSample, Culling, MAX_POSITIONS, ModalModel,
    Mode, Renderer, Scene,
};
use asperity_dsp::rng::Rng;
use common::{SIDE_M, plate, stroke};
use std::collections::HashMap;

/// A body as a fit of a recording gives it: a few strong modes and hundreds of weak ones.
fn body(modes: usize) -> ModalModel {
    let mut rng = Rng::new(8);
    let modes = (0..modes).map(|i| Mode {
        frequency_hz: 150.0 * 100f64.powf(rng.uniform()),
        decay_per_s: 4.0 + 60.0 * rng.uniform(),
        amplitude: rng.normal() * 10f64.powf(-6.5 * i as f64 / modes as f64),
        phase_rad: 0.0,
    });
    ModalModel::new(modes.collect(), 0.01).unwrap()
}

fn strike(config: Config, model: ModalModel, position: usize) -> Vec<f32> {
    let asperity::Engine { mut scene, renderer, .. } = config.build().unwrap();
    let body = scene.add_body(model).unwrap();
    let names = Names { bodies: HashMap::from([("b".to_owned(), body)]), ..Names::default() };
    let line = r#"{"t":0.01,"event":"impact","body":"b","speed_m_s":0.5,"mass_kg":0.002,"radius_m":0.002,"striker":"steel","position":"#;
    let log = ContactLog::parse(&format!("{line}{position}}}"), "log").unwrap();
    offline::render(
        scene,
        renderer,
        &log,
        &names,
        &Options { block_frames: 256, tail_s: 0.5, ..Options::default() },
    )
    .unwrap()
    .audio
    .swap_remove(0)
}

/// Energy of the difference over the energy of the reference, dB.
fn error_db(found: &[f32], reference: &[f32]) -> f64 {
    let difference: Vec<f32> = found.iter().zip(reference).map(|(a, b)| a - b).collect();
    20.0 * (common::rms(&difference) / common::rms(reference)).log10()
}

#[test]
fn inaudible_modes_are_left_out_with_the_error_below_them() {
    let all = body(400);
    let whole = strike(Config { culling: None, ..Config::default() }, all.clone(), 0);
    // What is left out, how many modes must go, and how much of the sound may go with them.
    for (culling, at_most, bar_db) in [
        (Culling::NEGLIGIBLE, 385, -100.0),
        (Culling { masking: false, ..Culling::default() }, 300, -60.0),
        (Culling::default(), 120, -20.0),
    ] {
        let kept = all.audible(44_100.0, &culling).modes.len();
        let culled = strike(Config { culling: Some(culling), ..Config::default() }, all.clone(), 0);
        let error = error_db(&culled, &whole);
        println!(
            "{} dB, masking {}: {kept} of 400 modes, error {error:.1} dB",
            culling.level_db, culling.masking
        );
        assert!(kept < at_most, "{kept} modes of 400 are kept");
        assert!(error < bar_db, "{error} dB");
    }
}

#[test]
fn a_body_sounds_as_it_is_struck() {
    let mut rng = Rng::new(3);
    let base = body(50);
    let elsewhere: Vec<Vec<f64>> =
        (0..3).map(|_| base.modes.iter().map(|m| m.amplitude * rng.normal()).collect()).collect();
    let model = base.clone().with_positions(elsewhere.clone()).unwrap();
    let plain = |amplitudes: &[f64]| {
        let modes = base.modes.iter().zip(amplitudes).map(|(m, a)| Mode { amplitude: *a, ..*m });
        ModalModel::new(modes.collect(), base.impulse_n_s).unwrap()
    };
    let own: Vec<f64> = base.modes.iter().map(|m| m.amplitude).collect();
    for (position, amplitudes) in [&own].into_iter().chain(&elsewhere).enumerate() {
        let found = strike(Config::default(), model.clone(), position);
        let expected = strike(Config::default(), plain(amplitudes), 0);
        let error = error_db(&found, &expected);
        assert!(error < -100.0, "position {position}: {error} dB");
    }
    let last = strike(Config::default(), model.clone(), 3);
    assert_eq!(strike(Config::default(), model, 99), last, "a position beyond the last counts as the last");
}

#[test]
fn two_fingers_on_two_positions_add_up() {
    // Loud, so that no mode falls asleep in one rendering and not in another.
    let model = ModalModel { impulse_n_s: 1e-7, ..body(40) };
    let amplitudes = model.modes.iter().rev().map(|m| m.amplitude).collect();
    let model = model.with_positions(vec![amplitudes]).unwrap();
    let slide = |touching: &[usize]| {
        let asperity::Engine { mut scene, mut renderer, .. } = Config::default().build().unwrap();
        let body = scene.add_body(model.clone()).unwrap();
        for (finger, &position) in touching.iter().enumerate() {
            let surface = plate(0.8).body(body).at_strike_position(position);
            let surface = scene.add_surface(surface).unwrap();
            let event = ContactEvent::begin(ContactId(finger as u64), surface, ChannelId(0), sliding());
            scene.report(0.0, event).unwrap();
        }
        let (mut haptic, mut audio) = (vec![0.0; 8820], vec![0.0; 8820]);
        renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        audio
    };
    let (first, second, both) = (slide(&[0]), slide(&[1]), slide(&[0, 1]));
    let sum: Vec<f32> = first.iter().zip(&second).map(|(a, b)| a + b).collect();
    let error = error_db(&both, &sum);
    assert!(error < -100.0, "{error} dB");
    assert!(error_db(&first, &second) > -10.0, "the positions sound differently");
}

#[test]
fn a_modes_file_may_list_positions_and_is_refused_when_wrong() {
    let text = r#"{"format":"asperity.modes","version":1,"modes":[{"frequency_hz":440.0,"decay_per_s":3.0,"amplitude":1.0}],"positions":[[0.5],[-2.0]]}"#;
    let model = ModalModel::parse(text).unwrap();
    assert_eq!(model.position_count(), 3);
    assert_eq!(ModalModel::parse(&model.to_json()).unwrap(), model);
    let refused = ModalModel::parse(&text.replace("[0.5]", "[0.5,0.1]")).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "positions[0]: 2.0 is refused; must be as many amplitudes as there are modes"
    );
    assert!(model.clone().with_positions(vec![vec![f64::NAN]]).is_err());
    assert!(model.with_positions(vec![vec![1.0]; MAX_POSITIONS]).is_err());
}

fn sliding() -> ContactSample {
    ContactSample {
        uv: [0.1, 0.4],
        velocity_m_s: Some([0.1, 0.02]),
        normal_force_n: 0.6,
        closing_m_s: 0.0,
        ..ContactSample::default()
    }
}

/// Ten fingers that stroke a body of 80 modes, reported at 60 Hz.
struct TenFingers {
    scene: Scene,
    renderer: Renderer,
    reported: u64,
}

impl TenFingers {
    fn new(config: Config) -> Self {
        Self::on(body(80), config)
    }

    fn on(body: ModalModel, config: Config) -> Self {
        let asperity::Engine { mut scene, renderer, .. } = config.build().unwrap();
        let body = scene.add_body(body).unwrap();
        let surface = scene.add_surface(plate(0.9).body(body)).unwrap();
        for finger in 0..10 {
            let event = ContactEvent::begin(ContactId(finger), surface, ChannelId(0), Self::at(finger, 0.0));
            scene.report(0.0, event).unwrap();
        }
        Self { scene, renderer, reported: 0 }
    }

    /// Slides at 0.1 m/s, each finger on a line of its own.
    fn at(finger: u64, time_s: f64) -> ContactSample {
        let (u, v) = (0.1 * finger as f64 + 0.1 * time_s / SIDE_M, 0.05 + 0.09 * finger as f64);
        ContactSample {
            uv: [u, v],
            velocity_m_s: Some([0.1, 0.0]),
            normal_force_n: 0.3 + 0.05 * finger as f64,
            closing_m_s: 0.0,
            ..ContactSample::default()
        }
    }

    /// Renders `count` blocks of 64 and returns the audio; before each, `load` is reported.
    fn blocks(&mut self, count: usize, load: Option<f32>) -> Vec<f32> {
        let mut all = Vec::new();
        let (mut haptic, mut audio) = ([0.0f32; 64], [0.0f32; 64]);
        for _ in 0..count {
            if self.renderer.position() as f64 / 44_100.0 >= self.reported as f64 / 60.0 {
                self.reported += 1;
                let time_s = self.reported as f64 / 60.0;
                for finger in 0..10 {
                    let event = ContactEvent::moved(ContactId(finger), Self::at(finger, time_s));
                    self.scene.report(time_s, event).unwrap();
                }
            }
            if let Some(load) = load {
                self.renderer.report_load(load);
            }
            self.renderer.render(&mut [&mut haptic], &mut [&mut audio]);
            all.extend_from_slice(&audio);
        }
        all
    }
}

#[test]
fn nothing_is_ever_left_out_where_nobody_reports_a_load() {
    let mut unreported = TenFingers::new(Config::default());
    let sound = unreported.blocks(100, None);
    assert!(common::rms(&sound) > 0.0);
    assert_eq!(unreported.scene.stats().shed, 0);
    let mut switched_off = TenFingers::new(Config { shed_load: false, ..Config::default() });
    assert_eq!(switched_off.blocks(100, Some(3.0)), sound);
    assert_eq!((switched_off.scene.stats().shed, switched_off.scene.stats().load), (0, 3.0));
}

#[test]
fn a_late_engine_leaves_out_the_least_first_and_takes_everything_back() {
    let mut late = TenFingers::new(Config::default());
    let mut whole = TenFingers::new(Config::default());
    assert_eq!(late.blocks(200, None), whole.blocks(200, None));
    // The engine's own work is two thirds of its time.
    assert_eq!(late.blocks(31, Some(0.7)), whole.blocks(31, None));
    // One late block, then neither late nor easy for half a second: the modes of a small body save
    // less than a tenth and go together with the two least fingers. Then two more a level, and
    // nothing of those that stay.
    let mut shed = 0;
    for fewer in 1..=3 {
        late.blocks(1, Some(0.9));
        late.blocks(344, Some(0.7));
        whole.blocks(345, None);
        assert_eq!(late.scene.stats().contacts, 10 - 2 * fewer);
        assert!(late.scene.stats().shed > shed, "level {fewer} leaves something out");
        shed = late.scene.stats().shed;
    }
    late.blocks(30, Some(2.0));
    whole.blocks(30, None);
    let few = late.scene.stats().contacts;
    assert!((1..=3).contains(&few), "{few} contacts are left");
    // Easy again: four levels of half a second; then every finger sounds again, and as if nothing
    // had been.
    late.blocks(3600, Some(0.1));
    whole.blocks(3600, None);
    assert_eq!(late.scene.stats().contacts, 10, "the next move revives a contact");
    shed = late.scene.stats().shed;
    let (found, wanted) = (late.blocks(344, Some(0.1)), whole.blocks(344, None));
    assert_eq!(late.scene.stats().shed, shed, "nothing is left out any more");
    let error = error_db(&found, &wanted);
    println!("after recovery: error {error:.1} dB");
    assert!(error < -60.0, "{error} dB");
}

/// Modes that are left out by ear are not those that err least by waveform
/// (`cli/tests/perceptual_order.rs` holds what is heard).
#[test]
fn a_late_engine_of_many_bodies_sheds_modes_and_no_finger() {
    let stroked = |late: bool| {
        let mut fingers = TenFingers::on(body(2000), Config { culling: None, ..Config::default() });
        fingers.blocks(200, None);
        // Busy, late once, then neither late nor easy.
        fingers.blocks(31, Some(0.7));
        fingers.blocks(1, Some(if late { 0.9 } else { 0.7 }));
        let sound = fingers.blocks(344, Some(0.7));
        (sound, fingers.scene.stats())
    };
    let ((whole, nothing), (found, less)) = (stroked(false), stroked(true));
    let louder_db = 20.0 * (common::rms(&found) / common::rms(&whole)).log10();
    println!("error {:.1} dB, {louder_db:+.2} dB louder", error_db(&found, &whole));
    assert!(error_db(&found, &whole) < -35.0 && louder_db.abs() < 0.1);
    assert_eq!((nothing.shed, nothing.contacts, less.contacts), (0, 10, 10));
    assert!(less.shed > 0);
}

#[test]
fn how_loud_a_body_is_decides_which_of_its_modes_nobody_hears() {
    let shed = |pascals_at_full_scale| {
        let audio = vec![AudioBus { pascals_at_full_scale, ..AudioBus::default() }];
        let asperity::Engine { mut scene, mut renderer, .. } =
            Config { audio, culling: None, ..Config::default() }.build().unwrap();
        let body = scene.add_body(body(400)).unwrap();
        // Busy, and late once.
        (0..31).for_each(|_| renderer.report_load(0.7));
        renderer.report_load(0.9);
        let impact = asperity::Impact::from_impulse(body, 1e-3, 1.0, 1.0);
        scene.report(0.0, ContactEvent::Impact(impact)).unwrap();
        let (mut haptic, mut audio) = (vec![0.0; 6400], vec![0.0; 6400]);
        renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        scene.stats().shed
    };
    // Its loudest mode is at 30 dB SPL and less, at what nobody knows, and at 100.
    let [quiet, unknown, loud] = [Some(1e-4), None, Some(10.0)].map(shed);
    println!("left out in 6400 samples, groups: {quiet}, {unknown}, {loud}");
    assert!(quiet > unknown && unknown >= loud && loud > 0, "{quiet}, {unknown}, {loud}");
}

#[test]
fn a_hiccup_of_the_host_costs_neither_sound_nor_contacts() {
    for late_blocks in [1, 3, 8] {
        let mut disturbed = TenFingers::new(Config::default());
        let mut whole = TenFingers::new(Config::default());
        assert_eq!(disturbed.blocks(100, Some(0.01)), whole.blocks(100, None));
        assert_eq!(disturbed.blocks(late_blocks, Some(4.0)), whole.blocks(late_blocks, None));
        assert_eq!(disturbed.blocks(300, Some(0.01)), whole.blocks(300, None));
        let stats = disturbed.scene.stats();
        assert_eq!((stats.shed, stats.stolen, stats.contacts), (0, 0, 10), "{late_blocks} late blocks");
    }
}

#[test]
fn culling_does_not_touch_what_a_stroke_sounds_like() {
    let log = stroke(SIDE_M, 0.1, 0.5, 0.3);
    let options = Options { block_frames: 256, tail_s: 0.2, ..Options::default() };
    let with = |culling| {
        common::render(Config { culling, ..Config::default() }, plate(0.8), &log, &options)
            .audio
            .swap_remove(0)
    };
    assert!(
        error_db(&with(Some(Culling::NEGLIGIBLE)), &with(None)) < -100.0
            || with(None) == with(Some(Culling::NEGLIGIBLE))
    );
}
