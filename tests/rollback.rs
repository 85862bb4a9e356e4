//! Strikes with a name under rollback: a game that predicts reports ticks again, takes back what
//! did not happen, and hears each strike once.

use crate::common;

use asperity::files::contact_log::Names;
use asperity::{BodyId, Config, Engine, Impact, Renderer, Scene};
use asperity_dsp::rng::Rng;
use common::bar;

const TICK_S: f64 = 1.0 / 60.0;

struct Game {
    scene: Scene,
    renderer: Renderer,
    body: BodyId,
}

impl Game {
    fn new() -> Self {
        let Engine { mut scene, renderer, .. } = Config::live(48_000.0).build().unwrap();
        let body = scene.add_body(bar()).unwrap();
        Self { scene, renderer, body }
    }

    fn strike(&mut self, tick: u64, speed_m_s: f64) {
        let impact = Impact::on(self.body).at_speed(speed_m_s);
        self.scene.report_named(100.0 + tick as f64 * TICK_S, tick, impact).unwrap();
    }

    /// A frame of audio, in blocks of 160 samples.
    fn render(&mut self) {
        for _ in 0..5 {
            let (mut haptic, mut audio) = ([0.0; 160], [0.0; 160]);
            self.renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        }
    }
}

#[test]
fn a_thousand_strikes_under_rollback_are_heard_once_each() {
    let (mut game, mut rng) = (Game::new(), Rng::new(8));
    for tick in 0..1000u64 {
        let back = (9.0 * rng.uniform()) as u64;
        for again in tick.saturating_sub(back)..=tick {
            // What the other player did turns out a little different.
            let speed = if rng.uniform() < 0.5 { 1.0 } else { 1.0 + 0.01 * rng.uniform() };
            game.strike(again, speed);
        }
        game.render();
    }
    (0..4).for_each(|_| game.render());
    let stats = game.scene.stats();
    assert_eq!(stats.impacts, 1000, "{stats:?}");
    assert_eq!((stats.clock_jumps, stats.dropped, stats.refused), (0, 0, 0), "{stats:?}");
    assert!(stats.repeated > 2000, "{stats:?}");
}

#[test]
fn a_strike_that_waits_is_withdrawn_and_one_that_sounded_is_not() {
    let mut game = Game::new();
    game.strike(0, 1.0);
    game.render();
    assert!(!game.scene.withdraw(0), "it has sounded");
    game.strike(1, 1.0);
    assert!(game.scene.withdraw(1) && !game.scene.withdraw(1));
    game.render();
    assert_eq!((game.scene.stats().impacts, game.scene.stats().withdrawn), (1, 1));
    // It happened after all: it sounds at once.
    game.strike(1, 1.0);
    game.render();
    assert_eq!(game.scene.stats().impacts, 2);
    assert!(!game.scene.withdraw(77), "nobody knows it");
}

#[test]
fn a_missed_strike_found_by_rollback_plays_at_once() {
    let mut game = Game::new();
    for tick in 0..100 {
        game.strike(tick, 1.0);
        game.render();
    }
    let before = game.scene.stats();
    let impact = Impact::on(game.body);
    game.scene.report_named(100.0 + 94.0 * TICK_S, 1 << 40, impact).unwrap();
    game.render();
    let after = game.scene.stats();
    assert_eq!((after.impacts, after.clock_jumps), (before.impacts + 1, before.clock_jumps));
}

#[test]
fn a_recording_holds_what_sounded_and_not_what_was_withdrawn() {
    let mut game = Game::new();
    game.scene.start_recording(&Names::default());
    for tick in 0..50u64 {
        game.strike(tick, 1.0);
        if tick % 3 == 0 {
            assert!(game.scene.withdraw(tick));
        }
        game.strike(tick.saturating_sub(5), 1.0);
        game.render();
    }
    game.render();
    let sounded = game.scene.stats().impacts;
    assert_eq!(game.scene.stop_recording().lines.len() as u64, sounded);
}

#[test]
fn more_strikes_than_may_wait_are_handed_back() {
    let mut game = Game::new();
    let report = |game: &mut Game, name: u64| {
        game.scene.report_named(100.0, name, Impact::on(game.body)).map_err(|error| error.reason)
    };
    let refused = (1..=1100).filter(|name| report(&mut game, *name).is_err()).count();
    assert!(refused >= 76, "{refused}");
    (0..3).for_each(|_| game.render());
    assert_eq!(game.scene.stats().impacts + refused as u64, 1100);
    report(&mut game, 2000).unwrap();
}
