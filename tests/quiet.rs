//! Gains, mute, pause, slow motion and an end to everything, while contacts touch and bodies ring.

use crate::common;

use asperity::{
    Body, BodyId, ChannelId, Config, ContactEvent, ContactId, ContactSample, Emphasis, Engine, Impact,
    Renderer, Scene, SurfaceId, Touching,
};
use common::{bar, grating};

const RATE_HZ: f64 = 44_100.0;

struct Game {
    scene: Scene,
    renderer: Renderer,
    body: BodyId,
    surface: SurfaceId,
    /// Steps of 60 Hz so far.
    step: u32,
    frames: usize,
    haptic: Vec<f32>,
    audio: Vec<f32>,
}

impl Game {
    fn new(frames: usize) -> Self {
        let Engine { mut scene, renderer, .. } = Config::default().build().unwrap();
        let body = scene.add_body(bar()).unwrap();
        let surface = scene.add_surface(grating(2e-3, 5e-5).body(body)).unwrap();
        Self { scene, renderer, body, surface, step: 0, frames, haptic: Vec::new(), audio: Vec::new() }
    }

    fn time_s(&self) -> f64 {
        f64::from(self.step) / 60.0
    }

    fn stroke(&mut self, emphasis: Emphasis) {
        let t = self.time_s();
        let sample = ContactSample {
            uv: [0.1 + 0.7 * t, 0.5],
            velocity_m_s: Some([0.1, 0.0]),
            normal_force_n: 0.6,
            closing_m_s: 0.0,
            ..ContactSample::default()
        };
        let event = if self.step == 0 {
            let touching = Touching::on(self.surface).felt_by(ChannelId(0));
            ContactEvent::begin_with(ContactId(1), touching, sample)
        } else {
            ContactEvent::moved_with(ContactId(1), sample, emphasis)
        };
        self.scene.report(t, event).unwrap();
    }

    /// One step of 60 Hz.
    fn render(&mut self) {
        self.step += 1;
        let until = (self.time_s() * RATE_HZ) as usize;
        while self.audio.len() < until {
            let at = self.audio.len();
            let to = until.min(at + self.frames);
            self.haptic.resize(to, 0.0);
            self.audio.resize(to, 0.0);
            self.renderer.render(&mut [&mut self.haptic[at..]], &mut [&mut self.audio[at..]]);
        }
    }

    fn strokes(&mut self, steps: u32) {
        for _ in 0..steps {
            self.stroke(Emphasis::default());
            self.render();
        }
    }
}

fn rms(samples: &[f32]) -> f64 {
    (samples.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / samples.len() as f64).sqrt()
}

/// Of the last `steps` steps.
fn last(samples: &[f32], steps: usize) -> &[f32] {
    &samples[samples.len() - steps * 735..]
}

#[test]
fn a_move_softens_and_restores_a_contact_without_a_step() {
    let (mut plain, mut changed) = (Game::new(64), Game::new(64));
    plain.strokes(90);
    changed.strokes(30);
    for (gain, steps) in [(Some(0.25), 30), (Some(1.0), 30)] {
        for step in 0..steps {
            let emphasis =
                if step == 0 { Emphasis { gain, importance: Some(2.0) } } else { Emphasis::default() };
            changed.stroke(emphasis);
            changed.render();
        }
    }
    let soft = 45 * 735..60 * 735;
    let ratio = rms(&changed.haptic[soft.clone()]) / rms(&plain.haptic[soft]);
    assert!((ratio - 0.25).abs() < 1e-6, "{ratio}");
    assert!(last(&changed.haptic, 15) == last(&plain.haptic, 15), "the gain is 1 again");
    let step =
        |samples: &[f32]| samples.windows(2).fold(0.0f32, |most, pair| most.max((pair[1] - pair[0]).abs()));
    assert!(step(&changed.haptic) < 1.05 * step(&plain.haptic), "no step");
    let unusual = Emphasis { gain: Some(-1.0), importance: None };
    let sample = ContactSample {
        uv: [0.5; 2],
        velocity_m_s: None,
        normal_force_n: 0.5,
        closing_m_s: 0.0,
        ..ContactSample::default()
    };
    let refused =
        changed.scene.report(2.0, ContactEvent::moved_with(ContactId(1), sample, unusual)).unwrap_err();
    assert!(refused.to_string().starts_with("gain"), "{refused}");
}

#[test]
fn a_ringing_body_is_made_softer_and_restored_to_the_bit() {
    let (mut plain, mut changed) = (Game::new(64), Game::new(64));
    for game in [&mut plain, &mut changed] {
        game.strokes(30);
    }
    changed.scene.set_body_gain(changed.body, 0.5).unwrap();
    plain.strokes(30);
    changed.strokes(30);
    let ratio = rms(last(&changed.audio, 10)) / rms(last(&plain.audio, 10));
    assert!((ratio - 0.5).abs() < 1e-6, "{ratio}");
    changed.scene.set_body_gain(changed.body, 1.0).unwrap();
    plain.strokes(30);
    changed.strokes(30);
    assert!(last(&changed.audio, 10) == last(&plain.audio, 10));
    assert!(changed.haptic == plain.haptic, "what is felt does not know of it");
    for gain in [-0.1, f64::NAN, 1e4] {
        let error = changed.scene.set_body_gain(changed.body, gain).unwrap_err();
        assert!(error.to_string().starts_with("gain"), "{error}");
    }
    // From the beginning, the same.
    let mut half = Game::new(64);
    half.body = half.scene.add_body(Body::new(bar()).gain(0.5)).unwrap();
    half.surface = half.scene.add_surface(grating(2e-3, 5e-5).body(half.body)).unwrap();
    half.strokes(90);
    assert!((rms(&half.audio) / rms(&plain.audio) - 0.5).abs() < 1e-6);
}

#[test]
fn mute_is_silence_to_the_bit_and_everything_has_gone_on_meanwhile() {
    let (mut plain, mut muted) = (Game::new(64), Game::new(64));
    plain.strokes(90);
    muted.strokes(30);
    muted.scene.set_muted(true).unwrap();
    muted.strokes(30);
    assert!(last(&muted.audio, 20).iter().chain(last(&muted.haptic, 20)).all(|x| *x == 0.0));
    muted.scene.set_muted(false).unwrap();
    muted.strokes(30);
    assert!(last(&muted.audio, 15) == last(&plain.audio, 15));
    assert!(last(&muted.haptic, 15) == last(&plain.haptic, 15));
}

#[test]
fn a_paused_game_is_silent_until_the_next_report() {
    let mut game = Game::new(64);
    game.strokes(30);
    game.scene.pause().unwrap();
    for _ in 0..600 {
        game.render();
    }
    assert!(last(&game.audio, 590).iter().chain(last(&game.haptic, 590)).all(|x| *x == 0.0));
    game.scene.resume().unwrap();
    // The game's own time has stood still.
    let (stood, rendered) = (30, game.audio.len());
    for step in 0..30u32 {
        let t = f64::from(stood + step) / 60.0;
        let sample = ContactSample {
            uv: [0.1 + 0.7 * t, 0.5],
            velocity_m_s: Some([0.1, 0.0]),
            normal_force_n: 0.6,
            closing_m_s: 0.0,
            ..ContactSample::default()
        };
        game.scene.report(t, ContactEvent::moved(ContactId(1), sample)).unwrap();
        game.render();
    }
    let (mut plain, stats) = (Game::new(64), game.scene.stats());
    plain.strokes(60);
    let level = rms(last(&game.haptic, 10)) / rms(last(&plain.haptic, 10));
    assert!((level - 1.0).abs() < 0.05, "{level} of the stroke, {} samples", rendered);
    assert_eq!((stats.contacts, stats.orphaned, stats.lapsed), (1, 0, 0), "{stats:?}");
}

#[test]
fn an_end_to_everything_is_silent_within_a_tenth_second() {
    let strike = |game: &mut Game| {
        let t = game.time_s();
        game.scene.report(t, ContactEvent::Impact(Impact::on(game.body))).unwrap();
    };
    let mut game = Game::new(64);
    strike(&mut game);
    game.strokes(30);
    assert!(rms(last(&game.audio, 1)) > 1e-6);
    game.scene.fade_all().unwrap();
    (0..9).for_each(|_| game.render());
    assert!(last(&game.audio, 2).iter().chain(last(&game.haptic, 2)).all(|x| *x == 0.0));
    assert_eq!(game.scene.stats().contacts, 0);
    let at = game.audio.len();
    strike(&mut game);
    (0..6).for_each(|_| game.render());
    let mut fresh = Game::new(64);
    (0..39).for_each(|_| fresh.render());
    strike(&mut fresh);
    (0..6).for_each(|_| fresh.render());
    assert!(game.audio[at..] == fresh.audio[at..], "struck again, it rings as it did");
}

#[test]
fn slow_motion_with_an_exact_clock_strokes_as_slowly_as_it_says() {
    let speed = |scale: f64| {
        let mut game = Game::new(64);
        game.strokes(30);
        game.scene.set_time_scale(scale, false).unwrap();
        let (mut until, mut t) = (game.audio.len(), game.time_s());
        let began = until;
        for _ in 0..30 {
            let sample = ContactSample {
                uv: [0.1 + 0.7 * t, 0.5],
                velocity_m_s: Some([0.1, 0.0]),
                normal_force_n: 0.6,
                closing_m_s: 0.0,
                ..ContactSample::default()
            };
            game.scene.report(t, ContactEvent::moved(ContactId(1), sample)).unwrap();
            t += 1.0 / 60.0;
            until += (735.0 / scale) as usize;
            game.audio.resize(until, 0.0);
            game.haptic.resize(until, 0.0);
            let at = game.renderer.position() as usize;
            game.renderer.render(&mut [&mut game.haptic[at..]], &mut [&mut game.audio[at..]]);
        }
        // Waves of the grating that went by: 2 mm each.
        let felt = &game.haptic[began + (until - began) / 4..];
        let crossings = felt.windows(2).filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0).count();
        (crossings as f64 / (felt.len() as f64 / RATE_HZ) * 2e-3, game.scene.stats().jumps)
    };
    for scale in [0.5, 1.0, 2.0] {
        let (speed_m_s, jumps) = speed(scale);
        assert!((speed_m_s / (0.1 * scale) - 1.0).abs() < 0.06, "{scale}: {speed_m_s} m/s");
        assert_eq!(jumps, 0);
    }
}

#[test]
fn however_blocks_are_cut_the_bits_are_the_same() {
    let render = |frames: usize| {
        let mut game = Game::new(frames);
        game.strokes(10);
        game.stroke(Emphasis { gain: Some(0.3), importance: None });
        game.render();
        game.scene.set_body_gain(game.body, 2.0).unwrap();
        game.strokes(3);
        game.scene.set_muted(true).unwrap();
        game.strokes(1);
        game.scene.set_muted(false).unwrap();
        game.strokes(10);
        game.scene.fade_all().unwrap();
        game.strokes(10);
        (game.haptic, game.audio)
    };
    let reference = render(735);
    for frames in [1, 7, 64, 100] {
        assert!(render(frames) == reference, "{frames} frames a block");
    }
}
