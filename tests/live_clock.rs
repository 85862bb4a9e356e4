//! A live game's clock: pauses, slow motion, restarts, stamps that are off, ticks in bursts. No
//! strike is lost, no contact sticks, nothing falls silent, and the counts say what happened.

use crate::common;

use asperity::{
    ActuatorSettings, BodyId, ChannelId, Config, ContactEvent, ContactId, ContactSample, Impact, Material,
    Renderer, Scene, Stats, SurfaceId,
};
use common::{SIDE_M, bar, peak, plate, rms};

const RATE_HZ: f64 = 48_000.0;
const FRAME_S: f64 = 1.0 / 60.0;
const SPEED_M_S: f64 = 0.1;

/// A game that strokes a plate and strikes it 30 times, while its time does what it likes.
struct Game {
    scene: Scene,
    renderer: Renderer,
    body: BodyId,
    surface: SurfaceId,
    refused: usize,
    strikes: usize,
    listened_s: f64,
    haptic: Vec<f32>,
    audio: Vec<f32>,
}

impl Game {
    fn new() -> Self {
        let si = ActuatorSettings { full_scale: 1.0, ..ActuatorSettings::default() };
        let asperity::Engine { mut scene, renderer, .. } =
            Config { actuators: vec![si], ..common::raw_live(RATE_HZ) }.build().unwrap();
        let body = scene.add_body(bar()).unwrap();
        let surface = scene.add_surface(plate(0.8)).unwrap();
        let (haptic, audio) = (Vec::new(), Vec::new());
        Self { scene, renderer, body, surface, refused: 0, strikes: 0, listened_s: 0.0, haptic, audio }
    }

    fn report(&mut self, time_s: f64, event: ContactEvent) {
        self.refused += usize::from(self.scene.report(time_s, event).is_err());
    }

    fn strike(&mut self, time_s: f64) {
        let impact = Impact {
            body: self.body,
            other: None,
            speed_m_s: 0.5,
            mass_kg: 0.01,
            radius_m: 0.005,
            striker: Material::STEEL,
            restitution: 1.0,
            position: 0,
            ..Impact::on(self.body)
        };
        self.strikes += 1;
        self.report(time_s, ContactEvent::Impact(impact));
    }

    /// The audio goes on by a frame.
    fn listen(&mut self, seconds: f64) {
        self.listened_s += seconds;
        let end = (self.listened_s * RATE_HZ).round() as usize;
        while self.haptic.len() + 256 <= end {
            let (mut haptic, mut audio) = ([0.0; 256], [0.0; 256]);
            self.renderer.render(&mut [&mut haptic], &mut [&mut audio]);
            self.haptic.extend(haptic);
            self.audio.extend(audio);
        }
    }

    fn touch(&self, way_s: f64) -> ContactSample {
        ContactSample {
            uv: [0.1 + SPEED_M_S * way_s / SIDE_M, 0.5],
            velocity_m_s: Some([SPEED_M_S, 0.0]),
            normal_force_n: 0.6,
            closing_m_s: 0.0,
            ..ContactSample::default()
        }
    }
}

/// One tick of the game: when the game says it is, and how far its world has come, s.
struct Tick {
    stamp_s: f64,
    world_s: f64,
}

/// Plays ticks by frames, ends the contact and listens for another second. `silences` frames, in
/// which nothing is reported, may be quiet.
fn play(what: &str, frames: &[Vec<Tick>]) -> Stats {
    let mut game = Game::new();
    let (mut begun, mut ticks) = (false, 0);
    let mut loud_s = Vec::new();
    for frame in frames {
        for tick in frame {
            let sample = game.touch(tick.world_s);
            let event = if begun {
                ContactEvent::moved(ContactId(1), sample)
            } else {
                ContactEvent::begin(ContactId(1), game.surface, ChannelId(0), sample)
            };
            begun = true;
            game.report(tick.stamp_s, event);
            if ticks % 15 == 7 {
                game.strike(tick.stamp_s);
                loud_s.push(game.haptic.len());
            }
            ticks += 1;
        }
        game.listen(FRAME_S);
    }
    let last = frames.iter().flatten().last().unwrap().stamp_s;
    game.report(last, ContactEvent::end(ContactId(1)));
    game.listen(1.0);
    let stats = game.scene.stats();
    println!(
        "{what}: {} jumps, {} paces, {} late, {} lapsed of {} events",
        stats.clock_jumps, stats.clock_paces, stats.late, stats.lapsed, stats.events
    );
    assert_eq!(game.refused, 0, "{what}");
    assert_eq!(stats.impacts, game.strikes as u64, "{what}: a strike is lost");
    assert_eq!(stats.contacts, 0, "{what}: a contact sticks");
    assert_eq!(stats.orphaned, 0, "{what}");
    // Each strike sounds within 0.3 s of its report, or as soon as it was reported.
    for at in loud_s {
        let window = &game.audio[at..(at + 14_400).min(game.audio.len())];
        assert!(peak(window) > 0.05, "{what}: silence {:.2} s in", at as f64 / RATE_HZ);
    }
    // The stroke is felt in every half second in which the world moved.
    let frame_samples = (FRAME_S * RATE_HZ) as usize;
    let mut at = 30;
    while at + 30 < frames.len() {
        if frames[at..at + 30].iter().all(|frame| !frame.is_empty()) {
            let felt = rms(&game.haptic[at * frame_samples..(at + 30) * frame_samples]);
            assert!(felt > 1e-7, "{what}: nothing is felt {:.2} s in: {felt}", at as f64 * FRAME_S);
        }
        at += 30;
    }
    stats
}

/// A game of 7 s whose stamps are a function of the frame.
fn stamped(stamp_s: impl Fn(f64) -> f64) -> Vec<Vec<Tick>> {
    (0..420)
        .map(|frame| {
            let now_s = f64::from(frame) * FRAME_S;
            vec![Tick { stamp_s: stamp_s(now_s), world_s: now_s }]
        })
        .collect()
}

#[test]
fn a_game_that_just_runs_is_tied_once() {
    let stats = play("steady", &stamped(|t| t));
    assert_eq!((stats.clock_jumps, stats.clock_paces, stats.lapsed), (0, 0, 0));
}

#[test]
fn game_time_may_be_anywhere() {
    for ahead_s in [12.3, 1000.0, 1e6, -5.0] {
        let stats = play("ahead", &stamped(|t| t + ahead_s));
        assert_eq!((stats.clock_jumps, stats.clock_paces), (0, 0));
    }
}

#[test]
fn a_level_restart_at_0_and_a_wrong_stamp_mute_nobody() {
    let stats = play("restart at 0", &stamped(|t| if t < 3.0 { 100.0 + t } else { t - 3.0 }));
    assert_eq!(stats.clock_jumps, 1);
    for off_s in [1e6, -1e6, 30.0] {
        let stats = play("one stamp off", &stamped(|t| if (t - 3.0).abs() < 1e-3 { t + off_s } else { t }));
        assert_eq!(stats.clock_jumps, 2);
    }
    let stats = play("12 s ahead from now on", &stamped(|t| if t < 3.0 { t } else { t + 12.0 }));
    assert_eq!(stats.clock_jumps, 1);
}

#[test]
fn a_game_that_pauses_goes_on_sounding() {
    // Two seconds without a tick, after which game time goes on where it stood.
    let frames: Vec<Vec<Tick>> = (0..420)
        .map(|frame| {
            let now_s = f64::from(frame) * FRAME_S;
            let world_s = if frame < 180 { now_s } else { now_s - 2.0 };
            let paused = (180..300).contains(&frame);
            if paused { Vec::new() } else { vec![Tick { stamp_s: world_s, world_s }] }
        })
        .collect();
    let stats = play("pause", &frames);
    assert_eq!((stats.clock_jumps, stats.lapsed), (1, 1));
    // The same, but the paused game goes on reporting the frame it stands at.
    let frames: Vec<Vec<Tick>> = (0..420)
        .map(|frame| {
            let now_s = f64::from(frame) * FRAME_S;
            let world_s = if frame < 180 { now_s } else { (now_s - 2.0).max(180.0 * FRAME_S) };
            vec![Tick { stamp_s: world_s, world_s }]
        })
        .collect();
    let mut game = Game::new();
    let event = ContactEvent::begin(ContactId(1), game.surface, ChannelId(0), game.touch(0.0));
    game.report(0.0, event);
    for frame in &frames {
        for tick in frame {
            let event = ContactEvent::moved(ContactId(1), game.touch(tick.world_s));
            game.report(tick.stamp_s, event);
        }
        game.listen(FRAME_S);
    }
    let stats = game.scene.stats();
    assert!((1..=10).contains(&stats.clock_jumps), "{} jumps", stats.clock_jumps);
    let felt = |from_s: f64| {
        let at = (from_s * RATE_HZ) as usize;
        rms(&game.haptic[at..at + 24_000])
    };
    // It has glided on for want of news and comes back to where the game says it stands: at rest
    // 1.25 s after the pause began.
    assert!(felt(4.25) < 0.02 * felt(2.0), "a paused finger is felt: {} against {}", felt(4.25), felt(2.0));
    assert!(felt(6.0) > 0.3 * felt(2.0), "{} against {}", felt(6.0), felt(2.0));
}

#[test]
fn slow_motion_and_fast_motion_are_followed() {
    for pace in [0.25, 0.5, 3.0] {
        let frames: Vec<Vec<Tick>> = (0..420)
            .map(|frame| {
                let now_s = f64::from(frame) * FRAME_S;
                let world_s = if now_s < 2.0 { now_s } else { 2.0 + pace * (now_s - 2.0) };
                vec![Tick { stamp_s: world_s, world_s }]
            })
            .collect();
        let stats = play(&format!("pace {pace}"), &frames);
        assert!((1..=3).contains(&stats.clock_paces), "{pace}: {} paces", stats.clock_paces);
        assert!(stats.clock_jumps <= 12, "{pace}: {} jumps", stats.clock_jumps);
        assert_eq!(stats.lapsed, 0);
    }
}

#[test]
fn eight_ticks_at_once_keep_their_distances() {
    let frames: Vec<Vec<Tick>> = (0..420)
        .map(|frame| {
            let ticks = if frame % 8 == 7 { frame - 7..frame + 1 } else { 0..0 };
            let at = |tick: i32| f64::from(tick) * FRAME_S;
            ticks.map(|tick| Tick { stamp_s: at(tick), world_s: at(tick) }).collect()
        })
        .collect();
    let stats = play("bursts", &frames);
    assert_eq!((stats.clock_jumps, stats.clock_paces, stats.lapsed), (0, 0, 0));
}

#[test]
fn a_reset_ties_an_exact_clock_anew_and_drops_what_waited() {
    let asperity::Engine { mut scene, mut renderer, .. } = Config::default().build().unwrap();
    let body = scene.add_body(bar()).unwrap();
    let impact = ContactEvent::Impact(Impact {
        body,
        other: None,
        speed_m_s: 0.5,
        mass_kg: 0.01,
        radius_m: 0.005,
        striker: Material::STEEL,
        restitution: 1.0,
        position: 0,
        ..Impact::on(body)
    });
    let (mut haptic, mut audio) = (vec![0.0; 4410], vec![0.0; 4410]);
    scene.report(12.0, impact).unwrap();
    renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    assert_eq!(peak(&audio), 0.0, "an exact clock waits");
    assert!(scene.stats().ahead > 500_000, "and says so: {} samples", scene.stats().ahead);
    scene.reset().unwrap();
    scene.report(0.0, impact).unwrap();
    scene.report(0.05, impact).unwrap();
    renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    let asperity::Engine { scene: mut at_once, renderer: mut fresh, .. } = Config::default().build().unwrap();
    at_once.add_body(bar()).unwrap();
    at_once.report(0.0, impact).unwrap();
    at_once.report(0.05, impact).unwrap();
    let mut expected = vec![0.0; 4410];
    fresh.render(&mut [&mut haptic], &mut [&mut expected]);
    for (n, (x, expected)) in audio.iter().zip(&expected).enumerate() {
        assert!((x - expected).abs() < 1e-3 * peak(&audio) as f32, "sample {n}: {x}, {expected}");
    }
    assert_eq!((scene.stats().impacts, scene.stats().superseded), (2, 1));
}
